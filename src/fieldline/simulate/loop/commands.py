"""From what a law wants to what the actuators do: allocation, limits, delay, duty cycle.

    u_k = clip( q_k round( (P w)_k / q_k ), limit_k )                                                      (1)

w: the wanted dipole of a body's torquers, or the wanted torque of its wheels on it; P: the pseudo-inverse of their axes,
so the command is the least one that gives w where the axes span it. A wheel gives the body the opposite of what its
motor gives the wheel: the sign is in P. A thruster told 0 to 1 fires at full thrust for that part of the law's period,
not at all where that is less than its shortest firing. Conductors, circuits, reels and sliding attachments are told what
to do one by one. Under a constant torque a wheel's momentum is linear in time, so the
time at which it is full is known beforehand, and its motor rests from then until it is told to go back.
"""

from __future__ import annotations

from math import exp

from fieldline.compiled import inner
from fieldline.dynamics.lines.chain import slide
from fieldline.dynamics.parameters import STATE
from fieldline.simulate.loop.records import CIRCUIT, CONDUCTOR, DIPOLE, NEVER, REEL, SAME_TIME_S, THRUST, WHEEL


@inner
def limited(wanted, lower, limit, quantum):
    """One actuator's command; equation (1)."""
    if quantum > 0.0:
        wanted = quantum * round(wanted / quantum)
    return min(max(wanted, lower), limit)


@inner
def allocate(reply, count, task, tasks, actuators, out):
    """What law `task` wants, as commands of its body's actuators into `out`; others keep NEVER. Returns numbers used."""
    body = tasks.body[task]
    at = 0
    first = 0
    for kind in range(actuators.ends.shape[0]):
        last = actuators.ends[kind]
        if tasks.groups[task, kind] != 0:
            column = at
            for k in range(first, last):
                if actuators.body[k] != body:
                    continue
                if kind <= WHEEL:
                    value = 0.0
                    for j in range(3):
                        value += actuators.share[k, j] * reply[at + j]
                else:
                    value = reply[column] if column < count else 0.0
                    column += 1
                out[k] = limited(value, actuators.lower[k], actuators.limit[k], actuators.quantum[k])
            at = at + 3 if kind <= WHEEL else column
        first = last
    return at


@inner
def send(t, task, tasks, commands):
    """Put commands (actuators,) in the queue of a task; the oldest place is taken if it is full."""
    depth = tasks.pending.shape[1]
    place = 0
    for j in range(depth):
        if tasks.pending[task, j] >= NEVER:
            place = j
            break
    tasks.pending[task, place] = t + tasks.delay[task]
    for k in range(commands.shape[0]):
        tasks.waiting[task, place, k] = commands[k]


@inner
def next_command(tasks):
    """When the next command takes effect [s], NEVER where none waits."""
    soonest = NEVER
    for i in range(tasks.pending.shape[0]):
        for j in range(tasks.pending.shape[1]):
            soonest = min(soonest, tasks.pending[i, j])
    return soonest


@inner
def drive(t, k, value, period, run):
    """Let actuator k do `value` from t on; a thruster for that part of `period`."""
    inputs, actuators = run.inputs, run.actuators
    row = actuators.target[k]
    if k < actuators.ends[DIPOLE]:
        lag = run.plant.torquers.lag[row]
        now = inputs.dipole_to[row]
        if lag > 0.0:
            now += (inputs.dipole_from[row] - now) * exp(-(t - inputs.dipole_since[row]) / lag)
        inputs.dipole_from[row] = now
        inputs.dipole_to[row] = value
        inputs.dipole_since[row] = t
    elif k < actuators.ends[WHEEL]:
        inputs.wheel_torque[row] = value
    elif k < actuators.ends[THRUST]:
        firing = value * period
        if firing <= 0.0 or firing < actuators.least[row]:
            inputs.thrust[row] = 0.0
            actuators.until[row] = NEVER
        else:
            inputs.thrust[row] = 1.0
            actuators.until[row] = t + firing
    elif k < actuators.ends[CONDUCTOR]:
        inputs.current[row] = value
    elif k < actuators.ends[CIRCUIT]:
        inputs.circuit[row] = value
        run.shared.ambient.stale[0] = 1
    elif k < actuators.ends[REEL]:
        inputs.reel[row] = value
    else:
        inputs.slide_from[row] = slide(t, row, run.plant.sliders, inputs)[0]
        inputs.slide_to[row] = value
        inputs.slide_since[row] = t


@inner
def cease_fire(t, inputs, actuators):
    """End the firings whose time is up."""
    for k in range(actuators.until.shape[0]):
        if actuators.until[k] <= t + SAME_TIME_S:
            inputs.thrust[k] = 0.0
            actuators.until[k] = NEVER


@inner
def next_ceasing(actuators):
    """When the next firing ends [s]."""
    soonest = NEVER
    for k in range(actuators.until.shape[0]):
        soonest = min(soonest, actuators.until[k])
    return soonest


@inner
def time_to_fill(k, run):
    """Seconds after which wheel k is full at the torque in effect; NEVER for one that rests."""
    torque = run.inputs.wheel_torque[k]
    if torque == 0.0:
        return NEVER
    full = run.plant.wheels.momentum_max[k]
    momentum = run.y[STATE * run.plant.bodies.mass.shape[0] + k]
    return ((full if torque > 0.0 else -full) - momentum) / torque


@inner
def next_filling(t, run):
    """When the next wheel is full [s]."""
    soonest = NEVER
    for k in range(run.inputs.wheel_torque.shape[0]):
        soonest = min(soonest, t + time_to_fill(k, run))
    return soonest


@inner
def rest_full_wheels(run):
    """Stop the motors that would press a full wheel further."""
    for k in range(run.inputs.wheel_torque.shape[0]):
        if time_to_fill(k, run) <= SAME_TIME_S:
            run.inputs.wheel_torque[k] = 0.0


@inner
def obey(t, run):
    """Let every command that is due take effect."""
    tasks, actuators = run.tasks, run.actuators
    for i in range(tasks.pending.shape[0]):
        for j in range(tasks.pending.shape[1]):
            if tasks.pending[i, j] > t + SAME_TIME_S:
                continue
            tasks.pending[i, j] = NEVER
            for k in range(actuators.body.shape[0]):
                value = tasks.waiting[i, j, k]
                if value >= NEVER:
                    continue
                actuators.wanted[k] = value
                if not (k < actuators.ends[DIPOLE] and actuators.off[actuators.body[k]] != 0):
                    drive(t, k, value, tasks.period[i], run)
    rest_full_wheels(run)


@inner
def switch_torquers(t, body, off, run):
    """Duty cycle: let the torquers of a body rest, or do what was wanted last."""
    actuators = run.actuators
    actuators.off[body] = 1 if off else 0
    for k in range(actuators.ends[DIPOLE]):
        if actuators.body[k] == body:
            drive(t, k, 0.0 if off else actuators.wanted[k], 0.0, run)
