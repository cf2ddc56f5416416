"""Electromotive force of a bent line, currents of an insulated one."""

import numpy as np
import pytest

from fieldline.constants import EARTH_ROTATION_RATE_RAD_S, ELECTRON_MASS_KG, ELEMENTARY_CHARGE_C
from fieldline.dynamics.lines.current import line_emfs, series_current, sphere_limit

pytestmark = pytest.mark.kernels

POLE = (0.0, 0.0, 1.0)


def along(s):
    """A bent line of some 20 km: places (n, 3) [m], velocities [m/s], field [T] at s in 0 .. 1, and the tangent."""
    s = np.atleast_1d(s)[:, None]
    start, up = np.array([6.7e6, 1e4, -2e5]), np.array([2.0e4, 300.0, 900.0])
    place = start + s * up + 700.0 * np.sin(np.pi * s) * np.array([0.0, 0.6, 0.8])
    tangent = up + 700.0 * np.pi * np.cos(np.pi * s) * np.array([0.0, 0.6, 0.8])
    velocity = np.array([10.0, 7500.0, 900.0]) + s * np.array([3.0, 20.0, -5.0])
    field = np.array([1e-6, 4e-6, 2.7e-5]) + s * np.array([1e-7, -2e-7, -2e-7])
    return place, velocity, field, tangent


def test_emf_is_the_line_integral():
    fine = np.linspace(0.0, 1.0, 4001)
    place, velocity, field, tangent = along(fine)
    wind = velocity - EARTH_ROTATION_RATE_RAD_S * np.cross(POLE, place)
    exact = np.trapezoid(np.sum(np.cross(wind, field) * tangent, axis=1), fine)
    assert 3000.0 < abs(exact) < 5000.0
    errors = []
    for segments in (10, 20):
        ends, middle = np.linspace(0.0, 1.0, segments + 1), (np.arange(segments) + 0.5) / segments
        out = np.empty(segments)
        total = line_emfs(along(ends)[0], along(ends)[1], POLE, along(middle)[2], out)
        assert total == pytest.approx(out.sum(), rel=1e-14)
        errors.append(abs(total - exact))
    assert errors[0] < 3e-3
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


def test_upper_end_is_positive_when_the_line_flies_east():
    """Eastward across a field to the north the emf points up, less the part that the turning Earth's plasma takes along."""
    points = np.array([[6.678e6, 0.0, 0.0], [6.698e6, 0.0, 0.0]])
    speed = np.array([[0.0, 7726.0, 0.0], [0.0, 7749.0, 0.0]])
    out = np.empty(1)
    total = line_emfs(points, speed, POLE, np.array([[0.0, 0.0, 2.7e-5]]), out)
    relative = 0.5 * (7726.0 + 7749.0) - EARTH_ROTATION_RATE_RAD_S * 6.688e6
    assert total == pytest.approx(relative * 2.7e-5 * 2e4, rel=1e-12)


def test_a_sphere_of_the_size_of_a_satellite():
    collected, potential = sphere_limit(0.8, 7e11, 3e-5, 0.12, 1.0)
    thermal = 7e11 * ELEMENTARY_CHARGE_C * np.sqrt(ELEMENTARY_CHARGE_C * 0.12 / (2.0 * np.pi * ELECTRON_MASS_KG))
    assert collected == pytest.approx(2.0 * np.pi * 0.8**2 * thermal, rel=1e-12)
    assert potential == pytest.approx(ELEMENTARY_CHARGE_C * (3e-5 * 0.8) ** 2 / (8.0 * ELECTRON_MASS_KG), rel=1e-12)
    assert 0.01 < collected < 0.05 and 10.0 < potential < 15.0  # a few hundredths of an ampere at some ten volts
    assert sphere_limit(0.8, 7e11, 3e-5, 0.12, 2.5)[0] == pytest.approx(2.5 * collected)


@pytest.mark.parametrize("drive", [3500.0, -3500.0, 200.0, 5.0])
def test_current_balances_the_circuit(drive):
    resistance, collected, scale = 2100.0, 0.05, 12.0
    current = series_current(drive, resistance, collected, scale, 1e3)
    size = abs(current)
    potential = scale * max(0.0, size / collected - 1.0) ** 2
    assert resistance * size + potential == pytest.approx(abs(drive), rel=1e-12)
    assert np.sign(current) == np.sign(drive)


def test_limits_of_the_circuit():
    assert series_current(3500.0, 2100.0, -1.0, 0.0, 1e3) == pytest.approx(3500.0 / 2100.0)
    assert series_current(3500.0, 2100.0, -1.0, 0.0, 0.75) == 0.75
    assert series_current(-3500.0, 2100.0, -1.0, 0.0, 0.75) == -0.75
    assert series_current(3500.0, 2100.0, 0.0, 0.0, 1e3) == 0.0
    assert series_current(0.0, 2100.0, 0.05, 12.0, 1e3) == 0.0
