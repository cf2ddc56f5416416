"""The filter's model of motion against closed forms and differences."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from fieldline.estimation.inertia import inertia_of, shape_of
from fieldline.estimation.motion import propagate, random_walk, rigid_body
from fieldline.frames.attitude import rotation_error_b

pytestmark = pytest.mark.kernels

ZERO = (0.0, 0.0, 0.0)
INERTIA = np.array([[2.2, 0.04, -0.025], [0.04, 1.5, 0.03], [-0.025, 0.03, 2.6]])


def start(seed):
    q = Rotation.random(random_state=seed).as_quat()
    w = np.random.default_rng(seed).normal(size=3) * 0.05
    return tuple(map(float, q)), tuple(map(float, w))


def moved(q, w, error, change):
    turned = (Rotation.from_quat(q) * Rotation.from_rotvec(error)).as_quat()
    return tuple(map(float, turned)), tuple(map(float, np.asarray(w) + change))


def test_constant_rate_turns_by_rate_times_time_either_way():
    q, w = start(1)
    for h in (7.0, -7.0):
        there, rate, *_ = propagate(q, w, ZERO, ZERO, ZERO, h, random_walk(0.0))
        expected = (Rotation.from_quat(q) * Rotation.from_rotvec(np.array(w) * h)).as_quat()
        assert np.abs(rotation_error_b(expected, np.array(there))).max() < 1e-14
        assert rate == w


def test_a_gyro_carries_the_random_walk():
    q, w = start(2)
    gyro = (0.03, -0.01, 0.02)
    rides, *_ = propagate(q, w, gyro, ZERO, ZERO, 3.0, random_walk(0.0))
    alone, *_ = propagate(q, tuple(np.add(w, gyro)), ZERO, ZERO, ZERO, 3.0, random_walk(0.0))
    assert np.allclose(rides, alone, atol=1e-15)


def test_a_commanded_dipole_acts_as_a_residual_one():
    q, w = start(6)
    moment, field_i = (0.3, -0.1, 0.2), (2e-5, -3e-5, 1e-5)
    commanded = propagate(q, w, moment, field_i, ZERO, 6.0, rigid_body(INERTIA, 0.0))
    residual = propagate(q, w, ZERO, field_i, ZERO, 6.0, rigid_body(INERTIA, 0.0, dipole=moment))
    assert commanded[0] == residual[0] and commanded[1] == residual[1]
    assert commanded[1] != propagate(q, w, ZERO, field_i, ZERO, 6.0, rigid_body(INERTIA, 0.0))[1]


@pytest.mark.parametrize("h", [2.0, -5.0, 20.0])
def test_rigid_body_follows_eulers_equations(h):
    """Against SciPy's DOP853, with residual dipole and gravity gradient held along the step as the kernel holds them."""
    q, w = start(3)
    model = rigid_body(INERTIA, 0.0, dipole=(0.4, -0.2, 0.3))
    field_i, pull_i = (3e-5, -1e-5, 2e-5), (1.2e-3, 0.9e-3, -1.0e-3)

    def rates(_, y):
        to_body = Rotation.from_quat(y[:4]).inv()
        b, g, omega = to_body.apply(field_i), to_body.apply(pull_i), y[4:]
        torque = np.cross([0.4, -0.2, 0.3], b) + np.cross(g, INERTIA @ g)
        turn = Rotation.from_quat(y[:4]).as_quat()
        v, s = turn[:3], turn[3]
        dq = 0.5 * np.r_[s * omega + np.cross(v, omega), -v @ omega]
        return np.r_[dq, np.linalg.solve(INERTIA, torque - np.cross(omega, INERTIA @ omega))]

    exact = solve_ivp(rates, (0.0, h), np.r_[q, w], method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    there, rate, *_ = propagate(q, w, ZERO, field_i, pull_i, h, model)
    # substeps of at most 0.15 rad: 2e-7 rad each
    assert np.abs(rotation_error_b(exact[:4] / np.linalg.norm(exact[:4]), np.array(there))).max() < 3e-6
    assert np.abs(exact[4:] - rate).max() < 1e-7


@pytest.mark.parametrize("model", [random_walk(0.0), rigid_body(INERTIA, 0.0)], ids=["random walk", "rigid body"])
@pytest.mark.parametrize("h", [0.5, 4.0, -3.0])
def test_derivatives_equal_differences(model, h):
    q, w = start(4)
    there, rate, phi, psi, lam = propagate(q, w, ZERO, ZERO, ZERO, h, model)
    size = 1e-6
    for k in range(3):
        e = np.zeros(3)
        e[k] = size
        turned, _, *_ = propagate(*moved(q, w, e, 0.0), ZERO, ZERO, ZERO, h, model)
        assert np.allclose(rotation_error_b(np.array(turned), np.array(there)) / size, np.reshape(phi, (3, 3))[:, k], atol=2e-3)
        turned, faster, *_ = propagate(*moved(q, w, np.zeros(3), e), ZERO, ZERO, ZERO, h, model)
        assert np.allclose(
            rotation_error_b(np.array(turned), np.array(there)) / size, np.reshape(psi, (3, 3))[:, k], atol=5e-3 * abs(h)
        )
        assert np.allclose(np.subtract(faster, rate) / size, np.reshape(lam, (3, 3))[:, k], atol=2e-3)


def test_a_rate_that_ran_away_ends_in_bounded_time():
    _, rate, *_ = propagate((0.0, 0.0, 0.0, 1.0), (1e30, 0.0, 1e30), ZERO, ZERO, ZERO, 1.0, rigid_body(INERTIA, 0.0))
    assert not np.isfinite(rate).all() or np.abs(rate).max() > 1e20


def test_shape_numbers_and_inertia_are_inverses_and_every_shape_is_a_body():
    rng = np.random.default_rng(5)
    for _ in range(50):
        shape = rng.normal(size=5)
        inertia = inertia_of(shape)
        moments = np.linalg.eigvalsh(inertia)
        assert moments[0] > 0 and moments[2] < moments[0] + moments[1]
        assert np.isclose(np.trace(inertia), 3.0)
        assert np.allclose(shape_of(7.0 * inertia), shape, atol=1e-9)
