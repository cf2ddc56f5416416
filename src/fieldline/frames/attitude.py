"""Attitude: unit quaternions, scalar last, as the field uses them (Markley and Crassidis; CCSDS).

The quaternion q_bi of body axes b against axes i is such that

    v_i = q_bi * v_b * conj(q_bi)          (Hamilton product)                              (1)
    dcm_bi = A(q_bi),   v_b = A(q_bi) v_i                                                  (2)
    dq_bi/dt = 1/2 q_bi * (omega_bi_b, 0)                                                  (3)
    A(q) = (w^2 - |v|^2) I + 2 v v^T - 2 w [v x]                                           (4)

so `scipy.spatial.transform.Rotation.from_quat(q_bi).apply(v_b)` is v_i: SciPy's matrix is the transpose of A.
Small errors are rotation vectors in body axes: q_true = q_estimate * exp(error_b / 2).

Source: Markley and Crassidis, Fundamentals of Spacecraft Attitude Determination and Control (2014), s. 2.9 and 3.1,
with their product order replaced by Hamilton's: their A(q) and ours are the same matrix.
"""

from __future__ import annotations

from math import atan2, cos, sin, sqrt

import numpy as np
from numba import njit

from fieldline.frames.vectors import cross, dot


@njit(cache=True)
def quat_mul(p, q):
    """Hamilton product p * q, scalar last: first q, then p, in the sense of (1)."""
    return (
        p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1],
        p[3] * q[1] - p[0] * q[2] + p[1] * q[3] + p[2] * q[0],
        p[3] * q[2] + p[0] * q[1] - p[1] * q[0] + p[2] * q[3],
        p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2],
    )


@njit(cache=True)
def quat_conj(q):
    """The inverse of a unit quaternion."""
    return (-q[0], -q[1], -q[2], q[3])


@njit(cache=True, error_model="numpy")
def quat_unit(q):
    """q / |q|; NaN where q is zero, for the caller to find."""
    s = 1.0 / sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    return (s * q[0], s * q[1], s * q[2], s * q[3])


@njit(cache=True)
def quat_exp(angle):
    """The unit quaternion of a rotation vector [rad]; a series near zero, where sin(x)/x loses its digits."""
    square = dot(angle, angle)
    if square < 1e-8:
        s = 0.5 - square / 48.0
        return quat_unit((s * angle[0], s * angle[1], s * angle[2], 1.0 - square / 8.0))
    size = sqrt(square)
    s = sin(0.5 * size) / size
    return (s * angle[0], s * angle[1], s * angle[2], cos(0.5 * size))


@njit(cache=True)
def rotation_vector(q):
    """The rotation vector [rad] of a unit quaternion, the short way round: `quat_exp` undone."""
    x, y, z, w = q
    if w < 0.0:
        x, y, z, w = -x, -y, -z, -w
    size = sqrt(x * x + y * y + z * z)
    s = 2.0 if size < 1e-12 else 2.0 * atan2(size, w) / size
    return (s * x, s * y, s * z)


@njit(cache=True)
def to_body(q_bi, v_i):
    """v_b = A(q_bi) v_i, equation (2)."""
    v = (q_bi[0], q_bi[1], q_bi[2])
    w = q_bi[3]
    t = cross(v, v_i)
    t = (2.0 * t[0], 2.0 * t[1], 2.0 * t[2])
    u = cross(v, t)
    return (v_i[0] - w * t[0] + u[0], v_i[1] - w * t[1] + u[1], v_i[2] - w * t[2] + u[2])


@njit(cache=True)
def to_inertial(q_bi, v_b):
    """v_i = A(q_bi)^T v_b, equation (1)."""
    return to_body(quat_conj(q_bi), v_b)


@njit(cache=True)
def dcm(q_bi):
    """A(q_bi) of equation (4) as nine floats, row by row."""
    x, y, z, w = q_bi
    return (
        w * w + x * x - y * y - z * z,
        2.0 * (x * y + w * z),
        2.0 * (x * z - w * y),
        2.0 * (x * y - w * z),
        w * w - x * x + y * y - z * z,
        2.0 * (y * z + w * x),
        2.0 * (x * z + w * y),
        2.0 * (y * z - w * x),
        w * w - x * x - y * y + z * z,
    )


def dcm_from_quaternion(q_bi):
    """(..., 3, 3) matrices A with v_b = A v_i, of (..., 4) unit quaternions, scalar last (4)."""
    q = np.asarray(q_bi, dtype=float)
    x, y, z, w = np.moveaxis(q / np.linalg.norm(q, axis=-1, keepdims=True), -1, 0)
    rows = (
        (w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)),
        (2 * (x * y - w * z), w * w - x * x + y * y - z * z, 2 * (y * z + w * x)),
        (2 * (x * z + w * y), 2 * (y * z - w * x), w * w - x * x - y * y + z * z),
    )
    return np.stack([np.stack(r, axis=-1) for r in rows], axis=-2)


def quaternion_from_dcm(dcm_bi):
    """(..., 4) unit quaternions, scalar last and non-negative, of (..., 3, 3) matrices with v_b = A v_i."""
    from scipy.spatial.transform import Rotation

    matrices = np.asarray(dcm_bi, dtype=float)
    q = Rotation.from_matrix(np.swapaxes(matrices, -1, -2).reshape(-1, 3, 3)).as_quat(canonical=True)
    return q.reshape((*matrices.shape[:-2], 4))


def rotation_error_b(q_true, q_estimate):
    """(..., 3) [rad], body axes: the rotation vector e with q_true = q_estimate * exp(e / 2)."""
    from scipy.spatial.transform import Rotation

    true = np.asarray(q_true, dtype=float)
    estimate = np.asarray(q_estimate, dtype=float)
    error = Rotation.from_quat(estimate.reshape(-1, 4)).inv() * Rotation.from_quat(true.reshape(-1, 4))
    return error.as_rotvec().reshape((*np.broadcast_shapes(true.shape, estimate.shape)[:-1], 3))
