"""Crossings within a step: always found, never with more evaluations than were promised."""

from math import exp, tanh

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fieldline.integrate.roots import bracketed, evaluations, narrow, next_guess

pytestmark = pytest.mark.kernels

SHAPES = {
    "straight": lambda x, r: x - r,
    "kinked": lambda x, r: (x - r) * (1e3 if x > r else 1.0),
    "jump": lambda x, r: 1.0 if x >= r else -1.0,
    "flat": lambda x, r: (x - r) ** 9,
    "steep": lambda x, r: tanh(200.0 * (x - r)),
    "exponential": lambda x, r: exp(30.0 * x) - exp(30.0 * r),
    "falling": lambda x, r: r - x,
}


def find(f, a, b, tolerance):
    """(a, b, evaluations used) of the closed bracket."""
    fa, fb = f(a), f(b)
    left = promised = evaluations(b - a, tolerance)
    while b - a > tolerance and left > 0:
        x = next_guess(a, fa, b, fb, left, tolerance)
        assert a <= x <= b
        a, fa, b, fb = narrow(a, fa, b, fb, x, f(x))
        left -= 1
    return a, b, promised - left


@settings(max_examples=150, deadline=None)
@given(
    shape=st.sampled_from(sorted(SHAPES)),
    root=st.floats(0.01, 0.99),
    tolerance=st.sampled_from([1e-3, 1e-6, 1e-10]),
)
def test_a_crossing_is_found_within_the_promised_evaluations(shape, root, tolerance):
    def f(x):
        return SHAPES[shape](x, root)

    a, b, _ = find(f, 0.0, 1.0, tolerance)
    assert b - a <= tolerance * (1 + 1e-5)
    assert a <= root <= b or f(b) == 0.0
    assert f(b) == 0.0 or (f(b) > 0.0) == (f(1.0) > 0.0)  # b is past the crossing


def test_a_smooth_crossing_takes_far_fewer_evaluations_than_bisection():
    used = find(lambda x: np.cos(x) - 0.8, 0.0, 1.0, 1e-12)[2]
    assert used <= 12  # bisection: 40


@pytest.mark.parametrize(
    ("fa", "fb", "upwards", "downwards"),
    [
        (-1.0, 1.0, True, False),
        (1.0, -1.0, False, True),
        (-1.0, 0.0, True, False),
        (0.0, 1.0, False, False),
        (0.0, -1.0, False, False),
        (1.0, 2.0, False, False),
        (float("nan"), 1.0, False, False),
        (-1.0, float("nan"), False, False),
    ],
)
def test_arriving_at_zero_is_a_crossing_and_leaving_is_none(fa, fb, upwards, downwards):
    assert bracketed(fa, fb, 1) is upwards
    assert bracketed(fa, fb, -1) is downwards
    assert bracketed(fa, fb, 0) is (upwards or downwards)


def test_no_evaluation_is_needed_for_a_bracket_that_is_narrow_enough():
    assert evaluations(1e-3, 1e-3) == 0
    assert evaluations(1.0, 0.25) == 3
