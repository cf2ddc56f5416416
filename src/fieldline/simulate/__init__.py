"""Days not yet flown: simulated truth, and the telemetry that it would have sent down."""

from fieldline.simulate.free_flight import FreeFlight, fly_free
from fieldline.simulate.magnetometer import Magnetometer

__all__ = ["FreeFlight", "Magnetometer", "fly_free"]
