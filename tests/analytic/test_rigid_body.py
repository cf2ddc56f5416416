"""A free rigid body against its closed forms and its integrals."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError
from fieldline.mechanics.rigid_body import (
    as_inertia9,
    free_motion,
    gravity_gradient,
    gravity_gradient_torque,
    rigid_step,
    torqued_step,
)

pytestmark = pytest.mark.kernels
ASYMMETRIC = np.array([[2200.0, 40.0, -25.0], [40.0, 1500.0, 30.0], [-25.0, 30.0, 2600.0]])
IDENTITY_Q = (0.0, 0.0, 0.0, 1.0)


def test_constant_spin_about_a_principal_axis_is_exact_at_any_step():
    inertia, inverse = as_inertia9([3.0, 4.0, 5.0])
    q, omega = rigid_step(IDENTITY_Q, (0.0, 0.0, 0.8), 2.5, inertia, inverse)
    assert np.allclose(q, Rotation.from_rotvec([0, 0, 2.0]).as_quat(), atol=1e-15)
    assert np.allclose(omega, (0.0, 0.0, 0.8), atol=1e-16)


def test_symmetric_top_nutates_at_the_closed_form_rate():
    transverse, axial, spin, wobble = 3.0, 5.0, 0.4, 0.1
    seconds = np.linspace(0.0, 60.0, 61)
    _, omega = free_motion(seconds, IDENTITY_Q, (wobble, 0.0, spin), [transverse, transverse, axial])
    nutation = (axial - transverse) / transverse * spin
    expected = np.stack([wobble * np.cos(nutation * seconds), wobble * np.sin(nutation * seconds), 0 * seconds + spin], -1)
    assert np.abs(omega - expected).max() < 1e-7 * spin  # 500 inner steps that turn 0.05 rad at most


def test_momentum_is_fixed_in_space_and_energy_is_kept():
    seconds = np.linspace(0.0, 200.0, 101)
    q, omega = free_motion(seconds, IDENTITY_Q, (0.1, -0.5, 0.3), ASYMMETRIC)
    momentum_i = Rotation.from_quat(q).apply(omega @ ASYMMETRIC)
    energy = np.einsum("ni,ij,nj->n", omega, ASYMMETRIC, omega)
    assert np.abs(momentum_i - momentum_i[0]).max() < 1e-6 * np.linalg.norm(momentum_i[0])
    assert np.ptp(energy) < 1e-6 * energy[0]


def test_order_of_the_step_is_four():
    reference_q, _ = free_motion([0.0, 8.0], IDENTITY_Q, (0.1, -0.5, 0.3), ASYMMETRIC, step_max_s=0.01)
    errors = []
    for step in (0.5, 0.25):
        q, _ = free_motion([0.0, 8.0], IDENTITY_Q, (0.1, -0.5, 0.3), ASYMMETRIC, step_max_s=step)
        errors.append((Rotation.from_quat(q[-1]) * Rotation.from_quat(reference_q[-1]).inv()).magnitude())
    assert 3.7 < np.log2(errors[0] / errors[1]) < 4.6


def test_a_step_forward_and_back_returns():
    inertia, inverse = as_inertia9(ASYMMETRIC)
    torque = (0.2, -0.1, 0.4)
    q, omega = torqued_step(IDENTITY_Q, (0.02, -0.03, 0.01), 1.0, inertia, inverse, torque)
    q, omega = torqued_step(q, omega, -1.0, inertia, inverse, torque)
    assert np.allclose(q, IDENTITY_Q, atol=1e-12)
    assert np.allclose(omega, (0.02, -0.03, 0.01), atol=1e-12)


def test_constant_torque_about_a_principal_axis():
    inertia, inverse = as_inertia9([2.0, 3.0, 4.0])
    q, omega = torqued_step(IDENTITY_Q, (0.0, 0.1, 0.0), 2.0, inertia, inverse, (0.0, 0.6, 0.0))
    assert omega[1] == pytest.approx(0.1 + 0.2 * 2.0, abs=1e-15)
    assert 2.0 * np.arcsin(q[1]) == pytest.approx(0.1 * 2.0 + 0.5 * 0.2 * 4.0, abs=1e-15)


def test_gravity_gradient_of_a_dumbbell():
    """A body tilted by 45 degrees feels 3/2 n^2 (difference of moments), towards the vertical."""
    radius, moments = 6.978137e6, np.array([10.0, 10.0, 1.0])
    position = radius * np.array([np.sqrt(0.5), 0.0, np.sqrt(0.5)])
    expected = 1.5 * EARTH_GM_M3_S2 / radius**3 * (moments[0] - moments[2])
    torque = gravity_gradient(position, moments)
    assert torque == pytest.approx([0.0, expected, 0.0], abs=1e-15 * expected + 1e-18)
    inertia, _ = as_inertia9(moments)
    assert gravity_gradient_torque(tuple(position), inertia, EARTH_GM_M3_S2) == pytest.approx(torque, rel=1e-13, abs=1e-20)


@pytest.mark.parametrize(
    "inertia, words",
    [([1.0, 1.0, 3.0], "sum of the other two"), (np.ones((2, 2)), "shape"), ([[1, 0.2, 0], [0, 1, 0], [0, 0, 1]], "symmetric")],
)
def test_impossible_inertia_is_refused(inertia, words):
    with pytest.raises(InputError, match=words):
        as_inertia9(inertia)
