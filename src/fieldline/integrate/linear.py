"""Small dense systems solved in place, by rows with the largest pivot first; knows no physics.

factorise(matrix, n, order) replaces the leading (n, n) part by its factors and `order` by the rows as they were swapped;
substitute(matrix, n, order, column) replaces the first n numbers of the column by the solution. A matrix without
inverse gives infinities or NaN, for the caller to find.
"""

from __future__ import annotations

from numba import njit


@njit(cache=True, error_model="numpy")
def factorise(matrix, n, order):
    """The factors of the leading (n, n) part, in place."""
    for j in range(n):
        best = j
        for i in range(j + 1, n):
            if abs(matrix[i, j]) > abs(matrix[best, j]):
                best = i
        order[j] = best
        if best != j:
            for c in range(n):
                matrix[j, c], matrix[best, c] = matrix[best, c], matrix[j, c]
        for i in range(j + 1, n):
            part = matrix[i, j] / matrix[j, j]
            matrix[i, j] = part
            if part != 0.0:
                for c in range(j + 1, n):
                    matrix[i, c] -= part * matrix[j, c]


@njit(cache=True, error_model="numpy")
def substitute(matrix, n, order, column):
    """The solution for a column, in place."""
    for j in range(n):
        best = order[j]
        column[j], column[best] = column[best], column[j]
    for i in range(n):
        for c in range(i):
            column[i] -= matrix[i, c] * column[c]
    for i in range(n - 1, -1, -1):
        for c in range(i + 1, n):
            column[i] -= matrix[i, c] * column[c]
        column[i] /= matrix[i, i]
