"""The 1978 program's surroundings of masses, as loads for the plant: its own oblateness, air and mass anomaly.

    F / m = J2 in the equator of the inertial axes                                                          (1)
          - G dm (x - x_a) / |x - x_a|^3,  G dm = dg (R_E pi / 180)^2 / (2 pi)       gravity anomaly           (2)
          - C_d A rho0 exp(-(h - h0) / H) |v| v / (2 m),  h = r - R_E                drag                      (3)

The air does not turn with the Earth, and the anomaly does not either: the annex computes both in inertial axes. (2) is the
pull of a point that would give dg [1 Gal = 0.01 m/s^2] as a disc of one square degree does; the annex names its input and
not its formula.

GM = 3.986013e14 m^3/s^2 and R_E = 6378.0 km are not printed. They follow from the printed orbital rate and tension of the
spinning test case, both of which they give to the tenth digit, and no other common pair does.
"""

from __future__ import annotations

from math import exp, pi, sqrt

import numpy as np
from numba import njit

from fieldline.cases.erbs_like import number
from fieldline.errors import InputError, nearest
from fieldline.frames.attitude import to_body, to_inertial
from fieldline.frames.vectors import add, cross, dot, norm, scale, sub

GM_M3_S2 = 3.986013e14
EARTH_RADIUS_M = 6378.0e3
J2 = 1.08263e-3
MGAL_M_S2 = 1e-5
NO_AIR = {"drag_area_m2": 0.0, "density_kg_m3": 0.0, "reference_height_m": 0.0, "scale_height_m": 1.0}
NO_ANOMALY = {"anomaly_mgal": 0.0, "anomaly_x_m": EARTH_RADIUS_M, "anomaly_y_m": 0.0, "anomaly_z_m": 0.0}


@njit(cache=True)
def oblateness(place, j2):
    """Acceleration [m/s^2] of J2 at a place (tuple) [m]; the pole is z."""
    square = dot(place, place)
    size = 1.5 * j2 * GM_M3_S2 * EARTH_RADIUS_M * EARTH_RADIUS_M / (square * square * sqrt(square))
    polar = 5.0 * place[2] * place[2] / square
    return (size * (polar - 1.0) * place[0], size * (polar - 1.0) * place[1], size * (polar - 3.0) * place[2])


@njit(cache=True)
def anomaly_pull(place, anomaly_place, anomaly):
    """Acceleration [m/s^2] of (2) of an anomaly dg [m/s^2] at a point of the ground."""
    away = sub(place, anomaly_place)
    degree = EARTH_RADIUS_M * pi / 180.0
    return scale(-anomaly * degree * degree / (2.0 * pi * norm(away) ** 3), away)


@njit(cache=True)
def drag(place, velocity, area, density, reference, scale_height):
    """Force [N] of (3); `area` is C_d A [m^2]."""
    height = sqrt(dot(place, place)) - EARTH_RADIUS_M
    push = 0.5 * area * density * exp(-(height - reference) / scale_height)
    return scale(-push * norm(velocity), velocity)


@njit(cache=True)
def pull_at(place, parameters):
    """Acceleration [m/s^2] of (1) and (2) at a place [m]; `parameters` in the order of `load_parameters`."""
    pull = (0.0, 0.0, 0.0)
    if parameters[1] != 0.0:
        pull = oblateness(place, parameters[1])  # (1)
    if parameters[2] != 0.0:
        there = (parameters[3], parameters[4], parameters[5])
        pull = add(pull, anomaly_pull(place, there, MGAL_M_S2 * parameters[2]))  # (2)
    return pull


@njit(cache=True)
def push_on(mass, place, velocity, parameters):
    """Force [N] of (1) to (3) on a mass [kg] at a place; the mass among `parameters` plays no part."""
    force = scale(mass, pull_at(place, parameters))
    if parameters[6] != 0.0:
        push = drag(place, velocity, parameters[6], parameters[7], parameters[8], parameters[9])
        force = add(push, force)  # (3)
    return force


@njit(cache=True)
def surroundings_of_1978(t, state, parameters):
    """Force [N] and torque [N m] on a body: (1) to (3), a compiled load of the user's. `load_parameters` gives parameters.

    Half a segment of a line with mass sits at the attachment: (1) and (2) act on it there, and turn the body by the lever.
    """
    place, velocity = (state[0], state[1], state[2]), (state[3], state[4], state[5])
    force = push_on(parameters[0], place, velocity, parameters)
    torque = (0.0, 0.0, 0.0)
    if parameters[10] != 0.0:
        q_bi = (state[6], state[7], state[8], state[9])
        lever = (parameters[11], parameters[12], parameters[13])
        weight = scale(parameters[10], pull_at(add(place, to_inertial(q_bi, lever)), parameters))
        force, torque = add(force, weight), cross(lever, to_body(q_bi, weight))
    out = np.zeros(6)
    out[0], out[1], out[2] = force
    out[3], out[4], out[5] = torque
    return out


@njit(cache=True)
def surroundings_of_a_node(t, state, parameters):
    """Force [N] on a node of a line, whose mass comes with its state: (1) to (3), a compiled load of the user's."""
    force = push_on(state[7], (state[0], state[1], state[2]), (state[3], state[4], state[5]), parameters)
    out = np.zeros(6)
    out[0], out[1], out[2] = force
    return out


def load_parameters(
    mass_kg: float, *, j2: float = 0.0, anomaly=None, air=None, end_mass_kg: float = 0.0, lever_b_m=(0.0, 0.0, 0.0)
) -> dict[str, float]:
    """The parameters of `surroundings_of_1978`, in its order; those of `surroundings_of_a_node`, which has no mass of its own.

    anomaly, air : every key of NO_ANOMALY and of NO_AIR, or None. end_mass_kg, lever_b_m : half a segment at the attachment.
    Errors: InputError for others, missing ones, no numbers.
    """
    whole = _whole("anomaly", anomaly, NO_ANOMALY) | _whole("air", air, NO_AIR)
    if whole["scale_height_m"] <= 0.0:
        raise InputError(f'air["scale_height_m"] must be positive; got {whole["scale_height_m"]:g}.')
    lever = dict(zip(("lever_x_m", "lever_y_m", "lever_z_m"), map(float, lever_b_m), strict=True))
    return {"mass_kg": float(mass_kg), "j2": j2} | whole | {"end_mass_kg": float(end_mass_kg)} | lever


def _whole(name: str, given, pattern: dict[str, float]) -> dict[str, float]:
    """The given numbers in the pattern's order, or the pattern."""
    if given is None:
        return pattern
    if not isinstance(given, dict):
        raise InputError(f"{name} must be a dict of {', '.join(pattern)}, or None; got {given!r}.")
    for key in given:
        if key not in pattern:
            raise InputError(f'unknown key "{key}" in {name}; {nearest(str(key), pattern)}')
    missing = [key for key in pattern if key not in given]
    if missing:
        raise InputError(f"{name} lacks {', '.join(missing)}; give {', '.join(pattern)}.")
    return {key: number(f'{name}["{key}"]', given[key], -1e12, 1e12) for key in pattern}
