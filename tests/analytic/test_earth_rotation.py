"""Earth rotation against ERFA at each time, against the older theories, and against itself."""

import erfa
import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.frames.earth_rotation import dcm_ei, dcm_it, geodetic_from_itrs, itrs_from_geodetic
from fieldline.frames.time import utc_julian

LOW_ORBIT_M = 7.0e6


def scattered_times(count=400, first="1975-01-01", days=18000, seed=3):
    rng = np.random.default_rng(seed)
    return np.datetime64(first, "ns") + (rng.random(count) * days * 86400e9).astype("timedelta64[ns]")


def test_interpolated_pole_is_good_to_a_tenth_of_a_millimetre():
    times = scattered_times()
    day, fraction = utc_julian(times)
    exact = erfa.c2t06a(*erfa.taitt(*erfa.utctai(day, fraction)), day, fraction, 0.0, 0.0)
    # ERFA turns by s' too, which is 5e-5 arcseconds a century (0.8 mm) and belongs to polar motion.
    s_prime = erfa.pom00(0.0, 0.0, erfa.sp00(day, fraction))
    assert np.abs(np.swapaxes(s_prime, -1, -2) @ exact - dcm_ei(times)).max() * LOW_ORBIT_M < 1e-4


def test_teme_agrees_with_the_theories_of_1976_and_1980():
    """TEME to J2000 by the equation of the equinoxes, IAU 1980 nutation and IAU 1976 precession, without corrections."""
    times = scattered_times(60, "1995-01-01", 10000)
    day, fraction = utc_julian(times)
    tt = erfa.taitt(*erfa.utctai(day, fraction))
    equinoxes = erfa.nut80(*tt)[0] * np.cos(erfa.obl80(*tt))  # without the two terms of 1994, as TEME has it
    to_true = erfa.rz(-equinoxes, np.broadcast_to(np.eye(3), (60, 3, 3)))
    old = np.swapaxes(erfa.nutm80(*tt) @ erfa.pmat76(*tt), -1, -2) @ to_true
    # The old theories are 60 milliarcseconds off by now, 2 m; the axes of J2000 are 23 off those of GCRS.
    assert np.abs(old - dcm_it(times)).max() * LOW_ORBIT_M < 4.0


def test_a_time_gives_the_same_matrix_whatever_is_asked_beside_it():
    times = scattered_times(50, "2023-01-01", 2)
    for rotation in (dcm_ei, dcm_it):
        together = rotation(times)
        alone = np.array([rotation(time) for time in times])
        assert np.abs(together - alone).max() < 1e-13


def test_matrices_are_rotations_of_any_shape():
    times = scattered_times(12).reshape(3, 4)
    for rotation in (dcm_ei, dcm_it):
        matrices = rotation(times)
        assert matrices.shape == (3, 4, 3, 3)
        assert np.abs(matrices @ np.swapaxes(matrices, -1, -2) - np.eye(3)).max() < 1e-14
        assert np.linalg.det(matrices).min() > 0.999
        assert rotation(times[:0]).shape == (0, 4, 3, 3)


def test_the_earth_turns_eastward_once_in_a_sidereal_day():
    start = np.datetime64("2023-08-24T00:00:00.000000000")
    day_later = start + np.timedelta64(86164_098904_000, "ns")
    assert np.abs(dcm_ei(start) - dcm_ei(day_later)).max() < 5e-7  # 0.1 arcseconds: precession and nutation of one day
    quarter = dcm_ei(start + np.timedelta64(21541_024726_000, "ns")) @ dcm_ei(start).T
    assert quarter[0, 1] == pytest.approx(1.0, abs=1e-6)  # what was on e's y axis is on its x axis after a quarter turn


@pytest.mark.parametrize("year", ["1900-01-01", "1959-12-31", "2029-12-31", "2100-01-01"])
def test_years_without_leap_seconds_pass_in_silence(year):
    assert np.isfinite(dcm_ei(np.datetime64(year, "ns"))).all()


def test_geodetic_poles_equator_and_height():
    a, f = 6378137.0, 1.0 / 298.257223563
    places = np.array([[a + 5e5, 0.0, 0.0], [0.0, a, 0.0], [0.0, 0.0, a * (1.0 - f) + 4e5], [0.0, 0.0, -a * (1.0 - f)]])
    latitude, longitude, height = geodetic_from_itrs(places)
    assert latitude == pytest.approx([0.0, 0.0, np.pi / 2, -np.pi / 2])
    assert longitude[:2] == pytest.approx([0.0, np.pi / 2])
    assert height == pytest.approx([5e5, 0.0, 4e5, 0.0], abs=1e-8)


def test_geodetic_errors_say_what_to_do():
    with pytest.raises(InputError, match=r"\(3, 7\).*Use \.T"):
        geodetic_from_itrs(np.zeros((3, 7)))
    with pytest.raises(InputError, match="degrees"):
        itrs_from_geodetic(45.0, 0.0, 0.0)
