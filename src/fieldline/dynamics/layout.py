"""Where things stand in z: three numbers at a time, attitudes within a step, and where nodes, feeds and temperatures start.

Equations (1) and (2) of `fieldline.dynamics.parameters`.
"""

from __future__ import annotations

from fieldline.compiled import inner
from fieldline.dynamics.parameters import TANGENT, Plant
from fieldline.frames.attitude import quat_exp, quat_mul

NOTHING = (0.0, 0.0, 0.0)


@inner
def three(z, at):
    """Three numbers of an array as a tuple."""
    return (z[at], z[at + 1], z[at + 2])


@inner
def store(z, at, v):
    """A tuple as three numbers of an array."""
    z[at] = v[0]
    z[at + 1] = v[1]
    z[at + 2] = v[2]


@inner
def attitude_at(z, start, b):
    """q_bi of body b within a step."""
    q0 = (start[b, 0], start[b, 1], start[b, 2], start[b, 3])
    return quat_mul(q0, quat_exp(three(z, TANGENT * b + 6)))


@inner
def nodes_at(plant):
    """Where the nodes start in z; 6 numbers each, r_i and v_i."""
    return TANGENT * plant.bodies.mass.shape[0] + plant.wheels.body.shape[0] + plant.rods.body.shape[0]


@inner
def feeds_at(plant):
    """Where the feeds start in z; 2 numbers a line, length and rate of the last segment."""
    return nodes_at(plant) + 6 * plant.lines.first[plant.lines.nodes.shape[0]]


@inner
def temperatures_at(plant):
    """Where the temperatures start in z; one a segment of a warm line."""
    return feeds_at(plant) + 2 * plant.lines.nodes.shape[0]


def starts_in_state(plant: Plant) -> tuple[int, int, int]:
    """Where nodes, feeds and temperatures start in the state y, for Python."""
    bodies, lines = len(plant.bodies.mass), plant.lines
    nodes = (TANGENT + 1) * bodies + len(plant.wheels.body) + len(plant.rods.body)
    feeds = nodes + 6 * int(lines.first[-1])
    return nodes, feeds, feeds + 2 * len(lines.nodes)
