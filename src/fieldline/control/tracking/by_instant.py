"""The regulator of one instant, as the thesis has it: u = M r - K x, each control cut at its own limit.

`feed_forward = "turning"` takes M r from the field of now instead: the controls of least power that hold the path, u_r, and
u = u_r - K (x - x_r). K stays that of its instant: the field turns and it does not.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fieldline.control.tracking import onboard_vehicle as own
from fieldline.control.tracking.tracking_loop import allocated, in_body, prepared, silent, told

TURNING, GAIN = 0, 1  # of the law's own numbers: the switch; K (m, 12), then M (m, 6)


@njit(cache=True, error_model="numpy")
def tracking_frozen(t, measurement, memory, params):
    """Thrusts and currents of `tracking-frozen`."""
    m = int(params[own.CONTROLS])
    x, error, loads, effect = np.zeros(12), np.zeros(12), np.zeros(6), np.zeros((6, m))
    known, q_hb = prepared(t, measurement, memory, params, x, error, loads, effect)
    if not known:
        return silent(memory, params)
    at = own.law_at(params)
    u = np.zeros(m)
    turning = params[at + TURNING] > 0.5
    if turning:
        wanted = np.zeros(6)
        in_body(q_hb, loads, wanted)
        allocated(wanted, effect, memory, params, u)
    for k in range(m):
        for j in range(12):
            u[k] -= params[at + GAIN + 12 * k + j] * (error[j] if turning else x[j])
        for j in range(6):
            reference = x[2 * j] - error[2 * j]
            u[k] += 0.0 if turning else params[at + GAIN + 12 * m + 6 * k + j] * reference
    return told(q_hb, u, effect, memory, params)
