"""What ended a run, in words; and how a run that broke off hands over what it has."""

from __future__ import annotations

import numpy as np

from fieldline.dynamics.layout import starts_in_state
from fieldline.errors import InputError, raised
from fieldline.simulate.assembly.lines import line_names
from fieldline.simulate.loop.records import Outcome

FINER_TURN_RAD = 0.2  # of a step, proposed where a step was too coarse


class RunError(InputError):
    """A run that could not go on: `dataset` holds what was simulated until then, marked partial."""

    def __init__(self, message: str, dataset):
        """The message says what happened, when, and what to try."""
        super().__init__(message)
        self.dataset = dataset


class RunInterrupted(KeyboardInterrupt):
    """A run that was interrupted: `dataset` holds what was simulated until then, marked partial."""

    def __init__(self, message: str, dataset):
        """The message says how far the run came."""
        super().__init__(message)
        self.dataset = dataset


def sentence(flight) -> str:
    """What ended a flight."""
    t = float(flight.clock.t[0])
    if flight.interrupted:
        return f"interrupted at t = {t:.6g} s of {flight.duration_s:.6g} s."
    return WORDS[flight.outcome](flight, t)


def _state_of(flight, b: int) -> str:
    """Rate and height of a body, to see what it was doing."""
    row = flight.y[13 * b : 13 * b + 13]
    rate = np.degrees(np.linalg.norm(row[10:13]))
    return f"rate {rate:.4g} deg/s, {1e-3 * np.linalg.norm(row[:3]):.6g} km from the Earth's centre"


def _task(flight):
    """The task at fault."""
    return flight.software[int(flight.shared.culprit[0])]


def _who(flight, t: float) -> str:
    """A law, with time and state."""
    task = _task(flight)
    return f'software "{task.name}" at t = {t:.6g} s ({_state_of(flight, task.body)})'


def _raised(flight, t: float) -> str:
    return f"{_who(flight, t)} raised {raised(flight.host.error).rstrip('.')}. Mend the law and run again."


def _shape(flight, t: float) -> str:
    task, got = _task(flight), int(flight.shared.culprit[1])
    expected = int(flight.tasks.replies[int(flight.shared.culprit[0])])
    groups = "q_bi and omega_bi_b" if task.record.role == "estimator" else ", ".join(task.commands)
    numbers = "1 number" if got == 1 else f"{got} numbers"
    return f"{_who(flight, t)} returned {numbers} where {expected} are expected ({groups}). Check its return value."


def _not_finite(flight, t: float) -> str:
    values = ", ".join(f"{v:g}" for v in flight.shared.reply[: int(flight.shared.culprit[1])])
    return (
        f"{_who(flight, t)} returned a number that is not finite ({values}). Guard it against missing measurements: `valid` "
        "says which there are."
    )


def _not_unit(flight, t: float) -> str:
    values = ", ".join(f"{v:g}" for v in flight.shared.reply[:4])
    return f"{_who(flight, t)} returned a q_bi that is no unit quaternion ({values}). Scale it to length one, scalar last."


def _load(what: str):
    """Words for a user's load."""

    def words(flight, t: float) -> str:
        name = flight.load_names[int(flight.shared.culprit[0])]
        told = f"raised {raised(flight.host.error)}" if what == "raised" else what
        return f"{name} {told} at t = {t:.6g} s; it must return six finite numbers: force_i [N] and torque_b [N m]."

    return words


def _event(flight, t: float) -> str:
    event = flight.scenario.event[int(flight.shared.culprit[0])]
    error = flight.host.error
    told = "gave no finite number" if error is None else f"raised {raised(error)}"
    return f'event "{event.name or event.kind}" ({event.function}) {told} at t = {t:.6g} s; it must return at least one number.'


def _coarse(flight, t: float) -> str:
    bodies = flight.plant.bodies
    rates = [np.linalg.norm(flight.y[13 * b + 10 : 13 * b + 13]) for b in range(len(bodies.mass))]
    b = int(np.argmax(rates))
    step = flight.scenario.integrator.step_s
    fits = FINER_TURN_RAD / rates[b]
    return (
        f'the step is too coarse: body "{flight.scenario.body[b].name}" turns at {np.degrees(rates[b]):.4g} deg/s at '
        f"t = {t:.6g} s, {rates[b] * step:.2g} rad in a step of {step:g} s. Use step_s = {fits:.2g} or less, or method = "
        '"dop853".'
    )


def _lowest(flight) -> str:
    """What is nearest to the Earth: a body, or a node of a line."""
    lines = flight.plant.lines
    radii = {f'body "{body.name}"': np.linalg.norm(flight.y[13 * b : 13 * b + 3]) for b, body in enumerate(flight.scenario.body)}
    start = starts_in_state(flight.plant)[0]
    for k, name in enumerate(line_names(flight.scenario)):
        rows = flight.y[start + 6 * lines.first[k] :][: 6 * lines.nodes[k]].reshape(-1, 6)
        radii |= {f'node {j} of line "{name}"': np.linalg.norm(row[:3]) for j, row in enumerate(rows, start=1)}
    return min(radii, key=lambda what: radii[what])


def _ground(flight, t: float) -> str:
    return (
        f"{_lowest(flight)} fell below {1e-3 * flight.stepping.floor:g} km at t = {t:.6g} s, where the models of air and orbit "
        'end. Raise the orbit, or end the run there with an event: kind = "altitude", stop = true.'
    )


def _broken(flight, t: float) -> str:
    return (
        f"the state is no longer finite at t = {t:.6g} s: a load or a step is far too large for the bodies. Try a shorter step_s "
        "and look at the last rows of the result."
    )


def _underflow(flight, t: float) -> str:
    return (
        f"the step fell below a nanosecond at t = {t:.6g} s: a load changes faster than any step can follow. Loosen the "
        'tolerances, or use method = "rk4" with a fixed step.'
    )


def _reel(far: str):
    """Words for a reel at an end of its line."""

    def words(flight, t: float) -> str:
        k = int(flight.shared.culprit[0])
        line = flight.scenario.line[k]
        reel, name = line.reel, line.name or f"line_{k + 1}"
        rate = flight.y[starts_in_state(flight.plant)[1] + 2 * k + 1]
        if far == "in":
            told = f"took {name} in to shortest_length_m = {reel.shortest_length_m:g} m"
        else:
            told = f"paid out all {reel.total_length_m:g} m of {name} (total_length_m)"
        return (
            f'the reel on "{line.to_body}" {told} at t = {t:.6g} s and still ran at {rate:.4g} m/s. Let its law stop it before, '
            "as reel-profile does at its target_length_m, or end the run there with duration_s or an event."
        )

    return words


WORDS = {
    Outcome.DONE: lambda flight, t: f"flown to its end, {t:.6g} s.",
    Outcome.STOPPED: lambda flight, t: f"stopped by an event at t = {t:.6g} s.",
    Outcome.PAUSED: lambda flight, t: f"stopped at t = {t:.6g} s.",
    Outcome.NOT_FINITE: _broken,
    Outcome.GROUND: _ground,
    Outcome.COARSE: _coarse,
    Outcome.UNDERFLOW: _underflow,
    Outcome.LAW_RAISED: _raised,
    Outcome.LAW_SHAPE: _shape,
    Outcome.LAW_NOT_FINITE: _not_finite,
    Outcome.LOAD_RAISED: _load("raised"),
    Outcome.LOAD_SHAPE: _load("returned a wrong count of numbers"),
    Outcome.EVENT_FAILED: _event,
    Outcome.LAW_NOT_UNIT: _not_unit,
    Outcome.LOAD_NOT_FINITE: _load("returned a number that is not finite"),
    Outcome.REEL_IN: _reel("in"),
    Outcome.REEL_OUT: _reel("out"),
}
