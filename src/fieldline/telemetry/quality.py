"""Faults of the samples themselves: missing, frozen, held, saturated and wild values of the magnetometer.

Every rule compares a sample with what this file does elsewhere, as nothing is known of the satellite: an Earth-pointing
one with a coarse magnetometer repeats its values for minutes, a spinner jumps by half the field at every sample.

- held: most samples repeat the one before on all axes, for a regular time, and then move freely: the log runs faster
  than the sensor. A coarse sensor also repeats, but irregularly and by the same few steps.
- stuck: a value repeats, moves by over five of the file's usual small changes within half the run's length before or
  after it, and windows of that length elsewhere move by as much in 99 of 100 cases. A sinusoid that turns within one
  step of the sensor for a time T moves by three steps in the T / 2 after it, so a natural turn is no fault.
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
MANY = 0.05  # spikes beyond this share are no spikes but the signal
FIELD_MAX_TESLA = 7e-5  # the strongest field in low orbit
_FILLS = (-9999.0, -999.0, 9999.0, 32767.0, -32768.0, 65535.0, 99999.0, -99999.0, 999999.0)
FILL_BEYOND = 1e20  # fill values of CDF and NetCDF are 1e30 and more


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
    left = np.flatnonzero(~(nan | sentinel))
    found = {}
    for name, finder in _FINDERS.items():
        part = np.zeros(len(raw), dtype=bool)
        if len(left) >= 3:
            step = np.diff(seconds[left])
            breaks = step > 1.5 * float(np.median(step))
            part[left] = finder(raw[left], breaks, tesla)
            left = left[~part[left]]
        found[name] = part
    spikes = found.pop("wild") | found.pop("isolated")
    return Faults(nan, sentinel, spikes=spikes, **found)


def find_fills(raw: np.ndarray, skip: np.ndarray) -> np.ndarray:
    """(n,) bool: rows of zeros, rows of one fill value, and fill values far outside what the axis otherwise reads."""
    fills = (raw == 0.0).all(axis=1) | (np.abs(raw) > FILL_BEYOND).any(axis=1)
    for fill in _FILLS:
        hit = raw == fill
        fills |= hit.all(axis=1)
        for axis in np.flatnonzero(hit.any(axis=0)):
            others = raw[~skip & ~hit[:, axis] & ~fills, axis]
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


def find_held(values: np.ndarray, breaks: np.ndarray, tesla: float) -> np.ndarray:
    """(n,) bool: repeats of all three axes where they are half of the file, regular, and end in jumps that differ."""
    same = (values[1:] == values[:-1]).all(axis=1)
    none = np.zeros(len(values), dtype=bool)
    starts, ends = runs_of(same)
    if same.mean() <= 0.45 or len(starts) < 30:
        return none
    jumps = np.diff(values, axis=0)[~same][:100_000]
    kinds = np.unique(np.round(jumps / (1e-6 * np.ptp(values))), axis=0)
    lengths = ends - starts
    regular = np.mean(np.abs(lengths - np.median(lengths)) <= 1) > 0.8
    return np.concatenate(([False], same)) if regular and len(kinds) > 0.5 * len(jumps) else none


def _lattice(values: np.ndarray) -> float:
    """The smallest step between different values of an axis: its quantisation, if it has one."""
    steps = np.diff(np.unique(values[:200_000]))
    steps = steps[steps > 1e-9 * np.ptp(values)] if len(steps) else steps
    return float(steps.min()) if len(steps) else 0.0


def find_stuck(values: np.ndarray, breaks: np.ndarray, tesla: float) -> np.ndarray:
    """(n,) bool: samples of one or more axes that stand still where they should move."""
    stuck = np.zeros(len(values), dtype=bool)
    common = _common_step(values)
    segment = np.concatenate(([0], np.cumsum(breaks)))
    for axis in range(3):
        x = values[:, axis]
        change = max(usual_change(x), common)
        starts, ends = runs_of((x[1:] == x[:-1]) & ~breaks)
        long = ends - starts >= STUCK_SAMPLES
        starts, ends = starts[long], ends[long]
        if change == 0.0 or not len(starts):
            continue
        threshold = STUCK_CHANGES * change
        reach = np.maximum(3, (ends - starts) // 2)
        sudden = (_moved(x, segment, ends - 1, reach) > threshold) | (_moved(x, segment, starts, -reach) > threshold)
        starts, ends = starts[sudden], ends[sudden]
        moves: dict[int, bool] = {}
        for start, end in zip(starts, ends, strict=True):
            size = 1 << int(end - start).bit_length() - 1
            if size not in moves:
                long = ends - starts >= size // 2
                moves[size] = _moves(x, size, starts[long], ends[long], threshold)
            if moves[size]:
                stuck[start + 1 : end] = True
    return stuck


def _common_step(values: np.ndarray) -> float:
    """The usual step of a coarse sensor whose rows often repeat whole, also after a matrix has mixed its axes; else 0."""
    same = (values[1:] == values[:-1]).all(axis=1)
    starts, ends = runs_of(same)
    inner = ends[ends < len(values)]
    if len(starts) < max(10, 0.03 * len(values)) or not len(inner):
        return 0.0
    return float(np.median(np.linalg.norm(values[inner] - values[inner - 1], axis=1)))


def _moved(x: np.ndarray, segment: np.ndarray, at: np.ndarray, reach: np.ndarray) -> np.ndarray:
    """The largest distance from x[at] at 1, half and all of `reach` samples on (or back), within the same segment."""
    moved = np.zeros(len(at))
    for offset in (np.sign(reach), reach // 2, reach):
        to = np.clip(at + offset, 0, len(x) - 1)
        moved = np.maximum(moved, np.where(segment[to] == segment[at], np.abs(x[to] - x[at]), 0.0))
    return moved


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


def find_saturated(values: np.ndarray, breaks: np.ndarray, tesla: float) -> np.ndarray:
    """(n,) bool: samples at the largest or smallest value of an axis where these pile up as no motion would.

    A sinusoid spends 1 / (sqrt(6) - 1) = 0.7 times as long in its last step as in the five before; five times is a stop.
    """
    saturated = np.zeros(len(values), dtype=bool)
    common = _common_step(values)
    for axis in range(3):
        x = values[:, axis]
        step = max(_lattice(x), common, 1e-3 * float(np.ptp(x)))
        for end, sign in ((x.max(), 1.0), (x.min(), -1.0)):
            at = x == end
            near = (sign * (end - x) <= 5.0 * step) & ~at
            if at.sum() >= 10 and at.sum() >= 5 * near.sum() and at.sum() < 0.5 * len(x):
                saturated |= at
    return saturated


def find_wild(values: np.ndarray, breaks: np.ndarray, tesla: float) -> np.ndarray:
    """(n,) bool: values farther from the median than a field can turn, and three times as far as 19 of 20 others."""
    away = np.linalg.norm(values - np.median(values, axis=0), axis=1)
    return away > max(3.0 * float(np.quantile(away, 0.95)), 3.0 * FIELD_MAX_TESLA / tesla)


def find_isolated(values: np.ndarray, breaks: np.ndarray, tesla: float) -> np.ndarray:
    """(n,) bool: single samples far from the interpolation (2) of their neighbours; none where they would be many."""
    spikes = np.zeros(len(values), dtype=bool)
    if len(values) < 20 * TAPS:
        return spikes
    clean = values.copy()
    for _ in range(3):
        clean[spikes] = _bridged(values, spikes)[spikes]
        found = _peaks(clean, breaks, spikes)
        if not found.any():
            break
        spikes |= found
    return spikes if spikes.mean() < MANY else np.zeros(len(values), dtype=bool)


def _bridged(values: np.ndarray, bad: np.ndarray) -> np.ndarray:
    """The values with bad samples interpolated from the good ones beside them."""
    index = np.arange(len(values))
    return np.stack([np.interp(index, index[~bad], values[~bad, axis]) for axis in range(3)], axis=-1)


def _peaks(values: np.ndarray, breaks: np.ndarray, skip: np.ndarray) -> np.ndarray:
    """Samples whose interpolation error stands out from that of the neighbourhood, one peak at a time."""
    count = len(values)
    whole = np.ones(count, dtype=bool)
    whole[:TAPS] = whole[-TAPS:] = False
    at = np.flatnonzero(breaks)
    for offset in range(-TAPS + 1, TAPS + 1):
        whole[np.clip(at + offset, 0, count - 1)] = False
    common = _common_step(values)
    size, alone = np.zeros(count), np.zeros(count, dtype=bool)
    for axis in range(3):
        error = _interpolation_error(values[:, axis], whole & ~skip)
        scale = _local_scale(np.abs(error), whole)
        span = float(np.subtract(*np.quantile(values[:, axis], (0.99, 0.01))))
        floor = max(3.0 * _lattice(values[:, axis]), 3.0 * common, 0.02 * span)
        error = np.abs(error) / np.maximum(SPIKE_SIGMAS * scale, floor)
        size = np.maximum(size, np.where(whole, error, 0.0))
        alone |= (error > 1.0) & _stands_alone(values[:, axis])
    peak = np.ones(count, dtype=bool)
    for offset in range(1, TAPS + 1):
        peak[offset:] &= size[offset:] >= size[:-offset]
        peak[:-offset] &= size[:-offset] >= size[offset:]
    return (size > 1.0) & alone & peak & whole & ~skip


def _stands_alone(x: np.ndarray) -> np.ndarray:
    """(n,) whether a sample is no part of a run of equal values, nor the edge of one that leads elsewhere."""
    same = x[1:] == x[:-1]
    alone = np.ones(len(x), dtype=bool)
    alone[1:] &= ~same
    alone[:-1] &= ~same
    starts, ends = runs_of(same)
    long = ends - starts >= STUCK_SAMPLES
    edges = np.concatenate((starts[long] - 1, ends[long]))
    edges = edges[(edges > 0) & (edges < len(x) - 1)]
    before, at, after = x[edges - 1], x[edges], x[edges + 1]
    alone[edges] &= np.abs(after - before) < 0.5 * np.minimum(np.abs(at - before), np.abs(at - after))
    return alone


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


# In the order in which one fault would hide or mimic the next.
_FINDERS = {"held": find_held, "wild": find_wild, "saturated": find_saturated, "isolated": find_isolated, "stuck": find_stuck}
