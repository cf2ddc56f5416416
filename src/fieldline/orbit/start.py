"""Where a simulated satellite starts: one function over the ways to say it.

    from the Earth's axes:   r_i = C r_e,   v_i = C (v_e + w x r_e),   C = dcm_ei^T,  w = (0, 0, ERA')        (1)

The Earth turns about its intermediate pole, which is the z axis of e to within the pole's wandering of 0.6 arcseconds: (1)
is good to 2 mm/s with and to rounding without measured orientation.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.constants import EARTH_ROTATION_ANGLE_TURNS_PER_DAY, SECONDS_PER_DAY
from fieldline.errors import InputError, nearest
from fieldline.frames.earth_orientation import EarthOrientation
from fieldline.frames.earth_rotation import dcm_ei
from fieldline.frames.time import as_utc
from fieldline.orbit.elements import Elements, check_orbit, elements_from_state, state_from_elements
from fieldline.orbit.orbit import MAX_AGE_DAYS, Orbit
from fieldline.orbit.sun_synchronous import sun_synchronous_orbit

AXES = ("i", "e")
ERA_RATE_RAD_S = 2.0 * np.pi * EARTH_ROTATION_ANGLE_TURNS_PER_DAY / SECONDS_PER_DAY


class StartState(NamedTuple):
    """A position (3,) [m] and a velocity (3,) [m/s]; axes "i" (GCRS) or "e" (ITRS, the velocity as seen from the ground)."""

    position_m: tuple[float, float, float]
    velocity_m_s: tuple[float, float, float]
    axes: str = "i"


class SunSynchronous(NamedTuple):
    """A circle whose node keeps its mean local time."""

    altitude_m: float  # over the equatorial radius
    local_time_s: float  # of the ascending node, after midnight
    argument_of_latitude_rad: float = 0.0


def initial_state_i(
    start_utc,
    start: Orbit | Elements | StartState | SunSynchronous,
    *,
    eop: EarthOrientation | None = None,
    max_age_days: float = MAX_AGE_DAYS,
    unbound: bool = False,
) -> tuple[np.ndarray, np.ndarray, list[str]]:
    """Position (3,) [m] and velocity (3,) [m/s], GCRS axes, at a time; and warnings in words.

    Parameters
    ----------
    start_utc : one datetime64 or ISO 8601 text, UTC.
    start : an `Orbit` as `read_orbit` gives it (of a TLE the state of SGP4 at start_utc), osculating `Elements`, a
        `StartState`, or a `SunSynchronous`.
    eop : measured Earth orientation for a state in axes "e"; UT1 = UTC without it.
    max_age_days : how far from its epoch a TLE may be used [days].
    unbound : whether a hyperbola is meant.

    Raises
    ------
    InputError : an orbit that meets the ground or leaves the Earth, elements that are none, an orbit file that does not serve
        the time.
    """
    time = as_utc(start_utc, "start_utc")
    if time.ndim:
        raise InputError(f"start_utc must be one time; got shape {time.shape}.")
    warnings: list[str] = []
    if isinstance(start, Orbit):
        warnings += start.check(time, max_age_days)
        position, velocity = start.state_i(time)
    elif isinstance(start, SunSynchronous):
        place = start.argument_of_latitude_rad
        orbit = sun_synchronous_orbit(start.altitude_m, start.local_time_s, time, argument_of_latitude_rad=place)
        position, velocity = state_from_elements(orbit)
    elif isinstance(start, Elements):
        position, velocity = state_from_elements(start)
    elif isinstance(start, StartState):
        position, velocity = _of_state(start, time, eop)
    else:
        raise InputError(f"start must be an Orbit, Elements, StartState or SunSynchronous; got {type(start).__name__}.")
    warnings += check_orbit(elements_from_state(position, velocity), unbound=unbound)
    return position, velocity, warnings


def state_i_from_e(position_e_m, velocity_e_m_s, time_utc, eop: EarthOrientation | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Position and velocity (..., 3) [m, m/s] in GCRS axes of those in ITRS axes at (...) times; equation (1)."""
    position, velocity = np.asarray(position_e_m, dtype=float), np.asarray(velocity_e_m_s, dtype=float)
    turn = np.swapaxes(dcm_ei(time_utc, eop), -1, -2)
    carried = velocity + np.cross([0.0, 0.0, ERA_RATE_RAD_S], position)
    return np.einsum("...ij,...j->...i", turn, position), np.einsum("...ij,...j->...i", turn, carried)


def _of_state(start: StartState, time, eop) -> tuple[np.ndarray, np.ndarray]:
    """A given state, checked for its shape, in GCRS axes."""
    if start.axes not in AXES:
        raise InputError(f'unknown axes "{start.axes}" of a state; {nearest(str(start.axes), AXES)}')
    position, velocity = (np.asarray(part, dtype=float) for part in start[:2])
    if position.shape != (3,) or velocity.shape != (3,) or not np.isfinite([position, velocity]).all():
        raise InputError(f"position_m and velocity_m_s must be three finite numbers each; got {position} and {velocity}.")
    return (position, velocity) if start.axes == "i" else state_i_from_e(position, velocity, time, eop)
