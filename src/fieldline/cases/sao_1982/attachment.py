"""Angular damping at the attachment, as loads of the plant: the upper body is seen, then the lower one is damped.

A load of a user's knows its own body. The damping needs both ends of the line, so a first load on the upper body, which is
asked before those of the lower one at every evaluation, keeps what it sees for the second. Each thread keeps its own.
"""

from __future__ import annotations

import threading

import numpy as np

from fieldline.dynamics.loads.joint import attachment_chord, joint_torque
from fieldline.frames.attitude import to_body, to_inertial
from fieldline.frames.vectors import norm

NOTHING = np.zeros(6)
_seen = threading.local()


def far_end(t, state, parameters):
    """On the upper body: keeps its place and velocity, and does nothing."""
    _seen.place, _seen.velocity = tuple(state[0:3]), tuple(state[3:6])
    return NOTHING


def joint_damping(t, state, parameters):
    """On the lower body: (1) of `dynamics.loads.joint`, none while the line is slack.

    parameters: lever x, y, z [m] in body axes, unstretched length of the line [m], damping [N m s].
    """
    q, omega = tuple(state[6:10]), to_inertial(tuple(state[6:10]), tuple(state[10:13]))
    lever = to_inertial(q, tuple(parameters[0:3]))
    chord, rate = attachment_chord(tuple(state[0:3]), tuple(state[3:6]), omega, lever, _seen.place, _seen.velocity)
    if norm(chord) <= parameters[3]:
        return NOTHING
    torque = to_body(q, joint_torque(lever, omega, chord, rate, parameters[4]))
    return np.concatenate([NOTHING[:3], torque])
