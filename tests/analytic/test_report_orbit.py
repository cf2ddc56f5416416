"""The figure of a changed orbit: means of an orbit, which runs have it, what it says."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fieldline as fl
from fieldline.report.run_orbit_figures import orbit_mean
from fieldline.report.simulation_report import simulation_figures
from fieldline.simulate.scenario.templates import template


def test_a_mean_of_an_orbit_leaves_the_climb_and_takes_the_swing():
    seconds = np.linspace(0.0, 20_000.0, 801)
    climb, swing = 7e6 + 0.05 * seconds, 4e3 * np.cos(2.0 * np.pi * seconds / 2500.0)
    mean = orbit_mean(seconds, climb + swing, 5000.0)
    seen = np.isfinite(mean)
    assert seconds[seen][[0, -1]] == pytest.approx([2500.0, 17_500.0])
    assert_allclose(mean[seen], climb[seen], atol=0.5)


@pytest.fixture(scope="module")
def flown():
    scenario = fl.Scenario.from_toml(template("orbit-change", "climb")).replace(
        **{"time.duration_s": 12_000.0, "time.output_step_s": 60.0}
    )
    return fl.simulate(scenario)


def test_a_run_that_changes_its_orbit_shows_height_and_inclination(flown):
    pictures = {picture.name: picture for picture in simulation_figures(flown)}
    panels = pictures["orbit"].figure.axes
    assert [panel.get_title(loc="left") or panel.get_title() for panel in panels] == [
        "height of the semi-major axis",
        "inclination",
    ]
    mean = panels[0].lines[1].get_ydata()
    assert 0.2 < mean[-1] - mean[0] < 0.5  # km in 1.8 hours, a third of them in the dark
    assert "Wanted: 460 km." in pictures["orbit"].caption and "deg a day" in pictures["orbit"].caption


def test_a_run_without_the_law_has_none(flown):
    scenario = fl.Scenario.from_toml(flown.attrs["scenario_toml"])
    still = fl.simulate(scenario.replace(software=[]))
    assert "orbit" not in {picture.name for picture in simulation_figures(still)}
