"""A flexible line that skips: its middle found from the satellite's magnetometer, and taken out by the yaw that follows.

The scenarios and the planner's use of them are those of docs/gallery/skiprope_flight.py.
"""

import importlib.util
import sys
from pathlib import Path

import pytest

import fieldline as fl

SCRIPT = Path(__file__).parents[2] / "docs" / "gallery" / "skiprope_flight.py"


@pytest.fixture(scope="module")
def study():
    spec = importlib.util.spec_from_file_location("skiprope_flight", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    sys.modules["skiprope_flight"] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules["skiprope_flight"]


def test_the_middle_of_a_flexible_line_is_found(study):
    given = study.SHORT | {"nodes": 10, "duration_s": 3000.0}
    run, place = study.fly(study.scenario(**given))
    estimate = fl.estimate_skiprope(study.telemetry(run), tether_length_m=given["length_m"])
    plain = study.errors(estimate, run, place)
    mended = study.errors(estimate, run, place, study.swing_gain(estimate, study.swing_hz(run)))
    assert plain["sense"] == -1 and plain["plane_sd_deg"] < 2.0 and abs(plain["plane_mean_deg"]) < 3.0
    assert 2.0 < plain["deflection_percent"] < 7.0  # the satellite swings further than its tether
    assert abs(mended["deflection_percent"]) < 2.0 and mended["radius_m"] < 0.05 * mended["true_m"]


def test_the_yaw_that_is_planned_takes_it_out(study):
    given = study.SHORT | {"nodes": 10, "duration_s": 3600.0}
    done = study.damped(given, 2200.0)
    assert done["before_m"] == pytest.approx(6.0, abs=0.3) and done["after_m"] < 0.8
    wrong = study.damped(given, 2200.0, azimuth_error_deg=180.0)
    assert wrong["after_m"] > 1.7 * wrong["before_m"]  # the other way round it feeds the skiprope
