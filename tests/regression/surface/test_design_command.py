"""`fieldline design coil` and the cases of the 1961 study from the command line."""

import json
import re

import numpy as np
import pytest
import xarray as xr

from fieldline.cases import CASES, case_named
from fieldline.cli import main
from fieldline.errors import InputError

OBSERVATORY = "design coil --torque-n-m 5e-4 --field-nt 10000 --diameter-m 2.44 --current-a 0.1 --wire AWG29".split()
ROD = "design coil --moment-a-m2 10 --core rod --core-length-m 0.5 --core-diameter-m 0.012".split()


def test_a_table_for_people(capsys):
    assert main(OBSERVATORY) == 0
    out, err = capsys.readouterr()
    for words in ("107", "AWG29", "2.199 W", "0.4682 kg", "10,000 nT"):
        assert words in out
    assert err == ""


def test_a_record_for_programs(capsys):
    assert main([*ROD, "--wire", "AWG30", "--power-w", "0.5", "--insulation-mm", "0.02", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["power_w"] == pytest.approx(0.5, rel=2e-3)
    assert record["insulation_m"] == pytest.approx(2e-5)
    assert record["core_gain"] > 100.0 and record["core_tesla"] < record["core_saturation_tesla"]


def test_the_page_stands_alone(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main([*OBSERVATORY, "--out", "oao"]) == 0
    assert "wrote oao.html, oao.nc" in capsys.readouterr().out
    page = (tmp_path / "oao.html").read_text(encoding="utf-8")
    assert "<svg" in page and "AWG29" in page and "2.199 W" in page
    assert not re.search(r"""(?:src|href)=["']https?:""", page)
    with xr.open_dataset(tmp_path / "oao.nc") as curve:
        assert float(curve["power_w"].max()) > 10.0 > float(curve["power_w"].min())
        assert curve["mass_kg"].attrs["units"] == "kg"


def test_the_gauge_table(capsys):
    assert main("design wire --first 29 --last 30".split()) == 0
    assert "AWG29" in (out := capsys.readouterr().out) and "0.2685" in out and out.count("\n") == 3
    assert main("design wire --material aluminium --temperature-c 60 --first -3 --last -3 --json".split()) == 0
    (row,) = json.loads(capsys.readouterr().out)
    assert row["name"] == "AWG4/0" and row["diameter_m"] == pytest.approx(11.684e-3)
    assert row["resistance_ohm_per_m"] * row["area_m2"] == pytest.approx(2.8264e-8 * (1.0 + 40.0 * 4.03e-3))


def test_quiet_is_quiet(capsys):
    assert main([*OBSERVATORY, "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("design coil", "--moment-a-m2"),
        ("design coil --moment-a-m2 -5 --diameter-m 1", "--moment-a-m2 must be a positive number"),
        ("design coil --moment-a-m2 5 --diameter-m 1 --wire AWG29", "leaves the coil open"),
        ("design coil --moment-a-m2 5 --diameter-m 1 --wire AWG29 --voltage-v 5", "wire and --voltage-v"),
        ("design coil --moment-a-m2 5 --diameter-m 1 --wire 2.5mm --turns 9", "no gauge"),
        ("design coil --torque-n-m 5e-4 --field-nt 1e7 --diameter-m 1", "--field-nt must lie between"),
        ("design coil --moment-a-m2 5 --sides-m 3 --turns 9 --wire AWG29", "--sides-m needs two lengths"),
        ("design coil --moment-a-m2 5 --diameter-m 1 --turns 9 --wire AWG29 --material tin", "unknown material"),
        ("design coil --moment-a-m2 5 --diameter-m 1 --turns 9 --wire AWG29 --out no/such", "does not exist"),
        ("design coil --moment-a-m2 five", "--moment-a-m2"),
        ("design coils", "coil"),
        ("design wire --first 9 --last 3", "first"),
        ("case ames-1961-feild", 'did you mean "ames_1961_field"'),
        ("case ames-1961-field --set inclination=3", 'did you mean "inclination_deg"'),
        ("case ames-1961-field --set inclination_deg=300", "inclination_deg"),
    ],
)
def test_bad_input_ends_in_2_with_a_sentence(words, told, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(words.split()) == 2
    out, err = capsys.readouterr()
    assert told in err and err.count("\n") == 1
    assert out == "" and not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("name", "settings", "variable"),
    [
        ("ames-1961-field", ["duration_s=6000.0"], "normalised_s"),
        ("ames_1961_pointing", ["field_ratio=0.01", "duration_s=60.0"], "sensor"),
        ("ames-1961-dump", ["orbits=0.5", "momentum=[1.0, 0.0, 0.0]"], "fraction"),
        ("ames-1961-coil", ["wire=AWG25"], "power_w"),
        ("ames-1961-observatory", ["duration_s=600.0", "roll=free"], "along_line"),
    ],
)
def test_a_case_writes_its_signals_and_its_figure(name, settings, variable, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    options = [word for one in settings for word in ("--set", one)]
    assert main(["case", name, *options, "--out", "c", "--quiet"]) == 0
    with xr.open_dataset(tmp_path / "c.nc") as dataset:
        assert np.isfinite(dataset[variable]).all()
        assert all("units" in dataset[one].attrs for one in dataset.data_vars)
        assert json.loads(dataset.attrs["settings_json"]) and "1961" in dataset.attrs["source"]
    assert (tmp_path / "c.png").stat().st_size > 10_000


def test_every_case_is_there():
    for name in CASES:
        assert callable(case_named(name)) and case_named(name) is case_named(name.replace("_", "-"))
    with pytest.raises(InputError, match="there is no case"):
        case_named("ames")
