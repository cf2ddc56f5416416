"""How fast a bare line brings a satellite down: electrodynamic drag over an orbit and a day.

    F = integral of I ds x B,     da/dt = 2 a^2 F . v / (GM m)                                             (1)
    time down to a_1:  integral of da / |da/dt|                                                            (2)

A straight vertical line on a circular orbit, its upper end the anode on orbits that go east, the current by `dynamics.lines.bare`
in the plasma and the field where it is. (1) is averaged over the orbit and over the Earth's turn below it (a day, with the
Sun where it is at the given time); (2) takes (1) as it is along the way. The line's own swing, eclipses' cold and warm
wire, and air drag are left out; steering for the stability of the swing (`libration`) costs some of it.

Source: Sanmartin, Martinez-Sanchez and Ahedo (1993), J. Propul. Power 9(3), 353; King-Hele (1987), Satellite Orbits in an
Atmosphere, s. 3.2 for (1).
"""

from __future__ import annotations

import numpy as np

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2, EARTH_ROTATION_RATE_RAD_S
from fieldline.errors import InputError

PLACES, TURNS, SEGMENTS = 24, 8, 8  # along the orbit, of the Earth below it, along the line: 1 % of the mean


def bare_decay(
    altitude_m: float,
    inclination_rad: float,
    plasma,
    *,
    length_m: float,
    diameter_m: float,
    resistance_ohm_per_m: float,
    mass_kg: float,
    time_utc="2026-03-20T12:00:00",
    field: str = "IGRF-14",
    cathode_drop_v: float = 20.0,
    load_ohm: float = 0.0,
    raan_rad: float = 0.0,
):
    """Mean motion downwards of a satellite with a bare line: Dataset over `place` (argument of latitude) and `turn` of the Earth.

    Parameters
    ----------
    altitude_m, inclination_rad, raan_rad : of the circular orbit, over the equatorial radius [m].
    plasma : of `environment.plasma.plasma_model`.
    length_m, diameter_m, resistance_ohm_per_m : of the line; of a tape the circumference over pi [m].
    mass_kg : of everything.   cathode_drop_v, load_ohm : of its circuit.   field : name of a field model.

    Returns
    -------
    Dataset: emf [V], current [A] mean along the line, drag [N] against the velocity (negative where it pushes), and the
    means altitude_rate [m/s] of equation (1), power [W] taken from the orbit.

    Raises
    ------
    InputError : numbers out of range, an unknown field.
    """
    import xarray as xr

    for name, value in (("altitude_m", altitude_m), ("length_m", length_m), ("diameter_m", diameter_m), ("mass_kg", mass_kg)):
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{name} must be above zero; got {value}")
    radius = EARTH_EQUATORIAL_RADIUS_M + altitude_m
    place_i, velocity_i, up = _orbit(radius, inclination_rad, raan_rad)
    fields, winds, electrons = _along(place_i, velocity_i, plasma, time_utc, field)
    emf, current, drag = np.zeros((PLACES, TURNS)), np.zeros((PLACES, TURNS)), np.zeros((PLACES, TURNS))
    circuit = {"drop": cathode_drop_v, "load": load_ohm, "plasma": plasma, "ohm": resistance_ohm_per_m, "wide": diameter_m}
    for k in range(PLACES):
        for j in range(TURNS):
            along = float(np.dot(np.cross(winds[k], fields[k, j]), up[k]))
            emf[k, j] = along * length_m
            current[k, j] = _bare(along, length_m, electrons[k], **circuit)
            force = current[k, j] * length_m * np.cross(up[k], fields[k, j])
            drag[k, j] = -force @ velocity_i[k] / np.linalg.norm(velocity_i[k])
    speed = np.sqrt(EARTH_GM_M3_S2 / radius)
    rate = -2.0 * radius**2 * speed * drag.mean() / (EARTH_GM_M3_S2 * mass_kg)
    dims = ("place", "turn")
    return xr.Dataset(
        {
            "emf": (dims, emf, {"units": "V"}),
            "current": (dims, current, {"units": "A"}),
            "drag": (dims, drag, {"units": "N"}),
            "altitude_rate": ((), rate, {"units": "m s-1"}),
            "power": ((), float(drag.mean() * speed), {"units": "W"}),
        },
        coords={"place": 2.0 * np.pi * np.arange(PLACES) / PLACES, "turn": 2.0 * np.pi * np.arange(TURNS) / TURNS},
    )


def descent_time(
    from_altitude_m: float, to_altitude_m: float, inclination_rad: float, plasma, *, steps: int = 6, **line
) -> float:
    """Time [s] of equation (2), Gauss-Legendre over `steps` altitudes; further arguments as `bare_decay`.

    Raises InputError where the line does not pull down at one of them.
    """
    if not from_altitude_m > to_altitude_m > 0.0:
        raise InputError(f"the altitudes must fall: from {from_altitude_m} m to {to_altitude_m} m")
    nodes, weights = np.polynomial.legendre.leggauss(steps)
    half = 0.5 * (from_altitude_m - to_altitude_m)
    total = 0.0
    for node, weight in zip(nodes, weights, strict=True):
        height = to_altitude_m + half * (1.0 + node)
        rate = float(bare_decay(height, inclination_rad, plasma, **line)["altitude_rate"])
        if rate >= 0.0:
            raise InputError(
                f"the line does not pull down at {1e-3 * height:.0f} km: on an orbit that goes west it raises nothing."
            )
        total += half * weight / -rate
    return float(total)


def _orbit(radius: float, inclination: float, raan: float):
    """Places [m], velocities [m/s] and directions up over one orbit, (PLACES, 3) each, inertial axes."""
    u = 2.0 * np.pi * np.arange(PLACES) / PLACES
    node = np.array([np.cos(raan), np.sin(raan), 0.0])
    ahead = np.array([-np.sin(raan) * np.cos(inclination), np.cos(raan) * np.cos(inclination), np.sin(inclination)])
    up = np.cos(u)[:, None] * node + np.sin(u)[:, None] * ahead
    forward = np.cos(u)[:, None] * ahead - np.sin(u)[:, None] * node
    return radius * up, np.sqrt(EARTH_GM_M3_S2 / radius) * forward, up


def _along(place_i, velocity_i, plasma, time_utc, field: str):
    """Fields (PLACES, TURNS, 3) [T] as the Earth turns below, winds (PLACES, 3) [m/s], electrons (PLACES,) [1/m^3]."""
    from fieldline.environment.field import magnetic_field
    from fieldline.environment.plasma import electron_density
    from fieldline.environment.sun import sun_position_i

    when = np.datetime64(time_utc, "ns")
    wind = velocity_i - EARTH_ROTATION_RATE_RAD_S * np.cross([0.0, 0.0, 1.0], place_i)
    turned = np.empty((PLACES, TURNS, 3))
    for j, angle in enumerate(2.0 * np.pi * np.arange(TURNS) / TURNS):
        c, s = np.cos(angle), np.sin(angle)
        dcm_ei = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        turned[:, j] = magnetic_field(place_i @ dcm_ei.T, when, model=field) @ dcm_ei
    sun = np.broadcast_to(sun_position_i(when), place_i.shape)
    return turned, wind, electron_density(place_i, sun, plasma)


def _bare(along: float, length: float, electrons: float, *, drop, load, plasma, ohm, wide) -> float:
    """Mean current [A], upwards positive, of a line in a field of `along` [V/m]; the cathode is at the lower end."""
    from fieldline.dynamics.lines.bare import bare_currents, bare_work, gathering

    piece = length / SEGMENTS
    emf, gather = np.full(SEGMENTS, along * piece), np.full(SEGMENTS, gathering(wide, electrons) * piece)
    out = np.empty(SEGMENTS)
    ohms = np.full(SEGMENTS, max(ohm, 1e-12) * piece)
    bare_currents(emf, ohms, gather, False, drop, load, plasma.temperature_ev, 16.0, bare_work(SEGMENTS), out)
    return float(out.mean())
