"""A day of the Orbiting Astronomical Observatory (White, Shigemoto and Bourquin 1961): a scenario beyond the study."""

import numpy as np
import pytest

from fieldline.cases.ames_1961 import observatory
from fieldline.cases.ames_1961.observatory_day import field_along, stretches
from fieldline.errors import InputError

HOUR = {"duration_s": 7200.0}


@pytest.fixture(scope="module")
def days():
    return {coils: observatory(coils) for coils in (3, 2)}


def test_three_coils_hold_the_line_longer_than_two(days):
    three, two = days[3], days[2]
    assert 0.99 < float(two["within_fraction"]) < float(three["within_fraction"]) < 1.0
    assert three.sizes["loss"] < two.sizes["loss"]
    assert float(three["mean_power_w"]) < float(two["mean_power_w"]) < 0.1
    assert float(three["error_max_arcsec"]) < 0.6


def test_the_losses_are_where_the_field_is_across_the_line(days):
    for day in days.values():
        later = day["loss_start_s"].values > 300.0  # the integral has learnt the torque by then
        assert later.sum() > 5
        assert (day["loss_field_ratio"].values[later] < 0.01).all()
        assert (day["loss_length_s"].values[later] < 90.0).all()
        worst = np.abs(day["error"].values).max(axis=1)
        total = day["loss_length_s"].values.sum() / day["seconds"].values[-1]
        assert 1.0 - float(day["within_fraction"]) == pytest.approx(total, abs=2e-5)
        assert day["loss_error_arcsec"].values.max() == worst.max()
        assert 0.04 < float(day["weak_fraction"]) < 0.07  # 5 % in the mean over the sky


def test_energy_is_the_integral_of_power(days):
    day = days[2]
    trapezoid = np.trapezoid(day["power"].values, day["seconds"].values)
    assert float(day["energy"][-1]) == pytest.approx(trapezoid, rel=0.02)


def test_the_wheel_takes_what_the_coils_turn_about_the_line(days):
    day = days[3]
    assert np.abs(day["roll_angle"].values).max() < 0.2
    close = observatory(duration_s=900.0, sample_s=0.02)
    torque = close["torque"].values[:, 0]
    turned = np.concatenate([[0.0], np.cumsum(0.01 * (torque[1:] + torque[:-1]))])
    vehicle = 1356.0 * np.radians(close["rate"].values[:, 0] / 3600.0)
    assert np.ptp(turned) > 0.02
    assert close["wheel_momentum"].values + vehicle == pytest.approx(turned, abs=1e-4)
    free = observatory(roll="free", **HOUR)
    assert "wheel_momentum" not in free
    assert np.abs(free["roll_angle"].values).max() > 0.5


def test_the_step_is_fine_enough():
    coarse, fine = (observatory(step_s=step, **HOUR)["error"].values for step in (0.02, 0.005))
    assert np.abs(coarse - fine).max() < 2e-3


def test_another_field_model_and_another_star():
    igrf = field_along(35.0, 805e3, (60.0, 20.0, 0.0), "IGRF-14", "2025-06-01T00:00:00", 6050.0)
    study = field_along(35.0, 805e3, (60.0, 20.0, 0.0), "study", "2025-06-01T00:00:00", 6050.0)
    assert igrf.shape == study.shape
    assert 1.6e-5 < np.linalg.norm(igrf, axis=1).min() < np.linalg.norm(igrf, axis=1).max() < 4.6e-5
    coarse = field_along(35.0, 805e3, (60.0, 20.0, 0.0), "IGRF-14", "2025-06-01T00:00:00", 6050.0, degree=1)
    assert 0.0 < np.abs(coarse - igrf).max() < 1.5e-5
    day = observatory(model="IGRF-14", inertia_kg_m2=np.array([1200.0, 1356.0, 1400.0]), **HOUR)
    assert float(day["within_fraction"]) > 0.95
    aside = observatory(right_ascension_deg=200.0, declination_deg=-40.0, roll_deg=30.0, **HOUR)
    assert float(aside["within_fraction"]) > 0.9


def test_stretches():
    assert stretches(np.array([True, False, True, True])) == [(0, 1), (2, 4)]
    assert stretches(np.zeros(3, dtype=bool)) == []


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"roll": "held"}, "roll"),
        ({"coils": 1}, "coils"),
        ({"model": "IGRF-99"}, "IGRF-14"),
        ({"degree": 4}, "no degree"),
        ({"model": "IGRF-14", "start_utc": "1850-01-01"}, "1850"),
        ({"altitude_m": 500.0}, "altitude_m"),
    ],
)
def test_bad_input_is_named(settings, words):
    with pytest.raises(InputError, match=words):
        observatory(**settings)
