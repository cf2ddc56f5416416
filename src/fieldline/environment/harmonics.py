"""Potential fields as spherical harmonics in Cartesian components: no angles, hence no singularity at the poles.

    V = a sum_n sum_m (a/r)^(n+1) S_nm(z/r) (g_nm cos m lambda + h_nm sin m lambda),    B = -grad V         (1)

Each Cartesian component of B, and of its gradient, is itself harmonic: a sum like (1) one (two) degrees higher, whose
coefficients are fixed combinations of g and h (`derivatives`). So the field is three sums over one set of functions,

    B_k = sum_m [ c_m sum_n G^k_nm R_nm + s_m sum_n H^k_nm R_nm ]                                           (2)
    c_m + i s_m = ((x + i y) a / r^2)^m,   R_mm = a / r                                                     (3)
    R_n+1,m = alpha_nm (a z / r^2) R_nm - beta_nm (a / r)^2 R_n-1,m                                         (4)

with every square root of the Schmidt normalisation taken once, when the tables are made. (4) is the recursion of the
Schmidt functions, alpha = (2n+1) / sqrt((n+1)^2 - m^2) and beta = sqrt((n^2 - m^2) / ((n+1)^2 - m^2)); R_nm lacks the
sectoral factor S_mm, which the coefficients carry instead.

Sources: Winch, Ivers, Turner and Stening (2005), Geophys. J. Int. 160, 487 (Schmidt functions); Cunningham (1970),
Celest. Mech. 2, 207 (derivatives of harmonics are harmonics); Montenbruck and Gill, Satellite Orbits (2000), s. 3.2.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.frames.vectors import dot


class Basis(NamedTuple):
    """The functions R_nm up to a degree and an order, as kernels take them."""

    radius_m: float
    degree: int
    order: int
    recursion: np.ndarray  # (2 L,) alpha, beta of each (m, n), n running fastest


@njit(cache=True, fastmath={"contract"})
def synthesis_kernel(r_e, basis, table):
    """B [T] at r_e [m] (tuple, outside the origin) of a flat table (6 L,) made by `field_table`: equations (2) to (4)."""
    ratio = basis.radius_m / dot(r_e, r_e)
    s, t, u = ratio * r_e[0], ratio * r_e[1], ratio * r_e[2]
    square = ratio * basis.radius_m
    first = sqrt(square)
    cosine, sine = 1.0, 0.0
    bx, by, bz = 0.0, 0.0, 0.0
    row = 0
    for m in range(basis.order + 1):
        below, here = 0.0, first
        xc, xs, yc, ys, zc, zs = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for _ in range(m, basis.degree + 1):
            k = 6 * row
            xc += table[k] * here
            xs += table[k + 1] * here
            yc += table[k + 2] * here
            ys += table[k + 3] * here
            zc += table[k + 4] * here
            zs += table[k + 5] * here
            above = basis.recursion[2 * row] * u * here - basis.recursion[2 * row + 1] * square * below  # (4)
            below, here = here, above
            row += 1
        bx += cosine * xc + sine * xs  # (2)
        by += cosine * yc + sine * ys
        bz += cosine * zc + sine * zs
        cosine, sine = cosine * s - sine * t, cosine * t + sine * s  # (3)
    return (bx, by, bz)


@njit(cache=True)
def gradient_kernel(r_e, basis, table):
    """dB_i/dx_j [T/m] as nine floats, row by row, of a flat table (10 L,) made by `gradient_table`; its trace is zero."""
    ratio = basis.radius_m / dot(r_e, r_e)
    s, t, u = ratio * r_e[0], ratio * r_e[1], ratio * r_e[2]
    square = ratio * basis.radius_m
    first = sqrt(square)
    cosine, sine = 1.0, 0.0
    xx, xy, xz, yy, yz = 0.0, 0.0, 0.0, 0.0, 0.0
    row = 0
    for m in range(basis.order + 1):
        below, here = 0.0, first
        xxc, xxs, xyc, xys, xzc, xzs, yyc, yys, yzc, yzs = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for _ in range(m, basis.degree + 1):
            k = 10 * row
            xxc += table[k] * here
            xxs += table[k + 1] * here
            xyc += table[k + 2] * here
            xys += table[k + 3] * here
            xzc += table[k + 4] * here
            xzs += table[k + 5] * here
            yyc += table[k + 6] * here
            yys += table[k + 7] * here
            yzc += table[k + 8] * here
            yzs += table[k + 9] * here
            above = basis.recursion[2 * row] * u * here - basis.recursion[2 * row + 1] * square * below  # (4)
            below, here = here, above
            row += 1
        xx += cosine * xxc + sine * xxs  # (2)
        xy += cosine * xyc + sine * xys
        xz += cosine * xzc + sine * xzs
        yy += cosine * yyc + sine * yys
        yz += cosine * yzc + sine * yzs
        cosine, sine = cosine * s - sine * t, cosine * t + sine * s  # (3)
    return (xx, xy, xz, xy, yy, yz, xz, yz, -xx - yy)


@njit(cache=True)
def potential_kernel(r_e, basis, table):
    """V / a of equation (1) [unit of g] at r_e [m] (tuple) of a flat table (2 L,) made by `potential_table`."""
    ratio = basis.radius_m / dot(r_e, r_e)
    s, t, u = ratio * r_e[0], ratio * r_e[1], ratio * r_e[2]
    square = ratio * basis.radius_m
    first = sqrt(square)
    cosine, sine = 1.0, 0.0
    value = 0.0
    row = 0
    for m in range(basis.order + 1):
        below, here = 0.0, first
        along_cosine, along_sine = 0.0, 0.0
        for _ in range(m, basis.degree + 1):
            along_cosine += table[2 * row] * here
            along_sine += table[2 * row + 1] * here
            above = basis.recursion[2 * row] * u * here - basis.recursion[2 * row + 1] * square * below  # (4)
            below, here = here, above
            row += 1
        value += cosine * along_cosine + sine * along_sine
        cosine, sine = cosine * s - sine * t, cosine * t + sine * s  # (3)
    return value


def basis_for(degree: int, order: int, radius_m: float) -> Basis:
    """The functions up to `degree` and `order`, with their recursion (4)."""
    pairs = np.zeros((_rows(degree, order), 2))
    for row, (n, m) in enumerate(_degrees_orders(degree, order)):
        below = (n + 1.0) ** 2 - m * m
        pairs[row] = (2 * n + 1) / sqrt(below), sqrt((n * n - m * m) / below)
    recursion = pairs.ravel()
    recursion.flags.writeable = False
    return Basis(float(radius_m), degree, order, recursion)


def field_table(g, h, order: int) -> np.ndarray:
    """(..., 6 L) sums of (2) for B = -grad V [unit of g], from (..., N+1, N+1) Schmidt coefficients g, h."""
    return _table([_negative(pair) for pair in derivatives(g, h)], order + 1)


def potential_table(g, h, order: int) -> np.ndarray:
    """(..., 2 L) sums for V / a [unit of g], over the functions of `field_table`: one degree and order more than g, h."""
    space = [(0, 0)] * (np.ndim(g) - 2) + [(0, 1), (0, 1)]
    return _table([(np.pad(g, space), np.pad(h, space))], order + 1)


def gradient_table(g, h, order: int, radius_m: float) -> np.ndarray:
    """(..., 10 L) sums for dB_i/dx_j, ij = xx, xy, xz, yy, yz [unit of g / m]; zz follows from div B = 0."""
    x, y, _ = derivatives(g, h)
    (xx, xy, xz), (_, yy, yz) = derivatives(*x), derivatives(*y)
    pairs = [_negative(pair) for pair in (xx, xy, xz, yy, yz)]
    return _table(pairs, order + 2, 1.0 / radius_m)


def derivatives(g, h):
    """Schmidt coefficients (..., N+2, N+2) of a dF/dx, a dF/dy, a dF/dz, where F has the coefficients g, h of (1).

    With Z_nm = (a/r)^(n+1) S_nm e^(i m lambda) the derivatives are, for Z without normalisation (Cunningham 1970),
        dZ_nm/dx = -Z_n+1,m+1 / 2 + (n-m+2)(n-m+1) Z_n+1,m-1 / 2,   dZ_nm/dy likewise,   dZ_nm/dz = -(n-m+1) Z_n+1,m
    and the factors here are these times the ratio of the norms sqrt((2 - [m=0]) (n-m)! / (n+m)!).
    """
    g, h = np.asarray(g, dtype=float), np.asarray(h, dtype=float)
    size = g.shape[-1] + 1
    out = [(np.zeros((*g.shape[:-2], size, size)), np.zeros((*g.shape[:-2], size, size))) for _ in range(3)]
    (xg, xh), (yg, yh), (zg, zh) = out
    for n in range(size - 1):
        for m in range(n + 1):
            cosine, sine = g[..., n, m], h[..., n, m]
            along = -sqrt((n + 1.0) ** 2 - m * m)
            zg[..., n + 1, m] += along * cosine
            zh[..., n + 1, m] += along * sine
            up = 0.5 * sqrt((n + m + 1.0) * (n + m + 2.0)) * (sqrt(2.0) if m == 0 else 1.0)
            xg[..., n + 1, m + 1] -= up * cosine
            xh[..., n + 1, m + 1] -= up * sine
            yh[..., n + 1, m + 1] -= up * cosine
            yg[..., n + 1, m + 1] += up * sine
            if m > 0:
                down = 0.5 * sqrt((n - m + 1.0) * (n - m + 2.0)) * (sqrt(2.0) if m == 1 else 1.0)
                xg[..., n + 1, m - 1] += down * cosine
                xh[..., n + 1, m - 1] += down * sine
                yh[..., n + 1, m - 1] -= down * cosine
                yg[..., n + 1, m - 1] += down * sine
    for _, sine in out:
        sine[..., 0] = 0.0  # sin 0: what a derivative leaves there would come back in the next one
    return out


def _table(pairs, order: int, factor: float = 1.0) -> np.ndarray:
    """Pairs (G, H) of coefficients as one flat row of sums, in the order in which the kernels read them."""
    degree = pairs[0][0].shape[-1] - 1
    n, m = np.array(_degrees_orders(degree, order)).T
    sectoral = np.cumprod([1.0, 1.0] + [sqrt((2 * k - 1) / (2 * k)) for k in range(2, degree + 1)])  # S_mm
    columns = [part[..., n, m] * sectoral[m] for pair in pairs for part in pair]
    table = np.stack(columns, axis=-1)
    flat = np.ascontiguousarray(factor * table.reshape(*table.shape[:-2], -1))
    flat.flags.writeable = False
    return flat


def _degrees_orders(degree: int, order: int) -> list[tuple[int, int]]:
    """(n, m) of every row of a table, order by order."""
    return [(n, m) for m in range(min(order, degree) + 1) for n in range(m, degree + 1)]


def _rows(degree: int, order: int) -> int:
    """Number of functions up to a degree and an order."""
    return len(_degrees_orders(degree, order))


def _negative(pair):
    """The coefficients of -F."""
    return (-pair[0], -pair[1])
