"""Orbital axes o: x along the velocity (exactly, along the track), y against the orbit's normal, z to the Earth's centre.

    z_o = -r / |r|,   y_o = -(r x v) / |r x v|,   x_o = y_o x z_o                                           (1)

dcm_oi has these as its rows: v_o = dcm_oi v_i. In a circular orbit x is the velocity's direction; in an eccentric one the
velocity leans out of the horizontal by the flight path angle and x does not.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fieldline.errors import InputError
from fieldline.frames.vectors import cross, scale, unit


@njit(cache=True)
def orbital_axes(r_i, v_i):
    """dcm_oi as nine floats, row by row, of a position and a velocity (tuples) that are not parallel: equation (1)."""
    z = scale(-1.0, unit(r_i))
    y = unit(cross(v_i, r_i))
    x = cross(y, z)
    return (x[0], x[1], x[2], y[0], y[1], y[2], z[0], z[1], z[2])


def dcm_oi(position_i_m, velocity_i_m_s) -> np.ndarray:
    """(..., 3, 3) of (1), v_o = dcm_oi @ v_i, from positions (..., 3) [m] and velocities (..., 3) [m/s], GCRS axes.

    InputError where a position and its velocity span no plane.
    """
    position, velocity = np.asarray(position_i_m, dtype=float), np.asarray(velocity_i_m_s, dtype=float)
    normal = np.cross(position, velocity)
    size = np.linalg.norm(normal, axis=-1, keepdims=True)
    least = 1e-12 * np.linalg.norm(position, axis=-1, keepdims=True) * np.linalg.norm(velocity, axis=-1, keepdims=True)
    if not (size > least).all():
        raise InputError("position_i_m and velocity_i_m_s must not be parallel, zero or NaN: they span no orbital plane.")
    z = -position / np.linalg.norm(position, axis=-1, keepdims=True)
    y = -normal / size
    return np.stack([np.cross(y, z), y, z], axis=-2)
