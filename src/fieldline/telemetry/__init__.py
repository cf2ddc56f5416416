"""Telemetry: tables of attitude sensors in, attitude files out."""

from fieldline.telemetry.reading import read_telemetry
from fieldline.telemetry.record import Quality, Recognised, Telemetry

__all__ = ["Quality", "Recognised", "Telemetry", "read_telemetry"]
