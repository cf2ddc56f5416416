"""Every template flies: two minutes of each, to the end and with finite signals."""

from functools import cache

import numpy as np
import pytest

import fieldline as fl
from fieldline.report.run_numbers import run_numbers
from fieldline.report.simulation_report import simulation_html
from fieldline.simulate.scenario.templates import TEMPLATES, template

SHORT = {"time.duration_orbits": None, "time.duration_s": 120.0, "time.output_step_s": 10.0}


FINE_STEPS = ("picosatellite", "detumble", "chain", "tss1r", "deorbit-tape", "microsat-pair")  # too many for plain Python
NAMES = [
    pytest.param(name, marks=() if name in FINE_STEPS else (pytest.mark.kernels, pytest.mark.flight))
    for name in sorted(TEMPLATES)
]


@cache
def flight(name):
    """(scenario, what was flown)."""
    scenario = fl.Scenario.from_toml(template(name, name)).replace(**SHORT)
    return scenario, fl.simulate(scenario)


@pytest.mark.parametrize("name", NAMES)
def test_a_template_flies(name):
    scenario, flown = flight(name)
    assert flown.attrs["complete"] == 1, flown.attrs["outcome"]
    assert flown.sizes["time"] == 13 and flown.sizes["body"] == len(scenario.body)
    for signal in ("position_i", "velocity_i", "field_i"):
        assert np.isfinite(flown[signal].values).all(), signal


@pytest.mark.parametrize("name", sorted(TEMPLATES))
def test_a_flights_report_and_numbers_are_made(name):
    _, flown = flight(name)
    numbers = run_numbers(flown)
    assert set(numbers["bodies"]) <= set(flown["body"].values) and numbers["outcome"] == flown.attrs["outcome"]
    assert "</html>" in simulation_html(flown)
