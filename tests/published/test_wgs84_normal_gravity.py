"""Gravity of the level ellipsoid: NIMA TR8350.2, Department of Defense World Geodetic System 1984, 3rd ed., ch. 3 and 5.

The potential's even zonals and the closed-form gravity on the ellipsoid are derived there independently of each other.
"""

import numpy as np
import pytest

from fieldline.environment.gravity import gravity_kernel, gravity_model, gravity_potential_kernel, harmonic_gravity

pytestmark = pytest.mark.kernels

ZONALS = {  # Table 5.1 (degree 2) and the series of section 5
    2: -0.484166774985e-03,
    4: 0.790303733511e-06,
    6: -0.168724961151e-08,
    8: 0.346052468394e-11,
    10: -0.265002225747e-14,
}
GM, OMEGA = 3.986004418e14, 7.292115e-5
SEMI_MAJOR, SEMI_MINOR = 6378137.0, 6356752.3142
GRAVITY_EQUATOR, GRAVITY_POLE, POTENTIAL = 9.7803253359, 9.8321849378, 62636851.7146  # Table 3.4


@pytest.fixture(scope="module")
def level_ellipsoid():
    c = np.zeros((11, 11))
    for n, value in ZONALS.items():
        c[n, 0] = value
    return harmonic_gravity(c, 0.0 * c, GM, SEMI_MAJOR)


def test_gravity_at_the_equator_and_at_the_pole(level_ellipsoid):
    equator = gravity_kernel((0.0, SEMI_MAJOR, 0.0), level_ellipsoid)
    pole = gravity_kernel((0.0, 0.0, -SEMI_MINOR), level_ellipsoid)
    assert -equator[1] - OMEGA**2 * SEMI_MAJOR == pytest.approx(GRAVITY_EQUATOR, abs=2e-10)
    assert pole[2] == pytest.approx(GRAVITY_POLE, abs=3e-10)  # its semi-minor axis is printed to 0.1 mm
    assert max(abs(equator[0]), abs(equator[2]), abs(pole[0]), abs(pole[1])) < 1e-15


def test_the_ellipsoid_is_level(level_ellipsoid):
    for latitude in np.radians([0.0, 20.0, 45.0, 70.0, 90.0]):  # parametric
        across, z = SEMI_MAJOR * np.cos(latitude), SEMI_MINOR * np.sin(latitude)
        whole = gravity_potential_kernel((across, 0.0, z), level_ellipsoid) - 0.5 * OMEGA**2 * across**2
        assert whole == pytest.approx(-POTENTIAL, abs=1e-3)


def test_the_earth_is_near_its_ellipsoid(level_ellipsoid):
    """The real field leaves the level ellipsoid's by anomalies of under 1e-3 m/s^2, its degree 2 by a few parts in 1e6."""
    for place in np.random.default_rng(2).standard_normal((30, 3)):
        r_e = tuple(6.5e6 * place / np.linalg.norm(place))
        real, level = gravity_kernel(r_e, gravity_model("harmonic", 70)), gravity_kernel(r_e, level_ellipsoid)
        assert 1e-7 < np.linalg.norm(np.subtract(real, level)) < 1e-3
