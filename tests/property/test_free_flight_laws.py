"""Laws of the simulated truth: what is conserved, what depends on what."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fieldline.errors import InputError
from fieldline.estimation.reference import reference_along_orbit
from fieldline.orbit import read_orbit
from fieldline.simulate import Magnetometer, fly_free
from tests_support import SAMPLE_TLE, times_utc

INERTIA = np.diag([0.02, 0.03, 0.035])


@pytest.fixture(scope="module")
def reference():
    return reference_along_orbit(times_utc(600, 5.0), read_orbit(SAMPLE_TLE), degree=4)


@settings(max_examples=15, deadline=None)
@given(rate=st.tuples(*[st.floats(-5.0, 5.0)] * 3))
def test_torque_free_motion_keeps_energy_and_momentum(reference, rate):
    flight = fly_free(reference, omega0_deg_s=rate, inertia_kg_m2=INERTIA, gravity_gradient=False, seed=1)
    momentum_i = Rotation.from_quat(flight.q_bi).apply(flight.omega_bi_b @ INERTIA)
    energy = np.einsum("ni,ij,nj->n", flight.omega_bi_b, INERTIA, flight.omega_bi_b)
    scale = np.linalg.norm(momentum_i[0]) + 1e-12
    # 3,000 s in steps of at most 0.02 rad
    assert np.abs(momentum_i - momentum_i[0]).max() < 1e-7 * scale
    assert np.abs(energy - energy[0]).max() < 1e-7 * (energy[0] + 1e-18)


def test_gravity_gradient_changes_energy_and_a_dipole_works_on_it(reference):
    quiet = {"omega0_deg_s": (0.1, -0.05, 0.08), "q0_bi": (0.1, 0.7, 0.1, 0.7), "inertia_kg_m2": INERTIA}
    quiet["q0_bi"] = tuple(np.array(quiet["q0_bi"]) / np.linalg.norm(quiet["q0_bi"]))
    free = fly_free(reference, gravity_gradient=False, **quiet)
    pulled = fly_free(reference, **quiet)
    magnetic = fly_free(reference, gravity_gradient=False, dipole_a_m2=(0.01, 0.0, 0.0), **quiet)
    assert np.abs(pulled.omega_bi_b - free.omega_bi_b).max() > 1e-5
    # 0.01 A m2 in 3e-5 T on 0.03 kg m2: 1e-5 rad/s2, over some 100 s before the field has turned in the body
    assert 1e-4 < np.abs(magnetic.omega_bi_b - free.omega_bi_b).max() < 1e-1


def test_same_seed_same_bits_other_seed_other_flight(reference):
    sensor = Magnetometer(noise_std_tesla=1e-7, quantum_tesla=1e-7)
    one, two = (fly_free(reference, seed=5, magnetometer=sensor) for _ in range(2))
    other = fly_free(reference, seed=6, magnetometer=sensor)
    assert np.array_equal(one.telemetry.field_s, two.telemetry.field_s)
    assert not np.array_equal(one.telemetry.field_s, other.telemetry.field_s)


def test_a_magnetometer_gives_what_its_record_says(reference):
    bias, matrix = np.array([5e-5, -2e-5, 1e-5]), np.array([[1.1, 0.01, 0.0], [0.01, 0.95, 0.02], [0.0, 0.02, 1.0]])
    sensor = Magnetometer(bias_s=bias, matrix=matrix, quantum_tesla=1e-9)
    flight = fly_free(reference, seed=2, magnetometer=sensor)
    back = (flight.telemetry.field_s - bias) @ matrix.T
    assert np.abs(back - flight.field_b).max() < 1e-9
    clipped = fly_free(reference, seed=2, magnetometer=Magnetometer(range_tesla=2e-5))
    assert np.abs(clipped.telemetry.field_s).max() == 2e-5


def test_earth_pointing_body_turns_once_an_orbit(reference):
    flight = fly_free(reference, pointing="earth")
    nadir = -reference.position_i / np.linalg.norm(reference.position_i, axis=1, keepdims=True)
    in_body = Rotation.from_quat(flight.q_bi).inv().apply(nadir)
    assert np.abs(in_body - [0.0, 0.0, 1.0]).max() < 1e-12
    # 15.36 revolutions a day
    assert np.isclose(np.median(np.linalg.norm(flight.omega_bi_b, axis=1)), 15.36 * 2 * np.pi / 86400, rtol=0.01)


def test_bad_requests_are_named(reference):
    with pytest.raises(InputError, match="pointing"):
        fly_free(reference, pointing="sun")
    with pytest.raises(InputError, match="unit quaternion"):
        fly_free(reference, q0_bi=(1.0, 1.0, 0.0, 0.0))
    with pytest.raises(InputError, match="Magnetometer"):
        Magnetometer(noise_std_tesla=-1.0)
