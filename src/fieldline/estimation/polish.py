"""Constants of a flight found with the attitude: calibration, inertia ratios, residual dipole.

    maximise over theta   h ( log p(innovations | theta) + V(theta) )  -  1/2 (theta - prior)^T P^-1 (theta - prior)  (1)
    h = 1 / (1 + 2 sum_k r_k^2)                                                                                 (2)

    V = sum_k log | d field_b / d field_s |_k                                                                   (3)

(3) makes it a likelihood of the readings: without it, a matrix that shrinks the readings shrinks their noise and wins.
Climbed by Gauss-Newton on the filter's whitened innovations: their derivative to theta is a difference of two runs of the filter,
which re-estimates attitude, rate and slow error by itself. So a vector recalibration (bias and symmetric matrix, twelve
numbers of which three are the attitude's) costs one run per number, and a step is taken only if (1) grows: a loop from a
wrong basin stops instead of running away.

h is what the innovations' memory leaves of their number (Bartlett's formula, r_k their autocorrelation): a spinner's
errors repeat with the spin, and 5,000 samples that say the same thing 40 times over must not outvote the magnitudes.

The calibration's prior is the one that the magnitudes gave, at twice its variance, because the same magnitudes are in the
innovations too. The inverse of the normal matrix is the covariance of theta, from which `systematics` widens the
attitude's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fieldline.estimation.batch import DIPOLE_STD
from fieldline.estimation.inertia import SHAPE_STD, inertia_of
from fieldline.estimation.kalman import Noise
from fieldline.estimation.motion import RateModel, rigid_body
from fieldline.estimation.series import Series
from fieldline.estimation.smoothing import innovations

LEAST_GAIN = 0.5  # of the logarithm (1): less is not worth another run
MAGNITUDES_COUNT_TWICE = 2.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Constants:
    """theta with its prior: calibration numbers first, then five of shape and three of the dipole where they are free.

    values (p,), prior_mean (p,), prior_covariance (p, p), covariance (p, p) after the fit; calibration numbers come first,
    `calibrated` of them; shape, dipole: whether they are free; inertia: given one, else None.
    """

    values: np.ndarray
    prior_mean: np.ndarray
    prior_covariance: np.ndarray
    covariance: np.ndarray
    calibrated: int
    shape: bool
    dipole: bool
    inertia: np.ndarray | None = None

    def model(self, like: RateModel) -> RateModel:
        """The rate model with these constants and the rate noise of `like`."""
        if not self.dipole:
            return like
        body = self.values[self.calibrated :]
        inertia = inertia_of(body[:5]) if self.shape else self.inertia
        return rigid_body(inertia, like.noise, body[-3:])

    @property
    def body_names(self) -> list[str]:
        """Names of the numbers that are not the calibration's."""
        shape = [f"shape_{k}" for k in range(5)] if self.shape else []
        return shape + ([f"dipole_{a}" for a in "xyz"] if self.dipole else [])


def gather_constants(calibration_values, calibration_covariance, shape, dipole, inertia) -> Constants:
    """Constants to polish; any group may be empty (None)."""
    calibration_values = np.zeros(0) if calibration_values is None else np.asarray(calibration_values, dtype=float)
    groups = [calibration_values]
    spreads = [MAGNITUDES_COUNT_TWICE * np.asarray(calibration_covariance)] if calibration_values.size else []
    mean = [calibration_values]
    for numbers, std in ((shape, SHAPE_STD), (dipole, DIPOLE_STD)):
        if numbers is not None:
            groups.append(np.asarray(numbers, dtype=float))
            mean.append(np.zeros(len(numbers)))
            spreads.append(std**2 * np.eye(len(numbers)))
    size = sum(len(g) for g in groups)
    prior = np.zeros((size, size))
    at = 0
    for spread in spreads:
        prior[at : at + len(spread), at : at + len(spread)] = spread
        at += len(spread)
    return Constants(
        values=np.concatenate(groups),
        prior_mean=np.concatenate(mean),
        prior_covariance=prior,
        covariance=prior,
        calibrated=calibration_values.size,
        shape=shape is not None,
        dipole=dipole is not None,
        inertia=inertia,
    )


def polish(
    constants: Constants,
    series_of: Callable[[np.ndarray], Series],
    volume_of: Callable[[np.ndarray], float],
    start: np.ndarray,
    noise: Noise,
    like: RateModel,
    *,
    rounds: int = 5,
) -> tuple[Constants, float]:
    """Constants that maximise (1), with their covariance, and the gain of (1).

    series_of(calibration numbers) gives the arc calibrated with them, volume_of the V of (3); start (7,) is the state at
    its first row.
    """
    if constants.values.size == 0:
        return constants, 0.0
    # scaled by the prior's spread, the normal matrix is well conditioned whatever the units
    scale = np.sqrt(np.diag(constants.prior_covariance))
    precision = np.linalg.inv(constants.prior_covariance / np.outer(scale, scale))

    share = effective_share(innovations(series_of(constants.values[: constants.calibrated]), start, noise, like)[0])

    def run(values):
        trial = _with(constants, values)
        white, total = innovations(series_of(values[: constants.calibrated]), start, noise, trial.model(like))
        off = (values - constants.prior_mean) / scale
        total += volume_of(values[: constants.calibrated])
        return np.nan_to_num(white), share * total - 0.5 * off @ precision @ off

    values, (white, score) = constants.values, run(constants.values)
    if not np.isfinite(score):
        return constants, 0.0
    first, normal = score, precision
    for _ in range(rounds):
        slopes = _slopes(run, values, white, scale, noise.gate)
        weight = np.minimum(1.0, noise.gate / np.maximum((white**2).sum(axis=1), 1e-12))[:, None]
        flat = (slopes * weight[..., None]).reshape(-1, values.size)
        normal = share * flat.T @ slopes.reshape(-1, values.size) + precision
        gradient = -share * flat.T @ white.reshape(-1) - precision @ ((values - constants.prior_mean) / scale)
        first_v, second_v = _volume_slopes(volume_of, values, scale, constants.calibrated)
        gradient[: constants.calibrated] += share * first_v
        normal[np.arange(constants.calibrated), np.arange(constants.calibrated)] += share * second_v
        step = np.linalg.solve(normal, gradient)
        taken = _line_search(run, values, step * scale, score)
        if taken is None:
            break
        gained = taken[2] - score
        values, white, score = taken
        if gained < LEAST_GAIN:
            break
    covariance = np.linalg.inv(normal) * np.outer(scale, scale)
    return _with(constants, values, covariance), float(score - first)


def effective_share(white: np.ndarray) -> float:
    """Share h of (2) for whitened innovations (n, 3): 1 for white ones; rows not used count as zero."""
    rows = np.nan_to_num(white)
    rows = rows * np.minimum(1.0, 5.0 / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-12))
    n = len(rows)
    size = 1 << (2 * n - 1).bit_length()
    power = (np.abs(np.fft.rfft(rows, size, axis=0)) ** 2).sum(axis=1)
    memory = np.fft.irfft(power)[: max(2, n // 4)]
    squares = (memory[1:] / max(memory[0], 1e-300)) ** 2
    # white noise has squares of 1 / (3 n) by chance
    return float(1.0 / (1.0 + 2.0 * max(squares.sum() - len(squares) / (3.0 * n), 0.0)))


def _with(constants: Constants, values: np.ndarray, covariance: np.ndarray | None = None) -> Constants:
    """The constants with other values."""
    from dataclasses import replace

    return replace(constants, values=values, covariance=constants.covariance if covariance is None else covariance)


def _slopes(run, values: np.ndarray, white: np.ndarray, scale: np.ndarray, gate: float) -> np.ndarray:
    """d(white)/d(values / scale) (n, 3, p) by differences, each over a step that moves the innovations by about 0.1."""
    slopes = np.empty((*white.shape, values.size))
    for k in range(values.size):
        step = 1e-3
        for _ in range(3):
            moved = values.copy()
            moved[k] += step * scale[k]
            change = np.clip(run(moved)[0] - white, -gate, gate)
            size = float(np.sqrt(np.mean(change**2)))
            if 1e-4 < size < 0.3:
                break
            step *= 0.05 / max(size, 1e-6)
        slopes[:, :, k] = change / step
    return slopes


def _volume_slopes(volume_of, values: np.ndarray, scale: np.ndarray, calibrated: int) -> tuple[np.ndarray, np.ndarray]:
    """First derivatives of (3) to the calibration numbers over their scale, and minus its second ones where that is positive."""
    first, second = np.zeros(calibrated), np.zeros(calibrated)
    base = values[:calibrated]
    middle = volume_of(base) if calibrated else 0.0
    for k in range(calibrated):
        step = np.zeros(calibrated)
        step[k] = 0.01 * scale[k]
        above, below = volume_of(base + step), volume_of(base - step)
        first[k] = (above - below) / 0.02
        second[k] = max(0.0, -(above - 2.0 * middle + below) / 1e-4)
    return first, second


def _line_search(run, values, step, score):
    """The first of the full, half, quarter … step that raises the score, or None."""
    for shrink in (1.0, 0.5, 0.2, 0.05):
        trial = values + shrink * step
        white, total = run(trial)
        if np.isfinite(total) and total > score:
            return trial, white, total
    return None
