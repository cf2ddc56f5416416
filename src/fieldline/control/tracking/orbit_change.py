"""`orbit-by-current`: size and inclination of an orbit changed by currents, each where in the orbit it helps most.

    S_k = L_k x B . (w_a (a1 - a) / (da^2) 2/n t  +  w_i (i1 - i)/(di^2) cos u/(n a) h)             (1)
    I_k = limit_k clip(S_k / (s |S|), -1, 1)                                                        (2)

t, h: along the velocity and the orbit's normal; u: argument of latitude; a1, i1: what is wanted, da, di: errors that are as
bad as each other; |S|: the size that S_k has for an error of one da; s: softness. (1) is the part of the current in the
fall of ((a1 - a)/da)^2 + ((i1 - i)/di)^2: every current takes from it. To turn the plane at one height, vertical
conductors push ahead in two quarters of an orbit and back in the others; nobody has to say so: it follows as a drifts.

limit_k is the conductor's own, and what a plasma contact takes: less in the Earth's shadow, a cylinder, about a Sun that goes
on by 360 degrees a year.

Osculating a and i swing by the oblateness (9 km, 0.01 deg in low orbit): what is below that is not told apart.
Source: Gauss's equations for small eccentricity, Vallado (2013), Fundamentals of Astrodynamics, 4th ed., s. 9.3.2.
"""

from __future__ import annotations

from math import acos, cos, pi, radians, sin, sqrt

import numpy as np
from numba import njit

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2, SECONDS_PER_DAY
from fieldline.control.law import Law, Parameter, complete
from fieldline.control.orbital_axes import argument_of_latitude
from fieldline.control.readings import attitude_known, finite3, lifted, orbit_known
from fieldline.errors import InputError
from fieldline.frames.attitude import to_body
from fieldline.frames.vectors import axpy, cross, dot, norm, scale, unit

AXIS, TILT, AXIS_SIZE, TILT_SIZE, SOFTNESS, CONDUCTORS, DARK, SUN, WIRES = 0, 1, 2, 3, 4, 5, 6, 7, 10  # SUN (3)
# then wire (3) and limit of each conductor
ECLIPTIC_POLE_I = (0.0, -sin(radians(23.4393)), cos(radians(23.4393)))
SUN_RATE_RAD_S = 2.0 * pi / (365.2422 * SECONDS_PER_DAY)
SMALL_TESLA, LIMITLESS = 1e-12, 1e30


@njit(cache=True, error_model="numpy")
def pull(a, i, u, field_h, wire_h, params):
    """S of equation (1), in parts of what an error of one size is worth per metre and tesla; axes h: up, along, across."""
    gm = EARTH_GM_M3_S2
    n = sqrt(gm / a**3)
    push = cross(wire_h, field_h)
    by_axis = (params[AXIS] - a) / params[AXIS_SIZE] ** 2 * 2.0 / n * push[1]
    by_tilt = (params[TILT] - i) / params[TILT_SIZE] ** 2 * cos(u) / (n * a) * push[2]
    return by_axis + by_tilt, 2.0 / (n * params[AXIS_SIZE]) * norm(wire_h) * norm(field_h)


@njit(cache=True, error_model="numpy")
def current_share(a, i, u, field_h, wire_h, params):
    """The clipped part of equation (2), -1 to 1."""
    wanted, size = pull(a, i, u, field_h, wire_h, params)
    if not size > 0.0:
        return 0.0
    return min(max(wanted / (params[SOFTNESS] * size), -1.0), 1.0)


@njit(cache=True, error_model="numpy")
def contact_limit(t, r_i, params):
    """Most current [A] of a contact in the shadow at r_i [m], t [s] after the Sun stood at SUN; infinite in the light."""
    first = (params[SUN], params[SUN + 1], params[SUN + 2])
    angle = SUN_RATE_RAD_S * t
    sun = axpy(sin(angle), cross(ECLIPTIC_POLE_I, first), scale(cos(angle), first))
    along = dot(r_i, sun)
    dark = along < 0.0 and norm(axpy(-along, sun, r_i)) < EARTH_EQUATORIAL_RADIUS_M
    return params[DARK] if dark else LIMITLESS


@njit(cache=True, error_model="numpy")
def orbit_by_current(t, measurement, memory, params):
    """Currents [A] of equation (2)."""
    count = int(params[CONDUCTORS])
    out = np.zeros(count)
    field_i = lifted(measurement.field_i)
    if not (orbit_known(measurement) and attitude_known(measurement) and finite3(field_i)):
        return out
    r, v = lifted(measurement.position_i), lifted(measurement.velocity_i)
    energy = 0.5 * dot(v, v) - EARTH_GM_M3_S2 / norm(r)
    if not energy < 0.0 or norm(field_i) < SMALL_TESLA:
        return out
    a, normal = -0.5 * EARTH_GM_M3_S2 / energy, unit(cross(r, v))
    i, u = acos(min(max(normal[2], -1.0), 1.0)), argument_of_latitude(r, v)
    q = (measurement.q_bi[0], measurement.q_bi[1], measurement.q_bi[2], measurement.q_bi[3])
    up, ahead = to_body(q, unit(r)), to_body(q, cross(normal, unit(r)))
    across, field_b = to_body(q, normal), to_body(q, field_i)
    field_h = (dot(up, field_b), dot(ahead, field_b), dot(across, field_b))
    most = contact_limit(t, r, params)
    for k in range(count):
        at = WIRES + 4 * k
        wire = (params[at], params[at + 1], params[at + 2])
        wire_h = (dot(up, wire), dot(ahead, wire), dot(across, wire))
        out[k] = min(params[at + 3], most) * current_share(a, i, u, field_h, wire_h, params)
    memory[0] = t
    return out


PARAMETERS = {
    "altitude_km": Parameter("km", "wanted semi-major axis less 6378.1366 km", 400.0, "positive"),
    "inclination_deg": Parameter("deg", "wanted inclination; derived as that at the start", kind="not negative", derived=True),
    "altitude_size_km": Parameter("km", "error of the semi-major axis that is as bad as inclination_size_deg", 10.0, "positive"),
    "inclination_size_deg": Parameter("deg", "error of the inclination that is", 0.1, "positive"),
    "softness": Parameter("", "errors, in such sizes, below which less than full current flows", 0.1, "positive"),
    "contact_limit_a": Parameter("A", "most current that a plasma contact takes; 0 is no limit", 0.0, "not negative"),
    "contact_dark_a": Parameter(
        "A",
        "the same in the Earth's shadow, for which sun_i is needed; derived as in the light",
        kind="not negative",
        derived=True,
    ),
    "sun_i": Parameter("", "direction of the Sun at the start, GCRS; derived as none", kind="vector", derived=True),
}


def transfer_row(values: dict, conductors, inclination_rad: float) -> np.ndarray:
    """The law's numbers for checked values and conductors."""
    tilt = inclination_rad if values["inclination_deg"] is None else np.radians(values["inclination_deg"])
    most = values["contact_limit_a"] or np.inf
    rows = [[*(one.length_m * np.array(one.direction_b)), min(one.current_max_a, most)] for one in conductors]
    axis = EARTH_EQUATORIAL_RADIUS_M + 1e3 * values["altitude_km"]
    sizes = 1e3 * values["altitude_size_km"], np.radians(values["inclination_size_deg"])
    dark, sun = values.get("contact_dark_a"), values.get("sun_i")
    if (dark is None) != (sun is None) or (sun is not None and not np.linalg.norm(sun) > 0.0):
        raise InputError("contact_dark_a and sun_i, a direction, belong together: the shadow is where the Sun is not. Give both.")
    shadow = [LIMITLESS, 0.0, 0.0, 0.0] if dark is None else [dark, *(np.asarray(sun) / np.linalg.norm(sun))]
    return np.concatenate([[axis, tilt, *sizes, values["softness"], len(rows), *shadow], np.ravel(rows)])


def _pack(table, context) -> np.ndarray:
    values = complete("orbit-by-current", PARAMETERS, table)
    if not context.conductors:
        raise InputError('the law "orbit-by-current" needs a body with [[body.conductor]]; it has none.')
    return transfer_row(values, context.conductors, context.inclination_rad)


LAWS = (
    Law(
        "orbit-by-current",
        orbit_by_current,
        PARAMETERS,
        1,
        ("current",),
        "changes height and inclination of an orbit by currents",
        _pack,
        reference=True,
    ),
)
