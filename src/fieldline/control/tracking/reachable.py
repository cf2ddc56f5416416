"""Which part of a wanted place limits on the controls can hold, over a day of the field.

At each instant the loads of holding are linear in the place; s of them can be given within the limits for every s up to a
largest one, found by halving with the allocation as the judge. A place counts as held that can be held for nine tenths of
the day: the field across the orbit, say, vanishes twice an orbit at high inclinations, and a heavy body waits that out. A moment
that is missed by what gravity does to a milliradian counts as given: a place along the orbit asks for less, and a body that
does not get it hangs turned by y/r0.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fieldline.control.tracking import onboard_vehicle as own
from fieldline.control.tracking.allocation import MET, allocate_kernel
from fieldline.mechanics.relative_motion import holding_force, holding_moment

HELD_PART = 0.9  # of the day
SAMPLES = 240
HALVINGS = 14
KEPT_RAD = 1e-3


@njit(cache=True, error_model="numpy")
def shares_kernel(effects, loads, weight, slack, cost, lower, upper, out):
    """out (N,): largest share, up to 1, of loads (6,) that the controls give to slack (6,) at each instant, effects (N, 6, m)."""
    m = lower.shape[0]
    u, held, wanted = np.zeros(m), np.zeros(m, dtype=np.int64), np.zeros(6)
    for k in range(effects.shape[0]):
        low, high, share = 0.0, 1.0, 1.0
        for _ in range(HALVINGS):
            size, missed = 0.0, 0.0
            for j in range(6):
                wanted[j] = share * loads[j]
            allocate_kernel(effects[k], wanted, weight, cost, lower, upper, 1e-9, u, held)
            for j in range(6):
                given = 0.0
                for i in range(m):
                    given += effects[k, j, i] * u[i]
                size += (weight[j] * wanted[j]) ** 2
                missed += (weight[j] * max(abs(wanted[j] - given) - slack[j], 0.0)) ** 2
            if missed <= MET * MET * size:
                low = share
                if share == 1.0:
                    break
            else:
                high = share
            share = 0.5 * (low + high)
        out[k] = low


def nearest_held(place, effects, controls, mass, moments, n: float, radius: float, weights) -> float:
    """Share of the place (3,) [m], axes h, that can be held for HELD_PART of the day; 1 for all of it."""
    place = np.asarray(place, dtype=float)
    loads = np.concatenate([holding_force(n, mass, place), holding_moment(n, radius, moments, place)])
    if not np.abs(loads).any():
        return 1.0
    few = np.ascontiguousarray(effects[:: max(1, len(effects) // SAMPLES)])
    lower, upper, cost = (np.ascontiguousarray(controls[:, which]) for which in (own.LOWER, own.UPPER, own.COST))
    shares = np.empty(len(few))
    slack = np.repeat([0.0, 3.0 * n * n * np.ptp(moments) * KEPT_RAD], 3)
    shares_kernel(few, loads, np.asarray(weights, dtype=float), slack, cost, lower, upper, shares)
    return float(np.quantile(shares, 1.0 - HELD_PART))
