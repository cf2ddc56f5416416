"""The rules of TP-3123 (`tuning`, `reading`, `position`), carried to rows in time.

The rules take the known azimuth for true, so the phasors are along (U, V) where the field is right. With a measured yaw and
the corrected rule, what the known azimuth is off by is read from the measured field, averaged over four periods, and taken
off: then they are along the body's axes.

Amplitude and plane at a time are those of the cycles about it. Both deviations are of a single cycle, as the ellipse and the
field's turning do not average out.
"""

from __future__ import annotations

import numpy as np

from fieldline.errors import NoEstimateError
from fieldline.estimation.skiprope.bandpass import bandpass, group_delay_s, settling_time_s
from fieldline.estimation.skiprope.position import tilt_azimuth
from fieldline.estimation.skiprope.reading import read_cone
from fieldline.estimation.skiprope.signals import FieldGeometry, SkipropeSignals
from fieldline.estimation.skiprope.track import Track
from fieldline.estimation.skiprope.tuning import tune

READ_PER_PERIOD = 64
AVERAGED_PERIODS = 4.0
LONGEST_HOLD_PERIODS = 0.5
STEEPEST_RAD = np.radians(75.0)  # of the field: C3 is four times its noise there, and without bounds beyond


def bandpass_track(signals: SkipropeSignals, rows, settings) -> Track:
    """Phasors at times `rows` (m,) [s]; see `estimate.Settings`."""
    coarse = signals.thinned(1.0 / (READ_PER_PERIOD * settings.frequency_hz))
    hold = LONGEST_HOLD_PERIODS / settings.frequency_hz
    try:
        tuning = tune(
            coarse.seconds,
            coarse.corrected,
            settings.frequency_hz,
            settings.damping,
            method="linear",
            longest_hold_s=hold,
        )
    except NoEstimateError as error:
        raise NoEstimateError(f"{error} The harmonic method needs no settling.") from error
    tuned = tuning.frequency_hz
    filtered = bandpass(signals.seconds, signals.corrected, tuned, settings.damping, method="linear", longest_hold_s=hold)
    times, outputs, geometry = _every(signals, filtered, 1.0 / (READ_PER_PERIOD * tuned))
    delay = float(group_delay_s(tuned, tuned, settings.damping)) if settings.rule == "corrected" else 0.0
    reading = read_cone(
        times,
        outputs,
        geometry,
        tuned,
        damping=settings.damping,
        knowledge=settings.knowledge,
        azimuth_delay_s=delay,
    )
    settled = times[0] + settling_time_s(tuned, settings.damping)
    off = _azimuth_off(coarse, rows, AVERAGED_PERIODS / tuned)
    body = settings.yaw_measured and settings.rule == "corrected"
    amplitude = np.interp(rows, reading.maximum_s, reading.cycle_amplitude_rad)
    amplitude_std = np.interp(rows, reading.maximum_s, reading.cycle_amplitude_std_rad)
    if reading.sense:
        tilt = tilt_azimuth(reading, rows)
        phase, phase_std = tilt.azimuth_rad + np.pi, np.sqrt(np.maximum(tilt.std_rad**2 - settings.knowledge.azimuth_rad**2, 0.0))
    else:
        phase, phase_std = 2.0 * np.pi * abs(reading.frequency_hz) * (rows - reading.maximum_s[0]), np.full(len(rows), np.pi)
    phase = phase - off if body else phase
    turning = np.exp((-1j if reading.sense < 0 else 1j) * phase)
    phasor = amplitude[:, None] * turning[:, None] * np.array([1.0, 1j if reading.sense < 0 else -1j])
    notes = () if tuning.converged else ("retuning did not settle: the filter's phase at what was read stayed above 3 deg.",)
    if settings.yaw_measured and not body:
        notes += ('a measured yaw is used by the paper\'s rule only to correct the signals; rule "corrected" uses all of it.',)
    steepest = float(np.abs(signals.geometry.elevation_rad).max())
    if steepest > STEEPEST_RAD:
        settled = np.inf
        notes += (
            f"the field stands up to {np.degrees(steepest):.0f} deg above the horizon: the rules divide by its cosine, and "
            "none of their rows is trusted; use the harmonic method.",
        )
    return Track(
        phasor,
        _covariance(phasor, amplitude_std, amplitude * phase_std),
        np.full(len(rows), abs(reading.frequency_hz)),
        np.full(len(rows), reading.frequency_std_hz),
        np.full(len(rows), reading.sense),
        off,
        body,
        settled,
        notes,
    )


def _covariance(phasor, radial_std, tangential_std) -> np.ndarray:
    """(m, 4, 4) of a round cone whose amplitude and phase are uncertain alone."""
    size = np.abs(phasor[:, :1])
    unit = phasor / np.maximum(size, 1e-300)
    along = np.stack([unit[:, 0].real, unit[:, 0].imag, unit[:, 1].real, unit[:, 1].imag], axis=1)
    across = np.stack([-unit[:, 0].imag, unit[:, 0].real, -unit[:, 1].imag, unit[:, 1].real], axis=1)
    radial, tangential = ((std**2)[:, None, None] for std in (radial_std, tangential_std))
    return radial * along[:, :, None] * along[:, None, :] + tangential * across[:, :, None] * across[:, None, :]


def _every(signals: SkipropeSignals, filtered, step_s: float) -> tuple[np.ndarray, np.ndarray, FieldGeometry]:
    """Every so many rows of the filters' outputs, which are smooth."""
    each = max(int(step_s / signals.step_s), 1)
    return signals.seconds[::each], filtered[::each], FieldGeometry(*(x[::each] for x in signals.geometry))


def _azimuth_off(signals: SkipropeSignals, rows, width_s: float) -> np.ndarray:
    """(m,) known azimuth less the measured one [rad], averaged over `width_s` about each row."""
    measured = np.arctan2(-signals.direction_b[:, 0], signals.direction_b[:, 1])
    off = np.unwrap(signals.geometry.azimuth_rad - measured)
    off -= 2.0 * np.pi * np.round(np.median(off) / (2.0 * np.pi))
    total = np.concatenate([[0.0], np.cumsum(off)])
    first = np.searchsorted(signals.seconds, rows - 0.5 * width_s)
    last = np.maximum(np.searchsorted(signals.seconds, rows + 0.5 * width_s), first + 1)
    last = np.minimum(last, len(off))
    first = np.minimum(first, last - 1)
    return (total[last] - total[first]) / (last - first)
