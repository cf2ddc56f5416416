"""Loads on lines and bodies that tests write: gravity made uniform, ends that are held or moved, a chosen motion.

Places are told from (ORIGIN_M, 0, 0), x_i being up: (x, y, z) of a laboratory is (z, x, y) in inertial axes.
"""

import numpy as np
from numba import njit

from fieldline.constants import EARTH_GM_M3_S2

ORIGIN_M = 6_878_136.6
GM = EARTH_GM_M3_S2


@njit(cache=True)
def laboratory(t, state, parameters):
    """On nodes: a uniform gravity (3) [m/s^2] in place of the Earth's, and a drag [1/s] against the velocity."""
    out = np.zeros(6)
    r3 = np.sqrt(state[0] ** 2 + state[1] ** 2 + state[2] ** 2) ** 3
    for j in range(3):
        out[j] = state[7] * (GM * state[j] / r3 + parameters[j] - parameters[3] * state[3 + j])
    return out


@njit(cache=True)
def laboratory_body(t, state, parameters):
    """On a body: mass with its half segments [kg], gravity (3) [m/s^2], acceleration (3) [m/s^2] times cos(rate t), rate."""
    out = np.zeros(6)
    r3 = np.sqrt(state[0] ** 2 + state[1] ** 2 + state[2] ** 2) ** 3
    swing = np.cos(parameters[7] * t)
    for j in range(3):
        out[j] = parameters[0] * (GM * state[j] / r3 + parameters[1 + j] + parameters[4 + j] * swing)
    return out
