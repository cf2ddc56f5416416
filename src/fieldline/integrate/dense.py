"""The state within a step, from what the step has evaluated anyway.

    z(theta) = z0 + theta (F0 + (1 - theta) (F1 + theta (F2 + (1 - theta) (F3 + ...)))),   0 <= theta <= 1    (1)
    F0 = z1 - z0,   F1 = h k0 - F0,   F2 = 2 F0 - h (k0 + k1)                                                 (2)
    F3..F6 = h d k                                                                                            (3)

F0..F2 alone are the cubic of Hermite, fit for RK4: error h^4/384 |z''''| at mid-step, one order less than the step.
With (3) it is the interpolant of order 7 of DOP853, which needs three more evaluations: for x = 0, 1, 2

    combine(z0, h, k, tableau.a_extra[x], 13 + x, stage),   k[13 + x] = f(t + tableau.c_extra[x] h, stage)

One `dense_value` reads both. Shapes: z0, z1, k0, k1, out of `dense_value` (n,); k (16, n); coefficients (7, n), or
(3, n) where only the cubic is used. Arrays are the caller's.

Source: Hairer, Norsett and Wanner (1993), s. II.6.
"""

from __future__ import annotations

from numba import njit


@njit(cache=True)
def hermite_coefficients(z0, z1, k0, k1, h, out):
    """Coefficients of the cubic through both states and rates, into rows 0..2 of out; further rows are zeroed (2)."""
    for i in range(z0.size):
        change = z1[i] - z0[i]
        out[0, i] = change
        out[1, i] = h * k0[i] - change
        out[2, i] = 2.0 * change - h * (k0[i] + k1[i])
    for row in range(3, out.shape[0]):
        for i in range(z0.size):
            out[row, i] = 0.0


@njit(cache=True)
def dense_coefficients(z0, z1, h, k, d, out):
    """Coefficients of the interpolant of DOP853 from its sixteen evaluations, into out (7, n); (2) and (3)."""
    hermite_coefficients(z0, z1, k[0], k[12], h, out)
    for row in range(d.shape[0]):
        for j in range(d.shape[1]):
            w = h * d[row, j]
            if w != 0.0:
                for i in range(z0.size):
                    out[3 + row, i] += w * k[j, i]


@njit(cache=True)
def dense_value(theta, coefficients, z0, out):
    """State at the fraction theta of the step, into out (1); coefficients has an odd number of rows."""
    last = coefficients.shape[0] - 1
    for i in range(z0.size):
        value = coefficients[last, i]
        for row in range(last - 1, -1, -1):
            value = value * (theta if row % 2 == 1 else 1.0 - theta) + coefficients[row, i]
        out[i] = z0[i] + theta * value
