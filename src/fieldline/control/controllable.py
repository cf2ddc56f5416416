"""Which motions a plant's controls reach at an instant, by Popov, Belevitch and Hautus, in scaled numbers.

    smin [s I - F, G] > 0   for every eigenvalue s of F                                             (1)

The smallest singular value is the margin: a perturbation of that size in (F, G) loses a motion. It has meaning only in
scaled numbers: time in 1/rate, states over their sizes, each control by its own greatest effect (a column of length 1).
`analysis.controllability` has the tests over an orbit and of standing still.

Source: Hautus (1969), Indagationes Mathematicae 31:443.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

THRESHOLD = 1e-6  # of the margin (1) in scaled numbers


class Instant(NamedTuple):
    """Controllability at instants, arrays (...)."""

    controllable: np.ndarray
    margin: np.ndarray  # smallest singular value of (1)
    eigenvalue: np.ndarray  # over rate, where it is
    motion: np.ndarray  # (..., n) direction of the state that is hardest to move, scaled
    input_values: np.ndarray  # (..., min(n, m)) singular values of the scaled G


def orbital_scale(mean_motion_rad_s: float, angle_rad: float = 0.01) -> np.ndarray:
    """(12,) sizes of the states of `mechanics.relative_motion`: a metre, and angle_rad, their rates times n."""
    return np.repeat([1.0, angle_rad], 6) * np.tile([1.0, mean_motion_rad_s], 6)


def scaled(F, G, rate: float, scale) -> tuple[np.ndarray, np.ndarray]:
    """F and G (..., n, m) in time 1/rate and states over scale (n,); columns of G of length 1, or zero."""
    size = np.broadcast_to(np.asarray(scale, dtype=float), (np.shape(F)[-1],))
    f, g = np.asarray(F) * size / size[:, None] / rate, np.asarray(G) / size[:, None] / rate
    length = np.linalg.norm(g, axis=-2, keepdims=True)
    return f, np.divide(g, length, out=np.zeros_like(g), where=length > 1e-14 * length.max(initial=0.0))


def controllability_now(F, G, *, rate: float, scale=1.0, threshold: float = THRESHOLD) -> Instant:
    """The test (1) of F (n, n) and G (..., n, m) at each instant."""
    f, g = scaled(F, G, rate, scale)
    eigenvalues = _upper(np.linalg.eigvals(f))
    n = f.shape[0]
    lead = g.shape[:-2]
    pencil = (eigenvalues[:, None, None] * np.eye(n) - f).reshape((len(eigenvalues), *(1,) * len(lead), n, n))
    pencil = np.broadcast_to(pencil, (len(eigenvalues), *lead, n, n))
    both = np.concatenate([pencil, np.broadcast_to(g, (len(eigenvalues), *g.shape))], axis=-1)
    left, values, _ = np.linalg.svd(both, full_matrices=False)
    least = values[..., -1]
    worst = least.argmin(axis=0)
    at = (worst, *np.indices(lead)) if lead else worst
    margin = least[at]
    motion = left[at][..., -1]
    return Instant(margin > threshold, margin, eigenvalues[worst], motion, np.linalg.svd(g, compute_uv=False))


def words_of(motion, names: Sequence[str], most: int = 3) -> str:
    """The states in which a motion is largest, by name, for a message."""
    size = np.abs(np.asarray(motion))
    order = np.argsort(-size)[:most]
    return ", ".join(names[k] for k in order if size[k] > 0.2 * size.max())


def _upper(eigenvalues: np.ndarray) -> np.ndarray:
    """One of each conjugate pair, since both give the same singular values."""
    return eigenvalues[eigenvalues.imag >= -1e-9 * np.abs(eigenvalues).max(initial=1.0)]
