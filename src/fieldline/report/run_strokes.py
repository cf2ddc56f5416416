"""What the figures of a run share: limits, shaded time axes, logarithmic sizes, means over slices."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fieldline.report.run_record import RunRecord
from fieldline.report.series import legend, line, room
from fieldline.report.theme import AXIS_COLOURS, FOURTH, GREY, INK, WARM

COLOURS = (*AXIS_COLOURS, FOURTH, WARM, INK, GREY)
SLICES = 160  # of a run, over each of which a root mean square is taken
FAR_BEYOND = 15.0  # ratio of the start to the rest from which on the scale follows the rest
WIDE_RANGE = 30.0  # ratio from which on a scale is logarithmic


def stroke(axes: Any, record: RunRecord, values: np.ndarray, k: int, label: str | None = None, **how: Any) -> None:
    """A signal over the outputs in colour k; beyond seven colours the line is dashed."""
    line(axes, record.time, values, COLOURS[k % len(COLOURS)], label, dashed=k >= len(COLOURS), **how)


def finish(axes: Any, record: RunRecord, title: str, unit: str, *, keyed: bool = True, columns: int = 6) -> None:
    """Title, unit and legend of a panel."""
    record.shade(axes)
    axes.set_title(title)
    axes.set_ylabel(f"[{unit}]" if unit else "")
    if axes.get_yscale() == "linear":
        axes.yaxis.set_major_formatter(_plain)
    if keyed:
        legend(axes, columns)


def _plain(value: float, _: object) -> str:
    """A tick's number without a power of ten beside the axis, and with a true minus."""
    return f"{value:.6g}".replace("-", "−") if abs(value) > 1e-12 else "0"


def smallest_on_top(axes: Any, values: np.ndarray) -> None:
    """Order the panel's signals, the columns of (n, m), so that the quiet ones are not hidden by the loud."""
    spread = np.nan_to_num(np.nanstd(values, axis=0))
    for rank, k in enumerate(np.argsort(-spread)):
        axes.lines[k].set_zorder(2.0 + 0.1 * rank)


def bounds(axes: Any, values: Sequence[float], reach: float) -> None:
    """Dashed lines at plus and minus each limit, where the signal comes near enough that they are worth the room."""
    for value in sorted({float(v) for v in values}):
        if reach > 0.1 * value:
            for sign in (-1.0, 1.0):
                axes.axhline(sign * value, color=GREY, linewidth=0.8, linestyle=(0, (4, 2.5)))


def sliced_rms(record: RunRecord, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(m,) middles [units of the clock] and (m,) root mean square of (n,) over slices of the run; all of it where short."""
    n = len(values)
    if n <= 2 * SLICES:
        return record.time, np.abs(values)
    edges = np.linspace(0, n, SLICES + 1).astype(int)
    middle = record.time[(edges[:-1] + edges[1:]) // 2]
    return middle, np.sqrt(np.add.reduceat(values**2, edges[:-1]) / np.diff(edges))


def slice_words(record: RunRecord) -> str:
    """For example: each over 5.3 min."""
    if len(record.seconds) <= 2 * SLICES:
        return "at each output"
    length = record.seconds[-1] / SLICES
    return f"RMS over {length / 60.0:.3g} min" if length >= 120.0 else f"RMS over {length:.3g} s"


def logarithmic(axes: Any, values: np.ndarray, decades: float = 6.0) -> None:
    """A logarithmic scale over at most so many decades, ticks where there is room, for positive values."""
    from matplotlib.ticker import LogLocator, NullLocator

    positive = values[np.isfinite(values) & (values > 0.0)]
    if not len(positive):
        return
    high = float(positive.max())
    low = max(float(positive.min()), high * 10.0**-decades)
    axes.set_yscale("log")
    axes.set_ylim(0.6 * low, 1.7 * high)
    narrow = axes.get_ylim()[1] / axes.get_ylim()[0] < 60.0
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if narrow else (1.0,), numticks=6))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")


def is_wide(values: np.ndarray) -> bool:
    """Whether positive values range over more than a linear scale shows."""
    positive = values[np.isfinite(values) & (values > 0.0)]
    return bool(len(positive)) and float(positive.max()) > WIDE_RANGE * max(float(np.median(positive)), 1e-300)


def fit_settled(axes: Any, values: np.ndarray, *, least: float = 0.0) -> str:
    """`fit`, to all but the first quarter where the start is far beyond the rest; words for the title that say so."""
    later = values[len(values) // 4 :]
    beyond = float(np.nanmax(np.abs(values))) > FAR_BEYOND * float(np.nanmax(np.abs(later)))
    fit(axes, later if beyond else values, least=least)
    return ", its start beyond the scale" if beyond else ""


def fit(axes: Any, values: np.ndarray, *, least: float = 0.0, tails: float = 0.0) -> None:
    """Vertical limits with a margin."""
    axes.set_ylim(room(np.ravel(values), least=least, share=0.12, tails=tails))
