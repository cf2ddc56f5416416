"""Bodies that hang on lines at the start: what is at rest stays at rest, what swings has the rate that it was given."""

import numpy as np
import pytest

import fieldline as fl
from fieldline.errors import InputError

LONG = {
    "rest_length_m": 20e3,
    "stiffness_n": 3.2e5,
    "damping_n_s": 1.6e4,
    "mass_per_length_kg_m": 8.35e-3,
    "nodes": 8,
}


def scenario(line=None, hang=None, seconds=600.0, bodies=(), lines=(), orbit=None, **top):
    """A heavy body, and one that hangs on a line from it."""
    below = {"name": "below", "mass_kg": 500.0, "inertia_kg_m2": [200.0, 200.0, 250.0], "rate_deg_s": [0.0, 0.0, 0.0]}
    below |= {"rate_axes": "orbital", "hang": hang or {}}
    above = {
        "name": "above",
        "mass_kg": 9e4,
        "inertia_kg_m2": [1e6, 1e6, 1e6],
        "rate_deg_s": [0.0, 0.0, 0.0],
        "rate_axes": "orbital",
    }
    tether = {"name": "tether", "from_body": "below", "to_body": "above", "from_point_b_m": [0.0, 0.0, -1.0]}
    return fl.Scenario.from_dict(
        {
            "time": {"start_utc": "2025-03-01T00:00:00Z", "duration_s": seconds, "output_step_s": 10.0},
            "orbit": orbit or {"elements": {"altitude_km": 300.0, "inclination_deg": 28.5}},
            "environment": {"gravity": "point", "uniform_field_i_tesla": [1e-5, 0.0, 0.0]},
            "integrator": {"method": "rosenbrock"},
            "body": [above | top, below, *bodies],
            "line": [tether | LONG | {"to_point_b_m": [0.0, 0.0, 2.0]} | (line or {}), *lines],
        },
        "hanging",
    )


def test_what_hangs_at_rest_stays_at_rest():
    data = fl.simulate(scenario(seconds=3000.0))
    tension = data.tension_tether.values
    assert 38.0 < tension[0, 0] < tension[0, -1] < 50.0
    assert np.ptp(tension, axis=0).max() < 0.05  # the levers of the bodies are not in the state of rest
    assert np.ptp(data.altitude_m.values - data.altitude_m.values[:, :1], axis=0).max() < 20.0  # the ellipsoid's, not the line's
    chord = data.line_position_i_tether.values[:, -1] - data.line_position_i_tether.values[:, 0]
    up = data.position_i.values[:, 0] / np.linalg.norm(data.position_i.values[:, 0], axis=1)[:, None]
    angle = np.arcsin(np.linalg.norm(np.cross(chord, up), axis=1) / np.linalg.norm(chord, axis=1))
    assert angle.max() < 1e-5


def test_upward_and_the_other_way_round():
    """The line may run from either body to the other; the upper body may be the one that hangs."""
    data = fl.simulate(
        scenario(hang={"upward": True}, line={"from_point_b_m": [0.0, 0.0, 1.0], "to_point_b_m": [0.0, 0.0, -2.0]})
    )
    assert np.ptp(data.tension_tether.values, axis=0).max() < 0.05
    assert data.altitude_m.values[0, 1] - data.altitude_m.values[0, 0] == pytest.approx(20006.0, abs=3.0)
    turned = {"from_body": "above", "to_body": "below", "from_point_b_m": [0.0, 0.0, 2.0], "to_point_b_m": [0.0, 0.0, -1.0]}
    one, other = fl.simulate(scenario()), fl.simulate(scenario(line=turned))
    assert np.allclose(one.tension_tether.values, other.tension_tether.values[:, ::-1], atol=1e-6)


@pytest.mark.parametrize("angle", ["in_plane", "out_of_plane"])
def test_a_swing_starts_where_it_was_told(angle):
    data = fl.simulate(scenario(hang={f"{angle}_deg": 10.0}, seconds=60.0))
    assert libration(data, angle)[0] == pytest.approx(10.0, abs=0.02)
    swung = fl.simulate(scenario(hang={f"{angle}_rate_deg_s": 0.01}, seconds=60.0))
    assert libration(swung, angle)[1] == pytest.approx(0.1, rel=0.02)


def libration(data, angle):
    """Angle [deg] of the chord over time, in orbital axes of the upper body."""
    r, v = data.position_i.values[:, 0], data.velocity_i.values[:, 0]
    down = data.line_position_i_tether.values[:, 0] - data.line_position_i_tether.values[:, -1]
    z = -r / np.linalg.norm(r, axis=1)[:, None]
    y = -np.cross(r, v) / np.linalg.norm(np.cross(r, v), axis=1)[:, None]
    x = np.cross(y, z)
    along, across, below = ((down * axis).sum(axis=1) for axis in (x, y, z))
    if angle == "in_plane":
        return np.degrees(np.arctan2(along, below))
    return np.degrees(np.arcsin(across / np.linalg.norm(down, axis=1)))


def test_an_unbalanced_body_keeps_its_orbit():
    kept = scenario(hang={"balanced": False})
    given = fl.simulate(kept).velocity_i.values[0, 0]
    free = np.sqrt(3.986004418e14 / 6_678_136.6)
    assert np.linalg.norm(given) == pytest.approx(free, abs=1e-6)
    assert np.linalg.norm(fl.simulate(scenario()).velocity_i.values[0, 0]) > free + 0.05  # the whole turns faster than that


@pytest.mark.parametrize("reel_on", ["carrier", "hanging"])
def test_a_reel_that_turns_already_jolts_nothing(reel_on):
    """At 0.5 m/s from the first moment on: neither the line nor the feed has to catch up."""
    line = {"reel": {"total_length_m": 21e3, "rate_m_s": 0.5}}
    if reel_on == "hanging":
        line |= {"from_body": "above", "to_body": "below", "from_point_b_m": [0.0, 0.0, 2.0], "to_point_b_m": [0.0, 0.0, -1.0]}
    told = fl.simulate(scenario(line=line, seconds=120.0))
    still = fl.simulate(scenario(line=line | {"reel": {"total_length_m": 21e3}}, seconds=120.0))
    assert told.deployed_length_tether.values[-1] == pytest.approx(20060.0, abs=0.5)
    # what fed line adds by itself: Coriolis force across, inertia of what leaves, and 3 n^2 m dL
    near, far = told.tension_tether.values[:, 0], still.tension_tether.values[:, 0]
    assert np.abs(near - far).max() < 0.1


def test_three_bodies_on_two_lines():
    third = {"name": "third", "kind": "point", "mass_kg": 100.0, "hang": {}}
    second = LONG | {"name": "second", "from_body": "third", "to_body": "below", "rest_length_m": 5e3, "nodes": 3}
    data = fl.simulate(scenario(bodies=[third], lines=[second | {"to_point_b_m": [0.0, 0.0, 1.0]}]))
    upper, lower = data.tension_tether.values, data.tension_second.values
    assert upper[0, 0] > lower[0, -1] > lower[0, 0] > 9.0
    assert np.ptp(lower, axis=0).max() < 0.05 and np.ptp(upper, axis=0).max() < 0.05


def test_a_skiprope_goes_round_as_told():
    wave = {"start": {"skiprope_amplitude_m": 30.0, "skiprope_phase_deg": 90.0, "skiprope_sense": "left-handed"}}
    data = fl.simulate(scenario(line=wave, seconds=800.0))
    place = data.line_position_i_tether.values
    chord = place[:, -1] - place[:, 0]
    down = -chord / np.linalg.norm(chord, axis=1)[:, None]
    middle = place[:, 4] - 0.5 * (place[:, 0] + place[:, -1])
    bow = middle - (middle * down).sum(axis=1)[:, None] * down
    assert np.linalg.norm(bow, axis=1) == pytest.approx(30.0, rel=0.25)
    turning = np.sign((np.cross(bow[:-1], bow[1:]) * down[1:]).sum(axis=1))
    assert np.all(turning == -1.0)  # left-handed about the direction down the line


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"hang": {"line": "rope"}}, 'names no [[line]]: "rope"'),
        ({"hang": {"in_plane_deg": 95.0}}, "in_plane_deg"),
        ({"line": {"nodes": 0, "start": {"skiprope_amplitude_m": 1.0}}}, "needs a line with nodes"),
        ({"line": {"start": {"skiprope_amplitude_m": 1.0, "skiprope_mode": 9}}}, "at most the number of nodes, 8"),
        ({"line": {"start": {"pulse_width_m": 9.0}}}, "pulse_amplitude_m"),
        ({"line": {"stiffness_n": 20.0}}, "stretch to more than twice"),
        ({"hang": {"in_plane_deg": 80.0, "in_plane_rate_deg_s": 0.066}}, "pushed, not pulled"),
    ],
    ids=lambda one: next(iter(one)) if isinstance(one, dict) else "",
)
def test_what_cannot_hang_is_refused(changes, words):
    with pytest.raises(InputError) as refused:
        scenario(**changes).check()
    assert words in str(refused.value)


@pytest.mark.parametrize("upward", [False, True], ids=["a chain", "above and below"])
def test_four_bodies_on_three_lines(upward):
    """Each below the one before, or one above the body from which the others hang: at rest, and it stays so."""
    third = {"name": "third", "kind": "point", "mass_kg": 100.0, "hang": {}}
    fourth = {"name": "fourth", "kind": "point", "mass_kg": 50.0, "hang": {"upward": upward}}
    second = LONG | {"name": "second", "from_body": "third", "to_body": "below", "rest_length_m": 5e3, "nodes": 3}
    last = LONG | {
        "name": "last",
        "from_body": "fourth",
        "to_body": "above" if upward else "third",
        "rest_length_m": 3e3,
        "nodes": 2,
    }
    lines = [second | {"to_point_b_m": [0.0, 0.0, 1.0]}, last | ({"to_point_b_m": [0.0, 0.0, -2.0]} if upward else {})]
    data = fl.simulate(scenario(bodies=[third, fourth], lines=lines))
    for name in ("tether", "second", "last"):
        tension = data[f"tension_{name}"].values
        assert tension.min() > 0.2 and np.ptp(tension, axis=0).max() < 0.05
    up = data.position_i.values[0] @ data.position_i.values[0, 0] / np.linalg.norm(data.position_i.values[0, 0])
    assert (up[3] > up[0] + 2.9e3) if upward else (up[3] < up[2] - 2.9e3)
