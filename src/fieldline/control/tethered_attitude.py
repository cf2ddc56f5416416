"""Attitude of a body that hangs on a line: its pendulum damped, and its turn about the line held.

The line pulls with T at the distance d from the centre of mass, along the unit vector f of the attachment. Across f the
body of inertia I swings like a pendulum; about f nothing holds it,

    I th'' = -T d th + N,   w_p = sqrt(T d / I)                                                            (56)
    N = -2 z sqrt(T d I) w_across - I_f (2 z w_f w_along + w_f^2 th_along)                                 (57)

w: rate against the orbital axes, th_along: pointing error about f. (57) gives the pendulum the damping ratio z whatever
the tension, which is measured. What makes the torque N [N m]:

    wheels      N
    torquers    M = B x N / B^2, without its part along B                                                  (58)
    thrusters   u = |N_x| U_x(+-) + |N_y| U_y(+-) + |N_z| U_z(+-), U the least firings for 1 N m            (59)
    attachment  moved by s: T s x f = N across f, s = (2 z / w_p) d (w x f)                                 (60)

A moved attachment cannot turn the body about the line. Where attitude or orbit is not known w is the rate against inertial
axes, and the orbit's turn makes the body lean by 2 z n / w_p. Below `tension_min_n` the line is taken for slack: the pendulum's
damping is then that of the least tension, and an attachment goes to its middle.

Source: SAO (1982), section 4, names the four means; the laws are own derivation. Valid for small swings and a line much
longer than d.
"""

from __future__ import annotations

from math import isfinite, sqrt

import numpy as np
from numba import njit

from fieldline.control import target
from fieldline.control.law import Law, Parameter, complete
from fieldline.control.orbital_axes import orbital_rate
from fieldline.control.readings import attitude_known, field_known, lifted, orbit_known, rate_known
from fieldline.control.saturation import as_command, shortened
from fieldline.control.target import packed_target, pointing_error
from fieldline.errors import InputError
from fieldline.frames.attitude import quat_unit, to_body
from fieldline.frames.vectors import axpy, cross, dot, norm, scale, sub

LINE = target.SIZE
AXIS = LINE + 1
ARM, ACROSS, ALONG, RATIO, TURN, LEAST, DEADBAND, OWN = range(AXIS + 3, AXIS + 11)
NEEDED = 1e-6  # part of a torque that thrusters may fail to give before they are said not to be able to
ZERO = (0.0, 0.0, 0.0)


@njit(cache=True)
def swing_rate(measurement):
    """(known, rate against the orbital axes [rad/s], body axes); against inertial axes where these are not known."""
    if not rate_known(measurement):
        return False, ZERO
    omega = lifted(measurement.omega_bi_b)
    if not (attitude_known(measurement) and orbit_known(measurement)):
        return True, omega
    q = measurement.q_bi
    turning = orbital_rate(lifted(measurement.position_i), lifted(measurement.velocity_i))
    return True, sub(omega, to_body(quat_unit((q[0], q[1], q[2], q[3])), turning))


@njit(cache=True)
def tension_of(measurement, params):
    """Tension of the line [N]; zero where it is not known."""
    j = int(params[LINE])
    if j >= measurement.tension.shape[0] or not isfinite(measurement.tension[j]):
        return 0.0
    return measurement.tension[j]


@njit(cache=True)
def holding_torque(measurement, params):
    """N of (57) [N m], body axes."""
    known, rate = swing_rate(measurement)
    if not known or norm(rate) < params[DEADBAND]:
        return ZERO
    f = (params[AXIS], params[AXIS + 1], params[AXIS + 2])
    along = dot(rate, f)
    tension = max(tension_of(measurement, params), params[LEAST])
    damping = 2.0 * params[RATIO] * sqrt(tension * params[ARM] * params[ACROSS])
    torque = scale(-damping, axpy(-along, f, rate))
    about = 2.0 * params[RATIO] * params[TURN] * along
    seen, theta, _, _ = pointing_error(measurement, params, 0)
    if seen:
        about += params[TURN] ** 2 * dot(theta, f)
    return axpy(-params[ALONG] * about, f, torque)


@njit(cache=True)
def by_wheels(t, measurement, memory, params):
    """(57) by wheels."""
    return as_command(holding_torque(measurement, params))


@njit(cache=True)
def by_torquers(t, measurement, memory, params):
    """(58)."""
    if not field_known(measurement):
        return as_command(ZERO)
    field = lifted(measurement.field_b)
    moment = scale(1.0 / dot(field, field), cross(field, holding_torque(measurement, params)))
    return as_command(shortened(moment, params, OWN)[0])


@njit(cache=True)
def by_thrusters(t, measurement, memory, params):
    """(59), all firings shortened alike where one would exceed the period."""
    count = int(params[OWN])
    torque = holding_torque(measurement, params)
    command = np.zeros(count)
    for axis in range(3):
        column = OWN + 1 + count * (2 * axis + (0 if torque[axis] > 0.0 else 1))
        for k in range(count):
            command[k] += abs(torque[axis]) * params[column + k]
    most = 1.0
    for k in range(count):
        most = max(most, command[k])
    return command / most


@njit(cache=True)
def by_attachment(t, measurement, memory, params):
    """(60), the place of each slider."""
    count = int(params[OWN])
    command = np.zeros(count)
    known, rate = swing_rate(measurement)
    tension = tension_of(measurement, params)
    if not known or tension < params[LEAST] or tension <= 0.0 or norm(rate) < params[DEADBAND]:
        return command
    f = (params[AXIS], params[AXIS + 1], params[AXIS + 2])
    frequency = sqrt(tension * params[ARM] / params[ACROSS])
    shift = scale(2.0 * params[RATIO] * params[ARM] / frequency, cross(rate, f))
    for k in range(count):
        for j in range(3):
            command[k] += params[OWN + 1 + 3 * k + j] * shift[j]
    return command


_PENDULUM = {
    "line": Parameter("", "number of the line among those on the body, from 1", 1.0, "positive"),
    "damping_ratio": Parameter("", "damping ratio z of the pendulum", 0.3, "positive"),
    "tension_min_n": Parameter("N", "tension below which the line is taken for slack", 0.1, "not negative"),
    "deadband_rad_s": Parameter("rad/s", "rate below which nothing is done", 0.0, "not negative"),
}
PARAMETERS = {
    **_PENDULUM,
    "turn_frequency_rad_s": Parameter("rad/s", "frequency w_f of the turn about the line", 0.02, "not negative"),
    "target": Parameter("", "where the turn about the line is held", "nadir", "choice", choices=("inertial", "nadir")),
    "attitude": target.PARAMETERS["attitude"],
}
TORQUER_PARAMETERS = {
    **PARAMETERS,
    "moment_max_a_m2": Parameter("A m^2", "largest moment per axis; derived from the torquers", kind="vector", derived=True),
}


def _packed(law: str, values: dict, context) -> np.ndarray:
    """The `OWN` first numbers, from checked parameters; InputError for a line that pulls at the centre of mass."""
    number = values["line"]
    ends = context.lines
    if number != int(number) or not 1 <= number <= max(1, len(ends)):
        raise InputError(
            f'line of the law "{law}" is the number of a line on the body, 1 to {max(1, len(ends))}; got {number:g}.'
        )
    point = np.array(ends[int(number) - 1].point_b_m if ends else (0.0, 0.0, 1.0), dtype=float)
    arm = float(np.linalg.norm(point))
    if arm == 0.0:
        raise InputError(f'the law "{law}" needs a line that is attached off the centre of mass: at it, nothing swings.')
    axis, inertia = point / arm, np.asarray(context.inertia_kg_m2, dtype=float)
    along = float(axis @ inertia @ axis)
    across = 0.5 * (float(np.trace(inertia)) - along)
    goal = packed_target({"target": "nadir", "attitude": (0.0, 0.0, 0.0, 1.0)} | values)
    gains = [values["damping_ratio"], values.get("turn_frequency_rad_s", 0.0), values["tension_min_n"], values["deadband_rad_s"]]
    return np.array([*goal, number - 1.0, *axis, arm, across, along, *gains])


def _pack_wheels(table, context) -> np.ndarray:
    return _packed("tether-wheels", complete("tether-wheels", PARAMETERS, table), context)


def _pack_torquers(table, context) -> np.ndarray:
    values = complete("tether-torquers", TORQUER_PARAMETERS, table)
    most = context.moment_max_a_m2 if values["moment_max_a_m2"] is None else values["moment_max_a_m2"]
    return np.concatenate([_packed("tether-torquers", values, context), np.asarray(most, dtype=float)])


def _pack_thrusters(table, context) -> np.ndarray:
    values = complete("tether-thrusters", PARAMETERS, table)
    firings = least_firings("tether-thrusters", context.thrusters)
    return np.concatenate([_packed("tether-thrusters", values, context), [len(context.thrusters)], firings.ravel()])


def _pack_attachment(table, context) -> np.ndarray:
    values = complete("tether-attachment", _PENDULUM, table)
    packed = _packed("tether-attachment", values, context)
    rows = []
    for k, end in enumerate(context.lines):
        axes = np.array(end.slider_axes_b, dtype=float).reshape(-1, 3)
        rows.append(np.linalg.pinv(axes.T) if k == values["line"] - 1.0 and len(axes) else np.zeros_like(axes))
    rows = np.concatenate([np.zeros((0, 3)), *rows])
    return np.concatenate([packed, [len(rows)], rows.ravel()])


def least_firings(law: str, thrusters) -> np.ndarray:
    """(6, n) shares of full thrust that give 1 N m about x, -x, y, -y, z, -z with the least impulse; n may be none.

    A direction that the thrusters cannot push alone is done as well as they can. InputError where they can do none.
    """
    from scipy.optimize import nnls

    if not thrusters:
        return np.zeros((6, 0))
    arms = np.array([one.position_b_m for one in thrusters], dtype=float)
    forces = np.array([one.force_n * np.array(one.direction_b) for one in thrusters], dtype=float)
    torques = np.cross(arms, forces).T
    wanted = [sign * np.eye(3)[axis] for axis in range(3) for sign in (1.0, -1.0)]
    found = [nnls(torques, one) for one in wanted]
    if all(left > 1.0 - NEEDED for _, left in found):
        raise InputError(f'the law "{law}" needs thrusters that turn the body; all of them push through its centre of mass.')
    return np.array([shares for shares, _ in found])


LAWS = (
    Law("tether-wheels", by_wheels, PARAMETERS, 1, ("wheel_torque",), "steadies a body on a line by wheels", _pack_wheels),
    Law(
        "tether-torquers",
        by_torquers,
        TORQUER_PARAMETERS,
        1,
        ("dipole",),
        "steadies a body on a line by the field",
        _pack_torquers,
    ),
    Law("tether-thrusters", by_thrusters, PARAMETERS, 1, ("thrust",), "steadies a body on a line by thrusters", _pack_thrusters),
    Law(
        "tether-attachment",
        by_attachment,
        _PENDULUM,
        1,
        ("attachment",),
        "damps the pendulum of a body on a line by moving the point at which it hangs",
        _pack_attachment,
    ),
)
