"""The dipole and the torque that a satellite carries unasked, estimated from how it turns, and cancelled.

A Kalman filter of nine states in body axes: the rate w, a constant dipole m, a constant torque c (drag on a body that flies
the same side ahead, pressure of sunlight). Between two calls

    J dw/dt = (d M + m) x B + c + T_g - w x (J w + H) - dH/dt + noise                              (33)

with the commanded dipole M (in force for the part d of the time, the torquers' duty cycle), the field B read at both ends,
the gravity gradient T_g where position and attitude are known, and the wheels' momentum H as they report it. The measured
rate corrects all. Dipole and torque are told apart, and the dipole along B is seen at all, only as the field turns in body
axes, a quarter of an orbit later for a body that points: the covariance knows.

Cancelling is to command -m, and against c the moment -B x c / B^2, which gives -c less its part along B: `cancel_residual`
of the pointing laws, or the law `residual-dipole` by itself, which cancels m alone.

The step is of second order: good while the body turns, and nutates, by less than a tenth of a radian between two calls.

Memory: a flag, the time, the nine states, their covariance; field, H and gravity gradient at the last good call; the
commanded dipole times its seconds since then, and when the last call was. Kernels take the place `m0` of the filter in a
law's memory and `p0` of its numbers in the law's params.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fieldline.constants import EARTH_GM_M3_S2, SECONDS_PER_DAY
from fieldline.control.law import Law, Parameter, complete
from fieldline.control.readings import attitude_known, field_known, lifted, orbit_known, rate_known, wheel_momentum_b
from fieldline.control.saturation import as_command
from fieldline.frames.attitude import to_body
from fieldline.frames.matrices import matmul, matscale, matsub, matvec, skew
from fieldline.frames.vectors import add, axpy, cross, dot, scale, sub
from fieldline.mechanics.rigid_body import gravity_gradient_torque

STATES = 9
HAS, TIME, RATE, DIPOLE, TORQUE, COVARIANCE = 0, 1, 2, 5, 8, 11
FIELD = COVARIANCE + STATES * STATES
MOMENTUM, KNOWN_TORQUE, GIVEN, CALLED = FIELD + 3, FIELD + 6, FIELD + 9, FIELD + 12
MEMORY = CALLED + 1
ON, INERTIA, INVERSE, RATE_VAR, NOISE_DENSITY, DIPOLE_VAR, DIPOLE_DRIFT, TORQUE_VAR, TORQUE_DRIFT = (
    0,
    1,
    10,
    19,
    20,
    21,
    22,
    23,
    24,
)
DUTY, GAP = 25, 26
SIZE = 27
TYPICAL_FIELD = 3e-5  # T, low orbit
ZERO = (0.0, 0.0, 0.0)


@njit(cache=True)
def _matrix(a, k):
    return (a[k], a[k + 1], a[k + 2], a[k + 3], a[k + 4], a[k + 5], a[k + 6], a[k + 7], a[k + 8])


@njit(cache=True)
def _vector(a, k):
    return (a[k], a[k + 1], a[k + 2])


@njit(cache=True)
def _store(a, k, v):
    for j in range(3):
        a[k + j] = v[j]


@njit(cache=True)
def _covariance(memory, m0):
    """The (9, 9) covariance as a view of the memory."""
    return memory[m0 + COVARIANCE : m0 + FIELD].reshape(STATES, STATES)


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
    """The rate brought to now by (33); gives the rows of the rate's derivatives (3, 9)."""
    inertia, inv = _matrix(params, p0 + INERTIA), _matrix(params, p0 + INVERSE)
    rate, dipole = _vector(memory, m0 + RATE), _vector(memory, m0 + DIPOLE)
    middle = scale(0.5, add(rate, lifted(measurement.omega_bi_b)))
    field = scale(0.5, add(_vector(memory, m0 + FIELD), lifted(measurement.field_b)))
    whole = add(matvec(inertia, middle), momentum_b)
    moment = axpy(params[p0 + DUTY] / dt, _vector(memory, m0 + GIVEN), dipole)
    known = scale(0.5, add(_vector(memory, m0 + KNOWN_TORQUE), _known_torque(measurement, params, p0)))
    torque = add(cross(moment, field), add(_vector(memory, m0 + TORQUE), known))
    wheels = sub(momentum_b, _vector(memory, m0 + MOMENTUM))
    push = sub(scale(dt, sub(torque, cross(middle, whole))), wheels)
    _store(memory, m0 + RATE, add(rate, matvec(inv, push)))
    by_rate = matmul(inv, matsub(skew(whole), matmul(skew(middle), inertia)))
    by_dipole = matscale(-1.0, matmul(inv, skew(field)))
    rows = np.zeros((3, STATES))
    for i in range(3):
        for j in range(3):
            rows[i, j] = dt * by_rate[3 * i + j]
            rows[i, 3 + j] = dt * by_dipole[3 * i + j]
            rows[i, 6 + j] = dt * inv[3 * i + j]
        rows[i, i] += 1.0
    return rows


@njit(cache=True)
def _spread(dt, rows, memory, m0, params, p0):
    """Covariance after the step: only the rate's rows of the transition differ from the identity."""
    P = _covariance(memory, m0)
    crossed = np.zeros((3, STATES))
    for i in range(3):
        for j in range(STATES):
            for k in range(STATES):
                crossed[i, j] += rows[i, k] * P[k, j]
    for i in range(3):
        for j in range(3, STATES):
            P[i, j] = crossed[i, j]
            P[j, i] = crossed[i, j]
    inv = params[p0 + INVERSE : p0 + INVERSE + 9]
    for i in range(3):
        for j in range(i, 3):
            total = 0.0
            for k in range(STATES):
                total += crossed[i, k] * rows[j, k]
            for k in range(3):
                total += dt * params[p0 + NOISE_DENSITY] * inv[3 * i + k] * inv[3 * j + k]
            P[i, j] = total
            P[j, i] = total
    for j in range(3):
        P[3 + j, 3 + j] += dt * params[p0 + DIPOLE_DRIFT]
        P[6 + j, 6 + j] += dt * params[p0 + TORQUE_DRIFT]


@njit(cache=True)
def _correct(measurement, memory, m0, params, p0):
    """The measured rate corrects every state, one component after the other."""
    P = _covariance(memory, m0)
    state = memory[m0 + RATE : m0 + COVARIANCE]
    gain = np.empty(STATES)
    row = np.empty(STATES)
    for j in range(3):
        spread = P[j, j] + params[p0 + RATE_VAR]
        news = measurement.omega_bi_b[j] - state[j]
        for i in range(STATES):
            row[i] = P[j, i]
            gain[i] = row[i] / spread
        for i in range(STATES):
            state[i] += gain[i] * news
            for k in range(i, STATES):
                P[i, k] -= gain[i] * row[k]
                P[k, i] = P[i, k]


@njit(cache=True)
def _begin(measurement, memory, m0, params, p0):
    """The rate as measured; of the rest what was known before a gap, or only how large it may be."""
    P = _covariance(memory, m0)
    for i in range(3):
        for j in range(STATES):
            P[i, j] = 0.0
            P[j, i] = 0.0
        P[i, i] = params[p0 + RATE_VAR]
        if memory[m0 + HAS] == 0.0:
            P[3 + i, 3 + i] = params[p0 + DIPOLE_VAR]
            P[6 + i, 6 + i] = params[p0 + TORQUE_VAR]
    memory[m0 + HAS] = 1.0
    _store(memory, m0 + RATE, lifted(measurement.omega_bi_b))


@njit(cache=True)
def residual_estimate(t, measurement, momentum_b, memory, m0, params, p0):
    """(dipole [A m^2], torque [N m]), body axes, as known after this call.

    Both zero where the filter is off; the last ones while field or rate is missing.
    """
    if params[p0 + ON] < 0.5:
        return ZERO, ZERO
    _store(memory, m0 + GIVEN, axpy(t - memory[m0 + CALLED], lifted(measurement.dipole_b), _vector(memory, m0 + GIVEN)))
    memory[m0 + CALLED] = t
    if field_known(measurement) and rate_known(measurement):
        dt = t - memory[m0 + TIME]
        if memory[m0 + HAS] > 0.5 and 0.0 < dt <= params[p0 + GAP]:
            rows = _predict(dt, measurement, momentum_b, memory, m0, params, p0)
            _spread(dt, rows, memory, m0, params, p0)
            _correct(measurement, memory, m0, params, p0)
        else:
            _begin(measurement, memory, m0, params, p0)
        memory[m0 + TIME] = t
        _store(memory, m0 + FIELD, lifted(measurement.field_b))
        _store(memory, m0 + MOMENTUM, momentum_b)
        _store(memory, m0 + KNOWN_TORQUE, _known_torque(measurement, params, p0))
        _store(memory, m0 + GIVEN, ZERO)
    return _vector(memory, m0 + DIPOLE), _vector(memory, m0 + TORQUE)


@njit(cache=True)
def cancelling_moment(field_b, dipole, torque):
    """Moment against a dipole and, as far as the field allows, a torque."""
    return sub(scale(-1.0 / dot(field_b, field_b), cross(field_b, torque)), dipole)


@njit(cache=True)
def residual_dipole(t, measurement, memory, params):
    """The law by itself: minus the estimated dipole."""
    momentum_b = wheel_momentum_b(measurement, params, SIZE)
    dipole, _ = residual_estimate(t, measurement, momentum_b, memory, 0, params, 0)
    return as_command(scale(-1.0, dipole))


FILTER_PARAMETERS = {
    "residual_std_a_m2": Parameter(
        "A m^2",
        "how large the residual dipole may be, 1 sigma per axis; derived as a tenth of the torquers'",
        kind="positive",
        derived=True,
    ),
    "residual_drift_a_m2_day": Parameter(
        "A m^2", "how far it may wander in a day; derived as a tenth of it", kind="not negative", derived=True
    ),
    "rate_noise_deg_s": Parameter("deg/s", "noise of the known rate, 1 sigma per axis and call", 1e-3, "positive"),
    "residual_torque_n_m": Parameter(
        "N m",
        "how large a constant torque may be; derived as 0.3 of the residual dipole's in 30 microtesla",
        kind="not negative",
        derived=True,
    ),
    "torque_noise_n_m": Parameter(
        "N m",
        "changing unknown torque; derived as a twentieth of the residual dipole's in 30 microtesla",
        kind="positive",
        derived=True,
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
    noise = 0.05 * size * TYPICAL_FIELD if values["torque_noise_n_m"] is None else values["torque_noise_n_m"]
    torque = 0.3 * size * TYPICAL_FIELD if values["residual_torque_n_m"] is None else values["residual_torque_n_m"]
    inertia = np.asarray(context.inertia_kg_m2, dtype=float)
    return np.array(
        [
            float(on),
            *inertia.ravel(),
            *np.linalg.inv(inertia).ravel(),
            np.radians(values["rate_noise_deg_s"]) ** 2,
            2.0 * noise**2 * values["torque_noise_time_s"],  # density of a torque that forgets itself in that time
            size**2,
            drift**2 / SECONDS_PER_DAY,
            torque**2,
            (torque * drift / size) ** 2 / SECONDS_PER_DAY,
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
