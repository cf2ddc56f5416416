"""ROS34PW2: its conditions of order with any matrix, its stability, and its order as measured on a stiff oscillator."""

from math import log2

import numpy as np
import pytest

from fieldline.integrate.rosenbrock import ALPHA, LOWER, ROS34PW2, SECOND_WEIGHTS, WEIGHTS, amplification, stage_error, sum_stages

ROUNDING = 1e-15


def conditions(weights):
    """What must vanish for order 1, 2 and 3 with any matrix (Hairer and Wanner 1996, s. IV.7, for W-methods)."""
    b, alpha, lower = np.array(weights), np.array(ALPHA), np.array(LOWER)
    c, g = alpha.sum(axis=1), lower.sum(axis=1)
    second = [b.sum() - 1.0, b @ c - 1.0 / 2.0, b @ g]
    third = [b @ c**2 - 1.0 / 3.0, b @ alpha @ c - 1.0 / 6.0, b @ alpha @ g, b @ lower @ c, b @ lower @ g]
    return np.abs(second).max(), np.abs(third).max()


def test_the_weights_have_order_three_with_any_matrix():
    assert max(conditions(WEIGHTS)) < ROUNDING


def test_the_second_weights_have_order_two_with_any_matrix_and_no_more():
    second, third = conditions(SECOND_WEIGHTS)
    assert second < ROUNDING
    assert third > 0.05


def test_the_last_stage_is_the_end_of_the_step():
    np.testing.assert_allclose(np.add(ALPHA, LOWER)[-1], WEIGHTS, rtol=0.0, atol=ROUNDING)
    assert ROS34PW2.nodes[-1] == pytest.approx(1.0, abs=ROUNDING)


def test_it_is_l_stable():
    on_the_axis = np.abs(amplification(1j * np.logspace(-3, 6, 400)))
    assert on_the_axis.max() <= 1.0 + 1e-12
    assert abs(amplification(-1e12)) < 1e-10
    assert abs(amplification(0.1) - np.exp(0.1)) < 5e-6


@pytest.mark.kernels
@pytest.mark.parametrize("share", [1.0, 0.0, 0.6], ids=["its Jacobian", "no matrix", "another matrix"])
def test_order_three_is_measured(share):
    """y' = -s (y - cos t) + y^2 / 4, s = 3, with some share of its Jacobian for A."""

    def rate(t, y):
        return -3.0 * (y - np.cos(t)) + 0.25 * y * y

    def flown(h):
        t, y = 0.0, np.array([0.3])
        stages, stage = np.zeros((4, 1)), np.zeros(1)
        for _ in range(round(2.0 / h)):
            matrix = share * (-3.0 + 0.5 * y[0])
            for i in range(4):
                sum_stages(y, stages, ROS34PW2.a[i], i, stage)
                right = rate(t + ROS34PW2.nodes[i] * h, stage) + ROS34PW2.c[i] @ stages / h
                stages[i] = right / (1.0 / (h * ROS34PW2.gamma) - matrix)
            sum_stages(y, stages, ROS34PW2.m, 4, stage)
            y, t = stage.copy(), t + h
        return y[0], stage_error(stages, ROS34PW2.error, np.array([1e-3]))

    truth = flown(1.0 / 2048.0)[0]
    errors = [flown(h) for h in (1.0 / 32.0, 1.0 / 64.0)]
    assert log2(abs(errors[0][0] - truth) / abs(errors[1][0] - truth)) == pytest.approx(3.0, abs=0.25)
    assert log2(errors[0][1] / errors[1][1]) == pytest.approx(3.0, abs=0.35)
