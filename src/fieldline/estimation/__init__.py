"""From measurements to attitude, rate, calibration and their uncertainty."""

from fieldline.estimation.calibrate import calibrate
from fieldline.estimation.estimate import estimate_attitude

__all__ = ["calibrate", "estimate_attitude"]
