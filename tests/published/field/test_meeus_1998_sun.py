"""The Sun against Meeus, Astronomical Algorithms, 2nd ed. (1998), and against ERFA evaluated at every time."""

import erfa
import numpy as np
import pytest

from fieldline.environment import sun_direction_i, sun_position_i
from fieldline.errors import InputError
from fieldline.frames.time import utc_julian

AU_M = 149597870700.0
ABERRATION_DEG = 20.4955 / 3600.0
STATED_DEG = 0.01


def angle_deg(a, b):
    """Angle between directions."""
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), np.sum(a * b, axis=-1)))


def test_example_25b():
    # 1992 October 13.0 TD by the complete VSOP87: apparent right ascension 13h 13m 30.749s, declination -7d 47' 01.74",
    # R = 0.99760853 au.
    tt_minus_utc = 27.0 + 32.184
    time = np.datetime64("1992-10-13", "ns") - np.timedelta64(round(tt_minus_utc * 1e9), "ns")
    right_ascension = np.radians(15.0 * (13 + 13 / 60 + 30.749 / 3600))
    declination = -np.radians(7 + 47 / 60 + 1.74 / 3600)
    apparent = np.array(
        [
            np.cos(declination) * np.cos(right_ascension),
            np.cos(declination) * np.sin(right_ascension),
            np.sin(declination),
        ]
    )
    true_of_date = erfa.pnm06a(2448908.5, 0.0) @ sun_direction_i(time)
    an_arcsecond_deg = 1.0 / 3600.0
    assert abs(angle_deg(true_of_date, apparent) - ABERRATION_DEG) < an_arcsecond_deg
    assert angle_deg(true_of_date, apparent) < STATED_DEG
    assert abs(np.linalg.norm(sun_position_i(time)) / AU_M - 0.99760853) < 2e-8  # 3 km


def test_low_precision_formula_over_the_telemetry_age():
    # Meeus, ch. 25, lower accuracy: true longitude to 0.01 deg, mean equinox and ecliptic of date.
    time = np.datetime64("1995-01-01") + np.arange(0, 12000, 37) * np.timedelta64(1, "D")
    whole, part = utc_julian(time)
    days = whole - 2451545.0 + part + 66.0 / 86400.0
    t = days / 36525.0
    anomaly = np.radians(357.52911 + 35999.05029 * t - 0.0001537 * t**2)
    centre = (1.914602 - 0.004817 * t) * np.sin(anomaly) + (0.019993 - 0.000101 * t) * np.sin(2 * anomaly)
    centre += 0.000289 * np.sin(3 * anomaly)
    longitude = np.radians(280.46646 + 36000.76983 * t + 0.0003032 * t**2 + centre)
    obliquity = np.radians(23.4392911 - 0.0130042 * t)
    of_date = np.stack([np.cos(longitude), np.sin(longitude) * np.cos(obliquity), np.sin(longitude) * np.sin(obliquity)], axis=-1)
    mean_of_date = np.einsum("nij,nj->ni", erfa.pmat06(whole, part), sun_direction_i(time))
    assert angle_deg(mean_of_date, of_date).max() < STATED_DEG


def test_between_its_nodes_the_position_is_erfas():
    # Clear of leap seconds, on whose days erfa's quasi-Julian date counts 86,401 s.
    time = np.datetime64("2017-01-02") + np.arange(0, 40 * 86400, 4999) * np.timedelta64(1, "s")
    heliocentric, _ = erfa.epv00(*erfa.taitt(*erfa.utctai(*utc_julian(time))))
    tenth_of_a_kilometre_au = 1e2 / AU_M
    assert np.abs(sun_position_i(time) / AU_M + heliocentric["p"]).max() < tenth_of_a_kilometre_au


def test_one_time_gives_one_vector_and_order_does_not_matter():
    time = np.array(["2023-08-24T16", "1999-01-01", "2023-08-24T14"], dtype="M8[h]")
    together = sun_direction_i(time)
    assert together.shape == (3, 3)
    assert np.array_equal(together, [sun_direction_i(t) for t in time])
    assert np.allclose(np.linalg.norm(together, axis=1), 1.0, rtol=1e-15)
    assert sun_direction_i(time.reshape(3, 1)).shape == (3, 1, 3)
    assert sun_position_i(np.array([], dtype="M8[ns]")).shape == (0, 3)


def test_years_without_an_ephemeris():
    for time in ("1899-12-31", "2100-01-01"):
        with pytest.raises(InputError, match="1900 to 2100"):
            sun_direction_i(np.datetime64(time))
    assert np.isfinite(sun_direction_i(np.array(["1900-01-01", "2099-12-31"], dtype="M8[D]"))).all()
