"""The residual dipole and torque, found from how a satellite turns."""

import numpy as np
import pytest

from fieldline.control import LAWS
from fieldline.control.residual_dipole import COVARIANCE, DIPOLE, FIELD, MEMORY, STATES, TORQUE
from law_tests import CONTEXT, known_measurement
from tiny_flight import TinyFlight

kernels = pytest.mark.kernels  # flights of hours stay out: they are slow without compilation
LAW = LAWS["residual-dipole"]
TRUE_DIPOLE, TRUE_TORQUE = np.array([0.02, -0.03, 0.01]), np.array([1e-7, -2e-7, 1.5e-7])


def flown(noise_deg_s, orbits=2.0, spoil=None, seed=3, dipole=TRUE_DIPOLE, torque=TRUE_TORQUE):
    flight = TinyFlight(
        inertia=(0.5, 0.6, 0.4),
        inclination_deg=70.0,
        period_s=4.0,
        residual_dipole=dipole,
        fixed_torque=torque,
        noise={"rate": np.radians(noise_deg_s)},
        seed=seed,
    )
    table = {"residual_std_a_m2": 0.05, "residual_torque_n_m": 5e-7, "rate_noise_deg_s": max(noise_deg_s, 1e-5)}
    params = LAW.pack(table | {"torque_noise_n_m": 1e-9, "residual_drift_a_m2_day": 0.0}, flight.context(1))
    return flight.fly(LAW, params, orbits, omega=np.radians([0.1, -0.15, 0.12]), h=(0.0, -0.001, 0.0005), spoil=spoil)


def test_dipole_and_torque_are_found():
    memory = flown(1e-4)["memory"]
    assert np.abs(memory[DIPOLE : DIPOLE + 3] - TRUE_DIPOLE).max() < 0.02 * np.linalg.norm(TRUE_DIPOLE)
    assert np.abs(memory[TORQUE : TORQUE + 3] - TRUE_TORQUE).max() < 0.05 * np.linalg.norm(TRUE_TORQUE)


def test_the_command_is_minus_the_estimate():
    run = flown(1e-4)
    assert np.array_equal(run["moment"][-1], -run["memory"][DIPOLE : DIPOLE + 3])


def test_covariance_is_consistent():
    scores = []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        dipole, torque = 0.05 * rng.standard_normal(3), 5e-7 * rng.standard_normal(3)  # as large as the filter is told
        memory = flown(2e-3, 0.3, seed=seed, dipole=dipole, torque=torque)["memory"]
        error = np.concatenate([memory[DIPOLE : DIPOLE + 3] - dipole, memory[TORQUE : TORQUE + 3] - torque])
        covariance = memory[COVARIANCE:FIELD].reshape(STATES, STATES)
        assert np.allclose(covariance, covariance.T, rtol=1e-9, atol=1e-30)
        scores.append(error @ np.linalg.solve(covariance[3:, 3:], error) / 6.0)
    assert 0.5 < np.mean(scores) < 1.7  # 72 degrees of freedom: 1 +- 0.17


def test_a_gap_keeps_what_is_known():
    def gap(k, measurement):
        if 1500 < k < 1560:
            measurement.valid[0] = 0.0
            measurement.field_b[:] = np.nan

    memory = flown(1e-4, spoil=gap)["memory"]
    assert np.abs(memory[DIPOLE : DIPOLE + 3] - TRUE_DIPOLE).max() < 0.02 * np.linalg.norm(TRUE_DIPOLE)


@kernels
def test_nothing_known_is_nothing_commanded():
    measurement = known_measurement()
    measurement.valid[:] = 0.0
    measurement.field_b[:] = measurement.omega_bi_b[:] = np.nan
    memory = np.zeros(MEMORY)
    assert not LAW.kernel(0.0, measurement, memory, LAW.pack({}, CONTEXT)).any() and not memory[:COVARIANCE].any()
