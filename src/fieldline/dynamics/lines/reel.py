"""A reel at B: line of linear mass mu leaves it at the rate u, or comes back at -u, and what that does to both sides.

The last segment has the unstretched length l; e points from the reel's attachment to the last node. Half of the segment's
mass sits at the node, half at the reel's end; between them the velocity of the material runs evenly from the node's v1
to v_out = V_B + u e, at which it leaves the reel. Through the segment's middle flows mu u/2 with (v_out + v1)/2, so

    node:   m1 dv1/dt = ... + (mu u/4)(v_out - v1),   dm1/dt = mu u/2                                    (1)
    reel:   (M + mu l/2) dV_B/dt = T e + R,           dM/dt = -mu u                                       (2)
            R = mu u V_B - (mu u/2) v_out - (mu u/4)(v_out + v1) - (mu l/2) d(u e)/dt
              = -(mu u/4)(3 u e + w) - (mu l/2)(u' e + u de/dt),   w = v1 - V_B                           (3)

(2) is what the conservation of  M V_B + (mu l/2) v_out + m1 v1 + ...  asks for. A line fed straight and evenly has
w = u e: no force on the node, and -mu u^2 e on the reel, the force that brings the material to its speed.

    rate follows a command:      u' = (u_c - u) / lag                                                     (4)
    tension follows a command:   u' = (T - T_c) / m_reel                                                  (5)
"""

from __future__ import annotations

from math import sqrt

from fieldline.compiled import inner
from fieldline.dynamics.parameters import RATE_REEL
from fieldline.frames.vectors import add, axpy, dot, scale


@inner
def feed_acceleration(kind, command, rate, tension, lag):
    """u' [m/s^2] of (4) or (5); `lag` is the time constant [s] or the reel's effective mass [kg]."""
    return (command - rate) / lag if kind == RATE_REEL else (tension - command) / lag


@inner
def reel_push(away, away_rate, length, rate, acceleration, linear_mass):
    """Forces [N] on the last node and on the reel's body, equations (1) and (3); `away`: node less attachment, and its rate."""
    distance = sqrt(dot(away, away))
    e = scale(1.0 / distance, away)
    turn = scale(1.0 / distance, axpy(-dot(e, away_rate), e, away_rate))
    flow = 0.25 * linear_mass * rate
    on_node = scale(flow, axpy(-1.0, away_rate, scale(rate, e)))
    streaming = scale(-flow, axpy(3.0 * rate, e, away_rate))
    speeding = scale(-0.5 * linear_mass * length, add(scale(acceleration, e), scale(rate, turn)))
    return on_node, add(streaming, speeding)
