"""What segments pull: one of them, or those between the nodes of a line; equations (1), (2) of `dynamics.lines.chain`.

This is where a line's time goes. `pull_inside` is given plain arrays that begin with the line, sums nothing over the line
and treats all its nodes alike: so the compiler takes four nodes at a time, which takes 5.5 instead of 9.6 ns a
segment. Given a record, or with the ends in the loop, it does not.
"""

from __future__ import annotations

from math import sqrt

from fieldline.compiled import inner, merged
from fieldline.dynamics.layout import store, three
from fieldline.frames.vectors import axpy, dot, scale, sub


@merged
def tighten(chord, chord_rate, rest, rest_rate, stiffness, damping):
    """Tension [N] of a segment by (1), and what it pulls per metre of chord [N/m]; zeros where it is slack."""
    stretched = sqrt(dot(chord, chord))
    if stretched <= rest:
        return 0.0, 0.0
    inverse, share = 1.0 / stretched, 1.0 / rest
    rate = dot(chord, chord_rate) * inverse - rest_rate * stretched * share
    tension = max(0.0, (stiffness * (stretched - rest) + damping * rate) * share)
    return tension, tension * inverse


@merged
def node_rate(ahead, behind, mass, r_i, gm):
    """(2) of a node of a mass [kg] between two pulls [N], under the pull of a point Earth alone [m/s^2]."""
    square = dot(r_i, r_i)
    weight = scale(-gm / (square * sqrt(square)), r_i)
    return axpy(1.0 / mass, sub(ahead, behind), weight)


@inner
def pull_inside(nodes, rests, masses, stiffness, damping, gm, behind, tensions, rates):
    """Tensions of the segments between the nodes of a line, and the rates of all nodes but the last.

    nodes, rates (6 n,): places and velocities, and their rates. rests [m], masses [kg], stiffness [N], damping [N s], tensions
    [N]: one a segment, of which the first joins A and the first node and is known: behind [N] is what it does there. Returns
    what the last of these segments, n - 1, pulls [N].
    """
    r, v = three(nodes, 0), three(nodes, 3)
    for j in range(tensions.size - 1):
        next_r, next_v = three(nodes, 6 * j + 6), three(nodes, 6 * j + 9)
        chord, chord_rate = sub(next_r, r), sub(next_v, v)
        tension, per_metre = tighten(chord, chord_rate, rests[j + 1], 0.0, stiffness[j + 1], damping[j + 1])
        tensions[j + 1] = tension
        ahead = scale(per_metre, chord)
        store(rates, 6 * j, v)
        store(rates, 6 * j + 3, node_rate(ahead, behind, 0.5 * (masses[j] + masses[j + 1]), r, gm))
        behind, r, v = ahead, next_r, next_v
    return behind
