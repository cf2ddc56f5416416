"""The spectrum of a signal with gaps and uneven steps, and its strongest line.

Samples are averaged in bins of an eighth of the shortest period asked for (which takes less than 3 % off its amplitude),
missing bins count as zero, and a Hann window over the record keeps strong lines from hiding weak ones:

    A(f) = 2 |sum_k w_k y_k exp(-2 pi i f t_k)| / sum_k w_k,     the amplitude of a line at f                     (1)

on frequencies a quarter of the record's resolution apart.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import NoEstimateError
from fieldline.estimation.skiprope.bandpass import as_series, positive

BINS_PER_PERIOD = 8
FINENESS = 4  # frequencies per 1 / length
FEWEST_PERIODS = 2.0


class Spectrum(NamedTuple):
    """Frequencies (m,) [Hz] and amplitudes (m,), in the signal's unit."""

    frequency_hz: np.ndarray
    amplitude: np.ndarray


def spectrum(seconds, signal, highest_hz: float) -> Spectrum:
    """Equation (1) of a signal (n,) at times (n,) [s], less its mean, from zero to `highest_hz`."""
    times, columns = as_series(seconds, signal)
    fine = np.isfinite(columns[:, 0])
    times, y = times[fine], columns[fine, 0]
    if len(times) < 4:
        raise NoEstimateError(f"a spectrum needs at least 4 good samples; got {len(times)}.")
    width = max(1.0 / (BINS_PER_PERIOD * positive("highest_hz", highest_hz)), float(np.median(np.diff(times))))
    bins = ((times - times[0]) / width + 1e-6).astype(int)
    count = np.bincount(bins)
    share = 0.5 - 0.5 * np.cos(2.0 * np.pi * (np.arange(len(count)) + 0.5) / len(count))
    weight = np.where(count > 0, share, 0.0)
    mean = np.bincount(bins, y) / np.maximum(count, 1)
    mean = mean - np.average(mean, weights=weight)
    size = 1 << int(np.ceil(np.log2(FINENESS * len(count))))
    amplitude = 2.0 * np.abs(np.fft.rfft(weight * mean, size)) / weight.sum()
    frequency = np.arange(len(amplitude)) / (size * width)
    kept = frequency <= highest_hz
    return Spectrum(frequency[kept], amplitude[kept])


def strongest_line(seconds, signal, lowest_hz: float, highest_hz: float) -> float:
    """[Hz] of the highest point of (1) between two frequencies, of which the record holds at least two periods."""
    found = spectrum(seconds, signal, highest_hz)
    span = float(seconds[-1] - seconds[0])
    inside = found.frequency_hz >= max(lowest_hz, FEWEST_PERIODS / span * (1.0 - 1e-9))
    if not inside.any():
        raise NoEstimateError(
            f"{span:.0f} s hold less than two periods of anything below {highest_hz:.4g} Hz; give a longer record, or a "
            "filter frequency nearer the cone's."
        )
    return float(found.frequency_hz[inside][found.amplitude[inside].argmax()])
