"""What every reading goes through: noise, digits, and the end of a range.

    digits = clip(q rint(x / q), -range, range)                                                     (1)

Halves go to the even digit, as IEEE 754 rounds. A quantum of zero leaves the value as it is; an infinite range never
cuts. NaN stays NaN.
"""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def digits(x, quantum, limit):
    """Reading of the value x, all in one unit (1)."""
    if quantum > 0.0:
        x = quantum * np.rint(x / quantum)
    return -limit if x < -limit else limit if x > limit else x


@njit(cache=True)
def nine(rows, k):
    """Row k of an (n, 9) array as a 3 x 3 matrix of nine floats."""
    row = rows[k]
    return (row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8])


@njit(cache=True)
def noise3(std, k, rng):
    """Three independent normal errors with the standard deviations of row k of std (n, 3), drawn in the axes' order.

    They are drawn even where the deviation is zero, so that switching a noise off leaves every other draw as it was.
    """
    x = std[k, 0] * rng.standard_normal()
    y = std[k, 1] * rng.standard_normal()
    z = std[k, 2] * rng.standard_normal()
    return (x, y, z)
