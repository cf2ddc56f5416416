"""`tracking-predictive`: the best controls over the hour ahead, in the field that is known ahead, within all limits.

    w_k = u_k - u_r,k,   e_k+1 = A e_k + B_k w_k + d_k,   least sum e'Q e + w'R w + e_N' P e_N      (1)
    lower - u_r,k <= w_k <= upper - u_r,k

u_r,k: the controls of least power that hold the path at stage k, from the allocation in the field of that time; d_k: what
they miss there. So nothing is paid for holding a place, and where limits do not allow it the plan goes round it in time.
B_k is from the on-board model along the nominal orbit, that of the first stage from the field of now. P is that of loads at
will. `horizon` solves (1) exactly at every call, from the last plan.
"""

from __future__ import annotations

from math import floor

import numpy as np
from numba import njit

from fieldline.control.tracking import onboard_vehicle as own
from fieldline.control.tracking.allocation import allocate_kernel
from fieldline.control.tracking.horizon import best_controls
from fieldline.control.tracking.riccati_sweep import Horizon, new_sweep
from fieldline.control.tracking.tracking_loop import DISTURBANCE, MEMORY, in_body, prepared, reference_at, silent, told

STAGES, STEP, MOST_STEPS, FIELDS, FIELD_STEP = range(5)
HEAD = 5  # then A (12, 12), Gamma (12, 6), Q (12), R (m), P (12, 12), sizes of states (12), field_h (FIELDS, 3)
MOST_STAGES, MOST_CONTROLS = 60, 16
PLAN = MEMORY
PLAN_HELD = PLAN + MOST_STAGES * MOST_CONTROLS
PLAN_MEMORY = PLAN_HELD + MOST_STAGES * MOST_CONTROLS


@njit(cache=True, error_model="numpy")
def field_ahead(t, params, at):
    """Field [T], axes h, on the nominal orbit at time t [s]: linear between the nodes of a day's table."""
    nodes, step = int(params[at - 2]), params[at - 1]
    turns = t / (nodes * step)
    place = (turns - floor(turns)) * nodes
    lower = int(place) % nodes
    share = place - floor(place)
    first, second = at + 3 * lower, at + 3 * ((lower + 1) % nodes)
    return (
        (1.0 - share) * params[first] + share * params[second],
        (1.0 - share) * params[first + 1] + share * params[second + 1],
        (1.0 - share) * params[first + 2] + share * params[second + 2],
    )


@njit(cache=True, error_model="numpy")
def _square(params, at, n, m):
    """An (n, m) matrix of the law's own numbers."""
    out = np.empty((n, m))
    for i in range(n):
        for j in range(m):
            out[i, j] = params[at + m * i + j]
    return out


@njit(cache=True, error_model="numpy")
def _stage_holds(t, effect, memory, params, lower, upper, cost, u, held, missed):
    """Controls u (m,) that hold the path at t best, warm from the stage before, and the loads (6,) that they miss."""
    state, loads = np.zeros(12), np.zeros(6)
    reference_at(t, params, state, loads)
    for k in range(6):
        loads[k] -= memory[DISTURBANCE + k]
    weight = params[own.WEIGHT : own.WEIGHT + 6]
    allocate_kernel(effect, loads, weight, cost, lower, upper, params[own.SHARE], u, held)
    for k in range(6):
        missed[k] = -loads[k]
        for j in range(u.shape[0]):
            missed[k] += effect[k, j] * u[j]


@njit(cache=True, error_model="numpy")
def _problem(t, first, memory, params, base, holds):
    """The problem (1) in scaled numbers; first (6, m): the effect of now; holds (N, m) is filled with u_r."""
    m, N = int(params[own.CONTROLS]), int(params[base + STAGES])
    A = _square(params, base + HEAD, 12, 12)
    gamma = _square(params, base + HEAD + 144, 12, 6)
    Q, R = params[base + HEAD + 216 : base + HEAD + 228].copy(), params[base + HEAD + 228 : base + HEAD + 228 + m].copy()
    P = _square(params, base + HEAD + 228 + m, 12, 12)
    fields = base + HEAD + 228 + m + 144 + 12 + 2
    lower, upper, cost = np.empty(m), np.empty(m), np.empty(m)
    own.column_of(params, own.LOWER, lower)
    own.column_of(params, own.UPPER, upper)
    own.column_of(params, own.COST, cost)
    B, d = np.zeros((N, 12, m)), np.zeros((N, 12))
    low, high = np.empty((N, m)), np.empty((N, m))
    effect, missed = np.empty((6, m)), np.zeros(6)
    u, held = np.zeros(m), np.zeros(m, dtype=np.int64)
    factor = params[own.FACTOR]
    for k in range(N):
        middle = t + (k + 0.5) * params[base + STEP] if k > 0 else t  # the first control is for now, till the next call
        if k == 0:
            effect[:] = first
        else:
            field = field_ahead(middle, params, fields)
            own.effect_of(params, (factor * field[0], factor * field[1], factor * field[2]), effect)
        _stage_holds(middle, effect, memory, params, lower, upper, cost, u, held, missed)
        for j in range(m):
            size = max(upper[j], -lower[j], 1e-300)
            holds[k, j] = u[j]
            low[k, j], high[k, j] = (lower[j] - u[j]) / size, (upper[j] - u[j]) / size
            for i in range(12):
                for c in range(6):
                    B[k, i, j] += gamma[i, c] * effect[c, j] * size
        for i in range(12):
            for c in range(6):
                d[k, i] += gamma[i, c] * missed[c]
    return Horizon(A, B, d, np.zeros((N + 1, 12)), Q, R, P, low, high)


@njit(cache=True, error_model="numpy")
def tracking_predictive(t, measurement, memory, params):
    """Thrusts and currents of `tracking-predictive`."""
    m = int(params[own.CONTROLS])
    x, error, loads, effect = np.zeros(12), np.zeros(12), np.zeros(6), np.zeros((6, m))
    known, q_hb = prepared(t, measurement, memory, params, x, error, loads, effect)
    if not known:
        return silent(memory, params)
    base = own.law_at(params)
    N = int(params[base + STAGES])
    scales = base + HEAD + 228 + m + 144
    for j in range(12):
        error[j] /= params[scales + j]
    holds = np.zeros((N, m))
    problem = _problem(t, _effect_h(q_hb, effect), memory, params, base, holds)
    plan, sweep = np.zeros((N, m)), new_sweep(N, 12, m)
    for k in range(N):
        for j in range(m):
            size = max(abs(problem.lower[k, j]), abs(problem.upper[k, j]))
            plan[k, j] = memory[PLAN + m * k + j] if size > 0.0 else 0.0
            sweep.held[k, j] = int(memory[PLAN_HELD + m * k + j])
    best_controls(problem, error, plan, int(params[base + MOST_STEPS]), sweep)
    u = np.zeros(m)
    for j in range(m):
        at = own.TABLE + own.WIDTH * j
        u[j] = holds[0, j] + plan[0, j] * max(params[at + own.UPPER], -params[at + own.LOWER])
    for k in range(N):
        for j in range(m):
            memory[PLAN + m * k + j] = plan[k, j]
            memory[PLAN_HELD + m * k + j] = sweep.held[k, j]
    return told(q_hb, u, effect, memory, params)


@njit(cache=True, error_model="numpy")
def _effect_h(q_hb, effect):
    """The effect (6, m) with its forces turned to axes h, where the motion is counted."""
    out, column, turned = np.empty(effect.shape), np.zeros(6), np.zeros(6)
    back = (-q_hb[0], -q_hb[1], -q_hb[2], q_hb[3])
    for k in range(effect.shape[1]):
        for j in range(6):
            column[j] = effect[j, k]
        in_body(back, column, turned)
        for j in range(6):
            out[j, k] = turned[j]
    return out
