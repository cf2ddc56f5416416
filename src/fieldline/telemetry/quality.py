"""Faults of the samples themselves: missing, frozen, held, saturated and wild values of the magnetometer.

Every rule compares a sample with what this file does elsewhere, as nothing is known of the satellite: an Earth-pointing
one with a coarse magnetometer repeats its values for minutes, a spinner jumps by half the field at every sample.

- stuck: a value repeats although windows of that length move, in 99 of 100 cases elsewhere in the file, by over five
  of the file's usual small changes, and the run ends with a jump (or at a gap or an end of the file).
- held: most samples repeat the one before on all axes and then jump: the log runs faster than the sensor.
- spike: a sample far from the interpolation of its neighbours (2), in units of that interpolation's own error nearby.

      x_k ~ c + sum_j a_j (x_{k-j} + x_{k+j}),  j = 1 .. 4                                     (2)

  with a_j fitted to the file, which follows a constant spin exactly (two neighbours predict a sinusoid of known rate).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

TAPS = 4
BLOCK = 64
SPIKE_SIGMAS = 12.0
STUCK_SAMPLES = 4
STUCK_CHANGES = 5.0
FIELD_MAX_TESLA = 7e-5  # the strongest field in low orbit
_FILLS = (-9999.0, -999.0, 9999.0, 32767.0, -32768.0, 65535.0, 99999.0, -99999.0, 999999.0)
_HUGE = 1e20  # fill values of CDF and NetCDF are 1e30 and more


class Faults(NamedTuple):
    """(n,) bool each: samples of the magnetometer that are not to be used, by reason."""

    nan: np.ndarray
    sentinel: np.ndarray
    stuck: np.ndarray
    held: np.ndarray
    saturated: np.ndarray
    spikes: np.ndarray

    def any(self) -> np.ndarray:
        """(n,) bool: samples with any fault."""
        return np.logical_or.reduce(self)


def find_faults(seconds: np.ndarray, raw: np.ndarray, tesla: float) -> Faults:
    """Faults of raw (n, 3) readings at `seconds` (n,); `tesla` is one unit of them, for the physical bound on spikes."""
    nan = ~np.isfinite(raw).all(axis=1)
    sentinel = ~nan & find_fills(raw, nan)
    good = ~(nan | sentinel)
    none = np.zeros(len(raw), dtype=bool)
    if good.sum() < 3:
        return Faults(nan, sentinel, none, none, none, none)
    index = np.flatnonzero(good)
    step = float(np.median(np.diff(seconds[index])))
    breaks = np.diff(seconds[index]) > 1.5 * step
    values = raw[index]
    held = find_held(values)
    stuck = none[index] if held.any() else find_stuck(values, breaks)
    saturated = find_saturated(values) & ~stuck
    spikes = find_spikes(values, breaks, held | stuck | saturated, tesla)
    parts = []
    for part in (stuck, held, saturated & ~held, spikes):
        whole = none.copy()
        whole[index] = part
        parts.append(whole)
    return Faults(nan, sentinel, *parts)


def find_fills(raw: np.ndarray, skip: np.ndarray) -> np.ndarray:
    """(n,) bool: rows of zeros, rows of one fill value, and fill values far outside what the axis otherwise reads."""
    fills = (raw == 0.0).all(axis=1) | (np.abs(raw) > _HUGE).any(axis=1)
    for fill in _FILLS:
        hit = raw == fill
        fills |= hit.all(axis=1)
        for axis in range(3):
            others = raw[~skip & ~hit[:, axis] & ~fills, axis] if hit[:, axis].any() else np.zeros(0)
            if len(others) >= 10:
                low, high = np.quantile(others, (0.005, 0.995))
                margin = 0.2 * (high - low)
                if not low - margin <= fill <= high + margin:
                    fills |= hit[:, axis]
    return fills


def runs_of(same: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Starts and ends (exclusive) of runs of samples whose `same` (n - 1,) links are all true; runs of two and more."""
    edges = np.diff(np.concatenate(([0], same.astype(np.int8), [0])))
    return np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) + 1


def usual_change(values: np.ndarray) -> float:
    """The file's usual small change of one axis from sample to sample: the 10 % quantile of those that are not zero."""
    change = np.abs(np.diff(values))
    change = change[change > 0.0]
    return float(np.quantile(change, 0.1)) if len(change) else 0.0


def find_held(values: np.ndarray) -> np.ndarray:
    """(n,) bool: repeats of all three axes where over half of the file is such repeats and they end in jumps."""
    same = (values[1:] == values[:-1]).all(axis=1)
    held = np.concatenate(([False], same))
    jumps = np.abs(np.diff(values, axis=0))[~same]
    if same.mean() <= 0.45 or len(jumps) < 10:
        return np.zeros(len(values), dtype=bool)
    steps = np.array([_lattice(values[:, axis]) for axis in range(3)])
    moved = np.median((jumps / np.where(steps > 0, steps, np.inf)).max(axis=1))
    starts, ends = runs_of(same)
    lengths = ends - starts
    regular = np.mean(np.abs(lengths - np.median(lengths)) <= 1) > 0.8
    return held if moved >= 2.0 * STUCK_CHANGES and regular else np.zeros(len(values), dtype=bool)


def _lattice(values: np.ndarray) -> float:
    """The smallest step between different values of an axis: its quantisation, if it has one."""
    steps = np.diff(np.unique(values[:200_000]))
    steps = steps[steps > 1e-9 * np.ptp(values)] if len(steps) else steps
    return float(steps.min()) if len(steps) else 0.0


def find_stuck(values: np.ndarray, breaks: np.ndarray) -> np.ndarray:
    """(n,) bool: samples of one or more axes that stand still where they should move."""
    stuck = np.zeros(len(values), dtype=bool)
    for axis in range(3):
        x = values[:, axis]
        change = usual_change(x)
        starts, ends = runs_of((x[1:] == x[:-1]) & ~breaks)
        long = ends - starts >= STUCK_SAMPLES
        starts, ends = starts[long], ends[long]
        if change == 0.0 or not len(starts):
            continue
        sudden = _ends_suddenly(x, breaks, starts, ends, STUCK_CHANGES * change)
        starts, ends = starts[sudden], ends[sudden]
        allowed: dict[int, bool] = {}
        for start, end in zip(starts, ends, strict=True):
            size = 1 << int(end - start).bit_length() - 1
            if size not in allowed:
                allowed[size] = _moves(x, size, starts, ends, STUCK_CHANGES * change)
            if allowed[size]:
                stuck[start + 1 : end] = True
    return stuck


def _ends_suddenly(x, breaks, starts, ends, jump: float) -> np.ndarray:
    """Whether each run is left by a jump, or reaches a gap or the end of the file."""
    last = len(x) - 1
    after = np.minimum(ends, last)
    leaves = np.abs(x[after] - x[ends - 1]) > jump
    return leaves | (ends > last) | breaks[np.minimum(ends - 1, last - 1)]


def _moves(x: np.ndarray, size: int, starts, ends, threshold: float) -> bool:
    """Whether windows of `size` samples clear of the runs span more than the threshold, 99 times in 100."""
    size = min(size, 8192)
    if len(x) < 2 * size:
        return False
    covered = np.zeros(len(x) + 1, dtype=np.int64)
    np.add.at(covered, starts, 1)
    np.add.at(covered, ends, -1)
    inside = np.concatenate(([0], np.cumsum(np.cumsum(covered[:-1]) > 0)))
    first = np.unique(np.linspace(0, len(x) - size, max(200, min(4000, 2_000_000 // size))).astype(int))
    first = first[inside[first + size] == inside[first]]
    if len(first) < 20:
        return False
    windows = np.lib.stride_tricks.sliding_window_view(x, size)[first]
    return bool(np.quantile(np.ptp(windows, axis=1), 0.01) > threshold)


def find_saturated(values: np.ndarray) -> np.ndarray:
    """(n,) bool: samples at the largest or smallest value of an axis where these pile up as no motion would.

    A sinusoid spends 1 / (sqrt(6) - 1) = 0.7 times as long in its last step as in the five before; five times is a stop.
    """
    saturated = np.zeros(len(values), dtype=bool)
    for axis in range(3):
        x = values[:, axis]
        step = max(_lattice(x), 1e-3 * float(np.ptp(x)))
        for end, sign in ((x.max(), 1.0), (x.min(), -1.0)):
            at = x == end
            near = (sign * (end - x) <= 5.0 * step) & ~at
            if at.sum() >= 10 and at.sum() >= 5 * near.sum() and at.sum() < 0.5 * len(x):
                saturated |= at
    return saturated


def find_spikes(values: np.ndarray, breaks: np.ndarray, skip: np.ndarray, tesla: float) -> np.ndarray:
    """(n,) bool: wild values, beyond any field or far from the interpolation (2) of their neighbours."""
    middle = np.median(values, axis=0)
    away = np.linalg.norm(values - middle, axis=1)
    spikes = away > max(3.0 * float(np.quantile(away, 0.95)), 3.0 * FIELD_MAX_TESLA / tesla)
    if len(values) < 20 * TAPS:
        return spikes
    clean = values.copy()
    for _ in range(3):
        clean[spikes] = _bridged(values, spikes)[spikes]
        found = _isolated(clean, breaks, spikes | skip) & ~spikes
        if not found.any() or (found | spikes).mean() > 0.05:
            break
        spikes = spikes | found
    return spikes


def _bridged(values: np.ndarray, bad: np.ndarray) -> np.ndarray:
    """The values with bad samples interpolated from the good ones beside them."""
    index = np.arange(len(values))
    return np.stack([np.interp(index, index[~bad], values[~bad, axis]) for axis in range(3)], axis=-1)


def _isolated(values: np.ndarray, breaks: np.ndarray, skip: np.ndarray) -> np.ndarray:
    """Samples whose interpolation error stands out from that of the neighbourhood, one peak at a time."""
    count = len(values)
    whole = np.ones(count, dtype=bool)
    whole[:TAPS] = whole[-TAPS:] = False
    at = np.flatnonzero(breaks)
    for offset in range(-TAPS + 1, TAPS + 1):
        whole[np.clip(at + offset, 0, count - 1)] = False
    size = np.zeros(count)
    for axis in range(3):
        error = _interpolation_error(values[:, axis], whole & ~skip)
        scale = _local_scale(np.abs(error), whole)
        floor = max(_lattice(values[:, axis]), 0.02 * float(np.subtract(*np.quantile(values[:, axis], (0.99, 0.01)))))
        size = np.maximum(size, np.where(whole, np.abs(error) / np.maximum(SPIKE_SIGMAS * scale, floor), 0.0))
    peak = np.ones(count, dtype=bool)
    for offset in range(1, TAPS + 1):
        peak[offset:] &= size[offset:] >= size[:-offset]
        peak[:-offset] &= size[:-offset] >= size[offset:]
    return (size > 1.0) & peak & whole & ~skip


def _interpolation_error(x: np.ndarray, use: np.ndarray) -> np.ndarray:
    """(n,) x less its interpolation (2), whose coefficients are fitted to the samples of `use`."""
    x = x - np.median(x)
    sums = np.ones((len(x), TAPS + 1))
    for j in range(1, TAPS + 1):
        sums[j:-j, j] = x[2 * j :] + x[: -2 * j]
    sums[:TAPS] = sums[-TAPS:] = 0.0
    chosen = np.flatnonzero(use)
    if len(chosen) < 10 * TAPS:
        return np.zeros(len(x))
    chosen = chosen[:: max(1, len(chosen) // 50_000)]
    coefficients = np.linalg.lstsq(sums[chosen], x[chosen], rcond=1e-9)[0]
    for _ in range(3):  # a spike must not bend the fit that judges it
        error = np.abs(x[chosen] - sums[chosen] @ coefficients)
        kept = chosen[error <= max(6.0 * float(np.median(error)), 1e-12 * float(np.ptp(x)))]
        if len(kept) < 10 * TAPS:
            break
        coefficients = np.linalg.lstsq(sums[kept], x[kept], rcond=1e-9)[0]
    return x - sums @ coefficients


def _local_scale(error: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """(n,) 1.48 times the median error of the blocks around each sample: the largest of three, so that a loud part may begin."""
    count = len(error)
    blocks = -(-count // BLOCK)
    padded = np.full(blocks * BLOCK, np.nan)
    padded[:count] = np.where(whole, error, np.nan)
    padded = padded.reshape(blocks, BLOCK)
    known = np.isfinite(padded).any(axis=1)
    median = np.full(blocks, np.nan)
    median[known] = np.nanmedian(padded[known], axis=1)
    overall = float(np.nanmedian(median)) if known.any() else 0.0
    median = np.where(known, median, overall)
    around = np.maximum(median, np.maximum(np.append(median[1:], overall), np.append(overall, median[:-1])))
    return 1.4826 * np.repeat(around, BLOCK)[:count]
