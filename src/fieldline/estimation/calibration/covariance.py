"""How well the parameters are known, when the residuals are not independent.

A fit of magnitudes leaves residuals that hang together over minutes (what the model does not have: heating, currents), so
that n samples are worth far fewer. The covariance is therefore the sandwich over contiguous blocks,

    cov = H^-1 (S + P) H^-1,   H = k A + P,   S = sum_blocks (sum_block psi J) (sum_block psi J)^T      (1)

A: Gauss-Newton information of the data with the robust weights, k: mean slope of the robust influence over mean weight, P:
information of the prior, psi J: score of a sample. The blocks are longer than
the residuals' memory (twice the last lag with |autocorrelation| over 0.1, at most a twelfth of the arc). S is never
taken smaller, in any direction, than with blocks of one sample, and is enlarged by b / (b - 1) for b blocks, since the fit
makes the scores' sum vanish.

The field model's own magnitude is not true either: what it lacks (crust, magnetosphere, ionosphere; 50 nT in low orbit is
our assumption, not a measurement) hangs together over ten minutes, too long to be seen in the residuals of one arc. S
therefore receives the scores that such an error would make, block of ten minutes by block.

Terms that the chosen candidate leaves out (the matrix of a bias-only fit) are not known to be absent: they enter (1) with
a prior of their own (`omitted_std`).
Source: Huber (1967); Newey and West, Econometrica 55 (1987) 703, for the idea; blocks after Cameron and Miller (2015).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fieldline.estimation.calibration.distance import block_kernel, information_of, matrix9, mirrored_half, problem_of
from fieldline.estimation.calibration.fit import (
    DEGREES,
    Fit,
    Prior,
    influence_slope,
    normal_equations,
    prior_of,
    weights_of,
    with_prior,
)
from fieldline.estimation.calibration.model import Samples, Terms, gain_sums
from fieldline.estimation.calibration.twin import twin

MEMORY_LEVEL = 0.1
LONGEST_SERIES = 131072
BLOCKS_AT_LEAST = 12
OMITTED_FACTOR = 3.0
OMITTED_MATRIX_STD = 0.1
FIELD_MODEL_STD_TESLA = 50e-9  # of the magnitude; our own assumption for a quiet day, with no source behind it
FIELD_MODEL_MEMORY_S = 600.0  # some 4000 km of ground track


def autocorrelation(series: np.ndarray) -> np.ndarray:
    """(n // BLOCKS_AT_LEAST,) autocorrelation from lag 0, by the fast Fourier transform."""
    series = np.asarray(series[:LONGEST_SERIES], dtype=float)
    series = series - series.mean()
    n = len(series)
    power = np.abs(np.fft.rfft(series, 2 * n)) ** 2
    lags = np.fft.irfft(power, 2 * n)[: max(2, n // BLOCKS_AT_LEAST)]
    return lags / lags[0] if lags[0] > 0 else np.eye(1, len(lags))[0]


def clipped(fit: Fit) -> np.ndarray:
    """Residuals as the robust fit weighs them: outliers do not hide or feign memory."""
    return fit.residual * weights_of(fit.residual, fit.scale)


def memory_samples(series: np.ndarray) -> int:
    """Last lag at which the autocorrelation stands out of its own noise and over MEMORY_LEVEL."""
    lags = np.abs(autocorrelation(series))
    above = np.flatnonzero(lags > max(MEMORY_LEVEL, 3.0 / np.sqrt(min(len(series), LONGEST_SERIES))))
    return int(above.max()) if len(above) else 0


def effective_samples(series: np.ndarray) -> float:
    """How many independent samples they are worth: n / (1 + 2 sum rho), up to the first lag where rho is lost in noise."""
    lags = autocorrelation(series)
    lost = np.flatnonzero(lags < 2.0 / np.sqrt(min(len(series), LONGEST_SERIES)))
    stop = lost[0] if len(lost) else len(lags)
    return len(series) / float(1.0 + 2.0 * np.sum(lags[1:stop]))


def block_length(fit: Fit) -> int:
    """Samples per block of (1)."""
    return max(1, min(2 * memory_samples(clipped(fit)), len(fit.residual) // BLOCKS_AT_LEAST))


def score_spread(
    terms: Terms, theta: np.ndarray, samples: Samples, scale: float, length: int, error: float | None = None
) -> np.ndarray:
    """S of (1) for blocks of `length` samples: of the residuals, or of a constant `error` in their place."""
    if length == 1 and error is None:
        return information_of(terms, theta, samples, scale, DEGREES, squared=True)[0].dense()
    spread, problem, matrix = np.zeros((terms.size, terms.size)), problem_of(terms, samples), matrix9(terms, theta)
    block_kernel(theta, matrix, *problem, scale, DEGREES, np.nan if error is None else error, length, spread)
    return mirrored_half(spread)


def field_model_block(samples: Samples) -> int:
    """Samples within the field model's memory."""
    step = float(np.median(np.diff(samples.seconds)[np.diff(samples.flight) == 0]))
    return max(1, round(FIELD_MODEL_MEMORY_S / step))


def omitted_std(fit: Fit, samples: Samples) -> float:
    """Spread of a matrix that was left out, as a fraction of the field.

    Raw magnitudes that agree vouch for the sensor: thrice their RMS. Once a bias was fitted they vouch for nothing, since
    it takes up what a matrix would have shown.
    """
    inside = np.abs(fit.residual) < 6.0 * fit.scale
    agreement = OMITTED_FACTOR * float(np.sqrt(np.mean(fit.residual[inside] ** 2)) / np.median(samples.magnitude))
    return min(agreement, OMITTED_MATRIX_STD) if not fit.terms.bias else OMITTED_MATRIX_STD


def widened(fit: Fit, samples: Samples) -> tuple[Terms, np.ndarray, Prior]:
    """The candidate with bias and full matrix whether fitted or not, its parameters, and their priors."""
    terms = replace(fit.terms, bias=True, matrix="full")
    theta = np.zeros(terms.size)
    theta[terms.layout["bias"]] = fit.terms.bias_of(fit.theta)
    theta[terms.layout["matrix"]] = fit.terms.matrix_of(fit.theta)[(0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)]
    for name, place in terms.layout.items():
        if name not in ("bias", "matrix"):
            theta[place] = fit.theta[fit.terms.layout[name]]
    prior = prior_of(terms, samples)
    information, spread = prior.information.copy(), omitted_std(fit, samples) ** -2.0
    if not fit.terms.bias:
        information[terms.layout["bias"]] = spread
    if fit.terms.matrix != "full":
        information[terms.layout["matrix"]] = np.maximum(spread, information[terms.layout["matrix"]])
    return terms, theta, Prior(theta if fit.terms.matrix != "full" else prior.mean, information, gain_sums(terms, samples) / 1e-6)


def covariance_of(
    fit: Fit, samples: Samples, field_model_std: float, bounded: bool = False
) -> tuple[Terms, np.ndarray, np.ndarray]:
    """The widened terms and parameters, and their covariance (1); `field_model_std` in units of the samples.

    `bounded`: for the greater of the two S take their sum, which is no smaller and needs no eigenvectors.
    """
    terms, theta, prior = widened(fit, samples)
    samples = samples.lengthened(fit.scale)
    information = normal_equations(terms, theta, samples, fit.scale)[0].dense()
    information *= influence_slope(fit.residual, fit.scale)
    length = block_length(fit)
    blocks = len(samples) / length
    spread = score_spread(terms, theta, samples, fit.scale, length) * blocks / (blocks - 1.0)
    single = score_spread(terms, theta, samples, fit.scale, 1)
    # Unseen directions have no scores at all: a trace of the information keeps the floor's factor invertible.
    single += 1e-9 * np.diag(np.diag(information) + prior.information)
    greater = spread + single if bounded else _greater(spread, single)
    inverse = np.linalg.inv(with_prior(information, prior))
    modelled = score_spread(terms, theta, samples, fit.scale, field_model_block(samples), field_model_std)
    covariance = inverse @ (greater + np.diag(prior.information) + modelled) @ inverse
    worth = len(samples) / effective_samples(clipped(fit)) + field_model_block(samples) * (field_model_std / fit.scale) ** 2
    away, odds = twin(fit, samples, worth)
    return terms, theta, covariance + odds * np.outer(*[_as_widened(fit, terms, away)] * 2)


def _greater(spread: np.ndarray, single: np.ndarray) -> np.ndarray:
    """The matrix that is `spread` but in no direction less than `single`."""
    root = np.linalg.cholesky(single)
    inside = np.linalg.solve(root, np.linalg.solve(root, spread).T)
    values, vectors = np.linalg.eigh(0.5 * (inside + inside.T))
    half = root @ vectors * np.sqrt(np.maximum(values, 1.0))
    return half @ half.T


def _as_widened(fit: Fit, terms: Terms, away: np.ndarray) -> np.ndarray:
    """A difference of the candidate's parameters in the widened vector."""
    out = np.zeros(terms.size)
    for name, place in fit.terms.layout.items():
        if name != "matrix" or fit.terms.matrix == "full":
            out[terms.layout[name]] = away[place]
        else:
            out[terms.layout[name]][:3] = away[place]
    return out
