"""Orbits whose node turns with the mean Sun, so that they cross the equator at the same local time for ever.

    cos i = -2/3 (w / n) (p / R)^2 / J2,     n = sqrt(GM / a^3)                                             (1)
    raan(t) = ERA(t) - w_day (t - 12 h UT) + (2 pi / 24 h) (LTAN - 12 h)                                    (2)

w is the mean Sun's rate among the stars, 0.9856123 deg a day; LTAN the mean local solar time at the ascending node.
ERA less UT at 2 pi a day is the mean Sun's place from the origin of GCRS right ascension (the non-rotating origin), so (2)
needs no equinox. The true Sun runs up to 16 minutes ahead of the mean one or behind it over a year.

(1) is of the first order in J2: over a year the local time of a real orbit drifts by some minutes at 1e-3 of w, and more by
the Sun's pull. Source: Vallado (2013), 4th ed., s. 11.4.1; IERS Conventions (2010), equation (5.15).
"""

from __future__ import annotations

import numpy as np

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_J2, EARTH_ROTATION_ANGLE_TURNS_PER_DAY, SECONDS_PER_DAY
from fieldline.errors import InputError
from fieldline.frames.earth_rotation import earth_rotation_angle
from fieldline.frames.time import as_utc, utc_julian
from fieldline.orbit.elements import Elements, mean_motion

MEAN_SUN_RATE_RAD_S = 2.0 * np.pi * (EARTH_ROTATION_ANGLE_TURNS_PER_DAY - 1.0) / SECONDS_PER_DAY


def sun_synchronous_inclination(altitude_m: float, eccentricity: float = 0.0) -> float:
    """Inclination [rad], equation (1), of an orbit whose semi-major axis exceeds the equatorial radius by altitude_m [m].

    InputError where no inclination does it: above 5,970 km for a circle, or below the ground.
    """
    axis = EARTH_EQUATORIAL_RADIUS_M + altitude_m
    if not 0.0 <= eccentricity < 1.0 or not axis * (1.0 - eccentricity) > EARTH_EQUATORIAL_RADIUS_M:
        raise InputError(
            f"a sun-synchronous orbit of altitude_m {altitude_m!r} and eccentricity {eccentricity!r} meets the ground. "
            "Is the altitude in metres?"
        )
    p = axis * (1.0 - eccentricity**2)
    motion = float(mean_motion(axis))
    cosine = -2.0 / 3.0 * MEAN_SUN_RATE_RAD_S / motion * (p / EARTH_EQUATORIAL_RADIUS_M) ** 2 / EARTH_J2  # (1)
    if cosine < -1.0:
        raise InputError(
            f"no orbit at altitude_m {altitude_m:.6g} is sun-synchronous: even a retrograde equatorial one turns too slowly. "
            "The highest circle is at 5.97e6 m."
        )
    return float(np.arccos(cosine))


def node_of_local_time(time_utc, local_time_s: float) -> float:
    """Right ascension [rad], 0 to 2 pi, of a node that the equator's clocks pass at local_time_s after midnight; equation (2).

    time_utc : one datetime64.      local_time_s : mean local solar time, 0 to 86400; 37800 is 10:30.
    """
    if not 0.0 <= local_time_s <= SECONDS_PER_DAY:
        raise InputError(f"local_time_s must lie within 0 and 86400, seconds after midnight; got {local_time_s!r}.")
    time = as_utc(time_utc)
    if time.ndim:
        raise InputError(f"time_utc must be one time; got shape {time.shape}.")
    _, day = utc_julian(time)  # from midnight UT
    angle = float(earth_rotation_angle(time)) + 2.0 * np.pi * (local_time_s / SECONDS_PER_DAY - float(day))
    return angle % (2.0 * np.pi)


def sun_synchronous_orbit(altitude_m: float, local_time_s: float, time_utc, *, argument_of_latitude_rad: float = 0.0) -> Elements:
    """Elements [m, rad], GCRS axes, of a sun-synchronous circle at a time; arguments as the functions above."""
    return Elements(
        EARTH_EQUATORIAL_RADIUS_M + altitude_m,
        0.0,
        sun_synchronous_inclination(altitude_m),
        node_of_local_time(time_utc, local_time_s),
        0.0,
        argument_of_latitude_rad,
    )
