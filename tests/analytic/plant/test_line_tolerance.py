"""The error that a step of the implicit method is allowed where none is given: small against what stretches the lines."""

import numpy as np
import pytest

import fieldline as fl
import tether_flights as tf
from fieldline.simulate.flight import Flight
from fieldline.simulate.scenario.line_stiffness import fastest_along, held_by_rk4
from fieldline.simulate.scenario.line_tolerance import allowed, least_stretch
from fieldline.simulate.scenario.summary import summary
from fieldline.simulate.scenario.templates import template

LINE = {"name": "rope", "from_body": "near", "to_body": "far", "mass_per_length_kg_m": 1e-3}
TAPE = {"rest_length_m": 500.0, "stiffness_n": 69e3, "nodes": 4}


def scenario(*lines, **integrator):
    """14 and 7.5 kg, 600 km up."""
    far = {"name": "far", "kind": "point", "mass_kg": 7.5, "offset_o_m": [0.0, 0.0, 400.0]}
    return fl.Scenario.from_dict(
        {
            "time": {"start_utc": "2026-03-01T00:00:00Z", "duration_s": 10.0, "output_step_s": 1.0},
            "orbit": {"elements": {"altitude_km": 600.0, "inclination_deg": 51.6}},
            "environment": {"gravity": "point"},
            "integrator": {"method": "rosenbrock", **integrator},
            "body": [{"name": "near", "kind": "point", "mass_kg": 14.0}, far],
            "line": [LINE | line for line in lines],
        },
        "tolerance",
    )


def test_the_stretch_is_that_of_the_line_at_rest():
    """Against the radii of a line of nodes at rest, which tell its tension; its middle segments bear most."""
    line = {"rest_length_m": 500.0, "stiffness_n": 100.0, "nodes": 4, "mass_per_length_kg_m": 1e-9}
    one = scenario(line)
    rate = np.sqrt(3.986004418e14 / 6978.137e3**3)
    rest = fl.tether_modes(500.0, 1e-9, 100.0, 7.5, 14.0, 600e3, 4)
    assert least_stretch(one, one.line[0], rate) == pytest.approx(float(rest.tension.values.mean()), rel=1e-3)  # 100 m, 100 N


@pytest.mark.parametrize(
    ("lines", "position", "relative"),
    [
        ([], 1e-4, 1e-12),
        ([TAPE | {"stiffness_n": 50.0}], 1e-4, 1e-12),  # 17 cm a segment
        ([TAPE], 1.26e-7, 1.8e-14),
        ([TAPE | {"nodes": 40}], 1e-7, 1.43e-14),  # 1.5 micrometres: bounded
        ([TAPE | {"stiffness_n": 50.0}, TAPE | {"stiffness_n": 3e4, "name": "stay"}], 2.9e-7, 4.14e-14),
    ],
    ids=["none", "soft", "tape", "tape-of-many", "two"],
)
def test_the_default(lines, position, relative):
    found = allowed(scenario(*lines))
    assert found == (pytest.approx(relative, rel=0.05), pytest.approx(position, rel=0.05))


def test_what_is_given_stays_and_other_methods_do_not_look():
    assert allowed(scenario(TAPE, position_tolerance_m=2e-3)) == (1e-12, 2e-3)
    assert allowed(scenario(TAPE, relative_tolerance=1e-11))[0] == 1e-11
    assert allowed(scenario(TAPE, method="dop853")) == (1e-9, 1e-3)


def test_a_flight_takes_it_and_the_summary_tells_it():
    tape = fl.Scenario.from_toml(template("deorbit-tape", "tape")).replace(**{"integrator.method": "rosenbrock"})
    relative, position = allowed(tape)
    assert position == pytest.approx(1.2e-7, rel=0.02)
    stepping = Flight(tape).stepping
    assert stepping.relative == relative and stepping.absolute[0] == position
    assert "error of a step 1.2e-07 m" in summary(tape)


@pytest.mark.parametrize(("segments", "told"), [(10, 6.11), (20, 12.34), (50, 30.94), (100, 61.9)])
def test_the_fastest_oscillation_along_a_line(segments, told):
    """Of an independent code."""
    one = tf.hung(segments - 1, seconds=10.0, output=1.0, step=0.001, damping_n_s=0.05 * tf.STIFFNESS_N)
    rate, step = fastest_along(one, 0)
    assert rate == pytest.approx(told, rel=1e-3)
    assert step == held_by_rk4(rate, 0.05)


def grown(rate, lag_s, step_s, steps=4000):
    """How much larger a damped oscillation is after so many steps of the classical rule, by the powers of its matrix."""
    oscillator = np.array([[0.0, 1.0], [-(rate**2), -lag_s * rate**2]]) * step_s
    square = oscillator @ oscillator
    one = np.eye(2) + oscillator + square / 2.0 + square @ oscillator / 6.0 + square @ square / 24.0
    scale = np.diag([1.0, 1.0 / rate])
    return np.linalg.norm(scale @ np.linalg.matrix_power(one, steps) @ np.linalg.inv(scale))


@pytest.mark.parametrize("lag_times_rate", [0.0, 0.01, 0.3, 1.0, 1.5, 1.9, 2.0, 2.5, 5.0, 100.0])
def test_the_longest_step_of_rk4_is_the_last_that_holds_every_oscillation(lag_times_rate):
    fastest = 31.0
    lag_s = lag_times_rate / fastest
    step = held_by_rk4(fastest, lag_s)
    rates = np.linspace(0.01, 1.0, 100) * fastest
    assert max(grown(rate, lag_s, step) for rate in rates) < 10.0
    assert max(grown(rate, lag_s, 1.01 * step) for rate in rates) > 1e3


def test_without_damping_and_with_much_the_limits_are_those_of_the_axes():
    assert held_by_rk4(7.0, 0.0) == pytest.approx(np.sqrt(8.0) / 7.0, rel=2e-3)
    assert held_by_rk4(7.0, 200.0) == pytest.approx(2.785293563405282 / (200.0 * 49.0), rel=2e-3)
