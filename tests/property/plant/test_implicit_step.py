"""Flights by the implicit method against DOP853, at tight tolerances of both; its order, its cost, its manners in a snap."""

import time
from itertools import pairwise

import numpy as np
import pytest

import plant_flights as pf
from plant_flights import law, torquers, wheels
from plant_loads import AXES, LIGHT, ROD

TRUTH = {
    "method": "dop853",
    "relative_tolerance": 1e-13,
    "position_tolerance_m": 1e-7,
    "velocity_tolerance_m_s": 1e-9,
    "angle_tolerance_rad": 1e-11,
    "rate_tolerance_rad_s": 1e-12,
}
LOOSE = {"relative_tolerance": 1e-2, "position_tolerance_m": 1e6, "angle_tolerance_rad": 1e3}


def implicit(tolerance, **more):
    """The method at a tolerance of place [m], and a thousandth of it in angle [rad]."""
    return {
        "method": "rosenbrock",
        "relative_tolerance": 1e-13,
        "position_tolerance_m": tolerance,
        "angle_tolerance_rad": 1e-3 * tolerance,
    } | more


def fixed(step):
    """Steps of one length, whatever the error."""
    return {"method": "rosenbrock", "step_s": step, "step_max_s": step, **LOOSE}


def hanging(nodes=5, seconds=60.0, length=20e3, damping=1.6e4, skiprope=20.0, lower=None, **tables):
    """A body that turns, 20 km below a heavier one, on a line with nodes that swings and swirls: 40 N, stretched by 3 m."""
    line = {
        "name": "tether",
        "from_body": "below",
        "from_point_b_m": (0.02, -0.01, -0.3),
        "to_body": "above",
        "to_point_b_m": (0.1, 0.0, 0.4),
        "rest_length_m": length,
        "stiffness_n": 3.2e5,
        "damping_n_s": damping,
        "nodes": nodes,
    }
    if nodes:
        line |= {"mass_per_length_kg_m": 0.00835, "start": {"skiprope_amplitude_m": skiprope}}
    above = pf.body("above", mass_kg=9000.0, inertia_kg_m2=(8e3, 1.2e4, 1e4), rate_deg_s=(0.1, -0.3, 0.2))
    below = pf.body("below", mass_kg=500.0, inertia_kg_m2=(120.0, 90.0, 100.0), rate_deg_s=(0.5, -0.4, 1.0))
    below |= {"hang": {"in_plane_deg": 15.0, "out_of_plane_deg": 5.0}}
    line |= tables.pop("line", {})
    above |= tables.pop("upper", {})
    return pf.scenario(above, below | (lower or {}), seconds=seconds, line=[line], **tables)


def flown(chosen):
    flight = pf.Flight(chosen)
    outcome = flight.fly()
    assert outcome.name in ("DONE", "STOPPED"), outcome
    return flight


def apart(one, other):
    """Largest difference of places [m] and of attitudes of both bodies [-] over all rows."""
    (seconds, mine), (same, theirs) = pf.rows(one), pf.rows(other)
    np.testing.assert_allclose(seconds, same, atol=1e-6)
    bodies = np.abs(mine - theirs).reshape(-1, 13)
    nodes = np.abs(pf.rest(one) - pf.rest(other))
    tail = nodes[:, : 6 * sum(line.nodes for line in one.scenario.line)].reshape(len(nodes), -1, 6)
    place = max(bodies[:, :3].max(), tail[:, :, :3].max(initial=0.0))
    return place, bodies[:, 6:10].max()


@pytest.mark.parametrize("nodes", [0, 5, 20, 50])
def test_it_agrees_with_an_explicit_method(nodes):
    """Both bodies turn, nodes swing and swirl: to the tolerance."""
    mine = flown(hanging(nodes, integrator=implicit(1e-5)))
    place, attitude = apart(mine, flown(hanging(nodes, integrator=TRUTH)))
    assert place < 2e-5 and attitude < 5e-5


def test_its_order_is_three():
    truth = flown(hanging(5, integrator=TRUTH))
    errors = [apart(flown(hanging(5, integrator=fixed(step))), truth) for step in (0.25, 0.125, 0.0625)]
    for rough, fine in pairwise(errors):
        assert np.log2(np.array(rough) / fine) == pytest.approx([3.0, 3.0], abs=0.25)


def test_steps_of_twenty_seconds_stay_on_the_swing():
    """Where explicit steps are held below 0.2 s: bodies without levers, a line of 20 nodes, half an orbit."""
    point = {"kind": "point", "inertia_kg_m2": None, "rate_deg_s": None, "attitude": None}
    middle = {"from_point_b_m": (0.0, 0.0, 0.0), "to_point_b_m": (0.0, 0.0, 0.0)}
    more = {"seconds": 2400.0, "lower": point, "upper": point, "line": middle, "damping": 1.6e5}
    fine = flown(hanging(20, integrator=implicit(1e-4), **more))
    rough = flown(hanging(20, integrator=fixed(20.0), **more))
    assert apart(rough, fine)[0] < 0.5
    assert rough.clock.steps[0] == 120


def test_the_state_within_a_step_is_as_good_as_at_its_ends():
    """Rows twice a second out of steps of half of one to one second."""
    mine, truth = (flown(hanging(5, output=0.5, integrator=one)) for one in (implicit(1e-2), TRUTH))
    assert mine.clock.steps[0] < 200
    place, attitude = apart(mine, truth)
    assert place < 0.01 and attitude < 1e-3
    speeds = [pf.rows(one)[1][:, :, 3:6] for one in (mine, truth)]
    assert np.abs(speeds[0] - speeds[1]).max() < 2e-3


def test_an_event_within_a_step_is_found_where_it_is():
    watched = [{"kind": "rate", "name": "turns fast", "body": "below", "rate_deg_s": 2.0, "direction": "rising", "stop": True}]
    mine, truth = (flown(hanging(5, event=watched, integrator=one)) for one in (implicit(1e-4), TRUTH))
    assert mine.outcome.name == truth.outcome.name == "STOPPED"
    assert mine.clock.t[0] == pytest.approx(truth.clock.t[0], abs=2e-4)


def test_it_goes_with_all_else_that_the_plant_has():
    """Wheels, torquers that lag, rods, a thruster, air, light, sensors and three laws, on the body that hangs."""
    thruster = {"position_b_m": (0.1, 0.2, 0.0), "direction_b": (0.0, 0.6, 0.8), "force_n": 0.05}
    lower = {
        "magnetorquer": torquers(time_constant_s=0.3),
        "wheel": wheels(momentum_n_m_s=0.5),
        "thruster": [thruster],
        "gravity_gradient": True,
        "residual_dipole_a_m2": (0.1, 0.2, -0.1),
        "solar_pressure": LIGHT,
        "hysteresis_rod": [ROD | {"axis_b": axis} for axis in AXES],
        "magnetometer": {"rate_hz": 1.0},
        "gyro": {"rate_hz": 1.0},
    }
    tasks = [
        law("wave", parameters=(1e4, 1e-3, 0.1)) | {"name": "magnetic", "body": "below"},
        law("steady", ("wheel_torque",), (1e-3, -2e-3, 1e-3), delay_s=0.7) | {"name": "wheels", "body": "below"},
        law("steady", ("thrust",), (0.3,), rate_hz=0.25) | {"name": "jets", "body": "below"},
    ]
    more = {"lower": lower, "software": tasks, "environment": {"gravity": "j2", "field_degree": 4}, "seconds": 20.0}
    mine, truth = (flown(hanging(5, integrator=one, **more)) for one in (implicit(1e-5), TRUTH))
    place, attitude = apart(mine, truth)
    assert place < 2e-5 and attitude < 4e-6
    bodies = 26
    np.testing.assert_allclose(mine.y[bodies : bodies + 6], truth.y[bodies : bodies + 6], atol=1e-6)  # wheels and rods


@pytest.mark.parametrize("mode", ["rate", "tension"])
def test_reels_that_feed_a_line(mode):
    """A winch that changes its rate, or gives way to the pull: the last segment, short and stiff, is part of the system."""
    reel = {"total_length_m": 20e3, "rate_m_s": 0.5, "lag_s": 3.0, "tension_n": 30.0, "effective_mass_kg": 20.0, "mode": mode}
    more = {"nodes": 4, "seconds": 40.0, "line": {"reel": reel, "rest_length_m": 18e3}}
    mine, truth = (flown(hanging(integrator=one, **more)) for one in (implicit(1e-5), TRUTH))
    assert mine.plant.lines.nodes[0] == truth.plant.lines.nodes[0]
    place, attitude = apart(mine, truth)
    assert place < 3e-4 and attitude < 1e-4  # paid out, the line slackens and snaps
    np.testing.assert_allclose(mine.y[-2:], truth.y[-2:], atol=1e-4)
    assert abs(mine.y[-2] - mine.start[-2]) > 1.0


def test_two_lines_that_meet_in_a_body():
    """A point 15 km above the middle one, which turns; the lower as before."""
    hang = {"line": "upper", "upward": True, "balanced": False}
    above = pf.body("top", kind="point", mass_kg=700.0, hang=hang)
    second = {
        "name": "upper",
        "from_body": "top",
        "to_body": "above",
        "to_point_b_m": (0.0, 0.3, -0.5),
        "rest_length_m": 15e3,
        "stiffness_n": 2e5,
        "damping_n_s": 1e4,
        "mass_per_length_kg_m": 0.01,
        "nodes": 3,
    }
    found = []
    for one in (implicit(1e-5), TRUTH):
        chosen = hanging(4, integrator=one)
        bodies = [_table(body) | ({"hang": {}} if body.hang else {}) for body in chosen.body]  # three hang at rest
        lines = [*map(_table, chosen.line), second]
        found.append(flown(pf.scenario(*bodies, above, line=lines, seconds=60.0, integrator=one)))
    place, attitude = apart(*found)
    assert place < 2e-5 and attitude < 4e-6


def _table(record):
    return record.model_dump(exclude_unset=True)


def test_slack_and_snap():
    """The lower body comes up half a metre a second: the line goes slack, and snaps half a minute later."""
    found = []
    for one in (implicit(1e-5), TRUTH):
        flight = pf.Flight(hanging(2, seconds=60.0, output=1.0, integrator=one))
        up = flight.y[13:16] / np.linalg.norm(flight.y[13:16])
        flight.y[16:19] += 0.5 * up
        assert flight.fly().name == "DONE"
        found.append(flight)
    tension = found[1].record.tension
    assert tension.min() == 0.0 and tension.max() > 60.0
    assert apart(*found)[0] < 2e-3


def energy(flight):
    """[J] of all rows: motion, weight and stretch, of bodies, nodes and end masses, less its first."""
    plant, lines = flight.plant, flight.plant.lines
    _, states = pf.rows(flight)
    nodes = pf.rest(flight)[:, : 6 * lines.nodes[0]].reshape(len(states), -1, 6)
    points = np.concatenate([states[:, 1:2, :6], nodes, states[:, :1, :6]], axis=1)
    segment = lines.linear_mass * lines.rest
    mass = np.array([plant.bodies.mass[1], *np.zeros(lines.nodes[0]), plant.bodies.mass[0]])
    mass[:-1] += 0.5 * segment
    mass[1:] += 0.5 * segment
    stretch = np.maximum(np.linalg.norm(np.diff(points[:, :, :3], axis=1), axis=-1) - lines.rest, 0.0)
    moving = 0.5 * np.sum(points[:, :, 3:] ** 2, axis=-1) - pf.EARTH_GM_M3_S2 / np.linalg.norm(points[:, :, :3], axis=-1)
    whole = moving @ mass + 0.5 * stretch**2 @ (lines.stiffness / lines.rest)
    return whole - whole[0]


def test_the_energy_of_fast_oscillations_goes_and_never_grows():
    """A pulse along an undamped line of 20 nodes, steps of a second: what cannot be followed is damped, the swing is not."""
    point = {"kind": "point", "inertia_kg_m2": None, "rate_deg_s": None, "attitude": None}
    line = {
        "from_point_b_m": (0.0, 0.0, 0.0),
        "to_point_b_m": (0.0, 0.0, 0.0),
        "start": {"pulse_amplitude_m": 0.1, "pulse_width_m": 3e3},
    }
    more = {"seconds": 600.0, "output": 10.0, "lower": point, "upper": point, "line": line, "damping": 0.0}
    lost = energy(flown(hanging(20, integrator=fixed(1.0), **more)))
    whole = 0.5 * 3.2e5 / 20e3 * 3.0**2  # [J] of the stretch at rest
    assert np.diff(lost).max() < 0.02 * whole
    assert -1.5 * whole < lost[-1] < 0.0


def test_cost_is_linear_in_nodes():
    """Eight times the nodes: about eight times the time, where a dense solution would take 64 to 512 times as long."""
    taken = []
    for nodes in (50, 400):
        flight = pf.Flight(hanging(nodes, seconds=1e4, integrator=fixed(0.5)))
        flight._fly_on(5)
        taken.append(min(timed(flight) for _ in range(7)))
    assert taken[1] / taken[0] < 20.0


def timed(flight):
    begun = time.perf_counter()
    flight._fly_on(30)
    return time.perf_counter() - begun
