"""Least squares in windows (`harmonic`), carried to rows in time, with deviations that the windows' own scatter confirms.

The covariance of a window knows its residual alone. What the known field does within a window that is neither slow nor noise
shows in how windows differ from their smoothed mean: where chi-squared of those differences exceeds its expectation, all
covariances grow by the ratio.
"""

from __future__ import annotations

import numpy as np

from fieldline.estimation.skiprope.harmonic import (
    MEMORY_PERIODS,
    WINDOW_PERIODS,
    HarmonicCone,
    fit_harmonics,
    refined_frequency,
    smoothed,
    turns,
)
from fieldline.estimation.skiprope.signals import SkipropeSignals
from fieldline.estimation.skiprope.solution import circular
from fieldline.estimation.skiprope.track import Track

TURN = 2.0 * np.pi
FEWEST_SAMPLES = 60  # of a window: three times the unknowns
SAMPLES_PER_PERIOD = 24  # of the fastest motion fitted; takes 0.3 % off its amplitude and nothing off the cone's
ROUNDS = 3  # the second leaves errors of 2 deg in the known field times 3 deg of swing in the amplitude
UNEVEN = "the phases of the windows do not advance evenly: from {:.4g} mHz the frequency ran to {:.4g} mHz, and was not followed."
STEEP_RAD = np.radians(60.0)  # above which the field's azimuth says less and less
NEAR_LINE = 0.25  # of a line's width: the spectrum's top is surely nearer than this to the frequency
SURE_SENSE = 2.0  # standard deviations by which the two turning parts must differ


def harmonic_track(signals: SkipropeSignals, rows, settings) -> Track:
    """Phasors at times `rows` (m,) [s]; see `estimate.Settings`."""
    fastest = max((settings.frequency_hz, *settings.pendulous_hz))
    thin = signals.thinned(1.0 / (SAMPLES_PER_PERIOD * fastest))
    frequency, notes = settings.frequency_hz, ()
    for _ in range(3):
        cone = _fitted(thin, frequency, settings.pendulous_hz)
        refined = refined_frequency(cone)
        if abs(refined - settings.frequency_hz) > NEAR_LINE * settings.resolution_hz:
            notes = (UNEVEN.format(1e3 * settings.frequency_hz, 1e3 * refined),)
            break  # the phases say less than the spectrum: turns were lost between windows
        frequency = refined
    memory = MEMORY_PERIODS / frequency if settings.memory_s is None else settings.memory_s
    final = smoothed(cone, memory) if memory > 0.0 else cone
    excess = _excess(cone, final) if memory > 0.0 else 1.0
    phasor, covariance = carried(final, rows)
    covariance = covariance * excess
    parts = np.abs(circular(phasor))
    spread = np.sqrt(np.trace(covariance, axis1=1, axis2=2) / 4.0)
    sense = np.where(np.abs(parts[:, 0] - parts[:, 1]) > SURE_SENSE * spread, np.sign(parts[:, 0] - parts[:, 1]), 0.0)
    near = np.exp(-0.5 * ((rows[:, None] - cone.middle_s) / max(memory, cone.window_s)) ** 2)
    near = near * level_share(np.interp(cone.middle_s, thin.seconds, thin.geometry.elevation_rad))
    azimuth_off = near @ cone.azimuth_off_rad / near.sum(axis=1)
    deviation = np.full(len(rows), frequency_deviation(cone))
    return Track(
        phasor,
        covariance,
        np.full(len(rows), cone.frequency_hz),
        deviation,
        sense.astype(int),
        azimuth_off,
        True,
        signals.seconds[0] + cone.window_s,
        notes,
    )


def level_share(elevation_rad) -> np.ndarray:
    """Weight of the field's azimuth at elevations: one below 60 deg, none where it is vertical and has no azimuth."""
    return np.minimum((np.cos(elevation_rad) / np.cos(STEEP_RAD)) ** 2, 1.0) + 1e-9


def _fitted(signals: SkipropeSignals, frequency_hz: float, others) -> HarmonicCone:
    """Windows of three periods, longer where samples are few or another motion is near, at most the record."""
    apart = min((abs(other - frequency_hz) for other in others), default=np.inf)
    window = max(WINDOW_PERIODS / frequency_hz, 2.0 / apart, FEWEST_SAMPLES * signals.step_s)
    window = min(window, signals.span_s)
    return fit_harmonics(
        signals.seconds,
        signals.field_b,
        signals.geometry,
        frequency_hz,
        window_s=window,
        step_s=window / (2.0 * WINDOW_PERIODS),
        other_lines_hz=others,
        rounds=ROUNDS,
    )


def carried(cone: HarmonicCone, rows) -> tuple[np.ndarray, np.ndarray]:
    """Phasors (m, 2) and covariances (m, 4, 4) at times (m,): mixed between two windows, carried on outside."""
    w = TURN * cone.frequency_hz
    frame = np.exp(1j * w * (cone.middle_s - cone.middle_s[0]))
    still = cone.phasor / frame[:, None]
    back, on = turns(1.0 / frame), np.exp(1j * w * (rows - cone.middle_s[0]))
    spread = (back @ cone.covariance @ back.transpose(0, 2, 1)).reshape(-1, 16)
    now = [np.interp(rows, cone.middle_s, z.real) + 1j * np.interp(rows, cone.middle_s, z.imag) for z in still.T]
    spread = np.stack([np.interp(rows, cone.middle_s, column) for column in spread.T], axis=1).reshape(-1, 4, 4)
    turn = turns(on)
    return np.stack(now, axis=1) * on[:, None], turn @ spread @ turn.transpose(0, 2, 1)


def frequency_deviation(cone: HarmonicCone) -> float:
    """[Hz] of `refined_frequency`: the phases' scatter about their line, over windows that share no samples."""
    parts = circular(cone.phasor)
    main = parts[:, int(np.abs(parts).mean(axis=0).argmax())]
    phase = np.unwrap(np.angle(main * np.exp(-1j * TURN * cone.frequency_hz * (cone.middle_s - cone.middle_s[0]))))
    spread = np.sqrt(np.trace(cone.covariance, axis1=1, axis2=2) / 8.0) / np.abs(main)
    span = np.ptp(cone.middle_s) + cone.window_s
    if len(phase) < 4:
        return float(spread.mean() * np.sqrt(12.0) / (TURN * span))
    left = phase - np.polyval(np.polyfit(cone.middle_s - cone.middle_s[0], phase, 1), cone.middle_s - cone.middle_s[0])
    apart = max(span / cone.window_s, 1.0)
    return float(np.hypot(left.std(ddof=2), np.sqrt(np.mean(spread**2))) * np.sqrt(12.0 / apart) / (TURN * span))


def _excess(cone: HarmonicCone, smooth: HarmonicCone) -> float:
    """Chi-squared of the windows about their smoothed mean, over its expectation; at least 1."""
    off = cone.phasor - smooth.phasor
    off = np.stack([off[:, 0].real, off[:, 0].imag, off[:, 1].real, off[:, 1].imag], axis=1)
    chi2 = np.einsum("mi,mij,mj->m", off, np.linalg.inv(cone.covariance), off)
    return max(float(np.median(chi2)) / 3.357, 1.0)
