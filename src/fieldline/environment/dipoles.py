"""Field of dipoles at given places.

    B = mu0 / (4 pi d^3) (3 (m . u) u - m),   d = |r - p|,   u = (r - p) / d                                (1)
    dB_i/dx_j = 3 mu0 / (4 pi d^4) [ (m . u)(delta_ij - 5 u_i u_j) + m_i u_j + u_i m_j ]                    (2)

Source: Jackson, Classical Electrodynamics, 3rd ed., eq. (5.56); (2) is its derivative.
Valid away from the dipoles themselves.
"""

from __future__ import annotations

from math import sqrt

from numba import njit

from fieldline.constants import MU0_OVER_4PI
from fieldline.frames.vectors import axpy, dot, scale, sub, vec


@njit(cache=True)
def dipoles_kernel(r_e, position_e, moment_e):
    """B [T] at r_e [m] (tuple) of dipoles at position_e (D, 3) [m] with moment_e (D, 3) [A m^2]: the sum of (1)."""
    total = (0.0, 0.0, 0.0)
    for k in range(position_e.shape[0]):
        moment = vec(moment_e, k)
        away = sub(r_e, vec(position_e, k))
        square = dot(away, away)
        strength = MU0_OVER_4PI / (square * sqrt(square))
        along = 3.0 * dot(moment, away) / square
        total = axpy(strength, sub(scale(along, away), moment), total)  # (1)
    return total


@njit(cache=True)
def dipoles_gradient_kernel(r_e, position_e, moment_e):
    """dB_i/dx_j [T/m] as nine floats, row by row: the sum of (2)."""
    xx, xy, xz, yy, yz = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(position_e.shape[0]):
        m = vec(moment_e, k)
        away = sub(r_e, vec(position_e, k))
        square = dot(away, away)
        u = scale(1.0 / sqrt(square), away)
        s = 3.0 * MU0_OVER_4PI / (square * square)
        mu = dot(m, u)
        xx += s * (mu * (1.0 - 5.0 * u[0] * u[0]) + 2.0 * m[0] * u[0])  # (2)
        xy += s * (-5.0 * mu * u[0] * u[1] + m[0] * u[1] + m[1] * u[0])
        xz += s * (-5.0 * mu * u[0] * u[2] + m[0] * u[2] + m[2] * u[0])
        yy += s * (mu * (1.0 - 5.0 * u[1] * u[1]) + 2.0 * m[1] * u[1])
        yz += s * (-5.0 * mu * u[1] * u[2] + m[1] * u[2] + m[2] * u[1])
    return (xx, xy, xz, xy, yy, yz, xz, yz, -xx - yy)
