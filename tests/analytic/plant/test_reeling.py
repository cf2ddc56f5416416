"""Nodes that come and go beside a reel in the plant: what is conserved, what does not jump, and runs over many of them."""

import numpy as np
import pytest
from numba import njit
from scipy.spatial.transform import Rotation

import plant_flights as pf
from fieldline.dynamics.layout import starts_in_state
from fieldline.dynamics.parameters import STATE
from fieldline.simulate.loop.reeling import reel_lines
from fieldline.simulate.run_dataset import dataset_of

MU, EA = 0.008, 2e5
ROPE = {
    "name": "tether",
    "from_body": "probe",
    "from_point_b_m": (0.1, 0.0, -0.4),
    "to_body": "ship",
    "to_point_b_m": (0.2, -0.3, 1.0),
    "stiffness_n": EA,
    "damping_n_s": 2e4,
    "mass_per_length_kg_m": MU,
    "nodes": 5,
    "rest_length_m": 320.0,
    "reel": {"total_length_m": 600.0, "rate_m_s": 0.4},
}
STILL = {"seconds": 1.0, "integrator": {"method": "rosenbrock"}}


@njit(cache=True)
def reeled(t, run):
    return reel_lines(t, run)


def flight_of(line=ROPE, point=False):
    """Probe below ship, both turning with the orbit unless they are points."""
    usual = {"attitude": None, "rate_deg_s": (0.0, 0.0, 0.0), "rate_axes": "orbital", "inertia_kg_m2": (30.0, 40.0, 50.0)}
    kind = {"kind": "point"} if point else usual
    line = dict(line)
    if point:
        line = {key: value for key, value in line.items() if "point" not in key}
    length = line["rest_length_m"] * (1.0 + 1e-4)
    ship = pf.body("ship", mass_kg=900.0, **kind)
    rate = line["reel"].get("rate_m_s", 0.0)
    probe = pf.body("probe", mass_kg=80.0, offset_o_m=(0.0, 0.0, length), offset_rate_o_m_s=(0.0, 0.0, rate), **kind)
    return pf.Flight(pf.scenario(ship, probe, line=[line], environment={"gravity": "point"}, **STILL))


class Account:
    """Mass, momentum and first moment of everything, with what streams in the reel's segment and on the way to it."""

    def __init__(self, flight):
        y, lines = flight.y, flight.plant.lines
        nodes, feeds, _ = starts_in_state(flight.plant)
        out, (length, rate) = int(lines.nodes[0]), y[feeds : feeds + 2]
        ends = [self.end(flight, k) for k in range(2)]
        points = y[nodes : nodes + 6 * out].reshape(-1, 6)
        places = [ends[0][0], *points[:, :3], ends[1][0]]
        speeds = [ends[0][1], *points[:, 3:], ends[1][1]]
        pieces = MU * np.append(lines.rest[:out], length)
        masses = np.zeros(out + 2)
        masses[:-1] += 0.5 * pieces
        masses[1:] += 0.5 * pieces
        last = (places[-2] - places[-1]) / length
        speeds[-1] = speeds[-1] + rate * last
        gone = pieces.sum() - lines.stored[0]
        bodies = y[: 2 * STATE].reshape(2, STATE)
        masses = np.concatenate([masses, [900.0 - gone, 80.0]])
        places = np.array([*places, *bodies[:, :3]])
        speeds = np.array([*speeds, *bodies[:, 3:6]])
        self.mass = masses.sum()
        self.momentum = masses @ speeds + MU * rate * (ends[1][0] - bodies[0, :3])
        self.moment = masses @ (places - bodies[0, :3])
        self.tension = [self.pull(flight, places, k, length) for k in (0, out)]

    @staticmethod
    def end(flight, k):
        """Place and velocity of an attachment."""
        lines = flight.plant.lines
        row, point = flight.y[STATE * lines.body[0, k] :][:STATE], lines.point[0, 3 * k : 3 * k + 3]
        turn = Rotation.from_quat(row[6:10])
        return row[:3] + turn.apply(point), row[3:6] + turn.apply(np.cross(row[10:13], point))

    @staticmethod
    def pull(flight, places, j, length):
        """Elastic tension of segment j."""
        rest = length if j == flight.plant.lines.nodes[0] else flight.plant.lines.rest[j]
        return EA * (np.linalg.norm(places[j + 1] - places[j]) / rest - 1.0)


def disturbed(seed, feed, line=ROPE, point=False):
    """A flight's state with its line somewhat off the straight one, taut, and the reel's segment of a length."""
    rng = np.random.default_rng(seed)
    flight = flight_of(line, point)
    nodes, feeds, _ = starts_in_state(flight.plant)
    out = int(flight.plant.lines.nodes[0])
    points = flight.y[nodes : nodes + 6 * out].reshape(-1, 6)
    points += rng.normal(0.0, [1e-2] * 3 + [1e-2] * 3, points.shape)
    flight.y[feeds] = feed
    flight.y[feeds + 1] = rng.normal()
    pf.rates(flight)  # the bodies' end masses, as after a step
    flight.y[STATE + 10 : STATE + 13] += rng.normal(0.0, 0.01, 3)
    return flight


@pytest.mark.parametrize("point", [False, True], ids=["rigid", "points"])
@pytest.mark.parametrize("rest", [320.0, 90.0], ids=["in the middle", "the first one"])
def test_a_node_appears_in_the_plant(rest, point):
    for seed in range(5):
        flight = disturbed(seed, 150.0, ROPE | {"rest_length_m": rest}, point)
        _, feeds, _ = starts_in_state(flight.plant)
        flight.y[feeds] = 151.0
        pf.rates(flight)
        before, out = Account(flight), int(flight.plant.lines.nodes[0])
        assert reeled(0.0, flight.packed) == 0
        after = Account(flight)
        assert flight.plant.lines.nodes[0] == out + 1 and flight.y[feeds] == pytest.approx(51.0)
        assert after.mass == pytest.approx(before.mass, rel=1e-14)
        np.testing.assert_allclose(after.momentum, before.momentum, rtol=1e-12)
        np.testing.assert_allclose(after.moment, before.moment, atol=1e-7)
        if out > 0:
            assert after.tension[0] == pytest.approx(before.tension[0], abs=1e-9)
        assert after.tension[1] == pytest.approx(before.tension[1], abs=1e-3)  # 2e5 N / 50 m times 1e-9 m and more


@pytest.mark.parametrize("point", [False, True], ids=["rigid", "points"])
@pytest.mark.parametrize("rest", [320.0, 160.0], ids=["in the middle", "the last one"])
def test_a_node_vanishes_in_the_plant(rest, point):
    for seed in range(5):
        flight = disturbed(seed, 35.0, ROPE | {"rest_length_m": rest}, point)
        before, out = Account(flight), int(flight.plant.lines.nodes[0])
        assert reeled(0.0, flight.packed) == 0
        after = Account(flight)
        assert flight.plant.lines.nodes[0] == out - 1
        assert after.mass == pytest.approx(before.mass, rel=1e-14)
        np.testing.assert_allclose(after.momentum, before.momentum, rtol=1e-12)


LONG = ROPE | {"stiffness_n": 2e4, "damping_n_s": 4e3, "mass_per_length_kg_m": 0.002, "rest_length_m": 2200.0}


def hung(*numbers, **tables):
    """A flight of `paid_out`."""
    return pf.Flight(paid_out(*numbers, **tables))


def paid_out(length, rate, reel, nodes=5, mass_per_length=0.002, seconds=800.0, **tables):
    """Points on a taut line that is reeled at a rate from the start; output every step of 0.2 s."""
    line = LONG | {"rest_length_m": length, "nodes": nodes, "mass_per_length_kg_m": mass_per_length}
    line["reel"] = {"total_length_m": 6000.0, "rate_m_s": rate, "lag_s": 1.0} | reel
    line = {key: value for key, value in line.items() if "point" not in key}
    n = pf.MEAN_MOTION
    pull = 3.0 * n * n * length * (80.0 + 0.5 * mass_per_length * length)
    ship = pf.body("ship", mass_kg=9000.0, kind="point")
    lean = 0.5 * np.arcsin(np.clip(4.0 * rate / (3.0 * n * length), -0.9, 0.9))  # of a line that is paid out so for long
    along = np.array([np.sin(lean), 0.0, np.cos(lean)])
    place, speed = tuple(length * (1.0 + pull / 2e4) * along), tuple(rate * along)
    probe = pf.body("probe", mass_kg=80.0, kind="point", offset_o_m=place, offset_rate_o_m_s=speed)
    integrator = {"method": "rk4", "step_s": 0.2}
    tables = {"output": 0.2, "integrator": integrator, "environment": {"gravity": "point"}} | tables
    return pf.scenario(ship, probe, line=[line], seconds=seconds, **tables)


def ends(flight):
    """Tension at the probe and at the reel [N], and nodes out, of every row."""
    rows = int(flight.clock.rows[0])
    nodes, tension = flight.record.nodes[:rows, 0], flight.record.tension[:rows]
    return tension[:, 0], tension[np.arange(rows), nodes], nodes


@pytest.mark.parametrize(("length", "rate"), [(2200.0, 1.0), (2700.0, -1.0)], ids=["appears", "vanishes"])
def test_no_tension_jumps_when_a_node_comes_or_goes(length, rate):
    """Between two steps it changes as it does beside them; where a node goes, by a tenth of what it weighed besides."""
    flight = hung(length, rate, {})
    flight.fly()
    assert flight.complete
    probe, reel, nodes = ends(flight)
    events = np.flatnonzero(np.diff(nodes))
    assert len(events) == 1
    k, n = events[0], pf.MEAN_MOTION
    weight = 0.0 if rate > 0.0 else 3.0 * n * n * length * 0.002 * 0.5 * 1400.0
    for tension in (probe, reel):
        change = np.abs(np.diff(tension))
        beside = change[k - 20 : k].max() + change[k + 1 : k + 3].max()
        assert change[k] < beside + 0.1 * weight, (change[k], beside, weight)
    assert np.ptp(reel[k - 5 : k + 6]) < 0.03 * reel.mean()


def lean_of(flight):
    """Angle of the straight line from the vertical in the orbit's plane [rad], and length out [m], of every row."""
    data = dataset_of(flight)
    r, v = data.position_i.values[:, 0], data.velocity_i.values[:, 0]
    beside = data.position_i.values[:, 1] - r
    down = -r / np.linalg.norm(r, axis=1, keepdims=True)
    across = np.cross(v, r)
    ahead = np.cross(across / np.linalg.norm(across, axis=1, keepdims=True), down)
    return np.arctan2((beside * ahead).sum(axis=1), (beside * down).sum(axis=1)), data.deployed_length_tether.values


IMPLICIT = {"method": "rosenbrock", "step_s": 0.1, "step_max_s": 10.0, "relative_tolerance": 1e-10}
EXPONENTIAL = {"body": "ship", "law": "reel-exponential", "rate_hz": 0.5}


@pytest.mark.parametrize("nodes", [0, 6])
def test_exponential_deployment_leans_at_its_constant_angle(nodes):
    """sin 2 th = 4 c / (3 n), on a line without nodes and on one of hardly any mass whose nodes appear."""
    c = 0.5 * pf.MEAN_MOTION
    law = EXPONENTIAL | {"parameters": {"target_length_m": 6000.0, "approach_per_s": 1.0, "rate_out_per_s": c}}
    mass = 1e-6 if nodes else 0.0
    flight = hung(600.0, 600.0 * c, {}, nodes, mass, 4000.0, output=20.0, software=[law], integrator=IMPLICIT)
    flight.fly()
    assert flight.complete
    lean, length = lean_of(flight)
    wanted = 0.5 * np.arcsin(4.0 * 0.5 / 3.0)
    assert length[-1] == pytest.approx(600.0 * np.exp(c * 4000.0), rel=0.01)
    assert flight.plant.lines.nodes[0] == (5 if nodes else 0)
    assert np.abs(lean - wanted).max() < 1.5e-3  # the call every two seconds and the reel's second of lag


def test_a_line_of_little_mass_is_the_line_without():
    """A deployment and its stop: the probe's place differs in proportion to the mass of the line, whose nodes appear."""
    c = 0.4 * pf.MEAN_MOTION
    law = EXPONENTIAL | {"parameters": {"target_length_m": 3000.0, "rate_out_per_s": c}}
    places = []
    for nodes, mass in ((0, 0.0), (5, 1e-3), (5, 1e-4), (5, 1e-5)):
        flight = hung(1200.0, 1200.0 * c, {}, nodes, mass, 5000.0, output=50.0, software=[law], integrator=IMPLICIT)
        flight.fly()
        assert flight.complete and flight.plant.lines.nodes[0] == (2 if nodes else 0)
        data = dataset_of(flight)
        places.append(data.position_i.values[:, 1] - data.position_i.values[:, 0])
    away = [np.linalg.norm(one - places[0], axis=1).max() for one in places[1:]]
    assert away[0] < 4.0
    assert away[1] == pytest.approx(0.1 * away[0], rel=0.03) and away[2] == pytest.approx(0.1 * away[1], rel=0.03)


def test_a_hundred_metres_to_twenty_kilometres_and_back():
    """Rupp's tension pays out a line of 10 nodes and takes it in; nothing is left of it in the account of masses."""
    far = {"target_length_m": 20e3, "second_from_s": 22e3, "second_target_length_m": 400.0, "far_mass_kg": 80.0}
    law = {"body": "ship", "law": "reel-tension", "rate_hz": 0.5}
    law["parameters"] = far | {"mass_per_length_kg_m": 0.002, "tension_min_n": 0.01}
    reel = {"mode": "tension", "total_length_m": 21e3, "tension_n": 0.02, "effective_mass_kg": 2.0}
    flight = hung(100.0, 0.08, reel, 10, 0.002, 52e3, output=100.0, software=[law])
    flight.fly()
    lean, length = lean_of(flight)
    assert flight.complete, flight.outcome
    out = flight.record.nodes[: len(length), 0]
    assert out[0] == 0 and out.max() == 10 and out[-1] == 0
    assert length[219] == pytest.approx(20e3, rel=0.01) and length[-1] < 500.0
    assert np.abs(lean[60:]).max() < np.radians(30.0)
    account = flight.y[starts_in_state(flight.plant)[1]] * 0.002
    assert account == pytest.approx(0.002 * length[-1])


@pytest.mark.parametrize(
    ("length", "rate", "words"),
    [
        (50.0, -0.5, "took tether in to shortest_length_m = 20 m"),
        (5950.0, 0.5, "paid out all 6000 m of tether"),
    ],
)
def test_a_reel_at_its_end_ends_the_run_and_keeps_it(length, rate, words):
    flight = hung(length, rate, {"shortest_length_m": 20.0}, seconds=300.0, output=1.0)
    flight.fly()
    data = dataset_of(flight)
    assert data.attrs["complete"] == 0 and words in data.attrs["outcome"] and "reel-profile" in data.attrs["outcome"]
    assert 40 < data.sizes["time"] < 200


HEAT = {
    "absorptivity": 0.5,
    "emissivity": 0.8,
    "specific_heat_j_kg_k": 1000.0,
    "expansion_1_k": 2e-5,
    "start_temperature_k": 320.0,
}


def test_a_warm_line_comes_and_goes_with_its_warmth():
    """Pieces of one temperature share their strain; two temperatures mix by the lengths."""
    line = ROPE | {"heat": HEAT, "diameter_m": 0.002}
    flight = disturbed(3, 151.0, line, point=True)
    _, feeds, warm = starts_in_state(flight.plant)
    out = int(flight.plant.lines.nodes[0])
    flight.y[warm : warm + out + 2] = [300.0 + 10.0 * j for j in range(out + 1)] + [200.0]
    grown = 1.0 + 2e-5 * (flight.y[warm + out] - flight.plant.lines.reference[0])
    before = strains(flight, out, grown)
    assert reeled(0.0, flight.packed) == 0
    assert flight.y[warm + out + 1] == flight.y[warm + out]
    assert strains(flight, out, grown) == pytest.approx(before, abs=1e-9)
    assert strains(flight, out + 1, grown) == pytest.approx(before, abs=1e-9)
    flight.y[feeds], flight.y[warm + out + 1] = 39.0, 260.0
    mixed = (100.0 * flight.y[warm + out] + 39.0 * 260.0) / 139.0
    assert reeled(0.0, flight.packed) == 0 and flight.plant.lines.nodes[0] == out
    assert flight.y[warm + out] == pytest.approx(mixed, rel=1e-12)


def strains(flight, j, grown):
    """Strain of segment j of a line between points, grown by its warmth."""
    nodes, feeds, _ = starts_in_state(flight.plant)
    out = int(flight.plant.lines.nodes[0])
    points = [Account.end(flight, 0)[0], *flight.y[nodes : nodes + 6 * out].reshape(-1, 6)[:, :3], Account.end(flight, 1)[0]]
    rest = flight.y[feeds] if j == out else flight.plant.lines.rest[j]
    return float(np.linalg.norm(points[j + 1] - points[j])) / (rest * grown) - 1.0


def test_a_law_of_the_users_own_works_the_reel(tmp_path):
    """It sees tension, length and rate of the line, and stops the reel at a length."""
    (tmp_path / "own.py").write_text(
        "def law(t, measurement, memory, params):\n"
        "    assert measurement.tension.shape == measurement.line_rate.shape == (1,)\n"
        "    return [params[0] if measurement.line_length[0] < params[1] else 0.0]\n"
    )
    task = {"body": "ship", "law": "own.py:law", "commands": ["reel"], "compiled": False, "rate_hz": 1.0}
    task["parameters"] = {"rate": 0.8, "until": 2300.0}
    scenario = paid_out(2200.0, 0.5, {}, seconds=300.0, output=10.0, software=[task])
    flight = pf.Flight(pf.Scenario.from_toml(scenario.to_toml(), folder=tmp_path))
    flight.fly()
    assert flight.complete
    _, length = lean_of(flight)
    assert 2300.0 < length[-1] < 2303.0 and flight.record.actuators[: len(length), 0].max() == 0.8
