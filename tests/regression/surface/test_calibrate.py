"""`fieldline calibrate` and `fl.calibrate` on the flown sample: files, several flights, and the way back in."""

import json
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

import fieldline as fl
from fieldline.cli import main
from fieldline.errors import InputError
from fieldline.estimation.calibration_file import calibrations_to_json, nearest_in_time, read_calibrations

DATA = Path(str(files("fieldline"))) / "data"
SAMPLE, ELEMENTS = DATA / "suchai3_2023-08-24.csv", DATA / "suchai3.tle"


@pytest.fixture(scope="module")
def flown():
    whole = fl.read_telemetry(SAMPLE)
    return whole.slice(0, 2800), whole.slice(2800, None)


@pytest.fixture(scope="module")
def halves(flown):
    return fl.calibrate(flown, fl.read_orbit(ELEMENTS), calibration="full+gain")


def test_flights_calibrated_together_share_bias_and_matrix(halves):
    first, second = halves
    assert np.array_equal(first.bias_s, second.bias_s) and np.array_equal(first.matrix, second.matrix)
    # Known of this sensor: bias near (+100, -30, -28.5) microtesla, 0.5 to 0.7 microtesla left with a gain.
    assert first.bias_s * 1e6 == pytest.approx([100.0, -29.5, -28.6], abs=1.5)
    assert max(one.residual_rms_tesla for one in halves) < 0.7e-6


def test_each_flight_keeps_its_own_gain_on_the_common_clock(halves, flown):
    first, second = halves
    assert first.epoch_utc == second.epoch_utc == flown[0].epoch_utc
    assert first.gain_knots_s[-1] <= second.gain_knots_s[0]
    applied = second.apply(flown[1].seconds, flown[1].field_s, epoch_utc=flown[1].epoch_utc)
    assert np.linalg.norm(applied, axis=1).max() < 60e-6


def test_a_file_of_several_calibrations_comes_back_and_serves_by_time(halves, flown, tmp_path):
    path = tmp_path / "both.json"
    path.write_text(calibrations_to_json(halves))
    back = read_calibrations(path)
    assert [one.values.tolist() for one in back] == [one.values.tolist() for one in halves]
    for number, telemetry in enumerate(flown):
        assert nearest_in_time(back, telemetry.time_utc) is back[number]


@pytest.mark.parametrize("text", ["", "not json", "[]", "{}", '{"schema": "fieldline-calibrations"}', '{"schema": 3}'])
def test_a_file_that_is_no_calibration_is_refused(tmp_path, text):
    path = tmp_path / "x.json"
    path.write_text(text)
    with pytest.raises(InputError, match=r"x\.json"):
        read_calibrations(path)


def test_the_clock_scan_is_reported_and_not_applied(flown):
    orbit = fl.read_orbit(ELEMENTS)
    found = fl.calibrate(flown[0], orbit, calibration="full", clock_scan=True)
    assert found.clock is not None and not found.clock.applied
    assert "Clock scan" in found.sentences[-1]


def test_columns_that_are_not_there_are_refused(flown):
    with pytest.raises(InputError, match="no column that was recognised"):
        fl.calibrate(flown[0], fl.read_orbit(ELEMENTS), use=("temperature",))
    with pytest.raises(InputError, match='did you mean "temperature"'):
        fl.calibrate(flown[0], fl.read_orbit(ELEMENTS), use=("temprature",))
    with pytest.raises(InputError, match="one for each"):
        fl.calibrate(flown, [fl.read_orbit(ELEMENTS)])


def test_the_command_writes_the_file_and_the_page(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["calibrate", str(SAMPLE), "--orbit", str(ELEMENTS), "--calibration", "full", "--json"]) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["model"] == "full"
    assert summary["rms_nt"] == pytest.approx(1960.0, abs=250.0)  # what nine parameters leave of this file
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "suchai3_2023-08-24_calibration.html",
        "suchai3_2023-08-24_calibration.json",
    ]
    assert read_calibrations("suchai3_2023-08-24_calibration.json")[0].model == "full"


def test_an_unknown_model_of_the_sensor_is_refused(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["calibrate", str(SAMPLE), "--orbit", str(ELEMENTS), "--calibration", "fll", "--quiet"]) == 2
    assert 'did you mean "full"?' in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
