"""The verdict and the notes, in words."""

from __future__ import annotations

import numpy as np

from fieldline.estimation.skiprope.lines import NEAR, close_to
from fieldline.estimation.skiprope.rotary import LEAST_TURNING, Detection, Line
from fieldline.estimation.skiprope.signals import SkipropeSignals
from fieldline.estimation.skiprope.track import Track

WORTH_A_NOTE_RAD = np.radians(12.0)
PENDULOUS_HZ = (0.02, 0.1)
FEW_PERIODS = 5.0
WORTH_TELLING = 0.05  # of the strongest line
SENSES = {1: "from the orbit's normal towards the rear", -1: "from the orbit's normal towards the front", 0: "either way"}


def none_of(found: Detection, given_hz: float | None) -> str:
    """The verdict where there is no skiprope, near a given frequency if there is one: what would have been seen."""
    where = "in the band" if given_hz is None else f"within a factor of two of {1e3 * given_hz:.4g} mHz turns and"
    reach = np.degrees(np.median(found.threshold_rad[1:])) if len(found.threshold_rad) > 1 else np.nan
    return (
        f"no skiprope: nothing {where} stands out of the noise; a round cone of {reach:.2g} deg would have "
        f"(false-alarm probability {found.false_alarm:g})."
    )


def verdict_of(numbers: dict, track: Track, trusted) -> str:
    """One sentence that a person reads first."""
    rows = trusted if trusted.any() else np.ones(len(trusted), dtype=bool)
    amplitude = np.degrees(np.median(numbers["amplitude_rad"][rows]))
    std = np.degrees(np.median(numbers["amplitude_std_rad"][rows]))
    plane = np.degrees(np.median(numbers["plane_std_rad"][rows]))
    deflection = np.median(numbers["deflection_m"][rows])
    turn = int(np.sign(np.sum(track.sense[rows])))
    text = (
        f"skiprope: {amplitude:.3g} +- {std:.2g} deg at {1e3 * track.frequency_hz[-1]:.4g} mHz, {deflection:.3g} m at the "
        f"middle, turning {SENSES[turn]}, plane known to {plane:.2g} deg"
    )
    return text + ("." if trusted.any() else "; not to be trusted yet.")


def notes_of(
    signals: SkipropeSignals, found: Detection, line: Line | None, off_rad: float, turn_std, given_hz: float | None
) -> tuple[str, ...]:
    """What a person should know besides; given_hz: a first frequency that was given."""
    notes = []
    largest = max((one.amplitude_rad for one in found.lines), default=0.0)
    for other in found.others:
        if other.amplitude_rad < WORTH_TELLING * largest:
            continue
        swings = "turns" if abs(other.turning) >= LEAST_TURNING else "swings"
        notes.append(
            f"another motion {swings} at {1e3 * other.frequency_hz:.4g} mHz with {np.degrees(other.amplitude_rad):.2g} deg."
        )
    notes += _not_as_given(found, line, given_hz)
    if line is None:
        return tuple(notes)
    if abs(line.turning) < LEAST_TURNING:
        notes.append("the motion swings in a plane rather than turns: its sense is weakly known, and it may be a pendulum's.")
    for other in close_to(found, line):
        notes.append(
            f"the motion at {1e3 * other.frequency_hz:.4g} mHz is within a factor of three of the skiprope's frequency: the "
            "bandpass lets it through, the harmonic fit and the Kalman filter carry it as a motion of its own."
        )
    if signals.span_s * line.frequency_hz < FEW_PERIODS:
        notes.append(f"the record holds only {signals.span_s * line.frequency_hz:.1f} periods.")
    sampling = 1.0 / signals.step_s
    for alias in (sampling - line.frequency_hz, sampling + line.frequency_hz):
        if PENDULOUS_HZ[0] <= alias <= PENDULOUS_HZ[1]:
            notes.append(
                f"with samples every {signals.step_s:.3g} s a motion at {1e3 * alias:.4g} mHz (the pendulous one?) would look "
                "the same."
            )
    if signals.longest_gap_s > 0.5 / line.frequency_hz:
        notes.append(f"the longest gap, {signals.longest_gap_s:.0f} s, is more than half a period.")
    if off_rad > WORTH_A_NOTE_RAD:
        notes.append(
            f"the measured field lies {np.degrees(off_rad):.0f} deg off the known one (median): yaw, or a wrong orbit or time."
        )
    notes.append(
        "yaw and azimuth error of the known field cannot be told apart by a magnetometer: "
        f"{np.degrees(np.median(turn_std)):.2g} deg of the plane's deviation are theirs."
    )
    return tuple(notes)


def _not_as_given(found: Detection, line: Line | None, given_hz: float | None) -> tuple[str, ...]:
    """That the skiprope is elsewhere than where a first frequency said, or may be."""
    if given_hz is None:
        return ()
    if line is None:
        turning = [one for one in found.others if abs(one.turning) >= LEAST_TURNING]
        if not turning:
            return ()
        return (f"give --frequency-hz {turning[0].frequency_hz:.3g}, or none, if what turns there is the skiprope.",)
    if abs(line.frequency_hz / given_hz - 1.0) <= NEAR:
        return ()
    return (
        f"nothing stands out within {100 * NEAR:.0f} % of the {1e3 * given_hz:.4g} mHz that were given; what turns at "
        f"{1e3 * line.frequency_hz:.4g} mHz is taken for the skiprope.",
    )
