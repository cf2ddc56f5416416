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

import numpy as np

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, SUN_RADIUS_M
from fieldline.environment.places import as_positions, one_time_each
from fieldline.environment.sun import sun_position_i
from fieldline.errors import InputError, nearest
from fieldline.frames.time import as_utc

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
    one_time_each(position.shape[:-1], sun.shape[:-1])
    return _cone(position, sun) if shape == "cone" else _cylinder(position, sun)


def _cylinder(position: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """Equation (1)."""
    s = sun / np.linalg.norm(sun, axis=-1, keepdims=True)
    along = np.sum(position * s, axis=-1)
    aside = np.linalg.norm(position - along[..., None] * s, axis=-1)
    return np.where((along < 0.0) & (aside < EARTH_EQUATORIAL_RADIUS_M), 0.0, 1.0)


def _cone(position: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """Equation (2)."""
    to_sun = sun - position
    distance = np.linalg.norm(to_sun, axis=-1)
    radius = np.linalg.norm(position, axis=-1)
    a = np.arcsin(SUN_RADIUS_M / distance)
    b = np.arcsin(np.minimum(EARTH_EQUATORIAL_RADIUS_M / radius, 1.0))
    # atan2 of cross and dot: acos would lose the penumbra's width to rounding for centres nearly in line.
    cross = np.linalg.norm(np.cross(to_sun, -position), axis=-1)
    c = np.arctan2(cross, np.sum(-to_sun * position, axis=-1))
    return np.clip(1.0 - _overlap(a, b, c) / (np.pi * a**2), 0.0, 1.0)  # rounding leaves -1e-16


def _overlap(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Area common to two circles of radius a and b whose centres are c apart."""
    apart = c >= a + b
    inside = c <= np.abs(a - b)
    between = np.where(apart | inside, a + b, c)  # any harmless value where the lens formula is not needed
    x = np.clip((between**2 + a**2 - b**2) / (2.0 * between), -a, a)
    y = np.sqrt(a**2 - x**2)
    # atan2 with the shared half-chord y, not acos((c - x) / b): near 1 that acos has no digits left.
    lens = a**2 * np.arctan2(y, x) + b**2 * np.arctan2(y, between - x) - between * y
    return np.where(apart, 0.0, np.where(inside, np.pi * np.minimum(a, b) ** 2, lens))
