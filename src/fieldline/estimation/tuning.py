"""How noisy the magnetometer is and how freely the rate wanders, read from the data.

The likelihood of the filter's innovations is climbed over the logarithms of white noise, slow error, its correlation time
and the rate's noise. The magnitude guards the climb: what it leaves, no attitude can explain, and errors do not know which way
the field points, so the white noise and the slow error together must be as large as its residual, within a quarter. (1)
Without (1) a likelihood alone lets the rate follow every error of a magnetically dirty body, or the slow error take over
what is motion.
"""

from __future__ import annotations

import numpy as np

from fieldline.estimation.kalman import Noise
from fieldline.estimation.motion import LARGEST_TURN, RateModel
from fieldline.estimation.series import Series
from fieldline.estimation.smoothing import log_likelihood

LARGEST_EXCESS = np.log(1.25)  # of the noise over the magnitude's residual
FEWEST = 2_000
LONGEST = 20_000  # rows that a tuning reads: the middle of a longer arc
RATE_NOISES = np.geomspace(1e-7, 1e-2, 11)  # [rad/s/sqrt(s)] first look, from a quiet boom to a thruster


def magnitude_noise(series: Series) -> float:
    """[T] robust RMS per axis of |b| - |B|, what no attitude explains; quantisation and model error included."""
    used = series.used
    left = np.linalg.norm(series.field_b[used], axis=1) - np.linalg.norm(series.field_i[used], axis=1)
    inner = 1.4826 * np.median(np.abs(left - np.median(left)))
    return float(max(np.sqrt(np.mean(np.clip(left, -5 * inner, 5 * inner) ** 2)), 1e-9))


def middle_rows(series: Series, parts: int = 1) -> slice:
    """At most LONGEST rows from the middle of an arc, fewer where each takes several substeps (`substeps`)."""
    n = len(series.seconds)
    most = max(FEWEST, LONGEST // parts)
    first = max(0, (n - most) // 2)
    return slice(first, min(n, first + most))


def substeps(series: Series, model: RateModel, start: np.ndarray) -> int:
    """How many substeps the rate model takes between two samples."""
    if not model.rigid:
        return 1
    return 1 + int(np.linalg.norm(start[4:7]) * float(np.median(np.diff(series.seconds))) / LARGEST_TURN)


def best_rate_noise(series: Series, start: np.ndarray, noise: Noise, model: RateModel) -> RateModel:
    """The model with the rate noise of RATE_NOISES under which the arc is likeliest, climbing from the nearest to its own."""
    seen: dict[int, float] = {}

    def value(index: int) -> float:
        if index not in seen:
            seen[index] = _finite(log_likelihood(series, start, noise, model._replace(noise=float(RATE_NOISES[index]))))
        return seen[index]

    at = int(np.argmin(np.abs(np.log(RATE_NOISES / max(model.noise, RATE_NOISES[0])))))
    while True:
        best = max((k for k in (at - 1, at, at + 1) if 0 <= k < len(RATE_NOISES)), key=value)
        if best == at:
            return model._replace(noise=float(RATE_NOISES[at]))
        at = best


def tune(
    series: Series, start: np.ndarray, noise: Noise, model: RateModel, floor: float, *, hold_rate: bool = False
) -> tuple[Noise, RateModel, float]:
    """Noise and model with the greatest likelihood, under (1); returns the log-likelihood too.

    start (7,) holds at the first row of the series; floor [T] is `magnitude_noise`. hold_rate leaves the rate's noise alone.
    """
    from scipy.optimize import minimize

    def decode(x):
        low, high = _bounds(floor)
        white, coloured, time = np.exp(np.clip(x[:3], low[:3], high[:3]))
        rate = model.noise if hold_rate else np.exp(np.clip(x[3], low[3], high[3]))
        return noise._replace(white=white, coloured=coloured, coloured_time=time), model._replace(noise=rate)

    def cost(x):
        trial, rate = decode(x)
        total = -_finite(log_likelihood(series, start, trial, rate))
        size = np.log(np.hypot(trial.white, trial.coloured) / floor)
        off = max(-size, 0.0) + max(size - LARGEST_EXCESS, 0.0)
        low, high = _bounds(floor)
        outside = np.sum((x - np.clip(x, low[: x.size], high[: x.size])) ** 2)
        # a floor that is missed by a tenth costs as much as the likelihood can gain over a few hundred samples
        return total + 1e4 * off**2 + 1e3 * outside

    x = np.log([noise.white, max(noise.coloured, 0.1 * floor), noise.coloured_time, model.noise])[: 3 if hold_rate else 4]
    simplex = x + np.vstack([np.zeros(x.size), np.diag([0.5, 0.7, 1.0, 1.2][: x.size])])
    options = {"xatol": 0.03, "fatol": 0.3, "maxfev": 160, "initial_simplex": simplex}
    found = minimize(cost, x, method="Nelder-Mead", options=options)
    tuned, rate = decode(found.x)
    return tuned, rate, -float(found.fun)


def _bounds(floor: float) -> tuple[np.ndarray, np.ndarray]:
    """Logarithms of what is sensible: white, slow error, its time, rate noise."""
    low = np.log([0.1 * floor, 0.02 * floor, 20.0, 1e-9])
    high = np.log([10.0 * floor, 10.0 * floor, 20_000.0, 0.1])
    return low, high


def _finite(value: float) -> float:
    """A likelihood that ran away counts as very bad."""
    return value if np.isfinite(value) else -1e12
