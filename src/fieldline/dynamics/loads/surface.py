"""Forces on a body's outside: air drag and the Sun's light.

    F_drag = -1/2 rho C_D A |v_r| v_r,     v_r = v - omega_earth x r                                        (1)
    F_sun  = -nu P (au / d)^2 C_R A s                                                                      (2)
    N = p x F                                                                                              (3)

v_r: speed through air that turns with the Earth. nu: sunlit fraction; s: unit vector to the Sun, d its distance.
p: centre of pressure from the centre of mass. Area and coefficients do not depend on the attitude: a sphere, or the
mean of a tumbler; a plate that swings past the wind is a user's load.

P = 1361 W/m2 / c [IAU 2015 B3 for the solar constant]. Air that rests on the turning Earth: winds of 100 to 500 m/s
aloft, up to 6 % of the speed, are left out.
Source: Montenbruck and Gill, Satellite Orbits (2000), s. 3.4 and 3.5.
"""

from __future__ import annotations

from fieldline.compiled import kernel
from fieldline.constants import ASTRONOMICAL_UNIT_M, EARTH_ROTATION_RATE_RAD_S
from fieldline.environment.eclipse import sunlit_kernel
from fieldline.frames.vectors import cross, dot, norm, scale, sub

SOLAR_PRESSURE_N_M2 = 1361.0 / 299792458.0  # at one astronomical unit


@kernel
def drag_force(position_i, velocity_i, pole_i, density, drag_area):
    """Force [N], inertial axes; pole_i: unit vector of the Earth's axis; drag_area: C_D A [m^2]; equation (1)."""
    wind = sub(velocity_i, scale(EARTH_ROTATION_RATE_RAD_S, cross(pole_i, position_i)))
    return scale(-0.5 * density * drag_area * norm(wind), wind)


@kernel
def solar_force(position_i, sun_i, solar_area):
    """Force [N], inertial axes; sun_i: position of the Sun [m]; solar_area: C_R A [m^2]; equation (2)."""
    to_sun = sub(sun_i, position_i)
    square = dot(to_sun, to_sun)
    pressure = SOLAR_PRESSURE_N_M2 * ASTRONOMICAL_UNIT_M**2 / square
    return scale(-sunlit_kernel(position_i, sun_i) * pressure * solar_area / square**0.5, to_sun)
