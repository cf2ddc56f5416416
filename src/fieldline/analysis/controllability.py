"""Which motions a vehicle's controls reach: at an instant, over an orbit, and whether it can stay where it is sent.

At an instant, by Popov, Belevitch and Hautus: dx/dt = F x + G u is controllable if for every eigenvalue s of F

    smin [s I - F, G] > 0                                                                           (1)

The smallest singular value is the margin: a perturbation of that size in (F, G) loses a motion. It has meaning only in
scaled numbers: time in 1/rate, states over their sizes, each control by its own greatest effect (a column of length 1).
Ranks of [G, F G, ..., F^(n-1) G] in SI lose all digits at twelve states.

Over a period, by the Gramian of the periodic system,

    W = integral over a period of X(T, t) G G' X(T, t)' dt                                          (2)

whose eigenvalues are the squares of how far a control of unit energy goes: none may be zero.

Steady-state controllability (Lawrence, 1992): every reference r of the outputs can be held by constant controls,

    rank [[F, G], [H, 0]] = n + p                                                                   (3)

Conductors alone never have it: B . force = 0 leaves one row of G dependent on the others.

Sources: Hautus (1969), Indagationes Mathematicae 31:443 (1); Kalman, Ho and Narendra (1963), Contributions to Differential
Equations 1:189 (2); Davison and Wang (1974), IEEE Trans. Automatic Control 19:643 (3); Lawrence (1992), AFIT/GA/ENY/92D-05.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from fieldline.analysis.floquet import as_ring, check_period
from fieldline.control.controllable import THRESHOLD, Instant, controllability_now, orbital_scale, scaled, words_of
from fieldline.control.periodic_system import transitions
from fieldline.errors import InputError

RANK_TOLERANCE = 1e-10  # of the largest singular value

__all__ = [
    "THRESHOLD",
    "Instant",
    "Orbit",
    "Steady",
    "controllability_now",
    "controllability_over",
    "orbital_scale",
    "removable",
    "scaled",
    "steady_state",
    "words_of",
]


class Orbit(NamedTuple):
    """Controllability over a period."""

    controllable: bool
    margin: float  # least over greatest reach: the root of the eigenvalues' ratio
    reach: np.ndarray  # (n,) roots of the eigenvalues of (2), scaled, least first
    motion: np.ndarray  # (n,) the direction of the least


class Steady(NamedTuple):
    """Steady-state controllability."""

    controllable: bool
    margin: float  # smallest over largest singular value of (3), scaled
    lost: np.ndarray  # (p,) scaled, length 1: references with a part along it are hard or impossible to hold; zero: all are


def controllability_over(F, G, period_s: float, *, rate: float, scale=1.0, threshold: float = THRESHOLD) -> Orbit:
    """The Gramian (2) of F (n, n) or (N, n, n) and G (N, n, m) at N equal steps of a period, columns scaled as one."""
    ring = as_ring("G", G, np.shape(F)[-1], np.shape(G)[-1])
    period = check_period(period_s)
    size = np.broadcast_to(np.asarray(scale, dtype=float), (np.shape(F)[-1],))
    f = np.asarray(F) * size / size[:, None] / rate
    g = ring / size[:, None] / rate
    length = np.sqrt((g * g).sum(axis=1).mean(axis=0))
    g = np.divide(g, length, out=np.zeros_like(g), where=length > 0.0)
    steps = transitions(as_ring("F", f, count=len(g)), rate * period)
    gramian, width = np.zeros((f.shape[-1],) * 2), rate * period / len(g)
    for k in range(len(g)):
        ends = (g[k] @ g[k].T, g[(k + 1) % len(g)] @ g[(k + 1) % len(g)].T)
        gramian = steps[k] @ (gramian + 0.5 * width * ends[0]) @ steps[k].T + 0.5 * width * ends[1]
    values, vectors = np.linalg.eigh(0.5 * (gramian + gramian.T))
    reach = np.sqrt(np.maximum(values, 0.0))
    margin = float(reach[0] / reach[-1]) if reach[-1] > 0.0 else 0.0
    return Orbit(margin > threshold, margin, reach, vectors[:, 0])


def steady_state(F, G, H, *, rate: float, scale=1.0) -> Steady:
    """The test (3) of F (n, n), G (n, m), H (p, n)."""
    f, g = scaled(F, G, rate, scale)
    size = np.broadcast_to(np.asarray(scale, dtype=float), (f.shape[0],))
    h = np.asarray(H) * size
    h = h / np.linalg.norm(h, axis=1, keepdims=True)
    left, values, _ = np.linalg.svd(np.block([[f, g], [h, np.zeros((h.shape[0], g.shape[1]))]]))
    rows = f.shape[0] + h.shape[0]
    values = np.concatenate([values, np.zeros(rows - len(values))])
    lost = left[f.shape[0] :, rows - 1]
    length = float(np.linalg.norm(lost))
    lost = lost / length if length > 0.0 else lost
    return Steady(bool(values[-1] > RANK_TOLERANCE * values[0]), float(values[-1] / values[0]), lost)


def removable(F, G, lost: int, *, rate: float, scale=1.0, of: Sequence[int] | None = None, threshold: float = THRESHOLD):
    """Which sets of `lost` controls can fail: (subset, least margin over the instants of G (..., n, m)) for all sets.

    `of` : columns that may fail, all by default. A set may be lost if its margin is above the threshold.
    """
    columns = range(np.shape(G)[-1]) if of is None else of
    count = sum(1 for _ in _subsets(columns, lost))
    if count == 0 or lost >= np.shape(G)[-1]:
        raise InputError(f"lost must be between 1 and {np.shape(G)[-1] - 1} controls; got {lost}.")
    found = []
    for subset in _subsets(columns, lost):
        kept = [k for k in range(np.shape(G)[-1]) if k not in subset]
        instant = controllability_now(F, np.asarray(G)[..., kept], rate=rate, scale=scale, threshold=threshold)
        found.append((subset, float(np.min(instant.margin))))
    return found


def _subsets(columns: Sequence[int], lost: int) -> Iterator[tuple[int, ...]]:
    """Sets of `lost` columns."""
    return combinations(columns, lost) if lost >= 1 else iter(())
