"""Between steps: nodes that appear beside a reel and vanish into it, and a reel that comes to its end.

The equations are (6) and (7) of `fieldline.dynamics.lines.feed`. What momentum a new piece cannot carry goes to its ends:
a node's velocity changes by it over the node's mass, a body is given an impulse J at its attachment p,

    M dv + d(omega) x S = J,    (I + J_ends) d(omega) + S x dv = p x J                                    (1)

as in `fieldline.dynamics.lines.end_mass`. A new segment is as warm as the one that it is cut from; two that become one
share their warmth by their lengths.
"""

from __future__ import annotations

from fieldline.compiled import inner
from fieldline.dynamics.layout import NOTHING, feeds_at, nodes_at, store, temperatures_at, three
from fieldline.dynamics.lines.chain import attachment, gather
from fieldline.dynamics.lines.end_mass import burdened_rates
from fieldline.dynamics.lines.feed import APPEAR, VANISH, insert_node, remove_node
from fieldline.dynamics.lines.readings import attachment_state, length_out
from fieldline.dynamics.loads.magnetic import row9
from fieldline.dynamics.parameters import NO_REEL, STATE
from fieldline.frames.attitude import to_body, to_inertial
from fieldline.frames.vectors import add, axpy, cross, sub
from fieldline.simulate.loop.records import Outcome

REEL_IN, REEL_OUT = int(Outcome.REEL_IN), int(Outcome.REEL_OUT)
HAIR = 1e-9  # of the line: how far past its end a reel may be for rounding


@inner
def kick(t, k, end, impulse_i, y, run):
    """Give the body at an end of line k an impulse [N s] at its attachment; equation (1)."""
    plant, shared = run.plant, run.shared
    b = plant.lines.body[k, end]
    at, bodies = STATE * b, plant.bodies
    if bodies.rigid[b] == 0:
        heavy = bodies.mass[b] + shared.end_mass[b, 0]
        store(y, at + 3, axpy(1.0 / heavy, impulse_i, three(y, at + 3)))
        return
    q = (y[at + 6], y[at + 7], y[at + 8], y[at + 9])
    point, _ = attachment(t, k, end, plant, run.inputs)
    push = to_body(q, impulse_i)
    along, turn = burdened_rates(NOTHING, bodies.mass[b], row9(bodies.inertia, b), shared.end_mass[b], push, cross(point, push))
    store(y, at + 3, add(three(y, at + 3), to_inertial(q, along)))
    store(y, at + 10, add(three(y, at + 10), turn))


@inner
def growth(k, j, y, plant):
    """By how much segment j of line k is longer for its warmth than at the reference temperature, as a factor."""
    lines = plant.lines
    if lines.warm[k + 1] == lines.warm[k]:
        return 1.0
    temperature = y[temperatures_at(plant) + plant.bodies.mass.shape[0] + lines.warm[k] + j]
    return 1.0 + lines.expansion[k] * (temperature - lines.reference[k])


@inner
def reweigh(t, k, end, change, out, run):
    """An end carries `change` [kg] more at its attachment; of a reel's body, `out` [kg] more has left the middle."""
    b = run.plant.lines.body[k, end]
    gather(b, change, attachment(t, k, end, run.plant, run.inputs)[0], run.shared.end_mass)
    run.shared.end_mass[b, 0] -= out


@inner
def appear(t, k, y, run):
    """A node at the end of line k."""
    plant, lines, bodies = run.plant, run.plant.lines, run.plant.bodies.mass.shape[0]
    nodes, row = lines.nodes[k], lines.first[k] + k
    at, feed = nodes_at(plant) + bodies + 6 * lines.first[k], feeds_at(plant) + bodies + 2 * k
    place, speed = attachment_state(t, k, 1, y, plant, run.inputs)
    if nodes == 0:
        far, far_rate = attachment_state(t, k, 0, y, plant, run.inputs)
    else:
        far, far_rate = three(y, at + 6 * nodes - 6), three(y, at + 6 * nodes - 3)
    grown, j = growth(k, nodes, y, plant), row + nodes
    stiffness = (lines.stiffness[j], lines.stiffness[j + 1])
    linear_mass = (lines.linear_mass[j] / grown, lines.linear_mass[j + 1] / grown)
    lengths = (grown * y[feed], grown * y[feed + 1], grown * lines.spacing[k])
    away, away_rate, rest, over = insert_node(
        sub(far, place), sub(far_rate, speed), lengths[0], lengths[1], lengths[2], stiffness, linear_mass
    )
    new = at + 6 * nodes
    store(y, new, add(place, away))
    store(y, new + 3, add(speed, away_rate))
    was, full = lines.linear_mass[j] * y[feed], lines.linear_mass[j] * lines.spacing[k]
    lines.nodes[k] = nodes + 1
    run.shared.ambient.stale[0] = 1
    y[feed] = rest / grown
    now = lines.linear_mass[j + 1] * y[feed]
    if nodes == 0:
        reweigh(t, k, 0, 0.5 * (full - was), 0.0, run)
    reweigh(t, k, 1, 0.5 * (now - was), full + now - was, run)
    if lines.warm[k + 1] > lines.warm[k]:
        warm = temperatures_at(plant) + bodies + lines.warm[k] + nodes
        y[warm + 1] = y[warm]
    kick(t, k, 1, over, y, run)


@inner
def vanish(t, k, y, run):
    """The node at the end of line k goes."""
    plant, lines, bodies = run.plant, run.plant.lines, run.plant.bodies.mass.shape[0]
    left, row = lines.nodes[k] - 1, lines.first[k] + k
    at, feed = nodes_at(plant) + bodies + 6 * lines.first[k], feeds_at(plant) + bodies + 2 * k
    place, speed = attachment_state(t, k, 1, y, plant, run.inputs)
    node, node_rate = three(y, at + 6 * left), three(y, at + 6 * left + 3)
    if left == 0:
        far, far_rate = attachment_state(t, k, 0, y, plant, run.inputs)
    else:
        far, far_rate = three(y, at + 6 * left - 6), three(y, at + 6 * left - 3)
    grown, j = (growth(k, left, y, plant), growth(k, left + 1, y, plant)), row + left
    stiffness = (lines.stiffness[j], lines.stiffness[j + 1])
    linear_mass = (lines.linear_mass[j] / grown[0], lines.linear_mass[j + 1] / grown[1])
    rest, on_node, on_reel = remove_node(
        sub(far, place), sub(far_rate, speed), sub(node, place), sub(node_rate, speed),
        grown[0] * lines.rest[j], grown[1] * y[feed], grown[1] * y[feed + 1], stiffness, linear_mass,
    )  # fmt: skip
    if lines.warm[k + 1] > lines.warm[k]:
        warm = temperatures_at(plant) + bodies + lines.warm[k] + left
        share = y[feed] / (lines.rest[j] + y[feed])
        y[warm] += share * (y[warm + 1] - y[warm])
    was, full = lines.linear_mass[j + 1] * y[feed], lines.linear_mass[j] * lines.rest[j]
    lines.nodes[k] = left
    run.shared.ambient.stale[0] = 1
    y[feed] = rest / growth(k, left, y, plant)
    now = lines.linear_mass[j] * y[feed]
    reweigh(t, k, 1, 0.5 * (now - was), now - full - was, run)
    if left == 0:
        reweigh(t, k, 0, 0.5 * (now - full), 0.0, run)
        kick(t, k, 0, on_node, y, run)
    else:
        mass = 0.5 * (lines.linear_mass[j - 1] * lines.rest[j - 1] + lines.linear_mass[j] * y[feed])
        store(y, at + 6 * left - 3, axpy(1.0 / mass, on_node, far_rate))
    kick(t, k, 1, on_reel, y, run)
    rest_node(nodes_at(plant) + 6 * (lines.first[k] + left), run)


@inner
def rest_node(at, run):
    """What the stepper keeps of a node that is no longer out, from z[at] on: its rates are not written any more."""
    for i in range(at, at + 6):
        run.y[i + run.plant.bodies.mass.shape[0]] = 0.0
        for s in range(run.work.k.shape[0]):
            run.work.k[s, i] = 0.0


@inner
def reel_lines(t, run):
    """Let nodes appear and vanish where the reels ask for it; 0, or REEL_IN or REEL_OUT at the end of one."""
    lines, y, culprit = run.plant.lines, run.y, run.shared.culprit
    for k in range(lines.nodes.shape[0]):
        if lines.reel[k] == NO_REEL:
            continue
        culprit[0] = k
        length, rate = length_out(k, y, run.plant)
        if rate < 0.0 and length < lines.span[k, 0] * (1.0 - HAIR):
            return REEL_IN
        if rate > 0.0 and length > lines.span[k, 1] * (1.0 + HAIR):
            return REEL_OUT
        feed = feeds_at(run.plant) + run.plant.bodies.mass.shape[0] + 2 * k
        room = lines.first[k + 1] - lines.first[k]
        while y[feed] > APPEAR * lines.spacing[k] and lines.nodes[k] < room:
            appear(t, k, y, run)
        while y[feed] < VANISH * lines.spacing[k] and lines.nodes[k] > 0:
            vanish(t, k, y, run)
    return 0
