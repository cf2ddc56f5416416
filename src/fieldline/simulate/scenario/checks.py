"""What a scenario's tables must be to each other; no file is opened here."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from fieldline.errors import InputError, nearest
from fieldline.simulate.scenario.coarseness import too_coarse
from fieldline.simulate.scenario.line_stiffness import too_stiff

MOST_SAMPLES = 50_000_000
NEEDS = {"dipole": "magnetorquer", "wheel_torque": "wheel", "thrust": "thruster"}

Found = Iterator[tuple[str, str]]


def problems(scenario) -> Found:
    """(path of a key, what is wrong with it), for everything at once."""
    yield from _starts(scenario)
    yield from _names(scenario)
    yield from _lines(scenario)
    yield from _software(scenario)
    yield from _events(scenario)
    yield from _models(scenario)
    yield from _lengths(scenario)


def _starts(scenario) -> Found:
    """The first body has the orbit, the others one of their own or a place beside the first."""
    first = scenario.body[0]
    if scenario.orbit is None and first.orbit is None:
        yield "orbit", "is missing: say where the first body starts, for example [orbit.sun_synchronous] with altitude_km"
    if scenario.orbit is not None and first.orbit is not None:
        yield "body[0].orbit", "is given beside [orbit], which is the first body's; leave one of them out"
    if first.offset_o_m is not None:
        yield "body[0].offset_o_m", "has no meaning for the first body, from which the others are counted; leave it out"
    if first.hang is not None:
        yield "body[0].hang", "has no meaning for the first body, from which the others hang; leave it out"
    for k, body in enumerate(scenario.body[1:], start=1):
        if body.hang is not None:
            yield from _hangs(scenario, k, body)
        elif body.orbit is None and body.offset_o_m is None:
            yield f"body[{k}]", "has no start: give offset_o_m from the first body, hang on a line, or an orbit of its own"


def _hangs(scenario, k: int, body) -> Found:
    """A body hangs on one line, whose other end is on an earlier body."""
    names = [line.name or f"line_{j}" for j, line in enumerate(scenario.line, start=1)]
    if body.hang.line and body.hang.line not in names:
        yield f"body[{k}].hang.line", f'names no [[line]]: "{body.hang.line[:40]}"; {nearest(body.hang.line, names)}'
        return
    carrying = [names[j] for j in carrying_lines(scenario, body)]
    if not carrying or (body.hang.line and body.hang.line not in carrying):
        yield (
            f"body[{k}].hang",
            f'needs a line from "{body.name}" to a body before it in the file; such lines: {_listed(carrying)}',
        )
    elif not body.hang.line and len(carrying) > 1:
        yield f"body[{k}].hang.line", f"is missing: which of {_listed(carrying)}?"


def _listed(names: list[str]) -> str:
    """Names, or none."""
    return ", ".join(names)[:80] or "none"


def carrying_lines(scenario, body) -> list[int]:
    """Lines between a body and one before it in the file."""
    names = [one.name for one in scenario.body]
    before = set(names[: names.index(body.name)])
    ends = [(line.from_body, line.to_body) for line in scenario.line]
    return [
        k for k, (one, two) in enumerate(ends) if (one == body.name and two in before) or (two == body.name and one in before)
    ]


def _names(scenario) -> Found:
    """Names in results are unique."""
    named = {
        "body": [one.name for one in scenario.body],
        "line": [one.name or f"line_{k}" for k, one in enumerate(scenario.line, start=1)],
        "software": [one.name or one.law for one in scenario.software],
        "event": [one.name or one.kind for one in scenario.event],
    }
    for table, names in named.items():
        first: dict[str, int] = {}
        for k, name in enumerate(names):
            if first.setdefault(name, k) != k:
                yield f"{table}[{k}].name", f'must be unique; "{name[:40]}" is {table}[{first[name]}] too'


def _body_named(scenario, path: str, name: str) -> Found:
    """The body exists."""
    known = [one.name for one in scenario.body]
    if name and name not in known:
        yield path, f'names no [[body]]: "{name[:40]}"; {nearest(name, known)}'


def _lines(scenario) -> Found:
    """A line ties two bodies that exist."""
    for k, line in enumerate(scenario.line):
        yield from _body_named(scenario, f"line[{k}].from_body", line.from_body)
        yield from _body_named(scenario, f"line[{k}].to_body", line.to_body)
        if line.from_body == line.to_body:
            yield f"line[{k}].to_body", "must be another body than from_body"
        known = {body.name: body for body in scenario.body}
        for j, one in enumerate(line.slider):
            body = known.get(getattr(line, f"{one.end}_body"))
            if body is not None and body.kind == "point":
                yield f"line[{k}].slider[{j}].end", f'is on "{body.name}", a point mass, which has no axes'
        for end in ("from", "to"):
            body = known.get(getattr(line, f"{end}_body"))
            if body is not None and body.kind == "point" and any(getattr(line, f"{end}_point_b_m")):
                yield f"line[{k}].{end}_point_b_m", f'is off "{body.name}", a point mass, which does not turn; leave it out'
            if body is not None and body.kind == "point" and getattr(line, f"{end}_joint_damping_n_m_s"):
                yield (
                    f"line[{k}].{end}_joint_damping_n_m_s",
                    f'acts on "{body.name}", a point mass, which does not turn; leave it out',
                )
    yield from _reels(scenario)


def _reels(scenario) -> Found:
    """What is on reels is part of their body's mass."""
    for body in scenario.body:
        reeled = [(k, one) for k, one in enumerate(scenario.line) if one.reel is not None and one.to_body == body.name]
        held = sum(line.mass_on_reel_kg for _, line in reeled)
        if held >= body.mass_kg:
            yield (
                f"line[{reeled[0][0]}].reel.total_length_m",
                f'leaves {held:.6g} kg of line on the reel of "{body.name}", whose mass_kg = {body.mass_kg:g} holds it too; '
                "give a shorter line, a lighter one, or a larger mass_kg",
            )


def _software(scenario) -> Found:
    """A task runs on a rigid body that exists and has what it commands."""
    for k, task in enumerate(scenario.software):
        path = f"software[{k}]"
        unknown = list(_body_named(scenario, f"{path}.body", task.body))
        yield from unknown
        if not task.body and len(scenario.body) > 1:
            yield f"{path}.body", f"is missing: which of {', '.join(one.name for one in scenario.body)[:80]}?"
        elif not unknown:
            body = scenario.body[scenario.index_of(task.body)]
            if body.kind == "point" and not (reeled(scenario, body) or commanded(scenario, body)):
                yield f"{path}.body", f'names "{body.name}", a point mass, which has nothing to command'
            else:
                yield from actuators_missing(f"{path}.commands", task.commands, scenario, body)


def reeled(scenario, body) -> list:
    """Lines whose reel a body's flight software commands."""
    return [line for line in scenario.line if line.to_body == body.name and line.reel is not None]


def commanded(scenario, body) -> list:
    """Lines whose current a body's flight software commands."""
    mine = [line.circuit for line in scenario.line if line.to_body == body.name]
    return [circuit for circuit in mine if circuit is not None and circuit.commanded]


def sliding(scenario, body) -> list:
    """Sliders of the attachments on a body."""
    ends = [(line, one) for line in scenario.line for one in line.slider]
    return [one for line, one in ends if getattr(line, f"{one.end}_body") == body.name]


def actuators_missing(path: str, commands: Iterable[str], scenario, body) -> Found:
    """Commands for which the body has no actuator."""
    for command in commands:
        if command == "current":
            there, what = (
                [*body.conductor, *commanded(scenario, body)],
                "[[body.conductor]] or commanded [line.circuit] on a line with that to_body",
            )
        elif command == "reel":
            there, what = reeled(scenario, body), "[line.reel] on a line with that to_body"
        elif command == "attachment":
            there, what = sliding(scenario, body), "[[line.slider]] at its end of a line"
        else:
            there, what = getattr(body, NEEDS[command]), f"[[body.{NEEDS[command]}]]"
        if not there:
            yield path, f'has "{command}", but body "{body.name}" has no {what}'


def _events(scenario) -> Found:
    """An event watches a body that exists and, for its rate, turns."""
    for k, event in enumerate(scenario.event):
        unknown = list(_body_named(scenario, f"event[{k}].body", event.body))
        yield from unknown
        if not unknown and event.kind == "rate" and scenario.body[scenario.index_of(event.body)].kind == "point":
            yield f"event[{k}].body", "is a point mass, which has no angular rate"


def _models(scenario) -> Found:
    """Drag needs air; the field model knows the year, on board too."""
    for k, body in enumerate(scenario.body):
        if body.drag is not None and scenario.environment.atmosphere.model == "none":
            yield f"body[{k}].drag", 'needs air: give [environment.atmosphere] with model = "exponential", "layered" or "msis"'
        if body.onboard is not None:
            yield from _field_of(f"body[{k}].onboard.field", body.onboard, scenario.time)
    for k, line in enumerate(scenario.line):
        if line.circuit is not None and collects(line.circuit) and scenario.environment.plasma.model == "none":
            yield (
                f"line[{k}].circuit",
                'collects electrons: give [environment.plasma] with model = "chapman", "constant" or "table"',
            )
    model = scenario.environment.field_model()
    if model is not None:
        yield from _year("time.start_utc", model, scenario.time)


def collects(circuit) -> bool:
    """Whether a circuit takes electrons from the plasma by itself."""
    return circuit.mode == "bare" or any(circuit.collector_radius_m)


def _field_of(path: str, onboard, span) -> Found:
    """The model on board exists and knows the year."""
    from fieldline.environment.field_registry import field_model

    try:
        model = field_model(onboard.field, degree=onboard.field_degree)
    except InputError as error:
        yield path, f"must be a field model with options that it has: {error}"
        return
    yield from _year(path, model, span)


def _year(path: str, model, span) -> Found:
    """The model covers the start."""
    try:
        model.years_of(span.start)
    except InputError as error:
        yield path, f"is outside the field model: {error}"


def _lengths(scenario) -> Found:
    """A bearable number of samples, and a step that the rate allows."""
    if scenario.time.duration_s is not None:
        samples = len(scenario.body) * scenario.time.duration_s / scenario.time.output_step_s
        if samples > MOST_SAMPLES:
            step = len(scenario.body) * scenario.time.duration_s / MOST_SAMPLES
            yield "time.output_step_s", f"gives {samples:.3g} samples; the most is {MOST_SAMPLES:g}, which {step:.3g} s keeps to"
    for k, body in enumerate(scenario.body):
        coarse = too_coarse(scenario, body)
        if coarse:
            yield "integrator.step_s", f"{coarse} (body[{k}])"
    known = {body.name for body in scenario.body}
    for k, line in enumerate(scenario.line):
        stiff = too_stiff(scenario, k) if {line.from_body, line.to_body} <= known else None
        if stiff:
            yield f"line[{k}]", stiff
