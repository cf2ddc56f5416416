"""Lines with nodes against the textbook's equations in NumPy, at states at random: ends, reels, sliders, damped joints."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

import plant_flights as pf
from fieldline.dynamics.layout import starts_in_state
from textbook_plant import Textbook

pytestmark = pytest.mark.kernels
seeds = st.integers(0, 2**32 - 1)
ROPE = {
    "from_body": "one",
    "from_point_b_m": (0.3, 0.1, 0.5),
    "to_body": "two",
    "to_point_b_m": (0.0, 0.2, -0.4),
    "stiffness_n": 5000.0,
    "damping_n_s": 300.0,
    "mass_per_length_kg_m": 0.004,
    "nodes": 4,
    "rest_length_m": 1000.0,
}
REEL = {"total_length_m": 1500.0, "rate_m_s": 3.0, "lag_s": 0.7, "tension_n": 4.0, "effective_mass_kg": 2.0}
SLIDERS = [
    {"end": "from", "axis_b": (0.6, 0.8, 0.0), "travel_m": 0.5, "speed_m_s": 0.02},
    {"end": "to", "axis_b": (0.0, 0.0, 1.0), "travel_m": 0.5, "speed_m_s": 10.0},
]
LINES = {
    "nodes": ROPE,
    "joints": ROPE | {"from_joint_damping_n_m_s": 40.0, "to_joint_damping_n_m_s": 25.0},
    "rate reel": ROPE | {"reel": REEL},
    "tension reel": ROPE | {"reel": REEL | {"mode": "tension"}},
    "one segment on a reel": ROPE | {"nodes": 0, "reel": REEL},
    "sliders": ROPE | {"slider": SLIDERS},
    "massless, damped joints": ROPE | {"nodes": 0, "mass_per_length_kg_m": 0.0, "from_joint_damping_n_m_s": 40.0},
    "everything": ROPE | {"slider": SLIDERS, "reel": REEL, "from_joint_damping_n_m_s": 40.0, "to_joint_damping_n_m_s": 25.0},
}


def flight_of(line, gravity="j2", **two):
    """Two rigid bodies with wheels and conductors, a point, and two lines that meet in the first body."""
    wheel = {"axis_b": (0.0, 0.6, 0.8), "momentum_n_m_s": 0.01, "momentum_max_n_m_s": 0.2, "torque_max_n_m": 0.01}
    wire = {"position_b_m": (0.1, -0.2, 0.3), "direction_b": (1.0, 2.0, 2.0), "length_m": 30.0}
    one = pf.body("one", mass_kg=40.0, wheel=[wheel], conductor=[wire, wire | {"direction_b": (0.0, 0.0, 1.0)}])
    other = pf.body("two", inertia_kg_m2=(1.0, 1.4, 1.7), offset_o_m=(0.0, 0.0, 1000.2), **two)
    third = pf.body("three", kind="point", offset_o_m=(0.0, 0.0, -1000.2))
    second = ROPE | {"name": "second", "to_body": "three", "from_point_b_m": (0.0, 0.1, -0.5), "nodes": 2}
    second.pop("to_point_b_m")
    environment = {"field": "centred-dipole", "field_moment_e_a_m2": [(1.4e22, -0.5e22, -7.6e22)], "gravity": gravity}
    flight = pf.Flight(pf.scenario(one, other, third, line=[line, second], environment=environment, integrator={"step_s": 0.1}))
    flight.inputs.current[:] = (3.0, -2.0)
    flight.inputs.wheel_torque[:] = 0.003
    flight.inputs.reel[:] = 5.0
    if len(flight.inputs.slide_to):
        flight.inputs.slide_to[:] = (0.3, -0.2)
    return flight


FLIGHTS = {name: flight_of(line) for name, line in LINES.items()}


def somewhere(flight, seed):
    """A state at random: nodes off the straight lines, feeds of any length and rate."""
    rng = np.random.default_rng(seed)
    y = pf.random_state(flight, seed)
    nodes, feeds, _ = starts_in_state(flight.plant)
    lines = flight.plant.lines
    for k in range(2):
        a, b = (y[13 * body : 13 * body + 6] for body in lines.body[k])
        out = lines.nodes[k]
        share = np.arange(1, out + 1)[:, None] / (out + 1)
        rows = y[nodes + 6 * lines.first[k] : nodes + 6 * (lines.first[k] + out)].reshape(-1, 6)
        rows[:] = (1.0 - share) * a + share * b + rng.normal(0.0, (20.0, 20.0, 20.0, 0.5, 0.5, 0.5), (out, 6))
    if lines.reel[0]:
        y[feeds : feeds + 2] = y[feeds] * rng.uniform(0.6, 1.0), rng.normal(0.0, 3.0)
    return y


@pytest.mark.parametrize("name", LINES)
@settings(max_examples=15, deadline=None)
@given(seed=seeds, t=st.floats(0.0, 20.0))
def test_rates_are_the_textbooks(name, seed, t):
    flight = FLIGHTS[name]
    y = somewhere(flight, seed)

    ours, log = pf.rates(flight, t, y)
    book = Textbook(flight, t, y)
    theirs = book.rates()
    size = np.abs(theirs).max()
    # places 7,000 km out are known to a nanometre, which 5 N/m of line turns into forces; joints are differenced
    assert np.abs(ours - theirs).max() < 3e-9 * max(1.0, size / 10.0), name
    told = sum(force for force, _ in book.loads[0].values())
    assert np.abs(log[:, 0, :3].sum(axis=0) - told).max() < 1e-9 * np.linalg.norm(told)


@pytest.mark.parametrize("name", [name for name, line in LINES.items() if "joint" not in str(line)])
def test_momentum_changes_by_gravity_alone(name):
    """d/dt of all momentum, what streams in a reel's segment included, is the weight of all masses."""
    flight = flight_of(LINES[name], gravity="point")
    flight.inputs.current[:] = 0.0
    for seed in range(4):
        y = somewhere(flight, seed)
        h = 1e-4
        rate = pf.rates(flight, 5.0, y)[0]
        change = (momentum(flight, 5.0 + h, advanced(y, rate, h)) - momentum(flight, 5.0 - h, advanced(y, rate, -h))) / (2.0 * h)
        weight = sum(mass * -3.986004418e14 * r / np.linalg.norm(r) ** 3 for mass, r, _ in masses(flight, 5.0, y))
        assert np.abs(change - weight).max() < 1e-6 * np.linalg.norm(weight), name


def advanced(y, rate, h):
    """State y moved along dz/dt for a moment."""
    new, bodies = y.copy(), 3
    for b in range(bodies):
        row, slope = new[13 * b : 13 * b + 13], rate[12 * b : 12 * b + 12]
        row[:6] += h * slope[:6]
        row[6:10] = (Rotation.from_quat(row[6:10]) * Rotation.from_rotvec(h * slope[6:9])).as_quat()
        row[10:13] += h * slope[9:12]
    new[13 * bodies :] += h * rate[12 * bodies :]
    return new


def masses(flight, t, y):
    """(mass, place, velocity) of bodies, nodes and ends; the reel's end moves with what streams out."""
    book = Textbook(flight, t, y)
    found, reeled = [], np.zeros(3)
    nodes, feed = len(flight.plant.wheels.body), starts_in_state(flight.plant)[1] - 39
    slider = 0
    from textbook_line import TextbookLine

    for k, line in enumerate(flight.scenario.line):
        one = TextbookLine(book, k, line, nodes, feed + 2 * k, slider)
        nodes, slider = nodes + 6 * line.nodes, slider + len(line.slider)
        speeds = [v.copy() for v in one.rates_of]
        if line.reel is not None:
            speeds[-1] = speeds[-1] + one.speed * (one.places[-2] - one.places[-1]) / one.length
            reeled[one.ends[1]["b"]] -= line.mass_per_length_kg_m * (sum(one.rests) - line.rest_length_m)
            arm = one.places[-1] - y[13 * one.ends[1]["b"] :][:3]  # line on its way from the reel in the body's middle
            linear = line.mass_per_length_kg_m
            found += [(linear, one.places[-1], one.speed * arm), (-linear, one.places[-1], np.zeros(3))]
        found += list(zip(one.mass, one.places, speeds, strict=True))
    for b, body in enumerate(flight.scenario.body):
        found.append((body.mass_kg + reeled[b], y[13 * b : 13 * b + 3], y[13 * b + 3 : 13 * b + 6]))
    return found


def momentum(flight, t, y):
    """Of everything [kg m/s]."""
    return sum(mass * speed for mass, _, speed in masses(flight, t, y))
