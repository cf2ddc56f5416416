"""The strokes that every figure is drawn with: a line, a band, a cloud of points, each made short first."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.report.decimation import LINE_BUCKETS, band, cloud, envelope, with_gaps


def line(
    axes: Any,
    x: np.ndarray,
    y: np.ndarray,
    colour: str,
    label: str | None = None,
    *,
    gap: float = np.inf,
    width: float = 1.0,
    dashed: bool = False,
) -> None:
    """A line through y(x), broken over gaps wider than `gap`, that keeps the extremes of each pixel column."""
    short = len(x)
    x, y = envelope(x, y)
    if np.isfinite(gap):
        coarser = 2.5 * (x[-1] - x[0]) / LINE_BUCKETS if len(x) < short else 0.0
        x, y = with_gaps(x, y, max(gap, coarser))
    axes.plot(x, y, color=colour, label=label, linewidth=width, linestyle=(0, (4, 2.5)) if dashed else "-")


def points(axes: Any, x: np.ndarray, y: np.ndarray, colour: str, label: str | None = None, *, size: float = 0.0) -> None:
    """A cloud of points, the smaller the more there are, drawn as pixels inside the SVG where there are many."""
    keep = cloud(x, y)
    dots = {"linestyle": "none", "marker": ".", "markersize": size or dot_size(len(keep)), "markeredgewidth": 0.0}
    axes.plot(x[keep], y[keep], color=colour, label=label, rasterized=len(keep) > 500, **dots)


def dot_size(count: int) -> float:
    """Points in print: 5 for a few dozen down to 2 for thousands."""
    return float(np.clip(9.0 - 2.0 * np.log10(max(count, 1)), 2.2, 5.0))


def spread(
    axes: Any, x: np.ndarray, middle: np.ndarray, std: np.ndarray, colour: str, label: str | None = None, *, gap: float = np.inf
) -> None:
    """The band of one sigma about a middle, broken over gaps wider than `gap`."""
    short, low, high = band(x, middle - std, middle + std)
    widest = max(gap, 2.5 * (x[-1] - x[0]) / LINE_BUCKETS if len(short) < len(x) else 0.0)
    whole, low = with_gaps(short, low, widest)
    axes.fill_between(whole, low, with_gaps(short, high, widest)[1], color=colour, label=label, alpha=0.25, linewidth=0)


def legend(axes: Any, columns: int = 6) -> None:
    """A legend in one row above the axes, on the right, where it hides no data; its dots large enough to see."""
    shown = axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.995), ncols=columns)
    for handle in shown.legend_handles:
        if getattr(handle, "get_marker", lambda: "")() == ".":
            handle.set_markersize(7.0)


def room(values: np.ndarray, *, least: float = 0.0, share: float = 0.08, tails: float = 0.0) -> tuple[float, float]:
    """Limits that hold the values (but for a share `tails` at each end) with a margin, at least `least` high."""
    finite = values[np.isfinite(values)]
    if not len(finite):
        return -1.0, 1.0
    low, high = np.quantile(finite, [tails, 1 - tails]) if tails else (finite.min(), finite.max())
    margin = max(share * (high - low), 0.5 * (least - (high - low)), 1e-12 + 1e-6 * abs(high))
    return float(low - margin), float(high + margin)
