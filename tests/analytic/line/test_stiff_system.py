"""The implicit step's linear system: chains condensed as a dense solver does it, and the plant's own Jacobian by differences."""

import numpy as np
import pytest
from numba import njit
from scipy.spatial.transform import Rotation

import plant_flights as pf
from fieldline.dynamics.implicit_arrays import new_implicit
from fieldline.dynamics.layout import feeds_at, nodes_at, starts_in_state, temperatures_at
from fieldline.dynamics.lines.chain_solve import condense, factorise_chain, new_chain, spread_out
from fieldline.dynamics.lines.stiff_system import enter_system, solve
from fieldline.dynamics.lines.turning_axes import enter_all, fall, leave_all, move_axes, open_axes, turn_all_rates
from fieldline.dynamics.parameters import NO_REEL, STATE, TANGENT
from fieldline.dynamics.step import rates_of
from fieldline.integrate.linear import factorise, substitute
from fieldline.packed import pack

pytestmark = pytest.mark.kernels


@njit
def solved_chain(k, first, nodes, u_a, u_b, chain):
    """What the chain's loads do to its ends, and the nodes' answer for given ends."""
    factorise_chain(k, first, nodes, chain)
    on_a, on_b = condense(k, first, nodes, chain)
    spread_out(k, first, nodes, u_a, u_b, chain)
    return on_a, on_b


@njit
def solved_dense(matrix, order, column):
    factorise(matrix, column.size, order)
    substitute(matrix, column.size, order, column)


@njit
def solved_stage(t, s, z, start, plant, inputs, shared, implicit, rate, out):
    """U of a stage for a right-hand side; the axes and the system as at a step's start."""
    at = (nodes_at(plant), feeds_at(plant), temperatures_at(plant))
    open_axes(t, z, start, at, plant, inputs, implicit.axes)
    tension, end_mass = shared.tension, shared.end_mass
    enter_system(s, z, start, at, plant.lines, plant.bodies, tension, end_mass, implicit.axes, implicit.system)
    solve(s, rate, z, start, at, plant.lines, plant.bodies, implicit.axes, implicit.system, out)


@njit
def there_and_back(t, later, z, start, plant, inputs, axes, inside, back, rate, turned):
    open_axes(t, z, start, (nodes_at(plant), feeds_at(plant)), plant, inputs, axes)
    move_axes(0.0, plant.surroundings.gravity.gm, axes)
    enter_all(z, nodes_at(plant), plant.lines, axes, inside)
    move_axes(later, plant.surroundings.gravity.gm, axes)
    leave_all(inside, nodes_at(plant), plant.lines, axes, back)
    turn_all_rates(inside, rate, nodes_at(plant), plant.lines, axes, turned)


@pytest.mark.parametrize("nodes", [0, 1, 2, 7])
def test_a_condensed_chain_is_the_dense_solution(nodes):
    """Second of two lines, blocks without symmetry, both ends driven."""
    rng = np.random.default_rng(nodes)
    first, k = 3, 1
    chain = new_chain(first + nodes, 2)
    pull, mass = 5.0 * np.eye(3) + rng.normal(size=(nodes + 1, 3, 3)), 20.0 * np.eye(3) + rng.normal(size=(nodes, 3, 3))
    load, ends = rng.normal(size=(nodes, 3)), rng.normal(size=(2, 3))
    chain.carried[first + k :] = pull.reshape(-1, 9)
    chain.pivot[first:] = mass.reshape(-1, 9)
    chain.load[first:] = load
    full = np.zeros((nodes + 2, 3, nodes + 2, 3))
    for i in range(nodes):
        full[i + 1, :, i + 1] = mass[i]
    for j in range(nodes + 1):
        for row, sign in ((j, 1.0), (j + 1, -1.0)):
            full[row, :, j] += sign * pull[j]
            full[row, :, j + 1] -= sign * pull[j]
    inside = full[1:-1, :, 1:-1].reshape(3 * nodes, 3 * nodes)
    driven = load.ravel() - full[1:-1, :, 0].reshape(-1, 3) @ ends[0] - full[1:-1, :, -1].reshape(-1, 3) @ ends[1]
    answer = np.concatenate([ends[:1], np.linalg.solve(inside, driven).reshape(-1, 3), ends[1:]])
    push = -np.einsum("iajb,jb->ia", full, answer)[[0, -1]]

    on_a, on_b = solved_chain(k, first, nodes, tuple(ends[0]), tuple(ends[1]), chain)
    s_aa, s_ab, s_ba, s_bb = chain.ends[k].reshape(4, 3, 3)
    np.testing.assert_allclose(chain.load[first:], answer[1:-1], atol=1e-13)
    np.testing.assert_allclose(np.array(on_a) - s_aa @ ends[0] - s_ab @ ends[1], push[0], atol=1e-12)
    np.testing.assert_allclose(np.array(on_b) - s_ba @ ends[0] - s_bb @ ends[1], push[1], atol=1e-12)


def test_the_small_solver_swaps_rows_where_it_must():
    matrix = np.array([[0.0, 2.0, 1.0], [1.0, 1.0, 0.0], [4.0, 0.0, -3.0]])
    right = np.array([3.0, -1.0, 2.0])
    column = right.copy()
    solved_dense(matrix.copy(), np.zeros(3, dtype=np.int64), column)
    np.testing.assert_allclose(matrix @ column, right, atol=1e-14)


LINE = {
    "from_body": "one",
    "from_point_b_m": (0.3, 0.1, 0.5),
    "to_body": "two",
    "to_point_b_m": (0.0, 0.2, -0.4),
    "stiffness_n": 5000.0,
    "mass_per_length_kg_m": 0.004,
    "nodes": 3,
    "rest_length_m": 1000.0,
}
IMPLICIT = {"method": "rosenbrock"}
REEL = {"total_length_m": 1300.0, "rate_m_s": 0.0, "lag_s": 0.7, "tension_n": 4.0, "effective_mass_kg": 40.0}


def flight_of(**more):
    """Two rigid bodies and a point, far out where gravity is no matter, on two lines that meet in the first body."""
    inertia = 1e3 * np.array(pf.INERTIA)
    still = {"rate_deg_s": (0.0, 0.0, 0.0), "gravity_gradient": False, "mass_kg": 4e4, "inertia_kg_m2": inertia.tolist()}
    one = pf.body("one", **still)
    two = pf.body("two", offset_o_m=(0.0, 0.0, 1009.0), **still)
    three = pf.body("three", kind="point", offset_o_m=(300.0, 0.0, -960.0))
    second = {key: value for key, value in LINE.items() if key != "to_point_b_m"} | {"to_body": "three", "nodes": 1}
    far = {"elements": {"altitude_km": 5.0e4, "inclination_deg": 20.0}}
    flight = pf.Flight(
        pf.scenario(one, two, three, line=[LINE | more, second | {"name": "second"}], orbit=far, integrator=IMPLICIT)
    )
    nodes, feeds, _ = starts_in_state(flight.plant)
    rng = np.random.default_rng(5)
    flight.y[nodes:feeds] += rng.normal(size=feeds - nodes) * np.tile([2.0, 2.0, 2.0, 0.0, 0.0, 0.0], (feeds - nodes) // 6)
    return flight, rng


def turning_rates(flight, moved, origin, omega):
    """(W, v' - 2 Omega x W - Omega x (Omega x X), ...) of numbers in turning axes that start at `origin`."""
    bodies, nodes, feeds = len(flight.plant.bodies.mass), *starts_in_state(flight.plant)[:2]
    y, at = flight.y.copy(), []
    for b in range(bodies):
        at.append((TANGENT * b, STATE * b))
        y[STATE * b + 10 : STATE * b + 13] = moved[TANGENT * b + 9 : TANGENT * b + 12]
    at += [(place - bodies, place) for place in range(nodes, feeds, 6)]
    y[feeds:] = moved[feeds - bodies :]
    for tangent, state in at:
        x, w = moved[tangent : tangent + 3], moved[tangent + 3 : tangent + 6]
        y[state : state + 3] = origin[:3] + x
        y[state + 3 : state + 6] = origin[3:] + w + np.cross(omega, x)
    for b in range(bodies):
        turned = Rotation.from_quat(y[STATE * b + 6 : STATE * b + 10]) * Rotation.from_rotvec(
            moved[TANGENT * b + 6 : TANGENT * b + 9]
        )
        y[STATE * b + 6 : STATE * b + 10] = turned.as_quat()
    rate, _ = rates_of(0.0, y, flight.plant, flight.inputs, flight.loads, flight.host.callback, flight.shared)
    for tangent, _ in at:
        x, w = moved[tangent : tangent + 3], moved[tangent + 3 : tangent + 6]
        rate[tangent : tangent + 3] = w
        rate[tangent + 3 : tangent + 6] -= 2.0 * np.cross(omega, w) + np.cross(omega, np.cross(omega, x))
    return rate


# what is left out: end masses against bodies 5e4 times heavier, and the forces of what streams through a reel
CASES = {
    "no damping, turning": ({}, 0.004, 1e-3),
    "damping": ({"damping_n_s": 900.0}, 0.0, 1e-3),
    "reel that follows a tension": ({"reel": REEL | {"mode": "tension"}, "damping_n_s": 300.0}, 0.0, 2e-2),
    "reel that follows a rate": ({"reel": REEL}, 0.0, 1e-2),
}


@pytest.mark.parametrize("case", CASES)
def test_the_system_is_the_jacobian_of_the_plant(case):
    """(1/s - A) U = rate, with A by central differences of the whole right-hand side, at a line that is bent and turns."""
    more, turning, close = CASES[case]
    flight, rng = flight_of(**more)
    plant, y = flight.plant, flight.y
    bodies, (nodes, feeds, _) = len(plant.bodies.mass), starts_in_state(plant)
    spin = np.array([0.3, 1.0, -0.2]) * turning
    places = [STATE * b for b in range(bodies)] + list(range(nodes, feeds, 6))
    centre = np.average(y.reshape(-1)[: STATE * bodies].reshape(-1, STATE)[:, :6], axis=0, weights=plant.bodies.mass)
    for p in places:
        y[p + 3 : p + 6] = centre[3:] + np.cross(spin, y[p : p + 3] - centre[:3])
    start = np.array([y[STATE * b + 6 : STATE * b + 10] for b in range(bodies)])
    z = np.concatenate([*(np.r_[y[STATE * b : STATE * b + 6], np.zeros(6)] for b in range(bodies)), y[STATE * bodies :]])
    rates_of(0.0, y, plant, flight.inputs, flight.loads, flight.host.callback, flight.shared)
    implicit, s = new_implicit(plant, True), 0.8
    right, out = rng.normal(size=z.size), np.zeros(z.size)
    for k in range(len(plant.lines.nodes)):  # what has no rate in the plant
        gone = nodes - bodies + 6 * (plant.lines.first[k] + plant.lines.nodes[k])
        right[gone : nodes - bodies + 6 * plant.lines.first[k + 1]] = 0.0
        if plant.lines.reel[k] == NO_REEL:
            right[feeds - bodies + 2 * k : feeds - bodies + 2 * k + 2] = 0.0
    records = [pack(one) for one in (plant, flight.inputs, flight.shared, implicit)]
    solved_stage(0.0, s, z, start, *records, right, out)
    origin, omega = implicit.axes.origin[0, :6], implicit.axes.origin[0, 6:]
    assert np.linalg.norm(omega - spin) < 1e-6 + 0.1 * np.linalg.norm(spin)

    inside = z.copy()
    for p in [TANGENT * b for b in range(bodies)] + list(range(nodes - bodies, feeds - bodies, 6)):
        inside[p : p + 3] -= origin[:3]
        inside[p + 3 : p + 6] -= origin[3:] + np.cross(omega, inside[p : p + 3])
    jacobian = np.zeros((z.size, z.size))
    for j in range(z.size):
        step = np.zeros(z.size)
        step[j] = 1e-3
        above, below = (turning_rates(flight, inside + sign * step, origin, omega) for sign in (1.0, -1.0))
        jacobian[:, j] = (above - below) / 2e-3
    error, drive = np.abs(out / s - jacobian @ out - right), np.abs(jacobian @ out)
    bodily = np.arange(TANGENT * bodies).reshape(bodies, 4, 3)
    for rows in (bodily[:, 0], bodily[:, 1], bodily[:, 2], bodily[:, 3], np.arange(TANGENT * bodies, z.size)):
        assert error[rows].max() < close * drive[rows].max()


def test_axes_that_turn_leave_nothing_out():
    """Into them and back at once is the same state; a free body falls with them to what their series leaves out."""
    flight, rng = flight_of()
    plant, y = flight.plant, flight.y
    bodies = len(plant.bodies.mass)
    start = np.array([y[STATE * b + 6 : STATE * b + 10] for b in range(bodies)])
    z = np.concatenate([*(np.r_[y[STATE * b : STATE * b + 6], np.zeros(6)] for b in range(bodies)), y[STATE * bodies :]])
    z += 1e-3 * rng.normal(size=z.size)
    axes = new_implicit(plant, True).axes
    records = [pack(one) for one in (plant, flight.inputs, axes)]
    inside, back, turned = np.zeros_like(z), np.zeros_like(z), np.zeros_like(z)
    there_and_back(0.0, 0.0, z, start, *records, inside, back, np.zeros_like(z), turned)
    np.testing.assert_allclose(back, z, rtol=1e-14, atol=1e-9)
    # a state at rest in them, a while later: dr/dt by differences is the velocity
    places = []
    for later in (20.0 - 1e-2, 20.0, 20.0 + 1e-2):
        there_and_back(0.0, later, z, start, *records, inside, back, np.zeros_like(z), turned)
        places.append(back.copy())
    still = inside[3:6].copy()
    speed = (places[2][:3] - places[0][:3]) / 2e-2 + np.array(axes.now[0, :9]).reshape(3, 3) @ still
    np.testing.assert_allclose(speed, places[1][3:6], rtol=0.0, atol=2e-5)


def test_the_fall_is_two_body_motion():
    """Against the series' next term: (n t)^6 / 720 of the radius."""
    gm, r, v = 3.986e14, (7.0e6, 0.0, 0.0), (0.0, 7546.0, 0.0)
    rate = np.sqrt(gm / 7.0e6**3)
    place, speed, bend = wrapped_fall(r, v, 30.0, gm)
    angle = 30.0 * v[1] / 7.0e6
    assert abs(np.linalg.norm(place) - 7.0e6) < 0.5
    circle = np.sqrt(gm / 7.0e6)
    place, speed, bend = wrapped_fall(r, (0.0, circle, 0.0), 30.0, gm)
    angle = rate * 30.0
    true = 7.0e6 * np.array([np.cos(angle), np.sin(angle), 0.0])
    assert np.linalg.norm(np.array(place) - true) < 7.0e6 * angle**6 / 700.0
    assert np.linalg.norm(np.array(speed) - circle * np.array([-np.sin(angle), np.cos(angle), 0.0])) < circle * angle**5 / 100.0
    assert np.linalg.norm(np.array(bend) + gm / 7.0e6**3 * true) < 7.0e6 * rate**2 * angle**4 / 20.0


@njit
def wrapped_fall(r, v, t, gm):
    return fall(r, v, t, gm)
