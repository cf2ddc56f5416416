"""B-dot: gain, derivative, filter, missing readings, handover."""

import numpy as np
import pytest

from fieldline.control import LAWS
from fieldline.control.b_dot import b_dot_gain
from law_tests import CONTEXT, FLIGHT, called, known_measurement
from tiny_flight import TinyFlight

kernels = pytest.mark.kernels  # flights of hours stay out: they are slow without compilation
B_DOT, BANG_BANG = LAWS["b-dot"], LAWS["b-dot-bang-bang"]
FIRST, SECOND = (2e-5, 0.0, 1e-5), (2e-5, 4e-6, 0.8e-5)


def readings(law, params, *samples):
    """Commands for a list of (call time, field or None, reading time)."""
    memory, commands = np.zeros(law.memory), []
    for t, field, read_at in samples:
        measurement = known_measurement(time_s=read_at)
        if field is None:
            measurement.valid[0] = 0.0
        else:
            measurement.field_b[:] = field
        commands.append(law.kernel(t, measurement, memory, params))
    return np.array(commands)


@kernels
def test_gain_follows_the_published_rule():
    assert b_dot_gain(1.1e-3, np.pi / 2, np.diag([0.03, 0.04, 0.01])) == pytest.approx(2 * 1.1e-3 * 2.0 * 0.01)
    params = B_DOT.pack({}, CONTEXT)
    assert params[0] == pytest.approx(2 * FLIGHT.mean_motion * (1 + np.sin(FLIGHT.inclination)) * 2.0)


@kernels
def test_moment_is_against_the_difference():
    params = B_DOT.pack({"gain_n_m_s": 1e-3}, CONTEXT)
    first, second = readings(B_DOT, params, (0.0, FIRST, 0.0), (2.0, SECOND, 2.0))
    change = (np.array(SECOND) - FIRST) / 2.0
    assert not first.any()
    assert np.allclose(second, -1e-3 / np.dot(SECOND, SECOND) * change, rtol=1e-14)  # (20)


@kernels
def test_bang_bang_takes_the_signs_outside_the_dead_band():
    params = BANG_BANG.pack({"moment_a_m2": (0.2, 0.3, 0.4), "dead_band_tesla_s": 1e-9}, CONTEXT)
    command = readings(BANG_BANG, params, (0.0, FIRST, 0.0), (2.0, SECOND, 2.0))[1]
    assert command.tolist() == [0.0, -0.3, 0.4]  # (21)


@kernels
def test_low_pass_settles_on_a_steady_slope():
    params = B_DOT.pack({"gain_n_m_s": 1.0, "low_pass_s": 5.0}, CONTEXT)
    ramp = [(float(k), (2e-5, 1e-7 * k + (2e-8 if k % 2 else 0.0), 0.0), float(k)) for k in range(80)]
    raw = readings(B_DOT, B_DOT.pack({"gain_n_m_s": 1.0}, CONTEXT), *ramp)[-10:, 1]
    smooth = readings(B_DOT, params, *ramp)[-10:, 1]
    assert np.ptp(smooth) < 0.2 * np.ptp(raw)
    assert smooth.mean() == pytest.approx(raw.mean(), rel=0.05)


@kernels
def test_between_readings_the_command_stands():
    # The torquers work while the magnetometer rests: calls at 1 s, readings at 4 s.
    params = B_DOT.pack({"gain_n_m_s": 1e-3}, CONTEXT)
    samples = [(0.0, FIRST, 0.0), (4.0, SECOND, 4.0), (5.0, SECOND, 4.0), (6.0, SECOND, 4.0), (100.0, SECOND, 4.0)]
    commands = readings(B_DOT, params, *samples)
    assert commands[1].any() and np.array_equal(commands[1], commands[2]) and np.array_equal(commands[1], commands[3])
    assert not commands[4].any()  # too old: what the body does now is not known


@kernels
@pytest.mark.parametrize("spoilt", [None, (np.nan, 0.0, 1e-5), (0.0, 0.0, 0.0), (np.inf, 0.0, 0.0)])
@pytest.mark.parametrize("law", [B_DOT, BANG_BANG], ids=lambda law: law.name)
def test_a_bad_reading_gives_no_moment_and_breaks_the_chain(law, spoilt):
    params = law.pack({}, CONTEXT)
    samples = ((0.0, FIRST, 0.0), (1.0, SECOND, 1.0), (2.0, spoilt, 2.0), (3.0, FIRST, 3.0), (4.0, SECOND, 4.0))
    commands = readings(law, params, *samples)
    assert [bool(c.any()) for c in commands] == [False, True, False, False, True]


@kernels
def test_a_long_gap_breaks_the_chain():
    params = B_DOT.pack({"gap_s": 3.0}, CONTEXT)
    commands = readings(B_DOT, params, (0.0, FIRST, 0.0), (5.0, SECOND, 5.0), (6.0, FIRST, 6.0))
    assert [bool(c.any()) for c in commands] == [False, False, True]


@kernels
def test_gyro_gives_the_torque_across_the_field():
    params = B_DOT.pack({"derivative": "gyro", "gain_n_m_s": 2e-3}, CONTEXT)
    omega, field = np.array([0.02, -0.01, 0.03]), np.array([2e-5, -1e-5, 1.5e-5])
    moment = called("b-dot", known_measurement(field, omega), params=params)
    across = omega - field * (omega @ field) / (field @ field)
    assert np.allclose(np.cross(moment, field), -2e-3 * across, rtol=1e-12)


@kernels
def test_gyro_that_is_not_valid_gives_no_moment():
    measurement = known_measurement(omega_b=(0.1, 0.0, 0.0))
    measurement.valid[1] = 0.0
    assert not called("b-dot", measurement, params=B_DOT.pack({"derivative": "gyro"}, CONTEXT)).any()


@kernels
def test_handover_with_hysteresis():
    params = B_DOT.pack({"rate_off_deg_s": 1.0, "rate_on_deg_s": 3.0}, CONTEXT)
    samples, angle = [], 0.0
    for k, rate_deg_s in enumerate([5.0] * 5 + [2.0] * 5 + [0.5] * 5 + [2.0] * 5 + [5.0] * 5):
        angle += np.radians(rate_deg_s)
        samples.append((float(k), (2e-5 * np.cos(angle), 2e-5 * np.sin(angle), 0.0), float(k)))
    works = [bool(c.any()) for c in readings(B_DOT, params, *samples)]
    assert works == [False] + [True] * 9 + [False] * 10 + [True] * 5


@pytest.mark.parametrize("name", ["b-dot", "b-dot-bang-bang"])
@pytest.mark.parametrize("duty", [1, 5])
def test_a_tumble_is_stopped(name, duty):
    flight = TinyFlight(inertia=(0.03, 0.035, 0.01), altitude_km=500.0, inclination_deg=97.0, moment_max=0.2, period_s=1.0)
    law = LAWS[name]

    def read_rarely(k, measurement):  # the reading of the last slot in which the torquers were off
        if k % duty:
            measurement.field_b[:], measurement.field_time_s[0] = kept
        else:
            kept[0], kept[1] = measurement.field_b.copy(), measurement.field_time_s[0]

    kept = [None, 0.0]
    table = {"gain_n_m_s": 4e-4} if name == "b-dot" else {"moment_a_m2": (0.02, 0.02, 0.02)}
    flown = flight.fly(law, law.pack(table, flight.context(1)), 2.0, omega=np.radians([5.0, -4.0, 6.0]), spoil=read_rarely)
    rate = np.degrees(np.linalg.norm(flown["omega"], axis=1))
    assert rate[0] > 8.0 and rate[-300:].max() < 0.7
