"""Temperature of a line: balance, cooling, time constants; what it is lit by."""

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from fieldline.constants import ASTRONOMICAL_UNIT_M, EARTH_EQUATORIAL_RADIUS_M, SOLAR_CONSTANT_W_M2, STEFAN_BOLTZMANN_W_M2_K4
from fieldline.dynamics.lines.heat import balance_temperature, line_heating, warm_resistance, warming
from fieldline.environment.radiation import ALBEDO, EARTH_INFRARED_W_M2, light_on_line, line_view

pytestmark = pytest.mark.kernels

SUN = (ASTRONOMICAL_UNIT_M, 0.0, 0.0)


def seen(cos_vertical, radius):
    """W by quadrature: sin psi over the Earth's disc, over pi."""
    half = np.arcsin(EARTH_EQUATORIAL_RADIUS_M / radius)
    sine = np.sqrt(1.0 - cos_vertical**2)
    turn = (np.arange(400) + 0.5) * (2.0 * np.pi / 400)

    def ring(angle):
        along = np.cos(angle) * cos_vertical + np.sin(angle) * sine * np.cos(turn)
        return np.sin(angle) * np.sqrt(np.maximum(1.0 - along**2, 0.0)).mean() * 2.0 * np.pi

    return quad(ring, 0.0, half, limit=200)[0] / np.pi


@pytest.mark.parametrize("height", [0.0, 300e3, 1000e3])
@pytest.mark.parametrize("cosine", [0.0, 0.4, 0.8, 1.0, -0.8])
def test_the_earth_as_a_line_sees_it(height, cosine):
    radius = EARTH_EQUATORIAL_RADIUS_M + height
    assert line_view(cosine, radius) == pytest.approx(seen(cosine, radius), rel=2e-3)


def test_closed_forms_of_the_view():
    radius = EARTH_EQUATORIAL_RADIUS_M + 400e3
    half = np.arcsin(EARTH_EQUATORIAL_RADIUS_M / radius)
    assert line_view(1.0, radius) == pytest.approx(half - np.sin(half) * np.cos(half), rel=3e-3)  # a line that hangs down
    assert line_view(0.3, EARTH_EQUATORIAL_RADIUS_M) == pytest.approx(np.pi / 2.0, rel=1e-12)  # half of its circumference
    far = 60.0 * EARTH_EQUATORIAL_RADIUS_M
    assert line_view(0.0, far) == pytest.approx((EARTH_EQUATORIAL_RADIUS_M / far) ** 2, rel=3e-2)


def test_sun_albedo_and_shadow():
    radius = EARTH_EQUATORIAL_RADIUS_M + 400e3
    day, infrared = light_on_line((radius, 0.0, 0.0), (0.0, 1.0, 0.0), SUN)
    view = line_view(0.0, radius)
    assert infrared == pytest.approx(EARTH_INFRARED_W_M2 * view, rel=1e-14)
    assert day == pytest.approx(SOLAR_CONSTANT_W_M2 * (1.0 + ALBEDO * view), rel=1e-3)
    hanging, _ = light_on_line((radius, 0.0, 0.0), (1.0, 0.0, 0.0), SUN)
    assert hanging == pytest.approx(SOLAR_CONSTANT_W_M2 * ALBEDO * line_view(1.0, radius), rel=1e-3)
    night, still = light_on_line((-radius, 0.0, 0.0), (0.0, 1.0, 0.0), SUN)
    assert (night, still) == (0.0, pytest.approx(infrared, rel=1e-14))


def test_balance():
    taken = line_heating(1361.0, 0.0, 0.0, 0.0, 2.5e-3, 0.5, 0.8)
    hot = balance_temperature(taken, 2.5e-3, 0.8)
    assert hot == pytest.approx((0.5 * 1361.0 / (np.pi * 0.8 * STEFAN_BOLTZMANN_W_M2_K4)) ** 0.25, rel=1e-14)
    assert warming(hot, taken, 2.5e-3, 0.8, 10.0) == pytest.approx(0.0, abs=1e-15)
    assert line_heating(0.0, 300.0, 0.02, 0.3, 1e-3, 0.5, 0.8) == pytest.approx(0.24 + 0.32)


def test_cooling_against_the_closed_form():
    diameter, emissivity, capacity, start = 2.5e-3, 0.8, 8.2e-3 * 900.0, 350.0
    found = solve_ivp(
        lambda _, y: [warming(y[0], 0.0, diameter, emissivity, capacity)], (0.0, 3000.0), [start], rtol=1e-10, atol=1e-8
    )
    rate = 3.0 * np.pi * diameter * emissivity * STEFAN_BOLTZMANN_W_M2_K4 / capacity
    assert found.y[0, -1] == pytest.approx((start**-3.0 + rate * 3000.0) ** (-1.0 / 3.0), rel=1e-8)


def test_resistance_of_warm_metal():
    assert warm_resistance(0.1, 393.15, 0.0039, 293.15) == pytest.approx(0.139)
    assert warm_resistance(0.1, 293.15, 0.0039, 293.15) == 0.1
