"""Bodies that hang on lines at the start: places and velocities at the ends of taut lines at rest, or of one that swings.

Two bodies on a line may swing as a rod (`fieldline.analysis.tether.starts`). More of them hang at rest on the vertical through
the first, which all turn about the Earth at one rate (`fieldline.simulate.assembly.rest_state`). The body from which the others
hang keeps its place; where `balanced`, its velocity changes by the difference between that turn and its own circular orbit,
so that what it had beyond a circular orbit it keeps:

    v_A = v_A,given + (w r_A - sqrt(GM / r_A)) t,    v_B = v_A + (v_B - v_A)_rest                             (1)

t: unit vector along the track, w: rate of the turn.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.dynamics.parameters import STATE
from fieldline.errors import InputError
from fieldline.simulate.assembly.line_ends import attachment_point
from fieldline.simulate.assembly.lines import line_names, strand_of
from fieldline.simulate.assembly.rest_state import rest_of
from fieldline.simulate.scenario.checks import carrying_lines


def line_of(scenario, body) -> int:
    """The line on which a body hangs."""
    if body.hang.line:
        return line_names(scenario).index(body.hang.line)
    return carrying_lines(scenario, body)[0]


def carrier_of(scenario, body):
    """The body at the other end of the line on which a body hangs."""
    line = scenario.line[line_of(scenario, body)]
    return scenario.body[scenario.index_of(line.to_body if line.from_body == body.name else line.from_body)]


def hung(scenario, body, states) -> tuple[np.ndarray, np.ndarray]:
    """(position_i, velocity_i) of a body's attachment, levers left out, from the states of the bodies before it."""
    position, velocity = states[scenario.index_of(carrier_of(scenario, body).name)]
    state = _taut(scenario, body, position, velocity)
    return state.position_i[-1], velocity + state.velocity_i[-1] - state.velocity_i[0]


def hang_bodies(scenario, y: np.ndarray) -> dict[int, object]:
    """Put hanging bodies, whose attitudes and rates are in y, where their lines are taut; states of their lines by number."""
    states, balanced = {}, set()
    for b, body in enumerate(scenario.body):
        if body.hang is None:
            continue
        k = line_of(scenario, body)
        carrier = carrier_of(scenario, body)
        mine, far = ("from", "to") if scenario.line[k].from_body == body.name else ("to", "from")
        row_a, row_b = y[_row(scenario.index_of(carrier.name))], y[_row(b)]
        lever_a, swing_a = _lever(scenario, k, far, row_a)
        state = _taut(scenario, body, row_a[:3] + lever_a, row_a[3:6])
        if body.hang.balanced and carrier.hang is None and carrier.name not in balanced:
            row_a[3:6] += _balance(state, row_a)
            balanced.add(carrier.name)
        speeds = row_a[3:6] + swing_a + state.velocity_i - state.velocity_i[0] + _paid_out(scenario.line[k], mine, state)
        lever_b, swing_b = _lever(scenario, k, mine, row_b)
        row_b[:3], row_b[3:6] = state.position_i[-1] - lever_b, speeds[-1] - swing_b
        moved = state._replace(velocity_i=speeds)
        states[k] = moved if mine == "to" else type(moved)(*(part[::-1] for part in moved))
    return states


def _row(b: int) -> slice:
    """A body's numbers in the state."""
    return slice(STATE * b, STATE * (b + 1))


def _taut(scenario, body, position_i, velocity_i):
    """The taut line from the carrier's attachment to this body's."""
    from fieldline.analysis.tether import librating

    hang, k = body.hang, line_of(scenario, body)
    swings = any((hang.in_plane_deg, hang.out_of_plane_deg, hang.in_plane_rate_deg_s, hang.out_of_plane_rate_deg_s))
    alone = sum(one.hang is not None for one in scenario.body) == 1
    where = f'body "{body.name}", hanging on line "{line_names(scenario)[k]}"'
    if swings and not alone:
        raise InputError(
            f"{where}: only two bodies can start swinging as a rod, and more of them hang here. Leave its angles and rates out."
        )
    try:
        if not alone:
            return rest_of(scenario, body, position_i, velocity_i, line_of, carrier_of)
        strand = strand_of(scenario.line[k])
        if scenario.line[k].to_body != body.name:
            strand = type(strand)(*(part[::-1].copy() for part in strand))
        return librating(
            position_i,
            velocity_i,
            strand,
            carrier_of(scenario, body).mass_kg,
            body.mass_kg,
            upward=hang.upward,
            in_plane_rad=np.radians(hang.in_plane_deg),
            across_rad=np.radians(hang.out_of_plane_deg),
            in_plane_rate_rad_s=np.radians(hang.in_plane_rate_deg_s),
            across_rate_rad_s=np.radians(hang.out_of_plane_rate_deg_s),
        )
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _paid_out(line, mine: str, state) -> np.ndarray:
    """(points, 3) [m/s] from the carrier on: what a reel that turns already adds to the velocities.

    A reel on the carrier moves all of the line and the body away from it; one on the body, the body alone.
    """
    added = np.zeros_like(state.velocity_i)
    if line.reel is not None:
        chord = state.position_i[-1] - state.position_i[0]
        moving = slice(1, None) if mine == "from" else slice(-1, None)
        added[moving] = line.reel.rate_m_s * chord / np.linalg.norm(chord)
    return added


def _balance(state, row_a: np.ndarray) -> np.ndarray:
    """Equation (1): what the carrier's velocity gains (3,) [m/s]."""
    position, velocity = row_a[:3], row_a[3:6]
    radius = float(np.linalg.norm(position))
    track = np.cross(np.cross(position, velocity), position)
    turn = np.cross(state.position_i[0], state.velocity_i[0])
    rate = float(np.linalg.norm(turn)) / float(state.position_i[0] @ state.position_i[0])
    return (rate * radius - np.sqrt(EARTH_GM_M3_S2 / radius)) * track / np.linalg.norm(track)


def _lever(scenario, k: int, end: str, row: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Attachment from the body's centre [m], and its velocity against it [m/s], inertial axes."""
    point = attachment_point(scenario, k, end)
    turn = Rotation.from_quat(row[6:10])
    return turn.apply(point), turn.apply(np.cross(row[10:13], point))
