"""Explicit Runge-Kutta methods as records of numbers.

    k_i = f(t + c_i h, z + h sum_j a_ij k_j),   z1 = z + h sum_j b_j k_j                           (1)

With s stages, a loop keeps its evaluations in an array k (s + 1 + extra, n): k[0..s-1] are the stages, k[s] is the
evaluation at the step's end, which serves the error estimate and the interpolant and is k[0] of the next step, and
what follows are the extra stages of the interpolant. All methods have the same types, so that one compiled loop
takes any of them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.integrate import dop853


class Tableau(NamedTuple):
    """An explicit method; float64 arrays. A method without error control has e3 and e5 zero, one without an interpolant
    of its own has no rows in a_extra, c_extra and d: use the cubic of `hermite_coefficients`.
    """

    a: np.ndarray  # (s, s) strictly lower
    b: np.ndarray  # (s,)
    c: np.ndarray  # (s,)
    order: int
    e3: np.ndarray  # (s + 1,) weights of the error of order 3
    e5: np.ndarray  # (s + 1,) weights of the error of order 5
    a_extra: np.ndarray  # (x, s + 1 + x) strictly lower, counted from row s + 1
    c_extra: np.ndarray  # (x,)
    d: np.ndarray  # (rows, s + 1 + x)

    @property
    def evaluations(self) -> int:
        """Rows that a loop's array k must have."""
        return self.b.size + 1 + self.c_extra.size


def _rows(rows, width: int) -> np.ndarray:
    """(len(rows), width) array of rows that may be shorter."""
    full = np.zeros((len(rows), width))
    for i, row in enumerate(rows):
        full[i, : len(row)] = row
    return full


def _rk4() -> Tableau:
    """The classical rule of Kutta (1901), order 4, without error control."""
    return Tableau(
        a=_rows(((), (0.5,), (0.0, 0.5), (0.0, 0.0, 1.0)), 4),
        b=np.array([1.0, 2.0, 2.0, 1.0]) / 6.0,
        c=np.array([0.0, 0.5, 0.5, 1.0]),
        order=4,
        e3=np.zeros(5),
        e5=np.zeros(5),
        a_extra=np.zeros((0, 5)),
        c_extra=np.zeros(0),
        d=np.zeros((0, 5)),
    )


def _dop853() -> Tableau:
    """Dormand and Prince's method of order 8 with error estimates of order 5 and 3 and an interpolant of order 7."""
    weights = np.array(dop853.STAGES[12])
    e3 = np.append(weights, 0.0)
    for stage, weight in dop853.WEIGHTS_3.items():
        e3[stage] -= weight
    return Tableau(
        a=_rows(dop853.STAGES[:12], 12),
        b=weights,
        c=np.array(dop853.NODES),
        order=8,
        e3=e3,
        e5=np.array(dop853.ERROR_5),
        a_extra=_rows(dop853.EXTRA_STAGES, 16),
        c_extra=np.array(dop853.EXTRA_NODES),
        d=np.array(dop853.DENSE),
    )


RK4 = _rk4()
DOP853 = _dop853()
