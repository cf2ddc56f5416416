"""A moment that the torquers can give: shortened as a whole, so that it keeps its direction.

Clipping each axis by itself would turn the moment, and with it the torque, away from what the law asks for.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fieldline.frames.vectors import scale


@njit(cache=True)
def shortened(moment, params, first):
    """(moment [A m^2], whether it was shortened); the most per axis in params from `first` on."""
    share = 1.0
    for j in range(3):
        most = params[first + j]
        if abs(moment[j]) * share > most:
            share = most / abs(moment[j])
    return scale(share, moment), share < 1.0


@njit(cache=True)
def as_command(moment):
    """A moment as the array that a law returns."""
    command = np.empty(3)
    for j in range(3):
        command[j] = moment[j]
    return command
