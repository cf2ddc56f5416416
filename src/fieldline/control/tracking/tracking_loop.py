"""What the laws of a tracking vehicle share: state and error, the loads that hold the path, the disturbance, the allocation.

    loads = m (a_r - F x_r) - d + (what the law adds for the error e = x - x_r)                     (1)
    d <- d + dt/(T + dt) (m (v1 - v0)/dt - m F (x0 + x1)/2 - given - d)                             (2)

F x: acceleration of the motion by itself, m: mass and moments of inertia, x_r, a_r: the path. (2) is the load that nobody
ordered: drag, oblateness, a field that is not the model's; it takes the place of an integral of the error and, because it
counts what was given and not what was wanted, does not wind up at the limits.

    x <- x_f + dt/(T_f + dt) (x - x_f),   x_f = x0 + dt dx/dt(x0, given + d)                        (3)

(3) is for place and rate alone: the currents are weak, and without it they would spend themselves on the noise of a
navigation sensor. The forecast leaves no lag, since given and unordered loads are in it.
"""

from __future__ import annotations

from math import isfinite

import numpy as np
from numba import njit

from fieldline.control.tracking import onboard_vehicle as own
from fieldline.control.tracking.allocation import allocate_power_kernel
from fieldline.control.tracking.approach_path import path
from fieldline.control.tracking.relative_state import field_known_b, relative_state, state_known
from fieldline.frames.attitude import to_body, to_inertial

MOST_CONTROLS = 24
HAS_LAST, LAST_TIME, LAST_STATE, GIVEN, DISTURBANCE = 0, 1, 2, 14, 20
FORECAST = 26
LAST_U, LAST_HELD = 32, 32 + MOST_CONTROLS
MEMORY = LAST_HELD + MOST_CONTROLS


@njit(cache=True, error_model="numpy")
def free_acceleration(params, x, k):
    """Acceleration k of the motion by itself at state x (12,): a row of F x."""
    total = 0.0
    for j in range(12):
        total += params[own.MOTION + 12 * k + j] * x[j]
    return total


@njit(cache=True, error_model="numpy")
def _filter(dt, fresh, x, memory, params):
    """Equation (3): place and rate in x, and in memory for the next call."""
    hold = params[own.FILTER]
    if fresh or not hold > 0.0:
        for j in range(6):
            memory[FORECAST + j] = x[j]
        return
    before = np.zeros(12)
    for j in range(6):
        before[j] = memory[FORECAST + j]
    share = dt / (hold + dt)
    for k in range(3):
        push = (memory[GIVEN + k] + memory[DISTURBANCE + k]) / params[own.MASS + k] + free_acceleration(params, before, k)
        place = before[2 * k] + dt * (before[2 * k + 1] + 0.5 * dt * push)
        rate = before[2 * k + 1] + dt * push
        x[2 * k] = place + share * (x[2 * k] - place)
        x[2 * k + 1] = rate + share * (x[2 * k + 1] - rate)
    for j in range(6):
        memory[FORECAST + j] = x[j]


@njit(cache=True, error_model="numpy")
def _observe(dt, t, x, memory, params):
    """Equation (2), and this state for the next call."""
    settle = params[own.SETTLE]
    if memory[HAS_LAST] > 0.5 and dt > 0.0 and settle > 0.0:
        middle = np.empty(12)
        for j in range(12):
            middle[j] = 0.5 * (x[j] + memory[LAST_STATE + j])
        share = dt / (settle + dt)
        for k in range(6):
            gained = (x[2 * k + 1] - memory[LAST_STATE + 2 * k + 1]) / dt
            seen = params[own.MASS + k] * (gained - free_acceleration(params, middle, k)) - memory[GIVEN + k]
            memory[DISTURBANCE + k] += share * (seen - memory[DISTURBANCE + k])
    memory[HAS_LAST] = 1.0
    memory[LAST_TIME] = t
    for j in range(12):
        memory[LAST_STATE + j] = x[j]


@njit(cache=True, error_model="numpy")
def reference_at(t, params, state, loads):
    """The path's state (12,) and the loads (6,) that keep a body on it: force in axes h, moment about axes b."""
    place, rate, push = np.zeros(3), np.zeros(3), np.zeros(3)
    path(t, params, own.PATH, place, rate, push)
    target = params[own.TARGET]
    for j in range(3):
        state[2 * j], state[2 * j + 1] = target * place[j], target * rate[j]
        state[6 + 2 * j], state[7 + 2 * j] = params[own.ANGLES + j], 0.0
    for k in range(6):
        wanted = target * push[k] if k < 3 else 0.0
        loads[k] = params[own.MASS + k] * (wanted - free_acceleration(params, state, k))


@njit(cache=True, error_model="numpy")
def prepared(t, measurement, memory, params, x, error, loads, effect):
    """Fill state x and error (12,), loads (6,) of (1) without the law's part, effect (6, m); (whether all is known, q_hb)."""
    nothing = (0.0, 0.0, 0.0, 1.0)
    if not state_known(measurement, params[own.TARGET]):
        memory[HAS_LAST] = 0.0
        return False, nothing
    q_hb, _ = relative_state(measurement, params[own.TARGET], x)
    for j in range(12):
        if not abs(x[j]) < 1e12:
            memory[HAS_LAST] = 0.0
            return False, nothing
    dt, fresh = t - memory[LAST_TIME], memory[HAS_LAST] < 0.5
    _observe(dt, t, x, memory, params)
    _filter(dt, fresh or not dt > 0.0, x, memory, params)
    reference_at(t, params, error, loads)
    for j in range(12):
        error[j] = x[j] - error[j]
    for k in range(6):
        loads[k] -= memory[DISTURBANCE + k]
    own.effect_of(params, field_known_b(measurement, params[own.BY_READING], params[own.FACTOR]), effect)
    return True, q_hb


@njit(cache=True, error_model="numpy")
def in_body(q_hb, loads, out):
    """Loads with the force in axes h as loads with the force in axes b."""
    force = to_body(q_hb, (loads[0], loads[1], loads[2]))
    for j in range(3):
        out[j], out[3 + j] = force[j], loads[3 + j]


@njit(cache=True, error_model="numpy")
def allocated(loads_b, effect, memory, params, u):
    """Controls u (m,) within limits that give loads_b (6,) best, warm from the last call's."""
    m = u.shape[0]
    lower, upper, cost, resistance = np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    held = np.zeros(m, dtype=np.int64)
    own.column_of(params, own.LOWER, lower)
    own.column_of(params, own.UPPER, upper)
    own.column_of(params, own.COST, cost)
    own.column_of(params, own.RESISTANCE, resistance)
    for k in range(m):
        u[k], held[k] = memory[LAST_U + k], int(memory[LAST_HELD + k])
    weight = params[own.WEIGHT : own.WEIGHT + 6]
    power_max, share = params[own.POWER_MAX], params[own.SHARE]
    allocate_power_kernel(effect, loads_b, weight, cost, lower, upper, resistance, power_max, share, u, held)
    for k in range(m):
        memory[LAST_HELD + k] = held[k]


@njit(cache=True, error_model="numpy")
def told(q_hb, u, effect, memory, params):
    """The command of controls u (m,), brought within limits; what it gives is kept for (2)."""
    m = u.shape[0]
    for k in range(m):
        at = own.TABLE + own.WIDTH * k
        u[k] = min(max(u[k] if isfinite(u[k]) else 0.0, params[at + own.LOWER]), params[at + own.UPPER])
        memory[LAST_U + k] = u[k]
    given = np.zeros(6)
    for j in range(6):
        for k in range(m):
            given[j] += effect[j, k] * u[k]
    force = to_inertial(q_hb, (given[0], given[1], given[2]))
    for j in range(3):
        memory[GIVEN + j], memory[GIVEN + 3 + j] = force[j], given[3 + j]
    out = np.zeros(int(params[own.THRUSTERS]) + int(params[own.CONDUCTORS]))
    own.commanded(params, u, out)
    return out


@njit(cache=True, error_model="numpy")
def silent(memory, params):
    """No command at all: what is needed is not known."""
    for k in range(6):
        memory[GIVEN + k] = 0.0
    return np.zeros(int(params[own.THRUSTERS]) + int(params[own.CONDUCTORS]))
