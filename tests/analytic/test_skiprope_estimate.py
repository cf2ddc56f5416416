"""One call from signals to a skiprope: where the tether is, when it crosses a plane, how sure that is, and what is refused."""

import numpy as np
import pytest

from fieldline.cases.tp3123 import fly, random_scenario, true_cone
from fieldline.errors import InputError, NoEstimateError
from fieldline.estimation.skiprope import (
    METHODS,
    FieldGeometry,
    FieldKnowledge,
    estimate_skiprope,
    field_vector,
    skiprope_signals,
)
from fieldline.estimation.skiprope.numbers import derived
from fieldline.estimation.skiprope.solution import plane_crossings

HZ, LENGTH = 0.005, 20e3


def flown(duration_s=4000.0, **changes):
    """A flight with the field known exactly, its signals, and the true tilt and azimuth."""
    flight = fly(duration_s=duration_s, rate_hz=1.0, noise_tesla=2e-8, **changes)
    return flight, skiprope_signals(flight.seconds, flight.measured_b, field_vector(flight.geometry)), true_cone(flight)


def apart(a, b):
    """Difference of two angles [deg], within +-180."""
    return np.degrees(np.angle(np.exp(1j * (np.asarray(a) - b))))


@pytest.mark.parametrize("method, worst_deg, worst", [("harmonic", 0.5, 0.01), ("kalman", 1.5, 0.02), ("bandpass", 6.0, 0.06)])
@pytest.mark.parametrize("hz", [HZ, -HZ])
def test_a_round_cone_is_where_it_is(method, worst_deg, worst, hz):
    """Field known exactly, yaw zero: the rules of the paper are left with the azimuth's delay."""
    _, signals, (tilt, azimuth) = flown(skiprope_frequency_hz=hz, skiprope_deg=(0.6, 0.6), bias_deg=(0.0, 0.0, 0.0))
    found = estimate_skiprope(signals, tether_length_m=LENGTH, method=method, rule="corrected")
    rows = found.seconds > 1000.0
    assert found.detected and found.trusted[rows].all() and 0.0 <= found.trusted_from_s < 1000.0
    true = np.interp(found.seconds, signals.seconds, np.unwrap(azimuth)) + np.pi
    assert np.sqrt(np.mean(apart(found.plane_rad, true)[rows] ** 2)) < worst_deg
    assert (found.sense[rows] == np.sign(hz)).all()
    assert found.frequency_hz[-1] == pytest.approx(HZ, rel=5e-3)
    deflection = np.interp(found.seconds, signals.seconds, tilt) * LENGTH / np.pi
    assert np.abs(found.deflection_m[rows] / deflection[rows] - 1.0).max() < worst
    middle = deflection[:, None] * np.stack([-np.sin(true), np.cos(true)], axis=1)
    off = np.linalg.norm(found.position_m - middle, axis=1)[rows]
    assert np.sqrt(np.mean((off / deflection[rows]) ** 2)) < worst + np.radians(worst_deg)


@pytest.mark.parametrize("method", METHODS)
def test_crossings_are_when_the_tether_crosses(method):
    """The true tether, an ellipse of 1.5 to 1, lies in the plane within four deviations of each of the times told."""
    flight, signals, (_, azimuth) = flown(skiprope_deg=(0.75, 0.5), bias_deg=(0.0, 0.0, 0.0))
    found = estimate_skiprope(signals.between(0.0, 3000.0), tether_length_m=LENGTH, method=method, rule="corrected")
    plane = np.radians(30.0)
    told = found.crossings(plane, 4)
    assert told.seconds.shape == (4,) and (np.diff(told.seconds) > 80.0).all()
    across = np.sin(np.unwrap(azimuth) + np.pi - plane)
    k = np.flatnonzero(across[1:] * across[:-1] < 0.0)
    true = flight.seconds[k] - across[k] / (across[k + 1] - across[k])
    for time, std, towards in zip(told.seconds, told.std_s, told.towards, strict=True):
        nearest = np.abs(true - time).argmin()
        assert abs(true[nearest] - time) < 4.0 * std
        assert towards == (np.cos(azimuth[k[nearest]] + np.pi - plane) > 0.0)
    each = found.crossings(plane, 2, row=slice(None))
    assert each.seconds.shape == (len(found.seconds), 2) and (each.seconds > found.seconds[:, None]).all()


def test_numbers_and_their_deviations_by_chance():
    """Four thousand phasors about one: sample deviations equal the stated ones to 4 %, all of them."""
    rng = np.random.default_rng(4)
    root = 1e-4 * rng.standard_normal((4, 4))
    mean = np.array([0.9, 0.4, 0.2, -0.7]) * 0.01
    drawn = mean + rng.standard_normal((4_000, 4)) @ root.T
    count, yaw, yaw_std = len(drawn), 0.4, 0.03
    yaws = yaw + yaw_std * rng.standard_normal(count)

    def numbers(rows, yaw_of):
        phasor = np.stack([rows[:, 0] + 1j * rows[:, 1], rows[:, 2] + 1j * rows[:, 3]], axis=1)
        many = len(rows)
        spread = np.broadcast_to(root @ root.T, (many, 4, 4))
        return derived(phasor, spread, np.zeros(many, dtype=int), yaw_of, np.full(many, yaw_std), LENGTH)

    one, many = numbers(mean[None], np.array([yaw])), numbers(drawn, yaws)
    for name in ("amplitude", "major", "minor", "phase", "plane"):
        assert many[f"{name}_rad"].std() == pytest.approx(one[f"{name}_std_rad"][0], rel=0.04), name
        assert many[f"{name}_rad"].mean() == pytest.approx(one[f"{name}_rad"][0], rel=0.01), name
    assert np.cov(many["position_m"].T) == pytest.approx(one["position_covariance_m2"][0], rel=0.07, abs=0.03)
    assert one["major_rad"] > one["amplitude_rad"] > one["minor_rad"]
    phasor = (drawn[:, 0] + 1j * drawn[:, 1], drawn[:, 2] + 1j * drawn[:, 3])
    told = plane_crossings(
        np.zeros(count), np.stack(phasor, axis=1), np.broadcast_to(root @ root.T, (count, 4, 4)),
        (np.full(count, HZ), np.full(count, 1e-9)), (yaws, np.full(count, yaw_std)), 0.8, 2,
    )  # fmt: skip
    assert told.seconds.std(axis=0) == pytest.approx(told.std_s.mean(axis=0), rel=0.04)


@pytest.mark.parametrize("method", METHODS)
def test_yaw_and_azimuth_are_one_until_the_yaw_is_measured(method):
    """A yaw of 8 deg: all of it in the plane without it; with it, none; an azimuth error of 8 deg instead, the same signals."""
    flight, signals, (_, azimuth) = flown(skiprope_deg=(0.6, 0.6), bias_deg=(0.0, 0.0, 8.0))
    size, elevation, known = flight.geometry
    wrong = skiprope_signals(
        flight.seconds, flight.measured_b, field_vector(FieldGeometry(size, elevation, known - np.radians(8.0)))
    )
    common = {"tether_length_m": LENGTH, "method": method, "rule": "corrected", "frequency_hz": HZ}

    def mean_off(found):
        rows = found.seconds > 1200.0
        true = np.interp(found.seconds, flight.seconds, np.unwrap(azimuth)) + np.pi
        return apart(found.plane_rad, true)[rows].mean(), np.degrees(np.median(found.yaw_std_rad))

    half = mean_off(estimate_skiprope(signals, knowledge=FieldKnowledge(0.0, 0.0, 0.08), yaw_std_rad=0.08, **common))
    measured = mean_off(estimate_skiprope(signals, yaw_rad=np.radians(8.0), **common))
    both = mean_off(estimate_skiprope(wrong, yaw_rad=np.radians(8.0), **common))
    expected = 0.0 if method == "bandpass" else -4.0  # the rule takes the azimuth for true
    assert half[0] == pytest.approx(expected, abs=4.0 if method == "bandpass" else 1.0)
    assert half[1] == pytest.approx(np.degrees(0.08) / (1.0 if method == "bandpass" else np.sqrt(2.0)), rel=1e-6)
    worst = 4.0 if method == "bandpass" else 1.0
    assert measured[0] == pytest.approx(0.0, abs=worst) and both[0] == pytest.approx(0.0, abs=worst)
    assert measured[1] == pytest.approx(0.5)


def test_a_filter_says_how_little_it_knows_before_its_first_samples():
    """No row of the Kalman filter is without a frequency and a doubt, also where its samples are means over seconds."""
    _, signals, _ = flown()
    found = estimate_skiprope(signals, tether_length_m=LENGTH, method="kalman")
    assert found.frequency_hz[0] == pytest.approx(HZ, rel=0.02) and found.amplitude_std_rad[0] > np.radians(0.5)


def test_rare_samples_are_not_taken_for_noisy_ones():
    """A reading every ten seconds: three to a pendulous swing, whose differences are 25 times the noise."""
    _, signals, _ = flown(duration_s=6000.0)
    rare = skiprope_signals(signals.seconds[::10], signals.field_b[::10], field_vector(signals.geometry)[::10])
    found = estimate_skiprope(rare, tether_length_m=LENGTH, method="kalman")
    off = found.amplitude_rad[300:] / np.radians(0.625) - 1.0
    assert np.abs(off).max() < 0.02 and np.median(found.amplitude_std_rad[300:]) < np.radians(0.625) * 0.03


def test_a_filter_that_has_not_settled_says_so():
    _, signals, _ = flown(duration_s=1000.0, skiprope_deg=(0.09, 0.09))
    found = estimate_skiprope(signals, tether_length_m=LENGTH, method="kalman", frequency_hz=HZ)
    assert not found.trusted.any() and any("has not settled" in note for note in found.notes)


@pytest.mark.parametrize("method", METHODS)
def test_over_the_poles_the_fields_azimuth_is_not_leant_on(method):
    """A field that is vertical at moments has no azimuth then; the known one, two degrees off, points anywhere."""
    flight = fly(duration_s=6000.0, rate_hz=1.0, field="IGRF-14", inclination_deg=98.0, bias_deg=(0.5, 0.5, 2.0))
    known = field_vector(flight.geometry)
    turn = np.radians([-2.0, -2.0, 0.0])
    off = known + np.cross(turn, known)
    assert np.degrees(np.abs(flight.geometry.elevation_rad)).max() > 80.0
    found = estimate_skiprope(skiprope_signals(flight.seconds, flight.measured_b, off), tether_length_m=LENGTH, method=method)
    if method == "bandpass":
        assert not found.trusted.any() and any("above the horizon" in note for note in found.notes)
        return
    true = np.interp(found.seconds, flight.seconds, np.unwrap(true_cone(flight)[1])) + np.pi
    assert np.sqrt(np.mean(apart(found.plane_rad, true)[found.trusted] ** 2)) < (1.2 if method == "harmonic" else 3.0)


def test_no_skiprope_is_said():
    _, signals, _ = flown(skiprope_deg=(0.0, 0.0))
    found = estimate_skiprope(signals, tether_length_m=LENGTH)
    assert not found.detected and len(found.seconds) == 0 and found.verdict.startswith("no skiprope")
    assert any("31.2" in note for note in found.notes)
    assert len(found.crossings(0.0).seconds) == 0 and np.isnan(found.trusted_from_s)
    told = estimate_skiprope(signals, tether_length_m=LENGTH, frequency_hz=HZ)
    assert not told.detected


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("share", [0.6, 1.0, 1.5, 1.8])
def test_a_bad_first_frequency_ends_at_the_skiprope(method, share):
    """The same as without one, and said where it was off; from further away the answer names what turns elsewhere."""
    _, signals, _ = flown()
    found = estimate_skiprope(signals, tether_length_m=LENGTH, method=method, frequency_hz=share * HZ)
    assert found.frequency_hz[-1] == pytest.approx(HZ, rel=5e-3)
    assert any("that were given; what turns at 5 mHz" in note for note in found.notes) == (share != 1.0)
    none = estimate_skiprope(signals, tether_length_m=LENGTH, method=method, frequency_hz=2.4 * HZ)
    assert not none.detected and "within a factor of two of 12 mHz" in none.verdict
    assert any("give --frequency-hz 0.005" in note for note in none.notes)


@pytest.mark.parametrize("method", ["harmonic", "kalman"])
@pytest.mark.parametrize("pendulous_hz", [0.0025, 0.0037, 0.0065])
def test_a_motion_close_by_is_carried_along(method, pendulous_hz):
    """Amplitude and sense beside a swing three times as large, within four deviations that are a few per cent at most."""
    _, signals, _ = flown(duration_s=6000.0, pendulous_frequency_hz=pendulous_hz, bias_deg=(0.5, 0.5, 2.0))
    found = estimate_skiprope(signals, tether_length_m=LENGTH, method=method, frequency_hz=HZ)
    rows = found.trusted
    assert rows.sum() > 300 and (found.sense[rows] == 1).all()
    off, std = found.amplitude_rad[rows] / np.radians(0.625) - 1.0, found.amplitude_std_rad[rows] / np.radians(0.625)
    assert np.median(std) < (0.01 if method == "harmonic" else 0.04)
    assert np.sqrt(np.mean(off**2)) < 0.05 and np.sqrt(np.mean((off / std) ** 2)) < 4.0


def test_a_filter_that_leaves_a_close_motion_out_is_not_trusted():
    """Of two other motions the Kalman filter carries the stronger; the weaker, close by, would pull it away unnoticed."""
    _, signals, _ = flown(duration_s=6000.0)
    lean = np.radians(0.4) * np.cos(2.0 * np.pi * 0.0065 * signals.seconds)
    tilted = signals.field_b - lean[:, None] * np.cross([1.0, 0.0, 0.0], signals.field_b)
    both = skiprope_signals(signals.seconds, tilted, field_vector(signals.geometry))
    found = estimate_skiprope(both, tether_length_m=LENGTH, method="kalman")
    assert not found.trusted.any() and any("leaves out what moves at 6.5" in note for note in found.notes)
    assert estimate_skiprope(both, tether_length_m=LENGTH).amplitude_rad[-1] == pytest.approx(np.radians(0.625), rel=0.02)


def test_what_a_person_should_know_is_in_the_notes():
    _, signals, _ = flown(pendulous_frequency_hz=0.011)
    assert any("factor of three" in note for note in estimate_skiprope(signals, tether_length_m=LENGTH).notes)
    _, signals, _ = flown(duration_s=900.0)
    assert any("only 4.5 periods" in note for note in estimate_skiprope(signals, tether_length_m=LENGTH).notes)
    _, signals, _ = flown(bias_deg=(1.0, 1.0, 20.0))
    assert any("off the known one" in note for note in estimate_skiprope(signals, tether_length_m=LENGTH).notes)
    _, signals, _ = flown(duration_s=8000.0)
    sparse = skiprope_signals(signals.seconds[::30], signals.field_b[::30], field_vector(signals.geometry)[::30])
    assert any("would look the same" in note for note in estimate_skiprope(sparse, tether_length_m=LENGTH).notes)


@pytest.mark.parametrize("method", METHODS)
def test_gaps_are_lived_through(method):
    _, signals, (_, azimuth) = flown(duration_s=6000.0, skiprope_deg=(0.6, 0.6), bias_deg=(0.0, 0.0, 0.0))
    kept = (signals.seconds < 2000.0) | (signals.seconds > 2350.0)
    holed = skiprope_signals(signals.seconds[kept], signals.field_b[kept], field_vector(signals.geometry)[kept])
    found = estimate_skiprope(holed, tether_length_m=LENGTH, method=method, rule="corrected")
    rows = found.seconds > 3600.0
    true = np.interp(found.seconds, signals.seconds, np.unwrap(azimuth)) + np.pi
    assert np.sqrt(np.mean(apart(found.plane_rad, true)[rows] ** 2)) < 5.0
    assert any("longest gap" in note for note in found.notes)


def test_refusals():
    flight, signals, _ = flown(duration_s=3000.0)
    known = field_vector(flight.geometry)
    with pytest.raises(InputError, match="harmonic"):
        estimate_skiprope(signals, tether_length_m=LENGTH, method="harmonics")
    with pytest.raises(InputError, match="rule must be"):
        estimate_skiprope(signals, tether_length_m=LENGTH, rule="mine")
    with pytest.raises(InputError, match="yaw_rad must be"):
        estimate_skiprope(signals, tether_length_m=LENGTH, yaw_rad=np.zeros(5))
    with pytest.raises(InputError, match="tether_length_m"):
        estimate_skiprope(signals, tether_length_m=-1.0)
    with pytest.raises(InputError, match="count"):
        estimate_skiprope(signals, tether_length_m=LENGTH).crossings(0.0, 0)
    with pytest.raises(NoEstimateError, match="check the orbit"):
        estimate_skiprope(skiprope_signals(flight.seconds, -flight.measured_b, known), tether_length_m=LENGTH)
    with pytest.raises(NoEstimateError, match="longer record"):
        estimate_skiprope(signals.between(0.0, 100.0), tether_length_m=LENGTH)
    with pytest.raises(InputError, match="rise"):
        skiprope_signals(flight.seconds[::-1], flight.measured_b, known)
    with pytest.raises(InputError, match="one row for each"):
        skiprope_signals(flight.seconds[1:], flight.measured_b, known)
    with pytest.raises(NoEstimateError, match="of 3001 samples"):
        skiprope_signals(flight.seconds, np.full_like(flight.measured_b, np.nan), known)


def test_a_random_flight_is_better_known_by_both_than_by_the_rules():
    one = random_scenario(5003)
    sizes = {}
    for method in METHODS:
        found = estimate_skiprope(one.signals, tether_length_m=LENGTH, method=method)
        rows = found.seconds > 1000.0
        radius = np.hypot(*found.position_m.T)[rows] * np.pi / LENGTH
        true = np.interp(found.seconds, one.flight.seconds, true_cone(one.flight)[0])[rows]
        sizes[method] = np.sqrt(np.mean((radius / true - 1.0) ** 2))
    assert max(sizes["harmonic"], sizes["kalman"]) < 0.5 * sizes["bandpass"]
