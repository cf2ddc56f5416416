"""The linear model (32) against differences of Euler's equation."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.control.linear_attitude import attitude_matrix, moment_matrix, with_integral
from tiny_flight import TinyFlight, _rates, dipole_field_i, place

pytestmark = pytest.mark.kernels
INERTIAS = [np.diag([4.0, 4.2, 1.0]), np.array([[3.0, 0.2, -0.1], [0.2, 2.5, 0.3], [-0.1, 0.3, 2.0]])]


def acceleration(flight, theta, w, momentum, moment=(0.0, 0.0, 0.0)):
    """dw/dt [rad/s^2] of the full equations for a body turned by theta from the orbital axes."""
    goal_rate = Rotation.from_rotvec(theta).inv().apply([0.0, -flight.mean_motion, 0.0])
    inertia, inverse = (tuple(map(float, m.ravel())) for m in (flight.matrix, np.linalg.inv(flight.matrix)))
    q, zero = tuple(flight.nadir_quaternion(0.0, theta)), (0.0, 0.0, 0.0)
    omega = tuple(np.asarray(w) + goal_rate)
    _, rate, _ = _rates(0.0, q, omega, tuple(momentum), flight.orbit, inertia, inverse, tuple(moment), zero, zero, zero)
    return np.array(rate) + np.cross(w, goal_rate)


@pytest.mark.parametrize("inertia", INERTIAS)
@pytest.mark.parametrize("momentum", [(0.0, 0.0, 0.0), (0.01, -0.3, 0.02)])
def test_nadir_model_equals_differences(inertia, momentum):
    flight = TinyFlight(inertia=inertia, inclination_deg=70.0)
    a = attitude_matrix(inertia, (0.0, -flight.mean_motion, 0.0), (0.0, 0.0, 1.0), momentum)
    zero = np.zeros(3)
    for j, axis in enumerate(np.eye(3)):
        angle, rate = 1e-5 * axis, 1e-6 * axis
        by_angle = (acceleration(flight, angle, zero, momentum) - acceleration(flight, -angle, zero, momentum)) / 2e-5
        by_rate = (acceleration(flight, zero, rate, momentum) - acceleration(flight, zero, -rate, momentum)) / 2e-6
        assert np.allclose(by_angle, a[3:, j], rtol=0.0, atol=1e-7 * np.abs(a[3:, :3]).max())
        assert np.allclose(by_rate, a[3:, 3 + j], rtol=0.0, atol=1e-6 * np.abs(a[3:, 3:]).max())


def test_moment_model_equals_differences():
    flight = TinyFlight(inertia=INERTIAS[1], inclination_deg=70.0)
    r, v = place(0.0, flight.radius, flight.inclination)
    b = moment_matrix(flight.matrix, flight.orbital_dcm(r, v) @ dipole_field_i(0.0, r))
    zero = np.zeros(3)
    still = acceleration(flight, zero, zero, zero)
    for j, axis in enumerate(np.eye(3)):
        assert np.allclose(acceleration(flight, zero, zero, zero, axis) - still, b[3:, j], atol=1e-12)


def test_small_pitch_librates_at_the_known_frequency():
    n, (x, y, z) = 1e-3, (5.0, 6.0, 2.0)
    a = attitude_matrix(np.diag([x, y, z]), (0.0, -n, 0.0), (0.0, 0.0, 1.0))
    assert a[4, 1] == pytest.approx(-3.0 * n**2 * (x - z) / y, rel=1e-12)


def test_free_body_in_inertial_axes_drifts():
    a = attitude_matrix(np.diag([1.0, 2.0, 2.5]))
    assert np.array_equal(a[:3, 3:], np.eye(3)) and not a[3:].any()


def test_integral_states_take_the_angle():
    a, b = with_integral(np.ones((6, 6)), np.ones((7, 6, 3)))
    assert a.shape == (9, 9) and b.shape == (7, 9, 3)
    assert np.array_equal(a[6:, :3], np.eye(3)) and not b[:, 6:].any()
