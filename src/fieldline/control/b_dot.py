"""B-dot: a tumbling body is stopped by a moment against the field's change in body axes.

    b-dot            M = -k / |B|^2 dB/dt                                                           (20)
    b-dot-bang-bang  M_j = -M_max,j sign(dB_j/dt)                                                   (21)
    gain             k = 2 n (1 + sin i) J_min                                                      (22)

A body that turns at omega sees dB/dt = -omega x B and the field's own change, about 2n |B|. With the first part alone (20)
is the torque -k omega_perp, which takes k |omega_perp|^2 of power from the body and never gives any.

dB/dt is the difference of two readings over the time between them, smoothed by a low-pass of first order if asked, or
-omega x B from the gyro (`derivative = "gyro"`). Readings may be rarer than calls (torquers and magnetometer taking turns):
between two readings the command stands. A reading that is missing, invalid or older than `gap_s` breaks the chain: the
command is zero until two good readings have come. With the gyro one reading is enough.

Handover: |dB/dt| / |B| is the rate across the field as the magnetometer sees it. Below `rate_off_deg_s` the law rests
(zero moment) until the rate exceeds `rate_on_deg_s`. A body at rest in inertial space still sees up to about 2 n (1 + sin i),
near 0.2 deg/s in low orbit: a threshold below that is never reached.

Sources: (20) and (22) Avanzini and Giulietti (2012), Magnetic detumbling of a rigid spacecraft, JGCD 35(4):1326;
(21) Stickler and Alfriend (1976), Elementary magnetic attitude control system, J. Spacecraft 13(5):282.
"""

from __future__ import annotations

from math import radians, sin, sqrt

import numpy as np
from numba import njit

from fieldline.compiled import kernel
from fieldline.control.law import Law, Parameter, complete
from fieldline.control.readings import field_known, finite3, gyro_known, lifted
from fieldline.frames.vectors import axpy, cross, dot, scale, sub

# params of both laws: GAIN of (20), moment of (21) on X, Y, Z
GAIN, MOMENT_X, MOMENT_Y, MOMENT_Z, USE_GYRO, LOW_PASS, GAP, RATE_OFF, RATE_ON, DEAD_BAND = range(10)
# memory: has a reading, its time, its field, has a derivative, the derivative, is resting, the command
HAS_FIELD, TIME, FIELD_X, HAS_CHANGE, CHANGE_X, RESTING, COMMAND_X = 0, 1, 2, 5, 6, 9, 10
MEMORY = 13


@kernel
def _store(memory, first, v):
    memory[first] = v[0]
    memory[first + 1] = v[1]
    memory[first + 2] = v[2]


@kernel
def _stored(memory, first):
    return (memory[first], memory[first + 1], memory[first + 2])


@kernel
def field_change(measurement, memory, params):
    """Whether dB/dt [T/s] in body axes is known at a new reading, and its value; memory takes the reading in."""
    field_b = lifted(measurement.field_b)
    if params[USE_GYRO] > 0.5:
        if not gyro_known(measurement):
            return False, (0.0, 0.0, 0.0)
        return True, cross(field_b, lifted(measurement.rate_b))
    gap = measurement.field_time_s[0] - memory[TIME]
    before = _stored(memory, FIELD_X)
    chained = memory[HAS_FIELD] > 0.5 and 0.0 < gap <= params[GAP]
    memory[HAS_FIELD] = 1.0
    memory[TIME] = measurement.field_time_s[0]
    _store(memory, FIELD_X, field_b)
    if not chained:
        memory[HAS_CHANGE] = 0.0
        return False, (0.0, 0.0, 0.0)
    change = scale(1.0 / gap, sub(field_b, before))
    if memory[HAS_CHANGE] > 0.5:
        past = _stored(memory, CHANGE_X)
        change = axpy(gap / (params[LOW_PASS] + gap), sub(change, past), past)
    memory[HAS_CHANGE] = 1.0
    _store(memory, CHANGE_X, change)
    return True, change


@kernel
def _rests(change, field_b, memory, params):
    """Hysteresis of the handover: whether the law gives no moment now."""
    rate = sqrt(dot(change, change) / dot(field_b, field_b))
    if memory[RESTING] > 0.5:
        memory[RESTING] = 0.0 if rate > params[RATE_ON] else 1.0
    elif rate < params[RATE_OFF]:
        memory[RESTING] = 1.0
    return memory[RESTING] > 0.5


@kernel
def _change_to_act_on(t, measurement, memory, params):
    """(act, hold, dB/dt): act on a new derivative, hold the last command, or neither, which is no moment at all."""
    if not field_known(measurement):
        memory[HAS_FIELD] = 0.0
        memory[HAS_CHANGE] = 0.0
        return False, False, (0.0, 0.0, 0.0)
    if params[USE_GYRO] < 0.5 and memory[HAS_FIELD] > 0.5 and measurement.field_time_s[0] == memory[TIME]:
        return False, t - memory[TIME] <= params[GAP], (0.0, 0.0, 0.0)
    known, change = field_change(measurement, memory, params)
    known = known and finite3(change)
    return known and not _rests(change, lifted(measurement.field_b), memory, params), False, change


@njit(cache=True)
def _answer(hold, moment, memory):
    """The command as an array; a new one is kept for the calls until the next reading."""
    if not hold:
        _store(memory, COMMAND_X, moment)
    command = np.empty(3)
    for j in range(3):
        command[j] = memory[COMMAND_X + j]
    return command


@njit(cache=True)
def b_dot(t, measurement, memory, params):
    """Moment of equation (20)."""
    act, hold, change = _change_to_act_on(t, measurement, memory, params)
    moment = (0.0, 0.0, 0.0)
    if act:
        field_b = lifted(measurement.field_b)
        moment = scale(-params[GAIN] / dot(field_b, field_b), change)  # (20)
    return _answer(hold, moment, memory)


@kernel
def _against(change, moment_max, dead_band):
    """One axis of equation (21): zero within the dead band."""
    if abs(change) <= dead_band:
        return 0.0
    return -moment_max if change > 0.0 else moment_max


@njit(cache=True)
def b_dot_bang_bang(t, measurement, memory, params):
    """Moment of equation (21)."""
    act, hold, change = _change_to_act_on(t, measurement, memory, params)
    moment = (0.0, 0.0, 0.0)
    if act:
        band = params[DEAD_BAND]
        moment = (
            _against(change[0], params[MOMENT_X], band),
            _against(change[1], params[MOMENT_Y], band),
            _against(change[2], params[MOMENT_Z], band),
        )
    return _answer(hold, moment, memory)


_SHARED = {
    "derivative": Parameter(
        "", 'from "difference" of readings or "gyro"', "difference", "choice", choices=("difference", "gyro")
    ),
    "low_pass_s": Parameter("s", "time constant of the filter on the differences; 0 is none", 0.0, "not negative"),
    "gap_s": Parameter(
        "s", "longest time between two readings; derived as 60 s or five calls of the law", kind="positive", derived=True
    ),
    "rate_off_deg_s": Parameter("deg/s", "below this rate across the field the law rests; 0 is never", 0.0, "not negative"),
    "rate_on_deg_s": Parameter("deg/s", "above it works again; derived as 1.5 rate_off", kind="not negative", derived=True),
}
B_DOT_PARAMETERS = {
    "gain_n_m_s": Parameter("N m s", "k of M = -k/B^2 dB/dt; derived as 2 n (1 + sin i) J_min", kind="positive", derived=True),
    **_SHARED,
}
BANG_BANG_PARAMETERS = {
    "moment_a_m2": Parameter("A m^2", "moment per axis; derived as the torquers' largest", kind="vector", derived=True),
    "dead_band_tesla_s": Parameter("T/s", "no moment on an axis whose field changes less", 0.0, "not negative"),
    **_SHARED,
}


def b_dot_gain(mean_motion_rad_s: float, inclination_rad: float, inertia_kg_m2) -> float:
    """Gain k [N m s] of equation (20) by the rule (22); inertia (3, 3) [kg m^2]."""
    least = float(np.linalg.eigvalsh(np.asarray(inertia_kg_m2, dtype=float))[0])
    return 2.0 * mean_motion_rad_s * (1.0 + sin(inclination_rad)) * least  # (22)


def _packed(values: dict, context, gain: float, moment) -> np.ndarray:
    """The shared layout of both laws."""
    off = radians(values["rate_off_deg_s"])
    on = 1.5 * off if values["rate_on_deg_s"] is None else radians(values["rate_on_deg_s"])
    gap = max(60.0, 5.0 * context.period_s) if values["gap_s"] is None else values["gap_s"]
    gyro = float(values["derivative"] == "gyro")
    tail = (gyro, values["low_pass_s"], gap, off, max(on, off), values.get("dead_band_tesla_s", 0.0))
    return np.array([gain, *moment, *tail], dtype=float)


def _pack_b_dot(table, context) -> np.ndarray:
    values = complete("b-dot", B_DOT_PARAMETERS, table)
    gain = values["gain_n_m_s"]
    if gain is None:
        gain = b_dot_gain(context.mean_motion_rad_s, context.inclination_rad, context.inertia_kg_m2)
    return _packed(values, context, gain, (0.0, 0.0, 0.0))


def _pack_bang_bang(table, context) -> np.ndarray:
    values = complete("b-dot-bang-bang", BANG_BANG_PARAMETERS, table)
    moment = context.moment_max_a_m2 if values["moment_a_m2"] is None else values["moment_a_m2"]
    return _packed(values, context, 0.0, moment)


LAWS = (
    Law("b-dot", b_dot, B_DOT_PARAMETERS, MEMORY, ("dipole",), "stops a tumble: moment against the field's change", _pack_b_dot),
    Law(
        "b-dot-bang-bang",
        b_dot_bang_bang,
        BANG_BANG_PARAMETERS,
        MEMORY,
        ("dipole",),
        "stops a tumble: full moment against the sign of the field's change",
        _pack_bang_bang,
    ),
)
