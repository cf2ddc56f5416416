"""What uncertain constants do to the attitude: the smoother run once more along each principal direction of their doubt.

    P_attitude = P_smoother + sum_j e_j e_j^T,    e_j = attitude(theta + sqrt(l_j) v_j) - attitude(theta)         (1)

and along draws of what a field model lacks: an error of FIELD_MODEL_STD per axis, inertial axes, that keeps its value over
FIELD_MODEL_TIME along the orbit (degrees above the model's, crust, currents above; IGRF itself claims about 100 nT), or
what the residuals show of such an error, if that is more: errors that repeat with the spin stand still in inertial axes. (2)

with l_j, v_j the eigenvalues and vectors of theta's covariance. Process noise averages out over an arc; a bias that is
wrong by 0.1 microtesla does not, and on a spinner it sits still in the body while the attitude error it makes does not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import sqrt

import numpy as np
from numba import njit

from fieldline.estimation.polish import Constants, _with
from fieldline.estimation.series import Series, part
from fieldline.estimation.smoothing import Smoothed, smooth
from fieldline.estimation.tuning import middle_rows
from fieldline.frames.attitude import dcm_from_quaternion, rotation_error_b

MOST_DIRECTIONS = 24
FIELD_MODEL_STD = 60e-9  # [T] per axis: 100 nT in all, the model's own statement for low orbit
FIELD_MODEL_TIME = 240.0  # [s] about 1,800 km of orbit, degree 22
FIELD_DRAWS = 8


def stretch(smoothed: Smoothed, variance_factor: float) -> Smoothed:
    """Attitude covariance and rate variance times a factor."""
    return replace(
        smoothed,
        attitude_covariance_b=smoothed.attitude_covariance_b * variance_factor,
        rate_std_b=smoothed.rate_std_b * np.sqrt(variance_factor),
    )


def widen(smoothed: Smoothed, constants: Constants, series_of: Callable[[np.ndarray], Series]) -> Smoothed:
    """The smoothed arc with covariance and rate spread widened by (1)."""
    if constants.values.size == 0:
        return smoothed
    scale = np.sqrt(np.diag(constants.prior_covariance))
    values, vectors = np.linalg.eigh(constants.covariance / np.outer(scale, scale))
    # the same step about the same path without the change, so that what the iteration still moves is not taken for doubt
    base = smooth(
        series_of(constants.values[: constants.calibrated]), smoothed.start, smoothed.noise, smoothed.model, about=smoothed
    )
    covariance = smoothed.attitude_covariance_b.copy()
    rate_var = smoothed.rate_std_b**2
    for j in np.argsort(values)[::-1][:MOST_DIRECTIONS]:
        if values[j] <= 0.0:
            continue
        # a tenth of a sigma stays linear where a whole one, on a long arc, may turn the body round
        moved = _with(constants, constants.values + 0.1 * np.sqrt(values[j]) * vectors[:, j] * scale)
        series = series_of(moved.values[: constants.calibrated])
        other = smooth(series, smoothed.start, smoothed.noise, moved.model(smoothed.model), about=smoothed)
        error = 10.0 * rotation_error_b(other.q_bi, base.q_bi)
        covariance += error[:, :, None] * error[:, None, :]
        rate_var += (10.0 * (other.omega_b - base.omega_b)) ** 2
    return replace(smoothed, attitude_covariance_b=covariance, rate_std_b=np.sqrt(rate_var))


def widen_by_field_model(smoothed: Smoothed, series: Series, seed: int) -> Smoothed:
    """The covariance widened by the mean effect of FIELD_DRAWS errors of the field model (2), equal over the arc.

    The mean is over the arc and the draws, in inertial axes where such an error lives, then turned into body axes.
    """
    rows = middle_rows(series)
    arc = part(series, rows)
    rng = np.random.default_rng(seed)
    start = np.concatenate([smoothed.q_bi[rows.start], smoothed.omega_b[rows.start]])
    base = smooth(arc, start, smoothed.noise, smoothed.model, passes=2)
    base = smooth(arc, base.start, smoothed.noise, smoothed.model, about=base)
    dcm_ib = np.swapaxes(dcm_from_quaternion(base.q_bi), 1, 2)
    size = max(FIELD_MODEL_STD, standing_error(base, arc))
    spread, rate_var = np.zeros((3, 3)), np.zeros(3)
    for _ in range(FIELD_DRAWS):
        error_i = size * first_order_noise(arc.seconds, FIELD_MODEL_TIME, rng)
        other = smooth(arc._replace(field_i=arc.field_i + error_i), start, smoothed.noise, smoothed.model, about=base)
        turned_i = np.einsum("nij,nj->ni", dcm_ib, rotation_error_b(other.q_bi, base.q_bi))
        spread += turned_i.T @ turned_i / (len(turned_i) * FIELD_DRAWS)
        rate_var += ((other.omega_b - base.omega_b) ** 2).mean(axis=0) / FIELD_DRAWS
    dcm_bi = dcm_from_quaternion(smoothed.q_bi)
    covariance = smoothed.attitude_covariance_b + dcm_bi @ spread @ np.swapaxes(dcm_bi, 1, 2)
    return replace(smoothed, attitude_covariance_b=covariance, rate_std_b=np.sqrt(smoothed.rate_std_b**2 + rate_var))


@njit(cache=True)
def _remember(rows, fade):
    """White rows (n, 3) become first-order noise of the same unit spread, in place."""
    gain = sqrt(1.0 - fade * fade)
    for k in range(1, rows.shape[0]):
        for j in range(3):
            rows[k, j] = fade * rows[k - 1, j] + gain * rows[k, j]


def first_order_noise(seconds: np.ndarray, time_s: float, rng: np.random.Generator) -> np.ndarray:
    """(n, 3) Gauss-Markov noise of unit spread at `seconds`, with the correlation exp(-dt / time_s)."""
    step = float(np.median(np.diff(seconds)))
    even = np.arange(0.0, seconds[-1] - seconds[0] + 2.0 * step, step)
    coloured = rng.standard_normal((len(even), 3))
    _remember(coloured, float(np.exp(-step / time_s)))
    return np.stack([np.interp(seconds - seconds[0], even, coloured[:, k]) for k in range(3)], axis=1)


def standing_error(smoothed: Smoothed, series: Series) -> float:
    """[T] RMS per axis of the residual's mean over FIELD_MODEL_TIME in inertial axes, less what white noise would leave."""
    residual = series.field_b - smoothed.slow_b - smoothed.predicted(series)
    left_i = np.einsum("nji,nj->ni", dcm_from_quaternion(smoothed.q_bi), np.where(series.used[:, None], residual, 0.0))
    rows = max(2, round(FIELD_MODEL_TIME / float(np.median(np.diff(series.seconds)))))
    if len(left_i) < 3 * rows:
        return 0.0
    sums = np.cumsum(np.vstack([np.zeros(3), left_i]), axis=0)
    means = (sums[rows:] - sums[:-rows]) / rows
    white = float((left_i**2).mean()) / rows
    return float(np.sqrt(max((means**2).mean() - white, 0.0)))
