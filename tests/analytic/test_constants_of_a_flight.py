"""Constants found with the attitude, what they add to its uncertainty, and the words on consistency."""

import numpy as np
import pytest

from fieldline.estimation.consistency import consistency
from fieldline.estimation.estimate import Arc, _calibrated
from fieldline.estimation.kalman import Noise
from fieldline.estimation.motion import random_walk
from fieldline.estimation.polish import effective_share, gather_constants, polish
from fieldline.estimation.reference import reference_along_orbit
from fieldline.estimation.smoothing import smooth
from fieldline.estimation.systematics import first_order_noise, standing_error, widen, widen_by_field_model
from fieldline.estimation.tuning import magnitude_noise, tune
from fieldline.frames.attitude import rotation_error_b
from fieldline.simulate import Magnetometer, fly_free
from tests_support import orbit, times_utc

BIAS = np.array([2e-5, -1e-5, 1.5e-5])
MATRIX = np.array([[1.02, 0.01, -0.006], [0.01, 0.98, 0.012], [-0.006, 0.012, 1.01]])
SIX = MATRIX[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def quiet(*_):
    """No progress."""


@pytest.fixture(scope="module")
def held():
    """Two orbits of a body held Earth-pointing, whose magnitudes leave the calibration unsure."""
    reference = reference_along_orbit(times_utc(2281, 5.0), orbit())
    sensor = Magnetometer(bias_s=BIAS, matrix=MATRIX, noise_std_tesla=5e-8)
    flight = fly_free(reference, pointing="earth", libration_deg=0.1, magnetometer=sensor, seed=1)
    arc, free = _calibrated(flight.telemetry, reference, "full", (), quiet)
    assert free
    return flight, arc


def polished(flight, arc: Arc, volume_of, rounds=3):
    start = np.r_[flight.q_bi[0], flight.omega_bi_b[0]]
    constants = gather_constants(arc.calibration.values, arc.calibration.covariance, None, None, None)
    noise, like = Noise(white=5e-8, coloured=3e-8, coloured_time=300.0), random_walk(1e-7)
    for _ in range(rounds):
        constants, _ = polish(constants, arc.series, volume_of, start, noise, like)
        series = arc.series(constants.values)
        noise, like, _ = tune(series, start, noise, like, magnitude_noise(series))
    return constants, noise, like


def test_recalibration_with_the_attitude_betters_the_magnitudes_and_states_its_error(held):
    flight, arc = held
    constants, *_ = polished(flight, arc, lambda v: arc.volume(v, slice(None)))
    true = np.r_[BIAS, SIX]
    before = np.abs(arc.calibration.values - true)
    after = np.abs(constants.values - true)
    std = np.sqrt(np.diag(constants.covariance))
    assert (after < 5.0 * std).all()
    # the axis across the orbit, along which the field of a held body hardly changes, is what the magnitudes see worst
    assert after[4] < before[4] or before[4] < 3e-3
    assert std[4] < np.sqrt(arc.calibration.covariance[4, 4])


def test_without_the_volume_a_matrix_shrinks_to_win(held):
    """The likelihood of the calibrated field, not of the readings, rewards a matrix that crushes an axis."""
    flight, arc = held
    honest, *_ = polished(flight, arc, lambda v: arc.volume(v, slice(None)), rounds=2)
    crushed, *_ = polished(flight, arc, lambda v: 0.0, rounds=2)
    assert abs(honest.values[4] - SIX[1]) < 0.1
    assert crushed.values[4] < 0.8 * SIX[1]


def test_doubt_of_the_constants_widens_the_attitude(held):
    flight, arc = held
    constants, noise, like = polished(flight, arc, lambda v: arc.volume(v, slice(None)))
    series = arc.series(constants.values)
    plain = smooth(series, np.r_[flight.q_bi[0], flight.omega_bi_b[0]], noise, like, passes=3)
    wide = widen(plain, constants, arc.series)
    grown = wide.attitude_covariance_b - plain.attitude_covariance_b
    assert np.linalg.eigvalsh(grown).min() > -1e-15
    assert np.trace(grown.mean(axis=0)) > np.trace(plain.attitude_covariance_b.mean(axis=0))
    error = rotation_error_b(flight.q_bi, wide.q_bi)
    square = np.einsum("ni,nij,nj->n", error, np.linalg.inv(wide.attitude_covariance_b), error).mean() / 3.0
    assert square < 6.0


def test_field_model_errors_widen_by_about_their_angle(held):
    """100 nT on 35,000 nT are 0.16 deg; an arc of two orbits averages some of them away."""
    flight, arc = held
    series = arc.series(None)
    plain = smooth(series, np.r_[flight.q_bi[0], flight.omega_bi_b[0]], Noise(white=5e-8), random_walk(1e-7), passes=2)
    first, second = (widen_by_field_model(plain, series, seed=3) for _ in range(2))
    grown = np.sqrt(np.trace((first.attitude_covariance_b - plain.attitude_covariance_b).mean(axis=0)))
    assert 0.01 < np.degrees(grown) < 1.0
    assert np.array_equal(first.attitude_covariance_b, second.attitude_covariance_b)


def test_standing_error_is_found_in_the_residuals(held):
    flight, arc = held
    series = arc.series(np.r_[BIAS, SIX])
    start = np.r_[flight.q_bi[0], flight.omega_bi_b[0]]
    plain = smooth(series, start, Noise(white=5e-8), random_walk(1e-12), passes=2)
    assert standing_error(plain, series) < 5e-8
    off = series._replace(field_i=series.field_i + np.array([4e-7, 0.0, 0.0]))
    assert 1e-7 < standing_error(plain, off) < 4e-7


def test_first_order_noise_has_unit_spread_and_its_memory():
    seconds = 2.0 * np.arange(200_000)
    noise = first_order_noise(seconds, 100.0, np.random.default_rng(0))
    assert np.allclose(noise.std(axis=0), 1.0, atol=0.05)
    lag = 50
    correlation = (noise[lag:] * noise[:-lag]).mean(axis=0)
    assert np.allclose(correlation, np.exp(-1.0), atol=0.06)


def test_samples_that_repeat_count_for_less():
    rng = np.random.default_rng(1)
    white = rng.standard_normal((4000, 3))
    assert effective_share(white) > 0.9
    spin = np.sin(2 * np.pi * np.arange(4000) / 7.87)[:, None]
    assert effective_share(white + 1.0 * spin) < 0.05
    holes = white.copy()
    holes[::3] = np.nan
    assert effective_share(holes) > 0.8


def test_words_on_consistency():
    rng = np.random.default_rng(2)
    white = rng.standard_normal((3000, 3))
    assert consistency(white)["words"] == "consistent"
    assert consistency(2.3 * white)["words"].startswith("too optimistic: residuals are 2.")
    assert consistency(0.5 * white)["words"].startswith("too pessimistic: residuals are 0.5 sigma")
    slow = white.copy()
    slow[1:] = (white[1:] + white[:-1]) / np.sqrt(2.0)
    assert "remember their neighbours" in consistency(slow)["words"]
    spin = np.sqrt(2.0) * np.sin(2 * np.pi * np.arange(3000) / 7.87)[:, None]
    assert "tell as much as" in consistency((white + spin) / np.sqrt(2.0))["words"]
    assert consistency(white[:5])["words"] == "too few samples to say"
