"""Runs in lanes are the plant's own runs, to rounding; and what the lanes do not cover is left to the plant."""

import numpy as np
import pytest

from ensemble_scenario import TABLE
from fieldline.dynamics.rates import turn_rate
from fieldline.frames.attitude import quat_exp
from fieldline.simulate.ensemble.coverage import alike, block_of, covered
from fieldline.simulate.ensemble.lane_loop import fly_lanes
from fieldline.simulate.ensemble.lanes import LANES, small_turn, small_turn_rate
from fieldline.simulate.flight import Flight
from fieldline.simulate.loop.records import Outcome
from fieldline.simulate.scenario import Scenario

pytestmark = [pytest.mark.kernels, pytest.mark.flight]

# Two ways of rounding one sum: parts in 1e15 of a step, a thousand times that after some hundred steps of a tumble.
NEAR = {"rtol": 0.0, "atol": 1e-11}


def scenario(**changes):
    return Scenario.from_dict(TABLE, "scenario").replace(**changes)


def plain(kernel):
    """An inner kernel of the plant, which has no way in from Python, as Python."""
    return getattr(kernel, "py_func", kernel)


def in_lanes(*flights):
    block = block_of(flights)
    while not fly_lanes(1000, *block):
        pass
    return block.progress


@pytest.mark.parametrize("size", [0.0, 1e-6, 1e-3, 0.1, 0.6, 1.0])
def test_series_of_a_small_turn_are_exact_to_rounding(size):
    sigma = tuple(size * np.array([0.48, -0.6, 0.64]))
    omega = (0.3, -0.2, 0.7)
    np.testing.assert_allclose(small_turn(sigma), quat_exp(sigma), rtol=0.0, atol=3e-16)
    np.testing.assert_allclose(small_turn_rate(sigma, omega), plain(turn_rate)(sigma, omega), rtol=0.0, atol=4e-16)


def test_runs_of_different_satellites_in_one_block_are_those_of_the_plant():
    changes = [
        {},
        {"body.0.rate_deg_s": [-20.0, 4.0, 9.0], "body.0.inertia_kg_m2": [0.02, 0.02, 0.005]},
        {"body.0.residual_dipole_a_m2": [0.0, 0.0, 0.0], "body.0.gravity_gradient": False},
        {"orbit.elements.inclination_deg": 30.0, "body.0.magnetorquer.1.moment_max_a_m2": 0.01},
        {"software.0.parameters": {"gain_n_m_s": 3e-4}},
    ]
    flights = [Flight(scenario(**change)) for change in changes]
    progress = in_lanes(*flights)
    for n, flight in enumerate(flights):
        flight.fly()
        assert flight.outcome == Outcome.DONE == progress.outcome[n]
        rows = slice(0, int(flight.clock.rows[0]))
        np.testing.assert_array_equal(progress.seconds, flight.record.seconds[rows])
        np.testing.assert_allclose(progress.state[n, :, :6], flight.record.state[rows, :6], rtol=1e-13)
        np.testing.assert_allclose(progress.state[n, :, 6:], flight.record.state[rows, 6:], **NEAR)
        np.testing.assert_allclose(progress.dipole[n], flight.record.actuators[rows], **NEAR)
    assert np.abs(progress.dipole[0]).max() == 0.1  # the limit was reached, so it is tested


def test_a_rate_that_falls_ends_a_run_when_the_plant_says_so():
    event = [{"kind": "rate", "rate_deg_s": 9.85, "direction": "falling", "stop": True}]
    flight = Flight(scenario(event=event))
    progress = in_lanes(flight)
    flight.fly()
    assert flight.outcome == Outcome.STOPPED == progress.outcome[0]
    assert progress.ended[0] == pytest.approx(flight.clock.t[0], abs=5e-3)  # a straight line in a step of 0.5 s
    rows = int(flight.clock.rows[0]) - 1  # the plant also keeps the state in which it stopped
    assert np.isfinite(progress.state[0, :rows]).all() and np.isnan(progress.state[0, rows:]).all()


def test_a_step_too_coarse_ends_one_run_and_no_other():
    flights = [Flight(scenario()), Flight(scenario())]
    flights[1].start[10] = flights[1].y[10] = 2.6  # [rad/s], 1.3 rad a step: no scenario may start so
    progress = in_lanes(*flights)
    flights[1].fly()
    assert flights[1].outcome == Outcome.COARSE == progress.outcome[1]
    assert progress.outcome[0] == Outcome.DONE and np.isfinite(progress.state[0]).all()


@pytest.mark.parametrize(
    "change",
    [
        {"body.0.magnetometer.noise_std_nt": 10.0},
        {"body.0.magnetometer.rate_hz": 2.0},
        {"body.0.magnetorquer.0.axis_b": [1, 1, 0]},
        {"body.0.magnetorquer.0.time_constant_s": 0.1},
        {"software.0.law": "b-dot-bang-bang"},
        {"software.0.delay_s": 0.1},
        {"software.0.parameters": {"low_pass_s": 3.0}},
        {"environment.gravity": "harmonic"},
        {"integrator.method": "dop853"},
        {"integrator.field_update": "step"},
        {"time.output_step_s": 2.5},
        {"body.0.eddy_damping_n_m_s_tesla2": [10.0, 10.0, 10.0]},
        {"event": [{"kind": "eclipse"}]},
    ],
    ids=str,
)
def test_what_the_lanes_do_not_know_is_not_covered(change):
    assert covered(Flight(scenario()))
    assert not covered(Flight(scenario(**change)))


def test_runs_that_share_too_little_are_not_alike():
    first = Flight(scenario())
    assert alike(first, Flight(scenario(**{"body.0.rate_deg_s": [1.0, 1.0, 1.0]})))
    assert not alike(first, Flight(scenario(**{"time.start_utc": "2026-03-02T00:00:00Z"})))
    assert not alike(first, Flight(scenario(**{"environment.field_degree": 3})))
    assert LANES > 1
