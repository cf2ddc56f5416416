"""The loop: sensors, laws, commands and outputs at their times, and the plant between them.

    while t < end:
        do what is due at t, in the order of the schedule's rows; let commands that are due take effect
        step the plant to the next time at which anything is due

RK4 divides the way to the next such time into equal steps of at most the given length; DOP853 and the implicit method
choose their steps by their error and interpolate outputs, which do not bind them. Where an event stops the run, the last
row is that moment. The loop returns after `budget` steps, and goes on where it was when it is called again.
"""

from __future__ import annotations

from math import ceil

from fieldline.compiled import inner, kernel
from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M
from fieldline.dynamics.implicit_step import allow_motion, attempt_implicit
from fieldline.dynamics.layout import nodes_at, three
from fieldline.dynamics.lines.ambient import refresh
from fieldline.dynamics.lines.chain import slide
from fieldline.dynamics.loads.magnetic import torquer_moment
from fieldline.dynamics.parameters import STATE
from fieldline.dynamics.rates import FINITE, NOT_FINITE, RAISED, field_at, plant_rates
from fieldline.dynamics.step import attempt, lift, settle
from fieldline.environment.eclipse import sunlit_kernel
from fieldline.environment.ephemeris import dcm_ei_kernel, sun_kernel
from fieldline.frames.vectors import dot, norm, put
from fieldline.integrate.rosenbrock import stage_error
from fieldline.integrate.steps import error_norm, error_scale, next_step
from fieldline.simulate.loop.commands import cease_fire, next_ceasing, next_command, next_filling, obey, switch_torquers
from fieldline.simulate.loop.flight_software import run_task
from fieldline.simulate.loop.records import (
    AMBIENT,
    CIRCUIT,
    CONDUCTOR,
    DIPOLE,
    OUTPUT,
    REEL,
    SAME_TIME_S,
    TASK,
    THRUST,
    TORQUE_OFF,
    TORQUE_ON,
    WHEEL,
    Outcome,
)
from fieldline.simulate.loop.reeling import reel_lines
from fieldline.simulate.loop.sampling import sample
from fieldline.simulate.loop.watching import GOES_ON, height_of, interpolant, quantity, watch, within

PAUSED, DONE, STOPPED = int(Outcome.PAUSED), int(Outcome.DONE), int(Outcome.STOPPED)
BROKEN, GROUND, COARSE, UNDERFLOW = int(Outcome.NOT_FINITE), int(Outcome.GROUND), int(Outcome.COARSE), int(Outcome.UNDERFLOW)
EVENT_FAILED = int(Outcome.EVENT_FAILED)
LOAD_RAISED, LOAD_SHAPE, LOAD_NOT_FINITE = int(Outcome.LOAD_RAISED), int(Outcome.LOAD_SHAPE), int(Outcome.LOAD_NOT_FINITE)
COARSEST_TURN = 1.0  # [rad] of a fixed step: beyond it the wobble of a body is no longer followed
SHORTEST = 1e-9  # [s] of an adaptive step
SAFE_SQUARE = (EARTH_EQUATORIAL_RADIUS_M + 100e3) ** 2  # [m^2] of a radius above any height at which a run ends


@inner
def load_outcome(status):
    """The outcome of what a user's load did wrong."""
    if status == RAISED:
        return LOAD_RAISED
    return LOAD_NOT_FINITE if status == NOT_FINITE else LOAD_SHAPE


@inner
def next_time(t, run):
    """When anything is due next that the plant must be stepped to [s]; outputs bind fixed steps only."""
    schedule, stepping, tasks, actuators = run.schedule, run.stepping, run.tasks, run.actuators
    soonest = min(min(stepping.end, next_filling(t, run)), min(next_command(tasks), next_ceasing(actuators)))
    for j in range(schedule.kind.shape[0]):
        if not (stepping.adaptive and schedule.kind[j] == OUTPUT):
            soonest = min(soonest, schedule.phase[j] + schedule.count[j] * schedule.period[j])
    return soonest


@inner
def write_actuators(t, row, run):
    """What every actuator does, into a row of the record."""
    plant, inputs, ends, target = run.plant, run.inputs, run.actuators.ends, run.actuators.target
    for k in range(row.shape[0]):
        one = target[k]
        if k < ends[DIPOLE]:
            row[k] = torquer_moment(t, one, plant.torquers, inputs)
        elif k < ends[WHEEL]:
            row[k] = inputs.wheel_torque[one]
        elif k < ends[THRUST]:
            row[k] = run.actuators.wanted[k]
        elif k < ends[CONDUCTOR]:
            row[k] = inputs.current[one]
        elif k < ends[CIRCUIT]:
            row[k] = inputs.circuit[one]
        elif k < ends[REEL]:
            row[k] = inputs.reel[one]
        else:
            row[k] = slide(t, one, plant.sliders, inputs)[0]


@inner
def write_lines(row, run):
    """What the lines' last evaluation found, into a row of the record."""
    record, shared = run.record, run.shared
    for k in range(record.nodes.shape[1]):
        record.nodes[row, k] = run.plant.lines.nodes[k]
        record.circuit[row, k, 0] = shared.ambient.emf[k]
        record.circuit[row, k, 1] = shared.ambient.power[k]
        for i in range(3):
            record.circuit[row, k, 2 + i] = shared.ambient.lorentz_i[k, i]
            record.circuit[row, k, 5 + i] = shared.ambient.drag_i[k, i]
    for s in range(record.tension.shape[1]):
        record.tension[row, s] = shared.tension[s]
        record.current[row, s] = shared.ambient.current[s]


@inner
def write_row(t, y, run, loads, call):
    """Keep the state and what goes with it."""
    plant, inputs, boards, record, clock = run.plant, run.inputs, run.boards, run.record, run.clock
    row = clock.rows[0]
    if row >= record.seconds.shape[0]:
        return
    clock.rows[0] = row + 1
    record.seconds[row] = t
    for j in range(y.shape[0]):
        record.state[row, j] = y[j]
    surroundings = plant.surroundings
    dcm_ei = dcm_ei_kernel(t, surroundings.ephemeris)
    sun_i = sun_kernel(t, surroundings.ephemeris)
    for b in range(plant.bodies.mass.shape[0]):
        r = three(y, STATE * b)
        put(record.field_i[row], b, field_at(r, dcm_ei, surroundings))
        record.sunlit[row, b] = sunlit_kernel(r, sun_i)
        for j in range(4):
            record.known[row, b, j] = boards.q_bi[b, j]
        for j in range(3):
            record.known[row, b, 4 + j] = boards.omega_bi_b[b, j]
    write_actuators(t, record.actuators[row], run)
    if record.loads.shape[0] > 0:
        lift(y, record.start, record.z)
        log = record.loads[row]
        plant_rates(t, record.z, record.start, plant, inputs, run.record.unfrozen, loads, call, run.shared, log, record.rate)
        write_lines(row, run)


@inner
def look_around(t, period, run):
    """Take anew what surrounds lines, for the middle of the time to come."""
    lift(run.y, run.record.start, run.record.z)
    refresh(t, 0.5 * period, run.record.z, run.record.start, run.plant, run.inputs, run.shared.ambient)


@inner
def do_due(t, run, laws, memories, parameters, loads, call, rng):
    """Everything that is due at t; 0 or the outcome that ends the run."""
    schedule = run.schedule
    for j in range(schedule.kind.shape[0]):
        if schedule.phase[j] + schedule.count[j] * schedule.period[j] > t + SAME_TIME_S:
            continue
        schedule.count[j] += 1
        kind, who = schedule.kind[j], schedule.who[j]
        if kind == TASK:
            outcome = run_task(t, who, run, laws, memories, parameters, call)
            if outcome != 0:
                return outcome
        elif kind == OUTPUT:
            if not run.stepping.adaptive or t == 0.0:
                cease_fire(t, run.inputs, run.actuators)
                obey(t, run)
                write_row(t, run.y, run, loads, call)
        elif kind == TORQUE_OFF or kind == TORQUE_ON:
            switch_torquers(t, who, kind == TORQUE_OFF, run)
        elif kind == AMBIENT:
            look_around(t, schedule.period[j], run)
        else:
            sample(t, j, kind, who, run, rng)
    cease_fire(t, run.inputs, run.actuators)
    obey(t, run)
    if run.shared.ambient.stale[0] != 0:
        look_around(t, 0.0, run)
    return 0


@inner
def fixed_length(t, due, run):
    """Length of the next fixed step [s], negative where it is too long for a body's rate."""
    y, plant, stepping = run.y, run.plant, run.stepping
    gap = due - t
    h = gap / max(1.0, ceil(gap / stepping.step - 1e-6))
    for b in range(plant.bodies.mass.shape[0]):
        if plant.bodies.rigid[b] != 0 and norm(three(y, STATE * b + 10)) * h > COARSEST_TURN:
            return -h
    return h


@inner
def sound(t, y, plant, stepping):
    """0, or the outcome that a state without meaning has."""
    lost = 0
    for j in range(y.shape[0]):
        lost += 0 if abs(y[j]) < FINITE else 1
    if lost > 0:
        return BROKEN
    for b in range(plant.bodies.mass.shape[0]):
        place = three(y, STATE * b)
        if dot(place, place) > SAFE_SQUARE:
            continue
        if height_of(t, place, plant) < stepping.floor:
            return GROUND
    return grounded_node(t, y, plant, stepping.floor)


@inner
def grounded_node(t, y, plant, floor):
    """GROUND where a node that is out is below the floor, else 0."""
    at = nodes_at(plant) + plant.bodies.mass.shape[0]
    for k in range(plant.lines.nodes.shape[0]):
        for j in range(plant.lines.nodes[k]):
            r = three(y, at + 6 * (plant.lines.first[k] + j))
            if dot(r, r) <= SAFE_SQUARE and height_of(t, r, plant) < floor:
                return GROUND
    return 0


@inner
def interpolated_rows(t, h, last, ready, run, loads, call):
    """Write the outputs of an adaptive step that fall in (t, last]."""
    schedule = run.schedule
    for j in range(schedule.kind.shape[0]):
        if schedule.kind[j] != OUTPUT:
            continue
        due = schedule.phase[j] + schedule.count[j] * schedule.period[j]
        while due <= last + SAME_TIME_S:
            if not ready:
                interpolant(t, h, run, loads, call)
                ready = True
            within(min((due - t) / h, 1.0), run.work, run.scratch)
            write_row(due, run.scratch, run, loads, call)
            schedule.count[j] += 1
            due = schedule.phase[j] + schedule.count[j] * schedule.period[j]


@inner
def step_error(h, implicit, plant, stepping, work):
    """Error of an adaptive step over what is allowed."""
    error_scale(work.z, work.z1, stepping.absolute, stepping.relative, work.scale)
    if implicit:
        allow_motion(h, plant, work.scale)
        return stage_error(work.k, work.implicit.method.error, work.scale)
    work.k[stepping.tableau.b.shape[0], :] = 0.0  # its weight in the error is zero
    return error_norm(h, work.k, stepping.tableau.e3, stepping.tableau.e5, work.scale)


@inner
def advance(t, due, run, loads, call):
    """One step of the plant towards `due`; (outcome, time reached)."""
    plant, stepping, clock, shared, work = run.plant, run.stepping, run.clock, run.shared, run.work
    if stepping.adaptive:
        h = min(clock.h[0], due - t)
    else:
        h = fixed_length(t, due, run)
        if h < 0.0:
            return COARSE, t
    refused = False
    implicit = work.implicit.rate.shape[0] > 0
    while True:
        if implicit:
            status = attempt_implicit(t, h, run.y, plant, run.inputs, loads, call, shared, work)
        else:
            status = attempt(t, h, run.y, plant, run.inputs, stepping.tableau, loads, call, shared, work)
        if status != 0:
            return load_outcome(status), t
        if not stepping.adaptive:
            break
        error = step_error(h, implicit, plant, stepping, work)
        proposed = next_step(h, error, work.implicit.method.order if implicit else stepping.tableau.order, refused)
        if error <= 1.0:
            # A step cut short by what was due says little about how long the next may be.
            clock.h[0] = min(stepping.step, max(proposed, clock.h[0] if h < clock.h[0] else 0.0))
            break
        refused = True
        clock.steps[1] += 1
        h = proposed
        clock.h[0] = h
        if h < SHORTEST:
            return UNDERFLOW, t
    clock.steps[0] += 1
    reached = due if due - (t + h) < SAME_TIME_S else t + h
    settle(work.z1, work.start, run.y)
    outcome = sound(reached, run.y, plant, stepping)
    if outcome == BROKEN:
        return outcome, reached
    ready = False
    part = GOES_ON
    if run.events.kind.shape[0] > 0:
        part = watch(t, h, ready, run, loads, call)
    if part < 0.0:
        return EVENT_FAILED, reached
    if part <= 1.0:
        interpolant(t, h, run, loads, call)
        ready = True
        reached = min(t + part * h, reached)
        outcome = STOPPED
    if stepping.adaptive:
        interpolated_rows(t, h, reached, ready, run, loads, call)
    if part <= 1.0:
        within(part, work, run.y)
    return outcome, reached


@kernel
def fly(budget, run, laws, memories, parameters, loads, call, rng):
    """Fly on from clock.t for at most `budget` steps; the outcome, as a number."""
    clock, stepping, events = run.clock, run.stepping, run.events
    t = clock.t[0]
    if clock.steps[0] == 0 and clock.rows[0] == 0:
        for k in range(events.kind.shape[0]):
            events.value[k] = quantity(t, k, run.y, run, loads, call)
            if not abs(events.value[k]) < FINITE:
                return EVENT_FAILED
    for _ in range(budget):
        outcome = do_due(t, run, laws, memories, parameters, loads, call, rng)
        if outcome != 0:
            return outcome
        if t >= stepping.end - SAME_TIME_S:
            return DONE
        outcome, t = advance(t, next_time(t, run), run, loads, call)
        clock.t[0] = t
        if outcome == 0:
            outcome = reel_lines(t, run)
        if outcome == STOPPED and t - run.record.seconds[clock.rows[0] - 1] > SAME_TIME_S:
            write_row(t, run.y, run, loads, call)
        if outcome != 0:
            return outcome
    return PAUSED
