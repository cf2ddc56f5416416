"""The model that the data support is chosen; what they do not support is refused in words."""

import json

import numpy as np
import pytest

from fieldline.errors import InputError, NoEstimateError
from fieldline.estimation.calibration import (
    Calibration,
    Flight,
    calibrate_flights,
    calibrate_magnitude,
    read_calibration,
    write_calibration,
)
from fieldline.estimation.calibration.selection import without_gaps


def calibrated(flown, **options):
    return calibrate_magnitude(flown.seconds, flown.field_s, flown.magnitude, **options)


def stated_and_true(found, flown):
    error = found.apply(flown.seconds, flown.field_s) - flown.field_b
    return np.sqrt(np.mean(found.propagated_std(flown.seconds, flown.field_s) ** 2)), np.sqrt(np.mean(error**2))


def test_a_calibrated_sensor_is_left_alone(flight):
    found = calibrated(flight("tumbling", bias=np.zeros(3), matrix=np.eye(3)))
    assert found.model == "none"
    assert np.array_equal(found.bias_s, np.zeros(3))
    assert found.bias_std_s.max() < 3e-7


def test_a_bias_alone_is_enough_for_a_square_sensor(flight):
    assert calibrated(flight("tumbling", matrix=np.eye(3))).model == "bias"


def test_a_tumbler_gets_nine(flight):
    found = calibrated(flight("tumbling"))
    assert found.model == "full"
    assert sum(c.chosen for c in found.candidates) == 1
    assert all(c.why for c in found.candidates)


@pytest.mark.parametrize("kind", ["earth", "still"])
def test_short_slow_arcs_fall_back_and_say_so(flight, kind):
    flown = [flight(kind, k, span_s=600.0) for k in range(4)]
    found = [calibrated(f) for f in flown]
    stated, true = zip(*map(stated_and_true, found, flown), strict=True)
    assert {one.model for one in found} <= {"none", "bias", "bias+scale"}
    assert np.sqrt(np.mean(np.square(true))) < 2.5 * np.sqrt(np.mean(np.square(stated)))


def test_slow_terms_are_refused_to_a_slow_satellite(flight):
    found = calibrated(flight("earth", gain=0.02, bias=np.array([1e-5, -3e-6, -3e-6]), step_s=2.0))
    assert found.terms.gain == "none"
    assert not found.terms.drift
    assert any("turns too slowly" in c.why for c in found.candidates)


def test_sunlight_without_a_step_is_not_chosen(flight):
    for seed in range(3):
        flown = flight("spinning", seed, step_s=2.0)
        found = calibrated(flown, sunlit=(np.abs(flown.seconds - 2000.0) > 1070.0).astype(float))
        assert found.model == "full"
        assert any("sunlit" in c.model for c in found.candidates)


def test_sunlight_is_not_tried_without_an_edge(flight):
    flown = flight("spinning", step_s=4.0)
    found = calibrated(flown, sunlit=np.ones(len(flown.seconds)))
    assert not any("sunlit" in c.model for c in found.candidates)
    with pytest.raises(InputError, match="never changes"):
        calibrated(flown, sunlit=np.ones(len(flown.seconds)), model="full+sunlit")
    arguments = {"seconds": flown.seconds, "field_s": flown.field_s, "magnitude_tesla": flown.magnitude}
    pair = [Flight(**arguments, sunlit=np.full(len(flown.seconds), k)) for k in (0.0, 1.0)]
    assert not any("sunlit" in c.model for c in calibrate_flights(pair)[0].candidates)


def test_sunlight_is_refused_to_a_slow_satellite(flight):
    flown = flight("earth", step_s=2.0)
    found = calibrated(flown, sunlit=(np.abs(flown.seconds - 2000.0) > 1070.0).astype(float))
    assert not found.terms.sunlit
    assert all("turns too slowly" in c.why for c in found.candidates if "sunlit" in c.model)


def test_held_out_stretches_do_not_reward_needless_terms(flight):
    assert all(calibrated(flight("spinning", k, step_s=2.0)).model == "full" for k in range(3))


def test_clock_scan_finds_a_shift_and_leaves_a_true_clock(flight):
    flown = flight("tumbling", 4)
    wide = flight("tumbling", 4, start_s=-200.0, span_s=6040.0)
    at = lambda offset, late=0.0: np.interp(flown.seconds + offset + late, wide.seconds, wide.magnitude)
    good = calibrated(flown, model="full", clock_scan=True, magnitude_at=at)
    assert abs(good.clock.best_s) < 1.0
    assert good.clock.sigmas < 3.0
    late = calibrate_magnitude(
        flown.seconds, flown.field_s, at(0.0, 40.0), model="full", clock_scan=True, magnitude_at=lambda o: at(o, 40.0)
    )
    assert late.clock.best_s == pytest.approx(-40.0, abs=2.0)
    assert late.clock.sigmas > 3.0
    assert not late.clock.applied
    assert "not applied" in late.summary()["sentence"]
    mended = calibrate_magnitude(
        flown.seconds, flown.field_s, at(0.0, 40.0), model="full", clock_apply=True, magnitude_at=lambda o: at(o, 40.0)
    )
    assert mended.clock.applied
    assert mended.residual_rms_tesla < 3.4e-7 < late.residual_rms_tesla


def test_json_returns_the_same_calibration(flight, tmp_path):
    flown = flight("spinning", gain=0.03, step_s=2.0)
    found = calibrated(flown, model="full+gain", epoch_utc=np.datetime64("2023-08-24T14:44:09"))
    path = write_calibration(found, tmp_path / "c.json")
    again = read_calibration(path)
    assert np.array_equal(again.apply(flown.seconds, flown.field_s), found.apply(flown.seconds, flown.field_s))
    assert again.summary() == found.summary()
    assert again.epoch_utc == found.epoch_utc
    json.dumps(found.summary(), allow_nan=False)
    later = again.apply(flown.seconds, flown.field_s, epoch_utc=np.datetime64("2023-08-26T14:44:09"))
    assert later == pytest.approx(flown.field_s @ again.matrix - again.matrix @ again.bias_s, abs=1e-15)
    far = again.propagated_std(flown.seconds, flown.field_s, epoch_utc=np.datetime64("2023-08-26T14:44:09"))
    assert far.mean() > 3.0 * again.propagated_std(flown.seconds, flown.field_s).mean()


@pytest.mark.parametrize(
    "damage",
    [
        lambda d: "",
        lambda d: "[1, 2]",
        lambda d: json.dumps({**d, "version": 9}),
        lambda d: json.dumps({**d, "values": d["values"][:-1]}),
        lambda d: json.dumps({k: v for k, v in d.items() if k != "terms"}),
        lambda d: json.dumps({**d, "values": ["x"] * len(d["values"])}),
        lambda d: json.dumps({**d, "terms": {**d["terms"], "bias": False}}),
    ],
)
def test_damaged_files_are_refused(flight, damage):
    document = json.loads(calibrated(flight(step_s=20.0), model="full").to_json())
    with pytest.raises(InputError, match="calibrat"):
        Calibration.from_json(damage(document))


def test_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot read"):
        read_calibration(tmp_path / "none.json")


def test_constant_field(flight):
    flown = flight()
    with pytest.raises(NoEstimateError, match="never changes"):
        calibrate_magnitude(flown.seconds, np.tile(flown.field_s[0], (len(flown.seconds), 1)), flown.magnitude)


def test_all_missing(flight):
    flown = flight(step_s=20.0)
    with pytest.raises(InputError, match="none of the"):
        calibrate_magnitude(flown.seconds, np.full_like(flown.field_s, np.nan), flown.magnitude)


def test_ten_samples(flight):
    flown = flight(span_s=10.0)
    with pytest.raises(NoEstimateError, match="10 usable samples"):
        calibrated(flown)
    assert calibrated(flown, model="none").fitted == 0


def test_collinear_readings_give_no_false_certainty(flight):
    flown = flight(step_s=4.0)
    line = np.outer(flown.magnitude, [0.6, 0.8, 0.0]) + 2e-7 * np.random.default_rng(0).standard_normal(flown.field_s.shape)
    found = calibrate_magnitude(flown.seconds, line, flown.magnitude)
    assert found.model in ("none", "bias", "bias+scale")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"model": "ful"}, "did you mean"),
        ({"model": "full+gian"}, "did you mean"),
        ({"model": "full+dipole"}, "needs the column"),
        ({"clock_scan": True}, "magnitude_at"),
        ({"seconds": np.zeros(282)}, "must increase"),
        ({"field_s": np.zeros((3, 282))}, "must agree"),
        ({"temperature_k": np.zeros(5)}, "temperature_k must be"),
    ],
)
def test_bad_arguments_are_named(flight, change, words):
    flown = flight(step_s=20.0)
    arguments = {"seconds": flown.seconds, "field_s": flown.field_s, "magnitude_tesla": flown.magnitude, **change}
    with pytest.raises(InputError, match=words):
        calibrate_magnitude(**arguments)


def test_no_flight_at_all():
    with pytest.raises(InputError, match="no flight"):
        calibrate_flights([])


def test_rows_that_are_not_usable_do_not_matter(flight):
    flown = flight(step_s=4.0)
    usable = np.ones(len(flown.seconds), dtype=bool)
    usable[100:200] = False
    wild = flown.field_s.copy()
    wild[100:200] = 7.0
    wild[300] = np.nan
    masked = calibrate_flights([Flight(seconds=flown.seconds, field_s=wild, magnitude_tesla=flown.magnitude, usable=usable)])[0]
    assert masked.samples == len(flown.seconds) - 101
    assert np.abs(masked.bias_s - flown.bias).max() < 2e-7
    assert np.isnan(masked.apply(flown.seconds, wild)[300]).all()


def test_two_passes_far_apart_are_as_good_as_one_arc(flight):
    """Blocks are cut from the time that was sampled: else two passes a day apart were two blocks, too few to hold one out."""
    near, far = flight("tumbling", span_s=500.0), flight("tumbling", 1, span_s=500.0, start_s=3 * 5640.0)
    seconds = np.concatenate([near.seconds, far.seconds])
    field_s, magnitude = np.concatenate([near.field_s, far.field_s]), np.concatenate([near.magnitude, far.magnitude])
    found = calibrate_magnitude(seconds, field_s, magnitude)
    assert found.model == "full"
    assert np.abs(found.bias_s - near.bias).max() < 1e-6


def test_gaps_are_cut_out_of_the_blocks():
    seconds = np.concatenate([np.arange(0.0, 400.0), np.arange(86400.0, 86800.0)])
    assert without_gaps(seconds)[-1] == pytest.approx(799.0)
    assert np.array_equal(without_gaps(np.arange(0.0, 5000.0, 600.0)), np.arange(0.0, 5000.0, 600.0))
