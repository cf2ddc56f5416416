"""Where the bodies of a scenario are at its start: states in GCRS axes, SI, from its records in degrees and kilometres.

A body beside the first one, at offset_o in orbital axes that turn at w_o = (0, -|r x v| / r^2, 0) [rad/s],

    r = r_1 + C_io offset_o,    v = v_1 + C_io (rate_o + w_o x offset_o)                                (1)

Elements, sun-synchronous orbits and states in Earth-fixed axes are those of `fieldline.orbit`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError
from fieldline.frames.orbital import dcm_oi
from fieldline.orbit import elements as kepler
from fieldline.orbit import start as starts
from fieldline.simulate.scenario.orbit_start import Elements, OrbitStart, SunSynchronous

SECONDS_PER_HOUR = 3600.0
SLOWEST, FASTEST = 0.8, 1.2  # of circular speed: what hangs on a line that is not a fifth of the way to the Earth


def start_states(scenario) -> list[tuple[np.ndarray, np.ndarray]]:
    """(position_i [m], velocity_i [m/s]) of each body at the scenario's start.

    A body that hangs on a line is where its attachment will be: the lever is added when its attitude is known.

    Errors: InputError for an orbit file that is missing, damaged or too old.
    """
    eop = earth_orientation(scenario)
    when, folder = scenario.time.start, scenario.folder
    first = scenario.body[0].orbit or scenario.orbit
    states = [state_of(first, when, folder, eop)]
    for body in scenario.body[1:]:
        if body.hang is not None:
            from fieldline.simulate.assembly.hanging import hung

            states.append(hung(scenario, body, states))
        elif body.offset_o_m is not None:
            tied = any(body.name in (line.from_body, line.to_body) for line in scenario.line)
            states.append(_beside(states[0], body, tied))
        else:
            states.append(state_of(body.orbit, when, folder, eop))
    return states


def earth_orientation(scenario):
    """The measured Earth orientation that the scenario names, or None."""
    from fieldline.frames.earth_orientation import read_eop

    path = scenario.environment.earth_orientation
    return None if path is None else read_eop(scenario.folder / path)


def state_of(start: OrbitStart, start_utc: np.datetime64, folder: str | Path = ".", eop=None) -> tuple[np.ndarray, np.ndarray]:
    """Position (3,) [m] and velocity (3,) [m/s], GCRS axes, of one orbit at a time."""
    if start.elements is not None:
        said = _elements(start.elements)
    elif start.sun_synchronous is not None:
        said = _sun_synchronous(start.sun_synchronous)
    elif start.state is not None:
        place, velocity = (tuple(1e3 * x for x in part) for part in (start.state.position_km, start.state.velocity_km_s))
        said = starts.StartState(place, velocity, "i" if start.state.axes == "gcrs" else "e")
    else:
        said = orbit_of(start, folder, eop)
    position, velocity, _ = starts.initial_state_i(start_utc, said, eop=eop)
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
    return float(2.0 * np.pi / kepler.mean_motion(axis))


def _elements(elements: Elements) -> kepler.Elements:
    """A record's elements in metres and radians; the place along the orbit from whichever angle was given."""
    perigee, e = np.radians(elements.argument_of_perigee_deg), elements.eccentricity
    if elements.argument_of_latitude_deg is not None:
        nu = np.radians(elements.argument_of_latitude_deg) - perigee
    elif elements.mean_anomaly_deg is not None:
        nu = kepler.true_anomaly(np.radians(elements.mean_anomaly_deg), e)
    else:
        nu = np.radians(elements.true_anomaly_deg or 0.0)
    inclination, node = np.radians(elements.inclination_deg), np.radians(elements.raan_deg)
    return kepler.Elements(1e3 * elements.axis_km, e, inclination, node, perigee, nu)


def _sun_synchronous(orbit: SunSynchronous) -> starts.SunSynchronous:
    """A record's sun-synchronous orbit in SI."""
    place = np.radians(orbit.argument_of_latitude_deg)
    return starts.SunSynchronous(1e3 * orbit.altitude_km, SECONDS_PER_HOUR * orbit.local_time_h, place)


def _beside(first: tuple[np.ndarray, np.ndarray], body, tied: bool) -> tuple[np.ndarray, np.ndarray]:
    """Equation (1); a body that is tied to a line need not be on an orbit by itself, but neither falls nor leaves."""
    position, velocity = first
    dcm_io, rate_o = orbital_axes(position, velocity)
    offset = np.array(body.offset_o_m)
    place = position + dcm_io @ offset
    speed = velocity + dcm_io @ (np.array(body.offset_rate_o_m_s) + np.cross(rate_o, offset))
    ratio = float(np.linalg.norm(speed) / np.sqrt(EARTH_GM_M3_S2 / np.linalg.norm(place)))
    if tied and SLOWEST < ratio < FASTEST:
        return place, speed
    try:
        kepler.check_orbit(kepler.elements_from_state(place, speed))
    except InputError as error:
        raise InputError(f'body "{body.name}", beside the first by offset_o_m and offset_rate_o_m_s: {error}') from None
    return place, speed


def orbital_axes(position_i: np.ndarray, velocity_i: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """dcm_io (3, 3), columns along the track, against the orbit normal, down; and the axes' rate (3,) [rad/s], in them."""
    rate = np.linalg.norm(np.cross(position_i, velocity_i)) / (position_i @ position_i)
    return dcm_oi(position_i, velocity_i).T, np.array([0.0, -rate, 0.0])
