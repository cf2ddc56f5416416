"""Bodies that hang on lines at the start: places and velocities at the ends of a taut line at rest, or swinging as a rod.

The state of rest of a line between two masses turns about the Earth at one rate (`fieldline.analysis.tether.starts`). The
upper or the lower body, whichever has the orbit, keeps its place; where `balanced`, its velocity changes by the difference
between that rate of turn and its own circular orbit, so that what it had beyond a circular orbit it keeps:

    v_A = v_A,given + v_A,rest - sqrt(GM / r_A) t,    v_B = v_A + (v_B - v_A)_rest                           (1)

t: unit vector along the track. What hangs beyond B counts as mass at B.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.dynamics.parameters import STATE
from fieldline.errors import InputError
from fieldline.simulate.assembly.line_ends import attachment_point
from fieldline.simulate.assembly.lines import line_names, mass_out, strand_of


def line_of(scenario, body) -> int:
    """The line on which a body hangs."""
    if body.hang.line:
        return line_names(scenario).index(body.hang.line)
    return next(k for k, line in enumerate(scenario.line) if body.name in (line.from_body, line.to_body))


def other_end(line, body) -> str:
    """Name of the body at the line's other end."""
    return line.to_body if line.from_body == body.name else line.from_body


def hung(scenario, body, states) -> tuple[np.ndarray, np.ndarray]:
    """(position_i, velocity_i) of a body's attachment, levers left out, from the states of the bodies before it."""
    line = scenario.line[line_of(scenario, body)]
    position, velocity = states[scenario.index_of(other_end(line, body))]
    state = _rod(scenario, body, position, velocity)
    return state.position_i[-1], velocity + state.velocity_i[-1] - state.velocity_i[0]


def hang_bodies(scenario, y: np.ndarray) -> dict[int, object]:
    """Put hanging bodies, whose attitudes and rates are in y, where their lines are taut; states of their lines by number."""
    states = {}
    for b, body in enumerate(scenario.body):
        if body.hang is None:
            continue
        k = line_of(scenario, body)
        line = scenario.line[k]
        a = scenario.index_of(other_end(line, body))
        mine = "from" if line.from_body == body.name else "to"
        row_a, row_b = (y[STATE * n : STATE * (n + 1)] for n in (a, b))
        lever_a, swing_a = _lever(scenario, k, "to" if mine == "from" else "from", row_a)
        state = _rod(scenario, body, row_a[:3] + lever_a, row_a[3:6])
        if body.hang.balanced:
            row_a[3:6] += _balance(state, row_a)
        speeds = row_a[3:6] + swing_a + state.velocity_i - state.velocity_i[0]
        lever_b, swing_b = _lever(scenario, k, mine, row_b)
        row_b[:3] = state.position_i[-1] - lever_b
        row_b[3:6] = speeds[-1] - swing_b
        moved = state._replace(velocity_i=speeds)
        states[k] = moved if mine == "to" else type(moved)(*(part[::-1] for part in moved))
    return states


def _rod(scenario, body, position_i, velocity_i):
    """The taut line from the other body's attachment to this one's."""
    from fieldline.analysis.tether import librating

    k = line_of(scenario, body)
    line = scenario.line[k]
    strand = strand_of(line)
    if line.to_body != body.name:
        strand = type(strand)(*(part[::-1].copy() for part in strand))
    other = scenario.body[scenario.index_of(other_end(line, body))]
    hang = body.hang
    try:
        return librating(
            position_i,
            velocity_i,
            strand,
            other.mass_kg,
            _mass_beyond(scenario, body),
            upward=hang.upward,
            in_plane_rad=np.radians(hang.in_plane_deg),
            across_rad=np.radians(hang.out_of_plane_deg),
            in_plane_rate_rad_s=np.radians(hang.in_plane_rate_deg_s),
            across_rate_rad_s=np.radians(hang.out_of_plane_rate_deg_s),
        )
    except InputError as error:
        raise InputError(f'body "{body.name}", hanging on line "{line_names(scenario)[k]}": {error}') from None


def _mass_beyond(scenario, body) -> float:
    """Mass of a body and of what hangs from it [kg]."""
    total = body.mass_kg
    for other in scenario.body:
        if other.hang is not None:
            line = scenario.line[line_of(scenario, other)]
            if other_end(line, other) == body.name:
                total += mass_out(line) + _mass_beyond(scenario, other)
    return total


def _balance(state, row_a: np.ndarray) -> np.ndarray:
    """Equation (1): what the other body's velocity gains (3,) [m/s]."""
    position, velocity = row_a[:3], row_a[3:6]
    radius = float(np.linalg.norm(position))
    normal = np.cross(position, velocity)
    track = np.cross(normal, position)
    rest = np.cross(state.velocity_i[0], state.position_i[0])  # the rod's turn, -w r^2
    rate = float(np.linalg.norm(rest)) / float(state.position_i[0] @ state.position_i[0])
    return (rate * radius - np.sqrt(EARTH_GM_M3_S2 / radius)) * track / np.linalg.norm(track)


def _lever(scenario, k: int, end: str, row: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Attachment from the body's centre [m], and its velocity against it [m/s], inertial axes."""
    point = attachment_point(scenario, k, end)
    turn = Rotation.from_quat(row[6:10])
    return turn.apply(point), turn.apply(np.cross(row[10:13], point))
