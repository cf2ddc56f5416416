"""Retuning: a first guess at the frequency, then what the filter shows.

A filter tuned to f_n passes the cone's f with a phase of about (f_n - f) / (z f), 57 deg for 10 % at z = 0.1, so that the
guess decides what is read of the plane, but the period of what comes out is the cone's own whatever the phase. Each pass
reads that period and tunes the filter to it. It is enough when the filter's phase at the frequency just read falls below
`phase_tolerance_rad`: a further pass would change the plane by less than that. At 3 deg and z = 0.1 this asks the frequency
to half a per cent, which the crossings of a few cycles give; from guesses off by half either way two passes do.

The guess must be nearer the cone than any other line: one at 0.03 Hz finds the pendulous motion.

Source: Polites (1991), NASA TP-3123, section III, asks for two passes; the rule to stop is ours.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, NoEstimateError
from fieldline.estimation.skiprope.bandpass import as_series, bandpass, bandpass_response, positive, settling_time_s
from fieldline.estimation.skiprope.reading import frequency_of

PHASE_TOLERANCE_RAD = np.radians(3.0)


class Pass(NamedTuple):
    """One pass: the filter's frequency, what was read with its standard deviation [Hz], the filter's phase there [rad]."""

    filter_hz: float
    read_hz: float
    std_hz: float
    phase_rad: float


class Tuning(NamedTuple):
    """The frequency of the last filter [Hz], its outputs (n, 3) [rad], all passes, and whether the rule to stop was met."""

    frequency_hz: float
    filtered: np.ndarray
    passes: tuple[Pass, ...]
    converged: bool


def tune(
    seconds,
    corrected,
    first_frequency_hz: float,
    damping: float = 0.1,
    *,
    phase_tolerance_rad: float = PHASE_TOLERANCE_RAD,
    most_passes: int = 6,
    settle_s: float | None = None,
    method: str = "exact",
    longest_hold_s: float = np.inf,
) -> Tuning:
    """Filter corrected signals (n, 3) [rad] at times (n,) [s] until the filter is tuned to what it shows.

    `settle_s` is left out at the start of each pass, by default what 92 % settling of that pass's filter takes.
    `method` and `longest_hold_s` are those of `filter_bank`: "linear" where there are less than a hundred samples a period.

    Errors: InputError for arguments; NoEstimateError where a pass finds less than two periods.
    """
    times, rows = as_series(seconds, corrected)
    frequency = positive("first_frequency_hz", first_frequency_hz)
    if most_passes < 1:
        raise InputError(f"most_passes must be 1 or more; got {most_passes!r}.")
    passes: list[Pass] = []
    while True:
        filtered = bandpass(times, rows, frequency, damping, method=method, longest_hold_s=longest_hold_s)
        settle = settling_time_s(frequency, damping) if settle_s is None else settle_s
        kept = times >= times[0] + settle
        if kept.sum() < 4:
            raise NoEstimateError(
                f"the record is shorter than the {settle:.0f} s that a filter at {frequency:.4g} Hz settles in."
            )
        read, std, _ = frequency_of(times[kept], filtered[kept, 2], frequency)
        phase = float(np.angle(bandpass_response(read, frequency, damping)))
        passes.append(Pass(frequency, read, std, phase))
        if abs(phase) <= phase_tolerance_rad or len(passes) == most_passes:
            return Tuning(frequency, filtered, tuple(passes), abs(phase) <= phase_tolerance_rad)
        frequency = read
