"""A planned yaw against the forced string, mode by mode, stepped finely."""

import numpy as np
import pytest

from fieldline.control.skiprope_yaw import SkipropeNow, arm_azimuth, left_after, plan_yaw
from fieldline.errors import InputError

ARM_M, HZ = 1.5, 0.005
W = 2.0 * np.pi * HZ


def now(**more):
    usual = {
        "seconds": 100.0, "deflection_m": 12.0, "deflection_std_m": 0.1, "azimuth_rad": 0.7, "azimuth_std_rad": 0.03,
        "frequency_hz": HZ, "frequency_std_hz": 1e-6, "sense": 1,
    }  # fmt: skip
    return SkipropeNow(**(usual | more))


def string(plan, start, true_hz, stop_s, modes=3, step_s=0.25):
    """Amplitude [m] of the first half wave at stop_s: q_n'' + w_n^2 q_n = -(2 / n pi) y'' of the arm's end, exactly stepped."""
    times = np.arange(start.seconds, stop_s, step_s)
    end = ARM_M * np.exp(1j * arm_azimuth(plan, times))
    q = start.deflection_m * np.exp(1j * start.azimuth_rad)
    v = 1j * start.sense * 2.0 * np.pi * true_hz * q
    w = 2.0 * np.pi * true_hz
    c, s = np.cos(w * step_s), np.sin(w * step_s)
    pushed = -(2.0 / np.pi) * np.gradient(np.gradient(end, step_s), step_s)
    for push in pushed:
        away = q - push / w**2
        q, v = push / w**2 + c * away + s * v / w, -w * s * away + c * v
    return abs(complex(0.5 * (q + v / (1j * start.sense * w))))  # the part that turns with the skiprope


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("azimuth", [-2.0, 0.0, 1.0, 3.0])
@pytest.mark.parametrize("deflection", [3.0, 12.0, 40.0])
def test_the_skiprope_is_taken_out(sense, azimuth, deflection):
    start = now(sense=sense, azimuth_rad=azimuth, deflection_m=deflection)
    plan = plan_yaw(start, arm_m=ARM_M, arm_azimuth_rad=0.4, not_before_s=400.0)
    assert 400.0 <= plan.start_s < 400.0 + 1.0 / HZ and np.sign(plan.rate_rad_s) == sense
    assert plan.stop_s - plan.start_s == pytest.approx(deflection / (2.0 * ARM_M) / HZ)  # two arms a turn
    assert string(plan, start, HZ, plan.stop_s) < 0.03 * deflection + 0.6  # start and stop of the yaw kick the string
    half = 0.5 * (plan.start_s + plan.stop_s)
    assert string(plan, start, HZ, half) == pytest.approx(0.5 * deflection, abs=0.7)


@pytest.mark.parametrize("off_deg", [5.0, 20.0, 60.0, 180.0])
def test_an_arm_that_stands_wrong_leaves_what_the_formula_says(off_deg):
    off = np.radians(off_deg)
    start = now(deflection_m=20.0)
    plan = plan_yaw(start, arm_m=ARM_M, arm_azimuth_rad=0.4, not_before_s=300.0)
    believed = start._replace(azimuth_rad=start.azimuth_rad - off)  # the arm leads the truth by off
    expected = left_after(20.0, ARM_M, W, plan.stop_s - plan.start_s, off)
    assert string(plan, believed, HZ, plan.stop_s) == pytest.approx(expected, abs=0.8)


def test_what_is_expected_grows_with_the_doubt():
    sure, doubtful, drifting = (
        plan_yaw(one, arm_m=ARM_M, arm_azimuth_rad=0.0, not_before_s=200.0).expected_m
        for one in (now(), now(azimuth_std_rad=0.2), now(frequency_std_hz=5e-5))
    )
    assert sure < doubtful and sure < drifting
    assert doubtful == pytest.approx(12.0 * np.sin(0.2), rel=0.1)


def test_a_yaw_needs_a_sense_and_an_arm():
    with pytest.raises(InputError, match="sense"):
        plan_yaw(now(sense=0), arm_m=1.0, arm_azimuth_rad=0.0, not_before_s=0.0)
    with pytest.raises(InputError, match="arm_m"):
        plan_yaw(now(), arm_m=0.0, arm_azimuth_rad=0.0, not_before_s=0.0)
