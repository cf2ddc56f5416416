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

NO_PATH = np.empty((0, STATES))
NOTHING = (NO_PATH, np.empty((0, 9)), np.empty((0, cov.BLOCKS)), np.empty((0, 3)))  # states, errors, blocks, white
FREE_ATTITUDE_STD = 1.8  # [rad] pi / sqrt(3): any angle about the field is as likely as any other
START_ATTITUDE_STD = 0.3  # [rad] of a start that a fit has found
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
    def path(self) -> np.ndarray:
        """(n, 10) the states as one array, for linearising about them."""
        return np.hstack([self.q_bi, self.omega_b, self.slow_b])

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


def first_prior(start: np.ndarray, noise: Noise, free: bool) -> np.ndarray:
    """(1, 54) covariance before the first sample.

    free: nothing is known of the attitude, and of the rate to a fifth; a pass about a path can do with that, and its
    covariance is then the data's own. Otherwise as well as a fit's start is known: an extended filter that forgets it
    wanders off to other motions before the field has turned.
    """
    size = float(np.linalg.norm(start[4:7]))
    if free:
        return prior_blocks(FREE_ATTITUDE_STD, max(0.2 * size, np.radians(0.5)), noise.coloured)
    return prior_blocks(START_ATTITUDE_STD, max(0.05 * size, np.radians(0.2)), noise.coloured)


def log_likelihood(series: Series, start: np.ndarray, noise: Noise, model: RateModel) -> float:
    """Log-likelihood of an arc's innovations from a start (7,) that a fit has found."""
    row, prior = _start_row(start), first_prior(start, noise, False)
    return filter_forward(series, True, 0.0, row, np.zeros((1, 9)), prior, noise, model, NO_PATH, *NOTHING)


def innovations(series: Series, start: np.ndarray, noise: Noise, model: RateModel) -> tuple[np.ndarray, float]:
    """Whitened innovations (n, 3) of an arc and their log-likelihood, from a start (7,) that a fit has found."""
    row, prior = _start_row(start), first_prior(start, noise, False)
    white = np.empty_like(series.field_b)
    total = filter_forward(series, True, 0.0, row, np.zeros((1, 9)), prior, noise, model, NO_PATH, *NOTHING[:3], white)
    return white, total


def state_at_first(series: Series, row: int, state: np.ndarray, noise: Noise, model: RateModel) -> np.ndarray:
    """(7,) state at the first sample from a state at another row, by filtering backwards in time."""
    if row == 0:
        return state
    back = part(series, slice(row, None, -1))
    start, prior = _start_row(state), first_prior(state, noise, False)
    filter_forward(back, True, 0.0, start, np.zeros((1, 9)), prior, noise, model, NO_PATH, *NOTHING)
    return start[0, :7].copy()


def smooth(
    series: Series, start: np.ndarray, noise: Noise, model: RateModel, passes: int = 1, *, about: Smoothed | None = None
) -> Smoothed:
    """Filter and smooth an arc from a start (7,) at its first sample, `passes` times over; the likeliest pass counts.

    The first pass linearises about the filter's own state, or about the path of `about`; each next one about the path of
    the one before.
    """
    best = result = _smooth_once(series, start, noise, model, NO_PATH if about is None else about.path)
    for _ in range(passes - 1):
        if not np.isfinite(result.q_bi).all():
            break
        result = _smooth_once(series, result.start, noise, model, result.path)
        best = result if result.log_likelihood > best.log_likelihood else best
    return best


def _smooth_once(series: Series, start: np.ndarray, noise: Noise, model: RateModel, path: np.ndarray) -> Smoothed:
    """One pass forward, remembering the state at the chunks' borders, and one backward, chunk by chunk."""
    n = len(series.seconds)
    borders = list(range(0, n, CHUNK))
    row, prior = _start_row(start), first_prior(start, noise, path.shape[0] > 0)
    offset, saved, total = np.zeros((1, 9)), [], 0.0
    for first in borders:
        saved.append((row.copy(), offset.copy(), prior.copy()))
        if first != borders[-1]:
            chunk = slice(first, first + CHUNK)
            total += filter_forward(
                part(series, chunk), first == 0, _before(series, first), row, offset, prior, noise, model, path[chunk], *NOTHING
            )
    out = _Outputs(n)
    adjoint_v, adjoint_m = np.zeros(9), np.zeros((1, cov.BLOCKS))
    for first, (row, offset, prior) in zip(borders[::-1], saved[::-1], strict=True):
        chunk = slice(first, first + CHUNK)
        rows = part(series, chunk)
        count = len(rows.seconds)
        states, errors = np.empty((count, STATES)), np.empty((count, 9))
        blocks, white = np.empty((count, cov.BLOCKS)), np.empty((count, 3))
        common = (rows, first == 0, _before(series, first))
        gained = filter_forward(
            *common, row.copy(), offset.copy(), prior.copy(), noise, model, path[chunk], states, errors, blocks, white
        )
        if not np.isfinite(gained):
            # the filter ran away before the end: what it did not reach holds no numbers
            total, states[:], blocks[:], white[:] = -np.inf, np.nan, np.nan, np.nan
        else:
            total += gained if first == borders[-1] else 0.0
            smooth_backward(*common, row, offset, prior, noise, model, path[chunk], states, errors, blocks, adjoint_v, adjoint_m)
        out.put(slice(first, first + count), states, blocks, white)
    return out.result(total, noise, model)


def _before(series: Series, first: int) -> float:
    """[s] the sample before a row, where there is one."""
    return float(series.seconds[first - 1]) if first else 0.0


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
