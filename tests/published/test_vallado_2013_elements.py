"""Vallado, Fundamentals of Astrodynamics and Applications, 4th ed. (2013), examples 2-5 and 2-6; and satellites that fly."""

import numpy as np
import pytest

from fieldline.orbit.elements import Elements, elements_from_state, state_from_elements
from fieldline.orbit.sun_synchronous import sun_synchronous_inclination

LAST_DIGIT_DEG = 0.001


def test_example_2_5():
    found = elements_from_state([6524.834e3, 6862.875e3, 6448.296e3], [4901.327, 5533.756, -1976.341])
    of_its_velocity = 30.0  # seven digits of the velocity are worth 25 m of the axis
    assert found.semi_major_axis_m == pytest.approx(36127.343e3, abs=of_its_velocity)
    assert found.semi_latus_rectum_m == pytest.approx(11067.790e3, abs=of_its_velocity)
    assert found.eccentricity == pytest.approx(0.832853, abs=1e-6)
    assert np.degrees(found[2:]) == pytest.approx([87.870, 227.898, 53.38, 92.335], abs=5 * LAST_DIGIT_DEG)


def test_example_2_6():
    angles = np.radians([87.87, 227.89, 53.38, 92.335])
    position, velocity = state_from_elements(Elements(11067.790e3 / (1.0 - 0.83285**2), 0.83285, *angles))
    assert position / 1e3 == pytest.approx([6525.368, 6861.532, 6449.119], abs=1e-3)
    assert velocity / 1e3 == pytest.approx([4.902279, 5.533140, -1.975710], abs=1e-6)


@pytest.mark.parametrize(
    ("altitude_km", "inclination_deg"),
    [(705.0, 98.2), (832.0, 98.75), (786.0, 98.6)],  # Landsat 8; SPOT 5; Sentinel-2, as their operators publish them
)
def test_satellites_that_keep_their_local_time(altitude_km, inclination_deg):
    of_the_altitude = 0.1  # published without saying over what: 20 km are worth 0.08 deg
    assert np.degrees(sun_synchronous_inclination(1e3 * altitude_km)) == pytest.approx(inclination_deg, abs=of_the_altitude)
