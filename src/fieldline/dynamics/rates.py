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
from fieldline.dynamics.loads.hysteresis import MU0, induction_rate
from fieldline.dynamics.loads.line import line_pull
from fieldline.dynamics.loads.magnetic import commanded_dipole, dipole_torque, eddy_torque, row9
from fieldline.dynamics.loads.surface import drag_force, solar_force
from fieldline.dynamics.parameters import PLAIN_LOAD, TANGENT
from fieldline.environment.atmosphere import density_kernel
from fieldline.environment.ephemeris import dcm_ei_kernel, sun_kernel
from fieldline.environment.field import field_kernel
from fieldline.environment.gravity import gravity_kernel
from fieldline.frames.attitude import quat_exp, quat_mul, to_body, to_inertial
from fieldline.frames.matrices import matvec, transpose
from fieldline.frames.vectors import add, axpy, cross, dot, put, scale, sub, vec
from fieldline.mechanics.rigid_body import euler_rate, gravity_gradient_torque

# Rows of the log, one a load: force_i [N] and torque_b [N m] on every body.
LOADS = (
    "gravity",
    "gravity_gradient",
    "torquers",
    "dipoles",
    "eddy_currents",
    "hysteresis",
    "drag",
    "solar_pressure",
    "thrusters",
    "wheels",
    "lines",
    "disturbance",
    "user",
)
(GRAVITY, GRADIENT, TORQUERS, DIPOLES, EDDY, HYSTERESIS, DRAG, SOLAR, THRUSTERS, WHEELS, LINES, DISTURBANCE, USER) = range(13)
NOTHING = (0.0, 0.0, 0.0)
FINITE = 1e300  # what is not below this is infinite or not a number
RAISED, WRONG_SHAPE, NOT_FINITE = 1, 2, 3  # what a user's load may do
LAW_AT_WORK, LOAD_AT_WORK, EVENT_AT_WORK = 1, 2, 3  # whose compiled function is running, should it raise
FIELD_STEP_S = 1.0  # over which the field's change along the orbit is taken, for the rods


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


@inner
def line_end(z, start, b, point_b):
    """Attachment point of a line on body b: offset from its centre, place and velocity, inertial axes."""
    base = TANGENT * b
    q = attitude_at(z, start, b)
    offset_i = to_inertial(q, point_b)
    swing_i = to_inertial(q, cross(three(z, base + 9), point_b))
    return add(three(z, base), offset_i), add(three(z, base + 3), swing_i)


@inner
def line_loads(z, start, plant, log, out):
    """Add force_i [N] and torque_b [N m] of all lines on every body to `out` (bodies, 6)."""
    lines = plant.lines
    for k in range(lines.length.shape[0]):
        one, two = lines.body[k, 0], lines.body[k, 1]
        point1 = (lines.point[k, 0], lines.point[k, 1], lines.point[k, 2])
        point2 = (lines.point[k, 3], lines.point[k, 4], lines.point[k, 5])
        place1, rate1 = line_end(z, start, one, point1)
        place2, rate2 = line_end(z, start, two, point2)
        pull = line_pull(place1, rate1, place2, rate2, lines.length[k], lines.stiffness[k], lines.damping[k])
        torque1 = cross(point1, to_body(attitude_at(z, start, one), pull))
        torque2 = cross(to_body(attitude_at(z, start, two), pull), point2)
        impose(log, LINES, one, pull, torque1, out)
        impose(log, LINES, two, scale(-1.0, pull), torque2, out)


@inner
def impose(log, load, b, force_i, torque_b, out):
    """Add a load to those of body b, and to the log where one is kept."""
    for j in range(3):
        out[b, j] += force_i[j]
        out[b, 3 + j] += torque_b[j]
        if log.shape[0] > 0:
            log[load, b, j] += force_i[j]
            log[load, b, 3 + j] += torque_b[j]


@counting
def ask(loads, slot, t, state, parameters, reply):
    """A compiled function's answer into `reply`; how many numbers it gave. Counts references: the answer is a new array."""
    answer = loads[slot](t, state, parameters)
    for j in range(min(answer.shape[0], reply.shape[0])):
        reply[j] = answer[j]
    return answer.shape[0]


@inner
def user_loads(t, z, start, plant, loads, call, shared, log, out):
    """Add the user's loads to `out`; 0, or what one of them did wrong."""
    user = plant.user
    for k in range(user.body.shape[0]):
        b = user.body[k]
        q = attitude_at(z, start, b)
        for j in range(6):
            shared.state[j] = z[TANGENT * b + j]
        for j in range(4):
            shared.state[6 + j] = q[j]
        for j in range(3):
            shared.state[10 + j] = z[TANGENT * b + 9 + j]
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
        reply = shared.reply
        if shared.replies[0] != 6:
            return WRONG_SHAPE
        for j in range(6):
            if not abs(reply[j]) < FINITE:
                return NOT_FINITE
        impose(log, USER, b, three(reply, 0), three(reply, 3), out)
    return 0


@inner
def note(log, load, b, force_i, torque_b):
    """Keep a load's force and torque, where a log (loads, bodies, 6) is kept."""
    if log.shape[0] > 0:
        for j in range(3):
            log[load, b, j] = force_i[j]
            log[load, b, 3 + j] = torque_b[j]


@merged
def magnetic_torque(t, b, z, q, dcm_ei, plant, inputs, frozen, log, out):
    """Torque of the field on body b [N m], body axes."""
    bodies = plant.bodies
    r, omega = three(z, TANGENT * b), three(z, TANGENT * b + 9)
    field_b = to_body(q, vec(frozen, b) if frozen.shape[0] > 0 else field_at(r, dcm_ei, plant.surroundings))
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


@merged
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


@merged
def turning(b, z, torque, plant, inputs, log, out):
    """Euler's equation (3) of body b under a torque [N m], body axes, its wheels' part added: into `out`."""
    base = TANGENT * b
    sigma, omega = three(z, base + 6), three(z, base + 9)
    if plant.wheels.body.shape[0] > 0:
        motors = wheel_reaction(b, plant, inputs, out)
        note(log, WHEELS, b, NOTHING, motors)
        torque = sub(add(torque, motors), cross(omega, wheel_momentum(b, z, plant)))
    inertia, inverse = row9(plant.bodies.inertia, b), row9(plant.bodies.inertia_inv, b)
    store(out, base + 6, turn_rate(sigma, omega))
    store(out, base + 9, euler_rate(omega, inertia, inverse, torque))


@merged
def body_rates(t, b, z, start, dcm_ei, plant, inputs, frozen, outer, log, out):
    """Rates (1) to (3) of body b; outer (bodies, 6): loads that come from other bodies or the user."""
    surroundings, bodies = plant.surroundings, plant.bodies
    base = TANGENT * b
    r = three(z, base)
    q = attitude_at(z, start, b)
    if surroundings.rotating:
        g = matvec(transpose(dcm_ei), gravity_kernel(matvec(dcm_ei, r), surroundings.gravity))
    else:
        g = gravity_kernel(r, surroundings.gravity)
    note(log, GRAVITY, b, scale(bodies.mass[b], g), NOTHING)
    force, torque = three(outer[b], 0), three(outer[b], 3)
    if bodies.drag[b] != 0.0 or bodies.solar[b] != 0.0:
        push, lever = surface_loads(t, b, z, q, dcm_ei, plant, log)
        force, torque = add(force, push), add(torque, lever)
    if plant.thrusters.body.shape[0] > 0:
        push_b, lever = thruster_load(b, plant, inputs)
        push = to_inertial(q, push_b)
        note(log, THRUSTERS, b, push, lever)
        force, torque = add(force, push), add(torque, lever)
    store(out, base, three(z, base + 3))
    store(out, base + 3, axpy(1.0 / bodies.mass[b], force, g))
    if bodies.rigid[b] == 0:
        store(out, base + 6, NOTHING)
        store(out, base + 9, NOTHING)
        return
    if bodies.gravity_gradient[b] != 0.0:
        lever = gravity_gradient_torque(to_body(q, r), row9(bodies.inertia, b), surroundings.gravity.gm)
        note(log, GRADIENT, b, NOTHING, lever)
        torque = add(torque, lever)
    if plant.magnetic:
        torque = add(torque, magnetic_torque(t, b, z, q, dcm_ei, plant, inputs, frozen, log, out))
    steady = add(vec(bodies.torque_b, b), to_body(q, vec(bodies.torque_i, b)))
    note(log, DISTURBANCE, b, NOTHING, steady)
    turning(b, z, add(torque, steady), plant, inputs, log, out)


@inner
def plant_rates(t, z, start, plant, inputs, frozen, loads, call, shared, log, out):
    """Fill `out` with dz/dt at t; 0, or the number of what a user's load did wrong.

    start (bodies, 4): attitudes at the step's start. frozen: field [T] to use, (bodies, 3); (0, 3): what it is here.
    """
    dcm_ei = dcm_ei_kernel(t, plant.surroundings.ephemeris)
    outer = shared.outer
    lined, used = plant.lines.length.shape[0] > 0, plant.user.body.shape[0] > 0
    if lined or used:
        outer[:, :] = 0.0
        if log.shape[0] > 0:
            log[LINES] = 0.0
            log[USER] = 0.0
    if lined:
        line_loads(z, start, plant, log, outer)
    if used:
        status = user_loads(t, z, start, plant, loads, call, shared, log, outer)
        if status != 0:
            return status
    for b in range(plant.bodies.mass.shape[0]):
        body_rates(t, b, z, start, dcm_ei, plant, inputs, frozen, outer, log, out)
    return 0
