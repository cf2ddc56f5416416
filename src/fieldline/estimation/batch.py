"""Least squares over a window: one motion without process noise that explains all its vectors.

    minimise  sum_k rho( |b_k - A(q_k) B_k|^2 / r^2 )  +  |shape|^2 / s_shape^2  +  |dipole|^2 / s_dipole^2

over attitude and rate at the window's middle and, for a rigid body whose inertia is not given, its five shape numbers
(see `inertia`) and a residual dipole. Derivatives to attitude and rate are carried along with the motion; those to shape
and dipole are differences. rho is Cauchy's beyond 4 sigma, so that a spike does not steer the fit.

Source: Levenberg-Marquardt after Nocedal and Wright (2006), Numerical Optimization, s. 10.3.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numba import njit

from fieldline.estimation.inertia import SHAPE_STD, inertia_of
from fieldline.estimation.motion import RateModel, propagate, random_walk, rigid_body, told
from fieldline.estimation.series import Series
from fieldline.frames.attitude import quat_exp, quat_mul, quat_unit, to_body
from fieldline.frames.matrices import IDENTITY, matadd, matmul, skew
from fieldline.frames.vectors import put, vec

DIPOLE_STD = 1.0  # [A m2 / kg m2] prior of the residual dipole: 0.02 A m2 on a 3U cubesat
LARGEST_SHAPE = 20.0  # of a shape number: ratios of second moments beyond 1e12, which no number format bears
ROBUST_SIGMA = 4.0
ZERO9 = (0.0,) * 9


@njit(cache=True)
def _fill(series, anchor, stop, step, q, w, model, predicted, slopes):
    """Predict from the anchor towards `stop`; slopes (n, 3, 6) is filled where it has n rows."""
    seconds, field_i, pull_i = series.seconds, series.field_i, series.pull_i
    derive = slopes.shape[0] == seconds.shape[0]
    phi, psi, lam = IDENTITY, ZERO9, IDENTITY
    k = anchor
    while k != stop:
        if k != anchor:
            h = seconds[k] - seconds[k - step]
            known = told(series, k - step, k, model)
            q, w, f, g, j = propagate(q, w, known, vec(field_i, k - step), vec(pull_i, k - step), h, model)
            psi = matadd(matmul(f, psi), matmul(g, lam))
            phi = matmul(f, phi)
            lam = matmul(j, lam)
        body = to_body(q, vec(field_i, k))
        put(predicted, k, body)
        if derive:
            h_a = matmul(skew(body), phi)
            h_r = matmul(skew(body), psi)
            for row in range(3):
                for col in range(3):
                    slopes[k, row, col] = h_a[3 * row + col]
                    slopes[k, row, 3 + col] = h_r[3 * row + col]
        k += step


@njit(cache=True)
def predict_window(series, anchor, q, w, model, predicted, slopes):
    """Fill predicted (n, 3) [T] and slopes (n, 3, 6): d(b)/d(attitude error, rate) at the anchor."""
    _fill(series, anchor, series.seconds.shape[0], 1, q, w, model, predicted, slopes)
    _fill(series, anchor, -1, -1, q, w, model, predicted, slopes)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Motion:
    """A motion and how well it fits: state at `anchor` (a row), shape and dipole, cost and covariance (6, 6)."""

    q_bi: np.ndarray
    omega_b: np.ndarray
    anchor: int
    shape: np.ndarray | None = None
    inertia: np.ndarray | None = None
    dipole: np.ndarray | None = None
    cost: float = np.inf
    samples: int = 0
    covariance: np.ndarray | None = None

    @property
    def chi2(self) -> float:
        """Cost over degrees of freedom: about 1 for a motion that explains the window."""
        return self.cost / max(3 * self.samples - 6, 1)

    def model(self, noise: float = 0.0) -> RateModel:
        """The rate model of this motion."""
        if self.shape is not None:
            return rigid_body(inertia_of(self.shape), noise, self._dipole())
        if self.inertia is not None:
            return rigid_body(self.inertia, noise, self._dipole())
        return random_walk(noise)

    def _dipole(self):
        return np.zeros(3) if self.dipole is None else self.dipole


def fit_window(series: Series, start: Motion, noise_tesla: float, *, iterations: int = 25) -> Motion:
    """Refine `start` on the rows given; which parameters are free follows from what `start` carries.

    start.anchor is a row of the series. shape and dipole are free where they are not None; a given `inertia` stays.
    """
    free = 6 + (5 if start.shape is not None else 0) + (3 if start.dipole is not None else 0)
    count = len(series.seconds)
    predicted, slopes = np.empty((count, 3)), np.empty((count, 3, 6))
    jacobian = np.zeros((count, 3, free))
    data = (series, noise_tesla)
    now, damping = replace(start, cost=_cost(start, data, predicted), samples=int(series.used.sum())), 1e-3
    for _ in range(iterations):
        normal, gradient = _normal_equations(now, data, predicted, slopes, jacobian)
        if not (np.isfinite(normal).all() and np.isfinite(gradient).all()):
            break  # slopes carried across a long gap may overflow where the motion itself does not
        better = None
        for _ in range(6):
            step = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), gradient)
            trial = _moved(now, step)
            cost = _cost(trial, data, predicted)
            if cost < now.cost:
                better = replace(trial, cost=cost)
                damping = max(damping * 0.2, 1e-9)
                break
            damping *= 6.0
        if better is None:
            break
        gained = now.cost - better.cost
        now = better
        if gained < 1e-4 * max(1.0, now.cost / 1000.0):
            break
    normal, _ = _normal_equations(now, data, predicted, slopes, jacobian)
    return replace(now, covariance=np.linalg.inv(normal)[:6, :6])


def _weights(square: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Cauchy's cost and weight of squared residuals in sigma, quadratic up to ROBUST_SIGMA."""
    limit = ROBUST_SIGMA**2
    beyond = np.maximum(square / limit, 1.0)
    return np.where(square > limit, limit * (1.0 + np.log(beyond)), square), 1.0 / beyond


def _prior(motion: Motion) -> float:
    """The cost of shape and dipole."""
    cost = 0.0
    if motion.shape is not None:
        cost += float(motion.shape @ motion.shape) / SHAPE_STD**2
    if motion.dipole is not None:
        cost += float(motion.dipole @ motion.dipole) / DIPOLE_STD**2
    return cost


def _predict(motion: Motion, data, predicted, slopes) -> None:
    q, w = tuple(map(float, motion.q_bi)), tuple(map(float, motion.omega_b))
    predict_window(data[0], motion.anchor, q, w, motion.model(), predicted, slopes)


def _cost(motion: Motion, data, predicted) -> float:
    """Robust cost of a motion; infinite where it runs away."""
    series, noise = data
    if motion.shape is not None and not np.abs(motion.shape).max() < LARGEST_SHAPE:
        return np.inf
    _predict(motion, data, predicted, np.empty((0, 3, 6)))
    square = ((series.field_b - predicted)[series.used] ** 2).sum(axis=1) / noise**2
    cost = float(_weights(square)[0].sum()) + _prior(motion)
    return cost if np.isfinite(cost) else np.inf


def _normal_equations(motion: Motion, data, predicted, slopes, jacobian) -> tuple[np.ndarray, np.ndarray]:
    """J^T W J and J^T W residual with the priors on shape and dipole."""
    series, noise = data
    _predict(motion, data, predicted, slopes)
    residual = (series.field_b - predicted) / noise
    jacobian[:, :, :6] = slopes / noise
    extra = _extra(motion)
    for column in range(6, 6 + len(extra)):
        jacobian[:, :, column] = _difference(motion, column - 6, data, predicted) / noise
    weight = _weights((residual**2).sum(axis=1))[1] * series.used
    flat = (jacobian * weight[:, None, None]).reshape(-1, jacobian.shape[2])
    normal = flat.T @ jacobian.reshape(-1, jacobian.shape[2])
    gradient = flat.T @ residual.reshape(-1)
    stds = np.r_[np.full(5 if motion.shape is not None else 0, SHAPE_STD), np.full(len(extra), DIPOLE_STD)][: len(extra)]
    precision = 1.0 / stds**2
    normal[np.arange(6, 6 + len(extra)), np.arange(6, 6 + len(extra))] += precision
    gradient[6:] -= precision * extra
    return normal, gradient


def _extra(motion: Motion) -> np.ndarray:
    """Shape and dipole numbers in one array, those that are free."""
    return np.concatenate([p for p in (motion.shape, motion.dipole) if p is not None] or [np.zeros(0)])


def _with_extra(motion: Motion, extra: np.ndarray) -> Motion:
    """The motion with other shape and dipole numbers."""
    shape = None if motion.shape is None else extra[:5]
    dipole = None if motion.dipole is None else extra[-3:]
    return replace(motion, shape=shape, dipole=dipole)


def _difference(motion: Motion, index: int, data, base: np.ndarray) -> np.ndarray:
    """d(predicted)/d(extra parameter) by a forward difference."""
    extra = _extra(motion)
    extra[index] += 1e-5
    moved = np.empty_like(base)
    _predict(_with_extra(motion, extra), data, moved, np.empty((0, 3, 6)))
    return (moved - base) / 1e-5


def _moved(motion: Motion, step: np.ndarray) -> Motion:
    """The motion after a step of all free parameters; an attitude step of over 0.5 rad is shortened with the rest."""
    step = step * min(1.0, 0.5 / max(float(np.linalg.norm(step[:3])), 1e-12))
    q = quat_unit(quat_mul(tuple(map(float, motion.q_bi)), quat_exp(tuple(map(float, step[:3])))))
    moved = replace(motion, q_bi=np.array(q), omega_b=motion.omega_b + step[3:6])
    return _with_extra(moved, _extra(motion) + step[6:]) if step.size > 6 else moved
