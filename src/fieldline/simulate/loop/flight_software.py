"""Laws at their times: what is known on board goes in, commands or an attitude come out.

A compiled law is one of a few slots, called through its address; a plain Python law is called back by its number and
leaves its answer in `shared.reply`. Both see the same rows of `Boards`, as a `Measurement`.
"""

from __future__ import annotations

from math import nan

from fieldline.compiled import counting, inner, merged
from fieldline.dynamics.layout import three
from fieldline.dynamics.lines.readings import end_tension, length_out
from fieldline.dynamics.parameters import STATE
from fieldline.dynamics.rates import LAW_AT_WORK
from fieldline.environment.ephemeris import dcm_ei_kernel
from fieldline.environment.field import field_kernel
from fieldline.frames.matrices import matvec, transpose
from fieldline.sensing.measurement import ATTITUDE, ORBIT, RATE, Measurement
from fieldline.simulate.loop.commands import allocate, send
from fieldline.simulate.loop.records import DIPOLE, NEVER, Outcome

LAW_RAISED, LAW_SHAPE, LAW_NOT_FINITE = int(Outcome.LAW_RAISED), int(Outcome.LAW_SHAPE), int(Outcome.LAW_NOT_FINITE)
LAW_NOT_UNIT = int(Outcome.LAW_NOT_UNIT)
NEARLY_UNIT = 2e-3  # of the square of an attitude's quaternion
KNOWLEDGE = 7  # numbers of an estimator's answer
SILENT, ANSWERED = 1, 2  # an estimator's last call


@merged
def measurement_of(boards, b):
    """Row b as what a law sees: views, not copies."""
    sun = boards.sun_sensor[b]
    wheels = boards.wheel_momentum[b]
    tension, length, rate = boards.tension[b], boards.line_length[b], boards.line_rate[b]
    return Measurement(
        boards.field_b[b],
        boards.field_time_s[b],
        boards.rate_b[b],
        sun[: boards.faces[b]],
        boards.q_bi[b],
        boards.omega_bi_b[b],
        boards.position_i[b],
        boards.velocity_i[b],
        boards.field_i[b],
        wheels[: boards.wheels[b]],
        boards.dipole_b[b],
        boards.valid[b],
        tension[: boards.lines[b]],
        length[: boards.lines[b]],
        rate[: boards.lines[b]],
        boards.relative_position_i[b],
        boards.relative_velocity_i[b],
    )


@inner
def read_lines(t, b, run):
    """Tension at the body's end [N], unstretched length out [m] and its rate [m/s] of each line that is attached."""
    lines, boards, at = run.plant.lines, run.boards, 0
    for k in range(lines.nodes.shape[0]):
        for end in range(2):
            if lines.body[k, end] == b:
                length, rate = length_out(k, run.y, run.plant)
                boards.tension[b, at] = end_tension(t, k, end, run.y, run.plant, run.inputs)
                boards.line_length[b, at] = length
                boards.line_rate[b, at] = rate
                at += 1


@inner
def refresh(t, b, reference, run):
    """What is known at any time: commands in effect, orbit where no receiver reads it, wheels' speeds, reference field."""
    y, plant, sensors, boards, actuators = run.y, run.plant, run.sensors, run.boards, run.actuators
    boards.dipole_b[b] = 0.0
    for k in range(actuators.ends[DIPOLE]):
        if actuators.body[k] == b:
            for j in range(3):
                boards.dipole_b[b, j] += actuators.wanted[k] * plant.torquers.axis[k, j]
    if sensors.suite.navigations.present[b] == 0.0:
        for j in range(3):
            boards.position_i[b, j] = y[STATE * b + j]
            boards.velocity_i[b, j] = y[STATE * b + 3 + j]
            if b > 0:
                boards.relative_position_i[b, j] = y[STATE * b + j] - y[j]
                boards.relative_velocity_i[b, j] = y[STATE * b + 3 + j] - y[3 + j]
        boards.valid[b, ORBIT] = 1.0
    at = 0
    base = STATE * plant.bodies.mass.shape[0]
    for k in range(plant.wheels.body.shape[0]):
        if plant.wheels.body[k] == b:
            boards.wheel_momentum[b, at] = y[base + k]
            at += 1
    if plant.lines.nodes.shape[0] > 0:
        read_lines(t, b, run)
    if reference and boards.valid[b, ORBIT] != 0.0:
        dcm_ei = dcm_ei_kernel(t, plant.surroundings.ephemeris)
        place = (boards.position_i[b, 0], boards.position_i[b, 1], boards.position_i[b, 2])
        field_i = matvec(transpose(dcm_ei), field_kernel(matvec(dcm_ei, place), sensors.field))
        uniform = three(plant.surroundings.uniform_field_i, 0)
        for j in range(3):
            boards.field_i[b, j] = field_i[j] + uniform[j]


@inner
def believe(reply, b, boards):
    """Take an estimator's answer as what is known of attitude and rate."""
    for j in range(4):
        boards.q_bi[b, j] = reply[j]
    for j in range(3):
        boards.omega_bi_b[b, j] = reply[4 + j]
    boards.valid[b, ATTITUDE] = 1.0
    boards.valid[b, RATE] = 1.0


@inner
def withdraw(b, boards):
    """An estimator that had an answer has none any more."""
    boards.q_bi[b] = nan
    boards.omega_bi_b[b] = nan
    boards.valid[b, ATTITUDE] = 0.0
    boards.valid[b, RATE] = 0.0


@inner
def all_finite(values, count):
    """Are the first `count` numbers finite?"""
    for j in range(count):
        if not abs(values[j]) < 1e300:
            return False
    return True


@counting
def ask(laws, slot, t, measurement, memory, params, reply):
    """A compiled law's answer into `reply`; how many numbers it gave. Counts references: the answer is a new array."""
    answer = laws[slot](t, measurement, memory, params)
    for j in range(min(answer.shape[0], reply.shape[0])):
        reply[j] = answer[j]
    return answer.shape[0]


@inner
def run_task(t, i, run, laws, memories, parameters, call):
    """Run task i; 0 or the outcome that ends the run, with the culprit noted."""
    boards, tasks, shared = run.boards, run.tasks, run.shared
    b = tasks.body[i]
    refresh(t, b, tasks.reference[i] != 0, run)
    shared.culprit[0] = i
    tasks.runs[i] += 1
    slot = tasks.slot[i]
    if slot < 0:
        if call(i, t) != 0:
            return LAW_RAISED
        count = shared.replies[0]
    else:
        shared.culprit[2] = LAW_AT_WORK
        count = ask(laws, slot, t, measurement_of(boards, b), memories[slot], parameters[slot], shared.reply)
        shared.culprit[2] = 0
    reply = shared.reply
    shared.culprit[1] = count
    if tasks.estimator[i] != 0 and count == 0:
        if tasks.estimator[i] == ANSWERED:
            withdraw(b, boards)
        tasks.estimator[i] = SILENT
        return 0
    if count != tasks.replies[i]:
        return LAW_SHAPE
    if not all_finite(reply, count):
        return LAW_NOT_FINITE
    if tasks.estimator[i] != 0:
        square = reply[0] * reply[0] + reply[1] * reply[1] + reply[2] * reply[2] + reply[3] * reply[3]
        if abs(square - 1.0) > NEARLY_UNIT:
            return LAW_NOT_UNIT
        believe(reply, b, boards)
        tasks.estimator[i] = ANSWERED
        return 0
    commands = shared.commands
    for k in range(commands.shape[0]):
        commands[k] = NEVER
    allocate(reply, count, i, tasks, run.actuators, commands)
    send(t, i, tasks, commands)
    return 0
