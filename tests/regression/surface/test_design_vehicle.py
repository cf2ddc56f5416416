"""`fieldline design conductor`, `fieldline design vehicle` and the cases of the 1992 thesis from the command line."""

import json

import numpy as np
import pytest

from fieldline.analysis.vehicle_survey import vehicle_survey
from fieldline.cases import CASES, case_named
from fieldline.cli import main
from fieldline.design import tank_with_towers
from fieldline.errors import InputError
from fieldline.report.case_figure import case_figure

CLIMB = "design conductor --mass-kg 50000 --low-km 300 --high-km 460 --days 30".split()


def test_conductor(capsys):
    assert main(CLIMB) == 0
    out = capsys.readouterr().out
    assert "1.754 N" in out and "29.07 to 325.9 kW" in out and "note: at 5 m the current's own field is 0.22" in out
    assert main([*CLIMB, "--neighbour-m", "50", "--plasma-ohm", "2,2", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["cautions"] == [] and found["power_w"][0] == found["power_w"][1]
    assert found["thrust_n"] == pytest.approx(1.754, abs=1e-3)


@pytest.mark.kernels
def test_vehicle(capsys, tmp_path):
    stem = tmp_path / "tank"
    assert main(["design", "vehicle", "--inclinations-deg", "28.5,78.5", "--out", str(stem)]) == 0
    out = capsys.readouterr().out
    assert out.count("yes") == 1 and "not always" in out.splitlines()[-4 if "wrote" in out else -3]
    assert "37,870 kg, 6,570 of it towers" in out and "grows e-fold in 537 s" in out
    assert (tmp_path / "tank.png").stat().st_size > 5000 and (tmp_path / "tank.nc").exists()
    assert main(["design", "vehicle", "--no-thruster", "--inclinations-deg", "0,80", "--json"]) == 0
    rows = json.loads(capsys.readouterr().out)["inclinations"]
    assert rows[0]["least_margin"] > 1e-2 and rows[0]["hold"] < 1e-12
    assert rows[1]["least_margin"] < 1e-5


@pytest.mark.kernels
def test_margins_vanish_where_the_field_across_does():
    survey = vehicle_survey(tank_with_towers(), 4e5, np.radians([28.5, 57.0, 60.0, 90.0]), arguments=24, nodes=12)
    least = survey["least_margin"].values
    assert least[0] > 0.1 and least[1] > 1e-3  # the field across vanishes from 58.2 deg on
    assert (least[2:] < 1e-5).all()
    assert (survey["hold"].values[:2] > 1e-3).all()
    assert (survey["margin"].min("argument_deg").values >= least - 1e-12).all()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["design", "vehicle", "--design", "3"], "design must be 1"),
        (["design", "vehicle", "--vertical-m", "0"], "vertical_m must be a positive number"),
        (["design", "vehicle", "--inclinations-deg", "0,x"], "--inclinations-deg needs angles"),
        (["design", "vehicle", "--inclinations-deg", "270"], "angles from 0 to 180"),
        (["design", "vehicle", "--altitude-km", "1"], "altitude_m must lie between"),
        (["design", "vehicle", "--date", "soon"], "--date needs a day"),
        (["design", "vehicle", "--model", "igrf99"], "igrf99"),
        ([*CLIMB, "--plasma-ohm", "one"], "--plasma-ohm needs two resistances"),
        ([*CLIMB, "--field-nt", "0"], "--field-nt must lie between"),
        ([*CLIMB, "--current-a", "-1"], "current_a must be a positive number"),
    ],
)
def test_bad_input(options, words, capsys):
    assert main(options) == 2
    assert words in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize("places", [(0, 5), (400, 400)])
def test_too_many_or_too_few_places(places):
    with pytest.raises(InputError, match="arguments and nodes must be 1 or more"):
        vehicle_survey(tank_with_towers(), 4e5, [0.1], arguments=places[0], nodes=places[1])


def test_cases_have_figures():
    for name in CASES:
        if name.startswith("afit_1992"):
            dataset = case_named(name)()
            assert dataset.attrs["case"] == name
            assert all("units" in dataset[one].attrs or "long_name" in dataset[one].attrs for one in dataset.data_vars), name
            assert len(case_figure(dataset).axes) >= 1


def test_a_case_by_its_name(tmp_path, capsys):
    assert main(["case", "afit-1992-lqr", "--set", "case=v-bar", "--set", "steps=4", "--out", str(tmp_path / "v")]) == 0
    assert (tmp_path / "v.nc").exists() and (tmp_path / "v.png").exists()
