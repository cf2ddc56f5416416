"""Symmetric matrices in the shape of an arrow: parameters that all samples share, and a band of spline coefficients.

    M = [ S    C^T ]      S (s, s), C (g, s), B (g, g) with three diagonals on either side of its own      (1)
        [ C    B   ]

The band is eliminated first, so that a solution costs and stores of the order of g s, not g^3: a record of days has
thousands of coefficients. Source: Golub and Van Loan, Matrix Computations, band Cholesky and block elimination.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

WIDTH = 4
LEAST_PIVOT = 1e-300


class Arrow(NamedTuple):
    """`shared` (s, s), its lower half; `coupling` (g, s) = C; `band` (g, 4) with band[i, d] = B[i, i - d]."""

    shared: np.ndarray
    coupling: np.ndarray
    band: np.ndarray

    def dense(self) -> np.ndarray:
        """(s + g, s + g) M."""
        s, g = len(self.shared), len(self.band)
        lower = np.zeros((s + g, s + g))
        lower[:s, :s], lower[s:, :s] = np.tril(self.shared), self.coupling
        for d in range(min(WIDTH, g)):
            rows = np.arange(d, g)
            lower[s + rows, s + rows - d] = self.band[rows, d]
        return lower + np.tril(lower, -1).T

    def scaled(self, factor: float) -> Arrow:
        """`factor` M."""
        return Arrow(factor * self.shared, factor * self.coupling, factor * self.band)

    def diagonal(self) -> np.ndarray:
        """(s + g,) of M."""
        return np.concatenate([np.diag(self.shared), self.band[:, 0]])

    def with_diagonal(self, added: np.ndarray) -> Arrow:
        """M + diag(added)."""
        s, band = len(self.shared), self.band.copy()
        band[:, 0] += added[s:]
        return Arrow(self.shared + np.diag(added[:s]), self.coupling, band)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """(s + g, m) X with M X = right; M positive definite."""
        solution = np.array(right, dtype=float)
        arrow_kernel(np.array(self.shared), np.array(self.coupling), np.array(self.band), solution)
        return solution


def empty_arrow(shared: int, banded: int) -> Arrow:
    """Zeros."""
    return Arrow(np.zeros((shared, shared)), np.zeros((banded, shared)), np.zeros((banded, WIDTH)))


@njit(cache=True)
def arrow_kernel(shared, coupling, band, right):
    """Overwrites `right` (s + g, m) with the solution, and the matrix with its factors."""
    s, g, m = len(shared), len(band), right.shape[1]
    for i in range(g):
        for k in range(max(0, i - WIDTH + 1), i + 1):
            left = band[i, i - k]
            for q in range(max(0, i - WIDTH + 1), k):
                left -= band[i, i - q] * band[k, k - q]
            band[i, i - k] = np.sqrt(max(left, LEAST_PIVOT)) if k == i else left / band[k, 0]
        for q in range(max(0, i - WIDTH + 1), i):
            for a in range(s):
                coupling[i, a] -= band[i, i - q] * coupling[q, a]
            for c in range(m):
                right[s + i, c] -= band[i, i - q] * right[s + q, c]
        for a in range(s):
            coupling[i, a] /= band[i, 0]
            for b in range(a + 1):
                shared[a, b] -= coupling[i, a] * coupling[i, b]
        for c in range(m):
            right[s + i, c] /= band[i, 0]
            for a in range(s):
                right[a, c] -= coupling[i, a] * right[s + i, c]
    cholesky_kernel(shared, right)
    for i in range(g - 1, -1, -1):
        for c in range(m):
            for a in range(s):
                right[s + i, c] -= coupling[i, a] * right[a, c]
            for q in range(i + 1, min(g, i + WIDTH)):
                right[s + i, c] -= band[q, q - i] * right[s + q, c]
            right[s + i, c] /= band[i, 0]


@njit(cache=True)
def cholesky_kernel(lower, right):
    """Solves for the first rows of `right` in place; `lower` holds the matrix' lower half and becomes its factor."""
    s, m = len(lower), right.shape[1]
    for i in range(s):
        for k in range(i + 1):
            left = lower[i, k]
            for q in range(k):
                left -= lower[i, q] * lower[k, q]
            lower[i, k] = np.sqrt(max(left, LEAST_PIVOT)) if k == i else left / lower[k, k]
    for c in range(m):
        for i in range(s):
            for q in range(i):
                right[i, c] -= lower[i, q] * right[q, c]
            right[i, c] /= lower[i, i]
        for i in range(s - 1, -1, -1):
            for q in range(i + 1, s):
                right[i, c] -= lower[q, i] * right[q, c]
            right[i, c] /= lower[i, i]
