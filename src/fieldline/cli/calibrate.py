"""`fieldline calibrate`: bias, matrix and gain of a magnetometer from one or several files of a satellite."""

from __future__ import annotations


def calibrate() -> int:
    """Calibrate."""
    return 0
