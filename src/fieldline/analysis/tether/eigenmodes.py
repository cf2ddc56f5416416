"""Small motions of a hanging line about its state of rest.

With x along the track, y across it (along the orbit's normal) and r up, at the points of a grid,

    m x'' + 2 n m r' + {S + m (GM/r^3 - n^2)} x = 0                                                          (1)
    m r'' - 2 n m x' + {A - m (2 GM/r^3 + n^2)} r = 0                                                        (2)
    m y'' + {S + m GM/r^3} y = 0                                                                             (3)
    S = D' (w T / (1 + T/EA)) D,    A = D' (w EA) D                                                          (4)

S: the string's stiffness, from its tension; A: the springs'. In the plane x = X cos(wt), r = -R sin(wt), and

    {K - w^2 - 2 n w P} (X, R) = 0    with masses taken out, P swapping X and R                              (5)

is real and symmetric; its eigenvalues come from a companion matrix of twice its size, and are then made good to the square
of their error by the quotient of Rayleigh of (5). Of the motions that are found, those of the orbit itself (along the track,
eccentric, inclined) are put aside: they move the mass centre.

Source: Tisseur and Meerbergen (2001), SIAM Review 43:235, sections 3 and 4 (gyroscopic quadratic eigenvalue problems).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.analysis.tether.statics import Hanging
from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError


class Motions(NamedTuple):
    """Motions of one family, slowest first; shapes are 1 where they are largest."""

    rate: np.ndarray  # (k,) [rad/s]
    shape: np.ndarray  # (k, p): goes with cos(wt)
    beside: np.ndarray  # (k, p): displacement in the plane at right angles to it, goes with sin(wt)


class Families(NamedTuple):
    """All motions of a line but those of its orbit."""

    in_plane: Motions  # shape along the track, beside: up; the first is the libration
    out_of_plane: Motions  # shape along the orbit's normal; the first is the libration
    along_line: Motions  # shape up, beside: along the track


def eigenmotions(hanging: Hanging, gm_m3_s2: float = EARTH_GM_M3_S2) -> Families:
    """Equations (1) to (5) about a state of rest.

    Raises
    ------
    InputError : the state of rest is no stable one, as with a line almost without stiffness.
    """
    grid, n = hanging.grid, hanging.rate
    root = np.sqrt(grid.mass)
    strain = hanging.tension / grid.stiffness
    string = grid.slope.T @ ((grid.weight * hanging.tension / (1.0 + strain))[:, None] * grid.slope)
    spring = grid.slope.T @ ((grid.weight * grid.stiffness)[:, None] * grid.slope)
    fall = np.diag(gm_m3_s2 / hanging.radius**3 / n**2)
    string, spring = (matrix / np.outer(root, root) / n**2 for matrix in (string, spring))
    one = np.eye(len(root))
    across = _across(string + fall, root, n)
    along, up = string + fall - one, spring - 2.0 * fall - one
    in_plane, along_line = _in_plane(along, up, root, n)
    return Families(in_plane, across, along_line)


def _across(stiffness: np.ndarray, root: np.ndarray, n: float) -> Motions:
    """Equation (3) in units of n, without the inclined orbit."""
    squares, vectors = np.linalg.eigh(stiffness)
    keep = np.arange(len(squares)) != np.argmax(_drift(vectors.T, root))
    if squares[keep].min(initial=1.0) <= 0.0:
        raise InputError(UNSTABLE)
    shapes = vectors.T[keep] / root
    shapes = shapes / _largest(shapes)[:, None]
    return Motions(n * np.sqrt(squares[keep]), shapes, np.zeros_like(shapes))


def _in_plane(along: np.ndarray, up: np.ndarray, root: np.ndarray, n: float) -> tuple[Motions, Motions]:
    """Equation (5) in units of n, without the two motions of the orbit: across the line, and along it."""
    p = len(root)
    stiffness = np.zeros((2 * p, 2 * p))
    stiffness[:p, :p], stiffness[p:, p:] = along, up
    rates, vectors = _companion(stiffness)
    x, r = vectors[:, :p], vectors[:, p:]
    eccentric = np.argmax(_drift(x, root) + _drift(r, root))
    keep = np.delete(np.arange(len(rates)), eccentric)
    rates, x, r = rates[keep], x[keep], r[keep]
    # p - 1 motions are along the line, one a spring: those with the largest share of it
    share = (r**2).sum(axis=1) / (x**2 + r**2).sum(axis=1)
    order = np.argsort(share, kind="stable")
    swings, stretches = np.sort(order[: len(rates) - (p - 1)]), np.sort(order[len(rates) - (p - 1) :])
    swing, beside = x[swings] / root, -r[swings] / root
    stretch, sway = -r[stretches] / root, -x[stretches] / root
    size, length = _largest(swing)[:, None], _largest(stretch)[:, None]
    return (
        Motions(n * rates[swings], swing / size, beside / size),
        Motions(n * rates[stretches], stretch / length, sway / length),
    )


def _companion(stiffness: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rates above zero of (5) in units of n, slowest first, and their vectors (k, 2 p); the orbit's drift is left out."""
    size = len(stiffness)
    swap = 2.0 * np.roll(np.eye(size), size // 2, axis=0)
    unit = np.sqrt(np.abs(stiffness).max())
    matrix = np.block([[np.zeros((size, size)), unit * np.eye(size)], [stiffness / unit, -swap]])
    values, vectors = np.linalg.eig(matrix)
    order = np.argsort(np.abs(values))[2:]  # drifting along the orbit: zero, twice
    order = order[values[order].real > 0.0]
    if len(order) != size - 1 or np.any(np.abs(values[order].imag) > 1e-5 * np.abs(values[order])):
        raise InputError(UNSTABLE)
    rates, found = values[order].real, vectors[:size, order].real.T
    found = found / np.linalg.norm(found, axis=1, keepdims=True)
    half = 0.5 * np.einsum("ki,ij,kj->k", found, swap, found)
    root = np.sqrt(half**2 + np.einsum("ki,ij,kj->k", found, stiffness, found))
    rates = np.where(np.abs(root - half - rates) <= np.abs(-root - half - rates), root - half, -root - half)
    order = np.argsort(rates)
    return rates[order], found[order]


def _drift(vectors: np.ndarray, root: np.ndarray) -> np.ndarray:
    """How much of each motion (k, p), masses taken out, is that of the mass centre."""
    return (vectors @ root) ** 2 / (root @ root)


def _largest(shapes: np.ndarray) -> np.ndarray:
    """(k,) element of largest size of each row."""
    return shapes[np.arange(len(shapes)), np.abs(shapes).argmax(axis=1)]


UNSTABLE = (
    "the hanging line is not a stable state of rest, so it has no modes: axial_stiffness_n is too low for this length and "
    "these masses. Is its unit newton?"
)
