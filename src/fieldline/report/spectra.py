"""Spectrum and autocorrelation of residuals, scaled so that white noise is flat at one and zero.

    S_k = mean over blocks |FFT(w r)|^2 / (sum w^2 var r)          (1)  Welch (1967), Hann window, blocks half overlapped
    rho_m = sum_k r_k r_{k+m} / sum_k r_k^2,  |rho_m| < 2 / sqrt(n) for white noise, 19 times of 20          (2)

Samples stand on the grid of the median step; missing ones count as zero, which leaves white noise white.
"""

from __future__ import annotations

import numpy as np

BLOCK = 1024  # at most; shorter on short arcs, so that some eight blocks are averaged
CELLS_PER_SAMPLE = 4  # a record with more gap than this is not gridded


def gridded(seconds: np.ndarray, values: np.ndarray, step_s: float) -> np.ndarray:
    """(m, k) values, each column less its mean, on the uniform grid; zero where there is none; none if mostly gaps."""
    cell = np.rint((seconds - seconds[0]) / step_s).astype(int)
    if cell[-1] >= CELLS_PER_SAMPLE * len(cell) + BLOCK:
        cell = np.arange(len(cell))  # long silences: the order of samples stands in for time
    grid = np.zeros((cell[-1] + 1, values.shape[1]))
    grid[cell] = np.nan_to_num(values - np.nanmean(values, axis=0))
    return grid


def spectrum(grid: np.ndarray, step_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (f,) [Hz] without zero, and (f, k) spectra relative to white noise of the same variance (1)."""
    n = len(grid)
    size = min(BLOCK, max(1 << int(np.log2(max(n / 4.5, 1.0))), min(n, 32)))
    window = np.hanning(size + 2)[1:-1, None]
    starts = range(0, n - size + 1, max(size // 2, 1))
    power = sum(np.abs(np.fft.rfft(window * grid[s : s + size], axis=0)) ** 2 for s in starts) / len(starts)
    variance = np.maximum(np.mean(grid**2, axis=0), 1e-300)
    return np.fft.rfftfreq(size, step_s)[1:], power[1:] / (np.sum(window**2) * variance)


def smoothed(frequency: np.ndarray, power: np.ndarray, bands: int = 70) -> tuple[np.ndarray, np.ndarray]:
    """The spectrum averaged over bands of equal width in the logarithm of frequency; narrow bands keep their one line."""
    edge = np.geomspace(frequency[0], frequency[-1], bands + 1)
    start = np.unique(np.searchsorted(frequency, edge[:-1]))
    count = np.diff(np.append(start, len(frequency)))
    return np.add.reduceat(frequency, start) / count, np.add.reduceat(power, start, axis=0) / count[:, None]


def autocorrelation(grid: np.ndarray, lags: int) -> np.ndarray:
    """(lags, k) correlation with itself at 1..lags steps (2)."""
    size = 1 << int(np.ceil(np.log2(len(grid) + lags)))
    product = np.fft.irfft(np.abs(np.fft.rfft(grid, size, axis=0)) ** 2, size, axis=0)
    return product[1 : lags + 1] / np.maximum(product[0], 1e-300)
