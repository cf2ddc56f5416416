"""Drag and heating of a segment against the plate's and the cylinder's formula in air that turns."""

import numpy as np
import pytest

from fieldline.constants import EARTH_ROTATION_RATE_RAD_S
from fieldline.dynamics.lines.air import air_heating, segment_drag, wind_past

pytestmark = pytest.mark.kernels

POLE, DENSITY, DIAMETER, DRAG = (0.0, 0.0, 1.0), 2e-11, 2.5e-3, 2.2
A = np.array([6.678e6, 0.0, 0.0])


def segment(direction, speed, length=500.0):
    """Its ends and their velocities, all tuples."""
    unit = np.array(direction) / np.linalg.norm(direction)
    ends = [A - 0.5 * length * unit, A + 0.5 * length * unit]
    return [tuple(part) for part in (ends[0], speed, ends[1], speed)]


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (1.0, 0.7, 0.0), (1.0, -2.0, 0.5)])
def test_a_cylinder_across_and_aslant(direction):
    speed = np.array([0.0, 7700.0, 100.0])
    wind = speed - EARTH_ROTATION_RATE_RAD_S * np.cross(POLE, A)
    size = np.linalg.norm(wind)
    unit = np.array(direction) / np.linalg.norm(direction)
    area = 500.0 * DIAMETER * np.sin(np.arccos(unit @ wind / size))
    force = segment_drag(*segment(direction, speed), POLE, DENSITY, DIAMETER, DRAG)
    assert force == pytest.approx(-0.5 * DENSITY * DRAG * area * size * wind, rel=1e-9)
    heat = air_heating(tuple(500.0 * unit), tuple(wind), DENSITY, DIAMETER)
    assert 500.0 * heat == pytest.approx(0.5 * DENSITY * area * size**3, rel=1e-9)


def test_air_turns_with_the_earth():
    still = EARTH_ROTATION_RATE_RAD_S * np.cross(POLE, A)
    assert wind_past(*segment((1.0, 0.0, 0.0), still), POLE) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    assert segment_drag(*segment((1.0, 0.0, 0.0), still), POLE, DENSITY, DIAMETER, DRAG) == pytest.approx(
        (0.0, 0.0, 0.0), abs=1e-20
    )
    east, west = (
        segment_drag(*segment((0.0, 0.0, 1.0), (0.0, v, 0.0)), POLE, DENSITY, DIAMETER, DRAG) for v in (7700.0, -7700.0)
    )
    turn = EARTH_ROTATION_RATE_RAD_S * A[0]
    assert -west[1] / east[1] == pytest.approx(((7700.0 + turn) / (7700.0 - turn)) ** 2, rel=1e-9)


def test_drag_takes_energy_from_any_segment():
    rng = np.random.default_rng(1)
    for _ in range(50):
        ends = segment(rng.standard_normal(3), rng.standard_normal(3) * 5000.0)
        force = segment_drag(*ends, POLE, DENSITY, DIAMETER, DRAG)
        assert np.dot(force, wind_past(*ends, POLE)) <= 0.0
