"""Orbital axes, phase of the orbit, and the pointing error against SciPy's rotations."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.control.law import complete
from fieldline.control.orbital_axes import argument_of_latitude, orbital_attitude, orbital_rate, quat_of_axes
from fieldline.control.target import PARAMETERS, packed_target, pointing_error
from law_tests import FLIGHT, known_measurement
from tiny_flight import place

pytestmark = pytest.mark.kernels


@pytest.mark.parametrize("seed", range(6))
def test_quaternion_of_axes(seed):
    rotation = Rotation.random(random_state=seed) if seed < 3 else Rotation.from_rotvec(np.pi * np.eye(3)[seed - 3])
    q = quat_of_axes(*(tuple(axis) for axis in rotation.as_matrix().T))
    assert abs(np.dot(q, rotation.as_quat())) == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("t", [0.0, 900.0, 4000.0])
def test_orbital_axes_and_rate(t):
    r, v = place(t, FLIGHT.radius, FLIGHT.inclination)
    rotation = Rotation.from_quat(orbital_attitude(r, v))
    assert np.allclose(rotation.inv().apply(r), [0.0, 0.0, -FLIGHT.radius], atol=1e-6)
    assert np.allclose(rotation.inv().apply(v), [np.linalg.norm(v), 0.0, 0.0], atol=1e-9)
    assert np.allclose(rotation.inv().apply(orbital_rate(r, v)), [0.0, -FLIGHT.mean_motion, 0.0], atol=1e-15)
    assert np.cos(argument_of_latitude(r, v) - FLIGHT.mean_motion * t) == pytest.approx(1.0, abs=1e-12)


def test_argument_of_latitude_of_an_equatorial_orbit_goes_from_x():
    assert argument_of_latitude((0.0, 7e6, 0.0), (-7.5e3, 0.0, 0.0)) == pytest.approx(np.pi / 2)


@pytest.mark.parametrize("kind", ["inertial", "nadir"])
def test_error_against_rotations(kind):
    goal, offset = Rotation.from_rotvec([0.2, -0.4, 0.9]), Rotation.from_rotvec([0.3, 0.1, -0.5])
    params = packed_target(complete("any", PARAMETERS, {"target": kind, "attitude": goal.as_quat()}))
    measurement = known_measurement(omega_b=(1e-3, -2e-3, 5e-4))
    r, v = (tuple(x) for x in (measurement.position_i, measurement.velocity_i))
    outer = Rotation.from_quat(orbital_attitude(r, v)) if kind == "nadir" else Rotation.identity()
    body = outer * goal * offset
    measurement.q_bi[:] = -body.as_quat()  # the sign of a quaternion means nothing
    known, theta, rate, goal_rate = pointing_error(measurement, params, 0)
    assert known and np.allclose(theta, [0.3, 0.1, -0.5], atol=1e-14)
    turning = body.inv().apply(orbital_rate(r, v)) if kind == "nadir" else np.zeros(3)
    assert np.allclose(goal_rate, turning, atol=1e-18)
    assert np.allclose(rate, [1e-3, -2e-3, 5e-4] - turning, atol=1e-16)


@pytest.mark.parametrize("missing", [3, 4, 5])
def test_what_is_not_known_is_not_used(missing):
    params = packed_target(complete("any", PARAMETERS, {"target": "nadir"}))
    measurement = known_measurement()
    measurement.valid[missing] = 0.0
    assert not pointing_error(measurement, params, 0)[0]
