"""Figures of what the estimate leaves: residuals over time, their spectrum and memory, and the filter's own consistency."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.report.record import Record
from fieldline.report.series import legend, line, points, room
from fieldline.report.spectra import autocorrelation, gridded, smoothed, spectrum
from fieldline.report.theme import AXES, AXIS_COLOURS, GREY, INK, Picture, label_outer, panels

NANOTESLA = 1e9
NIS_BLOCKS = 60  # means over a sixtieth of the arc


def residual_picture(record: Record) -> Picture:
    """Measured less predicted field per axis; samples that were set aside are crosses."""
    residual = record.values("residual_b", NANOTESLA)
    used = record.used
    figure, axes = panels(3, 1, height_in=4.6, row_gap=0.14)
    for k, one in enumerate(axes[:, 0]):
        points(one, record.time[used], residual[used, k], AXIS_COLOURS[k])
        points(one, record.time[~used], residual[~used, k], INK, "not used", size=4.0)
        one.axhline(0.0, color=INK, linewidth=0.8)
        one.set_ylim(room(residual[used, k], tails=0.0005, share=0.25, least=1.0))
        one.set_xlim(record.time[0], record.time[-1])
        one.set_ylabel(f"r{AXES[k]}  [nT]")
    if not used.all():
        legend(axes[0, 0])
    label_outer(axes, (record.clock.label,))
    rms = np.sqrt(np.nanmean(residual[used] ** 2, axis=0))
    return Picture(
        "residuals",
        "Residuals",
        "Measured less predicted. A patternless scatter about zero is what a good estimate leaves; waves and steps are "
        "something that the model does not know.",
        f"Residuals of the three axes over time, RMS {rms[0]:.0f}, {rms[1]:.0f} and {rms[2]:.0f} nanotesla.",
        figure,
    )


def whiteness_picture(record: Record) -> Picture:
    """Spectrum and autocorrelation of the filter's innovations, and their squares against what the filter expects."""
    name, what = ("innovation_b", "innovations") if record.has("innovation_b") else ("residual_b", "residuals")
    values = record.values(name)
    good = record.used & np.isfinite(values).all(axis=1)
    if good.sum() < 2:
        good = np.ones(len(values), dtype=bool)
    grid = gridded(record.seconds[good], np.nan_to_num(values[good]), record.step_s)
    lags = int(min(200, max(len(grid) // 4, 2)))
    figure, axes = panels(1, 3, height_in=2.9, column_gap=0.24)
    _draw_spectrum(axes[0, 0], grid, record.step_s)
    _draw_memory(axes[0, 1], autocorrelation(grid, lags), record.step_s, int(good.sum()))
    _draw_nis(axes[0, 2], record)
    words = record.verdict.get("consistency", {}).get("words", "")
    return Picture(
        "whiteness",
        f"Are the {what} white?",
        f"Innovations are measurements less what the filter foretold. Left and middle, {what}: a peak, or lines outside the "
        "dashed bounds, is a signal that the model does not know. Right: above the dashed line the filter is too sure of "
        "itself, below it too timid." + (f" In words: {words}." if words else ""),
        f"Spectrum and autocorrelation of the {what}, and the mean of the normalised innovations squared. {words}",
        figure,
    )


def _draw_spectrum(axes: Any, grid: np.ndarray, step_s: float) -> None:
    """Spectra relative to white noise, both axes logarithmic."""
    frequency, power = smoothed(*spectrum(grid, step_s))
    for k in range(3):
        axes.plot(1e3 * frequency, power[:, k], color=AXIS_COLOURS[k], label=AXES[k], linewidth=1.0)
    axes.axhline(1.0, color=INK, linewidth=0.8, linestyle=(0, (4, 2.5)))
    axes.set_xscale("log")
    axes.set_yscale("log")
    low, high = min(0.2, max(0.8 * float(np.min(power)), 1e-3)), max(5.0, 1.3 * float(np.max(power)))
    axes.set_ylim(low, high)
    axes.set_yticks([m * 10.0**k for k in range(-3, 7) for m in (1, 3) if low < m * 10.0**k < high])
    for one in (axes.xaxis, axes.yaxis):
        one.set_major_formatter(lambda value, _: f"{value:g}")
        one.set_minor_formatter(lambda value, _: "")
    axes.set_xlabel("frequency [mHz]")
    axes.set_title("spectrum")
    legend(axes)


def _draw_memory(axes: Any, memory: np.ndarray, step_s: float, count: int) -> None:
    """Correlation with itself against the lag, with the bounds of white noise."""
    lag = step_s * np.arange(1, len(memory) + 1)
    for k in range(3):
        axes.plot(lag, memory[:, k], color=AXIS_COLOURS[k], linewidth=0.8)
    for bound in (-2.0, 2.0):
        axes.axhline(bound / np.sqrt(count), color=INK, linewidth=0.8, linestyle=(0, (4, 2.5)))
    reach = 1.15 * max(float(np.max(np.abs(memory))), 4.0 / np.sqrt(count))
    axes.set_ylim(-reach, reach)
    axes.set_xlabel("lag [s]")
    axes.set_title("autocorrelation")


def _draw_nis(axes: Any, record: Record) -> None:
    """Means of the normalised innovation squared per axis over blocks of the arc; its expectation is 1."""
    nis = record.values("nis")
    known = np.isfinite(nis) & record.used
    time, nis = record.time[known], nis[known]
    size = max(len(nis) // NIS_BLOCKS, 1)
    blocks = len(nis) // size
    means = nis[: blocks * size].reshape(blocks, size).mean(axis=1)
    middle = time[: blocks * size].reshape(blocks, size).mean(axis=1)
    line(axes, middle, means, AXIS_COLOURS[0], gap=np.inf)
    half = 2.0 * np.sqrt(2.0 / (3.0 * size))
    axes.axhspan(max(1.0 - half, 0.0), 1.0 + half, color=GREY, alpha=0.2, linewidth=0)
    axes.axhline(1.0, color=INK, linewidth=0.8, linestyle=(0, (4, 2.5)))
    if len(means):
        axes.set_ylim(0.0, max(1.15 * float(np.max(means)), 2.0))
    axes.set_xlim(record.time[0], record.time[-1])
    axes.set_xlabel(record.clock.label)
    axes.set_title("innovations², over expected")
