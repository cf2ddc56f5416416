"""Harmonic gravity at single places, as other programs publish it.

Montenbruck and Gill, Satellite Orbits (2000), exercise 3-1: their program with JGM-3 at one place, degree and order n.
brahe (an astrodynamics library): EGM2008, tide-free, degree and order 60, on the equator at longitude 0.
"""

import numpy as np
import pytest

from fieldline.environment.gravity import PERMANENT_TIDE_C20, gravity_kernel, gravity_model

pytestmark = pytest.mark.kernels

PLACE_M = (6525.919e3, 1710.416e3, 2508.886e3)
JGM3 = {
    2: (-6.97922756436, -1.82928105380, -2.69001658552),
    4: (-6.97931189287, -1.82931487069, -2.68999140120),
    8: (-6.97927699747, -1.82928186346, -2.68998582282),
    12: (-6.97924725688, -1.82928130662, -2.68998625958),
    16: (-6.97926211023, -1.82928438361, -2.68999719587),
    20: (-6.97926186200, -1.82928315091, -2.68999053339),
}
OF_THE_MODELS = 1e-6  # JGM-3, of 1994, is that far from EGM2008 at degree 20 and 1e-7 at degree 2; the next degree is worth 1e-5
AT_THE_EQUATOR = (-9.81433239, 1.813976e-6, -7.29925652190e-5)


@pytest.mark.parametrize("degree", JGM3)
def test_exercise_3_1(degree):
    assert gravity_kernel(PLACE_M, gravity_model("harmonic", degree)) == pytest.approx(JGM3[degree], abs=OF_THE_MODELS)


def test_degree_sixty_of_the_same_coefficients():
    gravity = gravity_model("harmonic", 60)
    found = gravity_kernel((gravity.radius_m, 0.0, 0.0), gravity)
    of_the_permanent_tide = 1.5 * np.sqrt(5.0) * PERMANENT_TIDE_C20 * gravity.gm / gravity.radius_m**2
    assert found[0] - of_the_permanent_tide == pytest.approx(AT_THE_EQUATOR[0], abs=1e-8)
    assert found[1:] == pytest.approx(AT_THE_EQUATOR[1:], abs=1e-12)
