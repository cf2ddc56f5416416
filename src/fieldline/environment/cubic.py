"""Lagrange's cubic through four equidistant nodes, for tables in compiled loops.

    f(k + u) = sum_j w_j(u) f(k + j),   j = -1, 0, 1, 2,   0 <= u <= 1                                      (1)

The error is 3/128 h^4 f'''' in the middle of a cell, and up to twice that in a table's first and last cell, which take
the four outermost nodes. Outside the table its end's value is held.
"""

from __future__ import annotations

from numba import njit


@njit(cache=True)
def cubic_place(place, nodes):
    """(k, (w0, w1, w2, w3)): first of the four nodes about `place` (in spacings from node 0), and their weights (1)."""
    held = min(max(place, 0.0), nodes - 1.0)
    k = min(max(int(held), 1), nodes - 3)
    return k - 1, cubic_weights(held - k)


@njit(cache=True)
def cubic_weights(u):
    """Weights (1) of the nodes -1, 0, 1, 2 at u."""
    below, above, far = u + 1.0, u - 1.0, u - 2.0
    return (-u * above * far / 6.0, 0.5 * below * above * far, -0.5 * below * u * far, below * u * above / 6.0)
