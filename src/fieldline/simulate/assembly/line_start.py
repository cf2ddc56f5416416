"""Where the nodes of the lines are at the start, and what their reels do."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from fieldline.dynamics.layout import starts_in_state
from fieldline.dynamics.parameters import STATE, Plant
from fieldline.simulate.assembly.lines import last_length, nodes_out, sliders, spacing


def start_lines(scenario, plant: Plant, y: np.ndarray) -> None:
    """Nodes and feeds of every line into the state y, whose bodies have their states already."""
    nodes, feeds, _ = starts_in_state(plant)
    for k, line in enumerate(scenario.line):
        ends = [attachment(scenario, k, end, y) for end in ("from", "to")]
        first, out = int(plant.lines.first[k]), nodes_out(line)
        share = spacing(line) * np.arange(1, out + 1)[:, None] / line.rest_length_m
        rows = y[nodes + 6 * first : nodes + 6 * (first + out)].reshape(-1, 6)
        rows[:] = (1.0 - share) * ends[0] + share * ends[1]
        y[feeds + 2 * k] = last_length(line)
        y[feeds + 2 * k + 1] = 0.0 if line.reel is None else line.reel.rate_m_s


def attachment(scenario, k: int, end: str, y: np.ndarray) -> np.ndarray:
    """(6,) place [m] and velocity [m/s] of an end of line k, inertial axes."""
    line = scenario.line[k]
    b = scenario.index_of(getattr(line, f"{end}_body"))
    row = y[STATE * b : STATE * (b + 1)]
    point = np.array(getattr(line, f"{end}_point_b_m"), dtype=float)
    for owner, one in sliders(scenario):
        if owner == k and one.end == end:
            point += one.start_m * np.array(one.axis_b)
    turn = Rotation.from_quat(row[6:10])
    return np.concatenate([row[:3] + turn.apply(point), row[3:6] + turn.apply(np.cross(row[10:13], point))])
