"""Bounded least squares by an active set, for a handful of unknowns: the core of allocation, in compiled code.

    least 1/2 v'H v + g'v   with   lower <= v <= upper,   H positive definite                       (1)

From a start within the bounds, unknowns on a bound are held there and the others solved for by a Cholesky factor; a step
that would leave the bounds ends on the first one met, which is then held; at the least value of a held set the multiplier
with the wrong sign lets its unknown go. Each set is left with a smaller value, so none comes twice and the end is exact.

Source: Haerkegard (2002), Proc. 41st IEEE Conf. Decision and Control, 1295; Nocedal and Wright (2006), Numerical
Optimization, 2nd ed., algorithm 16.3. Cost: m^3/6 multiplications for each set, about m sets from a cold start.
"""

from __future__ import annotations

from math import sqrt

import numpy as np
from numba import njit

FREE, AT_LOWER, AT_UPPER = 0, 1, 2
MOST_SETS = 200
SLACK = 1e-12  # of the largest gradient: a multiplier of the wrong sign by less is rounding


@njit(cache=True, error_model="numpy")
def free_step(H, slope, held, factor, step):
    """step (m,) of the unknowns that are free to the least value of (1), 0 for the held; False if H is not positive."""
    m = slope.shape[0]
    for i in range(m):
        if held[i] != FREE:
            step[i] = 0.0
            continue
        total = -slope[i]
        for j in range(i):
            if held[j] != FREE:
                continue
            part = H[i, j]
            for k in range(j):
                if held[k] == FREE:
                    part -= factor[i, k] * factor[j, k]
            factor[i, j] = part / factor[j, j]
            total -= factor[i, j] * step[j]
        square = H[i, i]
        for k in range(i):
            if held[k] == FREE:
                square -= factor[i, k] * factor[i, k]
        if not square > 0.0:
            return False
        factor[i, i] = sqrt(square)
        step[i] = total / factor[i, i]
    for i in range(m - 1, -1, -1):
        if held[i] != FREE:
            continue
        total = step[i]
        for k in range(i + 1, m):
            if held[k] == FREE:
                total -= factor[k, i] * step[k]
        step[i] = total / factor[i, i]
    return True


@njit(cache=True, error_model="numpy")
def _slope(H, g, v, slope):
    """slope = H v + g; its largest size is returned."""
    largest = 0.0
    for i in range(v.shape[0]):
        total = g[i]
        for j in range(v.shape[0]):
            total += H[i, j] * v[j]
        slope[i] = total
        largest = max(largest, abs(total))
    return largest


@njit(cache=True, error_model="numpy")
def _longest(v, step, lower, upper, held):
    """(share of the step within the bounds, the unknown that meets one or -1)."""
    share, meets = 1.0, -1
    for i in range(v.shape[0]):
        if held[i] != FREE:
            continue
        room = upper[i] - v[i] if step[i] > 0.0 else lower[i] - v[i]
        if abs(step[i]) * share > abs(room) and step[i] != 0.0:
            share, meets = room / step[i], i
    return max(share, 0.0), meets


@njit(cache=True, error_model="numpy")
def _released(slope, held, lower, upper, slack):
    """The held unknown that pulls hardest off its bound, or -1; one whose bounds are the same stays."""
    worst, who = slack, -1
    for i in range(slope.shape[0]):
        pull = -slope[i] if held[i] == AT_LOWER else slope[i] if held[i] == AT_UPPER else 0.0
        if pull > worst and upper[i] > lower[i]:
            worst, who = pull, i
    return who


@njit(cache=True, error_model="numpy")
def bounded_least(H, g, lower, upper, v, held):
    """Solve (1) in place of v (m,), from where v and held (m,) int64 start; number of sets tried, or -1 where none ends.

    v is first brought within the bounds, and those off their bounds count as free: a last solution is a warm start.
    """
    m = v.shape[0]
    factor, step, slope = np.empty((m, m)), np.empty(m), np.empty(m)
    for i in range(m):
        v[i] = min(max(v[i], lower[i]), upper[i])
        if lower[i] == upper[i]:
            held[i] = AT_LOWER
        elif (held[i] == AT_LOWER and v[i] > lower[i]) or (held[i] == AT_UPPER and v[i] < upper[i]):
            held[i] = FREE
    scale = 0.0
    for i in range(m):
        scale = max(scale, abs(g[i]))
    for tried in range(1, MOST_SETS + 1):
        scale = max(scale, _slope(H, g, v, slope))
        if not free_step(H, slope, held, factor, step):
            return -1
        share, meets = _longest(v, step, lower, upper, held)
        for i in range(m):
            v[i] += share * step[i]
        if meets >= 0:
            held[meets] = AT_UPPER if step[meets] > 0.0 else AT_LOWER
            v[meets] = upper[meets] if step[meets] > 0.0 else lower[meets]
            continue
        _slope(H, g, v, slope)
        who = _released(slope, held, lower, upper, SLACK * scale)
        if who < 0:
            return tried
        held[who] = FREE
    return -1
