"""Laws that want loads and let the allocation find the controls.

    tracking-allocated   loads = (1) of `tracking_loop` - K e,   K one gain (6, 12) of a regulator whose inputs are loads
    tracking-periodic    loads = (1) - E(B) K(t) e,   K(t) (m, 12) of the periodic regulator of the controls themselves
    tracking-scheduled   the same with K(t) of the regulator of each instant, as if the field then stood still

The first needs controls that give any load at any time (a thruster across the orbit beside the conductors), and then its
loop is that of constant coefficients whatever the field does. The second knows what the controls can do at each time of the
day and what they will be able to do: it serves vehicles that cannot push everywhere always. The third schedules gains
over the sidereal day, linear between 120 nodes an orbit: it needs every motion to be within reach at every instant.
"""

from __future__ import annotations

from math import floor

import numpy as np
from numba import njit

from fieldline.control.tracking import onboard_vehicle as own
from fieldline.control.tracking.tracking_loop import allocated, in_body, prepared, silent, told

NODES, STEP, TABLE = 0, 1, 2  # of the law's own numbers: nodes of the gains, their step [s], the gains


@njit(cache=True, error_model="numpy")
def within_reach(params, error):
    """Errors of place cut to what a part of the loads answers; see `designs.reached`."""
    for j in range(3):
        most = params[own.REACH + j]
        error[2 * j] = min(max(error[2 * j], -most), most)


@njit(cache=True, error_model="numpy")
def tracking_allocated(t, measurement, memory, params):
    """Thrusts and currents of `tracking-allocated`."""
    m = int(params[own.CONTROLS])
    x, error, loads, effect = np.zeros(12), np.zeros(12), np.zeros(6), np.zeros((6, m))
    known, q_hb = prepared(t, measurement, memory, params, x, error, loads, effect)
    if not known:
        return silent(memory, params)
    at = own.law_at(params)
    within_reach(params, error)
    for k in range(6):
        for j in range(12):
            loads[k] -= params[at + 12 * k + j] * error[j]
    wanted, u = np.zeros(6), np.zeros(m)
    in_body(q_hb, loads, wanted)
    allocated(wanted, effect, memory, params, u)
    return told(q_hb, u, effect, memory, params)


@njit(cache=True, error_model="numpy")
def gained(t, params, at, error, m, out):
    """out (m,) = K(t) error, linear between the nodes of a day's table."""
    nodes, step = int(params[at + NODES]), params[at + STEP]
    turns = t / (nodes * step)
    place = (turns - floor(turns)) * nodes
    lower = int(place) % nodes
    share = place - floor(place)
    first, second = at + TABLE + 12 * m * lower, at + TABLE + 12 * m * ((lower + 1) % nodes)
    for k in range(m):
        total = 0.0
        for j in range(12):
            gain = (1.0 - share) * params[first + 12 * k + j] + share * params[second + 12 * k + j]
            total += gain * error[j]
        out[k] = total


@njit(cache=True, error_model="numpy")
def tracking_periodic(t, measurement, memory, params):
    """Thrusts and currents of `tracking-periodic` and `tracking-scheduled`, which differ in their table alone."""
    m = int(params[own.CONTROLS])
    x, error, loads, effect = np.zeros(12), np.zeros(12), np.zeros(6), np.zeros((6, m))
    known, q_hb = prepared(t, measurement, memory, params, x, error, loads, effect)
    if not known:
        return silent(memory, params)
    wanted, u = np.zeros(6), np.zeros(m)
    within_reach(params, error)
    gained(t, params, own.law_at(params), error, m, u)
    in_body(q_hb, loads, wanted)
    for k in range(6):
        for j in range(m):
            wanted[k] -= effect[k, j] * u[j]
    allocated(wanted, effect, memory, params, u)
    return told(q_hb, u, effect, memory, params)
