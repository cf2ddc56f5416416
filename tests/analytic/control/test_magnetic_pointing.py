"""Three axes by the field alone: gains against their definitions, and flights from 30 degrees per axis."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.analysis import periodic_regulator
from fieldline.control import LAWS
from fieldline.control.linear_attitude import attitude_matrix, moment_matrix
from fieldline.control.magnetic_regulator import ORBITS, ROW, TABLE_AT
from fieldline.control.regulator_design import fold, repeating_orbits
from fieldline.errors import InputError
from law_tests import CONTEXT, FLIGHT, called, known_measurement
from tiny_flight import TinyFlight

kernels = pytest.mark.kernels  # flights of hours stay out: they are slow without compilation
NAMES = ("magnetic-lqr-periodic", "magnetic-lqr-asymptotic", "magnetic-lqr-averaged")
# A dipole of 17 mA m2 and the torque of drag on a centre of pressure 5 to 10 cm off: nobody told the regulator.
MICROSATELLITE = {
    "inertia": (5.0, 6.0, 2.0),
    "altitude_km": 600.0,
    "inclination_deg": 70.0,
    "residual_dipole": (0.01, 0.01, 0.01),
    "drag": (0.0, 1e-7, 1e-7),
    "moment_max": 2.0,
    "period_s": 10.0,
}
CANCEL = {"target": "nadir", "cancel_residual": True, "residual_std_a_m2": 0.02}


def flown_from_30_deg(name, table, orbits, flight, momentum=(0.0, 0.0, 0.0)):
    """Largest error [deg] of each orbit."""
    theta = np.radians([30.0, 30.0, 30.0])
    rate = Rotation.from_rotvec(theta).inv().apply([0.0, -flight.mean_motion, 0.0])
    params = LAWS[name].pack(table, flight.context())
    error = flight.nadir_error_deg(flight.fly(LAWS[name], params, orbits, flight.nadir_quaternion(0.0, theta), rate, momentum))
    return np.array([part.max() for part in np.array_split(error, orbits)])


@kernels
def test_pd_moment_is_projected():
    params = LAWS["magnetic-pd"].pack({"natural_frequency_rad_s": 1e-3, "damping_ratio": 0.5}, CONTEXT)
    theta, rate = np.array([0.02, -0.01, 0.03]), np.array([1e-5, 2e-5, -1e-5])
    measurement = known_measurement(omega_b=rate, q_bi=Rotation.from_rotvec(theta).as_quat())
    field = measurement.field_b
    wanted = -FLIGHT.matrix @ (1e-6 * theta + 1e-3 * rate)
    moment = called("magnetic-pd", measurement, params=params)
    assert np.allclose(np.cross(moment, field), wanted - field * (wanted @ field) / (field @ field), rtol=1e-9)


@kernels
@pytest.mark.parametrize("name", ["magnetic-pd", *NAMES])
def test_a_large_moment_is_shortened_and_keeps_its_direction(name):
    q = Rotation.from_rotvec([0.3, -0.2, 0.5]).as_quat()
    wide = replace(CONTEXT, moment_max_a_m2=np.full(3, 1e9))
    free = called(name, known_measurement(q_bi=q), params=LAWS[name].pack({}, wide))
    most = 0.3 * np.abs(free).max()
    short = called(name, known_measurement(q_bi=q), params=LAWS[name].pack({"moment_max_a_m2": [most] * 3}, wide))
    assert np.allclose(short, 0.3 * free, rtol=1e-12)


@kernels
def test_periodic_gains_are_those_of_the_facade():
    table = {"target": "nadir", "angle_deg": 2.0, "rate_deg_s": 0.01, "moment_a_m2": 0.03, "orbits": 1}
    params = LAWS["magnetic-lqr-periodic"].pack(table, CONTEXT)
    seconds, field_o, _ = CONTEXT.field_along_orbit()
    n, J = FLIGHT.mean_motion, FLIGHT.matrix
    b = moment_matrix(J, fold(seconds, field_o, n))
    weights = np.diag([np.radians(2.0) ** -2] * 3 + [np.radians(0.01) ** -2] * 3)
    a = attitude_matrix(J, (0.0, -n, 0.0), (0.0, 0.0, 1.0))
    result = periodic_regulator(a, b, weights, np.eye(3) / 0.03**2, FLIGHT.orbit_s, control="continuous")
    assert result.attrs["residual"] < 1e-9 and abs(result.multiplier.values[0]) < 0.5
    rows = params[int(params[TABLE_AT]) :].reshape(-1, 3, ROW // 3)
    field = fold(seconds, field_o, n)
    for k in (0, 17, 60):
        by_law = np.cross(field[k], rows[k, :, :6].T).T  # M = -B x (G x), K = [B] G
        assert np.allclose(by_law, result.gain[k], rtol=1e-9, atol=1e-9 * np.abs(by_law).max())


@kernels
def test_fold_averages_whole_repetitions():
    n, turns = 1e-3, np.linspace(0.0, 4.0, 4001)
    field = np.stack([np.cos(2 * np.pi * turns), np.floor(turns + 1e-9), turns], axis=-1)
    seconds = turns * 2 * np.pi / n
    assert np.allclose(fold(seconds, field, n, 1)[:, 0], np.cos(np.arange(90) * 2 * np.pi / 90), atol=1e-5)
    assert np.allclose(fold(seconds, field, n, 2)[45, 2], np.mean([0.5, 2.5]))
    assert fold(seconds, field, n, 2).shape == (180, 3)
    with pytest.raises(InputError, match="it covers 4"):
        fold(seconds, field, n, 5)


@kernels
def test_gains_repeat_after_a_day_where_the_field_is_known_for_one():
    day, one = (LAWS["magnetic-lqr-periodic"].pack({"target": "nadir"}, FLIGHT.context(orbits)) for orbits in (15, 1))
    assert day[ORBITS] == 15.0 and one[ORBITS] == 1.0
    assert repeating_orbits(np.array([0.0, 90000.0]), FLIGHT.mean_motion) == 15


@kernels
def test_an_equatorial_orbit_of_an_upright_dipole_cannot_be_held():
    seconds = np.linspace(0.0, FLIGHT.orbit_s, 91)
    upright = np.tile([0.0, -3e-5, 0.0], (91, 1))
    context = replace(CONTEXT, field_along_orbit=lambda: (seconds, upright, upright))
    with pytest.raises(InputError, match="finds no regulator"):
        LAWS["magnetic-lqr-periodic"].pack({"target": "inertial"}, context)


def test_from_30_deg_to_a_tenth_with_a_momentum_wheel():
    momentum = (0.0, -0.1, 0.0)  # N m s, a wheel of constant speed
    errors = flown_from_30_deg(
        "magnetic-lqr-periodic", CANCEL | {"momentum_n_m_s": momentum}, 8, TinyFlight(**MICROSATELLITE), momentum
    )
    assert errors[0] > 50.0 and errors[-1] < 0.25  # the published benchmark is 0.5 to 1.0


def test_from_30_deg_by_gravity_gradient_alone():
    errors = flown_from_30_deg("magnetic-lqr-periodic", CANCEL, 6, TinyFlight(**MICROSATELLITE))
    assert errors[-1] < 1.5
    quieter = TinyFlight(**MICROSATELLITE | {"drag": (0.0, 3e-8, 3e-8)})
    assert flown_from_30_deg("magnetic-lqr-periodic", CANCEL, 6, quieter)[-1] < 0.5


@pytest.mark.parametrize("name", [*NAMES[1:], "magnetic-pd"])
def test_the_simpler_laws_converge(name):
    errors = flown_from_30_deg(
        name,
        {"target": "nadir"},
        10,
        TinyFlight(**MICROSATELLITE | {"drag": (0.0, 0.0, 0.0), "residual_dipole": (0.0, 0.0, 0.0)}),
    )
    assert errors[0] > 50.0 and errors[-1] < 0.5


def test_integral_action_takes_out_the_mean_of_a_constant_pitch_torque():
    still = {"drag": (0.0, 0.0, 0.0), "residual_dipole": (0.0, 0.0, 0.0), "fixed_torque": (0.0, 3e-7, 0.0)}
    flight, law = TinyFlight(**MICROSATELLITE | still), LAWS["magnetic-lqr-periodic"]
    means = {}
    for time_s in (0.0, 3000.0):
        params = law.pack({"target": "nadir", "integral_time_s": time_s}, flight.context())
        flown = flight.fly(law, params, 6, flight.nadir_quaternion(), (0.0, -flight.mean_motion, 0.0))
        pitch = flight.nadir_rotation(flown).as_rotvec()[:, 1]
        means[time_s] = np.degrees(abs(pitch[pitch.size // 2 :].mean()))
    assert means[0.0] > 0.5 and means[3000.0] < 0.2 * means[0.0]


def test_an_attitude_in_space_is_held_by_the_periodic_law():
    flight = TinyFlight(**MICROSATELLITE | {"inertia": (2.0, 2.1, 1.9), "drag": (0.0, 0.0, 0.0)})
    table = {"target": "inertial", "moment_a_m2": 0.05, "cancel_residual": True, "residual_std_a_m2": 0.02}
    params = LAWS["magnetic-lqr-periodic"].pack(table, flight.context())
    flown = flight.fly(LAWS["magnetic-lqr-periodic"], params, 6, Rotation.from_rotvec([0.2, -0.2, 0.2]).as_quat())
    error = np.degrees(Rotation.from_quat(flown["q"]).magnitude())
    assert error[0] > 15.0 and error[-600:].max() < 1.0


def test_noise_and_missing_readings_do_not_unsettle_the_regulator():
    noise = {"rate": np.radians(1e-3), "angle": np.radians(0.05), "field": 1e-7}
    flight = TinyFlight(**MICROSATELLITE | {"noise": noise})
    momentum = (0.0, -0.1, 0.0)

    def spoil(k, measurement):
        if k % 7 == 0:
            measurement.valid[:] = 0.0
            measurement.field_b[:] = measurement.q_bi[:] = measurement.omega_bi_b[:] = np.nan

    params = LAWS["magnetic-lqr-periodic"].pack(CANCEL | {"momentum_n_m_s": momentum}, flight.context())
    start = (flight.nadir_quaternion(0.0, (0.1, 0.1, 0.1)), (0.0, -flight.mean_motion, 0.0))
    flown = flight.fly(LAWS["magnetic-lqr-periodic"], params, 5, *start, momentum, spoil=spoil)
    assert flight.nadir_error_deg(flown)[-500:].max() < 0.5
