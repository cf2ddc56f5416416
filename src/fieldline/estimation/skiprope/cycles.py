"""Marks on a filtered signal: zero crossings, highest and lowest points, and a sine through each cycle.

A crossing counts once the signal has left a band about zero (a fifth of its RMS) on the other side, so that ripple on a
slope makes one crossing, not three; it lies where the last stretch between the bands meets zero. The highest point between
two crossings is what an eye reads off a plot. A sine over one period,

    y = y0 + Re(z exp(i w (t - t_m))),   t_m its middle                                                                (1)

uses every sample instead, and says by its misfit how far the eye could be led. z of several signals over the same cycle
are comparable in phase.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.estimation.skiprope.bandpass import as_series, positive

BAND = 0.2  # of the RMS


class Crossings(NamedTuple):
    """Times [s] where a signal goes through zero, (m,), and whether it rises there, (m,) bool, in turn."""

    seconds: np.ndarray
    rising: np.ndarray


class Cycles(NamedTuple):
    """m whole periods of k signals fitted by (1)."""

    middle_s: np.ndarray  # (m,) t_m
    phasor: np.ndarray  # (m, k) complex z, phase at t_m
    ripple: np.ndarray  # (m, k) RMS misfit


def zero_crossings(seconds, signal) -> Crossings:
    """Crossings of a signal (n,) at times (n,) [s], rising and falling in turn; none where it never leaves the band."""
    times, columns = as_series(seconds, signal)
    fine = np.isfinite(columns[:, 0])
    times, y = times[fine], columns[fine, 0]
    band = BAND * np.sqrt(np.mean(y * y)) if len(y) else 0.0
    outside = np.flatnonzero(np.abs(y) > band)
    changes = np.flatnonzero(np.diff(np.sign(y[outside])) != 0.0)
    found = np.empty(len(changes))
    for j, (first, last) in enumerate(zip(outside[changes], outside[changes + 1], strict=True)):
        found[j] = _mean_zero(times[first : last + 1], y[first : last + 1])
    return Crossings(found, y[outside[changes + 1]] > 0.0)


def extremes(seconds, signal, crossings: Crossings) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and values of the highest (after a rising crossing) or lowest point between crossings, each (m - 1,)."""
    times, columns = as_series(seconds, signal)
    edges = np.searchsorted(times, crossings.seconds)
    rows = []
    for first, last, rising in zip(edges[:-1], edges[1:], crossings.rising[:-1], strict=True):
        part = columns[first:last, 0]
        rows.append(first + int(np.nanargmax(part) if rising else np.nanargmin(part)))
    return times[rows], columns[rows, 0]


def fit_cycles(seconds, signals, frequency_hz: float) -> Cycles:
    """Equation (1) over each whole period of 1 / frequency_hz from the first sample on, for signals (n, k).

    Samples that are not finite are left out; a cycle with less than half of its samples, or with a gap of over a quarter of
    a period, is left out as a whole.
    """
    times, y = as_series(seconds, signals)
    period = 1.0 / positive("frequency_hz", frequency_hz)
    step = float(np.median(np.diff(times))) if len(times) > 1 else period
    count = int((times[-1] - times[0] + step) / period + 1e-9) if len(times) else 0
    middles, phasors, ripples = [], [], []
    for start in times[0] + period * np.arange(count) if count else ():
        first, last = np.searchsorted(times, (start - 1e-9, start + period - 1e-9))
        t, part = times[first:last], y[first:last]
        fine = np.isfinite(part).all(axis=1)
        t, part = t[fine], part[fine]
        inside = np.concatenate([[start], t, [start + period]])
        if len(t) < max(4, 0.5 * period / step) or np.diff(inside).max() > max(0.25 * period, 1.5 * step):
            continue
        middle = start + 0.5 * period
        phase = 2.0 * np.pi / period * (t - middle)
        basis = np.stack([np.ones_like(t), np.cos(phase), -np.sin(phase)], axis=1)
        weights = np.linalg.lstsq(basis, part, rcond=None)[0]
        middles.append(middle)
        phasors.append(weights[1] + 1j * weights[2])  # (1)
        ripples.append(np.sqrt(np.mean((part - basis @ weights) ** 2, axis=0)))
    width = y.shape[1]
    return Cycles(
        np.array(middles), np.array(phasors, dtype=complex).reshape(-1, width), np.array(ripples, dtype=float).reshape(-1, width)
    )


def _mean_zero(times, y) -> float:
    """The mean of the times at which the straight pieces through y meet zero."""
    above = y >= 0.0
    k = np.flatnonzero(above[1:] != above[:-1])
    return float(np.mean(times[k] - y[k] * (times[k + 1] - times[k]) / (y[k + 1] - y[k])))
