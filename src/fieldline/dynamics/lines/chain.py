"""A line of nodes between two bodies: rates of its nodes and its feed, and what it does to the bodies at its ends.

Segment j of line k joins the points j and j + 1 (A's attachment, the nodes, B's attachment) and pulls them together,

    T_j = max(0, E A (l - l0) / l0 + c d(strain)/dt) where l > l0, else 0                                  (1)
    m_j dv_j/dt = T_j e_j - T_(j-1) e_(j-1) + m_j g(r_j) + F_j,    m_j = (mu l0)_(j-1)/2 + (mu l0)_j/2     (2)

e_j from point j to j + 1, l0 the unstretched length, F_j half of the loads on either segment (air, current) and the
user's. Bending stiffness is neglected: a line of 2 mm at 20 km bends over millimetres. The half segments at the ends are
point masses fixed in the bodies there; `EndMass` of a body gathers them,

    M a + alpha x S = F - omega x (omega x S),    (I + J) alpha + S x a = N - omega x ((I + J) omega)        (3)
    S = sum m p,    J = sum m (p^2 E - p p^T),    M = m_body + sum m + what the reel holds

with F, N of everything, the weight of the end masses included. The reel's equations are in `fieldline.dynamics.lines.feed`.

Source: the discretisation is that of SKYHOOK (Kalaghan et al. 1978; Smithsonian Astrophysical Observatory 1982, s. 3.2).
"""

from __future__ import annotations

from math import sqrt

from fieldline.compiled import inner
from fieldline.dynamics.layout import NOTHING, attitude_at, feeds_at, nodes_at, store, temperatures_at, three
from fieldline.dynamics.lines.feed import feed_acceleration, feed_loads, passage_push
from fieldline.dynamics.lines.heat import warming
from fieldline.dynamics.lines.segment_loads import segment_load
from fieldline.dynamics.lines.segments import node_rate, pull_inside, tighten
from fieldline.dynamics.load_log import LINES, impose
from fieldline.dynamics.loads.joint import joint_torque
from fieldline.dynamics.parameters import NO_REEL, TANGENT
from fieldline.environment.gravity import gravity_kernel
from fieldline.frames.attitude import to_body, to_inertial
from fieldline.frames.matrices import matvec, transpose
from fieldline.frames.vectors import add, axpy, cross, dot, scale, sub, vec

END_MASS = 10  # numbers of an end mass of equation (3): sum m, S (3), J (xx, yy, zz, xy, xz, yz)


@inner
def weight_beside_point(r_i, dcm_ei, gravity):
    """What an Earth of a table of harmonics pulls [m/s^2], or J2 beside the point's, inertial axes.

    J2 is equation (2) of `fieldline.environment.gravity` about the pole p: -(G M/r^3) f ((1 - 5 (r.p)^2/r^2) r + 2 (r.p) p).
    """
    if gravity.table.shape[0] > 0:
        return matvec(transpose(dcm_ei), gravity_kernel(matvec(dcm_ei, r_i), gravity))
    square, pole = dot(r_i, r_i), (dcm_ei[6], dcm_ei[7], dcm_ei[8])
    flat, up = 1.5 * gravity.j2 * gravity.radius_m * gravity.radius_m / square, dot(r_i, pole)
    across = scale(1.0 - 5.0 * up * up / square, r_i)
    return scale(-gravity.gm * flat / (square * sqrt(square)), axpy(2.0 * up, pole, across))


@inner
def weight_per_mass(r_i, dcm_ei, surroundings):
    """The Earth's pull [m/s^2], inertial axes."""
    gravity = surroundings.gravity
    if gravity.table.shape[0] > 0:
        return weight_beside_point(r_i, dcm_ei, gravity)
    square = dot(r_i, r_i)
    point = scale(-gravity.gm / (square * sqrt(square)), r_i)
    return point if gravity.j2 == 0.0 else add(point, weight_beside_point(r_i, dcm_ei, gravity))


@inner
def slide(t, s, sliders, inputs):
    """Where slider s stands along its axis [m], and how fast it moves [m/s]: at its speed until it is there."""
    way = inputs.slide_to[s] - inputs.slide_from[s]
    gone = sliders.speed[s] * (t - inputs.slide_since[s])
    if gone >= abs(way):
        return inputs.slide_to[s], 0.0
    sign = 1.0 if way > 0.0 else -1.0
    return inputs.slide_from[s] + sign * gone, sign * sliders.speed[s]


@inner
def attachment(t, k, end, plant, inputs):
    """Attachment of line k at an end, 0 for A and 1 for B: place [m] and its rate [m/s] in the body, body axes."""
    point = three(plant.lines.point[k], 3 * end)
    rate = NOTHING
    for s in range(plant.sliders.line.shape[0]):
        if plant.sliders.line[s] == k and plant.sliders.end[s] == end:
            place, speed = slide(t, s, plant.sliders, inputs)
            point = axpy(place, vec(plant.sliders.axis, s), point)
            rate = axpy(speed, vec(plant.sliders.axis, s), rate)
    return point, rate


@inner
def line_end(z, start, b, bodies, point_b, point_rate_b):
    """Attachment point on body b: its place and velocity, inertial axes, and the body's attitude; a point is its own."""
    base = TANGENT * b
    if bodies.rigid[b] == 0:
        return three(z, base), three(z, base + 3), (start[b, 0], start[b, 1], start[b, 2], start[b, 3])
    q = attitude_at(z, start, b)
    swing_b = add(point_rate_b, cross(three(z, base + 9), point_b))
    place = add(three(z, base), to_inertial(q, point_b))
    return place, add(three(z, base + 3), to_inertial(q, swing_b)), q


@inner
def gather(b, mass, point_b, end_mass):
    """Add a point mass [kg] at a place in body b [m] to its end masses; equation (3)."""
    x, y, z = point_b
    end_mass[b, 0] += mass
    end_mass[b, 1] += mass * x
    end_mass[b, 2] += mass * y
    end_mass[b, 3] += mass * z
    end_mass[b, 4] += mass * (y * y + z * z)
    end_mass[b, 5] += mass * (x * x + z * z)
    end_mass[b, 6] += mass * (x * x + y * y)
    end_mass[b, 7] -= mass * x * y
    end_mass[b, 8] -= mass * x * z
    end_mass[b, 9] -= mass * y * z


@inner
def unstretched(j, k, z, feed, warm, lines):
    """l0 [m] of segment j of line k, and its rate [m/s]: as warm as it is, and fed where it is the last one."""
    if j == lines.nodes[k]:
        rest, rate = z[feed], z[feed + 1]
    else:
        rest, rate = lines.rest[lines.first[k] + k + j], 0.0
    if warm >= 0:
        grown = 1.0 + lines.expansion[k] * (z[warm + j] - lines.reference[k])
        return rest * grown, rate * grown
    return rest, rate


@inner
def load_end(b, mass, point_b, slide_b, pull_i, weight_i, q, omega_b, log, outer, end_mass):
    """An end's pull [N] and its half segment [kg] on body b; one that slides at a rate [m/s] has its Coriolis force."""
    force_i = axpy(mass, weight_i, pull_i)
    if slide_b != NOTHING:
        force_i = add(force_i, to_inertial(q, scale(-2.0 * mass, cross(omega_b, slide_b))))
    impose(log, LINES, b, force_i, cross(point_b, to_body(q, force_i)), outer)
    if mass > 0.0:
        gather(b, mass, point_b, end_mass)


@inner
def damp_joint(b, beta, point_b, q, omega_b, chord_i, chord_rate_i, log, outer):
    """Angular damping where a taut line is attached."""
    torque_i = joint_torque(to_inertial(q, point_b), to_inertial(q, omega_b), chord_i, chord_rate_i, beta)
    impose(log, LINES, b, NOTHING, to_body(q, torque_i), outer)


@inner
def carry_to_attachment(b, gone, moving, point_b, place, speed, q, z, dcm_ei, surroundings, log, outer):
    """Loads on a reel's body b for the line that has left its middle [kg], and for what moves to the attachment (mu u, mu u')."""
    r, v = three(z, TANGENT * b), three(z, TANGENT * b + 3)
    impose(log, LINES, b, scale(-gone, weight_per_mass(r, dcm_ei, surroundings)), NOTHING, outer)
    push = passage_push(sub(place, r), sub(speed, v), moving)
    impose(log, LINES, b, push, cross(scale(0.5, point_b), to_body(q, push)), outer)


@inner
def measure(k, z, row, plant, shared):
    """Unstretched length [m] and mass [kg] of each segment of line k, as it is fed and as warm as it is, into `shared`.

    Returns the rate of the last one's length [m/s].
    """
    lines, nodes, feed = plant.lines, plant.lines.nodes[k], feeds_at(plant) + 2 * k
    rests, masses = shared.rest[row : row + nodes + 1], shared.mass[row : row + nodes + 1]
    cold, linear_mass = lines.rest[row : row + nodes + 1], lines.linear_mass[row : row + nodes + 1]
    for j in range(nodes):
        rests[j] = cold[j]
        masses[j] = linear_mass[j] * cold[j]
    rests[nodes], rate = z[feed], z[feed + 1]
    masses[nodes] = linear_mass[nodes] * z[feed]
    if lines.warm[k + 1] > lines.warm[k]:
        warm = temperatures_at(plant) + lines.warm[k]
        for j in range(nodes + 1):
            rests[j] *= 1.0 + lines.expansion[k] * (z[warm + j] - lines.reference[k])
        rate *= 1.0 + lines.expansion[k] * (z[warm + nodes] - lines.reference[k])
    return rate


@inner
def pull_nodes(k, z, ends, row, base, plant, shared, out):
    """Rates of the nodes of line k into `out`, tensions, lengths and masses of all its segments into `shared`.

    ends: places and velocities of A's and B's attachments; row, base: where its segments start in `lines`, its nodes in z.
    Returns the force on A's end and on B's [N], without weight. Nodes have the pull of a point Earth; `surround_nodes` adds
    what else there is.
    """
    lines, gravity, nodes = plant.lines, plant.surroundings.gravity, plant.lines.nodes[k]
    gm = gravity.gm if gravity.table.shape[0] == 0 else 0.0
    here, there = z[base : base + 6 * nodes], out[base : base + 6 * nodes]
    stiffness, damping = lines.stiffness[row : row + nodes + 1], lines.damping[row : row + nodes + 1]
    rests, masses = shared.rest[row : row + nodes + 1], shared.mass[row : row + nodes + 1]
    tensions = shared.tension[row : row + nodes + 1]
    rate_b = measure(k, z, row, plant, shared)
    place_a, speed_a, place_b, speed_b = ends
    if nodes == 0:
        chord = sub(place_b, place_a)
        tensions[0], per_metre = tighten(chord, sub(speed_b, speed_a), rests[0], rate_b, stiffness[0], damping[0])
        on_a = scale(per_metre, chord)
        return on_a, scale(-1.0, on_a)
    chord = sub(three(here, 0), place_a)
    tensions[0], per_metre = tighten(chord, sub(three(here, 3), speed_a), rests[0], 0.0, stiffness[0], damping[0])
    on_a = scale(per_metre, chord)
    behind = pull_inside(
        here, rests[:nodes], masses[:nodes], stiffness[:nodes], damping[:nodes], gm, on_a, tensions[:nodes], there
    )
    last = 6 * nodes - 6
    r, v = three(here, last), three(here, last + 3)
    chord = sub(place_b, r)
    tensions[nodes], per_metre = tighten(chord, sub(speed_b, v), rests[nodes], rate_b, stiffness[nodes], damping[nodes])
    ahead = scale(per_metre, chord)
    store(there, last, v)
    store(there, last + 3, node_rate(ahead, behind, 0.5 * (masses[nodes - 1] + masses[nodes]), r, gm))
    return on_a, scale(-1.0, ahead)


@inner
def surround_nodes(t, k, z, ends, row, base, dcm_ei, plant, shared, out):
    """Add to the rates of the nodes of line k what `pull_nodes` leaves out: an Earth that is no point, air, current.

    Returns the forces of air and current on A's end and on B's [N], inertial axes.
    """
    lines, gravity, ambient = plant.lines, plant.surroundings.gravity, shared.ambient
    nodes = lines.nodes[k]
    if gravity.table.shape[0] > 0 or gravity.j2 != 0.0:
        for j in range(nodes):
            at = base + 6 * j
            store(out, at + 3, add(three(out, at + 3), weight_beside_point(three(z, at), dcm_ei, gravity)))
    if lines.exposed[k] == 0:
        return NOTHING, NOTHING
    p0, v0, place_b, speed_b = ends
    masses = shared.mass[row : row + nodes + 1]
    on_a, behind = NOTHING, NOTHING
    for j in range(nodes + 1):
        at = base + 6 * j
        p1, v1 = (three(z, at), three(z, at + 3)) if j < nodes else (place_b, speed_b)
        push = scale(0.5, segment_load(t, k, row + j, p0, v0, p1, v1, dcm_ei, lines, ambient))
        if j == 0:
            on_a = push
        else:
            store(out, at - 3, axpy(2.0 / (masses[j - 1] + masses[j]), add(behind, push), three(out, at - 3)))
        behind = push
        p0, v0 = p1, v1
    return on_a, behind


@inner
def line_rates(t, k, z, start, dcm_ei, plant, inputs, shared, log, out):
    """Rates of line k into `out`, its loads on the bodies into shared.outer and shared.end_mass."""
    lines, surroundings, outer = plant.lines, plant.surroundings, shared.outer
    a, b = lines.body[k, 0], lines.body[k, 1]
    point_a, slide_a = attachment(t, k, 0, plant, inputs)
    point_b, slide_b = attachment(t, k, 1, plant, inputs)
    place_a, speed_a, q_a = line_end(z, start, a, plant.bodies, point_a, slide_a)
    place_b, speed_b, q_b = line_end(z, start, b, plant.bodies, point_b, slide_b)
    nodes, row = lines.nodes[k], lines.first[k] + k
    base, feed = nodes_at(plant) + 6 * lines.first[k], feeds_at(plant) + 2 * k
    ends = (place_a, speed_a, place_b, speed_b)
    end_a, end_b = pull_nodes(k, z, ends, row, base, plant, shared, out)
    half_a, half_b = 0.5 * shared.mass[row], 0.5 * shared.mass[row + nodes]
    on_a, on_b = surround_nodes(t, k, z, ends, row, base, dcm_ei, plant, shared, out)
    end_a, end_b = add(end_a, on_a), add(end_b, on_b)
    if nodes == 0:
        first, first_rate, last, last_rate = place_b, speed_b, place_a, speed_a
    else:
        first, first_rate = three(z, base), three(z, base + 3)
        last, last_rate = three(z, base + 6 * nodes - 6), three(z, base + 6 * nodes - 3)
    back, back_rate = sub(last, place_b), sub(last_rate, speed_b)
    if lines.joint[k, 0] > 0.0 and shared.tension[row] > 0.0:
        chord, chord_rate = sub(first, place_a), sub(first_rate, speed_a)
        damp_joint(a, lines.joint[k, 0], point_a, q_a, three(z, TANGENT * a + 9), chord, chord_rate, log, outer)
    if lines.joint[k, 1] > 0.0 and shared.tension[row + nodes] > 0.0:
        damp_joint(b, lines.joint[k, 1], point_b, q_b, three(z, TANGENT * b + 9), back, back_rate, log, outer)
    out[feed] = 0.0
    out[feed + 1] = 0.0
    if lines.reel[k] != NO_REEL:
        out[feed] = z[feed + 1]
        tension = shared.tension[row + nodes]
        out[feed + 1] = feed_acceleration(lines.reel[k], inputs.reel[k], z[feed + 1], tension, lines.reel_lag[k])
        linear_mass = lines.linear_mass[row + nodes]
        on_node, on_reel = feed_loads(back, back_rate, z[feed], z[feed + 1], out[feed + 1], linear_mass)
        end_b = add(end_b, on_reel)
        if nodes == 0:
            end_a = add(end_a, on_node)
        else:
            at = base + 6 * nodes - 3
            store(out, at, axpy(2.0 / (shared.mass[row + nodes - 1] + shared.mass[row + nodes]), on_node, three(out, at)))
        gone = -lines.stored[k]
        for j in range(nodes + 1):
            gone += shared.mass[row + j]
        moving = linear_mass * z[feed + 1], linear_mass * out[feed + 1]
        carry_to_attachment(b, gone, moving, point_b, place_b, speed_b, q_b, z, dcm_ei, surroundings, log, outer)
        shared.end_mass[b, 0] -= gone
    weight_a = weight_per_mass(place_a, dcm_ei, surroundings) if half_a > 0.0 else NOTHING
    weight_b = weight_per_mass(place_b, dcm_ei, surroundings) if half_b > 0.0 else NOTHING
    load_end(a, half_a, point_a, slide_a, end_a, weight_a, q_a, three(z, TANGENT * a + 9), log, outer, shared.end_mass)
    load_end(b, half_b, point_b, slide_b, end_b, weight_b, q_b, three(z, TANGENT * b + 9), log, outer, shared.end_mass)


@inner
def warm_line(k, z, plant, ambient, out):
    """Rates of the temperatures of line k into `out`; what is on a reel stays as it is."""
    lines, at = plant.lines, temperatures_at(plant) + plant.lines.warm[k]
    for j in range(lines.warm[k + 1] - lines.warm[k]):
        out[at + j] = 0.0
        if j <= lines.nodes[k]:
            s = lines.first[k] + k + j
            out[at + j] = warming(z[at + j], ambient.heating[s], lines.diameter[s], lines.emissivity[k], lines.capacity[s])


@inner
def lines_rates(t, z, start, dcm_ei, plant, inputs, shared, log, out):
    """All lines: rates of nodes and feeds into `out`, loads on the bodies into shared.outer and shared.end_mass."""
    shared.end_mass[:, :] = 0.0
    for k in range(plant.lines.nodes.shape[0]):
        line_rates(t, k, z, start, dcm_ei, plant, inputs, shared, log, out)
        if plant.lines.warm[k + 1] > plant.lines.warm[k]:
            warm_line(k, z, plant, shared.ambient, out)
