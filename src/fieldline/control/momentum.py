"""Momentum drawn out of the wheels by the field, at all times or between two thresholds.

    M = -K (B x (H - H_wanted)) / B^2                                                              (11)

H is the momentum of all wheels in body axes. The part along B stays until the field has turned. Intermittent operation:
dumping begins when |H - H_wanted| exceeds `start_n_m_s` and ends when it falls below `stop_n_m_s`.

K not given: 2 n (1 + sin i), the rate at which the field itself turns, by analogy with (22). Faster is no better: the part
across B is gone before the field has brought up the next.

Source: White, Shigemoto and Bourquin (1961), NASA TN D-1068, equations (11) and (12).
"""

from __future__ import annotations

from math import sin

import numpy as np
from numba import njit

from fieldline.control.coils import dumping_moment
from fieldline.control.law import Law, Parameter, complete
from fieldline.control.readings import field_known, finite3, lifted, wheel_momentum_b
from fieldline.control.residual_dipole import packed_wheels
from fieldline.control.saturation import as_command
from fieldline.errors import InputError
from fieldline.frames.vectors import norm, sub

GAIN, WANTED, START, STOP, WHEELS = 0, 1, 4, 5, 6
DUMP_SIZE = 6
DUMPING = 0
MEMORY = 1
ZERO = (0.0, 0.0, 0.0)


@njit(cache=True)
def dump(measurement, momentum_b, memory, m0, params, p0):
    """Moment of equation (11), with the hysteresis of the thresholds."""
    wanted = (params[p0 + WANTED], params[p0 + WANTED + 1], params[p0 + WANTED + 2])
    excess = sub(momentum_b, wanted)
    if not (field_known(measurement) and finite3(excess)):
        return ZERO
    size = norm(excess)
    if memory[m0 + DUMPING] < 0.5:
        memory[m0 + DUMPING] = 1.0 if size >= params[p0 + START] else 0.0
    elif size < params[p0 + STOP]:
        memory[m0 + DUMPING] = 0.0
    if memory[m0 + DUMPING] < 0.5:
        return ZERO
    return dumping_moment(lifted(measurement.field_b), excess, params[p0 + GAIN])  # (11)


@njit(cache=True)
def momentum_dump(t, measurement, memory, params):
    """The law by itself."""
    moment = dump(measurement, wheel_momentum_b(measurement, params, WHEELS), memory, 0, params, 0)
    return as_command(moment)


PARAMETERS = {
    "gain_per_s": Parameter("1/s", "K; derived as 2 n (1 + sin i)", kind="positive", derived=True),
    "wanted_momentum_n_m_s": Parameter("N m s", "momentum to be left in the wheels, body axes", (0.0, 0.0, 0.0), "vector"),
    "start_n_m_s": Parameter("N m s", "dumping begins above it; 0 is always", 0.0, "not negative"),
    "stop_n_m_s": Parameter("N m s", "and ends below it; derived as a third of start", kind="not negative", derived=True),
}


def packed_dump(law: str, values: dict, context) -> np.ndarray:
    """The `DUMP_SIZE` numbers, from checked parameters."""
    gain = values["gain_per_s"]
    gain = 2.0 * context.mean_motion_rad_s * (1.0 + sin(context.inclination_rad)) if gain is None else gain
    start, stop = values["start_n_m_s"], values["stop_n_m_s"]
    stop = start / 3.0 if stop is None else stop
    if stop > start:
        raise InputError(f'stop_n_m_s of the law "{law}" must not be above start_n_m_s; got {stop:g} and {start:g}.')
    return np.array([gain, *values["wanted_momentum_n_m_s"], start, stop])


def _pack(table, context) -> np.ndarray:
    values = complete("momentum-dump", PARAMETERS, table)
    return np.concatenate([packed_dump("momentum-dump", values, context), packed_wheels(context)])


LAWS = (
    Law(
        "momentum-dump", momentum_dump, PARAMETERS, MEMORY, ("dipole",), "draws the wheels' momentum out through the field", _pack
    ),
)
