"""3-vectors as tuples, for kernels: they cost nothing after inlining and read like the paper.

    dot(a, b) = a . b        cross(a, b) = a x b        axpy(s, a, b) = s a + b

A vector in a kernel is a tuple of three floats; `vec(a, k)` lifts row k of an (n, 3) array, `put(a, k, v)` stores it.
"""

from __future__ import annotations

from math import sqrt

from numba import njit


@njit(cache=True, inline="always")
def vec(rows, k):
    """Row k of an (n, 3) array as a tuple."""
    return (rows[k, 0], rows[k, 1], rows[k, 2])


@njit(cache=True, inline="always")
def put(rows, k, v):
    """Store a tuple as row k of an (n, 3) array."""
    rows[k, 0] = v[0]
    rows[k, 1] = v[1]
    rows[k, 2] = v[2]


@njit(cache=True)
def dot(a, b):
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit(cache=True)
def cross(a, b):
    """a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@njit(cache=True)
def scale(s, a):
    """s a."""
    return (s * a[0], s * a[1], s * a[2])


@njit(cache=True)
def add(a, b):
    """a + b."""
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


@njit(cache=True)
def sub(a, b):
    """a - b."""
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


@njit(cache=True)
def axpy(s, a, b):
    """s a + b."""
    return (s * a[0] + b[0], s * a[1] + b[1], s * a[2] + b[2])


@njit(cache=True)
def norm(a):
    """|a|."""
    return sqrt(dot(a, a))


@njit(cache=True)
def unit(a):
    """a / |a|; the caller sees to it that a is not zero."""
    return scale(1.0 / norm(a), a)
