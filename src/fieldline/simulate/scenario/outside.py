"""What a scenario needs from outside itself: orbit files, functions of the user's, laws of the library, models' years."""

from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M
from fieldline.errors import InputError, nearest, shown
from fieldline.records.words import joined
from fieldline.simulate.scenario.checks import actuators_missing
from fieldline.simulate.scenario.coarseness import orbit_too_coarse, rather_coarse

MOST_STEPS = 1e10
MOST_STRAIN = 0.2  # of a line at the start: beyond it two keys do not fit each other
VIOLENT = 20.0  # tensions of the state of rest: a wave at the start that asks for more throws the ends at each other


def check(scenario) -> list[str]:
    """Warnings; InputError lists everything that would keep the scenario from running."""
    found: list[tuple[str, str]] = []
    states = _collected(found, "orbit", lambda: _states(scenario))
    found += _functions(scenario)
    found += _laws(scenario)
    if states is not None:
        found += _span(scenario, states)
        found += _buried(scenario, states)
        found += _overstretched(scenario, states)
    if found:
        texts = [joined(path, text) for path, text in found]
        if len(texts) == 1:
            raise InputError(f"{scenario.name}: {texts[0]}")
        raise InputError(f"{scenario.name} has {len(texts)} problems:\n  " + "\n  ".join(texts))
    return list(_warnings(scenario))


def _collected(found: list[tuple[str, str]], path: str, make) -> Any:
    """What `make` gives, or None with its refusal added to what was found."""
    try:
        return make()
    except InputError as error:
        found.append((path, str(error)))
        return None


def _states(scenario):
    """States of all bodies at the start."""
    from fieldline.simulate.scenario.states import start_states

    return start_states(scenario)


def duration_s(scenario) -> float:
    """Length of the run [s]."""
    from fieldline.simulate.scenario.states import period_s

    return scenario.time.length_s(period_s(*_states(scenario)[0]) if scenario.time.duration_s is None else 0.0)


def _span(scenario, states) -> Iterator[tuple[str, str]]:
    """The field model covers the end; the steps are of a number that ends."""
    from fieldline.simulate.scenario.states import period_s

    period = period_s(*states[0])
    length = scenario.time.length_s(period)
    coarse = orbit_too_coarse(scenario, min(period_s(*state) for state in states))
    if coarse:
        yield "integrator.step_s", coarse
    end = scenario.time.start + np.timedelta64(round(length * 1e9), "ns")
    model = scenario.environment.field_model()
    if model is not None:
        try:
            model.years_of(end)
        except InputError as error:
            yield "time", f"the run ends outside the field model: {error}"
    if length < scenario.time.output_step_s:
        yield "time.output_step_s", f"must be at most the run's {length:.6g} s; got {scenario.time.output_step_s:g}."
    if scenario.integrator.method == "rk4" and length / scenario.integrator.step_s > MOST_STEPS:
        yield "integrator.step_s", f"gives {length / scenario.integrator.step_s:.2g} steps; the most is {MOST_STEPS:.0g}."


def _strains(scenario, states) -> Iterator[tuple[int, float, float]]:
    """(line, distance of its ends [m], strain) at the start, at least: attitudes may bring the ends nearer by the levers."""
    for k, line in enumerate(scenario.line):
        places = [states[scenario.index_of(name)][0] for name in (line.from_body, line.to_body)]
        levers = float(np.linalg.norm(line.from_point_b_m) + np.linalg.norm(line.to_point_b_m))
        distance = max(0.0, float(np.linalg.norm(places[1] - places[0])) - levers)
        yield k, distance, distance / line.rest_length_m - 1.0


def _together(scenario, states, line) -> bool:
    """Whether the ends of a line are the same point."""
    places = [states[scenario.index_of(name)][0] for name in (line.from_body, line.to_body)]
    return bool(np.array_equal(*places)) and not any((*line.from_point_b_m, *line.to_point_b_m))


def _overstretched(scenario, states) -> Iterator[tuple[str, str]]:
    """A line is about as long as its ends are apart, and these are not in one place."""
    for k, distance, strain in _strains(scenario, states):
        if distance == 0.0 and _together(scenario, states, scenario.line[k]):
            told = "starts with both ends in the same place, and has no direction there; mend offset_o_m of one of its bodies."
            yield f"line[{k}]", told
        if strain > MOST_STRAIN:
            line = scenario.line[k]
            yield (
                f"line[{k}].rest_length_m",
                f"must be about the distance of its ends: it is {line.rest_length_m:g} m, and they start {distance:g} m apart, "
                f"which would stretch it by {100.0 * strain:.3g} %, to {strain * line.stiffness_n:.3g} N. Give [body.hang] to "
                "one of its bodies, which puts it where the line is at rest, or mend offset_o_m.",
            )


def _buried(scenario, states) -> Iterator[tuple[str, str]]:
    """Bodies start above the ground; the first one's orbit is looked at elsewhere."""
    for k, (body, (position, _)) in enumerate(zip(scenario.body, states, strict=True)):
        height = float(np.linalg.norm(position)) - EARTH_EQUATORIAL_RADIUS_M
        if k > 0 and height < 0.0:
            start = "the line on which it hangs" if body.hang is not None else "its orbit or offset_o_m"
            yield (
                f"body[{k}]",
                f'"{body.name}" starts {-1e-3 * height:.6g} km below the ground: mend {start}, or raise the orbit.',
            )


def _waves(scenario) -> Iterator[str]:
    """A skiprope that stretches its line far more than it is at rest."""
    from fieldline.simulate.assembly.lines import strand_of
    from fieldline.simulate.scenario.line_tolerance import rest_pull
    from fieldline.simulate.scenario.states import period_s

    rate = 2.0 * np.pi / period_s(*_states(scenario)[0])
    for k, line in enumerate(scenario.line):
        if line.start is None or line.start.skiprope_amplitude_m == 0.0:
            continue
        strand = strand_of(line)
        slope = line.start.skiprope_mode * np.pi * line.start.skiprope_amplitude_m / float(strand.rest.sum())
        pull = 0.25 * slope**2 * float(strand.rest.sum() / (strand.rest / strand.stiffness).sum())
        calm = rest_pull(scenario, line, strand, rate)
        if pull > VIOLENT * calm:
            amplitude = line.start.skiprope_amplitude_m
            most = amplitude * np.sqrt(VIOLENT * calm / pull)
            yield (
                f"line[{k}].start.skiprope_amplitude_m = {amplitude:g} m makes the line longer by a part in "
                f"{4.0 / slope**2:.2g}, which pulls its ends with {pull:.2g} N where {calm:.2g} N hold it at rest: they are "
                f"thrown at each other and the line falls slack. {most:.2g} m or less, or a softer line, keep it taut longer."
            )


def _functions(scenario) -> Iterator[tuple[str, str]]:
    """Functions of the user's own are where they are said to be."""
    named = [(f"software[{k}].law", one.law) for k, one in enumerate(scenario.software) if one.is_users]
    named += [(f"event[{k}].function", one.function) for k, one in enumerate(scenario.event) if one.function]
    for k, body in enumerate(scenario.body):
        named += [(f"body[{k}].load[{j}].function", one.function) for j, one in enumerate(body.load)]
    for k, line in enumerate(scenario.line):
        named += [(f"line[{k}].load[{j}].function", one.function) for j, one in enumerate(line.load)]
    for path, name in named:
        place, _, function = name.rpartition(":")
        if place.endswith(".py"):
            yield from _in_file(path, scenario.folder / place, function)
        elif not _module_exists(place):
            yield path, f'no module "{shown(place)}" is installed; name a file as "file.py:{shown(function)}" instead.'


def _in_file(path: str, file: Path, function: str) -> Iterator[tuple[str, str]]:
    """The file exists, is Python, and defines the function; it is not run."""
    import ast

    from fieldline.files import read_text

    try:
        tree = ast.parse(read_text(file, "Python file"))
    except InputError as error:
        yield path, str(error)
        return
    except (SyntaxError, ValueError, RecursionError) as error:
        yield path, f'"{file.name}" is no Python: {getattr(error, "msg", error)}, line {getattr(error, "lineno", None)}.'
        return
    names = [one.name for one in tree.body if isinstance(one, ast.FunctionDef)]
    names += [one.id for line in tree.body if isinstance(line, ast.Assign) for one in line.targets if isinstance(one, ast.Name)]
    if function not in names:
        yield path, f'"{file.name}" defines no {shown(function)}; {nearest(function, names) if names else "it has no function."}'


def _module_exists(name: str) -> bool:
    """Whether a module can be imported; its parents are."""
    try:
        return importlib.util.find_spec(name) is not None
    except (ImportError, ValueError, AttributeError):
        return False


def known_laws() -> dict[str, Any]:
    """Laws and estimators of the library by name."""
    from fieldline.control import LAWS
    from fieldline.simulate.estimators import ESTIMATORS
    from fieldline.simulate.skiprope_laws import HEARING_LAWS

    return {**LAWS, **ESTIMATORS, **HEARING_LAWS}


def _laws(scenario) -> Iterator[tuple[str, str]]:
    """Laws of the library exist, know their parameters and find their actuators."""
    laws = known_laws()
    for k, task in enumerate(scenario.software):
        if task.is_users:
            continue
        if task.law not in laws:
            near = nearest(task.law, laws)
            yield f"software[{k}].law", f'unknown law "{shown(task.law)}"; {near} Or name your own as "file.py:function".'
            continue
        law = laws[task.law]
        role = "controller" if law.commands else "estimator"
        if task.role != role:
            yield f"software[{k}].role", f'must be "{role}" for the law "{law.name}"; got "{task.role}".'
        for key in task.parameters:
            if key not in law.parameters:
                yield (
                    f"software[{k}].parameters.{shown(key)}",
                    f'"{law.name}" has no such parameter; {nearest(key, law.parameters)}',
                )
        body = scenario.body[scenario.index_of(task.body)]
        needed = [command for command in law.commands if command not in getattr(law, "optional", ())]
        yield from actuators_missing(f"software[{k}].law", needed, scenario, body)


def _rivals(scenario) -> Iterator[str]:
    """Tasks that command the same actuators: each call's command stands until the next one's."""
    laws, found = known_laws(), {}
    for k, task in enumerate(scenario.software):
        for command in task.commands if task.is_users else laws[task.law].commands:
            found.setdefault((scenario.index_of(task.body), command), []).append(k)
    for (b, command), tasks in found.items():
        if len(tasks) > 1:
            named = " and ".join(f"software[{k}]" for k in tasks)
            yield f'{named} all command "{command}" of "{scenario.body[b].name}": who was called last is obeyed.'


def _warnings(scenario) -> Iterator[str]:
    """What runs, but perhaps not as meant."""
    yield from _waves(scenario)
    yield from _rivals(scenario)
    for k, body in enumerate(scenario.body):
        coarse = rather_coarse(scenario, body)
        if coarse:
            yield f"integrator.{coarse} (body[{k}])."
    for k, task in enumerate(scenario.software):
        body = scenario.body[scenario.index_of(task.body)]
        cycle = body.duty_cycle
        if cycle is not None and task.rate_hz * cycle.period_s > 1.0 + 1e-9:
            yield (
                f"software[{k}] is called {task.rate_hz * cycle.period_s:.3g} times in a duty cycle of body[].duty_cycle, "
                f"{cycle.period_s:g} s: commands of calls in its second part wait for the next."
            )
