"""Moments of coils against the field: two axes held by three coils or by two, and momentum drawn out of wheels.

A coil's moment M in the field B turns the body by M x B, so no torque along B can be had. Asking for the torques T_y and
T_z across the tracked line x leaves (the roll torque is the price, the same for two coils and for three)

    T_x = -(T_y B_y + T_z B_z) / B_x                                                               (4)

and one freedom, a moment along B that turns nothing. Three coils spend it on the least moment, M . B = 0:

    M_x = (T_z B_y - T_y B_z) / B^2
    M_y = -(T_y B_y B_z + T_z (B_x^2 + B_z^2)) / (B_x B^2)                                         (8)
    M_z = (T_y (B_x^2 + B_y^2) + T_z B_y B_z) / (B_x B^2)

and two coils on M_x = 0:

    M_y = -T_z / B_x,   M_z = T_y / B_x                                                            (10)

The momentum H of the wheels is drawn out by (its part along B stays until the field has turned)

    M = -K (B x H) / B^2,   so that   T = -K (H - B (B . H) / B^2)                                 (11)

As B_x goes to zero, M_y and M_z of (8) and (10) grow without bound. The kernels divide by no less than `FLOOR` of |B|
(of the sign of B_x, positive for a plain zero), so what they return is finite and a coil's saturation makes the limit
of it. At B_x = 0 three coils still give T_y = B_z e / B^2, T_z = -B_y e / B^2 with e = T_y B_z - T_z B_y asked for; two
coils give none. In a field of zero every moment is zero.

Numbers of equations, and source: White, Shigemoto and Bourquin (1961), Satellite attitude control utilizing the Earth's
magnetic field, NASA TN D-1068. SI units throughout; vectors are 3-tuples in body axes.
"""

from __future__ import annotations

from math import copysign, sqrt

from numba import njit

from fieldline.frames.vectors import cross, dot, scale

FLOOR = 1e-12  # of |B|: far below what a magnetometer tells from zero, far above rounding


@njit(cache=True)
def _tracked_component(field_b):
    """B_x, held off zero by `FLOOR` of |B|."""
    least = FLOOR * sqrt(dot(field_b, field_b))
    return field_b[0] if abs(field_b[0]) > least else copysign(least, field_b[0])


@njit(cache=True)
def three_coil_moment(field_b, torque_y, torque_z):
    """Least moment [A m^2] that gives T_y and T_z [N m] in field_b [T]; equation (8)."""
    square = dot(field_b, field_b)
    if square == 0.0:
        return (0.0, 0.0, 0.0)
    roll = -(torque_y * field_b[1] + torque_z * field_b[2]) / _tracked_component(field_b)  # (4)
    return scale(1.0 / square, cross(field_b, (roll, torque_y, torque_z)))


@njit(cache=True)
def two_coil_moment(field_b, torque_y, torque_z):
    """Moment [A m^2] of the coils y and z alone that gives T_y and T_z [N m] in field_b [T]; equation (10)."""
    if dot(field_b, field_b) == 0.0:
        return (0.0, 0.0, 0.0)
    along = _tracked_component(field_b)
    return (0.0, -torque_z / along, torque_y / along)


@njit(cache=True)
def dumping_moment(field_b, momentum_b, gain):
    """Moment [A m^2] that draws momentum_b [N m s] across field_b [T] at the rate `gain` [1/s]; equation (11)."""
    square = dot(field_b, field_b)
    if square == 0.0:
        return (0.0, 0.0, 0.0)
    return scale(-gain / square, cross(field_b, momentum_b))
