"""Decimal years as UTC, as geomagnetic tables count."""

from pathlib import Path

import numpy as np
import pytest

DATA = Path(__file__).parent / "data"


@pytest.fixture
def table():
    """The named table of numbers."""
    return lambda name: np.loadtxt(DATA / name)


@pytest.fixture
def utc_of_year():
    """UTC of decimal years, to the nanosecond."""

    def convert(year):
        whole = np.floor(year).astype(int)
        start = (whole - 1970).astype("datetime64[Y]").astype("datetime64[ns]")
        end = (whole - 1969).astype("datetime64[Y]").astype("datetime64[ns]")
        part = (year - whole) * (end - start).astype(np.int64)
        return start + np.round(part).astype("timedelta64[ns]")

    return convert


@pytest.fixture
def local_axes():
    """(n, 3, 3) matrices that turn ITRS to north, east, down at a latitude and a longitude [rad]."""

    def matrices(latitude, longitude):
        sin_lat, cos_lat, sin_lon, cos_lon = np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)
        north = np.stack([-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat], axis=-1)
        east = np.stack([-sin_lon, cos_lon, np.zeros_like(sin_lon)], axis=-1)
        return np.stack([north, east, np.cross(north, east)], axis=-2)

    return matrices
