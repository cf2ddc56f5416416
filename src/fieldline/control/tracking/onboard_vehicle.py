"""What the flight software of a tracking vehicle knows of itself: motion, controls, limits, as one row of numbers.

A control is a conductor, or a pair of opposite thrusters (one signed number), or a single thruster (which only pushes). The
row: header, path (`approach_path`), what the motion does by itself (6 x 12), then WIDTH numbers a control. The law's own
numbers follow from `law_at` on.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit

from fieldline.control.tracking.allocation import power_costs
from fieldline.errors import InputError, nearest, shown
from fieldline.frames.vectors import cross
from fieldline.mechanics.relative_motion import motion_matrix

(CONTROLS, CONDUCTORS, THRUSTERS, MEAN_MOTION, RADIUS, FACTOR, BY_READING, TARGET, SETTLE) = range(9)
ANGLES, WEIGHT, SHARE, POWER_MAX, MASS = 9, 12, 18, 19, 20  # angles (3), weights of loads (6), mass and inertia (6)
FILTER = 26
REACH = 27  # (3) errors of place beyond which the law wants no more
PATH = 30
MOTION = PATH + 9
TABLE = MOTION + 72
WIRE, POINT, IS_THRUSTER, LOWER, UPPER, COST, RESISTANCE, FORWARD, BACKWARD = 0, 3, 6, 7, 8, 9, 10, 11, 12
WIDTH = 13


@njit(cache=True, error_model="numpy")
def law_at(params):
    """Where the law's own numbers begin."""
    return TABLE + WIDTH * int(params[CONTROLS])


@njit(cache=True, error_model="numpy")
def effect_of(params, field_b, out):
    """Fill out (6, m): force [N] and moment [N m] of each control, body axes, in field_b [T]."""
    for k in range(int(params[CONTROLS])):
        at = TABLE + WIDTH * k
        along = (params[at + WIRE], params[at + WIRE + 1], params[at + WIRE + 2])
        place = (params[at + POINT], params[at + POINT + 1], params[at + POINT + 2])
        push = along if params[at + IS_THRUSTER] > 0.5 else cross(along, field_b)
        lever = cross(place, push)
        for j in range(3):
            out[j, k] = push[j]
            out[3 + j, k] = lever[j]


@njit(cache=True, error_model="numpy")
def column_of(params, which, out):
    """One number of every control into out (m,)."""
    for k in range(out.shape[0]):
        out[k] = params[TABLE + WIDTH * k + which]


@njit(cache=True, error_model="numpy")
def commanded(params, u, out):
    """Thrusts (0 to 1), then currents [A], into out, from the controls u (m,)."""
    thrusters = int(params[THRUSTERS])
    for k in range(out.shape[0]):
        out[k] = 0.0
    for k in range(u.shape[0]):
        at = TABLE + WIDTH * k
        if params[at + IS_THRUSTER] < 0.5:
            out[thrusters + int(params[at + FORWARD])] = u[k]
            continue
        if u[k] > 0.0:
            out[int(params[at + FORWARD])] = min(1.0, u[k] / params[at + UPPER])
        elif u[k] < 0.0:
            out[int(params[at + BACKWARD])] = min(1.0, u[k] / params[at + LOWER])


def controls_of(conductors: Sequence, thrusters: Sequence, failed=(), resistance_ohm: float = 0.0):
    """(rows (m, WIDTH), names (m,)) of the controls; `failed` are names of conductors and thrusters that do nothing.

    Thrusters of one line and opposite directions become one signed control.
    """
    wires = [one.name or f"conductor_{k}" for k, one in enumerate(conductors, start=1)]
    jets = [one.name or f"thruster_{k}" for k, one in enumerate(thrusters, start=1)]
    for one in failed:
        if one not in wires + jets:
            raise InputError(f'failed names neither a conductor nor a thruster: "{shown(one)}"; {nearest(one, wires + jets)}')
    rows, names = [], []
    for k, (name, one) in enumerate(zip(wires, conductors, strict=True)):
        limit = 0.0 if name in failed else one.current_max_a
        wire = one.length_m * np.array(one.direction_b)
        rows.append([*wire, *one.position_b_m, 0.0, -limit, limit, 1.0, one.resistance_ohm + resistance_ohm, k, -1.0])
        names.append(name)
    taken: set[int] = set()
    for k, one in enumerate(thrusters):
        if k in taken:
            continue
        partner = next((j for j in range(k + 1, len(thrusters)) if j not in taken and _opposite(one, thrusters[j])), -1)
        force = 0.0 if jets[k] in failed else one.force_n
        back = 0.0 if partner < 0 or jets[partner] in failed else thrusters[partner].force_n
        rows.append([*one.direction_b, *one.position_b_m, 1.0, -back, force, 1.0, 0.0, k, partner])
        names.append(jets[k] if partner < 0 else f"{jets[k]}/{jets[partner]}")
        taken |= {k, partner}
    table = np.array(rows, dtype=float).reshape(-1, WIDTH)
    wired = table[:, IS_THRUSTER] < 0.5
    table[wired, COST] = power_costs(table[wired, RESISTANCE], table[wired, LOWER], table[wired, UPPER])
    return table, names


def _opposite(one, other) -> bool:
    """Whether two thrusters push along one line, either way."""
    along, gap = np.array(one.direction_b), np.array(other.position_b_m) - np.array(one.position_b_m)
    return bool(np.dot(along, other.direction_b) < -1.0 + 1e-9 and np.linalg.norm(np.cross(gap, along)) < 1e-6)


def motion_rows(mean_motion: float, radius: float, inertia) -> np.ndarray:
    """(6, 12): accelerations of the motion by itself, rows of `motion_matrix`; neutral in its angles for a round body."""
    return motion_matrix(mean_motion, radius, inertia)[1::2]


def principal_inertia(law: str, inertia_kg_m2) -> np.ndarray:
    """(3,) principal moments of a body whose axes are principal; InputError for others."""
    inertia = np.asarray(inertia_kg_m2, dtype=float)
    moments = np.diag(inertia).copy()
    if np.abs(inertia - np.diag(moments)).max() > 1e-3 * moments.min():
        raise InputError(f'the law "{law}" needs principal body axes: inertia_kg_m2 without products of inertia.')
    return moments
