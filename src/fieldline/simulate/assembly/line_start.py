"""Where the nodes of the lines are at the start, and what their reels do."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from fieldline.dynamics.layout import starts_in_state
from fieldline.dynamics.parameters import STATE, Plant
from fieldline.errors import InputError
from fieldline.simulate.assembly.line_ends import attachment_point
from fieldline.simulate.assembly.lines import last_length, line_names, nodes_out, strand_of


def start_lines(scenario, plant: Plant, y: np.ndarray, taut: dict[int, object]) -> None:
    """Nodes and feeds of every line into the state y, whose bodies have their states already.

    taut: the states of lines on which bodies hang. Other lines lie straight between their ends, as taut as these ask.
    """
    nodes, feeds, temperatures = starts_in_state(plant)
    for k, line in enumerate(scenario.line):
        first, out = int(plant.lines.first[k]), nodes_out(line)
        if out > 0:
            state = _waved(scenario, k, taut.get(k) or _straight(scenario, k, y))
            rows = y[nodes + 6 * first : nodes + 6 * (first + out)].reshape(-1, 6)
            rows[:, :3], rows[:, 3:] = state.position_i[1:-1], state.velocity_i[1:-1]
        y[feeds + 2 * k] = last_length(line)
        y[feeds + 2 * k + 1] = 0.0 if line.reel is None else line.reel.rate_m_s
        if line.heat is not None:
            y[temperatures + plant.lines.warm[k] : temperatures + plant.lines.warm[k + 1]] = line.heat.start_temperature_k


def _straight(scenario, k: int, y: np.ndarray):
    """A line between the ends where they stand."""
    from fieldline.analysis.tether import Ends, hanging

    ends = [attachment(scenario, k, end, y) for end in ("from", "to")]
    masses = [scenario.body[scenario.index_of(name)].mass_kg for name in (scenario.line[k].from_body, scenario.line[k].to_body)]
    return hanging(Ends(ends[0][:3], ends[0][3:], ends[1][:3], ends[1][3:]), strand_of(scenario.line[k]), *masses)


def _waved(scenario, k: int, state):
    """The waves of [line.start] laid over a line's state."""
    from fieldline.analysis.tether import pulse, skiprope

    line = scenario.line[k]
    start, strand = line.start, strand_of(line)
    if start is None:
        return state
    masses = [scenario.body[scenario.index_of(name)].mass_kg for name in (line.from_body, line.to_body)]
    try:
        if start.skiprope_amplitude_m > 0.0:
            state = skiprope(
                state,
                strand,
                *masses,
                amplitude_m=start.skiprope_amplitude_m,
                phase_rad=np.radians(start.skiprope_phase_deg),
                sense=start.skiprope_sense,
                mode=start.skiprope_mode,
            )
        if start.pulse_amplitude_m != 0.0:
            width = start.pulse_width_m or 0.1 * line.rest_length_m
            amplitude, towards = start.pulse_amplitude_m, start.pulse_towards
            state = pulse(state, strand, amplitude_m=amplitude, middle=start.pulse_middle, width_m=width, towards=towards)
    except InputError as error:
        raise InputError(f'line[{k}].start ("{line_names(scenario)[k]}"): {error}') from None
    return state


def attachment(scenario, k: int, end: str, y: np.ndarray) -> np.ndarray:
    """(6,) place [m] and velocity [m/s] of an end of line k, inertial axes."""
    b = scenario.index_of(getattr(scenario.line[k], f"{end}_body"))
    row = y[STATE * b : STATE * (b + 1)]
    point = attachment_point(scenario, k, end)
    turn = Rotation.from_quat(row[6:10])
    return np.concatenate([row[:3] + turn.apply(point), row[3:6] + turn.apply(np.cross(row[10:13], point))])
