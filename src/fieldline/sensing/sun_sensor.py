"""Coarse sun sensors: one photocell a face.

    light = sunlit max(0, n . s)_fov + albedo max(0, n . e) (R / r)^2 max(0, z . s)                 (1)
    reading = max(0, light + noise) where light > 0, else 0                                         (2)

n is the face's normal, s the direction to the Sun, z from the Earth to the satellite, e = -z; the Sun is seen within
the field of view about the normal. The second term takes the Earth for a diffuse mirror at the nadir, lit as the ground
below is: good to a few tenths of itself, zero over the night side, and of the size of data (0.3 mean albedo) in low
orbit. Readings are 1 at normal incidence in full sun; darkness reads exactly 0 and is a valid reading.

Valid for small sensors that no other part shades.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M
from fieldline.frames.vectors import dot, norm, scale, vec
from fieldline.sensing.measurement import SUN


class SunSensorParams(NamedTuple):
    """One row a face; body k has the faces start[k] to start[k + 1], in the order of its readings."""

    start: np.ndarray  # (bodies + 1,) int64
    normal: np.ndarray  # (faces, 3) outward, body axes
    least_cosine: np.ndarray  # (faces,) cosine of the field of view's half-angle: 0 is a hemisphere
    albedo: np.ndarray  # (faces,) of the Earth as this face sees it; 0: none
    noise_std: np.ndarray  # (faces,)


@njit(cache=True)
def earthlight(sun_b, position_b):
    """(R / r)^2 max(0, z . s): light of the ground below over sunlight times albedo; the second term of (1)."""
    radius = norm(position_b)
    return (EARTH_EQUATORIAL_RADIUS_M / radius) ** 2 * max(0.0, dot(position_b, sun_b) / radius)


@njit(cache=True)
def read_sun_sensor(sun_b, sunlit, position_b, params, k, rng, out):
    """Read the faces of body k into `out`.

    sun_b : unit vector to the Sun.      sunlit : fraction of its disc in sight, 0..1.
    position_b : [m] from the Earth's centre.      All 3-tuples, body axes.
    """
    first = params.start[k]
    if params.start[k + 1] == first:
        return
    ground = earthlight(sun_b, position_b)
    down_b = scale(-1.0 / norm(position_b), position_b)
    for face in range(first, params.start[k + 1]):
        normal = vec(params.normal, face)
        cosine = dot(normal, sun_b)
        direct = sunlit * max(0.0, cosine) if cosine >= params.least_cosine[face] else 0.0
        light = direct + params.albedo[face] * ground * max(0.0, dot(normal, down_b))
        error = params.noise_std[face] * rng.standard_normal()
        out.sun_sensor[face - first] = max(0.0, light + error) if light > 0.0 else 0.0
    out.valid[SUN] = 1.0
