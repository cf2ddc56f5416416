"""From tumbling to pointing by the field alone: one law that stops the tumble, waits for an attitude, then points.

    detumble    B-dot (20), from the start, and whenever the body turns fast or has no attitude
    point       one of the magnetic pointing laws, while the attitude is known and the body turns slowly

    r' = (|dB/dt| / |B| - r) / T                                                                    (41)

r is the field's turning rate in body axes, smoothed. Detumble becomes point once r < `point_below_deg_s` and attitude and
rate have been known for `dwell_s`; point becomes detumble once r > `detumble_above_deg_s` or they have been missing for
`patience_s`. Between the two thresholds nothing changes, so noise cannot make the modes alternate.

Torquers that act for a part d of the time only (`duty_cycle`) are told 1/d of what the pointing law asks for.
"""

from __future__ import annotations

from math import radians, sqrt

import numpy as np
from numba import njit

from fieldline.control import b_dot, magnetic_pd, magnetic_regulator, regulator_design
from fieldline.control.law import Law, Parameter, complete
from fieldline.control.readings import attitude_known, field_known, lifted, rate_known
from fieldline.errors import InputError
from fieldline.frames.vectors import dot

POINT_BELOW, DETUMBLE_ABOVE, DWELL, PATIENCE, RATE_TIME, DUTY, BY_GAINS = range(10, 17)
POINTING = 17  # params of the pointing law from here on
MODE, RATE, CALLED, HAS_CALLED, KNOWN_SINCE, MISSING_SINCE, KNOWN = range(b_dot.MEMORY, b_dot.MEMORY + 7)
POINTING_MEMORY = b_dot.MEMORY + 7
MEMORY = POINTING_MEMORY + max(magnetic_pd.MEMORY, magnetic_regulator.MEMORY)
DETUMBLE, POINT = 0.0, 1.0


@njit(cache=True)
def _smoothed_rate(t, measurement, memory, params):
    """r of (41) [rad/s] from what B-dot has just read."""
    dt = t - memory[CALLED] if memory[HAS_CALLED] > 0.5 else 0.0
    memory[HAS_CALLED] = 1.0
    memory[CALLED] = t
    if memory[b_dot.HAS_CHANGE] < 0.5 or not field_known(measurement):
        return memory[RATE]
    change, field = (memory[b_dot.CHANGE_X], memory[b_dot.CHANGE_X + 1], memory[b_dot.CHANGE_X + 2]), lifted(measurement.field_b)
    rate = sqrt(dot(change, change) / dot(field, field))
    if memory[RATE] < 0.0:
        memory[RATE] = rate
    memory[RATE] += dt / (dt + params[RATE_TIME]) * (rate - memory[RATE])
    return memory[RATE]


@njit(cache=True)
def _choose(t, known, rate, memory, params):
    """The mode from now on."""
    if known and memory[KNOWN] < 0.5:
        memory[KNOWN_SINCE] = t
    if not known and memory[KNOWN] > 0.5:
        memory[MISSING_SINCE] = t
    memory[KNOWN] = 1.0 if known else 0.0
    if memory[MODE] == DETUMBLE:
        if known and t - memory[KNOWN_SINCE] >= params[DWELL] and 0.0 <= rate < params[POINT_BELOW]:
            memory[MODE] = POINT
    elif rate > params[DETUMBLE_ABOVE] or (not known and t - memory[MISSING_SINCE] > params[PATIENCE]):
        memory[MODE] = DETUMBLE
        memory[POINTING_MEMORY:] = 0.0  # what the pointing law remembered is of another attitude


@njit(cache=True)
def magnetic_modes(t, measurement, memory, params):
    """The moment of the mode that holds now."""
    if memory[HAS_CALLED] < 0.5:
        memory[RATE] = -1.0  # none yet
    slowing = b_dot.b_dot(t, measurement, memory[: b_dot.MEMORY], params[:10])
    rate = _smoothed_rate(t, measurement, memory, params)
    _choose(t, attitude_known(measurement) and rate_known(measurement), rate, memory, params)
    if memory[MODE] == DETUMBLE:
        return slowing
    own, rest = memory[POINTING_MEMORY:], params[POINTING:]
    if params[BY_GAINS] > 0.5:
        return magnetic_regulator.magnetic_regulator(t, measurement, own, rest) / params[DUTY]
    return magnetic_pd.magnetic_pd(t, measurement, own, rest) / params[DUTY]


_POINTING_LAWS = {law.name: law for law in (*magnetic_pd.LAWS, *regulator_design.LAWS)}
_OWN = {
    "pointing": Parameter("", "law of the pointing mode", "magnetic-lqr-periodic", "choice", choices=tuple(_POINTING_LAWS)),
    "point_below_deg_s": Parameter("deg/s", "the field must turn slower in body axes before it points", 0.6, "positive"),
    "detumble_above_deg_s": Parameter(
        "deg/s", "above it B-dot again; derived as 2.5 times point_below", kind="positive", derived=True
    ),
    "dwell_s": Parameter("s", "for how long the attitude must have been known", 60.0, "not negative"),
    "patience_s": Parameter("s", "for how long it may be missing while pointing", 60.0, "not negative"),
    "rate_time_s": Parameter("s", "T of the smoothed rate", 120.0, "positive"),
}
_SLOWING = {key: value for key, value in b_dot.B_DOT_PARAMETERS.items() if key not in ("rate_off_deg_s", "rate_on_deg_s")}
PARAMETERS = {**_OWN, **_SLOWING, **magnetic_pd.PARAMETERS, **regulator_design.PARAMETERS}


def _pack(table, context) -> np.ndarray:
    values = complete("magnetic-modes", PARAMETERS, table)
    pointing = _POINTING_LAWS[values["pointing"]]
    for key in table:
        if key not in _OWN and key not in _SLOWING and key not in pointing.parameters:
            raise InputError(f'{key} of the law "magnetic-modes" has no meaning with pointing = "{pointing.name}"; leave it out.')
    below, above = values["point_below_deg_s"], values["detumble_above_deg_s"]
    above = 2.5 * below if above is None else above
    if above < below:
        raise InputError(f'detumble_above_deg_s of the law "magnetic-modes" must not be below point_below_deg_s; got {above:g}.')
    slowing = b_dot.LAWS[0].pack({k: v for k, v in table.items() if k in _SLOWING}, context)
    own = (radians(below), radians(above), values["dwell_s"], values["patience_s"], values["rate_time_s"], values["duty_cycle"])
    by_gains = float(pointing.kernel is magnetic_regulator.magnetic_regulator)
    rest = pointing.pack({k: v for k, v in table.items() if k in pointing.parameters}, context)
    return np.concatenate([slowing, own, [by_gains], rest])


LAWS = (
    Law(
        "magnetic-modes",
        magnetic_modes,
        PARAMETERS,
        MEMORY,
        ("dipole",),
        "stops a tumble, waits for an attitude, points: all by the field alone",
        _pack,
    ),
)
