"""Two laws against a skiprope: a body that yaws, as the place at which its tether leaves it, and a current along the tether."""

from math import cos, pi, sin

import numpy as np


def arm(t, measurement, memory, params):
    """Places along body x and y [m]: params are start, stop [s], rate [rad/s], arm [m], azimuth from the normal aft [rad]."""
    start, stop, rate, length, azimuth = params
    angle = azimuth + rate * (min(max(t, start), stop) - start)
    return np.array([-length * sin(angle), -length * cos(angle)])  # u = x, v = -y


def current(t, measurement, memory, params):
    """Current [A] against the motion of a model of the first half wave that began as the estimate said, and hears the force.

    q'' + w^2 q = (4 / pi) (I / mu) up x B,   I = -gain (up x B) . q' / |B|^2, at most the largest

    params: mass per length [kg/m], largest current [A], gain [A s/m T], then for each round start and stop [s], w [rad/s],
    and of the middle U, V [m], U', V' [m/s] at the start. memory: the round's start, last time, q, q'.
    """
    mass, most, gain = params[:3]
    rounds = np.reshape(params[3:], (-1, 7))
    now = [one for one in rounds if one[0] <= t < one[1]]
    if not now:
        return np.zeros(1)
    start, _, w, *middle = now[0]
    if memory[0] != start:
        memory[:] = (start, start, *middle)
    position, velocity, field = measurement.position_i, measurement.velocity_i, measurement.field_i
    up = position / np.linalg.norm(position)
    normal = np.cross(position, velocity)
    normal /= np.linalg.norm(normal)
    ahead = np.cross(normal, up)
    push = np.array([-field @ normal, field @ ahead])  # up x B along U, V
    step = t - memory[1]
    wanted = -gain * (push @ memory[4:6]) / (push @ push)
    driven = min(max(wanted, -most), most)
    c, s, rest = cos(w * step), sin(w * step), 4.0 / pi * driven / mass * push / w**2
    away = memory[2:4] - rest
    memory[2:4], memory[4:6] = rest + c * away + s / w * memory[4:6], -w * s * away + c * memory[4:6]
    memory[1] = t
    return np.array([driven])
