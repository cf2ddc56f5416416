"""Every template flies: two minutes of each, to the end and with finite signals."""

import numpy as np
import pytest

import fieldline as fl
from fieldline.simulate.scenario.templates import TEMPLATES, template

SHORT = {"time.duration_orbits": None, "time.duration_s": 120.0, "time.output_step_s": 10.0}


FINE_STEPS = ("picosatellite", "detumble", "chain", "tss1r", "deorbit-tape", "microsat-pair")  # too many for plain Python
NAMES = [
    pytest.param(name, marks=() if name in FINE_STEPS else (pytest.mark.kernels, pytest.mark.flight))
    for name in sorted(TEMPLATES)
]


@pytest.mark.parametrize("name", NAMES)
def test_a_template_flies(name):
    scenario = fl.Scenario.from_toml(template(name, name)).replace(**SHORT)
    flown = fl.simulate(scenario)
    assert flown.attrs["complete"] == 1, flown.attrs["outcome"]
    assert flown.sizes["time"] == 13 and flown.sizes["body"] == len(scenario.body)
    for signal in ("position_i", "velocity_i", "field_i"):
        assert np.isfinite(flown[signal].values).all(), signal
