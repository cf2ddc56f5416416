"""A free rigid body: Euler's equation, attitude, and the torque of the gravity gradient.

    I domega/dt = N - omega x (I omega)                                                            (1)
    dq_bi/dt = 1/2 q_bi * (omega, 0)                                                               (2)
    N_gravity = 3 GM / |r|^5  r x (I r)                                                            (3)

One step advances omega by the classical Runge-Kutta rule and the attitude by the Magnus series of fourth order,

    theta = dt/2 (w0 + w1) + dt^2/12 (dw0 - dw1) + dt^2/12 (w0 x w1),   q1 = q0 * exp(theta / 2)   (4)

whose first two terms are the Hermite quadrature of omega. A constant omega is integrated without error, however large
the turn: a spinner sampled once a second needs no finer step for its spin, only for its nutation.

Local error of (4): O(dt^5) in both; a body whose rate turns at w_n in body axes loses about (w_n dt)^5 / 500 a step.
Inertia is nine floats, row by row [kg m^2]; ratios serve as well in the torque-free case, where only they matter.

Source: Markley and Crassidis (2014), s. 3.3.5 and 3.3.6.1; Iserles and Norsett (1999), Phil. Trans. R. Soc. A 357:983.
"""

from __future__ import annotations

from math import ceil

import numpy as np
from numba import njit

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError
from fieldline.frames.attitude import quat_exp, quat_mul, quat_unit
from fieldline.frames.matrices import matvec
from fieldline.frames.vectors import axpy, cross, dot, scale, sub, vec

NO_TORQUE = (0.0, 0.0, 0.0)


@njit(cache=True)
def euler_rate(omega, inertia, inertia_inv, torque):
    """domega/dt [rad/s^2] of a rate [rad/s] under a torque [N m], body axes; equation (1)."""
    return matvec(inertia_inv, sub(torque, cross(omega, matvec(inertia, omega))))


@njit(cache=True)
def rate_step(omega, dt, inertia, inertia_inv, torque):
    """Omega after dt under a torque that is constant in body axes: the classical Runge-Kutta step of (1)."""
    k1 = euler_rate(omega, inertia, inertia_inv, torque)
    k2 = euler_rate(axpy(0.5 * dt, k1, omega), inertia, inertia_inv, torque)
    k3 = euler_rate(axpy(0.5 * dt, k2, omega), inertia, inertia_inv, torque)
    k4 = euler_rate(axpy(dt, k3, omega), inertia, inertia_inv, torque)
    return axpy(dt / 6.0, axpy(2.0, k2, axpy(2.0, k3, axpy(1.0, k1, k4))), omega)


@njit(cache=True)
def turn(omega0, omega1, rate0, rate1, dt):
    """Rotation vector [rad] over dt from the rates and their derivatives at both ends; equation (4)."""
    mean = scale(0.5 * dt, axpy(1.0, omega0, omega1))
    bend = axpy(1.0, sub(rate0, rate1), cross(omega0, omega1))
    return axpy(dt * dt / 12.0, bend, mean)


@njit(cache=True)
def torqued_step(q_bi, omega, dt, inertia, inertia_inv, torque):
    """(q_bi, omega) after dt, which may be negative, under a torque that is constant in body axes."""
    omega1 = rate_step(omega, dt, inertia, inertia_inv, torque)
    rate0 = euler_rate(omega, inertia, inertia_inv, torque)
    rate1 = euler_rate(omega1, inertia, inertia_inv, torque)
    return quat_unit(quat_mul(q_bi, quat_exp(turn(omega, omega1, rate0, rate1, dt)))), omega1


@njit(cache=True)
def rigid_step(q_bi, omega, dt, inertia, inertia_inv):
    """(q_bi, omega) of a torque-free body after dt, which may be negative."""
    return torqued_step(q_bi, omega, dt, inertia, inertia_inv, NO_TORQUE)


@njit(cache=True)
def gravity_gradient_torque(position_b, inertia, gm):
    """Torque [N m] on a body at position_b [m] from the centre of mass gm [m^3/s^2]; equation (3)."""
    square = dot(position_b, position_b)
    return scale(3.0 * gm / (square * square * square**0.5), cross(position_b, matvec(inertia, position_b)))


@njit(cache=True)
def free_motion_kernel(seconds, q0, omega0, inertia, inertia_inv, step_max, q_out, omega_out):
    """Fill (n, 4) and (n, 3) with the torque-free motion at `seconds`, where the first row is the start."""
    q, omega = q0, omega0
    for k in range(seconds.shape[0]):
        if k > 0:
            gap = seconds[k] - seconds[k - 1]
            parts = max(1, ceil(abs(gap) / step_max))
            for _ in range(parts):
                q, omega = rigid_step(q, omega, gap / parts, inertia, inertia_inv)
        for j in range(4):
            q_out[k, j] = q[j]
        for j in range(3):
            omega_out[k, j] = omega[j]


def as_inertia9(inertia_kg_m2) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Nine floats of a symmetric positive definite (3, 3) or (3,) diagonal inertia [kg m^2], and of its inverse.

    The triangle inequality of principal moments is demanded too: no rigid body breaks it.
    """
    given = np.asarray(inertia_kg_m2, dtype=float)
    matrix = np.diag(given) if given.shape == (3,) else given
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        raise InputError(f"inertia_kg_m2 must be three principal moments or a (3, 3) matrix; got shape {given.shape}.")
    if not np.allclose(matrix, matrix.T, rtol=1e-9, atol=1e-12 * np.abs(matrix).max()):
        raise InputError("inertia_kg_m2 must be symmetric; its off-diagonal elements differ across the diagonal.")
    moments = np.linalg.eigvalsh(matrix)
    if moments[0] <= 0.0 or moments[2] > (moments[0] + moments[1]) * (1.0 + 1e-9):
        raise InputError(
            f"inertia_kg_m2 has principal moments {moments[0]:g}, {moments[1]:g}, {moments[2]:g}: they must be positive and "
            "none larger than the sum of the other two. Are products of inertia given with the wrong sign?"
        )
    inverse = np.linalg.inv(matrix)
    return tuple(map(float, matrix.ravel())), tuple(map(float, inverse.ravel()))


def free_motion(seconds, q0_bi, omega0_b, inertia_kg_m2, step_max_s=None) -> tuple[np.ndarray, np.ndarray]:
    """Torque-free motion: q_bi (n, 4) and omega_bi_b (n, 3) [rad/s] at `seconds` (n,), from the first of them.

    `step_max_s` bounds the inner step; by default the rate vector turns at most 0.05 rad a step.
    """
    seconds = np.ascontiguousarray(seconds, dtype=float)
    inertia, inverse = as_inertia9(inertia_kg_m2)
    omega0 = vec(np.asarray(omega0_b, dtype=float).reshape(1, 3), 0)
    if step_max_s is None:
        step_max_s = 0.05 / max(float(np.linalg.norm(omega0)), 1e-12)
    q_bi, omega_b = np.empty((seconds.size, 4)), np.empty((seconds.size, 3))
    q0 = tuple(float(x) for x in q0_bi)
    free_motion_kernel(seconds, q0, omega0, inertia, inverse, float(step_max_s), q_bi, omega_b)
    return q_bi, omega_b


def gravity_gradient(position_b_m, inertia_kg_m2, gm_m3_s2=EARTH_GM_M3_S2) -> np.ndarray:
    """(..., 3) [N m], body axes: equation (3) for positions (..., 3) [m] from the Earth's centre, body axes."""
    position = np.asarray(position_b_m, dtype=float)
    inertia9, _ = as_inertia9(inertia_kg_m2)
    inertia = np.reshape(inertia9, (3, 3))
    distance = np.linalg.norm(position, axis=-1, keepdims=True)
    return 3.0 * gm_m3_s2 / distance**5 * np.cross(position, position @ inertia)
