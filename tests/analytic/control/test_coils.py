"""Equations (4), (8), (10), (11) of the 1961 study against the cross product itself, and their limits."""

import numpy as np
import pytest

from fieldline.control.coils import FLOOR, dumping_moment, three_coil_moment, two_coil_moment

pytestmark = pytest.mark.kernels

CASES = [(tuple(2e-5 * f), *t) for f, t in zip(*(np.random.default_rng(8).standard_normal((60, k)) for k in (3, 2)), strict=True)]
ROUNDING = 1e-12  # of the largest term: B_x is not nearly zero in these cases


def torque(moment, field):
    return np.cross(moment, field)


@pytest.mark.parametrize("kernel", [three_coil_moment, two_coil_moment])
@pytest.mark.parametrize(("field", "torque_y", "torque_z"), CASES[:20])
def test_both_laws_give_the_two_torques_and_the_same_roll(kernel, field, torque_y, torque_z):
    roll = -(torque_y * field[1] + torque_z * field[2]) / field[0]  # (4)
    wanted = np.array([roll, torque_y, torque_z])
    size = np.linalg.norm(wanted) * np.linalg.norm(field) / abs(field[0])
    assert np.abs(torque(kernel(field, torque_y, torque_z), field) - wanted).max() < ROUNDING * size


@pytest.mark.parametrize(("field", "torque_y", "torque_z"), CASES)
def test_three_coils_take_the_least_moment(field, torque_y, torque_z):
    three = np.array(three_coil_moment(field, torque_y, torque_z))
    two = np.array(two_coil_moment(field, torque_y, torque_z))
    assert abs(three @ field) < ROUNDING * np.linalg.norm(three) * np.linalg.norm(field)  # (5)
    along = (two - three) @ np.array(field) / np.dot(field, field)
    assert np.allclose(two - three, along * np.array(field), rtol=0.0, atol=1e-10 * np.linalg.norm(two))
    assert np.linalg.norm(three) <= np.linalg.norm(two) * (1.0 + ROUNDING)


@pytest.mark.parametrize(("field", "torque_y", "torque_z"), CASES)
def test_the_ratio_of_both_moments(field, torque_y, torque_z):
    # |M3|^2/|M2|^2 = cos^2 a + sin^2 a cos^2 p: a from B to x, p from the errors to the field across x.
    cosine = field[0] / np.linalg.norm(field)
    across, errors = np.array(field[1:]), np.array([torque_y, torque_z])
    cos_p = across @ errors / (np.linalg.norm(across) * np.linalg.norm(errors))
    three = np.sum(np.square(three_coil_moment(field, torque_y, torque_z)))
    two = np.sum(np.square(two_coil_moment(field, torque_y, torque_z)))
    assert three / two == pytest.approx(cosine**2 + (1.0 - cosine**2) * cos_p**2, rel=1e-9)


def test_without_field_along_the_line_three_coils_keep_one_combination():
    field, torque_y, torque_z = (0.0, 1e-5, 2e-5), 3e-4, -1e-4
    e = torque_y * field[2] - torque_z * field[1]
    square = field[1] ** 2 + field[2] ** 2
    given = np.array(three_coil_moment(field, torque_y, torque_z))
    saturated = np.clip(given, -100.0, 100.0)
    assert np.allclose(torque(saturated, field)[1:], [field[2] * e / square, -field[1] * e / square], rtol=1e-12)
    assert np.isfinite(given).all() and abs(given[1]) > 1e6


def test_without_field_along_the_line_two_coils_give_nothing():
    field = (0.0, 1e-5, 2e-5)
    saturated = np.clip(two_coil_moment(field, 3e-4, -1e-4), -50.0, 50.0)
    assert np.array_equal(torque(saturated, field)[1:], [0.0, 0.0])
    assert abs(saturated[1]) == abs(saturated[2]) == 50.0


def test_the_sign_of_a_vanishing_component_is_kept():
    for sign in (1.0, -1.0):
        field = (sign * 0.1 * FLOOR * 1e-5, 1e-5, 0.0)
        assert np.sign(two_coil_moment(field, 1.0, 1.0)[2]) == sign


@pytest.mark.parametrize(("field", "torque_y", "torque_z"), CASES[:20])
def test_dumping_takes_what_lies_across_the_field(field, torque_y, torque_z):
    momentum = np.array([1.0, torque_y, torque_z])
    got = torque(dumping_moment(field, tuple(momentum), 3e-4), field)
    across = momentum - np.array(field) * (momentum @ field) / np.dot(field, field)
    assert np.allclose(got, -3e-4 * across, rtol=1e-12, atol=1e-18)  # (12)


def test_no_field_no_moment():
    zero = (0.0, 0.0, 0.0)
    assert (
        three_coil_moment(zero, 1.0, 1.0) == two_coil_moment(zero, 1.0, 1.0) == dumping_moment(zero, (1.0, 1.0, 1.0), 1.0) == zero
    )
