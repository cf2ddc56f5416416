"""Many runs of one scenario: what differs between them, and how they fly, one by one or many in the lanes of a vector."""

from fieldline.simulate.ensemble.dispersion import Choice, Normal, Uniform
from fieldline.simulate.ensemble.many import simulate_many

__all__ = ["Choice", "Normal", "Uniform", "simulate_many"]
