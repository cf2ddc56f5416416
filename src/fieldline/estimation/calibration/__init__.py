"""Calibration of a magnetometer without attitude: from the magnitude of its readings against a field model's."""

from fieldline.estimation.calibration.clock import ClockScan
from fieldline.estimation.calibration.face import Flight, calibrate_flights, calibrate_magnitude
from fieldline.estimation.calibration.record import Calibration
from fieldline.estimation.calibration.selection import Candidate
from fieldline.estimation.calibration.storage import read_calibration, write_calibration

__all__ = [
    "calibrate_magnitude",
    "calibrate_flights",
    "Calibration",
    "Candidate",
    "Flight",
    "ClockScan",
    "read_calibration",
    "write_calibration",
]
