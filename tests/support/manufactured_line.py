"""A motion of a line that is chosen, and the forces that make it exact: of the continuum, or of nodes and segments.

    r(s, t) = O + up (1 + e) s + x a sin(pi s/L) cos(w1 t) + y b sin(2 pi s/L) sin(w2 t)
              + up d sin(pi s/L) cos(w3 t) + x A (1 - cos(w4 t))                                             (1)
    f = mu r_tt - (T r_s / |r_s|)_s,   T = EA (|r_s| - 1) + c |r_s|_t                                         (2)

x and y across, up along x_i. (2) times the length of a node's mass is the force on it; the Earth's gravity is taken off. The
ends are held bodies that move by A (1 - cos(w4 t)).
"""

from math import cos, pi, sin, sqrt

import numpy as np
from numba import njit

from line_loads import GM, ORIGIN_M

LENGTH, KG_PER_M, STIFFNESS, DAMPING = 100.0, 0.2, 2e3, 40.0
STRAIN, BOW_X, BOW_Y, STRETCH, SHIFT = 0.05, 4.0, 2.0, 0.5, 3.0
W1, W2, W3, W4 = 1.1, 1.7, 2.3, 0.9


@njit(cache=True)
def motion(s, t):
    """(9, 3) of (1): r from O, r_s, r_t, r_ss, r_st, r_tt, r_sst; rows 7 and 8 are not used."""
    k = pi / LENGTH
    out = np.zeros((9, 3))
    parts = (
        (1, BOW_X, k, cos(W1 * t), -W1 * sin(W1 * t), -W1 * W1 * cos(W1 * t)),
        (2, BOW_Y, 2.0 * k, sin(W2 * t), W2 * cos(W2 * t), -W2 * W2 * sin(W2 * t)),
        (0, STRETCH, k, cos(W3 * t), -W3 * sin(W3 * t), -W3 * W3 * cos(W3 * t)),
    )
    for axis, size, wave, now, rate, acceleration in parts:
        sine, cosine = size * sin(wave * s), size * wave * cos(wave * s)
        out[0, axis] += sine * now
        out[1, axis] += cosine * now
        out[2, axis] += sine * rate
        out[3, axis] += -wave * wave * sine * now
        out[4, axis] += cosine * rate
        out[5, axis] += sine * acceleration
        out[6, axis] += -wave * wave * sine * rate
    out[0, 0] += (1.0 + STRAIN) * s
    out[1, 0] += 1.0 + STRAIN
    out[0, 1] += SHIFT * (1.0 - cos(W4 * t))
    out[2, 1] += SHIFT * W4 * sin(W4 * t)
    out[5, 1] += SHIFT * W4 * W4 * cos(W4 * t)
    return out


@njit(cache=True)
def pull_gradient(s, t):
    """(3,) (T r_s / |r_s|)_s [N/m] of equation (2)."""
    m = motion(s, t)
    q, bend, q_t, bend_t = m[1], m[3], m[4], m[6]
    long = sqrt(q @ q)
    long_s, long_t = (q @ bend) / long, (q @ q_t) / long
    long_st = (q_t @ bend + q @ bend_t) / long - long_s * long_t / long
    tension, gradient = STIFFNESS * (long - 1.0) + DAMPING * long_t, STIFFNESS * long_s + DAMPING * long_st
    return gradient / long * q + tension * (bend / long - long_s / long**2 * q)


@njit(cache=True)
def segment_pull(s0, s1, t):
    """(3,) [N] of a straight segment between two material places."""
    a, b = motion(s0, t), motion(s1, t)
    chord, rate = b[0] - a[0], b[2] - a[2]
    long = sqrt(chord @ chord)
    tension = (STIFFNESS * (long - (s1 - s0)) + DAMPING * (chord @ rate) / long) / (s1 - s0)
    return tension / long * chord


@njit(cache=True)
def weightless(out, state):
    """Add what takes the Earth's gravity off a node."""
    r3 = sqrt(state[0] ** 2 + state[1] ** 2 + state[2] ** 2) ** 3
    for j in range(3):
        out[j] += state[7] * GM * state[j] / r3


@njit(cache=True)
def of_continuum(t, state, parameters):
    """On nodes: equation (2) times the length of their mass."""
    out = np.zeros(6)
    s = state[6]
    out[:3] = state[7] / KG_PER_M * (KG_PER_M * motion(s, t)[5] - pull_gradient(s, t))
    weightless(out, state)
    return out


@njit(cache=True)
def of_chain(t, state, parameters):
    """On nodes a distance p apart: what makes (1) exact for straight segments."""
    out = np.zeros(6)
    s, h = state[6], parameters[0]
    out[:3] = state[7] * motion(s, t)[5] - segment_pull(s, s + h, t) + segment_pull(s - h, s, t)
    weightless(out, state)
    return out


def exact(nodes, t):
    """(p, 3) places and velocities of all points, inertial axes."""
    rows = np.array([motion(s, t) for s in np.linspace(0.0, LENGTH, nodes + 2)])
    return rows[:, 0] + np.array([ORIGIN_M, 0.0, 0.0]), rows[:, 2]
