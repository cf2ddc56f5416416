"""Where the bodies of a scenario are at its start: states in GCRS axes, SI.

Elements: from perifocal axes by R3(-raan) R1(-inclination) R3(-argument of perigee), with

    r = p / (1 + e cos nu),   p = a (1 - e^2),   mean anomaly M = E - e sin E                          (1)

A sun-synchronous node turns by J2 as the mean Sun does, and stands where its local time asks:

    cos i = - 2/3 (rate / n) (a / R)^2 / J2,   raan = alpha_mean_sun + 15 deg (local_time - 12 h)       (2)

A body beside the first one, at offset_o in orbital axes that turn at w_o = (0, -|r x v| / r^2, 0) [rad/s],

    r = r_1 + C_io offset_o,    v = v_1 + C_io (rate_o + w_o x offset_o)                                (3)

alpha_mean_sun is the Sun's mean longitude, 280.460 deg + 0.9856474 deg a day of UT from J2000, good to 0.01 deg; the
equinox that it counts from moves by 46.1 arcseconds of right ascension a year, 3.51e-5 deg a day, and GCRS does not.

Source: Vallado (2013), Fundamentals of Astrodynamics, s. 2.5 and 11.4.1; The Astronomical Almanac, low precision Sun.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2, EARTH_J2, EARTH_ROTATION_RATE_RAD_S, SECONDS_PER_DAY
from fieldline.errors import InputError
from fieldline.simulate.scenario.orbit_start import Elements, OrbitStart, State, SunSynchronous

MEAN_SUN_RATE_RAD_S = 2.0 * np.pi / (365.2422 * SECONDS_PER_DAY)
J2000 = np.datetime64("2000-01-01T12:00:00", "ns")
KEPLER_TURNS = 50  # Newton's method from E = pi converges in a few for every eccentricity below 1


def start_states(scenario) -> list[tuple[np.ndarray, np.ndarray]]:
    """(position_i [m], velocity_i [m/s]) of each body at the scenario's start.

    Errors: InputError for an orbit file that is missing, damaged or too old.
    """
    eop = earth_orientation(scenario)
    when, folder = scenario.time.start, scenario.folder
    first = scenario.body[0].orbit or scenario.orbit
    states = [state_of(first, when, folder, eop)]
    for body in scenario.body[1:]:
        beside = body.offset_o_m is not None
        states.append(_beside(states[0], body) if beside else state_of(body.orbit, when, folder, eop))
    return states


def earth_orientation(scenario):
    """The measured Earth orientation that the scenario names, or None."""
    from fieldline.frames.earth_orientation import read_eop

    path = scenario.environment.earth_orientation
    return None if path is None else read_eop(scenario.folder / path)


def state_of(start: OrbitStart, start_utc: np.datetime64, folder: str | Path = ".", eop=None) -> tuple[np.ndarray, np.ndarray]:
    """Position (3,) [m] and velocity (3,) [m/s], GCRS axes, of one orbit at a time."""
    if start.elements is not None:
        return _of_elements(start.elements)
    if start.sun_synchronous is not None:
        return _of_elements(sun_synchronous_elements(start.sun_synchronous, start_utc))
    if start.state is not None:
        return _of_state(start.state, start_utc, eop)
    orbit = orbit_of(start, folder, eop)
    orbit.check(start_utc)
    position, velocity = orbit.state_i(start_utc)
    return position.reshape(3), velocity.reshape(3)


def orbit_of(start: OrbitStart, folder: str | Path = ".", eop=None):
    """The `Orbit` of a file or of two lines in the scenario itself."""
    from fieldline.orbit import read_orbit
    from fieldline.orbit.element_orbit import ElementOrbit
    from fieldline.orbit.tle import parse_tle

    text = start.tle or ""
    if "\n" not in text.strip():
        return read_orbit(Path(folder) / text.strip(), norad_id=start.norad_id, eop=eop)
    sets = parse_tle(text, "orbit.tle")
    if not sets:
        raise InputError("orbit.tle holds no element set: give the two lines, or the name of a file.")
    return ElementOrbit(name=sets[0].name or "TLE", kind="TLE", norad_id=sets[0].norad_id, sets=tuple(sets[:1]), eop=eop)


def period_s(position_i: np.ndarray, velocity_i: np.ndarray) -> float:
    """Period [s] of the osculating orbit."""
    radius = float(np.linalg.norm(position_i))
    axis = 1.0 / (2.0 / radius - float(velocity_i @ velocity_i) / EARTH_GM_M3_S2)
    return 2.0 * np.pi * float(np.sqrt(axis**3 / EARTH_GM_M3_S2))


def sun_synchronous_elements(orbit: SunSynchronous, start_utc: np.datetime64) -> Elements:
    """Elements of a circular orbit whose node turns with the mean Sun; equation (2)."""
    axis = EARTH_EQUATORIAL_RADIUS_M + 1e3 * orbit.altitude_km
    motion = np.sqrt(EARTH_GM_M3_S2 / axis**3)
    cosine = -2.0 / 3.0 * (MEAN_SUN_RATE_RAD_S / motion) * (axis / EARTH_EQUATORIAL_RADIUS_M) ** 2 / EARTH_J2
    days = (start_utc - J2000).astype(np.int64) * 1e-9 / SECONDS_PER_DAY
    mean_sun_deg = 280.460 + (0.9856474 - 3.51e-5) * days
    return Elements(
        altitude_km=orbit.altitude_km,
        inclination_deg=float(np.degrees(np.arccos(cosine))),
        raan_deg=float((mean_sun_deg + 15.0 * (orbit.local_time_h - 12.0)) % 360.0),
        argument_of_latitude_deg=orbit.argument_of_latitude_deg,
    )


def _of_elements(elements: Elements) -> tuple[np.ndarray, np.ndarray]:
    """Equation (1)."""
    axis, e = 1e3 * elements.axis_km, elements.eccentricity
    nu, perigee = _true_anomaly(elements), np.radians(elements.argument_of_perigee_deg)
    semi_latus = axis * (1.0 - e * e)
    radius, speed = semi_latus / (1.0 + e * np.cos(nu)), np.sqrt(EARTH_GM_M3_S2 / semi_latus)
    turn = _turn(2, np.radians(elements.raan_deg)) @ _turn(0, np.radians(elements.inclination_deg)) @ _turn(2, perigee)
    position = turn @ (radius * np.array([np.cos(nu), np.sin(nu), 0.0]))
    return position, turn @ (speed * np.array([-np.sin(nu), e + np.cos(nu), 0.0]))


def _true_anomaly(elements: Elements) -> float:
    """[rad], from whichever angle was given."""
    if elements.argument_of_latitude_deg is not None:
        return np.radians(elements.argument_of_latitude_deg - elements.argument_of_perigee_deg)
    if elements.mean_anomaly_deg is None:
        return np.radians(elements.true_anomaly_deg or 0.0)
    e, mean = elements.eccentricity, np.radians(elements.mean_anomaly_deg) % (2.0 * np.pi)
    eccentric = np.pi
    for _ in range(KEPLER_TURNS):
        eccentric -= (eccentric - e * np.sin(eccentric) - mean) / (1.0 - e * np.cos(eccentric))
    return 2.0 * np.arctan2(np.sqrt(1.0 + e) * np.sin(eccentric / 2.0), np.sqrt(1.0 - e) * np.cos(eccentric / 2.0))


def _of_state(state: State, start_utc: np.datetime64, eop) -> tuple[np.ndarray, np.ndarray]:
    """A given state, turned out of the Earth's axes where it is in them: v_i = C_ie (v_e + w x r_e)."""
    from fieldline.frames.earth_rotation import dcm_ei

    position, velocity = 1e3 * np.array(state.position_km), 1e3 * np.array(state.velocity_km_s)
    if state.axes == "gcrs":
        return position, velocity
    dcm_ie = dcm_ei(np.array([start_utc]), eop)[0].T
    spin = np.array([0.0, 0.0, EARTH_ROTATION_RATE_RAD_S])
    return dcm_ie @ position, dcm_ie @ (velocity + np.cross(spin, position))


def _beside(first: tuple[np.ndarray, np.ndarray], body) -> tuple[np.ndarray, np.ndarray]:
    """Equation (3)."""
    position, velocity = first
    dcm_io, rate_o = orbital_axes(position, velocity)
    offset = np.array(body.offset_o_m)
    return position + dcm_io @ offset, velocity + dcm_io @ (np.array(body.offset_rate_o_m_s) + np.cross(rate_o, offset))


def orbital_axes(position_i: np.ndarray, velocity_i: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """dcm_io (3, 3), columns along the track, against the orbit normal, down; and the axes' rate (3,) [rad/s], in them."""
    momentum = np.cross(position_i, velocity_i)
    down, against = -position_i / np.linalg.norm(position_i), -momentum / np.linalg.norm(momentum)
    rate = np.linalg.norm(momentum) / (position_i @ position_i)
    return np.column_stack((np.cross(against, down), against, down)), np.array([0.0, -rate, 0.0])


def _turn(axis: int, angle: float) -> np.ndarray:
    """(3, 3): a vector turned by `angle` [rad] about axis 0 or 2."""
    c, s = np.cos(angle), np.sin(angle)
    rows = {0: [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]], 2: [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]}
    return np.array(rows[axis])
