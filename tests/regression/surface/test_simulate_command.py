"""`fieldline simulate`: files, words, streams and exit codes, whole and broken off; and its telemetry."""

import json
import re
import sys
import time
from importlib import import_module
from types import SimpleNamespace

import numpy as np
import pytest
import xarray

import fieldline as fl
from fieldline.cli import main
from fieldline.errors import InputError
from fieldline.simulate.as_telemetry import telemetry_of_run
from fieldline.simulate.scenario import Scenario
from fieldline.telemetry.telemetry_csv import write_telemetry_csv
from simulated_runs import EVERYTHING, LAWS, TUMBLE, with_law


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder of one's own with the scenarios and the laws that they name."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "law.py").write_text(LAWS)
    (tmp_path / "short.toml").write_text(TUMBLE.replace("duration_s = 11400.0", "duration_s = 400.0"))
    for law in ("fails", "stopped", "fails_at_once"):
        (tmp_path / f"{law}.toml").write_text(with_law(law))
    return tmp_path


def visible(folder):
    return sorted(path.name for path in folder.iterdir() if path.suffix in {".nc", ".html", ".csv"})


def test_files_summary_and_streams(folder, capsys):
    assert main(["simulate", "short.toml", "--out", "a", "--as-telemetry", "flight.csv"]) == 0
    assert visible(folder) == ["a.html", "a.nc", "flight.csv"]
    out, err = capsys.readouterr()
    assert out.splitlines()[0] == "tumble: 0.1111 h from 2026-03-01T00:00:00Z, flown to its end, 400 s."
    assert re.search(r"^satellite: rate 2\.69 → 2\.\d+ °/s$", out, re.MULTILINE)
    assert out.splitlines()[-1] == "wrote a.nc, a.html, flight.csv"
    assert "flying" in err and "writing" in err and "wrote" not in err


def test_the_stem_is_the_scenarios_with_run(folder):
    assert main(["simulate", "short.toml", "--quiet"]) == 0
    assert visible(folder) == ["short_run.html", "short_run.nc"]


def test_quiet_says_nothing_and_the_report_may_go_elsewhere(folder, capsys):
    assert main(["simulate", "short.toml", "--out", "a", "--report", "b.html", "--figures", "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")
    assert visible(folder) == ["a.nc", "b.html"]
    assert {"rates.png", "rates.svg"} <= {path.name for path in (folder / "a_figures").iterdir()}


def test_json_is_alone_on_stdout(folder, capsys):
    assert main(["simulate", "short.toml", "--out", "a", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["complete"] is True and told["files"] == ["a.nc", "a.html"]
    assert told["bodies"]["satellite"]["rate_start_deg_s"] == pytest.approx(np.sqrt(7.25))


def test_the_seed_changes_the_run(folder):
    for name, seed in (("a", "5"), ("b", "5"), ("c", "6")):
        assert main(["simulate", "short.toml", "--out", name, "--seed", seed, "--quiet"]) == 0
    a, b, c = (xarray.load_dataset(f"{name}.nc") for name in "abc")
    assert a.identical(b) and not np.array_equal(a["q_bi"], c["q_bi"])


@pytest.mark.parametrize(
    "name, code, words",
    [
        ("fails", 2, ("raised ValueError: no field today", "kept, marked partial: fails_run.nc, fails_run.html")),
        ("stopped", 130, ("interrupted", "kept, marked partial: stopped_run.nc, stopped_run.html")),
    ],
)
def test_a_run_that_breaks_off_keeps_what_it_has(folder, capsys, name, code, words):
    assert main(["simulate", f"{name}.toml", "--quiet", "--as-telemetry", "t.csv"]) == code
    assert visible(folder) == [f"{name}_run.html", f"{name}_run.nc"]
    out, err = capsys.readouterr()
    assert out == "" and all(one in err for one in words) and "Traceback" not in err
    kept = xarray.load_dataset(f"{name}_run.nc")
    assert kept.attrs["complete"] == 0 and 290.0 <= float(kept["seconds"][-1]) <= 310.0
    page = (folder / f"{name}_run.html").read_text()
    assert '<div class="verdict refused"' in page and '<p class="state">Partial</p>' in page


def test_a_run_that_fails_at_once_leaves_no_files(folder, capsys):
    assert main(["simulate", "fails_at_once.toml"]) == 2
    assert visible(folder) == []
    assert "at t = 0 s" in capsys.readouterr().err


@pytest.mark.parametrize(
    "options, words",
    [
        (["--body", "satellite"], "--as-telemetry FILE.csv"),
        (["--as-telemetry", "a.csv", "--body", "satelite"], 'did you mean "satellite"?'),
        (["--as-telemetry", "a.nc"], "ends in .csv"),
        (["--as-telemetry", "no/a.csv"], 'the folder "no" does not exist'),
        (["--report", "no/a.html"], 'the folder "no" does not exist'),
        (["--out", "no/a"], 'the folder "no" does not exist'),
        (["--report", "short.toml"], "would replace an input"),
    ],
)
def test_what_cannot_be_written_is_refused_before_the_flight(folder, capsys, monkeypatch, options, words):
    monkeypatch.setattr("fieldline.simulate.run.simulate", None)  # a flight would fail
    assert main(["simulate", "short.toml", *options]) == 2
    assert words in capsys.readouterr().err


def test_telemetry_needs_a_magnetometer(folder, capsys):
    text = re.sub("^magnetometer = .*$", "", (folder / "short.toml").read_text(), flags=re.MULTILINE)
    (folder / "blind.toml").write_text(text)
    assert main(["simulate", "blind.toml", "--as-telemetry", "a.csv"]) == 2
    assert "no body has a magnetometer" in capsys.readouterr().err


@pytest.mark.parametrize("compiling", [True, False])
def test_compiling_is_told_of_while_it_lasts(monkeypatch, compiling):
    plant = SimpleNamespace(fly=SimpleNamespace(is_compiling=compiling))
    monkeypatch.setitem(sys.modules, "fieldline.simulate.loop.fly", plant)
    module = import_module("fieldline.cli.simulate")
    monkeypatch.setattr(module, "COMPILING_AFTER_S", 0.01)
    told = []
    with module._told_of_compiling(lambda *words: told.append(words)):
        time.sleep(0.2)
    assert told == ([("compiling the plant", 1, 1, "once; it takes about a minute")] if compiling else [])


@pytest.fixture(scope="module")
def everything():
    return fl.simulate(Scenario.from_toml(EVERYTHING))


def test_netcdf_gives_the_run_back(everything, tmp_path):
    from fieldline.telemetry import write_attitude_netcdf

    write_attitude_netcdf(everything, tmp_path / "a.nc")
    back = xarray.load_dataset(tmp_path / "a.nc")
    assert back.identical(everything)
    assert back.sizes["event"] > 0 and back["event_direction"].dtype == np.int8


def test_telemetry_is_what_the_sensors_said(everything):
    telemetry = telemetry_of_run(everything)
    assert np.array_equal(telemetry.field_s, everything["magnetometer_main"].values)
    assert np.array_equal(telemetry.rate_b, everything["gyro_main"].values)
    assert set(telemetry.sun_sensor) == {"+x", "-x", "+y", "-y", "+z", "-z"}
    read = np.isfinite(telemetry.sun_sensor["+x"])
    assert np.array_equal(telemetry.sun_sensor["+x"][read], everything["sun_sensor_main"].values[:, 0])
    assert np.array_equal(read, np.arange(len(telemetry)) % 2 == 0)  # half as often as the magnetometer
    assert telemetry.dipole_command_b is None and "dipole left out" in telemetry.ignored[0]


def test_the_position_between_outputs_is_the_true_one(everything):
    """A sensor at 1 Hz among outputs 2 s apart, against the distance from the Earth's centre in between."""
    telemetry = telemetry_of_run(everything)
    here = np.linalg.norm(telemetry.position_e, axis=1)
    there = np.linalg.norm(everything["position_i"].values[:, 0], axis=1)
    at_outputs = here[::2]
    assert np.allclose(at_outputs, there[: len(at_outputs)], atol=1e-3)
    bend = here[2:-2:2] - here[1:-3:2] / 2 - here[3:-1:2] / 2
    assert np.abs(bend).max() < 0.1  # [m] a quarter of the radius' acceleration, 0.02 m/s2


def test_the_dipole_is_told_where_outputs_are_dense_enough(tmp_path):
    (tmp_path / "law.py").write_text(LAWS)
    text = with_law("steady", rate_hz=0.1)
    (tmp_path / "a.toml").write_text(text)
    telemetry = telemetry_of_run(fl.simulate(tmp_path / "a.toml"))
    late = telemetry.seconds > 110.0
    assert np.allclose(telemetry.dipole_command_b[late], [0.0, -0.05, 0.0])
    assert np.allclose(telemetry.dipole_command_b[(telemetry.seconds > 10.0) & (telemetry.seconds < 100.0)], [0.0, 0.1, 0.0])


def test_telemetry_of_an_unknown_body_is_refused(everything):
    with pytest.raises(InputError, match='did you mean "main"'):
        telemetry_of_run(everything, "man")
    with pytest.raises(InputError, match='the body "end" has no magnetometer'):
        telemetry_of_run(everything, "end")


def test_a_simulated_day_is_estimated_from_its_telemetry(tmp_path):
    """Two orbits of a free tumble, the magnetometer off in bias and scale, no orbit file: the truth is met, and bounded."""
    from tests_support import nees

    run = fl.simulate(Scenario.from_toml(TUMBLE))
    path = write_telemetry_csv(telemetry_of_run(run), tmp_path / "flight.csv")
    estimate = fl.estimate_attitude(fl.read_telemetry(path), degree=8)
    truth = run.sel(body="satellite")
    assert np.array_equal(estimate["time"], truth["time"])
    error = np.degrees(np.linalg.norm(_error(truth, estimate), axis=1))
    second = truth["seconds"].values > 5700.0
    assert error[second].max() < 1.0
    assert np.sqrt(np.mean(error[second] ** 2)) < 0.3
    assert 0.05 < nees(_Truth(truth["q_bi"].values), estimate) < 2.0
    rate = np.degrees(np.linalg.norm(estimate["omega_bi_b"].values - truth["omega_bi_b"].values, axis=1))
    assert np.median(rate) < 0.005


class _Truth:
    """What `nees` asks of a flight."""

    def __init__(self, q_bi):
        self.q_bi = q_bi


def _error(truth, estimate):
    from fieldline.frames.attitude import rotation_error_b

    return rotation_error_b(truth["q_bi"].values, estimate["q_bi"].values)
