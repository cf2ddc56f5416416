"""How a line lies and moves when a run begins: straight, hanging, swinging.

All functions give every point of the line, attachments included, from A (row 0) to B (row N + 1), inertial axes. Where the
bodies stand is the caller's, and `straight` and `hanging` fill in the nodes between them; `librating` places the second
body as well, at the distance at which the line neither stretches nor rings. `waves` adds skiprope, a swing in a plane and
pulses to what these give.

Along a line that turns as a rod the tension follows from what each mass needs to stay on it,

    T_j - T_(j-1) = m_j {(a_A - g_j) . e - w^2 d_j}                                                          (1)

e: direction from A to B, w: rate at which it turns in inertial space, d_j: distance from A, g_j: gravity; a_A . e is such
that nothing is left over at B. A node's velocity is then that of the rod. When the distance of the ends is given, a tension
is added everywhere so that the stretched segments fill it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.analysis.tether.axes import direction_o, direction_rate_o
from fieldline.analysis.tether.strand import Strand, point_masses
from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError
from fieldline.frames.orbital import dcm_oi

PACE_S = 1.0  # step of the difference that tells how fast a swinging line stretches


class Ends(NamedTuple):
    """The two attachments, (3,) each: places [m] and velocities [m/s], inertial axes."""

    place_a: np.ndarray
    speed_a: np.ndarray
    place_b: np.ndarray
    speed_b: np.ndarray


class LineState(NamedTuple):
    """Points of a line from A to B, attachments included, inertial axes."""

    position_i: np.ndarray  # (s + 1, 3) [m]
    velocity_i: np.ndarray  # (s + 1, 3) [m/s]


def straight(ends: Ends, strand: Strand) -> LineState:
    """Nodes on the straight line between the ends, the same tension in every segment (none where it is slack).

    Velocities go evenly from end to end with the distance. A slack line is laid straight too: its segments are shorter than
    they are unstretched, and pull nothing.
    """
    distance = float(np.linalg.norm(ends.place_b - ends.place_a))
    return _laid(ends, _lengths(strand, np.zeros(len(strand.rest)), distance))


def hanging(ends: Ends, strand: Strand, mass_a_kg: float, mass_b_kg: float, gm_m3_s2: float = EARTH_GM_M3_S2) -> LineState:
    """Nodes on the straight line between the ends, spaced by the tension (1) of a line that turns with them.

    mass_a_kg, mass_b_kg : bodies at the ends. With the ends where `librating` puts them no segment rings; elsewhere the
    whole line is as taut as their distance asks, and is straight and slack where they are too near.
    """
    distance = float(np.linalg.norm(ends.place_b - ends.place_a))
    lengths = _lengths(strand, np.zeros(len(strand.rest)), distance)
    masses = point_masses(strand, mass_a_kg, mass_b_kg)
    for _ in range(4):
        tension = rod_tension(_laid(ends, lengths), masses, gm_m3_s2)
        lengths = _lengths(strand, tension, distance)
    return _laid(ends, lengths)


def librating(
    position_i,
    velocity_i,
    strand: Strand,
    mass_a_kg: float,
    mass_b_kg: float,
    *,
    upward: bool = False,
    in_plane_rad: float = 0.0,
    across_rad: float = 0.0,
    in_plane_rate_rad_s: float = 0.0,
    across_rate_rad_s: float = 0.0,
    gm_m3_s2: float = EARTH_GM_M3_S2,
) -> LineState:
    """A straight line from attachment A at angles from the vertical, its end B with it, so that nothing stretches or rings.

    position_i, velocity_i : (3,) of attachment A [m, m/s]; of the velocity only the orbit's plane and sense count.
    upward : B is above A at angles of zero, or below.
    in_plane_rad, across_rad : libration (2) of `fieldline.analysis.tether.axes`, and their rates [rad/s] in orbital axes.

    With angles and rates zero this is the state of rest in a circular orbit. Row 0 of velocity_i is the velocity that A needs
    for it, which is not that of a free body there: the mass centre is on the circular orbit.

    Raises
    ------
    InputError : a line that stretches without end, or angles at which it would be pushed together.
    """
    position = np.asarray(position_i, dtype=float)
    dcm, away = dcm_oi(position, velocity_i), -1.0 if upward else 1.0
    masses = point_masses(strand, mass_a_kg, mass_b_kg)
    angles = np.array([in_plane_rad, across_rad, in_plane_rate_rad_s, across_rate_rad_s], dtype=float)
    state = _rod(position, dcm, angles, away, strand, masses, gm_m3_s2)
    if rod_tension(state, masses, gm_m3_s2).min() < 0.0:
        raise InputError(
            "at this angle and rate of libration the line would be pushed, not pulled: start it nearer the vertical."
        )
    n = float(np.linalg.norm(state.velocity_i[0])) / float(np.linalg.norm(position))
    after, before = (
        _rod(position, dcm, angles + h * libration_rates(angles, n), away, strand, masses, gm_m3_s2) for h in (PACE_S, -PACE_S)
    )
    longer = _from_a(after.position_i) - _from_a(before.position_i)
    e = (state.position_i[-1] - position) / np.linalg.norm(state.position_i[-1] - position)
    return LineState(state.position_i, state.velocity_i + longer[:, None] / (2.0 * PACE_S) * e)


def libration_rates(angles: np.ndarray, n: float) -> np.ndarray:
    """(4,) rates of (a, b, a', b') of a straight short line in a circular orbit of rate n [rad/s].

    a'' = -2 (n - a') b' tan b - 3 n^2 sin a cos a,    b'' = -{(n - a')^2 + 3 n^2 cos^2 a} sin b cos b       (2)

    n - a': with the lower end ahead the line turns against the orbit.
    """
    a, b, da, db = angles
    in_plane = -2.0 * (n - da) * db * np.tan(b) - 3.0 * n**2 * np.sin(a) * np.cos(a)
    across = -((n - da) ** 2 + 3.0 * n**2 * np.cos(a) ** 2) * np.sin(b) * np.cos(b)
    return np.array([da, db, in_plane, across])


def _rod(position, dcm, angles, away: float, strand: Strand, masses: np.ndarray, gm: float) -> LineState:
    """A line from A that turns as a rod, as long as its tension makes it; `away`: 1 down from A, -1 up."""
    e, turn = (away * part @ dcm for part in (direction_o(*angles[:2]), direction_rate_o(*angles)))
    lengths = np.array(strand.rest, dtype=float)
    for _ in range(100):
        along = np.concatenate([[0.0], np.cumsum(lengths)])[:, None]
        points = position + along * e
        spin = -_circular_rate(points, masses, gm) * dcm[1]
        state = LineState(points, np.cross(spin, points) + along * turn)
        longer = strand.rest * (1.0 + rod_tension(state, masses, gm) / strand.stiffness)
        if not np.all((longer > 0.5 * strand.rest) & (longer < 2.0 * strand.rest)):
            raise InputError(
                "the line would stretch to more than twice its length, or be pushed together: is stiffness_n in newtons?"
            )
        if np.abs(longer - lengths).max() <= 1e-15 * along[-1, 0]:
            break
        lengths = longer
    return state


def _from_a(points: np.ndarray) -> np.ndarray:
    """(s + 1,) [m] distances from A."""
    return np.linalg.norm(points - points[0], axis=1)


def rod_tension(state: LineState, masses: np.ndarray, gm_m3_s2: float = EARTH_GM_M3_S2) -> np.ndarray:
    """(s,) [N] equation (1), negative where a rod would be pushed; `masses` (s + 1,) [kg], bodies included."""
    chord = state.position_i[-1] - state.position_i[0]
    chord_rate = state.velocity_i[-1] - state.velocity_i[0]
    length = np.linalg.norm(chord)
    e = chord / length
    turn = (chord_rate - e * (e @ chord_rate)) / length
    radius = np.linalg.norm(state.position_i, axis=1)
    fall = -gm_m3_s2 * (state.position_i @ e) / radius**3
    needed = -fall - (turn @ turn) * ((state.position_i - state.position_i[0]) @ e)
    needed = needed - (masses @ needed) / masses.sum()
    return np.cumsum(masses * needed)[:-1]


def _circular_rate(points: np.ndarray, masses: np.ndarray, gm: float) -> float:
    """[rad/s] at which the forces on all masses turn them about the Earth, seen along the mass centre's radius."""
    centre = masses @ points / masses.sum()
    pull = gm * (masses / np.linalg.norm(points, axis=1) ** 3) @ points
    return float(np.sqrt((pull @ centre) / (masses.sum() * (centre @ centre))))


def _lengths(strand: Strand, tension: np.ndarray, distance: float) -> np.ndarray:
    """(s,) [m] of segments that fill a distance with a tension given but for a constant; none is pushed."""
    if distance <= strand.rest.sum():
        return strand.rest * (distance / strand.rest.sum())
    compliance = strand.rest / strand.stiffness
    spare = distance - strand.rest.sum()
    taut = np.ones(len(tension), dtype=bool)
    for _ in range(len(tension)):
        added = (spare - compliance[taut] @ tension[taut]) / compliance[taut].sum()
        slack = taut & (tension + added < 0.0)
        if not slack.any():
            break
        taut &= ~slack
    return strand.rest + compliance * np.where(taut, tension + added, 0.0)


def _laid(ends: Ends, lengths: np.ndarray) -> LineState:
    """Points on the straight line between the ends."""
    part = np.concatenate([[0.0], np.cumsum(lengths)])
    part = (part / part[-1])[:, None]
    chord, chord_rate = ends.place_b - ends.place_a, ends.speed_b - ends.speed_a
    state = LineState(ends.place_a + part * chord, ends.speed_a + part * chord_rate)
    state.position_i[-1], state.velocity_i[-1] = ends.place_b, ends.speed_b
    return state
