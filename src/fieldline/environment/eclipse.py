"""The Earth's shadow: how much of the Sun a satellite sees.

    cylinder:  dark where r . s < 0 and |r - (r . s) s| < R                                                 (1)
    cone:      sunlit = 1 - (area of the Sun's disc behind the Earth's) / (pi a^2)                          (2)
               a = asin(R_sun / d),  b = asin(R / r),  c = angle between the centres, all seen by the satellite

(2) takes both discs as flat circles of radius a and b, c apart, which gives penumbra, umbra and (far out) the annular
eclipse; the limb's true curve differs by at most 0.0014 of the disc. The Earth is a sphere of equatorial
radius R without atmosphere: the flattening moves the shadow's edge by up to 21 km at the poles (some 3 s of flight),
and refraction dims the last few seconds.

Source: Montenbruck and Gill, Satellite Orbits (2000), s. 3.4.2.
"""

from __future__ import annotations

from math import asin, atan2, pi, sqrt

import numpy as np
from numba import njit

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, SUN_RADIUS_M
from fieldline.environment.places import as_positions, one_time_each
from fieldline.environment.sun import sun_position_i
from fieldline.errors import InputError, nearest
from fieldline.frames.time import as_utc
from fieldline.frames.vectors import cross, dot, norm, sub, vec

SHAPES = ("cone", "cylinder")


def eclipse(position_i_m, time_utc, shape: str = "cone") -> np.ndarray:
    """Sunlit fraction (...) of the Sun's disc: 1 in full sun, 0 in the umbra.

    Parameters
    ----------
    position_i_m : (..., 3) [m], GCRS axes.
    time_utc : datetime64, one for all places or one for each.
    shape : "cone" (umbra and penumbra) or "cylinder" (all or nothing).

    Raises
    ------
    InputError : unknown shape, places inside the Earth or not in metres, shapes that do not match, times outside
        1900 to 2100.
    """
    if shape not in SHAPES:
        raise InputError(f'unknown shadow shape "{shape}"; {nearest(str(shape), SHAPES)}')
    position = as_positions("position_i_m", position_i_m, "GCRS")
    sun = sun_position_i(as_utc(time_utc))
    common = one_time_each(position.shape[:-1], sun.shape[:-1])
    if shape == "cylinder":
        return _cylinder(position, sun)
    places = np.ascontiguousarray(np.broadcast_to(position, (*common, 3)).reshape(-1, 3))
    out = np.empty(len(places))
    _cone(places, sun.reshape(-1, 3), out)
    return out.reshape(common)


def _cylinder(position: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """Equation (1)."""
    s = sun / np.linalg.norm(sun, axis=-1, keepdims=True)
    along = np.sum(position * s, axis=-1)
    aside = np.linalg.norm(position - along[..., None] * s, axis=-1)
    return np.where((along < 0.0) & (aside < EARTH_EQUATORIAL_RADIUS_M), 0.0, 1.0)


@njit(cache=True)
def sunlit_kernel(r_i, sun_i):
    """Sunlit fraction of the Sun's disc at r_i [m] with the Sun's centre at sun_i [m] (tuples, any one axes), equation (2)."""
    to_sun = sub(sun_i, r_i)
    along = dot(to_sun, r_i)
    aside = norm(cross(to_sun, r_i))
    radius = norm(r_i)
    if along >= 0.0 and radius > 1.001 * EARTH_EQUATORIAL_RADIUS_M:
        return 1.0  # by day: the Sun is up, and the Earth's edge more than its disc below the horizon
    a = asin(SUN_RADIUS_M / norm(to_sun))
    b = asin(min(EARTH_EQUATORIAL_RADIUS_M / radius, 1.0))
    # atan2 of cross and dot: acos would lose the penumbra's width to rounding for centres nearly in line.
    c = atan2(aside, -along)
    return min(max(1.0 - _overlap(a, b, c) / (pi * a**2), 0.0), 1.0)  # rounding leaves -1e-16


@njit(cache=True)
def _overlap(a, b, c):
    """Area common to two circles of radius a and b whose centres are c apart."""
    if c >= a + b:
        return 0.0
    if c <= abs(a - b):
        return pi * min(a, b) ** 2
    x = min(max((c * c + a * a - b * b) / (2.0 * c), -a), a)
    y = sqrt(a * a - x * x)
    # atan2 with the shared half-chord y, not acos((c - x) / b): near 1 that acos has no digits left.
    return a * a * atan2(y, x) + b * b * atan2(y, c - x) - c * y


@njit(cache=True)
def _cone(position_i, sun_i, out):
    """`sunlit_kernel` at every row; the Sun has one row, or one for each."""
    for k in range(position_i.shape[0]):
        out[k] = sunlit_kernel(vec(position_i, k), vec(sun_i, k if sun_i.shape[0] > 1 else 0))
