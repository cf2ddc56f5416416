"""Orbital axes o from position and velocity: z to nadir, y against the orbit normal, x completes (along the velocity).

    z_o = -r/|r|,   y_o = -h/|h|,   x_o = y_o x z_o,   h = r x v                                   (24)
    omega_oi = h / |r|^2 = -(|h| / |r|^2) y_o                                                      (25)

(25) leaves out the turn of the orbit's plane, 2e-7 rad/s of precession at most in low orbit. Kernels; 3-tuples, SI.
"""

from __future__ import annotations

from math import atan2, sqrt

from numba import njit

from fieldline.frames.vectors import cross, dot, norm, scale, unit


@njit(cache=True)
def quat_of_axes(x, y, z):
    """q (scalar last) with v_outer = q * v_inner * conj(q) of right-handed unit axes x, y, z given in the outer axes.

    Shepperd's choice of the largest component keeps every digit at every attitude.
    """
    trace = x[0] + y[1] + z[2]
    if trace >= max(x[0], y[1], z[2]):
        w = 0.5 * sqrt(1.0 + trace)
        s = 0.25 / w
        return (s * (y[2] - z[1]), s * (z[0] - x[2]), s * (x[1] - y[0]), w)
    if x[0] >= max(y[1], z[2]):
        a = 0.5 * sqrt(1.0 + 2.0 * x[0] - trace)
        s = 0.25 / a
        return (a, s * (x[1] + y[0]), s * (x[2] + z[0]), s * (y[2] - z[1]))
    if y[1] >= z[2]:
        a = 0.5 * sqrt(1.0 + 2.0 * y[1] - trace)
        s = 0.25 / a
        return (s * (x[1] + y[0]), a, s * (y[2] + z[1]), s * (z[0] - x[2]))
    a = 0.5 * sqrt(1.0 + 2.0 * z[2] - trace)
    s = 0.25 / a
    return (s * (x[2] + z[0]), s * (y[2] + z[1]), a, s * (x[1] - y[0]))


@njit(cache=True)
def orbital_attitude(position_i, velocity_i):
    """q_oi of the axes (24): v_i = q v_o conj(q)."""
    z = scale(-1.0 / norm(position_i), position_i)
    y = unit(cross(velocity_i, position_i))
    return quat_of_axes(cross(y, z), y, z)


@njit(cache=True)
def orbital_rate(position_i, velocity_i):
    """Rate of the orbital axes [rad/s], inertial axes, equation (25)."""
    return scale(1.0 / dot(position_i, position_i), cross(position_i, velocity_i))


@njit(cache=True)
def argument_of_latitude(position_i, velocity_i):
    """Angle [rad] of the satellite from the ascending node, along its motion; from the x axis for an equatorial orbit."""
    momentum = cross(position_i, velocity_i)
    node = (-momentum[1], momentum[0], 0.0)
    if dot(node, node) < 1e-12 * dot(momentum, momentum):
        node = (1.0, 0.0, 0.0)
    ahead = cross(unit(momentum), node)
    return atan2(dot(position_i, ahead), dot(position_i, node))
