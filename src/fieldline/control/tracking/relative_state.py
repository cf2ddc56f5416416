"""Where a vehicle is beside its target, in the target's axes, from what is known on board.

Axes h: x up, y along the velocity (of a circular orbit), z along the orbit's normal; they turn at W = |r x v| / r^2 about z.

    place = C_hi rho,   rate = C_hi drho/dt - W z x place                                           (1)
    angles: the body's turn from h, twice the vector of its quaternion;  rate = omega - C_bh W z    (2)

To first order (2) are the Cardan angles and rates of `mechanics.relative_motion`, whose order of states is kept; unlike them
it has no place where it fails short of half a turn. A body without a target is at its own place.
"""

from __future__ import annotations

from math import sqrt

from numba import njit

from fieldline.control.orbital_axes import quat_of_axes
from fieldline.control.readings import attitude_known, finite3, lifted, orbit_known, rate_known
from fieldline.frames.attitude import quat_conj, quat_mul, to_body
from fieldline.frames.vectors import cross, dot, scale, sub, unit


@njit(cache=True, error_model="numpy")
def state_known(measurement, target):
    """Whether all that (1) and (2) need is known; `target`: the place beside the first body too."""
    known = orbit_known(measurement) and attitude_known(measurement) and rate_known(measurement)
    if target > 0.5:
        beside = finite3(lifted(measurement.relative_position_i)) and finite3(lifted(measurement.relative_velocity_i))
        return known and beside
    return known


@njit(cache=True, error_model="numpy")
def relative_state(measurement, target, out):
    """Fill out (12,) with (1) and (2), SI; (q_hb, W) of the attitude against h (v_h = q v_b q*) and the axes' rate."""
    r, v = lifted(measurement.position_i), lifted(measurement.velocity_i)
    rho, drho = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    if target > 0.5:
        rho, drho = lifted(measurement.relative_position_i), lifted(measurement.relative_velocity_i)
        r, v = sub(r, rho), sub(v, drho)
    momentum = cross(r, v)
    x, z = unit(r), unit(momentum)
    y = cross(z, x)
    spin = sqrt(dot(momentum, momentum)) / dot(r, r)
    place = (dot(x, rho), dot(y, rho), dot(z, rho))
    out[0], out[2], out[4] = place[0], place[1], place[2]
    out[1] = dot(x, drho) + spin * place[1]
    out[3] = dot(y, drho) - spin * place[0]
    out[5] = dot(z, drho)
    q = measurement.q_bi
    q_hb = quat_mul(quat_conj(quat_of_axes(x, y, z)), (q[0], q[1], q[2], q[3]))
    sign = 2.0 if q_hb[3] >= 0.0 else -2.0
    turn_b = to_body(q_hb, (0.0, 0.0, spin))
    for j in range(3):
        out[6 + 2 * j] = sign * q_hb[j]
        out[7 + 2 * j] = measurement.omega_bi_b[j] - turn_b[j]
    return q_hb, spin


@njit(cache=True, error_model="numpy")
def field_known_b(measurement, by_magnetometer, factor):
    """Field [T] in body axes that the law takes for the truth: the model's times a factor, or the reading; zero if unknown."""
    if by_magnetometer > 0.5:
        field = lifted(measurement.field_b)
        return field if finite3(field) else (0.0, 0.0, 0.0)
    field = lifted(measurement.field_i)
    if not finite3(field):
        return (0.0, 0.0, 0.0)
    q = measurement.q_bi
    return scale(factor, to_body((q[0], q[1], q[2], q[3]), field))
