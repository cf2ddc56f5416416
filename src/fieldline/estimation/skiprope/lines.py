"""Which line of the spectrum is the skiprope that was asked for, and which go beside it.

A first frequency is a guess: within a tenth of it the strongest line is taken, and that again within `NEAR`, a line that turns
before one that swings unless it is weak beside it; where there is none, the cone among the lines within `FAR`, which must turn
(the pendulous motion, which swings, is the stronger one from twice the skiprope's frequency on).

Every other motion whose frequency is near is in the windows of the harmonic fit and must have a part of its own there: left
out, it counts as noise, thirty times what the skiprope's own deviation is.
"""

from __future__ import annotations

from fieldline.estimation.skiprope.rotary import HIGHER_MODE, LEAST_TURNING, Detection, Line, cone_of

NEAREST, NEAR = 0.1, 0.3  # of a given frequency, in which its line is looked for
FAR = 2.0  # times a given frequency, or part of it, where nothing is near
CLOSE = 3.0  # times the cone's frequency: the bandpass then lets more than a quarter of another motion through
WORTH = 0.2  # of the cone's amplitude: of a close motion that matters
ABOVE = 2.0  # times the cone's frequency: any motion above is carried along
MOST = 2  # above, and as many close


def line_given(found: Detection, frequency_hz: float) -> Line | None:
    """The line that a first frequency means; None where none is within a factor of two."""
    for reach in (NEAREST, NEAR):
        near = [line for line in found.lines if abs(line.frequency_hz / frequency_hz - 1.0) <= reach]
        strongest = max((line.amplitude_rad for line in near), default=0.0)
        turning = [line for line in near if abs(line.turning) >= LEAST_TURNING and line.amplitude_rad > HIGHER_MODE * strongest]
        if near:
            return max(turning or near, key=lambda line: line.amplitude_rad)
    far = cone_of([line for line in found.lines if 1.0 / FAR <= line.frequency_hz / frequency_hz <= FAR])
    return far if far is not None and abs(far.turning) >= LEAST_TURNING else None


def close_to(found: Detection, line: Line) -> list[Line]:
    """The other motions within a factor of three of a line's frequency that are no small matter to it."""
    return [
        other
        for other in found.others
        if 1.0 / CLOSE < other.frequency_hz / line.frequency_hz < CLOSE and other.amplitude_rad > WORTH * line.amplitude_rad
    ]


def beside(found: Detection, line: Line) -> tuple[float, ...]:
    """[Hz] of the motions to be fitted beside a line, the strongest first: two above twice its frequency, two closer to it."""
    above = [other for other in found.others if other.frequency_hz > ABOVE * line.frequency_hz]
    close = [other for other in close_to(found, line) if other.frequency_hz <= ABOVE * line.frequency_hz]
    strongest = [other for kind in (above, close) for other in sorted(kind, key=lambda one: -one.amplitude_rad)[:MOST]]
    return tuple(other.frequency_hz for other in sorted(strongest, key=lambda one: -one.amplitude_rad))


def crowded(found: Detection, line: Line, carried_hz: float | None) -> tuple[float, ...]:
    """[Hz] of the motions close to a line that a filter which carries one other motion leaves out, and takes for the line's."""
    return tuple(other.frequency_hz for other in close_to(found, line) if other.frequency_hz != carried_hz)
