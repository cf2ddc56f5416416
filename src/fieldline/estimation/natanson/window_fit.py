"""Least squares over a window: attitude and constant body rate from magnetometer samples, from any number of starts.

Minimises  chi^2 = sum_k |B_A(t_k) - A(q(t_k)) B_R(t_k)|^2 / sigma^2,   q(t) = q0 * exp(omega (t - t0) / 2),      (1)

over q0 and omega by Gauss-Newton steps with Levenberg's damping. With body-axes errors q_true = q * exp(e/2),

    d(A B_R) = [b x] e,   b = A B_R                                                                               (2)
    e(t) = exp(-theta) e0 + J(theta) (t - t0) domega,   theta = omega (t - t0)                                    (3)
    J(theta) = I - (1 - cos|theta|)/|theta|^2 [theta x] + (|theta| - sin|theta|)/|theta|^3 [theta x]^2

The covariance of (e0, domega) at t0 is the inverse of the normal matrix at sigma as given; with sigma honest, chi^2 is
about 3 n - 6. What a window can tell is bounded: at 6.44 mG digits and 0.06 deg/s the bound is 15 deg over 240 s, 3 deg
over 480 s, 0.4 deg over 960 s (one sigma, three axes); the fit reaches it.

Source: Markley and Crassidis (2014), s. 6.2 (nonlinear least squares) and 3.1 (errors); (3) is the right Jacobian of the
rotation group. Valid while the body rate is constant to about sigma / (|B| window).
"""

from __future__ import annotations

from math import cos, sin, sqrt
from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.errors import InputError
from fieldline.frames.attitude import quat_exp, quat_mul, quat_unit, to_body
from fieldline.frames.matrices import matadd, matmul, matscale, skew
from fieldline.frames.vectors import add, cross, dot, scale, sub, vec

SIZE = 6
CONVERGED = 1e-7  # relative fall of chi^2 at which the fit stops
DAMPING_MAX = 1e12


class WindowFit(NamedTuple):
    """The fits from m starts, best first."""

    q_bi: np.ndarray  # (m, 4) at the epoch
    omega_b: np.ndarray  # (m, 3) [rad/s]
    covariance: np.ndarray  # (m, 6, 6) of (e0 [rad], domega [rad/s]), body axes
    chi_square: np.ndarray  # (m,)
    residual_rms_tesla: np.ndarray  # (m,) per axis
    iterations: np.ndarray  # (m,)
    start: np.ndarray  # (m,) which of the starts led here
    epoch_s: float


@njit(cache=True)
def right_jacobian(theta):
    """J of equation (3) as nine floats; a series near zero, where its factors lose their digits."""
    square = dot(theta, theta)
    if square < 1e-6:
        first, second = 0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0
    else:
        size = sqrt(square)
        first, second = (1.0 - cos(size)) / square, (size - sin(size)) / (square * size)
    crossed = skew(theta)
    twice = matmul(crossed, crossed)
    return matadd((1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0), matadd(matscale(-first, crossed), matscale(second, twice)))


@njit(cache=True)
def chi_square_kernel(lapse, field_b, field_i, q, omega, sigma):
    """Equation (1)."""
    total = 0.0
    for k in range(lapse.shape[0]):
        there = quat_mul(q, quat_exp(scale(lapse[k], omega)))
        miss = sub(vec(field_b, k), to_body(there, vec(field_i, k)))
        total += dot(miss, miss)
    return total / (sigma * sigma)


@njit(cache=True)
def normal_equations_kernel(lapse, field_b, field_i, q, omega, sigma, normal, gradient):
    """Fill the (6, 6) normal matrix and the (6,) right side of a Gauss-Newton step; (2) and (3)."""
    normal[:, :] = 0.0
    gradient[:] = 0.0
    weight = 1.0 / (sigma * sigma)
    row = np.empty(SIZE)
    for k in range(lapse.shape[0]):
        theta = scale(lapse[k], omega)
        swing = quat_exp(theta)
        b = to_body(quat_mul(q, swing), vec(field_i, k))
        miss = sub(vec(field_b, k), b)
        jacobian = right_jacobian(theta)
        for axis in range(3):
            # Row `axis` of [b x] M is the vector (unit x b) M, whose transpose is M^T (unit x b).
            arm = cross((1.0 * (axis == 0), 1.0 * (axis == 1), 1.0 * (axis == 2)), b)
            turned = to_body((-swing[0], -swing[1], -swing[2], swing[3]), arm)
            for j in range(3):
                row[j] = turned[j]
                row[3 + j] = lapse[k] * (jacobian[j] * arm[0] + jacobian[3 + j] * arm[1] + jacobian[6 + j] * arm[2])
            for i in range(SIZE):
                gradient[i] += weight * row[i] * miss[axis]
                for j in range(i + 1):
                    normal[i, j] += weight * row[i] * row[j]
    for i in range(SIZE):
        for j in range(i):
            normal[j, i] = normal[i, j]


@njit(cache=True)
def cholesky(matrix, lower):
    """Fill `lower` with L of matrix = L L^T; False where the matrix is not positive definite."""
    size = matrix.shape[0]
    for i in range(size):
        for j in range(i + 1):
            total = matrix[i, j]
            for k in range(j):
                total -= lower[i, k] * lower[j, k]
            if i == j:
                if not total > 0.0:
                    return False
                lower[i, i] = sqrt(total)
            else:
                lower[i, j] = total / lower[j, j]
    return True


@njit(cache=True)
def cholesky_solve(lower, right, out):
    """Fill `out` with the solution of L L^T out = right."""
    size = lower.shape[0]
    for i in range(size):
        total = right[i]
        for k in range(i):
            total -= lower[i, k] * out[k]
        out[i] = total / lower[i, i]
    for i in range(size - 1, -1, -1):
        total = out[i]
        for k in range(i + 1, size):
            total -= lower[k, i] * out[k]
        out[i] = total / lower[i, i]


@njit(cache=True)
def fit_kernel(lapse, field_b, field_i, q, omega, sigma, rounds, covariance):
    """(q, omega, chi^2, iterations) of one start; fills the (6, 6) covariance, NaN where the window cannot tell."""
    normal, damped, lower = np.zeros((SIZE, SIZE)), np.zeros((SIZE, SIZE)), np.zeros((SIZE, SIZE))
    gradient, step = np.zeros(SIZE), np.zeros(SIZE)
    cost = chi_square_kernel(lapse, field_b, field_i, q, omega, sigma)
    damping, used = 1e-3, 0
    for _ in range(rounds):
        used += 1
        normal_equations_kernel(lapse, field_b, field_i, q, omega, sigma, normal, gradient)
        fall = 0.0
        while damping < DAMPING_MAX:
            for i in range(SIZE):
                for j in range(SIZE):
                    damped[i, j] = normal[i, j]
                damped[i, i] += damping * normal[i, i]
            if cholesky(damped, lower):
                cholesky_solve(lower, gradient, step)
                q_new = quat_unit(quat_mul(q, quat_exp((step[0], step[1], step[2]))))
                omega_new = add(omega, (step[3], step[4], step[5]))
                cost_new = chi_square_kernel(lapse, field_b, field_i, q_new, omega_new, sigma)
                if cost_new < cost:
                    fall = cost - cost_new
                    q, omega, cost = q_new, omega_new, cost_new
                    damping *= 0.1
                    break
            damping *= 10.0
        if fall <= CONVERGED * cost:
            break
    normal_equations_kernel(lapse, field_b, field_i, q, omega, sigma, normal, gradient)
    covariance[:, :] = np.nan
    if cholesky(normal, lower):
        for i in range(SIZE):
            gradient[:] = 0.0
            gradient[i] = 1.0
            cholesky_solve(lower, gradient, step)
            covariance[:, i] = step
    return q, omega, cost, used


@njit(cache=True)
def fit_all_kernel(lapse, field_b, field_i, q_bi, omega_b, sigma, rounds, covariance, chi_square, iterations):
    """`fit_kernel` for each of m starts, in place."""
    for m in range(q_bi.shape[0]):
        q = quat_unit((q_bi[m, 0], q_bi[m, 1], q_bi[m, 2], q_bi[m, 3]))
        q, omega, cost, used = fit_kernel(lapse, field_b, field_i, q, vec(omega_b, m), sigma, rounds, covariance[m])
        for j in range(4):
            q_bi[m, j] = q[j]
        for j in range(3):
            omega_b[m, j] = omega[j]
        chi_square[m], iterations[m] = cost, used


def fit_window(seconds, field_b, field_i, start_q_bi, start_omega_b, *, noise_tesla, epoch_s=None, rounds=60) -> WindowFit:
    """Attitude and constant rate over the samples given, from each start; the best fit first.

    Parameters
    ----------
    seconds (n,) [s]; field_b, field_i (n, 3) [T], body and inertial axes; rows with NaN are left out.
    start_q_bi (m, 4), start_omega_b (m, 3) [rad/s] : the starts, at epoch_s (default: the middle of the window).
    noise_tesla : one sigma per axis; a digitised field has digit/sqrt(12).
    """
    times, body, inertial = (np.asarray(x, dtype=float) for x in (seconds, field_b, field_i))
    keep = np.isfinite(times) & np.isfinite(body).all(axis=-1) & np.isfinite(inertial).all(axis=-1)
    times, body, inertial = times[keep], np.ascontiguousarray(body[keep]), np.ascontiguousarray(inertial[keep])
    if times.size < 3:
        raise InputError(f"six unknowns need three field vectors or more; the window holds {times.size} usable samples.")
    if not noise_tesla > 0.0:
        raise InputError(f"noise_tesla must be positive; got {noise_tesla}.")
    epoch = float(0.5 * (times[0] + times[-1]) if epoch_s is None else epoch_s)
    q_bi = np.array(start_q_bi, dtype=float).reshape(-1, 4)
    omega_b = np.array(start_omega_b, dtype=float).reshape(-1, 3)
    count = len(q_bi)
    if count == 0 or len(omega_b) != count:
        raise InputError(f"each start needs an attitude and a rate; got {count} attitudes and {len(omega_b)} rates.")
    known = np.isfinite(q_bi).all(axis=1) & np.isfinite(omega_b).all(axis=1) & (np.abs(q_bi).max(axis=1) > 0.0)
    if not known.all():
        raise InputError(f"start {int(np.argmin(known))} is not a number or a zero quaternion; leave such starts out.")
    covariance, chi_square, iterations = np.empty((count, SIZE, SIZE)), np.empty(count), np.empty(count, dtype=np.int64)
    fit_all_kernel(times - epoch, body, inertial, q_bi, omega_b, float(noise_tesla), rounds, covariance, chi_square, iterations)
    order = np.argsort(chi_square)
    rms = noise_tesla * np.sqrt(chi_square / (3.0 * times.size))
    rows = (q_bi, omega_b, covariance, chi_square, rms, iterations, np.arange(count))
    return WindowFit(*(x[order] for x in rows), epoch)


def propagate(q_bi, omega_b, lapse_s) -> np.ndarray:
    """(n, 4) attitudes after each of (n,) [s] at a constant body rate, from (4,) and (3,)."""
    from scipy.spatial.transform import Rotation

    swing = Rotation.from_rotvec(np.multiply.outer(np.asarray(lapse_s, dtype=float), np.asarray(omega_b, dtype=float)))
    return (Rotation.from_quat(q_bi) * swing).as_quat()


def starts_on_circle(field_b, field_i, count: int = 8) -> np.ndarray:
    """(count, 4) attitudes that put one field vector right and differ by equal turns about it: a bank with no prior."""
    from scipy.spatial.transform import Rotation

    body, inertial = (np.asarray(x, dtype=float) / np.linalg.norm(x) for x in (field_b, field_i))
    first = Rotation.align_vectors(inertial[None], body[None])[0]
    turns = Rotation.from_rotvec(np.multiply.outer(2.0 * np.pi * np.arange(count) / count, inertial))
    return (turns * first).as_quat()


def expected_error_deg(fit: WindowFit, which: int = 0) -> float:
    """One-sigma angle of the attitude error at the epoch, over three axes [deg]."""
    return float(np.degrees(np.sqrt(np.trace(fit.covariance[which][:3, :3]))))
