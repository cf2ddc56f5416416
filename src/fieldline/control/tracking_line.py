"""Two axes held by coils alone, as the 1961 study has it: the tracked line x is kept on a direction in space.

A_y and A_z are the angles by which the body must still turn about y and z; the sensor limits each to `sensor_limit_arcsec`,
a network adds the derivative of what the sensor gives, and an integrator if asked:

    T_y = G(s) A_y,   T_z = G(s) A_z,   G(s) = K_p + K_d s + K_i / s                               (3)

The torques become a moment by three coils, equation (8), or by two, equation (10), of `control.coils`, and each coil's
current saturates by itself. Roll about x is not controlled.

Gains not given follow from the undamped frequency w, the damping ratio z and the moment of inertia J of each axis:

    K_p = J (w^2 + 2 z w v),   K_d = J (2 z w + v),   K_i = J w^2 v                                (23)

with v the integrator's corner. At v = 0 these are the study's own: w^2 = K_p / J, 2 z w = K_d / J. For v > 0 the added lead
v in K_d is the compensation that an integrator needs: the pair keeps w and z, and the third pole lies at -v. The integrator
rests while its sensor is limited or a coil is saturated, so that a long approach does not wind it up.

`rate = "difference"` is the study's: the limited signal is differentiated, so there is no damping while it is limited.
`rate = "gyro"` takes the body's rate instead, at all times.

Source: White, Shigemoto and Bourquin (1961), NASA TN D-1068; (23) is ours, the study asks for a network and gives none.
"""

from __future__ import annotations

from math import atan2, isfinite, pi

import numpy as np
from numba import njit

from fieldline.control.coils import three_coil_moment, two_coil_moment
from fieldline.control.law import Law, Parameter, complete
from fieldline.control.readings import attitude_known, field_known, lifted, rate_known
from fieldline.errors import InputError
from fieldline.frames.attitude import to_body

ARCSECOND = pi / 648000.0
NO_LIMIT = 1e30  # a sensor without a limit

(TARGET_X, TARGET_Y, TARGET_Z, KP_Y, KP_Z, KD_Y, KD_Z, KI_Y, KI_Z, LIMIT, USE_GYRO, LOW_PASS) = range(12)
MOMENT_X, MOMENT_Y, MOMENT_Z = 12, 13, 14
HAS_LAST, TIME, LAST_Y, LAST_Z, SLOPE_Y, SLOPE_Z, SUM_Y, SUM_Z, SATURATED = range(9)
MEMORY = 9


@njit(cache=True)
def tracking_errors(q_bi, target_i):
    """A_y and A_z [rad]: turns about y and z that bring the body's x axis onto target_i; exact for one alone."""
    target_b = to_body(q_bi, target_i)
    return atan2(-target_b[2], target_b[0]), atan2(target_b[1], target_b[0])


@njit(cache=True)
def _limited(value, most):
    return min(max(value, -most), most)


@njit(cache=True)
def _slope(now, last, slope, dt, low_pass):
    """Derivative [1/s] of a sampled signal through a low-pass of first order."""
    return slope + dt / (low_pass + dt) * ((now - last) / dt - slope)


@njit(cache=True)
def _learn(t, measurement, memory, params, error_y, error_z, signal_y, signal_z):
    """Derivatives and integrals of the sensor's signals, kept in memory."""
    dt = t - memory[TIME]
    fresh = memory[HAS_LAST] > 0.5 and dt > 0.0
    if params[USE_GYRO] > 0.5:
        seen = rate_known(measurement)
        memory[SLOPE_Y] = -measurement.omega_bi_b[1] if seen else 0.0
        memory[SLOPE_Z] = -measurement.omega_bi_b[2] if seen else 0.0
    elif fresh:
        memory[SLOPE_Y] = _slope(signal_y, memory[LAST_Y], memory[SLOPE_Y], dt, params[LOW_PASS])
        memory[SLOPE_Z] = _slope(signal_z, memory[LAST_Z], memory[SLOPE_Z], dt, params[LOW_PASS])
    if fresh and memory[SATURATED] < 0.5:
        memory[SUM_Y] += dt * signal_y if signal_y == error_y else 0.0
        memory[SUM_Z] += dt * signal_z if signal_z == error_z else 0.0
    memory[HAS_LAST] = 1.0
    memory[TIME] = t
    memory[LAST_Y] = signal_y
    memory[LAST_Z] = signal_z


@njit(cache=True)
def _forget(memory):
    """Without a sensor signal there is nothing to differentiate; what the integrator knows stays."""
    memory[HAS_LAST] = 0.0
    memory[SLOPE_Y] = 0.0
    memory[SLOPE_Z] = 0.0


@njit(cache=True)
def _wanted_torques(t, measurement, memory, params):
    """T_y and T_z [N m] of equation (3)."""
    q = measurement.q_bi
    error_y, error_z = tracking_errors((q[0], q[1], q[2], q[3]), lifted(params))
    signal_y, signal_z = _limited(error_y, params[LIMIT]), _limited(error_z, params[LIMIT])
    _learn(t, measurement, memory, params, error_y, error_z, signal_y, signal_z)
    torque_y = params[KP_Y] * signal_y + params[KD_Y] * memory[SLOPE_Y] + params[KI_Y] * memory[SUM_Y]
    torque_z = params[KP_Z] * signal_z + params[KD_Z] * memory[SLOPE_Z] + params[KI_Z] * memory[SUM_Z]
    return torque_y, torque_z


@njit(cache=True)
def _through_coils(moment, memory, params):
    """Every coil saturates by itself."""
    command = np.empty(3)
    memory[SATURATED] = 0.0
    for j in range(3):
        command[j] = _limited(moment[j], params[MOMENT_X + j])
        if command[j] != moment[j] or not isfinite(moment[j]):
            memory[SATURATED] = 1.0
    return command


@njit(cache=True)
def three_coil(t, measurement, memory, params):
    """Moment of equation (8) for the torques (3)."""
    if not (field_known(measurement) and attitude_known(measurement)):
        _forget(memory)
        return np.zeros(3)
    torque_y, torque_z = _wanted_torques(t, measurement, memory, params)
    return _through_coils(three_coil_moment(lifted(measurement.field_b), torque_y, torque_z), memory, params)


@njit(cache=True)
def two_coil(t, measurement, memory, params):
    """Moment of equation (10) for the torques (3)."""
    if not (field_known(measurement) and attitude_known(measurement)):
        _forget(memory)
        return np.zeros(3)
    torque_y, torque_z = _wanted_torques(t, measurement, memory, params)
    return _through_coils(two_coil_moment(lifted(measurement.field_b), torque_y, torque_z), memory, params)


PARAMETERS = {
    "target_i": Parameter("", "direction in inertial axes that the body's x axis is to keep", kind="vector"),
    "natural_frequency_rad_s": Parameter("rad/s", "undamped frequency w of each axis", 0.1, "positive"),
    "damping_ratio": Parameter("", "damping ratio z of each axis", 0.7, "positive"),
    "integrator_rad_s": Parameter("rad/s", "corner v of the integrator; 0 is none", 0.0, "not negative"),
    "gain_n_m_rad": Parameter("N m/rad", "K_p; derived by (23)", kind="positive", derived=True),
    "rate_gain_n_m_s_rad": Parameter("N m s/rad", "K_d; derived by (23)", kind="not negative", derived=True),
    "integral_gain_n_m_rad_s": Parameter("N m/(rad s)", "K_i; derived by (23)", kind="not negative", derived=True),
    "sensor_limit_arcsec": Parameter("arcsec", "largest angle that the sensor tells; 0 is no limit", 1.2, "not negative"),
    "rate": Parameter(
        "", 'damping from the "difference" of signals or the "gyro"', "difference", "choice", choices=("difference", "gyro")
    ),
    "low_pass_s": Parameter("s", "time constant of the filter on the difference; 0 is none", 0.0, "not negative"),
    "moment_max_a_m2": Parameter("A m^2", "where each coil saturates; derived from the torquers", kind="vector", derived=True),
}


def line_gains(inertia: float, frequency: float, damping: float, integrator: float = 0.0) -> tuple[float, float, float]:
    """K_p [N m/rad], K_d [N m s/rad], K_i [N m/(rad s)] of equation (23); inertia [kg m^2], frequencies [rad/s]."""
    return (
        inertia * (frequency**2 + 2.0 * damping * frequency * integrator),
        inertia * (2.0 * damping * frequency + integrator),
        inertia * frequency**2 * integrator,
    )


def _pack(law: str, table, context) -> np.ndarray:
    values = complete(law, PARAMETERS, table)
    size = float(np.linalg.norm(values["target_i"]))
    if size == 0.0:
        raise InputError(f'target_i of the law "{law}" must be a direction; got three zeros.')
    design = (values["natural_frequency_rad_s"], values["damping_ratio"], values["integrator_rad_s"])
    derived = np.array([line_gains(context.inertia_kg_m2[j, j], *design) for j in (1, 2)])
    given = (values["gain_n_m_rad"], values["rate_gain_n_m_s_rad"], values["integral_gain_n_m_rad_s"])
    gains = [derived[axis, k] if given[k] is None else given[k] for k in range(3) for axis in range(2)]
    limit = values["sensor_limit_arcsec"] * ARCSECOND or NO_LIMIT
    moment = context.moment_max_a_m2 if values["moment_max_a_m2"] is None else values["moment_max_a_m2"]
    gyro = float(values["rate"] == "gyro")
    return np.array([*(values["target_i"] / size), *gains, limit, gyro, values["low_pass_s"], *moment], dtype=float)


def _pack_three(table, context) -> np.ndarray:
    return _pack("three-coil", table, context)


def _pack_two(table, context) -> np.ndarray:
    return _pack("two-coil", table, context)


LAWS = (
    Law(
        "three-coil", three_coil, PARAMETERS, MEMORY, ("dipole",), "holds a line by three coils, least moment (1961)", _pack_three
    ),
    Law("two-coil", two_coil, PARAMETERS, MEMORY, ("dipole",), "holds a line by the coils y and z (1961)", _pack_two),
)
