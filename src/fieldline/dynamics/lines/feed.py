"""A reel at B: what line of linear mass mu that streams out at the rate u, or back at -u, does to both sides of it.

The last segment has the unstretched length l; d = p1 - p_B is its chord from the reel to the last node, w = d'. Half of
its mass is at the node, half at the reel's end. Material leaves the reel at v_out = V_B + (u/l) d, stretched as the
segment is, and its velocity runs evenly to the node's v1. Through the segment's middle mu u/2 flows with the velocity
(v_out + v1)/2, which gives node and body (mass M without the half segment)

    dm1/dt = mu u/2,   m1 dv1/dt = ... + (mu u/4)(v_out - v1) = ... + (mu u/4)((u/l) d - w)                    (1)
    dM/dt = -mu u,     (M + mu l/2) dV_B/dt = T d/|d| + R                                                      (2)
    R = mu u V_B - (mu u/2) v_out - (mu u/4)(v_out + v1) - (mu l/2) d((u/l) d)/dt
      = -(mu/4)((u^2/l + 2 u') d + 3 u w)                                                                      (3)

so that M V_B + (mu l/2) v_out + m1 v1 + ... changes by what acts from outside alone, paying out or reeling in, and is the
rate of the first moment sum(m r). Line fed straight and evenly has w = (u/l) d: nothing on the node, and
R = -mu u^2 d/l, the force that sets the material going.

The line on the reel is at the centre of mass of the body, V there, and runs straight from there to the attachment at p,
with the momentum mu u p. That asks for one more force on the body, in the middle of the way:

    F = -d(mu u p)/dt - mu u (V_B - V) = -mu (u' p + 2 u p'),   p' = V_B - V,    at p/2                        (4)

A rate follows its command, or the tension of the last segment does:

    u' = (u_c - u) / lag            u' = (T - T_c) / m_reel                                                    (5)

Where l has grown beyond `APPEAR` of a full segment h, a node appears at the unstretched distance h from the last one:

    d1 = (1 - h/l) d,   w1 = w + (h/l)((u/l) d - w),   l1 = l - h                                              (6)

Both pieces then have the strain and the rate of strain of the whole, so no tension jumps, and momentum and first moment
are what they were. Where l has shrunk below `VANISH` of it, the last node n (d_n, w_n) gives way to the one before
it (d, w) at the unstretched distance r from it:

    T = (r T_1 + l T_2) / (r + l),   l1 = |d| / (1 + T / E A)                                                  (7)

the tension of the new piece is the mean of the two (what a bent piece is longer than its chord goes into the reel; where
either is slack, l1 = r + l). The momentum that the straight piece cannot carry goes to its ends by the lever rule. The
centre of mass of everything moves by the removed node's share of its distance from the chord.

Source: own derivation; a half segment lumped at either end is the discretisation of SKYHOOK (SAO 1982, section 3.2).
Valid for u small against the speed of waves in the line; what is still on the reel is at rest in its body.
"""

from __future__ import annotations

from math import sqrt

from fieldline.compiled import kernel
from fieldline.dynamics.parameters import RATE_REEL
from fieldline.frames.vectors import add, axpy, dot, scale, sub

APPEAR, VANISH = 1.5, 0.4  # of a full segment; what appears leaves 0.5 behind, so a node does not come and go


@kernel
def feed_acceleration(kind, command, rate, tension, lag):
    """u' [m/s^2] of (5); `lag` is the time constant [s] of a rate, or the effective mass [kg] of a reel by tension."""
    return (command - rate) / lag if kind == RATE_REEL else (tension - command) / lag


@kernel
def feed_loads(chord, chord_rate, length, rate, acceleration, linear_mass):
    """Forces [N] on the last node (1) and on the reel's body (3); chord d [m], w [m/s], l [m], u [m/s], u' [m/s^2], mu [kg/m]."""
    flow = 0.25 * linear_mass * rate
    on_node = scale(flow, axpy(rate / length, chord, scale(-1.0, chord_rate)))
    pushed = 0.25 * linear_mass * (rate * rate / length + 2.0 * acceleration)
    return on_node, axpy(-pushed, chord, scale(-3.0 * flow, chord_rate))


@kernel
def passage_push(arm, arm_rate, moving):
    """Force [N] of (4); arm p [m] and p' [m/s], inertial axes; moving: mu u [kg/s] and mu u' [kg/s^2]."""
    return scale(-1.0, axpy(moving[1], arm, scale(2.0 * moving[0], arm_rate)))


@kernel
def piece_momentum(linear_mass, length, rate, chord, chord_rate):
    """Momentum [N s] of a last segment against the reel: halves of it at w and at (u/l) d."""
    return scale(0.5 * linear_mass, axpy(rate, chord, scale(length, chord_rate)))


@kernel
def insert_node(chord, chord_rate, length, rate, spacing, stiffness, linear_mass):
    """(d1, w1, l1, momentum left over [N s]) of the node that appears; equation (6).

    stiffness, linear_mass: of the piece before the node and of the one after it, pairs. Where they differ, l1 is what has
    the same elastic tension, and what momentum is left over is the reel's body's.
    """
    part = spacing / length
    place = scale(1.0 - part, chord)
    moving = axpy(part, axpy(rate / length, chord, scale(-1.0, chord_rate)), chord_rate)
    rest = length - spacing
    if stiffness[0] != stiffness[1]:
        strain = sqrt(dot(chord, chord)) / length - 1.0
        rest *= (1.0 + strain) / (1.0 + strain * stiffness[0] / stiffness[1])
    before = piece_momentum(linear_mass[0], length, rate, chord, chord_rate)
    inner = scale(0.5 * linear_mass[0] * spacing, add(chord_rate, moving))
    after = add(inner, piece_momentum(linear_mass[1], rest, rate, place, moving))
    return place, moving, rest, sub(before, after)


@kernel
def pull(chord, length, stiffness):
    """Elastic tension [N] of a piece, negative where it is slack."""
    return stiffness * (sqrt(dot(chord, chord)) / length - 1.0)


@kernel
def remove_node(chord, chord_rate, node, node_rate, spacing, length, rate, stiffness, linear_mass):
    """(l1, momenta [N s] for the node before and for the reel's body) where a node vanishes; equation (7).

    chord, chord_rate: d, w of the node before; node, node_rate: of the one that vanishes; spacing: r between them; length: l.
    stiffness, linear_mass: of the pieces before and after it, pairs; the new piece is made of the first.
    """
    whole = spacing + length
    between = sub(chord, node)
    tension = (pull(between, spacing, stiffness[0]), pull(node, length, stiffness[1]))
    rest = whole
    if tension[0] > 0.0 and tension[1] > 0.0:
        mean = (spacing * tension[0] + length * tension[1]) / whole
        rest = sqrt(dot(chord, chord)) / (1.0 + mean / stiffness[0])
    inner = scale(0.5 * linear_mass[0] * spacing, add(chord_rate, node_rate))
    before = add(inner, piece_momentum(linear_mass[1], length, rate, node, node_rate))
    over = sub(before, piece_momentum(linear_mass[0], rest, rate, chord, chord_rate))
    share = length / whole
    return rest, scale(share, over), scale(1.0 - share, over)
