"""Small angles about a held attitude: the linear model that regulators are designed on.

theta is the rotation vector from the goal to the body and w its rate (26), (27); O the goal's own rate (the orbital rate, or
zero in inertial space) and z the unit vector to nadir, both constant in the goal's axes; J the inertia, H the wheels'
momentum, L = J O + H, n the mean motion, [a] the matrix of a x. Euler's equation to first order, with the gravity
gradient:

    dtheta/dt = w
    J dw/dt   = ([L] [O] - [O] J [O] + 3 n^2 ([z] J [z] - [J z] [z])) theta + ([L] - J [O] - [O] J) w + M x B   (32)

and for the moment M the input matrix -J^-1 [B], B of t. What is constant is left out: O x L and the gravity gradient at theta = 0
vanish where a principal axis is held along each orbital axis and H lies along O.

Held in inertial axes (`orbital_rate_b` zero, `nadir_b` None) the gravity gradient turns twice per orbit: left to the
regulator as a disturbance. A circular orbit is assumed. Body axes; [1/s] for the state (rad, rad/s).
"""

from __future__ import annotations

import numpy as np


def cross_matrix(v) -> np.ndarray:
    """(..., 3, 3) matrices [v] with [v] u = v x u."""
    v = np.asarray(v, dtype=float)
    x, y, z = np.moveaxis(v, -1, 0)
    zero = np.zeros_like(x)
    rows = ((zero, -z, y), (z, zero, -x), (-y, x, zero))
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def attitude_matrix(inertia_kg_m2, orbital_rate_b=(0.0, 0.0, 0.0), nadir_b=None, momentum_b=(0.0, 0.0, 0.0)) -> np.ndarray:
    """(6, 6) matrix of (32) for the state (theta, w).

    inertia (3, 3) [kg m^2]; orbital_rate_b (3,) [rad/s], its length is n; nadir_b (3,) unit vector, or None without
    gravity gradient; momentum_b (3,) of the wheels [N m s].
    """
    J, rate = np.asarray(inertia_kg_m2, dtype=float), np.asarray(orbital_rate_b, dtype=float)
    turn, held = cross_matrix(rate), cross_matrix(J @ rate + np.asarray(momentum_b, dtype=float))
    stiffness = held @ turn - turn @ J @ turn
    if nadir_b is not None:
        z = np.asarray(nadir_b, dtype=float)
        down = cross_matrix(z)
        stiffness = stiffness + 3.0 * (rate @ rate) * (down @ J @ down - cross_matrix(J @ z) @ down)
    a = np.zeros((6, 6))
    a[:3, 3:] = np.eye(3)
    a[3:, :3] = np.linalg.solve(J, stiffness)
    a[3:, 3:] = np.linalg.solve(J, held - J @ turn - turn @ J)
    return a


def moment_matrix(inertia_kg_m2, field_b) -> np.ndarray:
    """(..., 6, 3) input matrices -J^-1 [B] of a moment [A m^2], field_b (..., 3) [T]."""
    field = np.asarray(field_b, dtype=float)
    b = np.zeros((*field.shape[:-1], 6, 3))
    b[..., 3:, :] = -np.linalg.solve(np.asarray(inertia_kg_m2, dtype=float), cross_matrix(field))
    return b


def with_integral(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The model with three more states, the integral of theta [rad s]: (9, 9) and (..., 9, 3)."""
    longer = np.zeros((9, 9))
    longer[:6, :6] = a
    longer[6:, :3] = np.eye(3)
    return longer, np.concatenate([b, np.zeros((*b.shape[:-2], 3, 3))], axis=-2)
