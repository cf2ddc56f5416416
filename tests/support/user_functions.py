"""Functions of a user's own, as tests name them: "user_functions:push"."""

import numpy as np
from numba import njit


def push(t, state, parameters):
    """A force along the velocity and a torque along the rate, growing with time: plain Python."""
    gain = parameters[0] * (1.0 + 0.001 * t)
    return [gain * v for v in (*state[3:6], *state[10:13])]


@njit
def pull(t, state, parameters):
    """Against the place, a torque from the attitude: compiled."""
    out = np.empty(6)
    for j in range(3):
        out[j] = -parameters[0] * state[j]
        out[3 + j] = parameters[1] * state[6 + j]
    return out


def clock(t, state, parameters):
    """An event's quantity: time less a parameter, plain Python."""
    return [t - parameters[0]]


@njit
def height(t, state, parameters):
    """An event's quantity: the place over the equator's plane [m], compiled."""
    return np.array([state[2] - parameters[0]])


def fails_late(t, state, parameters):
    """Raises once the time has come."""
    if t >= parameters[0]:
        raise ValueError("the load has had enough")
    return [0.0] * 6


def not_finite_late(t, state, parameters):
    """NaN once the time has come."""
    return [float("nan") if t >= parameters[0] else 0.0] * 6


def short_late(t, state, parameters):
    """Five numbers once the time has come."""
    return [0.0] * (5 if t >= parameters[0] else 6)


def none_late(t, state, parameters):
    """Nothing once the time has come."""
    return None if t >= parameters[0] else [0.0] * 6


def wave(t, measurement, memory, params):
    """A dipole that swings with time, the field and what was remembered; nothing fancy, the same bits either way."""
    out = np.empty(3)
    for j in range(3):
        memory[j] = 0.9 * memory[j] + params[0] * measurement.field_b[j]
        out[j] = memory[j] + params[1] * t + params[2] * measurement.rate_b[j]
    return out


compiled_wave = njit(wave)


def ramp(t, measurement, memory, params):
    """A command that tells its call: params times the number of the call from 1."""
    memory[0] += 1.0
    return [p * memory[0] for p in params]


def steady(t, measurement, memory, params):
    """The parameters themselves."""
    return params


def trouble(t, measurement, memory, params):
    """Does the harm of kind params[0] from time params[1] on."""
    kind = int(params[0]) if t >= params[1] else 0
    if kind == 1:
        raise RuntimeError("the law gave up")
    if kind == 2:
        return [float("nan"), 0.0, 0.0]
    if kind == 3:
        return [0.0, 0.0]
    if kind == 4:
        return None
    if kind == 5:
        raise KeyboardInterrupt
    if kind == 6:
        return "wrong"
    if kind == 7:
        return [float("inf")] * 3
    if kind == 8:
        return np.zeros((100, 3))
    return [0.0, 0.0, 0.0]


def knows_later(t, measurement, memory, params):
    """An estimator that knows nothing until params[0], then params[1:8]."""
    return [] if t < params[0] else params[1:8]


def listens(t, measurement, memory, params):
    """A controller that writes down what is known on board."""
    memory[0:4] = measurement.q_bi
    memory[4:7] = measurement.omega_bi_b
    memory[7:13] = measurement.valid
    memory[13:16] = measurement.dipole_b
    memory[16 : 16 + len(measurement.wheel_momentum)] = measurement.wheel_momentum
    memory[20:23] = measurement.field_i
    memory[23] += 1.0
    return [1e-3 * v for v in memory[4:7]] if measurement.valid[4] else [0.0, 0.0, 0.0]


@njit
def compiled_law_raises(t, measurement, memory, params):
    """Divides by what is zero from 30 s on: a compiled law raises too."""
    out = np.zeros(3)
    out[0] = 1.0 / (memory[0] if t > 29.0 else 1.0)
    return out


@njit
def compiled_raises(t, state, parameters):
    """A compiled load, or event's quantity, that raises from 30 s on."""
    if t >= 30.0:
        raise ValueError("compiled and cross")
    return np.ones(6) * 1e-9


@njit
def compiled_short(t, state, parameters):
    """A compiled load, or event's quantity, without numbers from 30 s on."""
    return np.ones(6 if t < 30.0 else 0) * 1e-9
