"""2,000 values of the IGRF-14 synthesis program (source and licence: data/NOTICE.md).

The program's Fortran literals, coefficients and inputs are single precision (6371.2 km becomes 6371.2002 km, the year
2017.3 becomes 2017.3000488), its sums double. Given the same literals our synthesis agrees with every row to the last
printed digit; given the true numbers, as a user gives them, it differs by what the literals are worth.
"""

import numpy as np
import pytest

from fieldline.environment import field_model, magnetic_field
from fieldline.environment.coefficients import igrf14
from fieldline.environment.harmonics import basis_for, field_table, synthesis_kernel

pytestmark = [pytest.mark.kernels]

LAST_DIGIT_NT = 0.5e-5 + 1e-9  # the table prints 1e-5 nT; the rest is for rounding in our own sums
SINGLE_PRECISION_NT = 0.015  # 6e-8 of the field times degree + 2, and of the year times the secular variation


def single(value):
    """The value that a single-precision literal holds."""
    return np.asarray(value, dtype=np.float32).astype(float)


def spherical(radius, colatitude, longitude):
    """Cartesian positions, and latitudes."""
    sine = np.sin(colatitude)
    return np.stack([radius * sine * np.cos(longitude), radius * sine * np.sin(longitude), radius * np.cos(colatitude)], axis=-1)


def coefficients_like_the_program(year):
    """g, h [nT] with its time arithmetic: interpolation in units of five years, then a rate with two decimals."""
    model = igrf14()
    g, h = single(model.g * 1e9), single(model.h * 1e9)
    if year >= 2025.0:
        rates = (single(np.round((c[26] - c[25]) * 1e9 / 5.0, 2)) for c in (model.g, model.h))
        return [c[25] + (year - 2025.0) * rate for c, rate in zip((g, h), rates, strict=True)]
    lustres = single(0.2) * (year - 1900.0)
    k = int(lustres)
    part = lustres - k
    return [(1.0 - part) * c[k] + part * c[k + 1] for c in (g, h)]


def test_every_row_to_its_last_digit_with_the_programs_literals(table, local_axes):
    rows = table("igrf14_geocentric.txt")
    assert rows.shape == (2000, 8)
    year, radius_km = single(rows[:, 0]), single(rows[:, 1])
    colatitude, longitude = single(rows[:, 2:4]).T * single(0.017453292)
    position = spherical(radius_km * 1e3, colatitude, longitude)
    basis = basis_for(14, 14, float(single(6371.2)) * 1e3)
    field_e = np.array(
        [
            synthesis_kernel(tuple(r), basis, field_table(*coefficients_like_the_program(y), 13))
            for r, y in zip(position, year, strict=True)
        ]
    )
    local = np.einsum("nij,nj->ni", local_axes(np.pi / 2 - colatitude, longitude), field_e)
    computed = np.column_stack([local, np.linalg.norm(field_e, axis=1)])
    assert np.abs(computed - rows[:, 4:]).max() < LAST_DIGIT_NT


def test_every_row_with_true_numbers(table, local_axes, utc_of_year):
    rows = table("igrf14_geocentric.txt")
    colatitude, longitude = np.radians(rows[:, 2:4]).T
    position = spherical(rows[:, 1] * 1e3, colatitude, longitude)
    # The program carries the secular variation on past 2030; we do so only when asked.
    field_e = magnetic_field(position, utc_of_year(rows[:, 0]), field_model("IGRF-14", until_year=2035.0)) * 1e9
    local = np.einsum("nij,nj->ni", local_axes(np.pi / 2 - colatitude, longitude), field_e)
    computed = np.column_stack([local, np.linalg.norm(field_e, axis=1)])
    assert np.abs(computed - rows[:, 4:]).max() < SINGLE_PRECISION_NT
