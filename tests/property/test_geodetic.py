"""Geodetic coordinates there and back, over the whole space that satellites use."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fieldline.frames.earth_rotation import geodetic_from_itrs, itrs_from_geodetic

TWO_MILLIMETRES, FIVE_MICROMETRES = 2e-3, 5e-6  # ERFA's gc2gd makes one step of its iteration


@given(st.floats(-np.pi / 2, np.pi / 2), st.floats(-np.pi, np.pi), st.floats(-1e4, 4e7))
def test_round_trip(latitude, longitude, height):
    position = itrs_from_geodetic(latitude, longitude, height)
    again = itrs_from_geodetic(*geodetic_from_itrs(position))
    assert np.linalg.norm(again - position) < (FIVE_MICROMETRES if height < 1e6 else TWO_MILLIMETRES)
