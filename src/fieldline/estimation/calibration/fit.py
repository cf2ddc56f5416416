"""The robust fit: Levenberg-Marquardt on Student's likelihood, by normal equations in bounded memory.

    cost = sum_k (nu + 1)/2 log(1 + d_k^2 / (nu s^2)) + 1/2 sum_j ((theta_j - mu_j)/sigma_j)^2     (1)
    weight of a sample = (nu + 1)/(nu + d^2/s^2)                                                   (2)

with nu = 4: gross errors lose their pull, and on Gaussian noise 7 % of efficiency is paid. The scale s is the median of
|d| times 1.4826, renewed between rounds. The priors (1) only stop directions that the data do not see from running away;
they are wide against what any sensor shows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fieldline.estimation.calibration.arrow import Arrow
from fieldline.estimation.calibration.distance import distances, information_of
from fieldline.estimation.calibration.model import Samples, Terms, gain_sums

DEGREES = 4.0
GAIN_STD = 0.05  # a slow gain of more than a few per cent would be a broken sensor
BIAS_FACTOR = 3.0  # a bias shows in the raw magnitudes by about its own size; along unseen axes it is not much larger
LEAST_BIAS_STD = 0.01  # of the field
MATRIX_STD = 0.15
MEAN_GAIN_STD = 1e-6  # the mean gain belongs to D; this fixes it at 1
SCALE_FLOOR = 1e-7  # of the field: a few pT, so that noise-free tests have a scale
OUTLIER_SIGMAS = 6.0
LARGEST_DAMPING = 1e8
SETTLED = 1e-4  # of the cost, where one sigma of a parameter is 0.5
NEARLY_SETTLED = 1e-2  # a seventh of a sigma: enough for a start and for what held-out samples tell
LEAST_SLOPE = 0.3


@dataclass(frozen=True, slots=True)
class Prior:
    """Gaussian prior: centre and information of the parameters, and the row that fixes the mean gain."""

    mean: np.ndarray
    information: np.ndarray
    gain_row: np.ndarray


@dataclass(frozen=True, slots=True)
class Fit:
    """A converged candidate, scaled."""

    terms: Terms
    theta: np.ndarray
    residual: np.ndarray
    scale: float
    cost: float
    converged: bool


def prior_of(terms: Terms, samples: Samples) -> Prior:
    """Wide priors for every term that the candidate has."""
    reach = float(np.median(np.linalg.norm(samples.field_s, axis=1)) + np.median(samples.magnitude))
    raw = float(np.median(np.abs(np.linalg.norm(samples.field_s, axis=1) - samples.magnitude)))
    stds = {
        "bias": BIAS_FACTOR * raw + LEAST_BIAS_STD, "matrix": MATRIX_STD, "temperature": GAIN_STD, "drift": reach,
        "dipole": reach, "current": reach, "sunlit": reach, "gain": GAIN_STD,
    }  # fmt: skip
    mean, information = np.zeros(terms.size), np.zeros(terms.size)
    for name, place in terms.layout.items():
        information[place] = stds[name] ** -2.0
    if terms.matrix != "none":
        place = terms.layout["matrix"]
        mean[place] = np.ones(1) if terms.matrix == "scale" else np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    return Prior(mean, information, gain_sums(terms, samples) / MEAN_GAIN_STD)


def robust_scale(residual: np.ndarray) -> float:
    """1.4826 times the median of |r|, with a floor."""
    return max(1.4826 * float(np.median(np.abs(residual))), SCALE_FLOOR)


def weights_of(residual: np.ndarray, scale: float) -> np.ndarray:
    """Equation (2)."""
    return (DEGREES + 1.0) / (DEGREES + (residual / scale) ** 2)


def log_loss(residual: np.ndarray, scale: float) -> np.ndarray:
    """Negative logarithm of Student's density of each residual, up to a constant of nu."""
    return 0.5 * (DEGREES + 1.0) * np.log1p((residual / scale) ** 2 / DEGREES) + np.log(scale)


def cost_of(prior: Prior, theta: np.ndarray, residual: np.ndarray, scale: float) -> float:
    """Equation (1)."""
    away = theta - prior.mean
    return float(
        np.sum(log_loss(residual, scale)) - len(residual) * np.log(scale)
        + 0.5 * np.sum(prior.information * away**2) + 0.5 * float(prior.gain_row @ theta) ** 2
    )  # fmt: skip


def normal_equations(terms: Terms, theta: np.ndarray, samples: Samples, scale: float) -> tuple[Arrow, np.ndarray]:
    """Sum of weight J J^T / s^2 and of weight J r / s^2; the data alone."""
    return information_of(terms, theta, samples, scale, DEGREES)


def with_prior(matrix: np.ndarray, prior: Prior) -> np.ndarray:
    """The information of data and prior together."""
    return matrix + np.diag(prior.information) + np.outer(prior.gain_row, prior.gain_row)


def influence_slope(residual: np.ndarray, scale: float) -> float:
    """Mean of d psi / d r over the mean weight: how much less than its weights a robust fit resists being pulled."""
    x2 = (residual / scale) ** 2
    slope = (DEGREES + 1.0) * (DEGREES - x2) / (DEGREES + x2) ** 2
    return max(LEAST_SLOPE, float(np.mean(slope) / np.mean(weights_of(residual, scale))))


def fit(
    terms: Terms, theta: np.ndarray, samples: Samples, prior: Prior, *,
    rounds: int = 5, steps: int = 40, settled: float = SETTLED, scale: float | None = None,
) -> Fit:  # fmt: skip
    """Minimise (1) from `theta` and, where it is known, from a scale, which each round renews."""
    if scale is None:
        scale = robust_scale(distances(terms, theta, samples))
    if not terms.size:
        residual = distances(terms, theta, samples.lengthened(scale))
        scale = robust_scale(residual)
        return Fit(terms, theta, residual, scale, cost_of(prior, theta, residual, scale), True)
    residual, converged = np.empty(0), False
    for _ in range(rounds):
        expected = samples.lengthened(scale)
        residual = distances(terms, theta, expected)
        theta, residual, converged = _descend(terms, theta, residual, expected, prior, scale, steps, settled)
        renewed = robust_scale(residual)
        steady = abs(np.log(renewed / scale)) < 1e-3
        scale = renewed
        if steady:
            break
    return Fit(terms, theta, residual, scale, cost_of(prior, theta, residual, scale), converged)


def _descend(
    terms: Terms, theta: np.ndarray, residual: np.ndarray, samples: Samples, prior: Prior, scale: float, steps: int,
    settled: float,
) -> tuple[np.ndarray, np.ndarray, bool]:  # fmt: skip
    """Levenberg-Marquardt at a fixed scale; True when another step promises nothing.

    Gauss-Newton's matrix with the weights (2) is stiffer than the cost by `influence_slope`; without it every step would fall
    short by a third.
    """
    cost, damping = cost_of(prior, theta, residual, scale), 1e-6
    matrix, gradient = _system(terms, theta, samples, prior, scale, residual)
    for _ in range(steps):
        step = _step(matrix, gradient, damping, prior.gain_row)
        promised = -float(gradient @ step)
        trial = theta + step
        trial_residual = distances(terms, trial, samples)
        trial_cost = cost_of(prior, trial, trial_residual, scale)
        if trial_cost <= cost:
            theta, residual, cost, damping = trial, trial_residual, trial_cost, max(damping * 0.1, 1e-12)
        if promised < settled or damping > LARGEST_DAMPING:
            return theta, residual, True
        if theta is trial:
            matrix, gradient = _system(terms, theta, samples, prior, scale, residual)
        else:
            damping = max(damping * 10.0, 1e-6)
    return theta, residual, False


def _system(
    terms: Terms, theta: np.ndarray, samples: Samples, prior: Prior, scale: float, residual: np.ndarray
) -> tuple[Arrow, np.ndarray]:
    """Curvature, but for the row that fixes the mean gain, and gradient of (1)."""
    matrix, gradient = normal_equations(terms, theta, samples, scale)
    row = prior.gain_row
    curvature = matrix.scaled(influence_slope(residual, scale)).with_diagonal(prior.information)
    return curvature, gradient + prior.information * (theta - prior.mean) + row * float(row @ theta)


def _step(curvature: Arrow, gradient: np.ndarray, damping: float, row: np.ndarray) -> np.ndarray:
    """- (curvature, damped, + row row^T)^-1 gradient, by Sherman and Morrison's formula, since the row fills the band."""
    both = curvature.with_diagonal(damping * curvature.diagonal()).solve(np.stack([gradient, row], axis=1))
    return both[:, 1] * float(row @ both[:, 0]) / (1.0 + float(row @ both[:, 1])) - both[:, 0]
