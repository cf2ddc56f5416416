"""ppigrf, an independent implementation of IGRF-14 in spherical coordinates, as an oracle."""

import datetime

import numpy as np
import ppigrf
import pytest

from fieldline.environment import magnetic_field
from fieldline.frames.earth_rotation import itrs_from_geodetic

pytestmark = pytest.mark.kernels

ROUNDING_NT = 1e-6
# ppigrf interpolates in days between epochs, IAGA in decimal years: within a leap year they part by up to 0.75 day.
CALENDAR_NT = 0.5


@pytest.fixture
def places():
    random = np.random.default_rng(14)
    colatitude = np.degrees(np.arccos(random.uniform(-0.9999, 0.9999, 300)))
    return random.uniform(6371.2, 42000.0, 300), colatitude, random.uniform(-180.0, 360.0, 300)


def ours_gc(radius_km, colatitude_deg, longitude_deg, time):
    """Radial, southward and eastward field [nT]."""
    theta, phi = np.radians(colatitude_deg), np.radians(longitude_deg)
    sin_t, cos_t, sin_p, cos_p = np.sin(theta), np.cos(theta), np.sin(phi), np.cos(phi)
    up = np.stack([sin_t * cos_p, sin_t * sin_p, cos_t], axis=-1)
    south = np.stack([cos_t * cos_p, cos_t * sin_p, -sin_t], axis=-1)
    east = np.stack([-sin_p, cos_p, np.zeros_like(sin_p)], axis=-1)
    field = magnetic_field(up * radius_km[:, None] * 1e3, time) * 1e9
    return [np.sum(field * axis, axis=-1) for axis in (up, south, east)]


@pytest.mark.parametrize("year", [1900, 1945, 1995, 2000, 2015, 2020, 2025])
def test_at_an_epoch_to_rounding(places, year):
    oracle = ppigrf.igrf_gc(*places, datetime.datetime(year, 1, 1))
    ours = ours_gc(*places, np.datetime64(f"{year}-01-01"))
    assert np.abs(np.squeeze(oracle) - ours).max() < ROUNDING_NT


@pytest.mark.parametrize("day", ["1903-05-17", "1988-12-31", "2012-06-30", "2023-08-24", "2028-02-29"])
def test_between_epochs_to_the_calendar(places, day):
    oracle = ppigrf.igrf_gc(*places, datetime.datetime.fromisoformat(day))
    assert np.abs(np.squeeze(oracle) - ours_gc(*places, np.datetime64(day))).max() < CALENDAR_NT


def test_geodetic(places):
    _, colatitude, longitude = places
    latitude = 90.0 - colatitude
    height_km = np.linspace(0.0, 900.0, 300)
    east, north, up = (np.squeeze(c) for c in ppigrf.igrf(longitude, latitude, height_km, datetime.datetime(2020, 1, 1)))
    position = itrs_from_geodetic(np.radians(latitude), np.radians(longitude), height_km * 1e3)
    ours = np.linalg.norm(magnetic_field(position, np.datetime64("2020-01-01")), axis=1) * 1e9
    half_a_millimetre_nt = 5e-5  # ppigrf's flattening constant has 12 digits
    assert np.abs(ours - np.sqrt(east**2 + north**2 + up**2)).max() < half_a_millimetre_nt
