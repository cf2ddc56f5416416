"""Derivatives from samples: exact where they must be, and as wrong as they say where they may be."""

import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.estimation.natanson.derivatives import (
    best_cutoff_rad_s,
    best_step_samples,
    best_window_s,
    difference_error,
    finite_differences,
    local_polynomial,
    polynomial_error,
    smoothing_spline,
    spline_error,
)

INTERVAL, COUNT = 8.0, 1500
TURN, MAGNITUDE, NOISE = 2.5e-3, 3e-5, 1.86e-7
SECONDS = INTERVAL * np.arange(COUNT)


def wave(turn=TURN):
    """(value, first, second) of a field that turns at a steady rate."""
    phase = turn * SECONDS[:, None] + np.array([0.0, 2.0, 4.0])
    return MAGNITUDE * np.sin(phase), MAGNITUDE * turn * np.cos(phase), -MAGNITUDE * turn**2 * np.sin(phase)


METHODS = {
    "three points": (
        lambda y: finite_differences(SECONDS, y, step_samples=15),
        lambda s, m: difference_error(120.0, s, m, TURN),
    ),
    "five points": (
        lambda y: finite_differences(SECONDS, y, step_samples=15, points=5),
        lambda s, m: difference_error(120.0, s, m, TURN, 5),
    ),
    "polynomial": (
        lambda y: local_polynomial(SECONDS, y, window_s=960.0),
        lambda s, m: polynomial_error(960.0, INTERVAL, s, m, TURN),
    ),
    "spline": (
        lambda y: smoothing_spline(SECONDS, y, cutoff_rad_s=0.006),
        lambda s, m: spline_error(0.006, INTERVAL, s, m, TURN),
    ),
}


@pytest.mark.parametrize("name", METHODS)
def test_noise_is_as_foretold(name):
    derive, foretell = METHODS[name]
    noise = NOISE * np.random.default_rng(1).standard_normal((COUNT, 3))
    found, expected = derive(noise), foretell(NOISE, 0.0)
    for k, values in enumerate((found.first, found.second)):
        assert np.nanstd(values) == pytest.approx(expected.noise[k], rel=0.15)  # 4500 values, correlated over a window


@pytest.mark.parametrize("name", METHODS)
def test_bias_is_as_foretold(name):
    derive, foretell = METHODS[name]
    value, first, second = wave()
    found, expected = derive(value), foretell(0.0, MAGNITUDE)
    inside = slice(200, -200)  # the ends of a spline reach 8 / w_c in
    for k, (given, true) in enumerate(((found.first, first), (found.second, second))):
        worst = np.nanmax(np.abs(given - true)[inside])
        assert worst == pytest.approx(expected.bias[k], rel=0.35)  # the leading term alone: at 960 s the next is a third


@pytest.mark.parametrize("points, degree", [(3, 2), (5, 4)])
def test_differences_are_exact_for_polynomials(points, degree):
    times = 2.0 * np.arange(30)
    powers = np.array([3.0, -0.5, 0.02, 1e-3, -2e-5])[: degree + 1]
    field = np.tile(np.polynomial.Polynomial(powers)(times)[:, None], 3)
    found = finite_differences(times, field, step_samples=2, points=points)
    inside = np.isfinite(found.second[:, 0])
    assert inside.sum() == 30 - 2 * 2 * (points // 2)
    assert found.first[inside, 0] == pytest.approx(np.polynomial.Polynomial(powers).deriv()(times[inside]), abs=1e-11)
    assert found.second[inside, 1] == pytest.approx(np.polynomial.Polynomial(powers).deriv(2)(times[inside]), abs=1e-11)


def test_polynomial_allows_for_gaps():
    value, _, second = wave()
    keep = np.random.default_rng(2).random(COUNT) > 0.1
    keep[700:760] = False
    found = local_polynomial(SECONDS[keep], value[keep], window_s=480.0)
    known = np.isfinite(found.second).all(axis=1)
    whole = local_polynomial(SECONDS, value, window_s=480.0)
    assert 0.7 * keep.sum() < known.sum() < keep.sum()
    bias = np.nanmax(np.abs(whole.second - second))
    assert np.abs(found.second[known] - second[keep][known]).max() < 3.0 * bias  # lopsided samples let the odd powers in
    times = SECONDS[keep]
    assert not known[(times > SECONDS[670]) & (times < SECONDS[790])].any()


def test_polynomial_at_chosen_samples_is_the_same():
    value, _, _ = wave()
    keep = np.random.default_rng(2).random(COUNT) > 0.1
    at = np.array([0, 40, 700, 1100])
    for times, field in ((SECONDS, value), (SECONDS[keep], value[keep])):
        whole = local_polynomial(times, field, window_s=480.0)
        some = local_polynomial(times, field, window_s=480.0, at=at)
        for all_rows, rows in zip(whole, some, strict=True):
            assert np.isnan(rows[0]).all()
            assert rows[1:] == pytest.approx(all_rows[at[1:]], rel=1e-9, abs=1e-20)


def test_spline_keeps_a_quadratic():
    """What the third derivative's penalty does not see it must return exactly."""
    field = np.tile((1e-5 + 2e-9 * SECONDS - 3e-13 * SECONDS**2)[:, None], 3)
    found = smoothing_spline(SECONDS, field, cutoff_rad_s=0.004)
    inside = np.isfinite(found.second[:, 0])
    assert found.second[inside, 0] == pytest.approx(-6e-13, rel=1e-6)
    assert inside.sum() > COUNT - 2 * 3.0 / 0.004 / INTERVAL - 3


def test_best_step_and_window_balance_noise_and_bias():
    for finder, error, scale in (
        (best_step_samples, lambda x: difference_error(x * INTERVAL, NOISE, MAGNITUDE, TURN).total[1], 1),
        (best_window_s, lambda x: polynomial_error(x, INTERVAL, NOISE, MAGNITUDE, TURN).total[1], 16.0),
        (best_cutoff_rad_s, lambda x: spline_error(x, INTERVAL, NOISE, MAGNITUDE, TURN).total[1], None),
    ):
        best = finder(INTERVAL, NOISE, MAGNITUDE, TURN)
        step = 0.1 * best if scale is None else max(scale, 0.1 * best // scale * scale)
        assert error(best) <= 1.001 * min(error(best - step), error(best + step))


def test_best_step_of_three_points_is_the_closed_form():
    """d/dh of 6 s^2/h^4 + (M w^4 h^2/12)^2 = 0 gives h^8 = 6 * 144 s^2 / (M^2 w^8), to half a sample."""
    closed = (6.0 * 144.0 * NOISE**2 / (MAGNITUDE**2 * TURN**8)) ** 0.125
    assert best_step_samples(INTERVAL, NOISE, MAGNITUDE, TURN) == pytest.approx(closed / INTERVAL, abs=0.6)


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda: finite_differences([0, 1, 2, 4.0], np.zeros((4, 3))), "equally spaced"),
        (lambda: finite_differences([0, 1, 2.0], np.zeros((3, 3)), points=4), "3 or 5"),
        (lambda: finite_differences([0, 1, 2.0], np.zeros((3, 3)), step_samples=0), "whole number"),
        (lambda: finite_differences([0, 1, 2.0], np.zeros((2, 3))), "Did you pass"),
        (lambda: finite_differences([0, 1.0], np.zeros((2, 3))), "three samples"),
        (lambda: finite_differences([0, 1, 1.0], np.zeros((3, 3))), "must rise"),
        (lambda: local_polynomial(SECONDS, np.zeros((COUNT, 3)), window_s=20.0), "lengthen window_s"),
        (lambda: smoothing_spline(SECONDS[:9], np.zeros((9, 3)), cutoff_rad_s=0.01), "raise cutoff"),
    ],
)
def test_bad_requests_are_refused_in_words(call, words):
    with pytest.raises(InputError, match=words):
        call()
