"""From telemetry to the skiprope: axes, averages, planes, and what comes out against a known motion."""

import json

import numpy as np
import pytest

import fieldline as fl
from fieldline.cases.tp3123.flight import dcm_321
from fieldline.errors import InputError, NoEstimateError
from fieldline.estimation.skiprope.signals import ORBITAL_FROM_CONE
from fieldline.estimation.skiprope_telemetry import Mounting
from fieldline.estimation.skiprope_telemetry.plane import plane_of
from fieldline.telemetry import telemetry_of
from fieldline.telemetry.averaging import averaged, comes_fast
from fieldline.telemetry.stream import Rows, no_rows
from skiprope_flights import LENGTH_M, METHODS, START, flight, sample_orbit, tether_azimuth_rad, times, wrapped_deg

DEG = np.pi / 180.0


def estimate(record, **more):
    return fl.estimate_skiprope(record.telemetry, sample_orbit(), **({"tether_length_m": LENGTH_M} | more))


def seconds_of(dataset, name="time"):
    return (dataset[name].values - START).astype(np.int64) * 1e-9


@pytest.mark.kernels
@pytest.mark.parametrize(
    "method, plane_deg, share, frequency",
    [("harmonic", 2.0, 0.02, 5e-4), ("kalman", 6.0, 0.15, 1e-2), ("bandpass", 18.0, 0.25, 1e-2)],
)
@pytest.mark.parametrize("sense", [1, -1])
def test_what_comes_out_is_what_moved(method, plane_deg, share, frequency, sense):
    record = flight(skiprope_frequency_hz=0.0049 * sense)
    found = estimate(record, method=method)
    trusted = found.trusted.values
    assert trusted.mean() > 0.5 and (found.sense.values[trusted] == sense).all()
    off = wrapped_deg(found.plane_rad.values - tether_azimuth_rad(record, seconds_of(found)))[trusted]
    assert np.sqrt(np.mean((off - off.mean()) ** 2)) < plane_deg
    assert abs(off.mean()) < 4.0  # yaw, which a magnetometer does not see
    assert np.degrees(found.amplitude_rad.values[trusted]) == pytest.approx(0.6, rel=share)
    assert found.deflection_m.values[-1] == pytest.approx(LENGTH_M / np.pi * found.amplitude_rad.values[-1])
    assert found.frequency_hz.values[trusted] == pytest.approx(0.0049, rel=frequency)


def test_crossings_of_the_fields_plane_are_where_the_truth_crosses_it():
    record = flight()
    found = estimate(record)
    row = 120
    at = (found.crossing_time.values[row] - START).astype(np.int64) * 1e-9
    assert (np.diff(at) > 0.4 / 0.0049).all() and at[0] >= seconds_of(found)[row]
    field = np.interp(at, seconds_of(found, "sample_time"), np.unwrap(found.field_azimuth_rad.values))
    apart = wrapped_deg(tether_azimuth_rad(record, at) - field)
    towards = found.crossing_towards.values[row]
    assert np.abs(np.where(towards, apart, np.abs(apart) - 180.0)).max() < 4.0
    assert list(towards[1:]) == list(~towards[:-1])


def test_where_the_field_is_steep_its_plane_is_badly_known():
    """Crossings of the field's plane are as unsure as two degrees of direction make its azimuth; of others, as the tether is."""
    record = flight(skiprope_deg=(0.6, 0.6))
    found, orbit = estimate(record), estimate(record, plane="orbit")
    elevation = np.interp(seconds_of(found), seconds_of(found, "sample_time"), found.field_elevation_rad.values)
    doubt = np.hypot(found.yaw_std_rad.values, 2.0 * DEG * np.abs(np.tan(elevation)))
    rate = np.median(np.abs(np.diff(np.unwrap(found.plane_rad.values))) / np.diff(seconds_of(found)))
    stated = found.crossing_std_s.values[:, 0]
    assert np.median(stated * rate / doubt) == pytest.approx(1.0, abs=0.15)
    assert np.median(orbit.crossing_std_s.values[:, 0] * rate / orbit.yaw_std_rad.values) == pytest.approx(1.0, abs=0.15)
    steep = np.abs(elevation) > np.radians(35.0)
    assert np.median(stated[steep]) > 1.15 * np.median(stated[np.abs(elevation) < np.radians(10.0)])


@pytest.mark.parametrize("plane, azimuth_deg", [("normal", 0.0), ("orbit", -90.0), ("37.5", 37.5), (-120, -120.0)])
def test_crossings_of_a_plane_that_stands(plane, azimuth_deg):
    record = flight()
    found = estimate(record, plane=plane)
    at = (found.crossing_time.values[100] - START).astype(np.int64) * 1e-9
    apart = wrapped_deg(tether_azimuth_rad(record, at) - azimuth_deg * DEG)
    assert np.abs(np.where(found.crossing_towards.values[100], apart, np.abs(apart) - 180.0)).max() < 4.0


def test_a_tether_that_goes_up_bows_to_the_other_side():
    down, up = (estimate(flight(), tether=tether) for tether in ("down", "up"))
    assert np.abs(wrapped_deg(up.plane_rad.values - down.plane_rad.values)) == pytest.approx(180.0)
    assert up.position_m.values == pytest.approx(-down.position_m.values)
    assert (up.crossing_towards.values != down.crossing_towards.values).all()
    assert (up.crossing_time.values == down.crossing_time.values).all()


@pytest.mark.parametrize("axes", ["x,-y,-z", "-z,x,-y"])
def test_sensor_axes_are_turned_back(axes):
    record = flight()
    plain = estimate(record)
    letters = [part.strip() for part in axes.split(",")]
    matrix = np.array([[(-1.0 if one[0] == "-" else 1.0) * (one[-1] == axis) for axis in "xyz"] for one in letters])
    turned = record.telemetry.field_s @ matrix  # v_s = S' v_b
    found = fl.estimate_skiprope(
        telemetry_of(record.telemetry.time_utc, turned), sample_orbit(), tether_length_m=LENGTH_M, sensor_axes=axes
    )
    assert found.plane_rad.values == pytest.approx(plain.plane_rad.values)
    again = fl.estimate_skiprope(
        telemetry_of(record.telemetry.time_utc, turned), sample_orbit(), tether_length_m=LENGTH_M, sensor_axes=matrix
    )
    assert again.plane_rad.values == pytest.approx(plain.plane_rad.values)


def test_the_usual_attitude_is_taken_off():
    """Roll, pitch and yaw of the orbital axes are -a's of the paper's: x is its first axis, y and z point the other way."""
    roll, pitch, yaw = 4.0, -7.0, 30.0
    field_o = np.random.default_rng(1).standard_normal((20, 3))
    field_b = np.einsum("ij,nj->ni", dcm_321(DEG * np.array([[roll, pitch, yaw]]))[0], field_o)
    found = Mounting(attitude_deg=(roll, pitch, yaw)).field_c(field_b)
    assert found == pytest.approx(field_o @ ORBITAL_FROM_CONE)
    by_column = Mounting(attitude_deg=(roll, pitch, 0.0)).field_c(field_b, np.full(20, yaw * DEG))
    assert by_column == pytest.approx(found)


def test_a_measured_yaw_lowers_the_floor_and_mends_the_plane():
    record = flight(bias_deg=(0.5, 0.5, 8.0))
    blind = estimate(record)
    yaw = np.full(len(record.telemetry), -8.0 * DEG)  # about nadir, a3 is about up
    seen = fl.estimate_skiprope(
        telemetry_of(record.telemetry.time_utc, record.telemetry.field_s, yaw_rad=yaw), sample_orbit(), tether_length_m=LENGTH_M
    )
    off = wrapped_deg(seen.plane_rad.values - tether_azimuth_rad(record, seconds_of(seen)))[seen.trusted.values]
    assert np.abs(off).max() < 1.5
    assert np.degrees(np.median(seen.yaw_std_rad)) < 1.0 < np.degrees(np.median(blind.yaw_std_rad))
    assert json.loads(seen.attrs["verdict_json"])["yaw_measured"]
    ignored = fl.estimate_skiprope(
        telemetry_of(record.telemetry.time_utc, record.telemetry.field_s, yaw_rad=yaw), sample_orbit(), tether_length_m=LENGTH_M,
        use_yaw=False,
    )  # fmt: skip
    assert ignored.plane_rad.values == pytest.approx(blind.plane_rad.values)


def test_a_satellite_that_turns_about_its_tether_is_followed_by_its_yaw():
    """One turn in 500 s: without the yaw nothing would fit."""
    record = flight()
    seconds = (record.telemetry.time_utc - START).astype(np.int64) * 1e-9
    yaw = 2.0 * np.pi * seconds / 500.0
    c, s = np.cos(yaw), np.sin(yaw)
    x, y, z = record.telemetry.field_s.T
    spun = np.stack([c * x + s * y, -s * x + c * y, z], axis=-1)
    telemetry = telemetry_of(record.telemetry.time_utc, spun, yaw_rad=(yaw + np.pi) % (2 * np.pi) - np.pi)
    found = fl.estimate_skiprope(telemetry, sample_orbit(), tether_length_m=LENGTH_M)
    off = wrapped_deg(found.plane_rad.values - tether_azimuth_rad(record, seconds_of(found)))[found.trusted.values]
    assert np.abs(off).max() < 4.0
    with pytest.raises(NoEstimateError, match=r"points .* away from the known one"):
        fl.estimate_skiprope(telemetry, sample_orbit(), tether_length_m=LENGTH_M, use_yaw=False)


def test_a_biased_magnetometer_is_calibrated():
    record = flight()
    raw = record.telemetry.field_s + np.array([3e-6, -2e-6, 4e-6])
    telemetry = telemetry_of(record.telemetry.time_utc, raw)
    warned = fl.estimate_skiprope(telemetry, sample_orbit(), tether_length_m=LENGTH_M)
    assert "--calibration bias" in json.loads(warned.attrs["verdict_json"])["warnings"][0]
    found = fl.estimate_skiprope(telemetry, sample_orbit(), tether_length_m=LENGTH_M, calibration="bias")
    assert np.degrees(np.median(found.amplitude_rad)) == pytest.approx(0.6, rel=0.03)
    assert json.loads(found.attrs["verdict_json"])["warnings"] == []


def test_seconds_are_averaged_wherever_they_begin():
    draw = np.random.default_rng(2)
    time = START + (np.arange(160) * 62_500_000 + 437_000_000).astype("timedelta64[ns]")
    rows = Rows(time, draw.standard_normal((160, 3)), draw.standard_normal(160), no_rows(160).position_e)
    rows.field_s[40] = np.nan
    assert comes_fast(time) and not comes_fast(times(20))
    whole = averaged(rows)
    later = averaged(rows.where(slice(25, None)))  # from the last reading of the second second on
    assert np.array_equal(whole.time_utc[2:], later.time_utc[1:])
    assert whole.field_s[2:] == pytest.approx(later.field_s[1:], abs=1e-14)
    second = (time.astype(np.int64) // 10**9) == (START.astype(np.int64) // 10**9) + 2
    good = second & np.isfinite(rows.field_s[:, 0])
    assert whole.field_s[2] == pytest.approx(rows.field_s[good].mean(axis=0))
    rows.field_s[second] = np.nan
    assert np.isnan(averaged(rows).field_s[2]).all() and np.isfinite(averaged(rows).field_s[3]).all()


def test_sixteen_a_second_say_the_same():
    slow = estimate(flight(2000, 1.0))
    fast = estimate(flight(2000 * 4, 0.25))
    assert fast.sizes["sample_time"] == 2000
    assert np.degrees(np.median(fast.amplitude_rad)) == pytest.approx(np.degrees(np.median(slow.amplitude_rad)), rel=0.01)


@pytest.mark.parametrize(
    "given, words",
    [
        ({"tether_length_m": -1.0}, "tether_length_m must be a number from 1 to 1e[+]06 m"),
        ({"tether_length_m": float("nan")}, "tether_length_m"),
        ({"frequency_hz": 0.0}, "frequency_hz must be a number"),
        ({"method": "kalmann"}, 'method "kalmann" is not known; did you mean "kalman"'),
        ({"plane": "feild"}, 'plane "feild" is neither .*did you mean "field"'),
        ({"plane": "1000"}, "is neither field, orbit, normal nor an azimuth"),
        ({"sensor_axes": "x,y"}, "sensor_axes"),
        ({"sensor_axes": "x,y,-z"}, "left-handed"),
        ({"sensor_axes": "x,x,z"}, "at right angles"),
        ({"sensor_axes": "1,0,0,0,1,0,0,0"}, "nine numbers"),
        ({"attitude_deg": (0.0, 95.0, 0.0)}, "beyond 80 deg"),
        ({"attitude_deg": (0.0, 5.0)}, "roll, pitch, yaw"),
        ({"tether": "sideways"}, '"down" or "up"'),
        ({"calibration": "best"}, "calibration must be none, auto, bias, full"),
        ({"steady_s": 0.0}, "steady_s must be a number"),
        ({"reeled": True}, 'needs method "kalman"; got "harmonic"'),
    ],
)
def test_arguments_are_refused_in_words(given, words):
    with pytest.raises(InputError, match=words):
        fl.estimate_skiprope(flight(200).telemetry, sample_orbit(), **({"tether_length_m": LENGTH_M} | given))


def test_an_orbit_or_positions_are_needed():
    with pytest.raises(InputError, match="no orbit"):
        fl.estimate_skiprope(flight(200).telemetry, tether_length_m=LENGTH_M)
    telemetry = flight().telemetry
    position = sample_orbit().position_e(telemetry.time_utc)
    own = telemetry_of(telemetry.time_utc, telemetry.field_s, position_e=position)
    by_positions = fl.estimate_skiprope(own, tether_length_m=LENGTH_M)
    by_orbit = estimate(flight())
    assert by_positions.plane_rad.values == pytest.approx(by_orbit.plane_rad.values, abs=1e-4)


@pytest.mark.parametrize("method", METHODS)
def test_too_little_gives_no_estimate(method):
    with pytest.raises(NoEstimateError, match="samples with a field"):
        estimate(flight(20), method=method)
    with pytest.raises(NoEstimateError, match=r"0\.8 periods of 0\.0049 Hz"):
        estimate(flight(80), method=method, frequency_hz=0.0049)  # 160 s
    found = estimate(flight(80), method=method)
    assert found.attrs["usable"] == 0
    assert "slower than 15.8 mHz would not be seen" in found.attrs["verdict_json"]


def test_a_field_of_another_size_or_direction_is_refused_with_what_would_fit():
    telemetry = flight().telemetry
    with pytest.raises(NoEstimateError, match=r"0\.50 times the model's"):
        half = telemetry_of(telemetry.time_utc, 0.5 * telemetry.field_s)
        fl.estimate_skiprope(half, sample_orbit(), tether_length_m=LENGTH_M)
    swapped = telemetry_of(telemetry.time_utc, telemetry.field_s @ ORBITAL_FROM_CONE)
    with pytest.raises(NoEstimateError, match='With --sensor-axes="x,-y,-z" it would be'):
        fl.estimate_skiprope(swapped, sample_orbit(), tether_length_m=LENGTH_M)
    late = telemetry_of(telemetry.time_utc + np.timedelta64(1800, "s"), telemetry.field_s)
    with pytest.raises(NoEstimateError, match=r"time stamps \(UTC\)"):
        fl.estimate_skiprope(late, sample_orbit(), tether_length_m=LENGTH_M)


@pytest.mark.parametrize("method", METHODS)
def test_without_a_skiprope_the_answer_is_that_there_is_none(method):
    found = estimate(flight(skiprope_frequency_hz=0.0, pendulous_deg=(1.0, 1.0)), method=method)
    verdict = json.loads(found.attrs["verdict_json"])
    assert found.attrs["usable"] == 0 and verdict["exit_code"] == 1 and not verdict["detected"]
    assert found.sizes["time"] == 0 and "no skiprope" in found.attrs["verdict"].lower()
    assert 0.0 < verdict["threshold_deg"] < 0.2 and verdict["false_alarm"] == 0.01


def test_a_skiprope_below_the_band_is_hinted_at_and_found_when_asked_for():
    record = flight(3000, 2.0, skiprope_frequency_hz=0.0016)
    blind = json.loads(estimate(record, tether_length_m=2e3).attrs["verdict_json"])
    assert not blind["detected"] and "say --frequency-hz 0.0016" in blind["warnings"][-1]
    asked = estimate(record, tether_length_m=2e3, frequency_hz=0.0016)
    assert np.degrees(asked.amplitude_rad.values[-1]) == pytest.approx(0.6, rel=0.1)
    long = estimate(record, tether_length_m=20e3)  # which can be as slow as that
    assert long.frequency_hz.values[-1] == pytest.approx(0.0016, rel=0.02)


def test_planes_by_word_and_number():
    assert plane_of("Orbit").azimuth_deg == -90.0 and plane_of(12).azimuth_deg == 12.0 and plane_of("field").azimuth_deg is None
