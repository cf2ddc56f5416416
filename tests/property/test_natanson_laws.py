"""Laws of the circle and of its roots for any attitude, rate and field."""

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fieldline.estimation.natanson.circle import attitude_at, transverse_rate, triad
from fieldline.estimation.natanson.constant_rate import Status, constant_rate_roots
from fieldline.estimation.natanson.derivatives import Derivatives, seen_in_body

# in thousandths: where a rate or a derivative is 1e-16 of the others, the answer is what rounding makes it
signed = st.integers(-1000, 1000).map(lambda thousandths: thousandths / 1000.0)
vectors = st.tuples(signed, signed, signed).map(np.array)
turns = st.tuples(*[st.floats(-3.0, 3.0)] * 3).map(np.array)


def scene(turn, rate, value, first, second):
    """A field of orbit size, its derivatives in body axes of a body that turns at up to 0.3 deg/s an axis."""
    assume(np.linalg.norm(value) > 0.2 and np.linalg.norm(np.cross(value, first)) > 0.02)
    field_i = Derivatives(4e-5 * value[None], 8e-8 * first[None], 2e-10 * second[None])
    dcm_bi = np.swapaxes(Rotation.from_rotvec(turn[None]).as_matrix(), 1, 2)
    omega = np.radians(0.3) * rate[None]
    body = seen_in_body(field_i, dcm_bi, omega)
    bent = np.linalg.norm(np.cross(body.value, body.first)) / (np.linalg.norm(body.value) * 8e-8)
    assume(bent > 0.02)
    return body, field_i, dcm_bi, omega


@settings(max_examples=200, deadline=None)
@given(turns, vectors, vectors, vectors, vectors)
def test_both_roots_satisfy_the_equations_and_the_truth_is_one(turn, rate, value, first, second):
    body, field_i, dcm_bi, omega = scene(turn, rate, value, first, second)
    roots = constant_rate_roots(body, field_i, beyond="nearest")
    assume(roots.status[0] != Status.EVERY_ANGLE)
    assume(roots.discriminant[0] > 1e-6)  # at a touch the root has half the digits
    circle = roots.circle
    away = np.hypot(circle.lambda_a + circle.lambda_r * np.cos(roots.angle_rad[0]), circle.lambda_r * np.sin(roots.angle_rad[0]))
    assume(away.min() > 0.02)  # where c vanishes omega_1 is free
    for q, w in zip(roots.q_bi[0], roots.omega_b[0], strict=True):
        again = seen_in_body(field_i, np.swapaxes(Rotation.from_quat(q[None]).as_matrix(), 1, 2), w[None])
        size = np.array([np.abs(x).max() for x in body]) + np.array([np.abs(x).max() for x in again])
        for given_, found, scale in zip(body, again, size, strict=True):
            assert np.abs(found - given_).max() < 1e-6 * scale
    error = (Rotation.from_quat(roots.q_bi[0]).inv() * Rotation.from_matrix(np.swapaxes(dcm_bi, 1, 2))).magnitude()
    true = np.argmin(error)
    assert error[true] < 1e-5
    assert np.abs(roots.omega_b[0, true] - omega[0]).max() < 1e-5 * np.radians(0.3) / away.min() ** 2


@settings(max_examples=100, deadline=None)
@given(turns, vectors, vectors, vectors, st.floats(0.0, 2.0 * np.pi))
def test_every_angle_on_the_circle_explains_field_and_first_derivative(turn, rate, value, first, angle):
    """(2-1a) and (2-1b) for any Phi and any omega_1: what two samples leave open."""
    body, field_i, _, _ = scene(turn, rate, value, first, np.zeros(3))
    circle = constant_rate_roots(body, field_i, beyond="nearest").circle
    dcm_bi = attitude_at(circle, np.array([[angle]]))[:, 0]
    two, three = transverse_rate(circle, np.array([[angle]]))
    omega = np.einsum("nij,nj->ni", circle.d_hat, np.stack([0.0 * two[:, 0] + 1e-3, two[:, 0], three[:, 0]], axis=-1))
    again = seen_in_body(field_i, dcm_bi, omega)
    assert np.abs(again.value - body.value).max() < 1e-12 * np.abs(body.value).max() + 1e-19
    assert np.abs(again.first - body.first).max() < 1e-10 * (np.abs(body.first).max() + np.abs(field_i.first).max())
    assert np.abs(dcm_bi[0] @ dcm_bi[0].T - np.eye(3)).max() < 1e-12


@settings(max_examples=60, deadline=None)
@given(turns, vectors, vectors, vectors, vectors, turns)
def test_turning_the_inertial_axes_turns_the_answer_and_nothing_else(turn, rate, value, first, second, other):
    body, field_i, _, _ = scene(turn, rate, value, first, second)
    spin = Rotation.from_rotvec(other)
    turned = Derivatives(*(spin.apply(x) for x in field_i))
    here, there = constant_rate_roots(body, field_i), constant_rate_roots(body, turned)
    assume(here.discriminant[0] > 1e-4)
    assert np.abs(np.exp(1j * here.angle_rad) - np.exp(1j * there.angle_rad)).max() < 1e-7
    moved = spin * Rotation.from_quat(here.q_bi[0])
    assert (moved.inv() * Rotation.from_quat(there.q_bi[0])).magnitude().max() < 1e-7


@settings(max_examples=60, deadline=None)
@given(vectors, vectors)
def test_triad_is_orthogonal_and_right_handed(value, first):
    assume(np.linalg.norm(np.cross(value, first)) > 1e-3)
    axes, magnitude, slope, sine, cosine = triad(value[None], first[None])
    assert np.abs(axes[0].T @ axes[0] - np.eye(3)).max() < 1e-9
    assert np.linalg.det(axes[0]) > 0.99
    assert abs(sine[0] ** 2 + cosine[0] ** 2 - 1.0) < 1e-9
    rebuilt = slope[0] * (cosine[0] * axes[0][:, 0] - sine[0] * axes[0][:, 2])  # (2-14)
    assert np.abs(rebuilt - first).max() < 1e-9
    assert np.abs(magnitude[0] * axes[0][:, 0] - value).max() < 1e-12
