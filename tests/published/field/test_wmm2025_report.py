"""The table of test values published with WMM2025 (source: data/NOTICE.md): all its nineteen columns."""

import numpy as np
import pytest

from fieldline.environment import field_rate, magnetic_field
from fieldline.frames.earth_rotation import itrs_from_geodetic

pytestmark = pytest.mark.kernels

A_TENTH_NT = 0.05 + 1e-6  # X to F and their rates print 0.1 nT
A_HUNDREDTH_DEG = 0.005 + 1e-6  # inclination, declination, grid variation and their rates print 0.01 deg
YEAR_S = 365 * 86400.0  # neither 2025 nor 2027 is a leap year


@pytest.fixture
def local(table, local_axes, utc_of_year):
    """The table's rows, and field [nT] and rate [nT/year] in north, east and down."""
    rows = table("wmm2025_test_values.txt")
    latitude, longitude = np.radians(rows[:, 2:4]).T
    position = itrs_from_geodetic(latitude, longitude, rows[:, 1] * 1e3)
    turn = local_axes(latitude, longitude)
    time = utc_of_year(rows[:, 0])
    field = np.einsum("nij,nj->ni", turn, magnetic_field(position, time, "WMM2025")) * 1e9
    rate = np.einsum("nij,nj->ni", turn, field_rate(position, time, "WMM2025")) * 1e9 * YEAR_S
    return rows, field, rate


def test_components_and_magnitudes(local):
    rows, field, _ = local
    horizontal = np.hypot(field[:, 0], field[:, 1])
    computed = np.column_stack([field, horizontal, np.linalg.norm(field, axis=1)])
    assert np.abs(computed - rows[:, 4:9]).max() < A_TENTH_NT


def test_inclination_declination_and_grid_variation(local):
    rows, (x, y, z) = local[0], local[1].T
    inclination, declination = np.degrees([np.arctan2(z, np.hypot(x, y)), np.arctan2(y, x)])
    assert np.abs(np.column_stack([inclination, declination]) - rows[:, 9:11]).max() < A_HUNDREDTH_DEG
    polar = np.abs(rows[:, 2]) > 55.0
    assert np.array_equal(polar, np.isfinite(rows[:, 11]))
    grid = declination - np.sign(rows[:, 2]) * rows[:, 3]
    away = (grid - rows[:, 11] + 180.0) % 360.0 - 180.0
    assert np.abs(away[polar]).max() < A_HUNDREDTH_DEG


def test_secular_variation(local):
    rows, (x, y, z), (dx, dy, dz) = local[0], local[1].T, local[2].T
    horizontal, total = np.hypot(x, y), np.sqrt(x**2 + y**2 + z**2)
    d_horizontal = (x * dx + y * dy) / horizontal
    d_total = (x * dx + y * dy + z * dz) / total
    computed = np.column_stack([dx, dy, dz, d_horizontal, d_total])
    assert np.abs(computed - rows[:, 12:17]).max() < A_TENTH_NT
    d_inclination = (horizontal * dz - z * d_horizontal) / total**2
    d_declination = (x * dy - y * dx) / horizontal**2
    computed = np.degrees(np.column_stack([d_inclination, d_declination]))
    assert np.abs(computed - rows[:, 17:19]).max() < A_HUNDREDTH_DEG
