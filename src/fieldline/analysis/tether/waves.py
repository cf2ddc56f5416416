"""Waves laid over a line that lies straight: skiprope and swings of any mode, and pulses that run along it.

Seen in the axes of the line (`fieldline.analysis.tether.axes`), the deflections in the plane (e_1) and across it (e_2) are

    x = A f(s) cos(p),    y = A f(s) sin(p),    dx/dt = -+A wx f(s) sin(p),    dy/dt = +-A wy f(s) cos(p)    (1)

p: its phase, from e_1 to e_2. Of the signs the upper are those of a skiprope that goes round right-handed about the direction
down the line, the lower left-handed; a swing in one plane has no speed. f is the shape of the mode less the straight line between
its ends, so that the bodies stay where they are: with a body that is not heavy against the line a little libration starts
with it. f is 1 where it is largest. The rates are

    {S + m GM/r^3} f = m wy^2 f,    wx^2 = wy^2 - n^2                                                        (2)

The second is exact for a line without stretch; the stretch and the Coriolis force change wx by parts in ten thousand.
A pulse is a stretch that runs with the speed of sound c = sqrt(EA / mu) in the unstretched line,

    u = A exp(-((s - s0) / b)^2),    du/dt = -+c du/ds towards B (-) or A (+)                                (3)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.analysis.tether.axes import Frame, line_axes
from fieldline.analysis.tether.starts import LineState, rod_tension
from fieldline.analysis.tether.strand import Strand, point_masses
from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError, nearest

SENSES = {"right-handed": 1.0, "left-handed": -1.0, "plane": 0.0}
TOWARDS = {"b": 1.0, "a": -1.0, "both": 0.0}


class Lateral(NamedTuple):
    """A lateral mode of a line, ends included."""

    shape: np.ndarray  # (s + 1,), less the straight line between its ends, 1 where it is largest
    in_plane: float  # wx [rad/s]
    out_of_plane: float  # wy [rad/s]


def skiprope(
    state: LineState,
    strand: Strand,
    mass_a_kg: float,
    mass_b_kg: float,
    *,
    amplitude_m: float,
    phase_rad: float = 0.0,
    sense: str = "right-handed",
    mode: int = 1,
    gm_m3_s2: float = EARTH_GM_M3_S2,
) -> LineState:
    """A straight line's state with a mode laid over it, equation (1); nodes move, attachments do not.

    amplitude_m : largest deflection from the straight line [m]. phase_rad : p. mode : half waves, 1 to the number of nodes.
    sense : "right-handed", "left-handed" (about the direction down the line), or "plane": a swing through the angle p.

    Raises
    ------
    InputError : no such mode or sense, an amplitude that is none, or a line with no tension.
    """
    if sense not in SENSES:
        raise InputError(f'sense is "{sense}"; {nearest(str(sense), SENSES)}')
    if not (np.isfinite(amplitude_m) and amplitude_m >= 0.0 and np.isfinite(phase_rad)):
        raise InputError(f"amplitude_m must be zero or more and phase_rad finite; got {amplitude_m} m and {phase_rad} rad.")
    masses = point_masses(strand, mass_a_kg, mass_b_kg)
    lateral = lateral_mode(state, strand, masses, mode, gm_m3_s2)
    frame = frame_of(state, masses)
    cosine, sine = np.cos(phase_rad), np.sin(phase_rad)
    place = amplitude_m * np.array([cosine, sine, 0.0])
    speed = SENSES[sense] * amplitude_m * np.array([-lateral.in_plane * sine, lateral.out_of_plane * cosine, 0.0])
    shape = lateral.shape[:, None]
    return LineState(
        state.position_i + shape * (place @ frame.axes),
        state.velocity_i + shape * (speed @ frame.axes + place @ frame.rate),
    )


def pulse(
    state: LineState, strand: Strand, *, amplitude_m: float, middle: float = 0.5, width_m: float, towards: str = "both"
) -> LineState:
    """A straight line's state with a pulse (3) laid over it; attachments do not move.

    amplitude_m : largest displacement, positive towards B [m]. middle : s0 over the unstretched length, from A. width_m : b.
    towards : "b", "a", or "both": two halves that part.

    Raises
    ------
    InputError : a direction that is none, a width that is none, a pulse that folds the line, or a line without mass.
    """
    if towards not in TOWARDS:
        raise InputError(f'towards is "{towards}"; {nearest(str(towards), TOWARDS)}')
    if not (np.isfinite(amplitude_m) and np.isfinite(middle) and np.isfinite(width_m) and width_m > abs(amplitude_m)):
        raise InputError(f"width_m must be above amplitude_m = {amplitude_m} m, or the line would fold; got {width_m} m.")
    if not np.all(strand.linear_mass > 0.0):
        raise InputError("a pulse needs a line with mass: mass_per_length_kg_m is zero.")
    s = np.concatenate([[0.0], np.cumsum(strand.rest)])
    away = (s - middle * s[-1]) / width_m
    u = amplitude_m * np.exp(-(away**2))
    sound = np.sqrt(strand.stiffness / strand.linear_mass)
    at_points = np.concatenate([[sound[0]], 0.5 * (sound[1:] + sound[:-1]), [sound[-1]]])
    speed = TOWARDS[towards] * at_points * 2.0 * away / width_m * u
    u[[0, -1]], speed[[0, -1]] = 0.0, 0.0
    chord, chord_rate = state.position_i[-1] - state.position_i[0], state.velocity_i[-1] - state.velocity_i[0]
    length = np.linalg.norm(chord)
    e = chord / length
    turn = (chord_rate - e * (e @ chord_rate)) / length
    return LineState(state.position_i + u[:, None] * e, state.velocity_i + speed[:, None] * e + u[:, None] * turn)


def lateral_mode(state: LineState, strand: Strand, masses: np.ndarray, mode: int, gm_m3_s2: float = EARTH_GM_M3_S2) -> Lateral:
    """Mode `mode` of a straight line in the state `state`, equation (2); `masses` (s + 1,) [kg], bodies included."""
    from scipy.linalg import eigh_tridiagonal

    most = len(strand.rest) - 1
    if isinstance(mode, bool) or not isinstance(mode, int | np.integer) or not 1 <= mode <= most:
        raise InputError(f"mode must be a whole number from 1 to {most}, the number of nodes; got {mode!r}.")
    tension = rod_tension(state, masses, gm_m3_s2)
    if not tension.min() > 0.0:
        raise InputError("the line has no tension, so it has no skiprope: hang it nearer the vertical, or stretch it.")
    stiffness = tension / np.linalg.norm(np.diff(state.position_i, axis=0), axis=1)
    fall = gm_m3_s2 / np.linalg.norm(state.position_i, axis=1) ** 3
    diagonal = fall + (np.append(stiffness, 0.0) + np.append(0.0, stiffness)) / masses
    beside = -stiffness / np.sqrt(masses[1:] * masses[:-1])
    # below it lie the inclined orbit and the libration
    square, vector = eigh_tridiagonal(diagonal, beside, select="i", select_range=(mode + 1, mode + 1))
    shape = vector[:, 0] / np.sqrt(masses)
    along = np.linalg.norm(state.position_i - state.position_i[0], axis=1)
    shape = shape - shape[0] - (shape[-1] - shape[0]) * along / along[-1]
    centre = masses @ state.position_i / masses.sum()
    orbit = gm_m3_s2 / float(np.linalg.norm(centre)) ** 3
    shape = shape / shape[np.abs(shape).argmax()]
    return Lateral(shape, float(np.sqrt(square[0] - orbit)), float(np.sqrt(square[0])))


def frame_of(state: LineState, masses: np.ndarray) -> Frame:
    """Axes of the line between its ends, the upper being the one farther from the Earth."""
    share = masses / masses.sum()
    against_normal = np.cross(share @ state.velocity_i, share @ state.position_i)
    radius = np.linalg.norm(state.position_i, axis=1)
    lower, upper = (0, -1) if radius[0] <= radius[-1] else (-1, 0)
    chord, chord_rate = (part[lower] - part[upper] for part in state)
    return line_axes(chord, chord_rate, against_normal)
