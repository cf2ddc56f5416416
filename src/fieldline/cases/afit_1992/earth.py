"""The thesis's Earth: constants as its program has them, the orbit, the dipole in the target's axes."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.cases.erbs_like import number
from fieldline.environment.orbital_dipole import dipole_direction_h, orbit_field_h
from fieldline.errors import InputError, shown

SOURCE = "Lawrence (1992), AFIT/GA/ENY/92D-05"
GM_M3_S2 = 6.67259e-11 * 5.976e24
EARTH_RADIUS_M = 6.378e6
DIPOLE_TESLA_M3 = 8.1e15
POLE_LATITUDE_DEG = -78.5
POLE_LONGITUDE_DEG = 111.0
SPIN_RAD_S = 2.0 * np.pi / 86164.0  # two sidereal days are 172,328 s
ALTITUDE_M = 400e3
FIELD_ANGLE_DEG = 33.0


class Circle(NamedTuple):
    """The target's orbit."""

    radius_m: float
    mean_motion_rad_s: float
    strength_tesla: float  # m / r^3


def inclinations_of(inclinations_deg) -> np.ndarray:
    """(k,) [deg] from 0 to 180, or a refusal."""
    try:
        inclinations = np.atleast_1d(np.asarray(inclinations_deg, dtype=float))
    except (TypeError, ValueError):
        inclinations = np.empty((0, 0))
    if inclinations.ndim != 1 or not len(inclinations) or not ((inclinations >= 0.0) & (inclinations <= 180.0)).all():
        raise InputError(f"inclinations_deg must be numbers from 0 to 180; got {inclinations_deg!r}.")
    return inclinations


def day_of(date: str) -> np.datetime64:
    """The day that a text names, or a refusal."""
    try:
        day = np.datetime64(date if isinstance(date, str) else "NaT", "s")
    except (TypeError, ValueError):
        day = np.datetime64("NaT")
    if np.isnat(day):
        raise InputError(f"date must be a day such as 1992-12-01; got {shown(str(date))!r}.")
    return day


def whole(name: str, value, least: int, most: int) -> int:
    """A whole number within bounds, or a refusal."""
    found = number(name, value, least, most)
    if found != int(found):
        raise InputError(f"{name} must be a whole number, {least} to {most}; got {value!r}.")
    return int(found)


def circle(altitude_m: float = ALTITUDE_M) -> Circle:
    """The circular orbit at a height over the thesis's Earth."""
    radius = EARTH_RADIUS_M + number("altitude_m", altitude_m, 1e5, 1e9)
    return Circle(radius, float(np.sqrt(GM_M3_S2 / radius**3)), DIPOLE_TESLA_M3 / radius**3)


def direction_h(inclination_deg, argument_deg, node_deg=0.0) -> np.ndarray:
    """(..., 3) alpha, beta, gamma at an argument of latitude and a node measured from the austral pole's meridian."""
    angles = np.radians(inclination_deg), np.radians(argument_deg), np.radians(node_deg)
    return dipole_direction_h(*angles, np.radians(POLE_LATITUDE_DEG))


def frozen_field_h(orbit: Circle, field_angle_deg, inclination_deg=0.0, node_deg=0.0) -> np.ndarray:
    """(..., 3) [T], axes h, at the angle u + node - thetag - lambda of the thesis's programs; node -thetag - lambda apart."""
    argument = np.asarray(field_angle_deg, dtype=float) - node_deg
    return orbit_field_h(direction_h(inclination_deg, argument, node_deg), orbit.strength_tesla)
