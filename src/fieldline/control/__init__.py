"""Flight software that acts: laws from a measurement to a command, and what their gains are designed with."""

from fieldline.control.law import DesignContext, Law, Parameter
from fieldline.control.registry import LAWS, law_named

__all__ = ["LAWS", "law_named", "Law", "Parameter", "DesignContext"]
