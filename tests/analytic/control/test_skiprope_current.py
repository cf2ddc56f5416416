"""The half wave's model and the current against it."""

import numpy as np
import pytest

from fieldline.control.skiprope_current import HalfWave, damping_current, half_wave_of, push_per_ampere
from fieldline.control.skiprope_yaw import YawPlan, yaw_by

W = 2.0 * np.pi * 0.005


def wave():
    return HalfWave(0.0, W, np.array([6.0, 0.0]), np.array([0.0, 6.0 * W]))


def test_a_free_wave_goes_round_and_a_push_moves_its_middle():
    free, pushed = wave(), wave()
    for t in np.arange(3.0, 100.1, 3.0):
        free.carried(t, np.zeros(2))
    at = free.seconds
    assert free.place_m == pytest.approx(6.0 * np.array([np.cos(W * at), np.sin(W * at)])) and free.amplitude_m == pytest.approx(
        6
    )
    push = np.array([1e-3, -2e-3])
    pushed.carried(37.0, push)
    pushed.carried(37.0 + 2.0 * np.pi / W, push)
    once = wave()
    once.carried(37.0, push)
    assert pushed.place_m == pytest.approx(once.place_m)  # a period on


def test_the_push_is_across_the_vertical_and_the_field():
    r, v, b = np.array([6.7e6, 0.0, 0.0]), np.array([0.0, 7.7e3, 0.0]), np.array([1e-5, 0.0, 3e-5])
    push = push_per_ampere(r, v, b, 8e-3)  # up x B = (0, -3e-5, 0): against the velocity
    assert push == pytest.approx([-4.0 / np.pi * 3e-5 / 8e-3, 0.0])


def test_the_current_takes_out_what_the_push_can_reach():
    one, push, most = wave(), np.array([1e-3, 0.0]), []
    for t in np.arange(1.0, 1500.0):
        current = damping_current(one, push, 0.01, 0.5)
        before = one.amplitude_m
        one.carried(t, current * push)
        most.append(abs(current))
        assert one.amplitude_m < before * (1.0 + 1e-3)
    assert max(most) == pytest.approx(0.5)
    u = np.hypot(one.place_m[0], one.speed_m_s[0] / W)
    v = np.hypot(one.place_m[1], one.speed_m_s[1] / W)
    assert u < 0.1 and v == pytest.approx(6.0)
    assert damping_current(one, np.zeros(2), 0.01, 0.5) == 0.0


def test_a_wave_is_read_from_the_last_turn():
    t = np.arange(0.0, 900.0, 10.0)
    places = np.stack([5.0 * np.cos(W * t + 0.3), 2.0 * np.sin(W * t)], axis=-1)
    places[:20] = 99.0
    found = half_wave_of(t, places, W)
    assert found.place_m == pytest.approx(places[-1]) and found.seconds == t[-1]
    assert found.speed_m_s == pytest.approx(W * np.array([-5.0 * np.sin(W * t[-1] + 0.3), 2.0 * np.cos(W * t[-1])]))


def test_the_ramps_lie_about_start_and_stop():
    plan = YawPlan(100.0, 500.0, -0.03, 12.0, 0.4, 0.0, 0.0)
    times = np.arange(0.0, 700.0, 0.5)
    angle, rate, acceleration = np.array([yaw_by(plan, t, 40.0) for t in times]).T
    assert angle[0] == 0.0 and angle[-1] == pytest.approx(-12.0) and rate[-1] == 0.0
    held = (times > 121.0) & (times < 479.0)
    assert angle[held] == pytest.approx(-0.03 * (times[held] - 100.0)) and (rate[held] == -0.03).all()
    assert np.gradient(angle, times)[1:-1] == pytest.approx(rate[1:-1], abs=2e-4)
    assert np.abs(acceleration).max() == pytest.approx(0.03 / 40.0)
