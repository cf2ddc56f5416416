"""What a thin line is lit by: the Sun, the Earth's own infrared, and sunlight that the Earth throws back.

    sun     q_s = S (au / d)^2 nu sin psi                                                                   (1)
    earth   q_e = E W(theta, r)                                                                             (2)
    albedo  q_a = a S (au / d)^2 max(0, cos chi) W(theta, r)                                                (3)
    W = (1 / pi) integral of sin psi over the Earth's disc
      = (pi / 2) [1 - c - (P1 - P3) P2(t) / 8 - (P3 - P5) P4(t) / 64 - 5 (P5 - P7) P6(t) / 1024],  t = cos theta   (4)

all in W per metre of line and per metre of its width. nu: sunlit part; psi: angle between a ray and the line; theta: angle
between the line and the vertical; c = cos rho and P_l = P_l(c), with sin rho = R / r the Earth's half-angle; chi: the Sun's
distance from the zenith. (4) is the series of sin psi in Legendre polynomials to degree 6, integrated over the cap: W is
pi/2 at the ground whatever the angle, within 0.2 % of the integral up to 1,000 km, and within 5 % of a plate's far out.

The Earth radiates E = 240 W/m^2 and reflects a = 0.29 of the sunlight, means over the globe and the year; single places
depart from them by a third, (3) takes the ground below for all that is seen, and near the terminator that is wrong by half.

Width: the diameter of a wire; of a tape that hangs at any roll, its circumference over pi (Cauchy's mean projection).
Source: IAU 2015 B3 (solar constant); Loeb et al. (2018), J. Climate 31, 895 (CERES: 240 W/m^2, 0.29); Modest (2013),
Radiative Heat Transfer, ch. 4 (view factors).
"""

from __future__ import annotations

from math import pi, sqrt

from fieldline.compiled import kernel
from fieldline.constants import ASTRONOMICAL_UNIT_M, EARTH_EQUATORIAL_RADIUS_M, SOLAR_CONSTANT_W_M2
from fieldline.environment.eclipse import sunlit_kernel
from fieldline.frames.vectors import cross, dot, norm, sub

EARTH_INFRARED_W_M2 = 240.0
ALBEDO = 0.29


@kernel
def line_view(cos_vertical, radius):
    """W of equation (4); cos_vertical: between line and vertical; radius [m]: from the Earth's centre."""
    sine = min(EARTH_EQUATORIAL_RADIUS_M / radius, 1.0)
    c = sqrt(1.0 - sine * sine)
    p1, p3, p5, p7 = _odd(c)
    p2, p4, p6 = _even(cos_vertical)
    return 0.5 * pi * (1.0 - c - (p1 - p3) * p2 / 8.0 - (p3 - p5) * p4 / 64.0 - 5.0 * (p5 - p7) * p6 / 1024.0)


@kernel
def _odd(c):
    """P1, P3, P5, P7 at c."""
    s = c * c
    return (
        c,
        0.5 * c * (5.0 * s - 3.0),
        0.125 * c * ((63.0 * s - 70.0) * s + 15.0),
        0.0625 * c * (((429.0 * s - 693.0) * s + 315.0) * s - 35.0),
    )


@kernel
def _even(t):
    """P2, P4, P6 at t."""
    s = t * t
    return (
        0.5 * (3.0 * s - 1.0),
        0.125 * ((35.0 * s - 30.0) * s + 3.0),
        0.0625 * (((231.0 * s - 315.0) * s + 105.0) * s - 5.0),
    )


@kernel
def light_on_line(r_i, direction_i, sun_i):
    """(sunlight straight and thrown back, the Earth's infrared) [W/m per metre of width]; equations (1) to (3).

    r_i : place [m].   direction_i : along the line, a unit vector.   sun_i : the Sun's place [m].   All tuples, axes i.
    """
    to_sun = sub(sun_i, r_i)
    distance, radius = norm(to_sun), norm(r_i)
    strength = SOLAR_CONSTANT_W_M2 * (ASTRONOMICAL_UNIT_M / distance) ** 2
    view = line_view(dot(direction_i, r_i) / radius, radius)
    straight = strength * sunlit_kernel(r_i, sun_i) * norm(cross(direction_i, to_sun)) / distance  # (1)
    back = ALBEDO * strength * max(0.0, dot(r_i, to_sun) / (radius * distance)) * view  # (3)
    return straight + back, EARTH_INFRARED_W_M2 * view  # (2)
