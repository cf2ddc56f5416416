"""The command line: exit codes, messages, files, and what goes to which stream.

The estimator is replaced by one that returns a finished estimate; what it was asked is what these tests look at.
"""

import json
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

import fieldline.estimation
import fieldline.report
from fieldline.cli import main
from fieldline.errors import NoEstimateError

DATA = Path(str(files("fieldline"))) / "data"
SAMPLE, ELEMENTS = DATA / "suchai3_2023-08-24.csv", DATA / "suchai3.tle"


@pytest.fixture
def asked(monkeypatch, plain_estimate, tmp_path):
    """What the estimator was called with; the current folder is a new one, and the report, tested elsewhere, is a word."""
    calls = {}

    def estimate_attitude(telemetry, orbit, **settings):
        calls.update(settings, telemetry=telemetry, orbit=orbit)
        settings["progress"]("refine", 1, 2)
        settings["progress"]("refine", 2, 2, "two of two")
        return plain_estimate

    monkeypatch.setattr(fieldline.estimation, "estimate_attitude", estimate_attitude, raising=False)
    monkeypatch.setattr(fieldline.report, "report_html", lambda estimate: "report")
    monkeypatch.chdir(tmp_path)
    return calls


def replace_estimator(monkeypatch, action):
    """Let the estimator end by an exception or return a value."""

    def estimate_attitude(*_, **__):
        if isinstance(action, BaseException):
            raise action
        return action

    monkeypatch.setattr(fieldline.estimation, "estimate_attitude", estimate_attitude, raising=False)


def attitude(*options):
    return main(["attitude", str(SAMPLE), "--orbit", str(ELEMENTS), *options])


def visible(folder):
    return sorted(path.name for path in Path(folder).iterdir())


def test_four_files_are_written_and_named(asked, tmp_path, capsys):
    assert attitude("--out", "flight") == 0
    assert visible(tmp_path) == ["flight.aem", "flight.csv", "flight.html", "flight.nc"]
    out, err = capsys.readouterr()
    assert out.splitlines()[0].startswith("Usable: attitude within 2 to 3 deg")
    assert "attitude 1σ 1.9° 2.9° 1.7° · rate 1σ 0.02 0.018 0.023 °/s · residual 1 µT · NIS 0.98 (consistent)" in out
    assert "wrote flight.nc, flight.csv, flight.aem, flight.html" in out
    assert "5,586 samples, 2023-08-24 14:44:09 to 16:17:28 UTC" in err
    assert "refine" in err and "two of two" in err and "wrote" not in err


def test_the_columns_that_may_be_used_are_the_estimators():
    from fieldline.cli.attitude import USES
    from fieldline.estimation import estimate

    assert set(USES) == set(estimate.USES)


def test_the_settings_reach_the_estimator(asked):
    options = "--model wmm2025 --use gyro --calibration bias --seed 7 --inertia 0.03,0.03,0.006 --quiet"
    assert attitude(*options.split()) == 0
    assert (asked["model"], asked["use"], asked["calibration"], asked["seed"]) == ("wmm2025", ("gyro",), "bias", 7)
    assert np.array_equal(asked["inertia_kg_m2"], np.diag([0.03, 0.03, 0.006]))


def test_the_default_stem_does_not_replace_the_telemetry(asked, tmp_path):
    (tmp_path / "flight.csv").write_bytes(SAMPLE.read_bytes())
    assert main(["attitude", "flight.csv", "--orbit", str(ELEMENTS), "--quiet"]) == 0
    assert "flight_attitude.csv" in visible(tmp_path)
    assert (tmp_path / "flight.csv").read_bytes() == SAMPLE.read_bytes()
    assert main(["attitude", "flight.csv", "--orbit", str(ELEMENTS), "--out", "flight"]) == 2


def test_the_report_may_go_elsewhere(asked, tmp_path):
    assert attitude("--out", "a.nc", "--report", "b.html", "--quiet") == 0
    assert visible(tmp_path) == ["a.aem", "a.csv", "a.nc", "b.html"]


def test_figures_on_request(asked, tmp_path):
    assert attitude("--out", "a", "--figures", "--quiet") == 0
    assert "field.png" in visible(tmp_path / "a_figures")


def test_quiet_is_quiet(asked, capsys):
    assert attitude("--quiet") == 0
    assert capsys.readouterr() == ("", "")


def test_json_is_alone_on_stdout(asked, capsys, plain_estimate):
    assert attitude("--json") == 0
    assert json.loads(capsys.readouterr().out) == json.loads(plain_estimate.attrs["verdict_json"])


def test_an_estimate_that_is_not_usable_is_written_and_ends_with_1(asked, monkeypatch, tmp_path, capsys, make_estimate):
    replace_estimator(monkeypatch, make_estimate(samples=60, usable=False))
    assert attitude("--out", "a") == 1
    assert len(visible(tmp_path)) == 4
    assert capsys.readouterr().out.startswith("Not usable")


@pytest.mark.parametrize(
    "action, code, words",
    [
        (NoEstimateError("the field does not turn."), 1, "the field does not turn"),
        (KeyboardInterrupt(), 130, "interrupted"),
        (ZeroDivisionError("division by zero"), 70, "a fault in Fieldline itself (ZeroDivisionError: division by zero)"),
    ],
)
def test_every_end_has_a_code_and_a_sentence(asked, monkeypatch, tmp_path, capsys, action, code, words):
    replace_estimator(monkeypatch, action)
    assert attitude("--out", "a", "--quiet") == code
    assert visible(tmp_path) == []
    err = capsys.readouterr().err
    assert words in err and "Traceback" not in err and err.count("\n") == 1


def test_debug_shows_the_fault(asked, monkeypatch):
    replace_estimator(monkeypatch, ZeroDivisionError())
    with pytest.raises(ZeroDivisionError):
        attitude("--debug")


@pytest.mark.parametrize("stop", [KeyboardInterrupt(), OSError(28, "No space left on device")])
def test_a_stop_while_writing_leaves_nothing_new(asked, monkeypatch, tmp_path, stop):
    def stopped(_):
        raise stop

    (tmp_path / "a.csv").write_text("from before")
    monkeypatch.setattr(fieldline.report, "report_html", stopped)
    assert attitude("--out", "a", "--quiet") == (130 if isinstance(stop, KeyboardInterrupt) else 2)
    assert visible(tmp_path) == ["a.csv"]
    assert (tmp_path / "a.csv").read_text() == "from before"


@pytest.mark.parametrize(
    "options, words",
    [
        (["--calibration", "ful"], 'did you mean "full"?'),
        (["--use", "gyrro"], 'did you mean "gyro"?'),
        (["--modle", "IGRF-14"], "--model"),
        (["--out", "nowhere/a"], 'the folder "nowhere" does not exist'),
        (["--out", "."], "is a folder"),
        (["--mag-columns", "a,b"], "--mag-columns needs the three columns"),
        (["--inertia", "1,2"], "--inertia needs three or six numbers"),
        (["--inertia", "1,1,3"], "none exceeds the sum of the others"),
        (["--inertia", "1,nan,3"], "--inertia"),
        (["--seed", "-1"], "--seed"),
        (["--eop", "missing.txt"], "missing.txt"),
        (["--max-orbit-age-days", "ten"], "--max-orbit-age-days"),
    ],
)
def test_bad_options_end_with_2_and_say_why(asked, tmp_path, capsys, options, words):
    assert attitude(*options) == 2
    assert words in capsys.readouterr().err
    assert visible(tmp_path) == []


@pytest.mark.parametrize(
    "arguments, words",
    [
        ([], "Usage"),
        (["atitude"], "attitude"),
        (["attitude"], "telemetry"),
        (["attitude", "missing.csv", "--orbit", str(ELEMENTS)], "missing.csv"),
        (["attitude", str(SAMPLE)], "an orbit is needed"),
        (["attitude", str(SAMPLE), "--orbit", "missing.tle"], "missing.tle"),
        (["field"], "--latitude-deg, --longitude-deg, --time"),
        (["field", "--latitude-deg", "95", "--longitude-deg", "0", "--time", "2024-01-01"], "between -90 and 90"),
        (["field", "--latitude-deg", "5", "--longitude-deg", "0", "--time", "yesterday"], "--time"),
        (["field", "--latitude-deg", "5", "--longitude-deg", "0", "--time", "1850-10-14"], "1900"),
        (["field", "--latitude-deg", "5", "--longitude-deg", "0", "--time", "2024-01-01", "--model", "IGRF14x"], "IGRF-14"),
        (["field", "--orbit", str(ELEMENTS), "--start", "2023-08-24"], "--stop, --out"),
        (["case", "natanson_1991"], "natanson_1990"),
        (["case", "natanson_1990", "--set", "stepp_s=1"], 'did you mean "step_s"?'),
        (["case", "natanson_1990", "--set", "step_s"], "KEY=VALUE"),
        (["case", "natanson_1990", "--set", "step_s=1..2"], "TOML"),
    ],
)
def test_bad_commands_end_with_2_and_say_why(monkeypatch, tmp_path, capsys, arguments, words):
    monkeypatch.chdir(tmp_path)
    code = main(arguments)
    out, err = capsys.readouterr()
    assert code == 2
    assert words in out + err
    assert visible(tmp_path) == []


def test_doubts_are_told_on_the_terminal(asked, monkeypatch, capsys, make_estimate):
    replace_estimator(monkeypatch, make_estimate(samples=60))
    assert attitude("--out", "flight") == 0
    said = capsys.readouterr().out
    assert "Doubt: sun-sensor hits on -x, -z: 91.2 %" in said
    assert "the sun sensors disagree on 9 % of the samples" in said


def test_a_full_disk_is_told_by_the_name_that_was_asked_for(asked, monkeypatch, tmp_path, capsys):
    import xarray

    def full(*_, **__):
        raise RuntimeError("NetCDF: HDF error")

    (tmp_path / "flight.nc").write_text("old")
    monkeypatch.setattr(xarray.Dataset, "to_netcdf", full)
    assert attitude("--out", "flight", "--quiet") == 2
    said = capsys.readouterr().err
    assert 'could not write "flight.nc"' in said
    assert "disk is full" in said
    assert "?." not in said
    assert visible(tmp_path) == ["flight.nc"]
    assert (tmp_path / "flight.nc").read_text() == "old"


def test_version(capsys):
    assert main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("fieldline 0.")


def test_models_are_listed(capsys):
    assert main(["models"]) == 0
    assert "IGRF-14              1900 to 2030 (forecast from 2025)" in capsys.readouterr().out


@pytest.mark.kernels
def test_the_field_at_a_place(capsys):
    # NOAA's test values of WMM2025 (2024), first row: 2025.0, height 0 km, latitude 80, longitude 0.
    place = "--latitude-deg 80 --longitude-deg 0 --time 2025-01-01 --model WMM2025 --json"
    assert main(["field", *place.split()]) == 0
    values = json.loads(capsys.readouterr().out)
    assert [values[k] for k in ("north_nT", "east_nT", "down_nT")] == pytest.approx([6521.6, 145.9, 54791.5], abs=0.05)


@pytest.mark.kernels
def test_the_field_along_an_orbit(tmp_path, capsys):
    out = tmp_path / "field.csv"
    span = "--start 2023-08-24T12:00:00 --stop 2023-08-24T12:01:00 --step-s 20"
    assert main(["field", "--orbit", str(ELEMENTS), *span.split(), "--out", str(out)]) == 0
    rows = out.read_text().splitlines()
    assert (
        rows[0] == "time_utc,latitude_deg,longitude_deg,altitude_km,field_x_itrs_nT,field_y_itrs_nT,field_z_itrs_nT,magnitude_nT"
    )
    assert [row.split(",")[0] for row in rows[1:]] == [f"2023-08-24T12:0{t}.000Z" for t in ("0:00", "0:20", "0:40", "1:00")]


@pytest.mark.kernels
def test_a_case_is_rerun_with_other_numbers(tmp_path, monkeypatch):
    import xarray

    monkeypatch.chdir(tmp_path)
    settings = ["--set", "step_s=120.0", "--set", "choice=robust", "--set", "rate_deg_s=[0.0, 0.05, 0.0]"]
    assert main(["case", "natanson_1990", *settings, "--out", "n", "--quiet"]) == 0
    assert visible(tmp_path) == ["n.nc", "n.png"]
    with xarray.open_dataset("n.nc") as dataset:
        assert json.loads(dataset.attrs["settings_json"])["choice"] == "robust"


def test_the_demo_makes_its_folder(asked, tmp_path, capsys):
    assert main(["demo"]) == 0
    assert "suchai3_2023-08-24.html" in visible(tmp_path / "fieldline-demo")
    assert f"open {tmp_path / 'fieldline-demo' / 'suchai3_2023-08-24'}.html" in capsys.readouterr().out
