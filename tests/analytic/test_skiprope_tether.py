"""What is known of the tether besides its length: where its skiprope can be, lengths that change, the satellite's swing."""

from dataclasses import replace

import numpy as np
import pytest

from fieldline.errors import InputError, NoEstimateError
from fieldline.estimation.skiprope import SkipropeSignals, detect, estimate_skiprope, skiprope_signals
from fieldline.estimation.skiprope.line_band import LOWEST_HZ, line_band, line_frequency
from fieldline.estimation.skiprope.reeled import PIECE_S, STEP_S, estimate_reeled, piece_starts
from fieldline.estimation.skiprope.rotary import BAND_HZ, Line, cone_of
from fieldline.estimation.skiprope_telemetry import SkipropeSettings, TetherLengths, read_tether_lengths
from fieldline.estimation.skiprope_telemetry.tether import swing_taken_off
from skiprope_flights import START

N = 1.157e-3  # rad/s at 300 km
RATIO_M = 520.0 / 8.35e-3


def turning(hz, seconds, tilt_deg=0.6, swing=None):
    """Signals of a round cone whose phase is the integral of hz (n,), in a field that turns as along an orbit, 20 nT of noise."""
    turn = 1.1e-3 * seconds
    known = 3e-5 * np.stack([np.sin(turn), np.cos(turn), 0.8 * np.cos(0.5 * turn + 0.4)], axis=-1)
    phase = 2.0 * np.pi * np.concatenate([[0.0], np.cumsum(0.5 * (hz[1:] + hz[:-1]) * np.diff(seconds))])
    lean = np.radians(tilt_deg) * np.stack([np.cos(phase), np.sin(phase), 0.0 * phase], axis=-1)
    if swing is not None:
        lean[:, 0] += np.radians(0.5) * np.cos(2.0 * np.pi * swing * seconds)
    noise = 2e-8 * np.random.default_rng(4).standard_normal(known.shape)
    return skiprope_signals(seconds, known - np.cross(lean, known) + noise, known)


@pytest.mark.parametrize(("length_m", "hz"), [(2400.0, 5.13e-3), (20000.0, 1.90e-3)])
def test_the_frequency_of_flown_lines(length_m, hz):
    """Of the lines of docs/gallery/skiprope_flight.md, which the plant flew."""
    assert line_frequency(length_m, N, RATIO_M) == pytest.approx(hz, rel=0.01)
    low, high = line_band(length_m, N, RATIO_M)
    assert low < hz < high < 2.0 * low


def test_a_band_goes_down_with_the_length_and_no_further_than_can_be_told():
    lows = [line_band(length, N)[0] for length in (1e3, 5e3, 1e4, 2e4, 1e5)]
    assert lows[0] == BAND_HZ[0] and lows == sorted(lows, reverse=True) and lows[-1] == LOWEST_HZ
    assert all(line_band(length, N)[1] == BAND_HZ[1] for length in (1e3, 1e5))
    librations = np.array([1.0, np.sqrt(3.0), 2.0]) * N / (2.0 * np.pi)
    assert (librations < 0.5 * LOWEST_HZ).all()


def test_a_slow_line_must_be_larger_than_errors_of_the_field():
    seconds = np.arange(0.0, 6000.0, 2.0)
    for tilt, heard in ((0.04, False), (0.12, True)):
        found = detect(turning(np.full(3000, 0.0017), seconds, tilt), band_hz=(LOWEST_HZ, 0.02))
        assert (found.cone is not None) is heard


@pytest.mark.parametrize(("weak_deg", "expected"), [(0.02, 0.005), (0.2, 0.015)])
def test_a_weak_mode_above_a_swing_is_not_the_skiprope(weak_deg, expected):
    swings, turns = Line(0.005, np.radians(0.2), 0.05, 1e3), Line(0.015, np.radians(weak_deg), 0.8, 1e2)
    assert cone_of([swings, turns]).frequency_hz == expected


def test_lengths_that_change_are_followed():
    seconds = np.arange(0.0, 9000.0, 2.0)
    length = np.interp(seconds, [0.0, 9000.0], [8000.0, 3000.0])
    hz = line_frequency(length, N, RATIO_M)
    found = estimate_reeled(turning(hz, seconds), length, mean_motion_rad_s=N, ratio_m=RATIO_M, yaw_rad=0.0)
    assert found.trusted.mean() > 0.7 and (np.diff(found.seconds) > 0.0).all()
    at = found.seconds
    assert found.frequency_hz == pytest.approx(np.interp(at, seconds, hz), rel=0.02)
    assert found.deflection_m == pytest.approx(np.radians(0.6) * np.interp(at, seconds, length) / np.pi, rel=0.03)
    assert (found.sense == 1).all() and "followed while 8 km of tether became 3 km" in found.verdict
    blind = estimate_reeled(turning(hz, seconds), length, mean_motion_rad_s=N, yaw_rad=0.0)  # no masses: a light line
    assert blind.frequency_hz == pytest.approx(np.interp(blind.seconds, seconds, hz), rel=0.02)


def test_nothing_and_too_little_on_the_reel():
    seconds = np.arange(0.0, 6000.0, 2.0)
    still = turning(np.full(3000, 0.004), seconds, 0.0)
    found = estimate_reeled(still, np.linspace(5e3, 4e3, 3000), mean_motion_rad_s=N)
    assert not found.detected and len(found.seconds) == 0
    short = SkipropeSignals(seconds[:40], still.field_b[:40], type(still.geometry)(*(x[:40] for x in still.geometry)))
    with pytest.raises(NoEstimateError):
        estimate_reeled(short, 5e3, mean_motion_rad_s=N)


@pytest.mark.parametrize("span", [100.0, PIECE_S, PIECE_S + STEP_S, 20000.0])
def test_pieces_cover_the_record(span):
    starts = piece_starts(50.0, 50.0 + span)
    assert starts[0] == 50.0 and np.allclose(np.diff(starts), STEP_S)
    assert 50.0 + span - (starts[-1] + PIECE_S) < STEP_S + 1e-6


def test_the_swing_is_taken_off_the_deflection_alone():
    seconds = np.arange(0.0, 6000.0, 2.0)
    found = estimate_skiprope(turning(np.full(3000, 0.005), seconds, swing=0.025), tether_length_m=2400.0)
    told, words = swing_taken_off(found, 0.025)
    heard, more = swing_taken_off(found, "found")
    assert told.deflection_m == pytest.approx(0.96 * found.deflection_m, rel=1e-3)
    assert heard.deflection_m == pytest.approx(told.deflection_m, rel=2e-3)
    assert (told.amplitude_rad == found.amplitude_rad).all() and "4.2 % further" in words[0] and "25 mHz" in more[0]
    assert swing_taken_off(found, None) == (found, ())
    quiet = replace(found, detection=found.detection._replace(others=()))
    assert "No swing" in swing_taken_off(quiet, "found")[1][0]
    with pytest.raises(InputError, match="below twice"):
        swing_taken_off(found, 0.008)


def test_lengths_are_read_and_refused(tmp_path):
    path = tmp_path / "reel.csv"
    path.write_text("time_utc,length_km\n1992-08-04T12:00:00Z,2.5\nodd,\n1992-08-04T12:01:00Z,2.4\n")
    lengths = read_tether_lengths(path)
    assert lengths.at(START + np.array([-9, 30, 99]).astype("timedelta64[s]")) == pytest.approx([2500.0, 2450.0, 2400.0])
    path.write_text("time_utc,width\n1992-08-04T12:00:00Z,2.5\n")
    with pytest.raises(InputError, match="length_m"):
        read_tether_lengths(path)
    path.write_text("time_utc,length_m\n1992-08-04T12:00:00Z,2.5\n")
    with pytest.raises(InputError, match="two are needed"):
        read_tether_lengths(path)
    with pytest.raises(InputError, match="no such file"):
        read_tether_lengths(tmp_path / "none.csv")
    with pytest.raises(InputError, match="rise"):
        TetherLengths(START + np.array([1, 0]).astype("timedelta64[s]"), np.array([1.0, 2.0]))
    with pytest.raises(InputError, match="1 to 1e6"):
        TetherLengths(START + np.array([0, 1]).astype("timedelta64[s]"), np.array([0.0, 2.0]))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"end_mass_kg": 5.0}, "give both"),
        ({"end_mass_kg": -5.0, "tether_kg_m": 1e-3}, "end_mass_kg"),
        ({"swing": "fast"}, "swing"),
        ({"swing": -1.0}, "swing"),
    ],
)
def test_settings_that_cannot_be(given, words):
    with pytest.raises(InputError, match=words):
        SkipropeSettings(tether_length_m=1e3, **given)
