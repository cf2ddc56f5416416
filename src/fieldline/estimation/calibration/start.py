"""Starts that need no guess: the centred, linear solutions for bias alone and for bias and matrix.

Squaring |D (f - b)| = B with E = D^T D and e = E b gives

    f . E f - 2 f . e + b . E b = B^2                                                              (1)

Only the constant b . E b spoils linearity. Subtracting the mean over the samples (centring) removes it, and what is left
is linear in E (six numbers) and e (three). With E = 1 the same equation gives the bias alone:

    2 (f - <f>) . b = (|f|^2 - B^2) - <|f|^2 - B^2>                                                (2)

Source: Alonso and Shuster, J. Astronaut. Sci. 50 (2002) 61, the first step of TWOSTEP; its second step (the constant that
centring threw away, by Gauss-Newton) is the fit that follows this start. Noise in f makes both starts slightly biased.
"""

from __future__ import annotations

import numpy as np

from fieldline.estimation.calibration.model import SYMMETRIC, Samples, symmetric

TRIMS = 3
SMALLEST_RATIO = 1e-12


def centred_bias(samples: Samples) -> np.ndarray | None:
    """(3,) bias from (2), or None where the directions do not span space."""
    f = samples.field_s
    right = np.einsum("ij,ij->i", f, f) - samples.magnitude**2
    return _trimmed(2.0 * f, right)


def centred_matrix(samples: Samples) -> tuple[np.ndarray, np.ndarray] | None:
    """(bias (3,), D (3, 3)) from (1), or None where it has no positive solution."""
    f = samples.field_s - samples.field_s.mean(axis=0)  # the square of a large bias would eat the digits
    squares = np.stack([(1.0 + (i != j)) * f[:, i] * f[:, j] for i, j in SYMMETRIC], axis=1)
    solution = _trimmed(np.concatenate([squares, -2.0 * f], axis=1), samples.magnitude**2)
    if solution is None:
        return None
    values, vectors = np.linalg.eigh(symmetric(solution[:6]))
    if values.min() <= SMALLEST_RATIO * abs(values).max():
        return None
    bias = vectors @ ((vectors.T @ solution[6:]) / values) + samples.field_s.mean(axis=0)
    return bias, (vectors * np.sqrt(values)) @ vectors.T


def _trimmed(left: np.ndarray, right: np.ndarray) -> np.ndarray | None:
    """Centred least squares, repeated without the samples that lie five robust sigmas off."""
    keep = np.ones(len(right), dtype=bool)
    solution = None
    for _ in range(TRIMS):
        if keep.sum() <= left.shape[1]:
            return solution
        a, b = left - left[keep].mean(axis=0), right - right[keep].mean()
        size = np.maximum(np.abs(a[keep]).max(axis=0), 1e-30)
        triangle = np.linalg.qr(np.column_stack([a[keep] / size, b[keep]]), mode="r")[: len(size)]
        solution, _, rank, _ = np.linalg.lstsq(triangle[:, :-1], triangle[:, -1], rcond=1e-10)
        if rank < left.shape[1]:
            return None
        solution = solution / size
        off = np.abs(b - a @ solution)
        keep = off <= 5.0 * 1.4826 * np.median(off) + 1e-12 * np.abs(b).max()
    return solution
