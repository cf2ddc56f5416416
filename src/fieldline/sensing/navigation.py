"""Position and velocity as known on board, from GNSS or from elements; those beside the first body, from a sensor of its own.

    r = r_i + x_i dx + y_i dy + z_i dz + noise                                                      (1)
    v = v_i + noise                                                                                 (2)
    r - r_first = truth + noise,   v - v_first = truth + noise                                      (3)

(dx, dy, dz) is constant in orbital axes: x along the velocity, z to the nadir, y against the orbit normal, so that an
old ephemeris is mostly dx. Noise is white, GCRS axes, and independent between position and velocity.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.frames.vectors import add, axpy, cross, scale, unit, vec
from fieldline.sensing.measurement import ORBIT
from fieldline.sensing.reading import noise3


class NavigationParams(NamedTuple):
    """One row a body; a body that does not know its orbit has 0 in `present`."""

    present: np.ndarray  # (n,) 0 or 1
    position_offset_o: np.ndarray  # (n, 3) [m], orbital axes
    position_noise_std: np.ndarray  # (n, 3) [m]
    velocity_noise_std: np.ndarray  # (n, 3) [m/s]
    relative_position_noise_std: np.ndarray  # (n, 3) [m]
    relative_velocity_noise_std: np.ndarray  # (n, 3) [m/s]


@njit(cache=True)
def from_orbital(offset_o, position_i, velocity_i):
    """A vector in orbital axes turned to axes i; zero stays zero even where a vertical fall has no such axes."""
    if offset_o[0] == 0.0 and offset_o[1] == 0.0 and offset_o[2] == 0.0:
        return (0.0, 0.0, 0.0)
    z = unit(scale(-1.0, position_i))
    y = unit(cross(velocity_i, position_i))
    x = cross(y, z)
    return axpy(offset_o[0], x, axpy(offset_o[1], y, scale(offset_o[2], z)))


@njit(cache=True)
def read_navigation(position_i, velocity_i, params, k, rng, out):
    """Position [m] and velocity [m/s] of body k as known on board, 3-tuples, into `out`; (1) and (2)."""
    if params.present[k] == 0.0:
        return
    offset = from_orbital(vec(params.position_offset_o, k), position_i, velocity_i)
    place = add(add(position_i, offset), noise3(params.position_noise_std, k, rng))
    speed = add(velocity_i, noise3(params.velocity_noise_std, k, rng))
    for axis in range(3):
        out.position_i[axis] = place[axis]
        out.velocity_i[axis] = speed[axis]
    out.valid[ORBIT] = 1.0


@njit(cache=True)
def read_relative(position_i, velocity_i, params, k, rng, out):
    """Place [m] and velocity [m/s] of body k from the first one as known on board, 3-tuples in GCRS axes, into `out`; (3)."""
    place = add(position_i, noise3(params.relative_position_noise_std, k, rng))
    speed = add(velocity_i, noise3(params.relative_velocity_noise_std, k, rng))
    for axis in range(3):
        out.relative_position_i[axis] = place[axis]
        out.relative_velocity_i[axis] = speed[axis]
