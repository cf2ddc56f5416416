"""Uniform cubic B-splines: the slow common gain as a function of time.

    gain(t) - 1 = sum_j a_j beta((t - t_0)/h - j),   beta the cubic B-spline on the integers

Each sample touches four coefficients, so that a fit over days stays banded and bounded in memory.
Source: de Boor, A Practical Guide to Splines (1978), chapter X.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

KNOT_SPACING_S = 900.0  # a sixth of a low orbit: follows eclipse heating, not the spin
SHORTEST_GAIN_ARC_S = 1800.0  # below two intervals a spline and a bias cannot be told apart


@dataclass(frozen=True, slots=True)
class UniformSpline:
    """Knots `start_s + k * spacing_s`, k = 0 .. intervals; coefficients number intervals + 3."""

    start_s: float
    spacing_s: float
    intervals: int

    @property
    def size(self) -> int:
        """Number of coefficients."""
        return self.intervals + 3

    @property
    def knots_s(self) -> np.ndarray:
        """(intervals + 1,) s: where pieces join."""
        return self.start_s + self.spacing_s * np.arange(self.intervals + 1)

    def weights(self, seconds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """First coefficient (n,) and the four weights (n, 4) of each sample.

        Within one interval outside the knots the end value stands; farther off nothing is known, and the weights are zero.
        """
        places = (np.asarray(seconds, dtype=float) - self.start_s) / self.spacing_s
        first, weights = np.empty(places.shape, dtype=np.intp), np.empty((*places.shape, 4))
        weights_kernel(places.ravel(), self.intervals, first.reshape(-1), weights.reshape(-1, 4))
        return first, weights

    def values(self, seconds: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
        """(n,) value of the spline."""
        first, weights = self.weights(seconds)
        return np.einsum("...k,...k->...", weights, coefficients[first[..., None] + np.arange(4)])

    def columns(self, seconds: np.ndarray) -> tuple[slice, np.ndarray]:
        """The coefficients that these samples touch, and the dense (n, m) basis over them only."""
        first, weights = self.weights(seconds)
        low, high = int(first.min()), int(first.max()) + 4
        basis = np.zeros((len(first), high - low))
        basis[np.arange(len(first))[:, None], first[:, None] - low + np.arange(4)] = weights
        return slice(low, high), basis


@njit(cache=True)
def basis_at(place, intervals):
    """First coefficient and the four weights at `place`, counted in intervals from the first knot."""
    known = 1.0 if -1.0 <= place <= intervals + 1.0 else 0.0
    place = min(max(place, 0.0), float(intervals))
    first = min(int(place), intervals - 1)
    x = place - first
    y = 1.0 - x
    return first, (
        known * y**3 / 6.0,
        known * (3.0 * x**3 - 6.0 * x**2 + 4.0) / 6.0,
        known * (3.0 * y**3 - 6.0 * y**2 + 4.0) / 6.0,
        known * x**3 / 6.0,
    )


@njit(cache=True)
def weights_kernel(places, intervals, first, weights):
    """`basis_at` of every place."""
    for k in range(len(places)):
        first[k], four = basis_at(places[k], intervals)
        for j in range(4):
            weights[k, j] = four[j]


def spline_over(first_s: float, last_s: float, spacing_s: float = KNOT_SPACING_S) -> UniformSpline:
    """Equal intervals near `spacing_s` from the first sample to the last; at least two."""
    intervals = max(2, round((last_s - first_s) / spacing_s))
    return UniformSpline(first_s, max(last_s - first_s, 1e-9) / intervals, intervals)
