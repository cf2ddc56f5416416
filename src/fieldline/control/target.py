"""Where a pointing law points: an attitude fixed in inertial space, or one fixed in the orbital axes.

    q_ti    attitude of the goal's axes: `attitude` itself (inertial) or q_oi * `attitude` (nadir)
    theta   rotation vector [rad], body axes, from the goal to the body: q_bi = q_ti * exp(theta / 2)      (26)
    w       omega_bi_b - A(q_bt) omega_ti_t, the body's rate against the goal, body axes                   (27)

Five numbers of a law's params hold the target: 1 for nadir or 0 for inertial, then the quaternion, scalar last.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fieldline.control.law import Parameter
from fieldline.control.orbital_axes import orbital_attitude, orbital_rate
from fieldline.control.readings import attitude_known, lifted, orbit_known, rate_known
from fieldline.frames.attitude import quat_conj, quat_mul, quat_unit, rotation_vector, to_body
from fieldline.frames.vectors import sub

SIZE = 5
ZERO = (0.0, 0.0, 0.0)

PARAMETERS = {
    "target": Parameter(
        "",
        '"inertial" (fixed among the stars) or "nadir" (fixed in orbital axes)',
        "inertial",
        "choice",
        choices=("inertial", "nadir"),
    ),
    "attitude": Parameter(
        "", "goal's quaternion (x, y, z, w) in those axes; v_axes = q v_body q*", (0.0, 0.0, 0.0, 1.0), "quaternion"
    ),
}


def packed_target(values: dict) -> np.ndarray:
    """The five numbers, from checked parameters."""
    return np.array([float(values["target"] == "nadir"), *values["attitude"]])


@njit(cache=True)
def pointing_error(measurement, params, first):
    """(known, theta, w, goal's rate in body axes [rad/s]) of equations (26) and (27); params from `first` on."""
    nadir = params[first] > 0.5
    if not (attitude_known(measurement) and rate_known(measurement)) or (nadir and not orbit_known(measurement)):
        return False, ZERO, ZERO, ZERO
    q = measurement.q_bi
    q_bi = quat_unit((q[0], q[1], q[2], q[3]))
    goal = (params[first + 1], params[first + 2], params[first + 3], params[first + 4])
    rate_i = ZERO
    if nadir:
        q_oi = orbital_attitude(lifted(measurement.position_i), lifted(measurement.velocity_i))
        rate_i = orbital_rate(lifted(measurement.position_i), lifted(measurement.velocity_i))
        goal = quat_mul(q_oi, goal)
    theta = rotation_vector(quat_mul(quat_conj(goal), q_bi))  # (26)
    rate_b = to_body(q_bi, rate_i)
    return True, theta, sub(lifted(measurement.omega_bi_b), rate_b), rate_b  # (27)
