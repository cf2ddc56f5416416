"""Attitude on board against the truth of a small flight that shares no motion with it: found from nothing, held, lost, found."""

from types import SimpleNamespace

import numpy as np

from fieldline.estimation.onboard import OnboardEstimator
from fieldline.estimation.onboard.bias import MagnitudeBias
from fieldline.estimation.onboard.readings import Readings
from fieldline.frames.attitude import rotation_error_b
from fieldline.sensing.measurement import FIELD
from tiny_flight import TinyFlight

INERTIA = (0.036, 0.034, 0.0067)
CUBESAT = {
    "inertia": INERTIA,
    "inclination_deg": 80.0,
    "altitude_km": 500.0,
    "residual_dipole": (2e-3, -1e-3, 1.5e-3),
    "moment_max": 0.2,
    "period_s": 4.0,
    "noise": {"field": 50e-9},
}
START = {"q": (0.1, -0.5, 0.3, 0.8062257748298549), "omega": np.radians((0.25, -0.2, 0.15))}
BIAS = np.array([150e-9, -80e-9, 60e-9])


def flown(orbits, estimator, moment=lambda t: np.zeros(3), spoil=None, **more):
    """(t, error [deg], rate error [deg/s], told) at each call: `moment(t)` is what the torquers are told."""
    told = []

    def kernel(t, measurement, memory, params):
        measurement.field_b[:] += BIAS
        told.append(estimator(t, measurement))
        return moment(t)

    flight = TinyFlight(**{**CUBESAT, **more})
    truth = flight.fly(SimpleNamespace(kernel=kernel, memory=0, commands=("dipole",)), None, orbits, **START, spoil=spoil)
    known = np.array([answer is not None for answer in told])
    error, rate = np.full((2, len(told)), np.nan)
    answers = np.array([answer for answer in told if answer is not None]).reshape(-1, 7)
    error[known] = np.degrees(np.linalg.norm(rotation_error_b(truth["q"][known], answers[:, :4]), axis=-1))
    rate[known] = np.degrees(np.linalg.norm(truth["omega"][known] - answers[:, 4:], axis=1))
    return truth["t"], error, rate, known


def test_attitude_is_found_from_nothing_and_held():
    estimator = OnboardEstimator(np.diag(INERTIA))
    t, error, rate, known = flown(1.5, estimator)
    assert not known[t < 0.9 * 2400.0].any()
    assert known[t > 3000.0].all()
    late = t > 4500.0
    assert np.sqrt(np.mean(error[late] ** 2)) < 1.5 and error[late].max() < 4.0
    assert np.sqrt(np.mean(rate[late] ** 2)) < 0.01
    assert np.linalg.norm(estimator.bias_b - BIAS) < 60e-9


def test_commanded_dipole_is_part_of_the_motion():
    def moment(t):
        return 3e-3 * np.array([np.sin(t / 70.0), np.cos(t / 110.0), np.sin(t / 90.0)])

    _, error, _, known = flown(0.75, OnboardEstimator(np.diag(INERTIA)), moment)
    # told that the torquers act for a fifth of the time, the same readings fit no motion, or a wrong one
    _, blind, _, seen = flown(0.75, OnboardEstimator(np.diag(INERTIA), duty_cycle=0.2), moment)
    assert known[-100:].all() and error[-100:].max() < 4.0
    assert not seen.any() or np.nanmax(blind[-100:]) > 2.0 * error[-100:].max()


def test_what_no_longer_fits_is_given_up_and_found_again():
    turned = {"from": 3600.0}

    def spoil(k, measurement):
        # the sensor is taken off and mounted the other way round: what was known is wrong from one reading to the next
        if k * CUBESAT["period_s"] >= turned["from"]:
            measurement.field_b[:] = measurement.field_b[[0, 1, 2]] * np.array([1.0, -1.0, -1.0])

    estimator = OnboardEstimator(np.diag(INERTIA))
    t, _, _, known = flown(1.0, estimator, spoil=spoil)
    assert known[(t > 3000.0) & (t < 3600.0)].all()
    assert not known[t > 4500.0].all()
    words = [text for _, text in estimator.events]
    assert any(text.startswith("found") for text in words) and any(text.startswith("lost") for text in words)


def test_nothing_is_told_without_readings():
    def spoil(k, measurement):
        if k * CUBESAT["period_s"] > 3000.0:
            measurement.valid[FIELD] = 0.0

    estimator = OnboardEstimator(np.diag(INERTIA))
    t, _, _, known = flown(0.75, estimator, spoil=spoil)
    assert known[(t > 2600.0) & (t < 3000.0)].all()
    assert not known[t > 3000.0 + 700.0].any()


def test_bias_from_magnitudes():
    rng = np.random.default_rng(4)
    field = 3e-5 * (lambda v: v / np.linalg.norm(v, axis=1, keepdims=True))(rng.standard_normal((400, 3)))
    field *= rng.uniform(0.7, 1.3, (400, 1))
    found = MagnitudeBias(1e-6)
    for row in field:
        found.add(row + BIAS + 50e-9 * rng.standard_normal(3), row)
    bias, covariance = found.estimate()
    off = bias - BIAS
    assert np.linalg.norm(off) < 25e-9
    assert off @ np.linalg.solve(covariance, off) < 16.3  # 99.9 % of chi-square with three


def test_no_bias_is_claimed_along_what_was_not_shown():
    rng = np.random.default_rng(5)
    found = MagnitudeBias(1e-6)
    for _ in range(400):
        row = np.array([*(2e-5 * rng.standard_normal(2)), 0.0])
        found.add(row + BIAS, row)
    bias, covariance = found.estimate()
    assert np.abs(bias[:2] - BIAS[:2]).max() < 2e-9
    assert 0.9e-6 < np.sqrt(covariance[2, 2]) < 1.01e-6 and abs(bias[2]) < 1e-6


def test_rows_hold_the_dipole_until_the_next():
    readings = Readings(100.0, 10.0)
    for t in np.arange(0.0, 41.0, 2.0):
        readings.add(t, [1e-5, 2e-5, 3e-5], [3e-5, 0.0, 0.0], [7e6, 0.0, 0.0], [1.0 if t > 20.0 else 0.0, t, 0.0])
    series = readings.series(np.zeros(3))
    assert list(series.seconds) == [0.0, 10.0, 20.0, 30.0, 40.0]
    assert np.allclose(series.moment_b[:4, 0], [0.0, 0.0, 1.0, 1.0])
    assert np.allclose(series.moment_b[0, 1], np.mean([2.0, 4.0, 6.0, 8.0, 10.0]))
