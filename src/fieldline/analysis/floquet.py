"""Stability of dx/dt = a(t) x with a(t + T) = a(t): the monodromy matrix and its eigenvalues.

    X(T) = M X(0),   x(t + T) ~ mu x(t),   stable if every |mu| < 1                                 (1)
    characteristic exponents  s = ln(mu) / T, known to multiples of 2 pi i / T                      (2)

a is given at N equal steps over the period, (N, n, n), or once, (n, n), for constant coefficients; it is integrated by the
Magnus series of fourth order of `control.periodic_system`.
"""

from __future__ import annotations

import numpy as np

from fieldline.control.periodic_system import product, transitions
from fieldline.errors import InputError


def as_ring(name: str, matrices, rows: int | None = None, columns: int | None = None, count: int = 1) -> np.ndarray:
    """(N, rows, columns) floats of coefficients at the nodes of a period, or of one set for all of them.

    Errors: `InputError` for another shape, another number of nodes than `count` (if more than one), or no finite number.
    """
    given = np.asarray(matrices, dtype=float)
    ring = given[None] if given.ndim == 2 else given
    rows = rows if rows is not None or ring.ndim != 3 else ring.shape[1]
    columns = columns if columns is not None else rows
    fits = (
        ring.ndim == 3 and ring.shape[1:] == (rows, columns) and ring.shape[0] in ((1, count) if count > 1 else (ring.shape[0],))
    )
    if not fits or ring.shape[0] == 0:
        nodes = f"({count}, {rows}, {columns}) or " if count > 1 else f"(N, {rows}, {columns}) or "
        raise InputError(f"{name} must have shape {nodes}({rows}, {columns}); got {given.shape}.")
    if not np.isfinite(ring).all():
        raise InputError(f"{name} has elements that are not finite.")
    return np.ascontiguousarray(np.broadcast_to(ring, (max(count, ring.shape[0]), *ring.shape[1:])))


def check_period(period_s: float) -> float:
    """The period [s], positive and finite."""
    if not (np.isfinite(period_s) and period_s > 0.0):
        raise InputError(f"period_s must be a positive number of seconds; got {period_s}.")
    return float(period_s)


def monodromy(a, period_s: float) -> np.ndarray:
    """(n, n) matrix M of equation (1); `a` (N, n, n) [1/s] at N equal steps over `period_s`, or (n, n)."""
    return product(transitions(as_ring("a", a), check_period(period_s)))


def floquet_multipliers(a, period_s: float) -> np.ndarray:
    """(n,) complex eigenvalues of the monodromy matrix of `a` (N, n, n) [1/s] over `period_s`, the largest first."""
    return multipliers_of(monodromy(a, period_s))


def multipliers_of(matrix: np.ndarray) -> np.ndarray:
    """(n,) complex eigenvalues of a monodromy matrix, the largest first."""
    multipliers = np.linalg.eigvals(matrix).astype(complex)
    return multipliers[np.argsort(-np.abs(multipliers), kind="stable")]


def characteristic_exponents(multipliers, period_s: float) -> np.ndarray:
    """(n,) complex exponents [1/s] of equation (2); a multiplier of zero has the exponent -inf."""
    multipliers = np.asarray(multipliers, dtype=complex)
    size = np.abs(multipliers)
    growth = np.log(size, out=np.full(size.shape, -np.inf), where=size > 0.0)
    return (growth + 1j * np.angle(multipliers)) / check_period(period_s)
