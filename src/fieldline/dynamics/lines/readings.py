"""What a sensor at the end of a line would read: tension, length that is out, rate of the feed."""

from __future__ import annotations

from fieldline.compiled import inner
from fieldline.dynamics.layout import feeds_at, nodes_at, temperatures_at, three
from fieldline.dynamics.lines.chain import attachment
from fieldline.dynamics.loads.line import line_tension
from fieldline.dynamics.parameters import STATE
from fieldline.frames.attitude import to_inertial
from fieldline.frames.vectors import add, cross, dot, norm, sub


@inner
def length_out(k, y, plant):
    """Unstretched length of line k that is out [m], and its rate [m/s], at state y."""
    lines, bodies = plant.lines, plant.bodies.mass.shape[0]
    feed = feeds_at(plant) + bodies + 2 * k
    row = lines.first[k] + k
    length = y[feed]
    for j in range(lines.nodes[k]):
        length += lines.rest[row + j]
    return length, y[feed + 1]


@inner
def attachment_state(t, k, end, y, plant, inputs):
    """Place [m] and velocity [m/s] of an attachment of line k at state y, inertial axes."""
    b = STATE * plant.lines.body[k, end]
    q = (y[b + 6], y[b + 7], y[b + 8], y[b + 9])
    point, rate = attachment(t, k, end, plant, inputs)
    swing = add(rate, cross(three(y, b + 10), point))
    return add(three(y, b), to_inertial(q, point)), add(three(y, b + 3), to_inertial(q, swing))


@inner
def end_tension(t, k, end, y, plant, inputs):
    """Tension [N] of the segment at an end of line k, 0 for A and 1 for B, at state y."""
    lines, bodies = plant.lines, plant.bodies.mass.shape[0]
    nodes, row = lines.nodes[k], lines.first[k] + k
    base, feed = nodes_at(plant) + bodies + 6 * lines.first[k], feeds_at(plant) + bodies + 2 * k
    near, near_rate = attachment_state(t, k, end, y, plant, inputs)
    if nodes == 0:
        far, far_rate = attachment_state(t, k, 1 - end, y, plant, inputs)
    else:
        at = base + (0 if end == 0 else 6 * (nodes - 1))
        far, far_rate = three(y, at), three(y, at + 3)
    j = 0 if end == 0 else nodes
    rest, rest_rate = (y[feed], y[feed + 1]) if j == nodes else (lines.rest[row + j], 0.0)
    if lines.warm[k + 1] > lines.warm[k]:
        grown = 1.0 + lines.expansion[k] * (y[temperatures_at(plant) + bodies + lines.warm[k] + j] - lines.reference[k])
        rest, rest_rate = rest * grown, rest_rate * grown
    chord = sub(far, near)
    stretched = norm(chord)
    if stretched <= rest:
        return 0.0
    rate = dot(chord, sub(far_rate, near_rate)) / stretched - rest_rate * stretched / rest
    return line_tension(stretched, rate, rest, lines.stiffness[row + j], lines.damping[row + j])
