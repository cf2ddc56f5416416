"""One pass of the filter and the smoother over an arc, in bounded memory, and passes repeated until the start settles.

The filter keeps only its state at the chunks' borders; the smoother runs the chunks again, last first, and carries its
adjoint from one to the next. The first pass from a guess linearises about a wrong path; the next ones start from the
smoothed first sample, which is what makes a coarse guess converge.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fieldline.estimation import covariance as cov
from fieldline.estimation.kalman import CHUNK, STATES, Noise, filter_forward, predicted_fields, prior_blocks, smooth_backward
from fieldline.estimation.motion import RateModel
from fieldline.estimation.series import Series, part

EMPTY_STATES, EMPTY_BLOCKS, EMPTY_WHITE = np.empty((0, STATES)), np.empty((0, cov.BLOCKS)), np.empty((0, 3))
FIRST_ATTITUDE_STD = 1.0  # [rad] the first sample's attitude is free
DIAGONAL = np.array([0, 4, 8])


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Smoothed:
    """Smoothed states of an arc.

    q_bi (n, 4), omega_b (n, 3) [rad/s], slow_b (n, 3) [T] coloured error of the measurement; attitude_covariance_b
    (n, 3, 3) [rad2], rate_std_b (n, 3) [rad/s]; white (n, 3): the filter's innovations whitened by their covariance, NaN
    where not used; log_likelihood of the innovations; noise and model that it was run with.
    """

    q_bi: np.ndarray
    omega_b: np.ndarray
    slow_b: np.ndarray
    attitude_covariance_b: np.ndarray
    rate_std_b: np.ndarray
    white: np.ndarray
    log_likelihood: float
    noise: Noise
    model: RateModel

    @property
    def start(self) -> np.ndarray:
        """(7,) attitude and rate at the first sample."""
        return np.concatenate([self.q_bi[0], self.omega_b[0]])

    @property
    def nis(self) -> np.ndarray:
        """(n,) normalised innovation squared, NaN where not used; its expectation is 3."""
        return (self.white**2).sum(axis=1)

    def predicted(self, series: Series) -> np.ndarray:
        """(n, 3) [T] the reference field in the estimated body axes."""
        body = np.empty_like(series.field_i)
        predicted_fields(self.q_bi, series.field_i, body)
        return body


def _start_row(start: np.ndarray) -> np.ndarray:
    row = np.zeros((1, STATES))
    row[0, : len(start)] = start
    return row


def rate_prior(start: np.ndarray) -> float:
    """[rad/s] spread of the first rate: a fifth of it, at least 0.5 deg/s, for a start that came from a fit."""
    return max(0.2 * float(np.linalg.norm(start[4:7])), np.radians(0.5))


def log_likelihood(series: Series, start: np.ndarray, noise: Noise, model: RateModel) -> float:
    """Log-likelihood of an arc's innovations from a start (7,), the first attitude free."""
    row, prior = _start_row(start), prior_blocks(FIRST_ATTITUDE_STD, rate_prior(start), noise.coloured)
    return filter_forward(series, True, 0.0, row, prior, noise, model, EMPTY_STATES, EMPTY_BLOCKS, EMPTY_WHITE)


def innovations(series: Series, start: np.ndarray, noise: Noise, model: RateModel) -> tuple[np.ndarray, float]:
    """Whitened innovations (n, 3) of an arc and their log-likelihood, from a start (7,), the first attitude free."""
    row, prior = _start_row(start), prior_blocks(FIRST_ATTITUDE_STD, rate_prior(start), noise.coloured)
    white = np.empty_like(series.field_b)
    total = filter_forward(series, True, 0.0, row, prior, noise, model, EMPTY_STATES, EMPTY_BLOCKS, white)
    return white, total


def state_at_first(series: Series, row: int, state: np.ndarray, noise: Noise, model: RateModel) -> np.ndarray:
    """(7,) state at the first sample from a state at another row, by filtering backwards in time."""
    if row == 0:
        return state
    back = part(series, slice(row, None, -1))
    start, prior = _start_row(state), prior_blocks(0.3, rate_prior(state), noise.coloured)
    filter_forward(back, True, 0.0, start, prior, noise, model, EMPTY_STATES, EMPTY_BLOCKS, EMPTY_WHITE)
    return start[0, :7].copy()


def smooth(series: Series, start: np.ndarray, noise: Noise, model: RateModel, passes: int = 1, progress=None) -> Smoothed:
    """Filter and smooth an arc from a start (7,) at its first sample, `passes` times over; the likeliest pass counts."""
    best = None
    for turn in range(passes):
        result = _smooth_once(series, start, noise, model, progress if turn == passes - 1 else None)
        start = result.start
        if best is None or result.log_likelihood > best.log_likelihood:
            best = result
        if not np.isfinite(start).all():
            break
    return best


def _smooth_once(series: Series, start: np.ndarray, noise: Noise, model: RateModel, progress) -> Smoothed:
    n = len(series.seconds)
    borders = list(range(0, n, CHUNK))
    row, prior = _start_row(start), prior_blocks(FIRST_ATTITUDE_STD, rate_prior(start), noise.coloured)
    saved, total = [], 0.0
    for k, first in enumerate(borders):
        saved.append((row.copy(), prior.copy()))
        if k < len(borders) - 1:
            rows = part(series, slice(first, first + CHUNK))
            before = float(series.seconds[first - 1]) if first else 0.0
            total += filter_forward(rows, first == 0, before, row, prior, noise, model, EMPTY_STATES, EMPTY_BLOCKS, EMPTY_WHITE)
    out = _Outputs(n)
    adjoint_v, adjoint_m = np.zeros(9), np.zeros((1, cov.BLOCKS))
    for k in range(len(borders) - 1, -1, -1):
        first = borders[k]
        rows = part(series, slice(first, first + CHUNK))
        before = float(series.seconds[first - 1]) if first else 0.0
        count = len(rows.seconds)
        states, blocks, white = np.empty((count, STATES)), np.empty((count, cov.BLOCKS)), np.empty((count, 3))
        row, prior = saved[k]
        gained = filter_forward(rows, first == 0, before, row.copy(), prior.copy(), noise, model, states, blocks, white)
        total += gained if k == len(borders) - 1 else 0.0
        smooth_backward(rows, first == 0, before, row, prior, noise, model, states, blocks, adjoint_v, adjoint_m)
        out.put(slice(first, first + count), states, blocks, white)
        if progress is not None:
            progress(n - first, n)
    return out.result(total, noise, model)


class _Outputs:
    """The columns of a `Smoothed` while chunks arrive."""

    def __init__(self, n: int):
        self.states = np.empty((n, STATES))
        self.attitude = np.empty((n, 9))
        self.rate_var = np.empty((n, 3))
        self.white = np.empty((n, 3))

    def put(self, rows: slice, states, blocks, white) -> None:
        """Store one chunk."""
        self.states[rows] = states
        self.attitude[rows] = blocks[:, :9]
        self.rate_var[rows] = blocks[:, 18 + DIAGONAL]
        self.white[rows] = white

    def result(self, total: float, noise: Noise, model: RateModel) -> Smoothed:
        """The finished record; rounding may leave a variance below zero where the prior was 1e10 times wider."""
        return Smoothed(
            q_bi=self.states[:, :4],
            omega_b=self.states[:, 4:7],
            slow_b=self.states[:, 7:10],
            attitude_covariance_b=self.attitude.reshape(-1, 3, 3),
            rate_std_b=np.sqrt(np.maximum(self.rate_var, 0.0)),
            white=self.white,
            log_likelihood=total,
            noise=noise,
            model=model,
        )
