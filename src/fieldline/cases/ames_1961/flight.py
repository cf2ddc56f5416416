"""A rigid vehicle pointed by coils along a star, as one compiled loop: sensor, law, coils, Euler's equation.

The sensor sees the star's direction s in body axes (x is the tracking line) as two errors, each limited,

    A_y = -atan2(s_z, s_x),   A_z = atan2(s_y, s_x),   |A| <= limit                                        (1)

and the law asks for the torques (the study's G(s) A, with the rate term and an integral)

    T_k = K_p A_k + K_d dA_k/dt + K_i int A_k dt,   k = y, z                                               (2)

The rate is that of the limited signal: none while the sensor is at its limit. The integral waits while the sensor or a
coil is at its limit. Coil moments follow by three coils (8) or two (10), each clipped; the vehicle turns by

    J domega/dt = M x B + T_d + T_w - omega x (J omega + h),     dh/dt = -T_w                              (3)

T_d : disturbance, constant in inertial axes. T_w : about x alone, of a roll wheel with momentum h, where there is one:
T_w = -J_x (w_r^2 roll + 1.4 w_r omega_x). State by RK4 at a fixed step; the jumps of (2) cost an error of first order
in the step, which `tests/published` hold against an adaptive solver.

An analogue computer would not carry the attitude: with `small_angle`, y and z are double integrators and only the roll
turns the field,

    dA_k/dt = -omega_k,   q_bi = exp(roll x / 2)                                                           (4)

which differs from (1) and (3) by roll times error, and where B_x is zero to within the errors themselves.
"""

from __future__ import annotations

from math import atan2, sqrt
from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.control.coils import three_coil_moment, two_coil_moment
from fieldline.frames.attitude import quat_mul, to_body
from fieldline.frames.matrices import matvec
from fieldline.frames.vectors import add, axpy, cross, dot, put, sub, vec

ROLL_DAMPING = 1.4  # twice the damping ratio of the roll wheel's loop
STATES = 14  # q_bi (4), omega_bi_b (3), integrals of A_y and A_z, roll wheel's momentum, int |M|^2 dt, roll, A_y and A_z of (4)


class Vehicle(NamedTuple):
    """Everything but the field; floats and tuples of floats, SI."""

    inertia: tuple  # 9, row by row
    inertia_inv: tuple
    coils: int  # 3 or 2
    gain_p: float  # K_p [N m/rad], K_d [N m s/rad], K_i [N m/(rad s)]
    gain_d: float
    gain_i: float
    sensor_limit: float  # [rad]
    moment_limit: float  # [A m^2]
    field_scale: tuple  # 3: what the law believes of each component of the field
    disturbance_i: tuple  # 3 [N m]
    roll_rate: float  # w_r [rad/s] of the roll wheel; 0 without one
    small_angle: bool  # (4) instead of the whole attitude


@njit(cache=True)
def field_at(t, field_i, field_step):
    """Field [T] at t, linear between the rows of (n, 3), the last of which holds on."""
    k = min(int(t / field_step), field_i.shape[0] - 2)
    part = min(max(t / field_step - k, 0.0), 1.0)
    return axpy(part, sub(vec(field_i, k + 1), vec(field_i, k)), vec(field_i, k))


@njit(cache=True)
def errors_of(q, omega):
    """A_y, A_z [rad] and their rates [rad/s]; equation (1), without the limit."""
    s = to_body(q, (1.0, 0.0, 0.0))
    rate = cross(s, omega)
    away_y, away_z = s[0] * s[0] + s[2] * s[2], s[0] * s[0] + s[1] * s[1]
    rate_y = -(s[0] * rate[2] - s[2] * rate[0]) / away_y
    rate_z = (s[0] * rate[1] - s[1] * rate[0]) / away_z
    return -atan2(s[2], s[0]), atan2(s[1], s[0]), rate_y, rate_z


@njit(cache=True)
def asked_torque(error, rate, integral, vehicle):
    """T_k [N m] of (2) from an error, its rate and its integral."""
    if error >= vehicle.sensor_limit or error <= -vehicle.sensor_limit:
        limited, seen_rate = (vehicle.sensor_limit if error > 0.0 else -vehicle.sensor_limit), 0.0
    else:
        limited, seen_rate = error, rate
    return vehicle.gain_p * limited + vehicle.gain_d * seen_rate + vehicle.gain_i * integral


@njit(cache=True)
def clipped(moment, limit):
    """Each coil at its limit at most, and whether one is."""
    x, y, z = moment
    full = abs(x) > limit or abs(y) > limit or abs(z) > limit
    return (min(max(x, -limit), limit), min(max(y, -limit), limit), min(max(z, -limit), limit)), full


@njit(cache=True)
def coil_moment(field_b, asked_y, asked_z, vehicle):
    """Moment [A m^2] by the law's own idea of the field, clipped, and whether a coil is at its limit."""
    f = vehicle.field_scale
    seen = (f[0] * field_b[0], f[1] * field_b[1], f[2] * field_b[2])
    if vehicle.coils == 3:
        return clipped(three_coil_moment(seen, asked_y, asked_z), vehicle.moment_limit)
    return clipped(two_coil_moment(seen, asked_y, asked_z), vehicle.moment_limit)


@njit(cache=True)
def commanded(state, field, vehicle):
    """Errors (4), moment [A m^2] and whether a coil is at its limit, at a state."""
    q = (state[0], state[1], state[2], state[3])
    if vehicle.small_angle:
        seen = (state[12], state[13], -state[5], -state[6])
    else:
        seen = errors_of(q, (state[4], state[5], state[6]))
    asked_y = asked_torque(seen[0], seen[2], state[7], vehicle)
    asked_z = asked_torque(seen[1], seen[3], state[8], vehicle)
    moment, full = coil_moment(to_body(q, field), asked_y, asked_z, vehicle)
    return seen, moment, full


@njit(cache=True)
def scale4(s, q):
    """s q of four floats."""
    return (s * q[0], s * q[1], s * q[2], s * q[3])


@njit(cache=True)
def derivative(state, field, vehicle, out):
    """Fill `out` (STATES) with d(state)/dt in field [T] (tuple, inertial axes)."""
    q = (state[0], state[1], state[2], state[3])
    omega = (state[4], state[5], state[6])
    seen, moment, full = commanded(state, field, vehicle)
    coil = add(cross(moment, to_body(q, field)), to_body(q, vehicle.disturbance_i))
    w = vehicle.roll_rate
    wheel = -vehicle.inertia[0] * w * (w * state[11] + ROLL_DAMPING * omega[0])
    momentum = add(matvec(vehicle.inertia, omega), (state[9], 0.0, 0.0))
    rate = matvec(vehicle.inertia_inv, sub(add(coil, (wheel, 0.0, 0.0)), cross(omega, momentum)))  # (3)
    turning = (omega[0], 0.0, 0.0) if vehicle.small_angle else omega
    out[0], out[1], out[2], out[3] = scale4(0.5, quat_mul(q, (turning[0], turning[1], turning[2], 0.0)))
    out[4], out[5], out[6] = rate
    held = full or max(abs(seen[0]), abs(seen[1])) >= vehicle.sensor_limit
    out[7] = 0.0 if held else seen[0]
    out[8] = 0.0 if held else seen[1]
    out[9] = -wheel
    out[10] = dot(moment, moment)
    out[11] = omega[0]
    out[12], out[13] = -omega[1], -omega[2]


@njit(cache=True)
def fly(state, field_i, field_step, step, each, vehicle, times, states, moments, fields_b, full_share):
    """Advance `state` (STATES) to the end of `times` (n,), n - 1 spans of `each` steps; fill (n, STATES), (n, 3), (n, 3), (n,).

    full_share : the part of the span before in which a coil was at its limit.
    """
    k1, k2, k3, k4, middle = np.empty(STATES), np.empty(STATES), np.empty(STATES), np.empty(STATES), np.empty(STATES)
    for row in range(times.shape[0]):
        start = times[row]
        field = field_at(start, field_i, field_step)
        _, moment, full = commanded(state, field, vehicle)
        states[row] = state
        put(moments, row, moment)
        put(fields_b, row, to_body((state[0], state[1], state[2], state[3]), field))
        if row + 1 == times.shape[0]:
            break
        limited = 0
        for part in range(each):
            t = start + part * step
            _, _, full = commanded(state, field_at(t, field_i, field_step), vehicle)
            limited += full
            _advance(state, t, step, field_i, field_step, vehicle, k1, k2, k3, k4, middle)
        full_share[row + 1] = limited / each


@njit(cache=True)
def _advance(state, t, step, field_i, field_step, vehicle, k1, k2, k3, k4, middle):
    """One RK4 step in place; the quaternion is made a unit again."""
    here = field_at(t, field_i, field_step)
    half = field_at(t + 0.5 * step, field_i, field_step)
    ahead = field_at(t + step, field_i, field_step)
    derivative(state, here, vehicle, k1)
    for j in range(STATES):
        middle[j] = state[j] + 0.5 * step * k1[j]
    derivative(middle, half, vehicle, k2)
    for j in range(STATES):
        middle[j] = state[j] + 0.5 * step * k2[j]
    derivative(middle, half, vehicle, k3)
    for j in range(STATES):
        middle[j] = state[j] + step * k3[j]
    derivative(middle, ahead, vehicle, k4)
    for j in range(STATES):
        state[j] += step / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j])
    size = 1.0 / sqrt(state[0] ** 2 + state[1] ** 2 + state[2] ** 2 + state[3] ** 2)
    for j in range(4):
        state[j] *= size
