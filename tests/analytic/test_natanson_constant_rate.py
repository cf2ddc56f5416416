"""The constant-rate form of Natanson 1990 where its answer is known without it."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.errors import InputError
from fieldline.estimation.natanson.choice import constant_rate_loss, least_loss, offsets_of, take
from fieldline.estimation.natanson.circle import uncertainty_circle
from fieldline.estimation.natanson.constant_rate import Status, constant_rate_roots
from fieldline.estimation.natanson.derivatives import Derivatives, seen_in_body

FIELD_I = Derivatives(
    np.array([[12e-6, -21e-6, 18e-6]]), np.array([[25e-9, 14e-9, -31e-9]]), np.array([[-30e-12, 21e-12, 12e-12]])
)


def body_of(rotation, omega, field_i=FIELD_I):
    return seen_in_body(field_i, np.swapaxes(rotation.as_matrix(), -1, -2), np.atleast_2d(omega))


def test_body_at_rest_in_body_axes_sees_the_inertial_derivatives():
    roots = constant_rate_roots(body_of(Rotation.identity(1), [0.0, 0.0, 0.0]), FIELD_I)
    error = Rotation.from_quat(roots.q_bi[0]).magnitude()
    assert error.min() < 1e-9
    assert np.abs(roots.omega_b[0, np.argmin(error)]).max() < 1e-12


@pytest.mark.parametrize("half_turn", [np.pi, np.pi * (1 - 1e-9)])
def test_a_root_at_half_a_turn_is_found(half_turn):
    """Tan(Phi/2) has no value there: the paper's quadratic (3-11) loses this root."""
    radius = np.linalg.norm(np.cross(FIELD_I.value, FIELD_I.first)) / np.linalg.norm(FIELD_I.value) ** 2
    d1 = FIELD_I.value[0] / np.linalg.norm(FIELD_I.value)
    normal = np.cross(FIELD_I.value[0], FIELD_I.first[0])
    u2 = normal / np.linalg.norm(normal)
    u3 = np.cross(d1, u2)
    # A rate along U2 and faster than the circle's radius turns dB_A over, so that D2 = -U2: half a turn.
    attitude = Rotation.identity(1)
    omega_i = 2.5 * radius * (np.cos(half_turn - np.pi) * u2 + np.sin(half_turn - np.pi) * u3) + 3e-4 * d1
    roots = constant_rate_roots(body_of(attitude, omega_i), FIELD_I)
    error = Rotation.from_quat(roots.q_bi[0]).magnitude()
    true = np.argmin(error)
    assert error[true] < 1e-6
    assert roots.angle_rad[0, true] == pytest.approx(np.pi, abs=1e-6)
    assert roots.omega_b[0, true] == pytest.approx(omega_i, abs=1e-8)


def test_parallel_derivative_has_no_circle_and_says_so():
    body = Derivatives(FIELD_I.value, 0.0 * FIELD_I.first, FIELD_I.second)
    roots = constant_rate_roots(body, FIELD_I)
    assert roots.status[0] == Status.NO_CIRCLE
    assert np.isnan(roots.q_bi).all()
    assert "digitised too coarsely" in roots.words()[0]


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)])
@pytest.mark.parametrize("second", [(0.0, 0.0, 0.0), (2e-10, 2e-10, 0.0)])
def test_second_derivatives_that_vanish_across_the_field_leave_every_angle_open_and_it_says_so(turn, second):
    """A body at rest in a field whose rate is steady, or grows along it: any angle on the circle satisfies (3-7b)."""
    steady = Derivatives(np.array([[4e-5, 4e-5, 0.0]]), np.array([[0.0, 4e-8, 8e-8]]), np.array([second]))
    roots = constant_rate_roots(body_of(Rotation.from_rotvec([turn]), [0.0, 0.0, 0.0], steady), steady)
    assert roots.status[0] == Status.EVERY_ANGLE
    assert np.isnan(roots.q_bi).all() and np.isnan(roots.discriminant[0])
    assert "every attitude" in roots.words()[0]


def negative_discriminant(count=5):
    """The vector's own case at the ends, and derivatives that no attitude explains between."""
    rotation = Rotation.from_rotvec([[0.4, -0.9, 1.3]])
    body = body_of(rotation, np.radians([-0.018, 0.049, -0.034]))
    body, inertial = (Derivatives(*(np.repeat(x, count, axis=0) for x in d)) for d in (body, FIELD_I))
    # Along D3 the second derivative enters P by lambda_A and Q by lambda_R, which is the smaller here: |P| > |Q|.
    second = body.second.copy()
    second[1:-1] += 1e-9 * uncertainty_circle(body, inertial).d_hat[1:-1, :, 2]
    return Derivatives(body.value, body.first, second), inertial


def test_negative_discriminant_is_reported_and_carried_only_on_request():
    body, inertial = negative_discriminant()
    silent = constant_rate_roots(body, inertial)
    assert list(silent.status) == [Status.SOLVED, *[Status.NO_REAL_ROOT] * 3, Status.SOLVED]
    assert (silent.discriminant[1:-1] < 0.0).all() and silent.discriminant[0] > 0.0
    assert np.isnan(silent.q_bi[1:-1]).all() and np.isnan(silent.omega_b[1:-1]).all()
    carried = constant_rate_roots(body, inertial, beyond="previous")
    assert np.array_equal(carried.q_bi[1:-1], np.repeat(silent.q_bi[:1], 3, axis=0))
    assert np.array_equal(carried.status, silent.status)
    near = constant_rate_roots(body, inertial, beyond="nearest")
    assert np.isfinite(near.q_bi).all()
    assert near.angle_rad[1, 0] == pytest.approx(near.angle_rad[1, 1])
    with pytest.raises(InputError, match="beyond"):
        constant_rate_roots(body, inertial, beyond="guess")


def test_nothing_to_carry_at_the_start():
    body, inertial = negative_discriminant()
    last = slice(1, None)
    body, inertial = (Derivatives(*(x[last] for x in d)) for d in (body, inertial))
    carried = constant_rate_roots(body, inertial, beyond="previous")
    assert np.isnan(carried.q_bi[:3]).all() and np.isfinite(carried.q_bi[3]).all()


@pytest.mark.kernels
def test_loss_is_zero_for_the_truth_and_is_the_papers_for_one_step():
    seconds = 8.0 * np.arange(-4, 5)
    omega = np.radians([0.02, 0.05, -0.03])
    field_i = FIELD_I.value + seconds[:, None] * FIELD_I.first
    attitudes = Rotation.from_rotvec([0.4, -0.9, 1.3]) * Rotation.from_rotvec(np.outer(seconds, omega))
    field_b = attitudes.inv().apply(field_i)
    roots = constant_rate_roots(*(Derivatives(x, x, x) for x in (field_b, field_i)))
    wrong = attitudes * Rotation.from_rotvec([0.3, 0.0, 0.0])
    q_bi = np.stack([attitudes.as_quat(), wrong.as_quat()], axis=1)
    roots = roots._replace(q_bi=q_bi, omega_b=np.tile(omega, (9, 2, 1)), angle_rad=np.zeros((9, 2)))
    loss = constant_rate_loss(roots, seconds, field_b, field_i)
    assert np.isnan(loss[[0, -1]]).all()
    assert loss[1:-1, 0].max() < 1e-20  # rounding of a field of 3e-5 T, over 16 s
    by_hand = 0.0
    for k in (3, 5):
        moved = wrong[4] * Rotation.from_rotvec((seconds[k] - seconds[4]) * omega)
        by_hand += np.linalg.norm(field_b[k] - moved.inv().apply(field_i[k])) / 16.0
    assert loss[4, 1] == pytest.approx(by_hand, rel=1e-12)
    chosen = least_loss(loss)
    assert list(chosen) == [-1, *[0] * 7, -1]
    assert np.isnan(take(q_bi, chosen)[0]).all() and np.array_equal(take(q_bi, chosen)[4], q_bi[4, 0])


def test_offsets():
    assert list(offsets_of(2, 3)) == [-6, -3, 3, 6]
    with pytest.raises(InputError, match="1 or more"):
        offsets_of(0, 1)
