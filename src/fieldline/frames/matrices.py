"""3 x 3 matrices as tuples of nine floats, row by row, for kernels such as the block filter.

matmul(a, b) = a b      matmul_t(a, b) = a b^T      transpose(a) = a^T      matvec(a, v) = a v
"""

from __future__ import annotations

from numba import njit

IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


@njit(cache=True)
def matmul(a, b):
    """A b."""
    return (
        a[0] * b[0] + a[1] * b[3] + a[2] * b[6],
        a[0] * b[1] + a[1] * b[4] + a[2] * b[7],
        a[0] * b[2] + a[1] * b[5] + a[2] * b[8],
        a[3] * b[0] + a[4] * b[3] + a[5] * b[6],
        a[3] * b[1] + a[4] * b[4] + a[5] * b[7],
        a[3] * b[2] + a[4] * b[5] + a[5] * b[8],
        a[6] * b[0] + a[7] * b[3] + a[8] * b[6],
        a[6] * b[1] + a[7] * b[4] + a[8] * b[7],
        a[6] * b[2] + a[7] * b[5] + a[8] * b[8],
    )


@njit(cache=True)
def transpose(a):
    """A^T."""
    return (a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8])


@njit(cache=True)
def matmul_t(a, b):
    """A b^T."""
    return matmul(a, transpose(b))


@njit(cache=True)
def matadd(a, b):
    """A + b."""
    return (
        a[0] + b[0],
        a[1] + b[1],
        a[2] + b[2],
        a[3] + b[3],
        a[4] + b[4],
        a[5] + b[5],
        a[6] + b[6],
        a[7] + b[7],
        a[8] + b[8],
    )


@njit(cache=True)
def matsub(a, b):
    """A - b."""
    return (
        a[0] - b[0],
        a[1] - b[1],
        a[2] - b[2],
        a[3] - b[3],
        a[4] - b[4],
        a[5] - b[5],
        a[6] - b[6],
        a[7] - b[7],
        a[8] - b[8],
    )


@njit(cache=True)
def matscale(s, a):
    """s a."""
    return (s * a[0], s * a[1], s * a[2], s * a[3], s * a[4], s * a[5], s * a[6], s * a[7], s * a[8])


@njit(cache=True)
def matvec(a, v):
    """A v."""
    return (
        a[0] * v[0] + a[1] * v[1] + a[2] * v[2],
        a[3] * v[0] + a[4] * v[1] + a[5] * v[2],
        a[6] * v[0] + a[7] * v[1] + a[8] * v[2],
    )


@njit(cache=True)
def skew(v):
    """[v x], so that matvec(skew(v), u) = v x u."""
    return (0.0, -v[2], v[1], v[2], 0.0, -v[0], -v[1], v[0], 0.0)


@njit(cache=True)
def symmetric(a):
    """(a + a^T) / 2: what rounding took from a covariance block."""
    xy = 0.5 * (a[1] + a[3])
    xz = 0.5 * (a[2] + a[6])
    yz = 0.5 * (a[5] + a[7])
    return (a[0], xy, xz, xy, a[4], yz, xz, yz, a[8])


@njit(cache=True)
def determinant(a):
    """Det a."""
    return a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] - a[5] * a[6]) + a[2] * (a[3] * a[7] - a[4] * a[6])


@njit(cache=True, error_model="numpy")
def inverse(a):
    """A^-1 by cofactors; infinities where det a is zero, for the caller to find."""
    s = 1.0 / determinant(a)
    return (
        s * (a[4] * a[8] - a[5] * a[7]),
        s * (a[2] * a[7] - a[1] * a[8]),
        s * (a[1] * a[5] - a[2] * a[4]),
        s * (a[5] * a[6] - a[3] * a[8]),
        s * (a[0] * a[8] - a[2] * a[6]),
        s * (a[2] * a[3] - a[0] * a[5]),
        s * (a[3] * a[7] - a[4] * a[6]),
        s * (a[1] * a[6] - a[0] * a[7]),
        s * (a[0] * a[4] - a[1] * a[3]),
    )


@njit(cache=True)
def diagonal(x, y, z):
    """Diag(x, y, z)."""
    return (x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z)
