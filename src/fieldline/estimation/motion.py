"""How attitude and rate move between two samples, with their derivatives: the filter's model of the satellite.

    q+ = q exp(theta / 2)                    e+  = Phi e + Psi dw                                       (1)
    w+ = w             (random walk)         dw+ = dw        (on a gyro's rate: the body turns by it and w)
    w+ = Euler's       (rigid body)          dw+ = Lam dw

e is the error's rotation vector in body axes, q_true = q exp(e / 2). For a constant rate Phi = A(exp(w h / 2)) and
Psi = int_0^h A(exp(w s / 2)) ds. White angular acceleration s [rad/s/sqrt(s)] adds

    Q = s^2 [[h^3/3, h^2/2], [h^2/2, h]]                                                               (2)

Euler's equations carry the torque of a residual dipole m, m x b, and of the gravity gradient (see `series`).

Source: Markley and Crassidis (2014), s. 3.1.3, 3.3.6, 6.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.frames.attitude import dcm, quat_exp, quat_mul, quat_unit, to_body
from fieldline.frames.matrices import IDENTITY, matadd, matmul, matscale, matsub, matvec, skew
from fieldline.frames.vectors import add, cross, norm, scale, vec
from fieldline.mechanics.rigid_body import euler_rate, rate_step, turn

NO_DIPOLE = NO_TORQUE = (0.0, 0.0, 0.0)
ZERO9 = (0.0,) * 9
MOST_PARTS = 1000  # substeps of one step: a rate that ran away must not run for ever
LARGEST_TURN = 0.15  # [rad] of one substep of Euler's equations: 2e-7 rad of error each


class RateModel(NamedTuple):
    """What moves the rate; a record of floats for the kernels, made by `random_walk` or `rigid_body`.

    inertia and its inverse: nine floats, any scale (only ratios act); dipole: residual dipole over that scale
    [A m2 / kg m2 when the inertia's unit is kg m2]; noise: s of (2) [rad/s/sqrt(s)]; torque: constant in body axes, over that
    scale too.
    """

    rigid: bool
    inertia: tuple
    inertia_inv: tuple
    dipole: tuple
    noise: float
    torque: tuple = NO_TORQUE


def random_walk(noise: float) -> RateModel:
    """The model that needs no inertia: each body rate wanders by `noise` [rad/s/sqrt(s)]."""
    return RateModel(False, IDENTITY, IDENTITY, NO_DIPOLE, float(noise))


def rigid_body(inertia, noise: float, dipole=NO_DIPOLE) -> RateModel:
    """Euler's equations with a (3, 3) inertia, a residual dipole and white angular acceleration `noise`."""
    matrix = np.asarray(inertia, dtype=float)
    inverse = np.linalg.inv(matrix)
    return RateModel(
        True,
        tuple(float(v) for v in matrix.ravel()),
        tuple(float(v) for v in inverse.ravel()),
        tuple(float(v) for v in np.asarray(dipole, dtype=float)),
        float(noise),
    )


@njit(cache=True)
def rate_jacobian(w, model):
    """d(dw/dt)/dw of Euler's equations: J^-1 ([J w x] - [w x] J)."""
    momentum = matvec(model.inertia, w)
    return matmul(model.inertia_inv, matsub(skew(momentum), matmul(skew(w), model.inertia)))


@njit(cache=True, inline="always")
def told(series, j, k, model):
    """What telemetry tells of the motion from row j to row k: see `propagate`."""
    if model.rigid:
        # a command is held until the next one
        return vec(series.moment_b, min(j, k))
    # a gyro reads at the samples: the trapezium between them
    return scale(0.5, add(vec(series.gyro_b, j), vec(series.gyro_b, k)))


@njit(cache=True, inline="always")
def propagate(q, w, known, field_i, pull_i, h, model):
    """q, w after h [s] (negative runs backwards) with Phi, Psi, Lam of (1); field and pull feed the torques.

    known: what telemetry tells of the motion, body axes: a gyro's rate [rad/s] under a random walk, a commanded dipole (over
    the inertia's scale) [A m2] in a rigid body; zeros where nothing is told.
    """
    if not model.rigid:
        half = quat_exp(scale(0.5 * h, add(w, known)))
        full = quat_mul(half, half)
        # Simpson's rule on A(exp(w s)): good to (w h)^4 / 2880, 1e-4 at 46 deg a step, ample for a covariance
        psi = matscale(h / 6.0, matadd(matadd(IDENTITY, matscale(4.0, dcm(half))), dcm(full)))
        return quat_unit(quat_mul(q, full)), w, dcm(full), psi, IDENTITY
    turns = abs(h) * norm(w) / LARGEST_TURN
    parts = 1 + int(turns) if turns < MOST_PARTS else MOST_PARTS
    step = h / parts
    phi, psi, lam = IDENTITY, ZERO9, IDENTITY
    for _ in range(parts):
        # torque at the substep's middle: at its start it would trail the body by half a substep
        torque = outer_torque(quat_mul(q, quat_exp(scale(0.5 * step, w))), add(model.dipole, known), field_i, pull_i, model)
        q, w, phi, psi, lam = _rigid_substep(q, w, torque, phi, psi, lam, step, model)
    return quat_unit(q), w, phi, psi, lam


@njit(cache=True)
def outer_torque(q, dipole, field_i, pull_i, model):
    """Torque over the inertia's scale: constant one, residual and commanded dipole, and gravity gradient."""
    pull_b = to_body(q, pull_i)
    magnetic = add(cross(dipole, to_body(q, field_i)), model.torque)
    return add(magnetic, cross(pull_b, matvec(model.inertia, pull_b)))


@njit(cache=True)
def _rigid_substep(q, w, torque, phi, psi, lam, h, model):
    """One substep of Euler's equations with a held torque; the derivatives go by the midpoint."""
    w_next = rate_step(w, h, model.inertia, model.inertia_inv, torque)
    before = euler_rate(w, model.inertia, model.inertia_inv, torque)
    after = euler_rate(w_next, model.inertia, model.inertia_inv, torque)
    step = quat_exp(turn(w, w_next, before, after, h))
    middle = (0.5 * (w[0] + w_next[0]), 0.5 * (w[1] + w_next[1]), 0.5 * (w[2] + w_next[2]))
    slope = matscale(h, rate_jacobian(middle, model))
    grow = matadd(IDENTITY, matadd(slope, matscale(0.5, matmul(slope, slope))))
    rotated = dcm(step)
    # what the rate's error adds over the substep: its value at the middle, turned on to the end
    half = dcm(quat_exp(scale(0.5 * h, middle)))
    gained = matscale(h, matmul(half, matmul(matadd(IDENTITY, matscale(0.5, slope)), lam)))
    psi = matadd(matmul(rotated, psi), gained)
    return quat_mul(q, step), w_next, matmul(rotated, phi), psi, matmul(grow, lam)
