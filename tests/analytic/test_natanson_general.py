"""The general case of Natanson 1990 on local problems: a field that is quadratic in time, a body integrated apart."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.errors import InputError
from fieldline.estimation.natanson.choice import least_loss, rigid_loss
from fieldline.estimation.natanson.constant_rate import Status, constant_rate_roots
from fieldline.estimation.natanson.derivatives import Derivatives, finite_differences, seen_in_body
from fieldline.estimation.natanson.general import b_dot_torque, gravity_gradient_of_attitude, rigid_body_roots
from fieldline.mechanics.rigid_body import gravity_gradient

ASYMMETRIC = np.array([[2200.0, 40.0, -25.0], [40.0, 1500.0, 30.0], [-25.0, 30.0, 2600.0]])
AXISYMMETRIC = np.diag([1000.0, 1000.0, 1400.0])
NEAR_SPHERE = np.diag([1000.0, 1010.0, 1020.0])
DIGIT = 6.44e-7
GAIN = 5e8  # [A m^2 s/T]


def scene(speed_deg_s, count=30, seed=3):
    """Random attitudes, rates, positions and a field with the derivatives that an orbit gives it."""
    rng = np.random.default_rng(seed)
    direction = rng.normal(size=(count, 3))
    field = 35e-6 * direction / np.linalg.norm(direction, axis=1)[:, None]
    field_i = Derivatives(field, 40e-9 * rng.normal(size=(count, 3)), 5e-11 * rng.normal(size=(count, 3)))
    omega = rng.normal(size=(count, 3))
    omega *= np.radians(speed_deg_s) / np.linalg.norm(omega, axis=1)[:, None]
    position = rng.normal(size=(count, 3))
    position *= 7e6 / np.linalg.norm(position, axis=1)[:, None]
    return Rotation.random(count, rng=rng), omega, field_i, position


def dcm(rotation):
    return np.swapaxes(rotation.as_matrix(), -1, -2)


def field_at(field_i, t):
    return field_i.value + t * field_i.first + 0.5 * t * t * field_i.second


def moved(rotation, omega, field_i, inertia, t, torque):
    """The state at t by RK4 on the matrix and the rate: no code of the library."""
    parts = max(4, int(np.ceil(abs(t) * np.linalg.norm(omega, axis=1).max() / 0.02)))
    h, inverse = t / parts, np.linalg.inv(inertia)
    a, w = dcm(rotation), omega.copy()

    def slope(time, a, w):
        crossed = np.cross(np.eye(3)[None], w[:, None]) @ np.eye(3)  # rows e_j x w, so crossed = [w x]
        return -crossed @ a, (torque(time, a, w) - np.cross(w, w @ inertia)) @ inverse

    for k in range(parts):
        time = k * h
        k1 = slope(time, a, w)
        k2 = slope(time + h / 2, a + h / 2 * k1[0], w + h / 2 * k1[1])
        k3 = slope(time + h / 2, a + h / 2 * k2[0], w + h / 2 * k2[1])
        k4 = slope(time + h, a + h * k3[0], w + h * k3[1])
        a = a + h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0])
        w = w + h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1])
    return a


def no_torque(time, a, w):
    return 0.0 * w


def three_samples(rotation, omega, field_i, inertia, step, torque=no_torque, digit=0.0):
    """(3, n, 3) body-axes fields at -step, 0, step."""
    rows = [
        np.einsum("nij,nj->ni", moved(rotation, omega, field_i, inertia, t, torque), field_at(field_i, t))
        for t in (-step, 0, step)
    ]
    return np.round(np.array(rows) / digit) * digit if digit else np.array(rows)


def central(rows, step):
    """Derivatives over three samples, one problem a row."""
    return Derivatives(rows[1], (rows[2] - rows[0]) / (2 * step), (rows[2] - 2 * rows[1] + rows[0]) / step**2)


def errors_deg(rotation, roots):
    """(n, m), NaN where there is no root."""
    error = np.full(roots.angle_rad.shape, np.nan)
    for m in range(error.shape[1]):
        known = np.isfinite(roots.q_bi[:, m]).all(axis=1)
        if known.any():
            estimate = Rotation.from_quat(roots.q_bi[known, m])
            error[known, m] = np.degrees((estimate.inv() * rotation[known]).magnitude())
    return error


def best_deg(rotation, roots):
    return np.nanmin(np.column_stack([errors_deg(rotation, roots), np.full(len(roots.status), 180.0)]), axis=1)


@pytest.mark.parametrize("speed", [0.06, 0.5, 10.0, 50.0])
@pytest.mark.parametrize("inertia", [ASYMMETRIC, AXISYMMETRIC, NEAR_SPHERE], ids=["asymmetric", "axisymmetric", "near-sphere"])
def test_exact_derivatives_give_the_truth_among_all_roots(speed, inertia):
    rotation, omega, field_i, _ = scene(speed, count=60)
    acceleration = -np.cross(omega, omega @ inertia) @ np.linalg.inv(inertia)
    body = seen_in_body(field_i, dcm(rotation), omega, acceleration)
    roots = rigid_body_roots(body, field_i, inertia)
    error = errors_deg(rotation, roots)
    assert np.nanmin(error, axis=1).max() < 2e-6  # the reference's bound; 16 eigenvalues in double precision, then Newton
    which = np.nanargmin(error, axis=1)
    rows = np.arange(60)
    assert np.abs(roots.omega_b[rows, which] - omega).max() < 1e-8 * np.radians(speed)
    assert np.abs(roots.omega_rate_b[rows, which] - acceleration).max() < 1e-7 * np.radians(speed) ** 2
    counts = np.isfinite(roots.angle_rad).sum(axis=1)
    assert set(counts) <= {2, 4, 6}  # real roots of a real resultant come in pairs


def test_every_root_reproduces_the_second_derivative_of_the_field():
    """All roots, the false ones too, satisfy (2-1a), (2-1b) and (3-1): each is a body that the derivatives allow."""
    rotation, omega, field_i, _ = scene(0.3)
    acceleration = -np.cross(omega, omega @ ASYMMETRIC) @ np.linalg.inv(ASYMMETRIC)
    body = seen_in_body(field_i, dcm(rotation), omega, acceleration)
    roots = rigid_body_roots(body, field_i, ASYMMETRIC)
    for m in range(roots.angle_rad.shape[1]):
        n = np.isfinite(roots.angle_rad[:, m])
        a = dcm(Rotation.from_quat(roots.q_bi[n, m]))
        again = seen_in_body(Derivatives(*(x[n] for x in field_i)), a, roots.omega_b[n, m], roots.omega_rate_b[n, m])
        for given, found in zip(body, again, strict=True):
            size = np.linalg.norm(given[n], axis=1).max() + np.linalg.norm(found, axis=1)
            assert (np.linalg.norm(found - given[n], axis=1) < 1e-7 * size).all()


@pytest.mark.parametrize("difference", [0.0, 1e-13, 1e-9, 1e-5])
def test_a_sphere_or_nearly_one_agrees_with_the_constant_rate(difference):
    rotation, omega, field_i, _ = scene(0.06)
    body = seen_in_body(field_i, dcm(rotation), omega)
    general = rigid_body_roots(body, field_i, np.diag([1.0, 1.0 + difference, 1.0 + 2 * difference]))
    simple = constant_rate_roots(body, field_i)
    for m in range(2):
        gap = np.abs(np.exp(1j * general.angle_rad) - np.exp(1j * simple.angle_rad[:, m : m + 1]))
        assert np.nanmin(gap, axis=1).max() < 1e-7 + 1e3 * difference  # a false root may have a large omega_1, squared


@pytest.mark.parametrize("speed, step, median", [(10.0, 0.1, 0.2), (30.0, 0.1, 3.0), (50.0, 0.02, 0.8)])
def test_tumbler_by_differences_without_digits(speed, step, median):
    """Measured elsewhere: 0.06, 1.7 and 0.31 deg; geometry moves a median of 30 by a factor of two."""
    rotation, omega, field_i, _ = scene(speed)
    rows = three_samples(rotation, omega, field_i, ASYMMETRIC, step)
    roots = rigid_body_roots(central(rows, step), field_i, ASYMMETRIC)
    assert np.median(best_deg(rotation, roots)) < median


@pytest.mark.parametrize("speed, step", [(10.0, 0.1), (10.0, 2.0), (30.0, 0.5), (50.0, 0.1)])
def test_digits_leave_a_tumbler_without_roots(speed, step):
    """28 to 30 of 30 have no real root: the case that the paper hoped for cannot work with three digitised samples."""
    rotation, omega, field_i, _ = scene(speed)
    rows = three_samples(rotation, omega, field_i, ASYMMETRIC, step, digit=DIGIT)
    roots = rigid_body_roots(central(rows, step), field_i, ASYMMETRIC)
    assert np.sum(roots.status != Status.SOLVED) >= 26
    assert "no solution" in " ".join(roots.words())


def test_b_dot_mode_by_differences_errs_as_the_square_of_the_step():
    """N = -K dB x B known from the measurement itself; along an orbit it is in `published/test_natanson_1990`."""
    rotation, omega, field_i, _ = scene(0.2)

    def torque(time, a, w):
        b = np.einsum("nij,nj->ni", a, field_at(field_i, time))
        rate = np.einsum("nij,nj->ni", a, field_i.first + time * field_i.second) - np.cross(w, b)
        return -GAIN * np.cross(rate, b)

    medians = []
    for step in (4.0, 8.0):
        body = central(three_samples(rotation, omega, field_i, ASYMMETRIC, step, torque), step)
        inertial = central(np.array([field_at(field_i, t) for t in (-step, 0, step)]), step)
        with_torque = best_deg(rotation, rigid_body_roots(body, inertial, ASYMMETRIC, torque_b=b_dot_torque(GAIN, body)))
        medians.append(np.median(with_torque))
        assert np.median(best_deg(rotation, constant_rate_roots(body, inertial))) > 5.0
    assert medians[1] < 0.03
    assert medians[1] / medians[0] == pytest.approx(4.0, rel=0.1)


@pytest.mark.parametrize("speed", [0.06, 0.2])
def test_gravity_gradient_needs_no_iteration_and_must_not_be_forgotten(speed):
    """Reference: 0.003 and 0.011 deg at 8 s; neglected, an error floor of 12 and 7 deg."""
    rotation, omega, field_i, position = scene(speed)

    def torque(time, a, w):
        return gravity_gradient(np.einsum("nij,nj->ni", a, position), ASYMMETRIC)

    body = central(three_samples(rotation, omega, field_i, ASYMMETRIC, 8.0, torque), 8.0)
    inertial = central(np.array([field_at(field_i, t) for t in (-8.0, 0, 8.0)]), 8.0)
    external = gravity_gradient_of_attitude(position, ASYMMETRIC)
    with_it = best_deg(rotation, rigid_body_roots(body, inertial, ASYMMETRIC, external=external))
    without = best_deg(rotation, rigid_body_roots(body, inertial, ASYMMETRIC))
    assert np.median(with_it) < 0.03
    assert np.median(without) > 2.0


def test_a_torque_of_high_degree_is_refused():
    rotation, omega, field_i, _ = scene(0.2)
    body = seen_in_body(field_i, dcm(rotation), omega)
    with pytest.raises(InputError, match="degree two"):
        rigid_body_roots(body, field_i, ASYMMETRIC, external=lambda a: 1e-3 * a[..., 0] ** 3)
    with pytest.raises(InputError, match="a row for each sample"):
        rigid_body_roots(body, field_i, ASYMMETRIC, torque_b=np.zeros(3))


@pytest.mark.kernels
def test_loss_by_eulers_equation_chooses_with_three_steps_to_each_side():
    """A tumbler in one arc: five-point derivatives and the loss over +-3 samples find the true root."""
    rotation, omega, field_i, _ = scene(0.5, count=1, seed=8)
    times = 2.0 * np.arange(-20, 21)
    field = np.array([field_at(field_i, t)[0] for t in times])
    body = np.array([moved(rotation, omega, field_i, ASYMMETRIC, t, no_torque)[0] @ b for t, b in zip(times, field, strict=True)])
    filters = {"points": 5, "step_samples": 2}
    roots = rigid_body_roots(finite_differences(times, body, **filters), finite_differences(times, field, **filters), ASYMMETRIC)
    loss = rigid_loss(roots, times, body, field, ASYMMETRIC, step_samples=2, reach=3)
    chosen = least_loss(loss)[20]
    error = errors_deg(rotation[np.zeros(41, dtype=int)], roots)[20]
    assert chosen == np.nanargmin(error)
    assert error[chosen] < 0.05
    assert loss[20, chosen] < 1e-3 * np.delete(loss[20], chosen)[np.isfinite(np.delete(loss[20], chosen))].min()
