"""Known calibrations are found again, within the uncertainty that is stated."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.errors import InputError
from fieldline.estimation.calibration import Flight, calibrate_flights, calibrate_magnitude
from fieldline.estimation.calibration.face import gather
from fieldline.estimation.calibration.fit import prior_of
from fieldline.estimation.calibration.ladder import BASIC, best_fit
from fieldline.estimation.calibration.start import centred_bias, centred_matrix

SIX = ((0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2))


def calibrated(flown, **options):
    return calibrate_magnitude(flown.seconds, flown.field_s, flown.magnitude, **options)


def errors(found, flown):
    return found.values[:9] - np.concatenate([flown.bias, flown.matrix[SIX]])


def squared_errors(flight, kind, **options):
    """Sum over ten seeds of the normalised squared error of nine parameters."""
    total = 0.0
    for seed in range(10):
        flown = flight(kind, seed, step_s=2.0)
        found = calibrated(flown, model="full", **options)
        e = errors(found, flown)
        total += float(e @ np.linalg.solve(found.covariance[:9, :9], e))
    return total


@pytest.mark.parametrize("kind", ["tumbling", "spinning"])
def test_nine_parameters_are_consistent_over_seeds(flight, kind):
    """Chi-squared of 90, within its 99.99 % and a lower bound that a doubled sigma would miss."""
    assert 45.0 < squared_errors(flight, kind, field_model_std_tesla=0.0) < 148.0


def test_a_slow_satellite_is_not_promised_too_much(flight):
    """Its valley is curved and the linear covariance short of it; with the field model's error stated, it is covered."""
    assert squared_errors(flight, "earth") < 148.0


def test_noise_free_start_is_exact(flight):
    flown = flight(noise=0.0)
    samples, units = gather([Flight(seconds=flown.seconds, field_s=flown.field_s, magnitude_tesla=flown.magnitude)])
    bias, matrix = centred_matrix(samples)
    assert np.abs(bias * units.field_tesla - flown.bias).max() < 1e-12
    assert np.abs(matrix - flown.matrix).max() < 1e-9
    level = flight(noise=0.0, matrix=np.eye(3))
    samples, units = gather([Flight(seconds=level.seconds, field_s=level.field_s, magnitude_tesla=level.magnitude)])
    assert np.abs(centred_bias(samples) * units.field_tesla - level.bias).max() < 1e-12


def test_two_per_cent_outliers_do_not_pull(flight):
    flown = flight(outliers=0.02)
    found = calibrated(flown, model="full")
    assert np.all(np.abs(errors(found, flown)) < 4.0 * found.std[:9])
    assert 60 <= found.outliers <= 140


def test_quantised_slow_satellite_states_its_error(flight):
    flown = flight("earth", 3, step_s=5.0, noise=5e-8, quantum=1e-7)
    found = calibrated(flown)
    error = np.sqrt(np.mean((found.apply(flown.seconds, flown.field_s) - flown.field_b) ** 2))
    stated = np.sqrt(np.mean(found.propagated_std(flown.seconds, flown.field_s) ** 2))
    assert found.model == "full"
    assert error < 2.0 * stated
    assert stated > 3e-7


def test_propagated_std_covers_the_field_error(flight):
    ratios = []
    for seed in range(6):
        flown = flight("tumbling", seed, noise=1e-6)
        found = calibrated(flown, model="full", field_model_std_tesla=0.0)
        clean = flown.field_b @ np.linalg.inv(flown.matrix) + flown.bias
        error = found.apply(flown.seconds, clean) - flown.field_b
        ratios.append(np.mean((error / found.propagated_std(flown.seconds, clean)) ** 2))
    assert 0.4 < np.mean(ratios) < 2.0


@pytest.mark.parametrize("on", ["reading", "field"])
def test_slow_gain_is_recovered_and_named(flight, on):
    flown = flight("spinning", 1, gain=0.04, gain_on=on)
    found = calibrated(flown)
    assert found.model == ("full+gain" if on == "reading" else "full+field-gain")
    assert np.abs(found.gain(flown.seconds) - flown.gain).max() < 0.005
    assert np.abs(np.mean(found.gain(flown.seconds)) - 1.0) < 1e-5
    error = found.apply(flown.seconds, flown.field_s) - flown.field_b
    assert np.sqrt(np.mean(error**2)) < 3.3e-7


def test_drift_is_recovered(flight):
    drift = np.array([8e-10, -5e-10, 3e-10])
    flown = flight(extra=lambda t: np.outer(t, drift))
    found = calibrated(flown)
    place = found.terms.layout["drift"]
    assert found.model == "full+drift"
    assert np.all(np.abs(found.values[place] - drift) < 4.0 * found.std[place])


def test_couplings_are_recovered(flight):
    rng = np.random.default_rng(5)
    dipole = rng.choice([-0.2, 0.0, 0.2], (5640, 3))
    current = rng.uniform(0.0, 2.0, 5640)
    coupling = 1e-5 * rng.standard_normal((3, 3))
    loop = np.array([2e-7, -5e-7, 4e-7])
    flown = flight(extra=lambda t: dipole @ coupling.T + np.outer(current, loop))
    found = calibrated(flown, dipole_command_b=dipole, solar_current=current)
    layout = found.terms.layout
    truth = np.concatenate([coupling.ravel(), loop])
    got = np.concatenate([found.values[layout["dipole"]], found.values[layout["current"]]])
    std = np.concatenate([found.std[layout["dipole"]], found.std[layout["current"]]])
    assert np.all(np.abs(got - truth) < 4.5 * std)
    applied = found.apply(flown.seconds, flown.field_s, dipole_command_b=dipole, solar_current=current)
    assert np.sqrt(np.mean((applied - flown.field_b) ** 2)) < 3.3e-7


def test_a_step_in_sunlight_is_recovered(flight):
    step, sunlit = np.array([-7e-7, 2e-6, -2e-7]), lambda t: np.clip((np.abs(t - 2000.0) - 1070.0) / 8.0, 0.0, 1.0)
    flown = flight("spinning", 2, gain=0.03, extra=lambda t: np.outer(sunlit(t), step))
    lit = sunlit(flown.seconds)
    found = calibrated(flown, sunlit=lit)
    place = found.terms.layout["sunlit"]
    assert found.model == "full+gain+sunlit"
    assert np.all(np.abs(found.values[place] - step) < 4.0 * found.std[place])
    applied = found.apply(flown.seconds, flown.field_s, sunlit=lit)
    assert np.sqrt(np.mean((applied - flown.field_b) ** 2)) < 3.3e-7
    assert "in sunlight" in found.summary()["sentence"]
    with pytest.raises(InputError, match="sunlit"):
        found.apply(flown.seconds, flown.field_s)


def test_temperature_gain_is_recovered(flight):
    flown = flight()
    temperature = 290.0 + 12.0 * np.sin(flown.seconds / 700.0) + 3.0 * np.sin(flown.seconds / 130.0)
    warm = flown.field_s / (1.0 + 0.002 * (temperature - temperature.mean()))[:, None]
    found = calibrate_magnitude(flown.seconds, warm, flown.magnitude, temperature_k=temperature)
    assert found.terms.temperature
    assert abs(found.values[found.terms.layout["temperature"]][0] - 0.002) < 2e-5


def test_several_flights_share_matrix_and_bias(flight):
    flown = [flight("tumbling", k, span_s=3000.0) for k in range(3)]
    factors = (1.0, 0.97, 1.02)
    flights = [
        Flight(seconds=f.seconds, field_s=f.field_s * g, magnitude_tesla=f.magnitude) for f, g in zip(flown, factors, strict=True)
    ]
    found = calibrate_flights(flights)
    assert len(found) == 3
    assert found[0].terms.gain == "reading"
    for one, f, g in zip(found, flown, factors, strict=True):
        assert np.array_equal(one.bias_s, found[0].bias_s)
        assert np.array_equal(one.matrix, found[0].matrix)
        assert one.gain(f.seconds).mean() / found[0].gain(flown[0].seconds).mean() == pytest.approx(1.0 / g, rel=2e-4)
        assert np.sqrt(np.mean((one.apply(f.seconds, f.field_s * g) - f.field_b) ** 2)) < 3.3e-7


def test_a_fixed_rotation_of_the_sensor_changes_no_magnitude(flight):
    flown = flight("tumbling", 2, step_s=4.0)
    turned = Rotation.from_euler("xyz", [40.0, -70.0, 15.0], degrees=True)
    one = calibrated(flown, model="full")
    other = calibrate_magnitude(flown.seconds, turned.apply(flown.field_s), flown.magnitude, model="full")
    assert other.bias_s == pytest.approx(turned.apply(one.bias_s), abs=2e-9)
    r = turned.as_matrix()
    assert other.matrix == pytest.approx(r @ one.matrix @ r.T, abs=1e-4)
    assert other.residual_rms_tesla == pytest.approx(one.residual_rms_tesla, rel=1e-3)


def test_robust_prior_never_decides_where_data_do(flight):
    flown = flight(step_s=4.0)
    samples, _ = gather([Flight(seconds=flown.seconds, field_s=flown.field_s, magnitude_tesla=flown.magnitude)])
    one = best_fit(BASIC["full"], samples)
    pull = prior_of(one.terms, samples).information * (one.theta - prior_of(one.terms, samples).mean)
    assert one.converged
    assert np.abs(pull).max() < 20.0  # against informations of 1e5 and more
