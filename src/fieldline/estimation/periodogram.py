"""Which constant rate turns a run of field vectors into one: the rotational periodogram.

While the reference field hardly turns, a body of constant rate w measures b_k = exp(-[w x] (t_k - t_0)) b_0, so

    C(w) = | sum_k exp([w x] (t_k - t_0)) b_k |  /  sum_k |b_k|                                          (1)

is 1 at the true rate and small elsewhere: a search over a ball of rates finds magnitude, axis and sense at once, where
finite differences of samples that turn by 46 deg find nothing. Rates above pi / step appear as their aliases, which
(1) cannot tell apart for evenly spaced samples; `nyquist_rate` says where they begin.

Valid for windows over which the field's direction moves by less than the rate's own resolution, 1 / length.
"""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import numpy as np
from numba import njit

from fieldline.frames.attitude import quat_exp, to_inertial
from fieldline.frames.vectors import add, dot, norm, scale, vec


@njit(cache=True)
def coherence(seconds, field_b, w):
    """C(w) of (1) for times (n,), vectors (n, 3) and a rate tuple [rad/s]."""
    total = (0.0, 0.0, 0.0)
    size = 0.0
    for k in range(seconds.shape[0]):
        b = vec(field_b, k)
        total = add(total, to_inertial(quat_exp(scale(seconds[k] - seconds[0], w)), b))
        size += norm(b)
    return norm(total) / size


@njit(cache=True)
def _coherence_on_axis(along, across_x, across_y, seconds, rate):
    """C(w) for w = rate * axis from the parts of b along and across the axis: two sums a sample."""
    c, s = 0.0, 0.0
    for k in range(seconds.shape[0]):
        a = rate * (seconds[k] - seconds[0])
        ca, sa = cos(a), sin(a)
        c += across_x[k] * ca - across_y[k] * sa
        s += across_x[k] * sa + across_y[k] * ca
    return sqrt(along * along + c * c + s * s)


@njit(cache=True)
def coherence_map(seconds, field_b, axes, rates, out):
    """Fill out (axes, rates) with C(w), w = rate * axis; axes (a, 3) unit vectors over half the sphere."""
    n = seconds.shape[0]
    x, y = np.empty(n), np.empty(n)
    size = 0.0
    for k in range(n):
        size += norm(vec(field_b, k))
    for i in range(axes.shape[0]):
        u = vec(axes, i)
        e1 = _perpendicular(u)
        e2 = (u[1] * e1[2] - u[2] * e1[1], u[2] * e1[0] - u[0] * e1[2], u[0] * e1[1] - u[1] * e1[0])
        along = 0.0
        for k in range(n):
            b = vec(field_b, k)
            along += dot(b, u)
            x[k], y[k] = dot(b, e1), dot(b, e2)
        for j in range(rates.shape[0]):
            out[i, j] = _coherence_on_axis(along, x, y, seconds, rates[j]) / size


@njit(cache=True)
def _perpendicular(u):
    """A unit vector across u."""
    if abs(u[0]) < 0.7:
        size = sqrt(u[1] * u[1] + u[2] * u[2])
        return (0.0, u[2] / size, -u[1] / size)
    size = sqrt(u[0] * u[0] + u[1] * u[1])
    return (u[1] / size, -u[0] / size, 0.0)


def half_sphere(spacing_rad: float) -> np.ndarray:
    """(a, 3) unit vectors spread over half the sphere (a Fibonacci lattice) about `spacing_rad` apart."""
    count = max(8, int(np.ceil(2.0 * pi / spacing_rad**2)))
    k = np.arange(count) + 0.5
    z = k / count
    longitude = k * pi * (1.0 + 5.0**0.5)
    r = np.sqrt(1.0 - z * z)
    return np.stack([r * np.cos(longitude), r * np.sin(longitude), z], axis=1)


def nyquist_rate(seconds: np.ndarray) -> float:
    """[rad/s] above which evenly spaced samples show an alias."""
    return pi / float(np.median(np.diff(seconds)))


def rate_peaks(seconds, field_b, *, rate_max_rad_s=None, most: int = 6) -> list[tuple[np.ndarray, float]]:
    """Rates (3,) [rad/s] at which (1) peaks, with C there, the best first; at most `most` of them.

    seconds (n,), field_b (n, 3) [T], n of 4 to a few dozen. Axes stand so close that the turn at `rate_max_rad_s` over
    half the window moves by 0.6 rad between neighbours. Each peak is climbed by a pattern search.
    """
    seconds = np.ascontiguousarray(seconds, dtype=float)
    field_b = np.ascontiguousarray(field_b, dtype=float)
    length = seconds[-1] - seconds[0]
    top = nyquist_rate(seconds) if rate_max_rad_s is None else min(rate_max_rad_s, nyquist_rate(seconds))
    axes = half_sphere(float(np.clip(1.2 / (top * length), 0.12, 0.5)))
    rates = np.linspace(-top, top, 2 * int(np.ceil(top * length / 0.8)) + 1)
    table = np.empty((len(axes), len(rates)))
    coherence_map(seconds, field_b, axes, rates, table)
    order = np.argsort(table.ravel())[::-1][: 40 * most]
    found: list[tuple[np.ndarray, float]] = []
    for index in order:
        axis, rate = axes[index // len(rates)], rates[index % len(rates)]
        w = axis * rate
        # half a resolution cell apart counts as the same peak
        if any(np.linalg.norm(w - other) < 1.5 / length for other, _ in found):
            continue
        found.append(_climb(seconds, field_b, w, 0.4 / length))
        if len(found) == most:
            break
    found.sort(key=lambda peak: -peak[1])
    kept: list[tuple[np.ndarray, float]] = []
    for w, value in found:
        if all(np.linalg.norm(w - other) > 0.5 / length for other, _ in kept):
            kept.append((w, value))
    return kept


def _climb(seconds, field_b, w, step) -> tuple[np.ndarray, float]:
    """Pattern search for the top of C(w) near w; the step halves until it is 1 % of the first."""
    best = coherence(seconds, field_b, tuple(w))
    last = step * 0.01
    while step > last:
        moved = False
        for axis in range(3):
            for sign in (1.0, -1.0):
                trial = w.copy()
                trial[axis] += sign * step
                value = coherence(seconds, field_b, tuple(trial))
                if value > best:
                    w, best, moved = trial, value, True
        if not moved:
            step *= 0.5
    return w, best
