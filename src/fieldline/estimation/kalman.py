"""Multiplicative Kalman filter and smoother: attitude and body rate from the field measured along an orbit.

State: quaternion q_bi, rate w = omega_bi_b, coloured measurement error c (body axes, first-order Gauss-Markov).

    b = A(q) B_i + c + noise,    H = [ [A B_i x], 0, I ]                                                (1)
    R = r^2 I + t^2 (w x b)(w x b)^T                                                                    (2)
    c+ = f c + sqrt(1 - f^2) s_c white,   f = exp(-h / tau)                                             (3)

t [s] is the jitter of the time stamps: on a body that turns 46 deg between samples, 20 ms of it outweigh the noise of a
magnetometer. c stands for what a calibration leaves and a field model lacks: its size is read from the magnitude, which
no attitude can explain, so the filter cannot turn such errors into motion.

Smoother (Bryson and Frazier): with the adjoint l, L run backwards from zero,

    l~ = (I - K H)^T l - H^T S^-1 v,     L~ = (I - K H)^T L (I - K H) + H^T S^-1 H                      (4)
    l' = F^T l~,                         L' = F^T L~ F                                                  (5)
    x_s = x_f - P_f l,                   P_s = P_f - P_f L P_f                                          (6)

It needs no inverse of a covariance and continues from chunk to chunk, so a long record takes bounded memory.

A filter that starts without knowing the angle about the field linearises about wrong states until it does. So the passes
after the first linearise about the smoothed path of the one before, x = x_path + error, which is Gauss-Newton on the whole
arc at once (the iterated smoother of Bell, 1994, SIAM J. Optim. 4:626).

Source: Markley and Crassidis (2014), s. 6.2; Bierman (1973), Automatica 9:503 for (4) to (6).
Valid while an update's correction is small against a radian: starts come from `estimation.starts`.
"""

from __future__ import annotations

from math import exp, inf, isfinite, log, nan, pi
from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.estimation import covariance as cov
from fieldline.estimation.motion import propagate, told
from fieldline.frames.attitude import quat_conj, quat_exp, quat_mul, quat_unit, rotation_vector, to_body
from fieldline.frames.matrices import determinant, matadd, matmul, matscale, matvec, skew
from fieldline.frames.vectors import add, cross, dot, put, scale, sub, vec

STATES = 10  # q (4), w (3), c (3) in a row
NO_ERROR = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
CHUNK = 65_536  # rows kept at a time by the smoother: 34 MB of states and covariances


class Noise(NamedTuple):
    """What disturbs a measurement. white, coloured [T], coloured_time [s], jitter [s]; gate: largest NIS taken whole."""

    white: float
    coloured: float = 0.0
    coloured_time: float = 600.0
    jitter: float = 0.0
    gate: float = 25.0


@njit(cache=True, inline="always")
def noise_matrix(w, body, noise):
    """R of (2)."""
    u = cross(w, body)
    t2, r2 = noise.jitter * noise.jitter, noise.white * noise.white
    xy, xz, yz = t2 * u[0] * u[1], t2 * u[0] * u[2], t2 * u[1] * u[2]
    return (r2 + t2 * u[0] * u[0], xy, xz, xy, r2 + t2 * u[1] * u[1], yz, xz, yz, r2 + t2 * u[2] * u[2])


@njit(cache=True, inline="always")
def innovation(ref, error, rate, p, measured, reference, noise, coloured, about):
    """Whitened residual, h, gains, S^-1 v, S^-1 and log-likelihood of one vector; beyond the gate R is stretched."""
    q, _, c = ref
    body = to_body(q, reference)
    h = skew(body)
    r = noise_matrix(rate, body, noise)
    residual = sub(measured, body)
    if coloured:
        residual = sub(residual, c)
    if about:
        residual = sub(residual, add(matvec(h, error[0]), error[2]))
    ga, gr, gc, s = cov.measurement_gain(p, h, r, coloured)
    white = cov.whitened(s, residual)
    nis = dot(white, white)
    cost = nis
    if nis > noise.gate:
        # an outlier moves the state no more than a sample at the gate; its cost grows with the logarithm (Student-like)
        cost = noise.gate * (1.0 + log(nis / noise.gate))
        s = matadd(s, matscale(nis / noise.gate - 1.0, r))
    s_inv = cov.inverted(s)
    log_likelihood = -0.5 * (cost + log(determinant(s)) + 3.0 * log(2.0 * pi))
    return white, h, ga, gr, gc, matvec(s_inv, residual), s_inv, log_likelihood


@njit(cache=True, inline="always")
def _row_state(states, k):
    """q, w, c of a row."""
    r = states[k]
    return (r[0], r[1], r[2], r[3]), (r[4], r[5], r[6]), (r[7], r[8], r[9])


@njit(cache=True, inline="always")
def _row_error(errors, k):
    """Errors e, dw, dc of a row."""
    r = errors[k]
    return (r[0], r[1], r[2]), (r[3], r[4], r[5]), (r[6], r[7], r[8])


@njit(cache=True)
def _put_state(states, k, ref):
    """Store q, w, c as a row."""
    for j in range(4):
        states[k, j] = ref[0][j]
    for j in range(3):
        states[k, 4 + j] = ref[1][j]
        states[k, 7 + j] = ref[2][j]


@njit(cache=True)
def _put_error(errors, k, error):
    """Store e, dw, dc as a row."""
    for part in range(3):
        for j in range(3):
            errors[k, 3 * part + j] = error[part][j]


@njit(cache=True, inline="always")
def _shifted(ref, error):
    """The state that lies by an error off a reference."""
    return quat_unit(quat_mul(ref[0], quat_exp(error[0]))), add(ref[1], error[1]), add(ref[2], error[2])


@njit(cache=True, inline="always")
def _fade(h, noise, coloured):
    """f of (3) and the variance that the coloured error gains over h."""
    if not coloured:
        return 1.0, 0.0
    f = exp(-abs(h) / noise.coloured_time)
    return f, (1.0 - f * f) * noise.coloured * noise.coloured


@njit(cache=True, inline="always")
def _predicted(ref, error, series, k, step, model, noise, coloured, path):
    """Reference and error at row k from those a step before, and the step's F: without a path the reference moves along.

    The environment of a step is that of the row before it, where there is one.
    """
    j = max(k - 1, 0)
    known = told(series, j, k, model)
    q, w, phi, psi, lam = propagate(ref[0], ref[1], known, vec(series.field_i, j), vec(series.pull_i, j), step, model)
    f, drive = _fade(step, noise, coloured)
    moved = (q, w, scale(f, ref[2]))
    if path.shape[0] == 0:
        return moved, NO_ERROR, phi, psi, lam, f, drive
    goal = _row_state(path, k)
    off = rotation_vector(quat_mul(quat_conj(goal[0]), moved[0]))
    turned = add(add(matvec(phi, error[0]), matvec(psi, error[1])), off)
    rate = add(matvec(lam, error[1]), sub(moved[1], goal[1]))
    slow = add(scale(f, error[2]), sub(moved[2], goal[2]))
    return goal, (turned, rate, slow), phi, psi, lam, f, drive


@njit(cache=True)
def filter_forward(series, first, before, start, offset, prior, noise, model, path, states, errors, blocks, white):
    """Filter samples; returns the log-likelihood and leaves the last reference, error and covariance in start,
    offset and prior.

    series: see `estimation.series`, n rows. start (1, 10), offset (1, 9) off it and prior (1, 54) hold at the first sample
    (first true) or at the time `before` [s], one step earlier. path (n, 10) linearises about a known motion, or has no
    rows: then about the filter's own, as an extended filter does. states (n, 10), errors (n, 9) off them and blocks
    (n, 54) are filled where they have n rows, and so is white (n, 3), the innovations whitened by their covariance, NaN
    where not used.
    """
    seconds, used = series.seconds, series.used
    n = seconds.shape[0]
    keep, report = states.shape[0] == n, white.shape[0] == n
    coloured, about = noise.coloured > 0.0, path.shape[0] == n
    ref, error = _row_state(start, 0), _row_error(offset, 0)
    p = cov.load(prior, 0)
    total = 0.0
    for k in range(n):
        if k > 0 or not first:
            step = seconds[k] - (seconds[k - 1] if k > 0 else before)
            ref, error, phi, psi, lam, f, drive = _predicted(ref, error, series, k, step, model, noise, coloured, path)
            p = cov.step_forward(p, phi, psi, lam, f, drive, model.noise, step, coloured)
        elif about:
            ref = _row_state(path, 0)
        whitened = (nan, nan, nan)
        if used[k]:
            rate = add(ref[1], vec(series.gyro_b, k))
            whitened, _, ga, gr, gc, v, s_inv, gained = innovation(
                ref, error, rate, p, vec(series.field_b, k), vec(series.field_i, k), noise, coloured, about
            )
            ec = add(error[2], matvec(gc, v)) if coloured else error[2]
            error = (add(error[0], matvec(ga, v)), add(error[1], matvec(gr, v)), ec)
            if not about:
                ref, error = _shifted(ref, error), NO_ERROR
            p = cov.updated(p, ga, gr, gc, s_inv, coloured)
            total += gained
            if not isfinite(total):
                return -inf
        if keep:
            _put_state(states, k, ref)
            _put_error(errors, k, error)
            cov.store(blocks, k, p)
        if report:
            put(white, k, whitened)
    _put_state(start, 0, ref)
    _put_error(offset, 0, error)
    cov.store(prior, 0, p)
    return total


@njit(cache=True)
def smooth_backward(
    series, first, before, start, offset, prior, noise, model, path, states, errors, blocks, adjoint_v, adjoint_m
):  # fmt: skip
    """Filtered rows become smoothed ones, by (4) to (6); start, offset and prior are those of the forward
    pass over the rows.

    adjoint_v (9,) and adjoint_m (1, 54) hold l and L after the last row (zero at the record's end) and leave holding
    them before the first one.
    """
    seconds, used = series.seconds, series.used
    n = seconds.shape[0]
    coloured, about = noise.coloured > 0.0, path.shape[0] == n
    va, vr, vc = _row_error(adjoint_v.reshape(1, 9), 0)
    m = cov.load(adjoint_m, 0)
    for k in range(n - 1, -1, -1):
        ref_f, error_f = _row_state(states, k), _row_error(errors, k)
        p_f = cov.load(blocks, k)
        if k > 0:
            ref, error, p = _row_state(states, k - 1), _row_error(errors, k - 1), cov.load(blocks, k - 1)
        else:
            ref, error, p = _row_state(start, 0), _row_error(offset, 0), cov.load(prior, 0)
        moves = k > 0 or not first
        phi, psi, lam, f = cov.IDENTITY, cov.ZERO9, cov.IDENTITY, 1.0
        if moves:
            step = seconds[k] - (seconds[k - 1] if k > 0 else before)
            ref, error, phi, psi, lam, f, drive = _predicted(ref, error, series, k, step, model, noise, coloured, path)
            p = cov.step_forward(p, phi, psi, lam, f, drive, model.noise, step, coloured)
        elif about:
            ref = _row_state(path, 0)
        ea, er, ec = cov.times(p_f, va, vr, vc, coloured)
        shift = (sub(error_f[0], ea), sub(error_f[1], er), sub(error_f[2], ec))
        _put_state(states, k, _shifted(ref_f, shift))
        cov.store(blocks, k, cov.smoothed(p_f, m, coloured))
        if used[k]:
            rate = add(ref[1], vec(series.gyro_b, k))
            _, h, ga, gr, gc, v, s_inv, _ = innovation(
                ref, error, rate, p, vec(series.field_b, k), vec(series.field_i, k), noise, coloured, about
            )
            ka, kr, kc = matmul(ga, s_inv), matmul(gr, s_inv), matmul(gc, s_inv)
            g = add(cov.transposed_gain(ka, kr, kc, va, vr, vc, coloured), v)
            va, vc = cov.innovated(va, vc, h, g)
            m = cov.measured_adjoint(m, h, ka, kr, kc, s_inv, coloured)
        if moves:
            va, vr, vc = cov.vectors_back(va, vr, vc, phi, psi, lam, f)
            m = cov.step_backward(m, phi, psi, lam, f, coloured)
    _put_error(adjoint_v.reshape(1, 9), 0, (va, vr, vc))
    cov.store(adjoint_m, 0, m)


@njit(cache=True)
def predicted_fields(states, field_i, body):
    """Fill body (n, 3) with the reference field in the estimated body axes."""
    for k in range(states.shape[0]):
        q = (states[k, 0], states[k, 1], states[k, 2], states[k, 3])
        put(body, k, to_body(q, vec(field_i, k)))


def prior_blocks(attitude_std_rad, rate_std_rad_s, coloured_tesla: float = 0.0) -> np.ndarray:
    """(1, 54) covariance of independent errors: attitude [rad], rate [rad/s] (scalars or per axis), coloured [T]."""
    blocks = np.zeros((1, cov.BLOCKS))
    blocks[0, [0, 4, 8]] = np.broadcast_to(np.asarray(attitude_std_rad, float) ** 2, 3)
    blocks[0, [18, 22, 26]] = np.broadcast_to(np.asarray(rate_std_rad_s, float) ** 2, 3)
    blocks[0, [45, 49, 53]] = coloured_tesla**2
    return blocks
