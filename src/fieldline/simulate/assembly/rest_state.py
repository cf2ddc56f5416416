"""Several bodies at rest on one vertical: a tree of lines that turns about the Earth at one rate.

    w^2 sum m r = sum m GM / r^2                                                                            (1)
    T_i = s_i sum over what hangs at i or beyond of m (w^2 r - GM / r^2),   l_i = l0_i (1 + T_i / EA_i)        (2)

r: distance of every mass, bodies and nodes, from the Earth's centre; s_i = 1 for what hangs upward, -1 downward. Each line
pulls on what carries it; levers of a body, metres in thousands of kilometres, are left out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError
from fieldline.simulate.assembly.lines import strand_of

PASSES = 60


class Tree(NamedTuple):
    """Points in an order in which each comes after the one that carries it; the first carries all."""

    parent: np.ndarray  # (n,) int
    mass: np.ndarray  # (n,) [kg]
    rest: np.ndarray  # (n,) [m] of the segment to the parent
    stiffness: np.ndarray  # (n,) [N]
    sign: np.ndarray  # (n,) 1 above its parent, -1 below it
    of_body: dict[str, list[int]]  # the points of each hanging body's line, carrier first


def rest_of(scenario, body, position_i, velocity_i, line_of, carrier_of):
    """State of the line on which a body hangs, from its carrier's attachment at `position_i` on."""
    from fieldline.analysis.tether import LineState

    position, velocity = np.asarray(position_i, dtype=float), np.asarray(velocity_i, dtype=float)
    tree = _tree(scenario, line_of, carrier_of)
    points = tree.of_body[body.name]
    radius, up = float(np.linalg.norm(position)), position / np.linalg.norm(position)
    height, rate = _rest(tree, points[0], radius)
    places = position + (height[points] - height[points[0]])[:, None] * up
    normal = np.cross(position, velocity)
    return LineState(places, np.cross(rate * normal / np.linalg.norm(normal), places))


def _tree(scenario, line_of, carrier_of) -> Tree:
    """Bodies and nodes of everything that hangs from the first body that carries."""
    hanging = [body for body in scenario.body if body.hang is not None]
    root = carrier_of(scenario, hanging[0])
    parent, mass, rest, stiffness, sign = [0], [root.mass_kg], [0.0], [1.0], [0.0]
    place, of_body = {root.name: 0}, {}
    for body in hanging:
        k = line_of(scenario, body)
        strand = strand_of(scenario.line[k])
        if scenario.line[k].to_body != body.name:
            strand = type(strand)(*(part[::-1].copy() for part in strand))
        at = place[carrier_of(scenario, body).name]
        of_body[body.name] = [at]
        for length, pull, linear in zip(*strand, strict=True):
            half = 0.5 * length * linear
            mass[at] += half
            parent.append(at)
            mass.append(half)
            rest.append(length)
            stiffness.append(pull)
            sign.append(1.0 if body.hang.upward else -1.0)
            at = len(parent) - 1
            of_body[body.name].append(at)
        mass[at] += body.mass_kg
        place[body.name] = at
    return Tree(np.array(parent), *(np.array(x) for x in (mass, rest, stiffness, sign)), of_body)


def _rest(tree: Tree, known: int, radius: float) -> tuple[np.ndarray, float]:
    """(heights over the root [m], rate [rad/s]) of equations (1) and (2), point `known` being at a radius [m]."""
    lengths = tree.rest.copy()
    for _ in range(PASSES):
        height = np.zeros(len(lengths))
        for i in range(1, len(lengths)):
            height[i] = height[tree.parent[i]] + tree.sign[i] * lengths[i]
        r = radius + height - height[known]
        fall = EARTH_GM_M3_S2 / r**2
        square = (tree.mass @ fall) / (tree.mass @ r)
        load = tree.mass * (square * r - fall)
        for i in range(len(lengths) - 1, 0, -1):
            load[tree.parent[i]] += load[i]
        tension = tree.sign * load
        longer = tree.rest * (1.0 + tension / tree.stiffness)
        if np.any(tension[1:] < 0.0) or np.any(longer > 2.0 * tree.rest):
            raise InputError(
                "at rest a line would be pushed, or stretch to more than twice its length: is each body on its side?"
            )
        if np.abs(longer - lengths).max() <= 1e-15 * np.abs(height).max():
            break
        lengths = longer
    return height, float(np.sqrt(square))
