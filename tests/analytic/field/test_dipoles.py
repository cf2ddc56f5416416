"""Dipoles against their closed form, and against the first degree of the harmonics."""

import numpy as np
import pytest

from fieldline.constants import IGRF_REFERENCE_RADIUS_M, MU0_OVER_4PI
from fieldline.environment import field_gradient, field_model, field_rate, magnetic_field
from fieldline.environment.coefficients import igrf14

pytestmark = pytest.mark.kernels

NOW = np.datetime64("2024-03-01T12:00")
MOMENT = 7.7e22  # A m^2, about the Earth's
SOUTHWARD = (0.0, 0.0, -MOMENT)


def test_field_at_the_pole_is_twice_that_at_the_equator():
    model = field_model("centred-dipole", moment_e=SOUTHWARD)
    pole, equator = magnetic_field([[0.0, 0.0, 7e6], [7e6, 0.0, 0.0]], NOW, model)
    assert np.allclose(pole, (0.0, 0.0, -2.0 * MU0_OVER_4PI * MOMENT / 7e6**3), rtol=1e-15)
    assert np.allclose(equator, (0.0, 0.0, MU0_OVER_4PI * MOMENT / 7e6**3), rtol=1e-15)


def test_inclination_follows_the_dipole_law():
    latitude = np.radians(np.linspace(-80.0, 80.0, 9))
    up = np.stack([np.cos(latitude), np.zeros(9), np.sin(latitude)], axis=-1)
    north = np.stack([-np.sin(latitude), np.zeros(9), np.cos(latitude)], axis=-1)
    field = magnetic_field(7e6 * up, NOW, field_model("centred-dipole", moment_e=SOUTHWARD))
    down_over_north = -np.sum(field * up, axis=-1) / np.sum(field * north, axis=-1)
    assert np.allclose(down_over_north, 2.0 * np.tan(latitude), rtol=1e-13)


def test_first_degree_of_igrf_is_the_dipole_of_its_three_coefficients():
    place = np.array([[5.0e6, -4.0e6, 3.0e6], [0.0, 0.0, -6.6e6]])
    c = igrf14()
    at_2020 = int(np.flatnonzero(c.epochs == 2020.0)[0])
    first = np.array([c.g[at_2020, 1, 1], c.h[at_2020, 1, 1], c.g[at_2020, 1, 0]])
    moment = first * IGRF_REFERENCE_RADIUS_M**3 / MU0_OVER_4PI
    epoch = np.datetime64("2020-01-01")
    centred = field_model("centred-dipole", moment_e=moment)
    for degree_one in (field_model("dipole"), field_model("IGRF-14", degree=1)):
        assert np.allclose(
            magnetic_field(place, epoch, degree_one), magnetic_field(place, epoch, centred), rtol=1e-13, atol=1e-20
        )
        assert np.allclose(
            field_gradient(place, epoch, degree_one), field_gradient(place, epoch, centred), rtol=1e-12, atol=1e-24
        )


def test_displaced_dipoles_are_shifted_and_added():
    position = np.array([[3e5, -2e5, 1e5], [-1e6, 5e5, 2e6]])
    moment = np.array([[1e21, -2e21, -6e22], [2e21, 3e20, -1e21]])
    both = field_model("displaced-dipoles", position_e=position, moment_e=moment)
    place = np.array([6.8e6, 1.0e6, -2.0e6])
    alone = sum(
        magnetic_field(place - p, NOW, field_model("centred-dipole", moment_e=m)) for p, m in zip(position, moment, strict=True)
    )
    assert np.allclose(magnetic_field(place, NOW, both), alone, rtol=1e-14)


def test_a_dipole_displaced_along_its_axis_has_the_quadrupole_of_its_shift():
    # Moment m at height z on the axis: g_n0 = mu0 m / (4 pi a^3) n (z/a)^(n-1), here to the second degree.
    shift, moment, radius = 5e4, -8e22, 4e7
    displaced = field_model("displaced-dipoles", position_e=(0.0, 0.0, shift), moment_e=(0.0, 0.0, moment))
    on_axis = magnetic_field((0.0, 0.0, radius), NOW, displaced)[2]
    series = 2.0 * MU0_OVER_4PI * moment / radius**3 * (1.0 + 3.0 * shift / radius + 6.0 * (shift / radius) ** 2)
    fourth_term = 10.0 * (shift / radius) ** 3
    assert abs(on_axis / series - 1.0) < 1.1 * fourth_term


def test_fixed_dipoles_do_not_change_with_time():
    model = field_model("centred-dipole", moment_e=SOUTHWARD)
    assert np.array_equal(field_rate((7e6, 0.0, 0.0), NOW, model), np.zeros(3))
    early, late = magnetic_field((7e6, 0.0, 0.0), np.array(["1750-01-01", "2200-01-01"], dtype="M8[D]"), model)
    assert np.array_equal(early, late)
