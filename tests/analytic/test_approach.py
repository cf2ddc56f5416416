"""A run seen from its first body: place and rate in turning axes, the cone of a way, what currents cost."""

import numpy as np
import pytest
import xarray as xr
from numpy.testing import assert_allclose

import fieldline as fl
from fieldline.simulate.approach import corridor_deg, relative_motion_h

N, RADIUS = 1.1e-3, 6.8e6


def run_of(place_h, rate_h):
    """A Dataset of two bodies on a circle, the second at places and rates (n, 3) in the first's turning axes."""
    t = np.arange(len(place_h)) * 10.0
    c, s, zero = np.cos(N * t), np.sin(N * t), 0.0 * t
    up, along = np.column_stack([c, s, zero]), np.column_stack([-s, c, zero])
    dcm_ih = np.stack([up, along, np.broadcast_to([0.0, 0.0, 1.0], up.shape)], axis=2)
    place = np.einsum("nij,nj->ni", dcm_ih, place_h)
    rate = np.einsum("nij,nj->ni", dcm_ih, rate_h) + np.cross([0.0, 0.0, N], place)
    first, speed = RADIUS * up, N * RADIUS * along
    dims = ("time", "body", "axis")
    return xr.Dataset(
        {
            "position_i": (dims, np.stack([first, first + place], axis=1)),
            "velocity_i": (dims, np.stack([speed, speed + rate], axis=1)),
        }
    )


def test_places_and_rates_come_back():
    rng = np.random.default_rng(4)
    place, rate = 100.0 * rng.normal(size=(20, 3)), 0.1 * rng.normal(size=(20, 3))
    found = relative_motion_h(run_of(place, rate), 1)
    assert_allclose(found[0], place, atol=1e-8)
    assert_allclose(found[1], rate, atol=1e-10)


def test_the_cone_holds_the_way():
    along = np.linspace(30.0, 0.0, 200)
    way = np.column_stack([np.tan(np.radians(5.0)) * along * np.sin(along), along, 0.0 * along])
    way[0, 0] = 0.0
    assert corridor_deg(way) == pytest.approx(5.0, abs=0.1)
    assert corridor_deg(np.column_stack([0.0 * along, along, 0.0 * along])) == pytest.approx(0.0, abs=1e-9)
    assert corridor_deg(np.full((10, 3), 7.0)) == 0.0  # a body that stands


@pytest.mark.kernels
@pytest.mark.flight
def test_what_a_hold_costs_and_what_is_refused():
    from fieldline.simulate.scenario.templates import template

    scenario = fl.Scenario.from_toml(template("v-bar", "way")).replace(**{"time.duration_s": 200.0, "time.output_step_s": 2.0})
    run = fl.simulate(scenario)
    seen = fl.approach(run)
    current = run["conductor_current"].values
    resistance = np.array([one.resistance_ohm for one in scenario.body[1].conductor])
    assert_allclose(float(seen["heat_j"]), np.trapezoid(current**2 @ resistance, run["seconds"].values), rtol=1e-12)
    assert_allclose(seen["charge_c"].values, np.trapezoid(np.abs(current), run["seconds"].values, axis=0), rtol=1e-12)
    assert (seen["peak_share"].values <= 1.0).all() and seen.attrs["target"] == "target"
    assert_allclose(seen["place_h_m"].values[0], [0.0, 100.0, 0.0], atol=1e-6)
    with pytest.raises(fl.InputError, match='no body "vehicel" beside the first; did you mean "vehicle"'):
        fl.approach(run, "vehicel")
    names = {picture.name for picture in simulation_pictures(run)}
    assert {"approach_2", "place_2", "currents_2", "energy_2"} <= names


def simulation_pictures(run):
    """The figures of the report."""
    from fieldline.report.simulation_report import simulation_figures

    return simulation_figures(run)
