"""The log of loads: force_i [N] and torque_b [N m] of each load on each body, where a log is kept."""

from __future__ import annotations

from fieldline.compiled import inner

# Rows of the log, one a load.
LOADS = (
    "gravity",
    "gravity_gradient",
    "torquers",
    "dipoles",
    "eddy_currents",
    "hysteresis",
    "drag",
    "solar_pressure",
    "thrusters",
    "wheels",
    "lines",
    "disturbance",
    "user",
    "conductors",
)
(GRAVITY, GRADIENT, TORQUERS, DIPOLES, EDDY, HYSTERESIS, DRAG, SOLAR, THRUSTERS, WHEELS, LINES, DISTURBANCE, USER, CONDUCTORS) = (
    range(14)
)


@inner
def note(log, load, b, force_i, torque_b):
    """Keep a load's force and torque, where a log (loads, bodies, 6) is kept."""
    if log.shape[0] > 0:
        for j in range(3):
            log[load, b, j] = force_i[j]
            log[load, b, 3 + j] = torque_b[j]


@inner
def impose(log, load, b, force_i, torque_b, out):
    """Add a load to those of body b in `out` (bodies, 6), and to the log where one is kept."""
    for j in range(3):
        out[b, j] += force_i[j]
        out[b, 3 + j] += torque_b[j]
        if log.shape[0] > 0:
            log[load, b, j] += force_i[j]
            log[load, b, 3 + j] += torque_b[j]
