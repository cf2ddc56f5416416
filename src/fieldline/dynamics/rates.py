"""The plant's right-hand side: dz/dt of everything that flies, from every load at once.

    dr/dt = v,      m dv/dt = m g(r) + F_drag + F_sun + F_thrust + F_line + F_user                           (1)
    dsigma/dt = omega + 1/2 sigma x omega + c(|sigma|) sigma x (sigma x omega)                               (2)
    I domega/dt = N - omega x (I omega + sum a h) - sum a u,      dh/dt = u                                  (3)

(2): the rotation vector sigma since the step's start, q_bi = q0 exp(sigma / 2); c = 1/12 near zero and
(1 - (|sigma|/2) cot(|sigma|/2)) / |sigma|^2 exactly. (3): h is the whole axial momentum of a wheel, its share of the
body's turn included, so that I lacks the wheels' spin inertia and I omega + sum a h is what is conserved; u is the
motor's torque on the wheel. That a full wheel takes no more is the loop's affair: its motor rests from then on.

The loads' equations are in `fieldline.dynamics.loads`, gravity and field in `fieldline.environment`.
Sources: Munthe-Kaas (1998), BIT 38:92 for (2); Markley and Crassidis (2014), s. 3.3 for (3).
"""

from __future__ import annotations

from math import sqrt, tan

from fieldline.compiled import counting, inner, kernel, merged
from fieldline.dynamics.layout import NOTHING, attitude_at, feeds_at, nodes_at, store, three
from fieldline.dynamics.lines.chain import lines_rates, weight_per_mass
from fieldline.dynamics.lines.end_mass import burdened_rates
from fieldline.dynamics.load_log import (
    CONDUCTORS,
    DIPOLES,
    DISTURBANCE,
    DRAG,
    EDDY,
    GRADIENT,
    GRAVITY,
    HYSTERESIS,
    LINES,
    SOLAR,
    THRUSTERS,
    TORQUERS,
    USER,
    WHEELS,
    impose,
    note,
)
from fieldline.dynamics.loads.hysteresis import MU0, induction_rate
from fieldline.dynamics.loads.magnetic import commanded_dipole, dipole_torque, eddy_torque, row9
from fieldline.dynamics.loads.surface import drag_force, solar_force
from fieldline.dynamics.parameters import PLAIN_LOAD, TANGENT
from fieldline.environment.atmosphere import density_kernel
from fieldline.environment.ephemeris import dcm_ei_kernel, sun_kernel
from fieldline.environment.field import field_kernel
from fieldline.frames.attitude import to_body, to_inertial
from fieldline.frames.matrices import matvec, transpose
from fieldline.frames.vectors import add, axpy, cross, dot, put, scale, sub, vec
from fieldline.mechanics.rigid_body import euler_rate, gravity_gradient_torque

FINITE = 1e300  # what is not below this is infinite or not a number
RAISED, WRONG_SHAPE, NOT_FINITE = 1, 2, 3  # what a user's load may do
LAW_AT_WORK, LOAD_AT_WORK, EVENT_AT_WORK = 1, 2, 3  # whose compiled function is running, should it raise
FIELD_STEP_S = 1.0  # over which the field's change along the orbit is taken, for the rods


@inner
def turn_rate(sigma, omega):
    """dsigma/dt of equation (2)."""
    square = dot(sigma, sigma)
    if square < 1e-4:
        c = 1.0 / 12.0 + square / 720.0 + square * square / 30240.0
    else:
        half = 0.5 * sqrt(square)
        c = (1.0 - half / tan(half)) / square
    bend = cross(sigma, omega)
    return axpy(1.0, omega, axpy(0.5, bend, scale(c, cross(sigma, bend))))


@kernel
def field_at(position_i, dcm_ei, surroundings):
    """The Earth's field [T], inertial axes."""
    field_e = field_kernel(matvec(dcm_ei, position_i), surroundings.field)
    return add(matvec(transpose(dcm_ei), field_e), three(surroundings.uniform_field_i, 0))


@inner
def freeze_fields(t, dt, y, plant, out):
    """Field of every body [T], inertial axes, in the middle of a step that starts at t: for the cheap option.

    The place is that of free fall, r + v dt/2 + g dt^2/8. What the option leaves out is the field's change within half a
    step either way, whose mean is zero: 1e-3 rad/s of turn times dt/4 on average.
    """
    middle = t + 0.5 * dt
    dcm_ei = dcm_ei_kernel(middle, plant.surroundings.ephemeris)
    for b in range(plant.bodies.mass.shape[0]):
        r, v = three(y, 13 * b), three(y, 13 * b + 3)
        pull = scale(-plant.surroundings.gravity.gm / dot(r, r) ** 1.5, r)
        place = axpy(0.5 * dt, v, axpy(0.125 * dt * dt, pull, r))
        put(out, b, field_at(place, dcm_ei, plant.surroundings))


@inner
def wheel_momentum(b, z, plant):
    """Momentum of body b's wheels [N m s], body axes."""
    wheels = plant.wheels
    base = TANGENT * plant.bodies.mass.shape[0]
    total = NOTHING
    for k in range(wheels.body.shape[0]):
        if wheels.body[k] == b:
            total = axpy(z[base + k], vec(wheels.axis, k), total)
    return total


@inner
def wheel_reaction(b, plant, inputs, out):
    """Torque of body b's wheels on it [N m], the motors' part of (3); their momentum's rate goes to `out`."""
    wheels = plant.wheels
    base = TANGENT * plant.bodies.mass.shape[0]
    reaction = NOTHING
    for k in range(wheels.body.shape[0]):
        if wheels.body[k] == b:
            torque = inputs.wheel_torque[k]
            out[base + k] = torque
            reaction = axpy(-torque, vec(wheels.axis, k), reaction)
    return reaction


@inner
def rods_torque(t, b, z, q, field_b, dcm_ei, plant, out):
    """Torque of body b's hysteresis rods [N m], body axes; the rates of their inductions go to `out`."""
    rods, surroundings = plant.rods, plant.surroundings
    r, v, omega = three(z, TANGENT * b), three(z, TANGENT * b + 3), three(z, TANGENT * b + 9)
    later = dcm_ei_kernel(t + FIELD_STEP_S, surroundings.ephemeris)
    ahead = field_at(axpy(FIELD_STEP_S, v, r), later, surroundings)
    change = scale(1.0 / FIELD_STEP_S, sub(ahead, field_at(r, dcm_ei, surroundings)))
    change_b = sub(to_body(q, change), cross(omega, field_b))
    base = TANGENT * plant.bodies.mass.shape[0] + plant.wheels.body.shape[0]
    dipole = NOTHING
    for k in range(rods.body.shape[0]):
        if rods.body[k] != b:
            continue
        axis = vec(rods.axis, k)
        field, rate = dot(axis, field_b) / MU0, dot(axis, change_b) / MU0
        induction = z[base + k]
        out[base + k] = induction_rate(field, rate, induction, rods.saturation[k], rods.remanence[k], rods.coercivity[k])
        dipole = axpy(rods.volume[k] * induction / MU0, axis, dipole)
    return cross(dipole, field_b)


@inner
def thruster_load(b, plant, inputs):
    """Force and torque of body b's thrusters [N, N m], body axes."""
    thrusters = plant.thrusters
    force, torque = NOTHING, NOTHING
    for k in range(thrusters.body.shape[0]):
        if thrusters.body[k] == b:
            push = scale(inputs.thrust[k], vec(thrusters.force, k))
            force = add(force, push)
            torque = add(torque, cross(vec(thrusters.point, k), push))
    return force, torque


@counting
def ask(loads, slot, t, state, parameters, reply):
    """A compiled function's answer into `reply`; how many numbers it gave. Counts references: the answer is a new array."""
    answer = loads[slot](t, state, parameters)
    for j in range(min(answer.shape[0], reply.shape[0])):
        reply[j] = answer[j]
    return answer.shape[0]


@inner
def asked(k, t, plant, loads, call, shared):
    """The answer of user load k for shared.state into shared.reply: 0, or what it did wrong."""
    user = plant.user
    slot = user.slot[k]
    shared.culprit[0] = k
    if slot >= PLAIN_LOAD:
        if call(slot, t) != 0:
            return RAISED
    else:
        parameters = user.parameters[user.first[k] : user.first[k + 1]]
        shared.culprit[2] = LOAD_AT_WORK
        shared.replies[0] = ask(loads, slot, t, shared.state, parameters, shared.reply)
        shared.culprit[2] = 0
    if shared.replies[0] != 6:
        return WRONG_SHAPE
    for j in range(6):
        if not abs(shared.reply[j]) < FINITE:
            return NOT_FINITE
    return 0


@inner
def node_loads(k, line, t, z, plant, loads, call, shared, out):
    """Add user load k to every node of a line: 0, or what it did wrong.

    It is given r_i, v_i, then the unstretched length from A to the node [m], its mass [kg], and zeros.
    """
    lines = plant.lines
    row, feed = lines.first[line] + line, feeds_at(plant) + 2 * line
    along = 0.0
    for j in range(lines.nodes[line]):
        at = nodes_at(plant) + 6 * (lines.first[line] + j)
        after = z[feed] if j + 1 == lines.nodes[line] else lines.rest[row + j + 1]
        along += lines.rest[row + j]
        mass = 0.5 * (lines.linear_mass[row + j] * lines.rest[row + j] + lines.linear_mass[row + j + 1] * after)
        shared.state[:] = 0.0
        for i in range(6):
            shared.state[i] = z[at + i]
        shared.state[6] = along
        shared.state[7] = mass
        status = asked(k, t, plant, loads, call, shared)
        if status != 0:
            return status
        for i in range(3):
            out[at + 3 + i] += shared.reply[i] / mass
    return 0


@inner
def user_loads(t, z, start, plant, loads, call, shared, log, out):
    """Add the user's loads to shared.outer, those on nodes to the rates `out`; 0, or what one of them did wrong."""
    user = plant.user
    bodies = plant.bodies.mass.shape[0]
    for k in range(user.body.shape[0]):
        b = user.body[k]
        if b >= bodies:
            status = node_loads(k, b - bodies, t, z, plant, loads, call, shared, out)
            if status != 0:
                return status
            continue
        q = attitude_at(z, start, b)
        for j in range(6):
            shared.state[j] = z[TANGENT * b + j]
        for j in range(4):
            shared.state[6 + j] = q[j]
        for j in range(3):
            shared.state[10 + j] = z[TANGENT * b + 9 + j]
        status = asked(k, t, plant, loads, call, shared)
        if status != 0:
            return status
        impose(log, USER, b, three(shared.reply, 0), three(shared.reply, 3), shared.outer)
    return 0


@inner
def conductor_load(b, field_b, plant, inputs):
    """Force and torque of body b's conductors [N, N m], body axes: I wire x B, at each one's middle."""
    conductors = plant.conductors
    force, torque = NOTHING, NOTHING
    for k in range(conductors.body.shape[0]):
        if conductors.body[k] == b:
            push = scale(inputs.current[k], cross(vec(conductors.wire, k), field_b))
            force = add(force, push)
            torque = add(torque, cross(vec(conductors.point, k), push))
    return force, torque


@merged
def magnetic_torque(t, b, z, q, field_b, dcm_ei, plant, inputs, log, out):
    """Torque of the field on body b [N m], body axes."""
    bodies = plant.bodies
    omega = three(z, TANGENT * b + 9)
    drive = cross(commanded_dipole(t, b, plant.torquers, inputs), field_b)
    note(log, TORQUERS, b, NOTHING, drive)
    still = dipole_torque(field_b, b, bodies)
    note(log, DIPOLES, b, NOTHING, still)
    eddy = eddy_torque(field_b, omega, row9(bodies.eddy, b))
    note(log, EDDY, b, NOTHING, eddy)
    torque = add(drive, add(still, eddy))
    if plant.rods.body.shape[0] > 0:
        rods = rods_torque(t, b, z, q, field_b, dcm_ei, plant, out)
        note(log, HYSTERESIS, b, NOTHING, rods)
        torque = add(torque, rods)
    return torque


@inner
def surface_loads(t, b, z, q, dcm_ei, plant, log):
    """Force_i [N] and torque_b [N m] of air and light on body b."""
    bodies, surroundings = plant.bodies, plant.surroundings
    r, v = three(z, TANGENT * b), three(z, TANGENT * b + 3)
    sun_i = sun_kernel(t, surroundings.ephemeris)
    force, torque = NOTHING, NOTHING
    if bodies.drag[b] != 0.0:
        density = density_kernel(matvec(dcm_ei, r), matvec(dcm_ei, sun_i), t, surroundings.atmosphere)
        force = drag_force(r, v, (dcm_ei[6], dcm_ei[7], dcm_ei[8]), density, bodies.drag[b])
        torque = cross(vec(bodies.drag_point, b), to_body(q, force))
        note(log, DRAG, b, force, torque)
    if bodies.solar[b] != 0.0:
        push = solar_force(r, sun_i, bodies.solar[b])
        lever = cross(vec(bodies.solar_point, b), to_body(q, push))
        note(log, SOLAR, b, push, lever)
        force, torque = add(force, push), add(torque, lever)
    return force, torque


@inner
def turning_torque(b, z, torque, plant, inputs, log, out):
    """Torque on body b [N m], body axes, with what its wheels add: their motors and their momentum carried round."""
    if plant.wheels.body.shape[0] == 0:
        return torque
    motors = wheel_reaction(b, plant, inputs, out)
    note(log, WHEELS, b, NOTHING, motors)
    return sub(add(torque, motors), cross(three(z, TANGENT * b + 9), wheel_momentum(b, z, plant)))


@merged
def body_rates(t, b, z, start, dcm_ei, plant, inputs, frozen, shared, log, out):
    """Rates (1) to (3) of body b; shared.outer: loads that come from other bodies or the user."""
    surroundings, bodies = plant.surroundings, plant.bodies
    base = TANGENT * b
    r = three(z, base)
    q = attitude_at(z, start, b) if bodies.rigid[b] != 0 else (start[b, 0], start[b, 1], start[b, 2], start[b, 3])
    g = weight_per_mass(r, dcm_ei, surroundings)
    note(log, GRAVITY, b, scale(bodies.mass[b], g), NOTHING)
    force, torque = three(shared.outer[b], 0), three(shared.outer[b], 3)
    if bodies.drag[b] != 0.0 or bodies.solar[b] != 0.0:
        push, lever = surface_loads(t, b, z, q, dcm_ei, plant, log)
        force, torque = add(force, push), add(torque, lever)
    if plant.thrusters.body.shape[0] > 0:
        push_b, lever = thruster_load(b, plant, inputs)
        push = to_inertial(q, push_b)
        note(log, THRUSTERS, b, push, lever)
        force, torque = add(force, push), add(torque, lever)
    store(out, base, three(z, base + 3))
    if bodies.rigid[b] == 0:
        heavy = bodies.mass[b] + shared.end_mass[b, 0]
        store(out, base + 3, scale(1.0 / heavy, axpy(bodies.mass[b], g, force)))
        store(out, base + 6, NOTHING)
        store(out, base + 9, NOTHING)
        return
    if bodies.gravity_gradient[b] != 0.0:
        lever = gravity_gradient_torque(to_body(q, r), row9(bodies.inertia, b), surroundings.gravity.gm)
        note(log, GRADIENT, b, NOTHING, lever)
        torque = add(torque, lever)
    if plant.magnetic:
        field_b = to_body(q, vec(frozen, b) if frozen.shape[0] > 0 else field_at(r, dcm_ei, surroundings))
        torque = add(torque, magnetic_torque(t, b, z, q, field_b, dcm_ei, plant, inputs, log, out))
        if plant.conductors.body.shape[0] > 0:
            push_b, lever = conductor_load(b, field_b, plant, inputs)
            push = to_inertial(q, push_b)
            note(log, CONDUCTORS, b, push, lever)
            force, torque = add(force, push), add(torque, lever)
    steady = add(vec(bodies.torque_b, b), to_body(q, vec(bodies.torque_i, b)))
    note(log, DISTURBANCE, b, NOTHING, steady)
    torque = turning_torque(b, z, add(torque, steady), plant, inputs, log, out)
    inertia = row9(bodies.inertia, b)
    omega = three(z, base + 9)
    store(out, base + 6, turn_rate(three(z, base + 6), omega))
    if shared.end_mass[b, 0] != 0.0:
        total_b = to_body(q, axpy(bodies.mass[b], g, force))
        along_b, turn_b = burdened_rates(omega, bodies.mass[b], inertia, shared.end_mass[b], total_b, torque)
        store(out, base + 3, to_inertial(q, along_b))
        store(out, base + 9, turn_b)
    else:
        store(out, base + 3, axpy(1.0 / bodies.mass[b], force, g))
        store(out, base + 9, euler_rate(omega, inertia, row9(bodies.inertia_inv, b), torque))


@inner
def earth_at(t, ephemeris, shared):
    """dcm_ei at t; what it was at the last evaluation is kept, since two stages and two steps share their times."""
    if shared.earth_time[0] != t:
        shared.earth_time[0] = t
        dcm_ei = dcm_ei_kernel(t, ephemeris)
        for j in range(9):
            shared.earth[0, j] = dcm_ei[j]
    return row9(shared.earth, 0)


@inner
def plant_rates(t, z, start, plant, inputs, frozen, loads, call, shared, log, out):
    """Fill `out` with dz/dt at t; 0, or the number of what a user's load did wrong.

    start (bodies, 4): attitudes at the step's start. frozen: field [T] to use, (bodies, 3); (0, 3): what it is here.
    """
    dcm_ei = earth_at(t, plant.surroundings.ephemeris, shared)
    lined, used = plant.lines.nodes.shape[0] > 0, plant.user.body.shape[0] > 0
    if lined or used:
        shared.outer[:, :] = 0.0
        if log.shape[0] > 0:
            log[LINES] = 0.0
            log[USER] = 0.0
    if lined:
        lines_rates(t, z, start, dcm_ei, plant, inputs, shared, log, out)
    if used:
        status = user_loads(t, z, start, plant, loads, call, shared, log, out)
        if status != 0:
            return status
    for b in range(plant.bodies.mass.shape[0]):
        body_rates(t, b, z, start, dcm_ei, plant, inputs, frozen, shared, log, out)
    return 0
