"""Long series made short for drawing, without losing what the eye would see.

A line keeps the least and the greatest value of each bucket of samples, in their order, so that spikes survive; a cloud
keeps one point for each occupied cell of a grid as fine as the pixels. Both cost O(n).
"""

from __future__ import annotations

import numpy as np

LINE_BUCKETS = 700  # a figure is about 900 pixels wide; two points a bucket draw every column
GRID_COLUMNS, GRID_ROWS = 1400, 360


def envelope(x: np.ndarray, y: np.ndarray, buckets: int = LINE_BUCKETS) -> tuple[np.ndarray, np.ndarray]:
    """(m,), (m,) with m <= 2 buckets + 2: the ends, and the extremes of each bucket of the series y(x); x ascends."""
    n = len(x)
    if n <= 2 * buckets + 2:
        return x, y
    size = -(-n // buckets)
    filled = n // size * size
    blocks = y[:filled].reshape(-1, size)
    start = np.arange(0, filled, size)
    low = start + np.argmin(np.where(np.isnan(blocks), np.inf, blocks), axis=1)
    high = start + np.argmax(np.where(np.isnan(blocks), -np.inf, blocks), axis=1)
    rest = y[filled:]
    ends = [0, n - 1]
    if len(rest):
        ends += [filled + int(np.argmin(np.where(np.isnan(rest), np.inf, rest)))]
        ends += [filled + int(np.argmax(np.where(np.isnan(rest), -np.inf, rest)))]
    keep = np.unique(np.concatenate([low, high, np.asarray(ends)]))
    return x[keep], y[keep]


def band(x: np.ndarray, low: np.ndarray, high: np.ndarray, buckets: int = LINE_BUCKETS) -> tuple[np.ndarray, ...]:
    """(m,), (m,), (m,): the hull of the band low..high, one value for each bucket at the bucket's middle."""
    n = len(x)
    if n <= 2 * buckets:
        return x, low, high
    size = -(-n // buckets)
    starts = np.arange(0, n, size)
    middle = np.minimum(starts + size // 2, n - 1)
    return x[middle], np.fmin.reduceat(low, starts), np.fmax.reduceat(high, starts)


def with_gaps(x: np.ndarray, y: np.ndarray, widest: float) -> tuple[np.ndarray, np.ndarray]:
    """The series with a NaN inside each gap wider than `widest`, so that no line is drawn over missing data."""
    after = np.flatnonzero(np.diff(x) > widest)
    if not len(after):
        return x, y
    return np.insert(x, after + 1, x[after]), np.insert(y, after + 1, np.nan)


def cloud(x: np.ndarray, y: np.ndarray, columns: int = GRID_COLUMNS, rows: int = GRID_ROWS) -> np.ndarray:
    """Indices of a subset of points that covers the same cells of a columns x rows grid; NaN points are left out."""
    finite = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
    if len(finite) <= columns * 2:
        return finite
    cell = _cells(x[finite], columns) * rows + _cells(y[finite], rows)
    last = np.full(columns * rows, -1)
    last[cell] = finite
    return np.sort(last[last >= 0])


def _cells(values: np.ndarray, count: int) -> np.ndarray:
    """The cell number 0..count-1 of each value between the least and the greatest."""
    low, high = values.min(), values.max()
    if high <= low:
        return np.zeros(len(values), dtype=int)
    return np.minimum(((values - low) * (count / (high - low))).astype(int), count - 1)
