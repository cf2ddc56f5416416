"""Spherical harmonics where their sums are known otherwise: poles, axis, zonal fields, time, truncation."""

import numpy as np
import pytest

from fieldline.environment import field_gradient, field_model, field_rate, magnetic_field
from fieldline.environment.coefficients import igrf14
from fieldline.environment.field import field_kernel
from fieldline.environment.harmonics import basis_for, field_table, gradient_kernel, gradient_table, synthesis_kernel

pytestmark = pytest.mark.kernels

A = 6371200.0
EPOCH = np.datetime64("2020-01-01")
YEAR_S = 365 * 86400.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_on_the_axis_only_zonal_terms_stand_along_it(sign):
    c = igrf14()
    g = c.g[int(np.flatnonzero(c.epochs == 2020.0)[0])]
    r = 6.9e6
    n = np.arange(1, 14)
    # S_n0 = (+-1)^n on the axis: the radial field is the sum of (n+1) (a/r)^(n+2) g_n0 (+-1)^n.
    radial = np.sum((n + 1) * (A / r) ** (n + 2) * g[1:, 0] * sign**n)
    field = magnetic_field((0.0, 0.0, sign * r), EPOCH)
    assert np.isclose(field[2], sign * radial, rtol=1e-13)
    # Across it only order 1 stays: dS_n1/dtheta = sqrt(n (n+1) / 2) there.
    across = np.sum((A / r) ** (n + 2) * np.sqrt(n * (n + 1) / 2.0) * sign ** (n + 1) * g[1:, 1])
    assert np.isclose(field[0], -across, rtol=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_nothing_happens_at_the_poles(sign):
    pole = np.array([0.0, 0.0, sign * 6.8e6])
    field, gradient = magnetic_field(pole, EPOCH), field_gradient(pole, EPOCH)
    assert np.isfinite(field).all() and np.isfinite(gradient).all()
    for step in 10.0 * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0.6, -0.8, 0]]):
        beside = magnetic_field(pole + step, EPOCH)
        second_order = 1e-15  # T: (10 m)^2 times the curvature of the field, 6 B / r^2
        assert np.abs(beside - field - gradient @ step).max() < second_order


@pytest.mark.parametrize(("n", "m"), [(1, 0), (2, 1), (3, 3), (7, 2), (13, 0), (13, 13)])
def test_each_harmonic_against_scipys_legendre_functions(n, m):
    from scipy.special import assoc_legendre_p

    g, h = np.zeros((14, 14)), np.zeros((14, 14))
    g[n, m], h[n, m] = 3.0, -2.0 if m else 0.0
    r, theta, phi = 7.1e6, 0.83, -2.1
    # Schmidt's norm without the phase (-1)^m that SciPy carries; B_r = (n+1) (a/r)^(n+2) S (g cos + h sin).
    factorials = np.prod(np.arange(n - m + 1.0, n + m + 1.0)) if m else 1.0
    schmidt = (-1) ** m * np.sqrt((2.0 if m else 1.0) / factorials) * float(assoc_legendre_p(n, m, np.cos(theta))[0])
    radial = (n + 1) * (A / r) ** (n + 2) * schmidt * (g[n, m] * np.cos(m * phi) + h[n, m] * np.sin(m * phi))
    up = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    field = synthesis_kernel(tuple(r * up), basis_for(14, 14, A), field_table(g, h, 13))
    assert np.isclose(np.dot(field, up), radial, rtol=1e-12)


def test_high_degree_stays_accurate():
    # On the axis the radial field of g_n0 = 1 is the sum over n again: no overflow, no loss at degree 150.
    g, h = np.zeros((151, 151)), np.zeros((151, 151))
    g[:, 0] = 1.0
    r = 1.2 * A
    n = np.arange(151)
    field = synthesis_kernel((0.0, 0.0, r), basis_for(151, 1, A), field_table(g, h, 0))
    assert np.isclose(field[2], np.sum((n + 1) * (A / r) ** (n + 2)), rtol=1e-12)
    gradient = gradient_kernel((0.0, 0.0, r), basis_for(152, 2, A), gradient_table(g, h, 0, A))
    assert np.isclose(gradient[8], -np.sum((n + 1) * (n + 2) * (A / r) ** (n + 3)) / A, rtol=1e-12)


def test_degree_and_order_cut_the_sum():
    place = np.array([4.0e6, 3.0e6, -4.5e6])
    whole = magnetic_field(place, EPOCH)
    assert np.array_equal(magnetic_field(place, EPOCH, degree=13), whole)
    assert np.array_equal(magnetic_field(place, EPOCH, degree=13, order=13), whole)
    steps = [np.linalg.norm(magnetic_field(place, EPOCH, degree=n) - whole) for n in (1, 4, 8, 12)]
    assert steps == sorted(steps, reverse=True)
    assert 0.0 < steps[-1] < 20e-9
    g8, h8 = (c.copy() for c in (igrf14().g[24], igrf14().h[24]))
    for c in (g8, h8):
        c[9:] = 0.0
        c[:, 4:] = 0.0
    by_hand = synthesis_kernel(tuple(place), basis_for(14, 14, A), field_table(g8, h8, 13))
    assert np.allclose(magnetic_field(place, EPOCH, degree=8, order=3), by_hand, rtol=1e-13)


def test_order_zero_has_the_symmetry_of_the_axis():
    turn = 1.234
    place = np.array([4.0e6, 3.0e6, -4.5e6])
    rotation = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    turned = magnetic_field(rotation @ place, EPOCH, order=0)
    assert np.allclose(turned, rotation @ magnetic_field(place, EPOCH, order=0), rtol=1e-13)


def test_time_is_linear_between_epochs_and_bends_there():
    place = (5.0e6, 1.0e6, 5.0e6)
    start, middle, end = (magnetic_field(place, np.datetime64(t)) for t in ("2000-01-01", "2002-07-02T12", "2005-01-01"))
    assert np.allclose(middle, 0.5 * (start + end), rtol=1e-12)  # 2002.5
    before, after = (field_rate(place, np.datetime64(t)) for t in ("2004-12-31", "2005-01-01"))
    assert np.abs(before - after).max() > 1e-18  # T/s
    assert np.allclose(after * YEAR_S * 5.0, magnetic_field(place, np.datetime64("2010-01-01")) - end, rtol=1e-9)


def test_a_series_equals_its_single_calls():
    random = np.random.default_rng(3)
    place = random.normal(size=(40, 3))
    place *= 7e6 / np.linalg.norm(place, axis=1, keepdims=True)
    time = np.datetime64("1990-01-01") + random.integers(0, 14000, 40) * np.timedelta64(1, "D")
    for function in (magnetic_field, field_gradient, field_rate):
        one_by_one = [function(p, t) for p, t in zip(place, time, strict=True)]
        assert np.array_equal(function(place, time), one_by_one)
        assert np.array_equal(
            function(place.reshape(8, 5, 3), time.reshape(8, 5)), np.reshape(one_by_one, (8, 5, *one_by_one[0].shape))
        )
        assert np.array_equal(function(place, time[7]), [function(p, time[7]) for p in place])
        assert np.array_equal(function(place[3], time), [function(place[3], t) for t in time])
    assert magnetic_field(np.zeros((0, 3)), EPOCH).shape == (0, 3)
    assert magnetic_field(np.zeros((0, 3)), np.array([], dtype="M8[ns]")).shape == (0, 3)


@pytest.mark.parametrize("model", [field_model("IGRF-14"), field_model("centred-dipole", moment_e=(0, 1e22, -7e22))])
def test_a_model_frozen_in_time_serves_compiled_loops(model):
    place, time = (5.0e6, 1.0e6, 5.0e6), np.datetime64("2023-08-24T15:00")
    assert np.allclose(field_kernel(place, model.at(time)), magnetic_field(place, time, model), rtol=1e-14)


def test_leap_years_pass_more_slowly():
    place = (7e6, 0.0, 0.0)
    ordinary, leap = field_rate(place, np.array(["2021-06-01", "2024-06-01"], dtype="M8[D]"))
    assert np.allclose(ordinary / leap, 366.0 / 365.0, rtol=1e-9)
