"""A climb or a turn of the orbit's plane by scheduled current, averaged over orbit and day.

    da/dt = 2/n <F_t>/M,   di/dt = 1/(n a) <F_h cos u>/M                                            (1)

F: the force of the currents of `control.tracking.orbit_change` at each argument of latitude u and each longitude of the
node, which a day goes through; the orbit circular, the vehicle along its axes. Two limits of the plasma's contacts, in the
light and in the dark: the ionosphere by night takes a tenth of the current and less. The shadow, a cylinder of the Earth's
width, lies about u_sun + 180 deg; where the Sun stands over the plane it is shorter.

    power = sum R I^2 + F . (v - w x r)                                                             (2)

(1) leaves out what cancels in an orbit: the swing of a within one, eccentricity from forces that follow u, and the
oblateness, which moves the node and not a or i. Against the plant: 1 % of the change in ten orbits.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2, EARTH_ROTATION_RATE_RAD_S
from fieldline.control.tracking.orbit_change import AXIS_SIZE, DARK, SOFTNESS, TILT, TILT_SIZE, WIRES
from fieldline.environment.orbit_field import field_on_orbit_h
from fieldline.errors import InputError, NoEstimateError
from fieldline.vehicle.conductor import Conductor

ARGUMENTS, NODES = 48, 16
LOWEST_M = 1e5


def orbit_transfer(
    conductors: Sequence[Conductor],
    mass_kg: float,
    altitude_m: float,
    inclination_rad: float,
    *,
    to_altitude_m: float,
    to_inclination_rad: float | None = None,
    duration_s: float = 30 * 86400.0,
    contact_light_a: float = np.inf,
    contact_dark_a: float = np.inf,
    sun_argument_rad: float = 0.0,
    sun_elevation_rad: float = 0.0,
    altitude_size_m: float = 10e3,
    inclination_size_rad: float = np.radians(0.1),
    softness: float = 0.1,
    resistance_ohm: float = 0.0,
    model: str = "IGRF-14",
    time_utc="2025-01-01",
    step_s: float = 21_600.0,
):
    """Height and inclination over time, as a Dataset over seconds.

    Parameters
    ----------
    conductors : records, body axes along up, velocity, normal.      mass_kg.
    altitude_m, inclination_rad : of the circular orbit at the start, over 6378.1366 km.      to_... : what is wanted.
    contact_light_a, contact_dark_a : most current of a contact in the light and in the dark.
    sun_argument_rad, sun_elevation_rad : argument of latitude of the Sun's direction in the orbit's plane, its height over it;
        they stay, though in a month the Sun goes on by 30 degrees and the node by some 200.
    altitude_size_m, inclination_size_rad, softness : as of the law.      resistance_ohm : added to each conductor's own.
    model, time_utc : of the field.      step_s : of the averaged equations.

    Returns
    -------
    Dataset: altitude_m, inclination_deg, power_w (supplies, mean of an orbit), current_share (mean |I| over the limit),
    and energy_j, charge_c of all.

    Raises
    ------
    InputError : no conductors, numbers out of range.      NoEstimateError : the orbit comes down.
    """
    if not conductors:
        raise InputError("a transfer by current needs conductors; got none.")
    least = {"mass_kg": mass_kg, "duration_s": duration_s, "step_s": step_s, "softness": softness}
    for name, value in {**least, "altitude_size_m": altitude_size_m, "inclination_size_rad": inclination_size_rad}.items():
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{name} must be a positive number; got {value!r}.")
    if min(contact_light_a, contact_dark_a) < 0.0 or not LOWEST_M <= min(altitude_m, to_altitude_m) <= 1e8:
        raise InputError("contact limits must not be negative, altitudes at least 100 km in metres.")
    tilt = inclination_rad if to_inclination_rad is None else to_inclination_rad
    row = np.zeros(WIRES)
    row[:DARK] = [
        EARTH_EQUATORIAL_RADIUS_M + to_altitude_m,
        tilt,
        altitude_size_m,
        inclination_size_rad,
        softness,
        len(conductors),
    ]
    wires = np.array([one.length_m * np.array(one.direction_b) for one in conductors])
    bound = np.array([one.current_max_a for one in conductors])
    ohms = np.array([one.resistance_ohm for one in conductors]) + resistance_ohm
    dark = np.array([contact_light_a, contact_dark_a])
    place = {
        "row": row,
        "wires": wires,
        "bound": bound,
        "ohms": ohms,
        "contact": dark,
        "sun": (sun_argument_rad, sun_elevation_rad),
    }
    count = max(1, int(np.ceil(duration_s / step_s)))
    seconds = np.linspace(0.0, duration_s, count + 1)
    state = np.array([EARTH_EQUATORIAL_RADIUS_M + altitude_m, inclination_rad])
    states, told = [state], [_averages(state, mass_kg, model, time_utc, **place)]
    for _ in range(count):
        state = _step(state, seconds[1], told[-1][0], mass_kg, model, time_utc, place)
        if state[0] < EARTH_EQUATORIAL_RADIUS_M + LOWEST_M:
            raise NoEstimateError("the orbit comes down below 100 km: the wanted height is too low or the currents push back.")
        states.append(state)
        told.append(_averages(state, mass_kg, model, time_utc, **place))
    return _dataset(seconds, np.array(states), told, model)


def _step(state, dt, first, mass, model, time_utc, place) -> np.ndarray:
    """A classical Runge-Kutta step of (1)."""
    k2, *_ = _averages(state + 0.5 * dt * first, mass, model, time_utc, **place)
    k3, *_ = _averages(state + 0.5 * dt * k2, mass, model, time_utc, **place)
    k4, *_ = _averages(state + dt * k3, mass, model, time_utc, **place)
    return state + dt / 6.0 * (first + 2.0 * k2 + 2.0 * k3 + k4)


def shadow_half_width(a: float, sun_elevation_rad: float) -> float:
    """[rad] of the argument of latitude in the Earth's shadow, a cylinder, either way of its middle: 0 where it is missed."""
    lit = np.sqrt(max(0.0, 1.0 - (EARTH_EQUATORIAL_RADIUS_M / a) ** 2)) / max(np.cos(sun_elevation_rad), 1e-12)
    return float(np.arccos(min(1.0, lit)))


def _averages(state, mass, model, time_utc, *, row, wires, bound, ohms, contact, sun):
    """(da/dt, di/dt), mean power [W], mean share of current, mean current of all [A]: over argument and node."""
    a, i = float(state[0]), float(state[1])
    n = np.sqrt(EARTH_GM_M3_S2 / a**3)
    u = 2.0 * np.pi * (np.arange(ARGUMENTS) + 0.5) / ARGUMENTS
    w = 2.0 * np.pi * np.arange(NODES) / NODES
    field_h = field_on_orbit_h(a, i, u[:, None], w, np.datetime64(time_utc), model)
    push = np.cross(wires[:, None, None, :], field_h)  # (m, u, w, 3) per ampere
    size = 2.0 / (n * row[AXIS_SIZE]) * np.linalg.norm(wires, axis=1)[:, None, None] * np.linalg.norm(field_h, axis=-1)
    wanted = (row[0] - a) / row[AXIS_SIZE] ** 2 * 2.0 / n * push[..., 1]
    wanted = wanted + (row[TILT] - i) / row[TILT_SIZE] ** 2 * np.cos(u)[:, None] / (n * a) * push[..., 2]
    half = shadow_half_width(a, sun[1])
    off = np.abs((u - sun[0]) % (2.0 * np.pi) - np.pi)
    limit = np.minimum(bound[:, None], np.where(off < half, contact[1], contact[0]))[:, :, None]
    current = limit * np.clip(wanted / (row[SOFTNESS] * size), -1.0, 1.0)
    force = np.einsum("muw,muwj->uwj", current, push)
    rates = np.array([2.0 / n * force[..., 1].mean(), (force[..., 2] * np.cos(u)[:, None]).mean() / (n * a)]) / mass
    cosine = np.cos(i)
    sine = np.sin(i) * np.cos(u)[:, None]
    ahead, across = n * a - EARTH_ROTATION_RATE_RAD_S * a * cosine, EARTH_ROTATION_RATE_RAD_S * a * sine
    work = force[..., 1] * ahead + force[..., 2] * across
    power = np.einsum("muw,m->uw", current**2, ohms) + work
    return (
        rates,
        float(power.mean()),
        float((np.abs(current) / bound[:, None, None]).mean()),
        float(np.abs(current).sum(axis=0).mean()),
    )


def _dataset(seconds, states, told, model):
    """The way of the orbit and what it costs."""
    import xarray as xr

    power, share, current = (np.array([one[k] for one in told]) for k in (1, 2, 3))
    over = "seconds"
    height = states[:, 0] - EARTH_EQUATORIAL_RADIUS_M
    return xr.Dataset(
        {
            "altitude_m": (over, height, {"units": "m", "long_name": "height over 6378.1366 km"}),
            "inclination_deg": (over, np.degrees(states[:, 1]), {"units": "degree", "long_name": "inclination"}),
            "power_w": (over, power, {"units": "W", "long_name": "power of the supplies, mean of an orbit"}),
            "current_share": (over, share, {"units": "1", "long_name": "mean current over its limit"}),
            "energy_j": ((), float(np.trapezoid(power, seconds)), {"units": "J", "long_name": "energy of the supplies"}),
            "charge_c": ((), float(np.trapezoid(current, seconds)), {"units": "C", "long_name": "charge through all conductors"}),
        },
        coords={over: (over, seconds, {"units": "s"})},
        attrs={"model": model},
    )
