"""Geodetic latitude and height in compiled loops, without angles or iteration.

    tan u = b z / (a p) (1 + e'^2 b / r)                                                                    (1)
    tan phi = (z + e'^2 b sin^3 u) / (p - e^2 a cos^3 u)                                                    (2)
    h = p cos phi + z sin phi - a sqrt(1 - e^2 sin^2 phi)                                                   (3)

over the ellipsoid of WGS84, with p the distance from the axis and r that from the centre. One step of Bowring's method
from his second starting value: below 2,000 km the height is right to rounding (1e-8 m) and the latitude to 1e-11 rad.
`frames.earth_rotation.geodetic_from_itrs` is the same for arrays, through ERFA.

Source: Bowring (1985), The accuracy of geodetic latitude and height equations, Survey Review 28:218, 202.
"""

from __future__ import annotations

from math import sqrt

from numba import njit

from fieldline.constants import WGS84_FLATTENING, WGS84_SEMI_MAJOR_AXIS_M

A_M = WGS84_SEMI_MAJOR_AXIS_M
B_M = A_M * (1.0 - WGS84_FLATTENING)
FIRST_ECCENTRICITY_2 = WGS84_FLATTENING * (2.0 - WGS84_FLATTENING)
SECOND_ECCENTRICITY_2 = FIRST_ECCENTRICITY_2 / (1.0 - FIRST_ECCENTRICITY_2)


@njit(cache=True)
def geodetic_kernel(r_e):
    """(sin phi, cos phi, height [m]) of a place r_e [m] (tuple), ITRS axes, outside the Earth's core."""
    z = r_e[2]
    p = sqrt(r_e[0] * r_e[0] + r_e[1] * r_e[1])
    r = sqrt(p * p + z * z)
    up, out = B_M * z * (r + SECOND_ECCENTRICITY_2 * B_M), A_M * p * r  # (1)
    size = sqrt(up * up + out * out)
    up, out = up / size, out / size
    north = z + SECOND_ECCENTRICITY_2 * B_M * up**3  # (2)
    across = p - FIRST_ECCENTRICITY_2 * A_M * out**3
    size = sqrt(north * north + across * across)
    s, c = north / size, across / size
    return s, c, p * c + z * s - A_M * sqrt(1.0 - FIRST_ECCENTRICITY_2 * s * s)  # (3)
