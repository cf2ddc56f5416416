"""Gains of the magnetic regulators: weights a person can name, the model about the goal, the Riccati solution.

Bryson's rule: each weight is one over the square of the size that is as bad as the others,

    Q = diag(1/angle^2, 1/rate^2, 1/(angle T)^2),   R = 1/moment^2                                 (39)

with T the integral's time. A constant torque c in the goal's axes, once estimated, is met by what the same cost finds best
over the whole orbit, part of it where the field allows and in advance of where it does not: the costate is P x + S c with

    -dS/dt = (a - b r^-1 b' P)' S + P (0, J^-1),   S periodic                                       (40)

See `magnetic_regulator` for the three designs (36) to (38).
"""

from __future__ import annotations

import numpy as np

from fieldline.constants import EARTH_ROTATION_RATE_RAD_S
from fieldline.control import magnetic_regulator, residual_dipole, target
from fieldline.control.law import Law, Parameter, complete
from fieldline.control.linear_attitude import attitude_matrix, cross_matrix, moment_matrix, with_integral
from fieldline.control.periodic_system import continuous_steps, disturbance_costate, periodic_solution, product, reach
from fieldline.control.residual_dipole import packed_filter, packed_wheels
from fieldline.control.target import packed_target
from fieldline.errors import InputError
from fieldline.frames.attitude import dcm_from_quaternion

NODES = 90  # of an orbit: 4 degrees
CONSTANT_STEP_S = 60.0  # of a design with constant coefficients: any step gives the same

PARAMETERS = {
    **target.PARAMETERS,
    "angle_deg": Parameter("deg", "pointing error that weighs as much as each of the others", 2.0, "positive"),
    "rate_deg_s": Parameter("deg/s", "rate error that does; derived as 3 n angle", kind="positive", derived=True),
    "moment_a_m2": Parameter(
        "A m^2", "moment that does; derived as a tenth of the torquers' least", kind="positive", derived=True
    ),
    "integral_time_s": Parameter("s", "T of the integral of the error; 0 is none", 0.0, "not negative"),
    "orbits": Parameter("", "after how many orbits the gains repeat; derived as a day's, or 1", kind="positive", derived=True),
    "integral_limit_deg": Parameter("deg", "no integration beyond this error", 5.0, "positive"),
    "momentum_n_m_s": Parameter(
        "N m s", "constant momentum of a wheel that the design counts on, body axes", (0.0, 0.0, 0.0), "vector"
    ),
    "moment_max_a_m2": Parameter("A m^2", "largest moment per axis; derived from the torquers", kind="vector", derived=True),
    **residual_dipole.CANCEL_PARAMETERS,
}


def fold(seconds, field, mean_motion_rad_s: float, orbits: int = 1, nodes: int = NODES) -> np.ndarray:
    """(orbits * nodes, 3) [T]: a field (n, 3) along an orbit at equal steps of phase from t = 0, repeating after `orbits`.

    What is longer is averaged over its whole repetitions. Errors: `InputError` for less than one.
    """
    turns = np.asarray(seconds, dtype=float) * mean_motion_rad_s / (2.0 * np.pi)
    first = np.ceil(turns[0] - 1e-9)
    whole = int(np.floor((turns[-1] - first) / orbits + 1e-2))
    if whole < 1:
        raise InputError(
            f"a regulator that repeats after {orbits} orbits needs their field; it covers {turns[-1] - turns[0]:.2f}."
        )
    at = (first + np.arange(whole * orbits * nodes) / nodes).ravel()
    along = np.stack([np.interp(at, turns, np.asarray(field)[:, j]) for j in range(3)], axis=-1)
    return np.roll(along.reshape(whole, orbits * nodes, 3).mean(axis=0), int(first) % orbits * nodes, axis=0)


def repeating_orbits(seconds, mean_motion_rad_s: float) -> int:
    """The whole number of orbits nearest to a turn of the Earth if the seconds (n,) cover it, else 1."""
    wanted = round(mean_motion_rad_s / EARTH_ROTATION_RATE_RAD_S)
    covered = (seconds[-1] - max(0.0, seconds[0])) * mean_motion_rad_s / (2.0 * np.pi)
    return wanted if covered + 1e-2 >= wanted else 1


def _goal(values: dict, context):
    """Linear model about the goal, and the field along the orbit in the goal's axes."""
    seconds, field_o, field_i = context.field_along_orbit()
    nadir = values["target"] == "nadir"
    turn = dcm_from_quaternion(values["attitude"])
    rate_b = turn @ np.array([0.0, -context.mean_motion_rad_s * nadir, 0.0])
    down = turn @ np.array([0.0, 0.0, 1.0]) if nadir else None
    a = attitude_matrix(context.inertia_kg_m2, rate_b, down, values["momentum_n_m_s"])
    return a, seconds, np.asarray(field_o if nadir else field_i) @ turn.T


def _weights(values: dict, field, context) -> tuple[np.ndarray, float]:
    """Diagonal of Q and the moment m of (39)."""
    angle = np.radians(values["angle_deg"])
    rate = 3.0 * angle * context.mean_motion_rad_s if values["rate_deg_s"] is None else np.radians(values["rate_deg_s"])
    moment = values["moment_a_m2"]
    if moment is None:
        stiffness = float(np.linalg.eigvalsh(context.inertia_kg_m2)[-1]) * context.mean_motion_rad_s**2
        moment = 3.0 * stiffness * angle / float(np.sqrt(np.mean(np.sum(field**2, axis=1))))
    q = [angle**-2.0] * 3 + [rate**-2.0] * 3
    if values["integral_time_s"] > 0.0:
        q += [(angle * values["integral_time_s"]) ** -2.0] * 3
    return np.array(q), moment


def _solved(law: str, a, g, q, inertia, period_s: float) -> np.ndarray:
    """(N, 3, n + 3): the rows of w of P and, for a constant torque in the goal's axes, of its costate (40)."""
    count, n = g.shape[0], g.shape[1]
    steps, factor = continuous_steps(np.broadcast_to(a, (count, n, n)), g, np.broadcast_to(q, (count, n, n)), period_s)
    P, closed, residual, doublings = periodic_solution(steps)
    if doublings < 0 or residual > 1e-6 or np.abs(np.linalg.eigvals(product(closed))).max() >= 1.0:
        raise InputError(
            f'the law "{law}" finds no regulator that holds the attitude with these weights. Give the moment more weight '
            "(moment_a_m2 larger), or check inertia and target; an orbit along the magnetic equator leaves an axis unheld."
        )
    step = period_s / count
    push = np.zeros((count, n, 3))
    push[:, 3:6] = step * np.linalg.inv(inertia)
    push[:, :3] = 0.5 * step * push[:, 3:6]
    costate = disturbance_costate(P, closed, push)
    return np.concatenate([P, costate], axis=2)[:, 3:6, :] / factor


def _model(a, b, integrates: bool):
    return with_integral(a, b) if integrates else (a, b)


def _periodic(law, a, seconds, field, q, moment, orbits, context) -> np.ndarray:
    """(36): gains (N, 3, n + 3)."""
    b = moment_matrix(context.inertia_kg_m2, fold(seconds, field, context.mean_motion_rad_s, orbits))
    a, b = _model(a, b, len(q) == 9)
    g = reach(b, np.eye(3) / moment**2)
    rows = _solved(law, a, g, q, context.inertia_kg_m2, 2.0 * np.pi * orbits / context.mean_motion_rad_s)
    return moment**2 * np.linalg.solve(context.inertia_kg_m2, rows)


def _asymptotic(law, a, seconds, field, q, moment, orbits, context) -> np.ndarray:
    """(37): gains (1, 3, n + 3)."""
    a, b = _model(a, moment_matrix(context.inertia_kg_m2, field), len(q) == 9)
    g = reach(b, np.eye(3) / moment**2).mean(axis=0, keepdims=True)
    rows = _solved(law, a, g, q, context.inertia_kg_m2, CONSTANT_STEP_S)
    return moment**2 * np.linalg.solve(context.inertia_kg_m2, rows)


def _averaged(law, a, seconds, field, q, moment, orbits, context) -> np.ndarray:
    """(38): gains (1, 3, n + 3)."""
    square = np.sum(field**2, axis=1)
    across = (-(cross_matrix(field) @ cross_matrix(field)) / square[:, None, None]).mean(axis=0)  # of I - B B'/B^2
    b = np.zeros((6, 3))
    b[3:] = np.linalg.solve(context.inertia_kg_m2, across)
    a, b = _model(a, b, len(q) == 9)
    torque = moment**2 * float(square.mean())
    rows = _solved(law, a, torque * (b @ b.T)[None], q, context.inertia_kg_m2, CONSTANT_STEP_S)
    return torque * across @ np.linalg.solve(context.inertia_kg_m2, rows)


def _pack(law: str, design, table, context) -> np.ndarray:
    """Checked, designed, and laid out for the kernel."""
    values = complete(law, PARAMETERS, table)
    a, seconds, field = _goal(values, context)
    q, moment = _weights(values, field, context)
    orbits = repeating_orbits(seconds, context.mean_motion_rad_s) if values["orbits"] is None else max(1, round(values["orbits"]))
    gains = design(law, a, seconds, field, np.diag(q), moment, orbits, context)
    rows = np.zeros((gains.shape[0], 3, 12))
    rows[:, :, : len(q)], rows[:, :, 9:] = gains[:, :, :-3], gains[:, :, -3:]
    most = context.moment_max_a_m2 if values["moment_max_a_m2"] is None else values["moment_max_a_m2"]
    integral = (float(values["integral_time_s"] > 0.0), np.radians(values["integral_limit_deg"]))
    head = (context.mean_motion_rad_s, float(rows.shape[0]), float(orbits), float(design is _averaged), *integral, *most)
    filter_numbers = packed_filter(values, context, values["cancel_residual"])
    wheels = packed_wheels(context)
    table_at = magnetic_regulator.WHEELS + wheels.size
    return np.concatenate([packed_target(values), head, filter_numbers, [table_at], wheels, rows.ravel()])


def _pack_periodic(table, context) -> np.ndarray:
    return _pack("magnetic-lqr-periodic", _periodic, table, context)


def _pack_asymptotic(table, context) -> np.ndarray:
    return _pack("magnetic-lqr-asymptotic", _asymptotic, table, context)


def _pack_averaged(table, context) -> np.ndarray:
    return _pack("magnetic-lqr-averaged", _averaged, table, context)


def _law(name: str, doc: str, pack) -> Law:
    return Law(name, magnetic_regulator.magnetic_regulator, PARAMETERS, magnetic_regulator.MEMORY, ("dipole",), doc, pack)


LAWS = (
    _law("magnetic-lqr-periodic", "holds three axes by the field alone, gains over the orbit", _pack_periodic),
    _law("magnetic-lqr-asymptotic", "the same with constant gains of the averaged Riccati equation", _pack_asymptotic),
    _law("magnetic-lqr-averaged", "the same with constant gains of the averaged projection", _pack_averaged),
)
