"""What a regulator forgives: factors on its inputs, lag and delay.

u = -K x on dx/dt = F x + G u. With L(s) = K (s I - F)^-1 G the loop, broken at the inputs, and |.| eigenvalues' sizes:

    range of gain    the factors g, on all inputs or on one, for which F - g G K stays stable            (1)
    lag              least angle t at which  det(I + exp(-j t) L(j w)) = 0  for some w:  a lag in all inputs (2)
    delay            least t with  det(I + exp(-j w t) L(j w)) = 0                                       (3)
    return           a = inf over w of the least singular value of I + R^1/2 L(j w) R^-1/2               (4)

(2) and (3) are found where an eigenvalue of L crosses the unit circle: before the first of them no root crosses the axis.
Of one input: L with the other inputs closed. (4), the distance of the loop from -1, bears factors between 1/(1 + a) and
1/(1 - a) and lags up to 2 asin(a/2) in every input by itself, in all of them, each another, at once. A regulator of least
cost with R diagonal has a = 1 at its own instant: 1/2 to infinity, and 60 degrees.

Over a period T, x(t + T) = X(g) x(t), the range of gain is that of |eigenvalues of X(g)| < 1; the delay, in whole steps of an
input that is held over each, that of the transition of the state with the inputs that are still under way.

Factors are searched from 1 outwards by FIRST and then halved between; an unstable island within one such part is not seen.

Sources: Safonov and Athans (1977), IEEE Trans. Automatic Control 22(2):173 (1/2, infinity, 60 degrees); Lehtomaki, Sandell and
Athans (1981), IEEE Trans. Automatic Control 26(1):75 ((4) and what it bears); Marshall, Gorecki, Walton and Korytowski (1992),
Time-Delay Systems, ch. 3 (crossings of (3)).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fieldline.errors import NoEstimateError

LARGEST_FACTOR = 1024.0  # beyond it a range counts as endless, below its inverse as reaching to 0
FIRST = np.sqrt(2.0)  # between factors that are tried
HALVINGS = 14  # of a factor's logarithm: 2e-5 of it
FREQUENCIES = 1500
DECADES = 2.5  # beyond the slowest and the fastest pole
REFINEMENTS = 40
MOST_DELAY_STATES = 240  # of the state with the inputs under way


class GainRange(NamedTuple):
    """Factors between which a loop stays stable: 0 and infinity where the search found no end."""

    low: float
    high: float


class Margins(NamedTuple):
    """Of all inputs together and of each alone (m,): ranges of gain, lag [rad], delay [s]; the return difference a of (4)."""

    gain: GainRange
    gain_of: list[GainRange]
    lag_rad: float
    lag_of_rad: np.ndarray
    delay_s: float
    delay_of_s: np.ndarray
    return_difference: float


def guaranteed(return_difference: float) -> tuple[float, float, float]:
    """Factors (low, high) and lag [rad] that every input bears whatever the others do within them, by (4)."""
    a = min(max(return_difference, 0.0), 1.0)
    return 1.0 / (1.0 + a), 1.0 / (1.0 - a) if a < 1.0 else np.inf, 2.0 * float(np.arcsin(0.5 * a))


def frozen_margins(F, G, gain, control_weights=1.0, *, rate: float = 1.0, scale=1.0) -> Margins:
    """Margins (1) to (4) of u = -gain x for coefficients that stay.

    F (n, n), G (n, m), gain (m, n); control_weights (m,), the diagonal of R in (4); rate [1/s] and scale (n,) as in
    `control.frozen_regulator`, for the numbers' sake.
    Errors: `NoEstimateError` where the closed loop is not stable.
    """
    size = np.broadcast_to(np.asarray(scale, dtype=float), (len(F),))
    root = np.sqrt(np.broadcast_to(np.asarray(control_weights, dtype=float), (G.shape[1],)))
    f, g, k = F * size / size[:, None] / rate, G / root / size[:, None] / rate, gain * root[:, None] * size

    def stable(factors: np.ndarray) -> bool:
        return bool(np.linalg.eigvals(f - (g * factors) @ k).real.max() < 0.0)

    m = g.shape[1]
    if not stable(np.ones(m)):
        raise NoEstimateError("the closed loop is not stable: it has no margins.")
    gains = _ranges(stable, m)
    w = _frequencies(np.concatenate([np.linalg.eigvals(f), np.linalg.eigvals(f - g @ k)]))
    lag, delay = _crossings(f, g, k, w)
    alone = [_crossings(f - np.delete(g, j, 1) @ np.delete(k, j, 0), g[:, [j]], k[[j]], w) for j in range(m)]
    lags, delays = np.array(alone).T
    return Margins(gains[0], gains[1:], lag, lags, delay / rate, delays / rate, _return_difference(f - g @ k, g, k, w))


def periodic_margins(phi, gamma, gain, step_s: float) -> tuple[list[GainRange], float]:
    """Ranges of gain, that of all inputs first, and the delay in all inputs [s] of an input that is held over each step.

    phi (N, n, n), gamma (N, n, m) of x1 = phi x0 + gamma u, gain (N, m, n), all over one period.
    """
    ranges = periodic_ranges(lambda factors: phi - (gamma * factors) @ gain, gamma.shape[2])
    return ranges, held_delay(phi, gamma, gain, step_s)


def held_delay(phi, gamma, gain, step_s: float) -> float:
    """The longest delay [s] in whole steps that leaves the loop of `periodic_margins` stable, up to MOST_DELAY_STATES in all.

    Not a number where it is not stable without any.
    """
    if not inside(phi - gamma @ gain):
        return float("nan")
    n, m = gamma.shape[1:]
    return step_s * _longest(lambda d: _spectral(_delayed(phi, gamma, gain, d)) < 1.0, max((MOST_DELAY_STATES - n) // m, 1))


def periodic_ranges(steps_of: Callable[[np.ndarray], np.ndarray], m: int) -> list[GainRange]:
    """Ranges of gain of m inputs, that of all together first, from steps_of(factors (m,)), the closed loop's (N, n, n)."""
    return _ranges(lambda factors: inside(steps_of(factors)), m)


def inside(steps: np.ndarray) -> bool:
    """Whether the product of steps (N, n, n) has all its eigenvalues inside the unit circle."""
    with np.errstate(over="ignore", invalid="ignore"):
        while len(steps) > 1:
            even = 2 * (len(steps) // 2)
            steps = np.concatenate([steps[1:even:2] @ steps[0:even:2], steps[even:]])
    return _spectral(steps[0]) < 1.0


def _spectral(matrix: np.ndarray) -> float:
    """The largest eigenvalue's size; infinite for a matrix that left the numbers."""
    return float(np.abs(np.linalg.eigvals(matrix)).max()) if np.isfinite(matrix).all() else np.inf


def gain_range(stable: Callable[[float], bool]) -> GainRange:
    """The factors around 1 for which `stable` holds: the search of this page for any loop."""
    return GainRange(_end(stable, 1.0 / FIRST), _end(stable, FIRST))


def _ranges(stable: Callable[[np.ndarray], bool], m: int) -> list[GainRange]:
    """Of all inputs by one factor, then of each alone."""
    return [gain_range(lambda factor, one=one: stable(1.0 + (factor - 1.0) * one)) for one in (np.ones(m), *np.eye(m))]


def _end(stable: Callable[[float], bool], way: float) -> float:
    """The last stable factor on the way, from 1."""
    good, bad = 1.0, way
    while stable(bad):
        good, bad = bad, bad * way
        if not 1.0 / LARGEST_FACTOR < bad < LARGEST_FACTOR:
            return 0.0 if way < 1.0 else np.inf
    for _ in range(HALVINGS):
        middle = float(np.sqrt(good * bad))
        good, bad = (middle, bad) if stable(middle) else (good, middle)
    return float(good)


def _frequencies(poles: np.ndarray) -> np.ndarray:
    """Frequencies around all poles, evenly spaced in the logarithm, and the poles' own."""
    sizes = np.abs(poles)[np.abs(poles) > 1e-6 * np.abs(poles).max(initial=1e-300)]
    low, high = (np.log10(sizes.min()), np.log10(sizes.max())) if len(sizes) else (0.0, 0.0)
    return np.union1d(np.logspace(low - DECADES, high + DECADES, FREQUENCIES), sizes * (1.0 + 1e-9))


def _loop_values(f, g, k, w) -> np.ndarray:
    """(..., q) eigenvalues of L(j w), by falling size."""
    resolved = np.linalg.solve(1j * np.asarray(w)[..., None, None] * np.eye(len(f)) - f, g.astype(complex))
    values = np.linalg.eigvals(k @ resolved)
    return np.take_along_axis(values, np.argsort(-np.abs(values), axis=-1), axis=-1)


def _crossings(f, g, k, w) -> tuple[float, float]:
    """Least lag (2), either way, and least delay (3) over all w at which an eigenvalue of L has the size 1."""
    sizes = np.abs(_loop_values(f, g, k, w))
    at, rank = np.nonzero((sizes[:-1] > 1.0) != (sizes[1:] > 1.0))
    if not len(at):
        return np.pi, np.inf
    low, high, above = np.log(w[at]), np.log(w[at + 1]), sizes[at, rank] > 1.0
    pick = np.arange(len(at)), rank
    for _ in range(REFINEMENTS):
        middle = 0.5 * (low + high)
        same = (np.abs(_loop_values(f, g, k, np.exp(middle))[pick]) > 1.0) == above
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    crossing = np.exp(high)
    angle = np.mod(np.angle(_loop_values(f, g, k, crossing)[pick]) + np.pi, 2.0 * np.pi)
    return float(np.minimum(angle, 2.0 * np.pi - angle).min()), float((angle / crossing).min())


def _return_difference(closed, g, k, w) -> float:
    """(4): 1 over the largest singular value of S = (I + L)^-1 = I - k (j w - closed)^-1 g; 1 where w has no end."""

    def largest(log_w):
        resolved = np.linalg.solve(1j * np.exp(log_w)[..., None, None] * np.eye(len(closed)) - closed, g.astype(complex))
        return np.linalg.svd(np.eye(g.shape[1]) - k @ resolved, compute_uv=False)[..., 0]

    log_w = np.log(w)
    best = largest(log_w)
    top = int(np.argmax(best))
    near = np.linspace(log_w[max(top - 1, 0)], log_w[min(top + 1, len(w) - 1)], 200)
    return 1.0 / max(1.0, float(best[top]), float(largest(near).max()))


def _longest(stable: Callable[[int], bool], most: int) -> int:
    """The largest number of steps d that is stable, found by doubling and then halving between; 0 is."""
    good, bad = 0, 1
    while bad <= most and stable(bad):
        good, bad = bad, 2 * bad
    if bad > most:
        bad = most + 1
    while bad - good > 1:
        middle = (good + bad) // 2
        good, bad = (middle, bad) if stable(middle) else (good, middle)
    return good


def _delayed(phi, gamma, gain, delay: int) -> np.ndarray:
    """(n + m d, n + m d) transition over the period of the state and the d inputs under way, the oldest first."""
    n, m = gamma.shape[1:]
    columns = n + m * delay
    state, under_way = np.eye(n, columns), np.eye(m * delay, columns, k=n).reshape(delay, m, columns)
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(len(phi)):
            slot = k % delay
            asked = -gain[k] @ state
            state = phi[k] @ state + gamma[k] @ under_way[slot]
            under_way[slot] = asked
    oldest_first = np.roll(under_way, -(len(phi) % delay), axis=0)
    return np.concatenate([state, oldest_first.reshape(m * delay, columns)])
