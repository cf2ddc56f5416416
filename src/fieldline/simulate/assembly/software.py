"""The flight software of a scenario: each task's law found, its parameters packed, its memory made."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fieldline.control import LAWS
from fieldline.errors import InputError
from fieldline.simulate.assembly.actuators import KINDS
from fieldline.simulate.assembly.boards import depth_of, measurement_row
from fieldline.simulate.assembly.host import Host, Slots, compiled, function_of
from fieldline.simulate.estimators import ESTIMATORS
from fieldline.simulate.loop import records as loop
from fieldline.simulate.loop.flight_software import KNOWLEDGE
from fieldline.simulate.loop.functions import LAW, no_law
from fieldline.simulate.skiprope_laws import HEARING_LAWS

USUAL_MEMORY = 64  # numbers, where a law of the user's own does not say


@dataclass(frozen=True, kw_only=True, eq=False)
class Task:
    """One task with its law: a function of (t, measurement, memory, params)."""

    record: object
    name: str
    body: int
    law: object
    plain: bool
    commands: tuple[str, ...]
    memory: np.ndarray
    params: np.ndarray
    heard: int | None = None  # the body whose magnetometer a law that listens hears
    reference: bool = True  # whether it is given the on-board model's field
    settings: dict = field(default_factory=dict)


def software_of(scenario, design) -> list[Task]:
    """All tasks; `design(body, period_s)` gives the `DesignContext` from which laws derive their gains."""
    return [_task(scenario, k, design) for k in range(len(scenario.software))]


def _task(scenario, k: int, design) -> Task:
    """Task k."""
    record = scenario.software[k]
    body = scenario.index_of(record.body)
    where = f'software[{k}] "{record.name or record.law}"'
    if record.is_users:
        law = function_of(record.law, scenario.folder, where)
        if record.compiled:
            law = compiled(law, LAW, where)
        return Task(
            record=record,
            name=record.name or record.law,
            body=body,
            law=law,
            plain=not record.compiled,
            commands=record.commands,
            memory=np.zeros(USUAL_MEMORY if record.memory is None else record.memory),
            params=_users_parameters(record.parameters, where),
        )
    if record.role == "estimator":
        return Task(
            record=record,
            name=record.name or record.law,
            body=body,
            law=ESTIMATORS[record.law].make(record.parameters, design(body, 1.0 / record.rate_hz)),
            plain=True,
            commands=(),
            memory=np.zeros(0),
            params=np.zeros(0),
        )
    if record.law in HEARING_LAWS:
        return _hearing(scenario, record, body, design, where)
    known = LAWS[record.law]
    params = np.array(known.pack(record.parameters, design(body, 1.0 / record.rate_hz)), dtype=float)
    return Task(
        record=record,
        name=record.name or record.law,
        body=body,
        law=known.kernel,
        plain=False,
        commands=known.commands,
        memory=np.zeros(known.memory),
        params=params,
        reference=known.reference,
    )


def _hearing(scenario, record, body: int, design, where: str) -> Task:
    """A law in plain Python that hears a magnetometer: the own body's, or that at the other end of its first line."""
    known = HEARING_LAWS[record.law]
    name = scenario.body[body].name
    ends = [(line.from_body, line.to_body) for line in scenario.line if name in (line.from_body, line.to_body)]
    if not ends:
        raise InputError(f'{where}: the law "{record.law}" needs a line on "{name}".')
    far = next(one for one in ends[0] if one != name)
    heard = next((one for one in (name, far) if scenario.body[scenario.index_of(one)].magnetometer is not None), None)
    if heard is None:
        raise InputError(f'{where}: the law "{record.law}" hears a magnetometer; neither "{name}" nor "{far}" has one.')
    return Task(
        record=record,
        name=record.name or record.law,
        body=body,
        law=known.make(record.parameters, design(body, 1.0 / record.rate_hz)),
        plain=True,
        commands=known.commands,
        memory=np.zeros(0),
        params=np.zeros(0),
        heard=scenario.index_of(heard),
    )


def _users_parameters(table: dict, where: str) -> np.ndarray:
    """Numbers and lists of numbers of a user's table, one after the other."""
    flat: list[float] = []
    for key, value in table.items():
        try:
            flat += [float(v) for v in np.ravel(np.asarray(value, dtype=float))]
        except (TypeError, ValueError):
            raise InputError(f"{where}: parameters.{key} must be a number or a list of numbers; got {value!r:.60}.") from None
    return np.array(flat, dtype=float)


def tasks_of(software: list[Task], actuators: loop.Actuators) -> loop.Tasks:
    """The tasks as the loop takes them; `slot` is filled by `place`."""
    records = [task.record for task in software]
    groups = np.array([[int(kind in task.commands) for kind in KINDS] for task in software], dtype=np.int64).reshape(
        -1, len(KINDS)
    )
    depth, count = depth_of(records), len(actuators.body)
    return loop.Tasks(
        body=np.array([task.body for task in software], dtype=np.int64),
        slot=np.full(len(software), -1, dtype=np.int64),
        reference=np.array([task.reference for task in software], dtype=np.int64),
        estimator=np.array([record.role == "estimator" for record in records], dtype=np.int64),
        groups=groups,
        replies=np.array([replies_of(task, actuators) for task in software], dtype=np.int64),
        period=np.array([1.0 / record.rate_hz for record in records]),
        delay=np.array([record.delay_s for record in records]),
        pending=np.full((len(software), depth), loop.NEVER),
        waiting=np.full((len(software), depth, count), loop.NEVER),
        runs=np.zeros(len(software), dtype=np.int64),
    )


def replies_of(task: Task, actuators: loop.Actuators) -> int:
    """Numbers that a task must return."""
    if task.record.role == "estimator":
        return KNOWLEDGE
    first, total = 0, 0
    for kind, last in zip(KINDS, actuators.ends, strict=True):
        if kind in task.commands:
            total += 3 if kind in ("dipole", "wheel_torque") else int(np.sum(actuators.body[first:last] == task.body))
        first = last
    return total


def place(software: list[Task], tasks: loop.Tasks, boards: loop.Boards, host: Host):
    """Give every task its slot or its number; (laws, memories, parameters) of the slots."""
    slots = Slots(no_law, LAW, "laws")
    memories, parameters = [], []
    for i, task in enumerate(software):
        if task.plain:
            row = measurement_row(boards, task.body)
            law, memory, params = task.law, task.memory, task.params
            if task.heard is not None:
                law.sensed = measurement_row(boards, task.heard)
            host.add(i, lambda t, law=law, row=row, memory=memory, params=params: law(t, row, memory, params))
            continue
        tasks.slot[i] = slots.add(task.law)  # one a task: two tasks of one law remember different things
        memories.append(task.memory)
        parameters.append(task.params)
    laws = slots.filled()
    empty = [np.zeros(0) for _ in range(len(laws) - len(memories))]
    return laws, tuple(memories + empty), tuple(parameters + empty)
