"""The dipole that a satellite carries unasked, estimated from how it turns, and cancelled.

A Kalman filter of six states, the rate w and a constant dipole m in body axes. Between two calls

    J dw/dt = (d M + m) x B + T_g - w x (J w + H) - dH/dt + noise                                  (33)

with the commanded dipole M (in force for the part d of the time, the torquers' duty cycle), the field B read at both ends,
the gravity gradient T_g where position and attitude are known, and the wheels' momentum H as they report it. The measured
rate corrects both. What lies along B is not seen until the field has turned, a quarter of an orbit later: the covariance
knows. Every other constant torque of body axes that changes like m x B is taken for a dipole too.

Cancelling is to add -m to the moment: `cancel_residual` of the pointing laws, or the law `residual-dipole` by itself.

Memory: a flag, the time, w, m, three covariance blocks (w w), (w m), (m m), then the field and H of the last call. Kernels
take the place `m0` of the filter in a law's memory and `p0` of its numbers in the law's params.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.control.law import Law, Parameter, complete
from fieldline.control.readings import attitude_known, field_known, lifted, orbit_known, rate_known, wheel_momentum_b
from fieldline.frames.attitude import to_body
from fieldline.frames.matrices import (
    IDENTITY,
    diagonal,
    inverse,
    matadd,
    matmul,
    matmul_t,
    matscale,
    matsub,
    matvec,
    skew,
    symmetric,
    transpose,
)
from fieldline.frames.vectors import add, axpy, cross, scale, sub
from fieldline.mechanics.rigid_body import gravity_gradient_torque

HAS, TIME, RATE, DIPOLE, P_WW, P_WM, P_MM, FIELD, MOMENTUM = 0, 1, 2, 5, 8, 17, 26, 35, 38
MEMORY = 41
ON, INERTIA, INVERSE, RATE_VAR, TORQUE_DENSITY, DIPOLE_VAR, DRIFT, DUTY, GAP = 0, 1, 10, 19, 20, 21, 22, 23, 24
SIZE = 25
ZERO = (0.0, 0.0, 0.0)


@njit(cache=True)
def _matrix(a, k):
    return (a[k], a[k + 1], a[k + 2], a[k + 3], a[k + 4], a[k + 5], a[k + 6], a[k + 7], a[k + 8])


@njit(cache=True)
def _vector(a, k):
    return (a[k], a[k + 1], a[k + 2])


@njit(cache=True)
def _store(a, k, v):
    for j in range(len(v)):
        a[k + j] = v[j]


@njit(cache=True)
def _known_torque(measurement, params, p0):
    """Gravity gradient [N m], zero where attitude or position is not known."""
    if not (attitude_known(measurement) and orbit_known(measurement)):
        return ZERO
    q = measurement.q_bi
    position_b = to_body((q[0], q[1], q[2], q[3]), lifted(measurement.position_i))
    return gravity_gradient_torque(position_b, _matrix(params, p0 + INERTIA), EARTH_GM_M3_S2)


@njit(cache=True)
def _predict(dt, measurement, momentum_b, memory, m0, params, p0):
    """Rate and covariance brought to now by (33), first order in the step; the dipole stays."""
    inertia, inv = _matrix(params, p0 + INERTIA), _matrix(params, p0 + INVERSE)
    rate, dipole = _vector(memory, m0 + RATE), _vector(memory, m0 + DIPOLE)
    middle = scale(0.5, add(rate, lifted(measurement.omega_bi_b)))
    field = scale(0.5, add(_vector(memory, m0 + FIELD), lifted(measurement.field_b)))
    whole = add(matvec(inertia, middle), momentum_b)
    moment = axpy(params[p0 + DUTY], lifted(measurement.dipole_b), dipole)
    torque = add(cross(moment, field), _known_torque(measurement, params, p0))
    wheels = sub(momentum_b, _vector(memory, m0 + MOMENTUM))
    push = sub(scale(dt, sub(torque, cross(middle, whole))), wheels)
    _store(memory, m0 + RATE, add(rate, matvec(inv, push)))
    A = matadd(IDENTITY, matscale(dt, matmul(inv, matsub(skew(whole), matmul(skew(middle), inertia)))))
    C = matscale(-dt, matmul(inv, skew(field)))
    ww, wm, mm = _matrix(memory, m0 + P_WW), _matrix(memory, m0 + P_WM), _matrix(memory, m0 + P_MM)
    A_wm_Ct = matmul_t(matmul(A, wm), C)
    ww = matadd(matmul_t(matmul(A, ww), A), matadd(matmul_t(matmul(C, mm), C), matadd(A_wm_Ct, transpose(A_wm_Ct))))
    ww = matadd(ww, matscale(dt * params[p0 + TORQUE_DENSITY], matmul_t(inv, inv)))
    drift = dt * params[p0 + DRIFT]
    _store(memory, m0 + P_WW, symmetric(ww))
    _store(memory, m0 + P_WM, matadd(matmul(A, wm), matmul(C, mm)))
    _store(memory, m0 + P_MM, matadd(mm, diagonal(drift, drift, drift)))


@njit(cache=True)
def _correct(measurement, memory, m0, params, p0):
    """The measured rate corrects rate and dipole."""
    ww, wm, mm = _matrix(memory, m0 + P_WW), _matrix(memory, m0 + P_WM), _matrix(memory, m0 + P_MM)
    noise = params[p0 + RATE_VAR]
    weight = inverse(matadd(ww, diagonal(noise, noise, noise)))
    gain_w, gain_m = matmul(ww, weight), matmul(transpose(wm), weight)
    rate, dipole = _vector(memory, m0 + RATE), _vector(memory, m0 + DIPOLE)
    news = sub(lifted(measurement.omega_bi_b), rate)
    _store(memory, m0 + RATE, add(rate, matvec(gain_w, news)))
    _store(memory, m0 + DIPOLE, add(dipole, matvec(gain_m, news)))
    _store(memory, m0 + P_MM, symmetric(matsub(mm, matmul(gain_m, wm))))
    _store(memory, m0 + P_WM, matsub(wm, matmul(gain_w, wm)))
    _store(memory, m0 + P_WW, symmetric(matsub(ww, matmul(gain_w, ww))))


@njit(cache=True)
def _begin(measurement, memory, m0, params, p0):
    """The rate as measured; of the dipole only how large it may be, unless it was known before."""
    noise = params[p0 + RATE_VAR]
    if memory[m0 + HAS] == 0.0:
        v = params[p0 + DIPOLE_VAR]
        _store(memory, m0 + P_MM, diagonal(v, v, v))
    memory[m0 + HAS] = 1.0
    _store(memory, m0 + RATE, lifted(measurement.omega_bi_b))
    _store(memory, m0 + P_WW, diagonal(noise, noise, noise))
    _store(memory, m0 + P_WM, matscale(0.0, IDENTITY))


@njit(cache=True)
def residual_dipole_estimate(t, measurement, momentum_b, memory, m0, params, p0):
    """Dipole [A m^2], body axes, as known after this call; zero where the filter is off, the last one in a gap of data."""
    if params[p0 + ON] < 0.5:
        return ZERO
    if not (field_known(measurement) and rate_known(measurement)):
        return _vector(memory, m0 + DIPOLE)
    dt = t - memory[m0 + TIME]
    if memory[m0 + HAS] > 0.5 and 0.0 < dt <= params[p0 + GAP]:
        _predict(dt, measurement, momentum_b, memory, m0, params, p0)
        _correct(measurement, memory, m0, params, p0)
    else:
        _begin(measurement, memory, m0, params, p0)
    memory[m0 + TIME] = t
    _store(memory, m0 + FIELD, lifted(measurement.field_b))
    _store(memory, m0 + MOMENTUM, momentum_b)
    return _vector(memory, m0 + DIPOLE)


@njit(cache=True)
def residual_dipole(t, measurement, memory, params):
    """The law by itself: minus the estimate."""
    momentum_b = wheel_momentum_b(measurement, params, SIZE)
    estimate = residual_dipole_estimate(t, measurement, momentum_b, memory, 0, params, 0)
    command = np.empty(3)
    for j in range(3):
        command[j] = -estimate[j]
    return command


FILTER_PARAMETERS = {
    "residual_std_a_m2": Parameter(
        "A m^2", "how large the residual dipole may be, 1 sigma per axis; derived as a tenth of the torquers'", kind="positive", derived=True
    ),
    "residual_drift_a_m2_day": Parameter("A m^2", "how far it may wander in a day; derived as a tenth of it", kind="not negative", derived=True),
    "rate_noise_deg_s": Parameter("deg/s", "noise of the known rate, 1 sigma per axis and call", 1e-3, "positive"),
    "torque_noise_n_m": Parameter(
        "N m", "other unknown torque; derived as a fifth of the residual dipole's in 30 microtesla", kind="positive", derived=True
    ),
    "torque_noise_time_s": Parameter("s", "for how long that torque keeps its value", 60.0, "positive"),
    "duty_cycle": Parameter("", "part of the time for which a commanded dipole is in force", 1.0, "positive"),
}
CANCEL_PARAMETERS = {
    "cancel_residual": Parameter("", "estimate the residual dipole and cancel it", False, "switch"),
    **FILTER_PARAMETERS,
}


def packed_filter(values: dict, context, on: bool) -> np.ndarray:
    """The filter's `SIZE` numbers, from checked parameters."""
    size = values["residual_std_a_m2"]
    size = 0.1 * float(np.max(context.moment_max_a_m2)) if size is None else size
    drift = 0.1 * size if values["residual_drift_a_m2_day"] is None else values["residual_drift_a_m2_day"]
    torque = 0.2 * size * 3e-5 if values["torque_noise_n_m"] is None else values["torque_noise_n_m"]
    inertia = np.asarray(context.inertia_kg_m2, dtype=float)
    return np.array(
        [
            float(on),
            *inertia.ravel(),
            *np.linalg.inv(inertia).ravel(),
            np.radians(values["rate_noise_deg_s"]) ** 2,
            2.0 * torque**2 * values["torque_noise_time_s"],  # density of a torque that forgets itself in that time
            size**2,
            drift**2 / 86400.0,
            values["duty_cycle"],
            max(60.0, 5.0 * context.period_s),
        ]
    )


def packed_wheels(context) -> np.ndarray:
    """Number of wheels and their axes, as `readings.wheel_momentum_b` reads them."""
    axes = np.asarray(context.wheel_axes_b, dtype=float).reshape(-1, 3)
    return np.array([float(len(axes)), *axes.ravel()])


def _pack(table, context) -> np.ndarray:
    values = complete("residual-dipole", FILTER_PARAMETERS, table)
    return np.concatenate([packed_filter(values, context, True), packed_wheels(context)])


LAWS = (
    Law(
        "residual-dipole",
        residual_dipole,
        FILTER_PARAMETERS,
        MEMORY,
        ("dipole",),
        "estimates the satellite's own constant dipole and cancels it",
        _pack,
    ),
)
