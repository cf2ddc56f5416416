"""Least squares over a window: Jacobian, exact data, covariance, no prior."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.cases.erbs_like import erbs_like_arc
from fieldline.errors import InputError
from fieldline.estimation.natanson.window_fit import (
    expected_error_deg,
    fit_window,
    normal_equations_kernel,
    propagate,
    right_jacobian,
    starts_on_circle,
)

OMEGA = np.radians([-0.018, 0.049, -0.034])


def arc_of(seconds, rotation, omega, noise=0.0, seed=0):
    """A field that turns as along an orbit, and its body components."""
    angle = 2e-3 * seconds
    field_i = 3e-5 * np.stack([np.cos(angle), 0.6 * np.sin(angle), 0.5 + 0.3 * np.sin(0.5 * angle)], axis=-1)
    attitudes = rotation * Rotation.from_rotvec(np.outer(seconds, omega))
    noisy = noise * np.random.default_rng(seed).standard_normal(field_i.shape)
    return attitudes.inv().apply(field_i) + noisy, field_i


@pytest.mark.kernels
@pytest.mark.parametrize("theta", [(0.3, -0.7, 1.1), (1e-4, 2e-4, -1e-4), (0.0, 0.0, 0.0)])
def test_right_jacobian_is_that_of_the_rotation_group(theta):
    found = np.reshape(right_jacobian(theta), (3, 3))
    base, step = Rotation.from_rotvec(theta), 1e-6
    by_differences = [(base.inv() * Rotation.from_rotvec(np.array(theta) + step * unit)).as_rotvec() / step for unit in np.eye(3)]
    assert found == pytest.approx(np.transpose(by_differences), abs=2e-6)


@pytest.mark.kernels
def test_gradient_equals_differences_of_the_cost():
    seconds = 10.0 * np.arange(-20, 21)
    body, inertial = arc_of(seconds, Rotation.from_rotvec([0.4, -0.9, 1.3]), 5.0 * OMEGA)
    q, omega = Rotation.from_rotvec([0.5, -0.7, 1.2]), 4.0 * OMEGA
    normal, gradient = np.zeros((6, 6)), np.zeros(6)
    normal_equations_kernel(seconds, body, inertial, tuple(q.as_quat()), tuple(omega), 1e-7, normal, gradient)

    def cost(e, d):
        moved = (q * Rotation.from_rotvec(e)) * Rotation.from_rotvec(np.outer(seconds, omega + d))
        return 0.5 * np.sum((body - moved.inv().apply(inertial)) ** 2) / 1e-14

    zero = np.zeros(3)
    for k, unit in enumerate(np.eye(3)):
        slope = (cost(1e-5 * unit, zero) - cost(-1e-5 * unit, zero)) / 2e-5
        assert -gradient[k] == pytest.approx(slope, rel=1e-6)
        slope = (cost(zero, 1e-8 * unit) - cost(zero, -1e-8 * unit)) / 2e-8
        assert -gradient[3 + k] == pytest.approx(slope, rel=1e-6)


@pytest.mark.kernels
def test_exact_data_are_fitted_exactly_from_a_distant_start():
    seconds = 8.0 * np.arange(121)
    true = Rotation.from_rotvec([0.4, -0.9, 1.3])
    body, inertial = arc_of(seconds, true, OMEGA)
    start = (true * Rotation.from_rotvec([0.5, -0.4, 0.3])).as_quat()
    fit = fit_window(seconds, body, inertial, start, OMEGA + 2e-4, noise_tesla=1e-9, epoch_s=0.0)
    assert (Rotation.from_quat(fit.q_bi[0]).inv() * true).magnitude() < 1e-9
    assert fit.omega_b[0] == pytest.approx(OMEGA, abs=1e-12)
    there = propagate(fit.q_bi[0], fit.omega_b[0], seconds)
    assert Rotation.from_quat(there).inv().apply(inertial) == pytest.approx(body, abs=1e-13)


def test_covariance_covers_the_errors():
    """Normalised squared errors of 150 fits have the mean of chi^2 with six degrees, 6 +- 3 sigma = 6 +- 0.85."""
    seconds, true, noise = 8.0 * np.arange(121), Rotation.from_rotvec([0.4, -0.9, 1.3]), 2e-7
    squares, costs = [], []
    for seed in range(150):
        body, inertial = arc_of(seconds, true, OMEGA, noise, seed)
        fit = fit_window(seconds, body, inertial, true.as_quat(), OMEGA, noise_tesla=noise, epoch_s=0.0)
        attitude = (Rotation.from_quat(fit.q_bi[0]).inv() * true).as_rotvec()
        error = np.concatenate([attitude, OMEGA - fit.omega_b[0]])
        squares.append(error @ np.linalg.solve(fit.covariance[0], error))
        costs.append(fit.chi_square[0])
    assert np.mean(squares) == pytest.approx(6.0, abs=0.85)
    assert np.mean(costs) == pytest.approx(3 * 121 - 6, abs=3 * np.sqrt(2 * 357 / 150))


def test_a_bank_on_the_circle_needs_no_prior():
    """Eight attitudes about one field vector, at rest, over half an hour of 6.44 mG digits."""
    arc = erbs_like_arc(attitude="random", seed=11)
    window = slice(0, 241)
    starts = starts_on_circle(arc.measured_b[120], arc.field_i[120])
    assert Rotation.from_quat(starts).apply(arc.measured_b[120]) == pytest.approx(
        np.tile(arc.field_i[120], (8, 1)), abs=2e-7 * np.sqrt(3)
    )
    samples = arc.seconds[window], arc.measured_b[window], arc.field_i[window]
    fit = fit_window(*samples, starts, np.zeros((8, 3)), noise_tesla=6.44e-7 / np.sqrt(12), epoch_s=arc.seconds[120])
    error = np.degrees((Rotation.from_quat(fit.q_bi[0]).inv() * Rotation.from_quat(arc.q_bi[120])).magnitude())
    assert error < 4.0 * expected_error_deg(fit)
    assert fit.residual_rms_tesla[0] == pytest.approx(6.44e-7 / np.sqrt(12), rel=0.1)
    assert (np.diff(fit.chi_square) >= 0.0).all()


@pytest.mark.kernels
def test_one_fixed_direction_is_not_enough_and_the_covariance_says_so():
    """A field that never turns leaves the turn about it unknown: no covariance, or one beyond a full turn."""
    field = np.tile([3e-5, 0.0, 0.0], (60, 1))
    fit = fit_window(np.arange(60.0), field, field, [0, 0, 0, 1.0], np.zeros(3), noise_tesla=1e-8)
    sigma = np.sqrt(np.trace(fit.covariance[0][:3, :3]))
    assert not sigma < 2.0 * np.pi


@pytest.mark.parametrize(
    "change, words",
    [
        ({"noise_tesla": 0.0}, "noise_tesla"),
        ({"start_omega_b": np.zeros((2, 3))}, "each start"),
        ({"seconds": [np.nan] * 5}, "usable"),
    ],
)
def test_bad_requests_are_refused(change, words):
    given = {
        "seconds": np.arange(5.0),
        "field_b": np.ones((5, 3)),
        "field_i": np.ones((5, 3)),
        "start_q_bi": [0, 0, 0, 1.0],
        "start_omega_b": np.zeros(3),
        "noise_tesla": 1e-7,
    }
    with pytest.raises(InputError, match=words):
        fit_window(**(given | change))
