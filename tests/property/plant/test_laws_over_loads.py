"""Laws that hold for every load of the registry `plant_loads.LOADS`, whatever it is.

A load that conserves keeps its energy, one that dissipates never adds any, one that exchanges keeps the whole momentum;
a load that is switched off does nothing; and none knows the sign of q, the order of the bodies or how axes were chosen.
"""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import plant_flights as pf
from fieldline.dynamics.load_log import LOADS as NAMES
from fieldline.dynamics.loads.hysteresis import induction_rate
from plant_loads import AXES, LOADS, ROD, everything

named = {"ids": lambda load: load.name}
CONSERVATIVE = [load for load in LOADS if load.nature == "conservative"]
DISSIPATIVE = [load for load in LOADS if load.nature == "dissipative" and load.energy is not None]
# Method, change of energy over its size in 2,000 s and in a day. A tumbler of 3.7 deg/s: 1e-9 and 2e-8 with RK4 at 1 s,
# 1e-8 and 2e-7 with DOP853 at its usual tolerances; orbits 1e-14, with the oblateness 5e-10 (the Earth's pole wanders).
METHODS = {"rk4": ({"step_s": 1.0}, 3e-9, 1e-7), "dop853": ({"method": "dop853"}, 3e-8, 1e-6)}
DAY_S = 86400.0


def integrator(method, load):
    chosen = dict(METHODS[method][0])
    if method == "rk4" and "line" in load.name:
        chosen["step_s"] = 0.2  # the stretch swings at 0.35 rad/s and the bodies on their attachments at 3 rad/s
    return chosen


def drift(load, method, seconds):
    """Change of a load's energy, over the largest change that its kinetic part makes (or its own size, where that is still)."""
    flight = load.flight(seconds=seconds, output=seconds / 200.0, integrator=integrator(method, load))
    flight.fly()
    _, states = pf.rows(flight)
    energy = load.energy(flight, states)
    # spin is measured in spin, orbits in what the orbit has
    size = np.abs(pf.spin_energy(flight, states)).max() if abs(energy[0]) < 1e3 else np.abs(energy).max()
    return (energy - energy[0]) / size


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("load", CONSERVATIVE, **named)
def test_a_conservative_load_conserves(load, method):
    assert np.abs(drift(load, method, 2000.0)).max() < METHODS[method][1]


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("load", CONSERVATIVE, **named)
def test_a_conservative_load_conserves_over_a_day(load, method):
    assert np.abs(drift(load, method, DAY_S)).max() < METHODS[method][2]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("load", DISSIPATIVE, **named)
def test_a_dissipative_load_never_adds(load, method):
    change = drift(load, method, 2000.0)
    assert np.diff(change).max() < METHODS[method][1] and change[-1] < -1e-10


@pytest.mark.kernels
@pytest.mark.parametrize("low, high", [(-40.0, 40.0), (-5.0, 30.0), (-2000.0, 2000.0), (1.0, 2.0)])
def test_a_rod_takes_energy_in_every_closed_cycle(low, high):
    """The integral of H db over a cycle, once its path has closed, is not negative: the area of the loop."""
    numbers = (ROD["saturation_tesla"], ROD["remanence_tesla"], ROD["coercivity_a_m"])
    angle = np.linspace(0.0, 2.0 * np.pi, 2001)
    field = 0.5 * (high + low) - 0.5 * (high - low) * np.cos(angle)
    b, work = 0.0, 0.0
    for _ in range(8):
        start, work = b, 0.0
        for before, after in pairwise(field):
            # midpoint rule in H
            half = b + 0.5 * (after - before) * induction_rate(before, np.sign(after - before), b, *numbers) * np.sign(
                after - before
            )
            mean = 0.5 * (before + after)
            change = induction_rate(mean, np.sign(after - before), half, *numbers) * abs(after - before)
            b, work = b + change, work + mean * change
    assert abs(b - start) < 0.02 * np.ptp(field) * 1e-4 + 0.05 * abs(b) + 1e-5
    assert work > 0.0
    assert abs(b) <= ROD["saturation_tesla"]


@pytest.mark.kernels
def test_internal_loads_push_nothing_as_a_whole():
    """Forces and torques about one point that lines and wheels make: none, to rounding, at states at random."""
    flight = everything()
    for seed in range(10):
        y = pf.random_state(flight, seed)
        out, log = pf.rates(flight, 0.0, y)
        states = y[:39].reshape(3, 13)
        force, torque_b = log[NAMES.index("lines"), :, :3], log[NAMES.index("lines"), :, 3:]
        turn = pf.turned(states)
        about_first = np.cross(states[:, :3] - states[0, :3], force) + turn.apply(torque_b)
        tension = np.abs(force).max()
        assert np.abs(force.sum(axis=0)).max() <= 1e-15 * tension
        # arms of a kilometre between places 7,000 km out, known to a nanometre
        assert np.abs(about_first.sum(axis=0)).max() < 1e-8 * tension
        motors = log[NAMES.index("wheels"), 0, 3:]
        assert np.allclose(motors, -np.array(AXES).T @ out[36:39], rtol=1e-14)


@pytest.mark.parametrize("load", [load for load in LOADS if load.nature == "exchange"], **named)
@pytest.mark.parametrize("method", METHODS)
def test_what_is_exchanged_is_kept(load, method):
    """Angular momentum about the Earth's centre, the bodies' own and their wheels' included; about its own centre where alone."""
    flight = load.flight(seconds=300.0, output=10.0, integrator={"step_s": 0.05} if method == "rk4" else {"method": method})
    flight.fly()
    _, states = pf.rows(flight)
    bodies = len(flight.scenario.body)
    wheels = pf.rest(flight) @ np.array(AXES) if load.name == "wheels" else None
    spin = sum(pf.spin_momentum(flight, states, b, wheels) for b in range(bodies))
    if bodies == 1:
        assert np.abs(spin - spin[0]).max() < 2e-8 * np.linalg.norm(spin[0])
        assert np.ptp(np.linalg.norm(states[:, 0, 10:13], axis=1)) > 1e-3  # the wheels did something
        return
    orbit = sum(record.mass_kg * np.cross(states[:, b, :3], states[:, b, 3:6]) for b, record in enumerate(flight.scenario.body))
    whole = orbit + spin
    assert np.abs(whole - whole[0]).max() < 1e-12 * np.linalg.norm(whole[0]) + 1e-3 * np.abs(spin).max()


@pytest.mark.kernels
@pytest.mark.parametrize("load", [load for load in LOADS if load.bodies[0] != pf.body()], **named)
def test_a_load_switched_off_does_nothing(load):
    """Without its keys every other load is what it was, to the bit, and the plain tumbler's rates come back."""
    plain = pf.Flight(pf.scenario(*[pf.body(b["name"], **_place(b)) for b in load.bodies]))
    flight = load.flight()
    y = flight.start
    bare = y[: 13 * len(load.bodies)]
    ours, log = pf.rates(plain, 3.0, bare)
    acting = np.flatnonzero([np.any(row) for row in log])
    assert [NAMES[k] for k in acting] == ["gravity"]
    _, whole = pf.rates(flight, 3.0, y)
    assert np.array_equal(whole[0], log[0])
    inertia = pf.inertia_of(plain)
    omega = bare[10:13]
    assert np.allclose(ours[9:12], np.linalg.solve(inertia, -np.cross(omega, inertia @ omega)), rtol=1e-13)


def _place(record):
    """Where a body starts and how it turns, of its table."""
    return {key: record[key] for key in ("mass_kg", "rate_deg_s", "offset_o_m", "offset_rate_o_m_s") if key in record}


def _turned_body(record, turn):
    """The same body, described in axes turned by `turn`: v_new = turn v_old."""
    new = dict(record)
    for key, value in record.items():
        if key in ("inertia_kg_m2", "induced_dipole_a_m2_tesla", "eddy_damping_n_m_s_tesla2"):
            tensor = np.diag(value) if np.ndim(value) == 1 else np.array(value)
            tensor = turn @ tensor @ turn.T
            new[key] = (0.5 * (tensor + tensor.T)).tolist()
        elif key in ("residual_dipole_a_m2", "disturbance_torque_b_n_m", "rate_deg_s") or key.endswith(("_b", "_b_m")):
            new[key] = (turn @ np.array(value)).tolist()
        elif isinstance(value, dict) and key != "attitude":
            new[key] = _turned_body(value, turn)
        elif isinstance(value, list | tuple) and value and isinstance(value[0], dict) and key != "load":
            new[key] = [_turned_body(one, turn) for one in value]
    return new


@pytest.mark.kernels
@pytest.mark.parametrize("load", [load for load in LOADS if load.name != "user"], **named)
def test_the_choice_of_body_axes_means_nothing(load):
    turn = Rotation.random(random_state=5).as_matrix()
    first = load.flight()
    bodies = tuple(_turned_body(b, turn) for b in load.bodies)
    tables = dict(load.tables)
    if "line" in tables:
        tables["line"] = [_turned_body(line, turn) for line in tables["line"]]
    other = type(load)(load.name, load.nature, bodies, tables, load.energy, load.inputs).flight()
    other.y[:] = first.y
    for b in range(len(bodies)):
        row = other.y[13 * b : 13 * b + 13]
        row[6:10] = (Rotation.from_quat(row[6:10]) * Rotation.from_matrix(turn.T)).as_quat()
        row[10:13] = turn @ row[10:13]
    (ours, log), (theirs, their_log) = pf.rates(first, 2.0), pf.rates(other, 2.0)
    slack = 1e-8 if "line" in load.name else 0.0
    for b in range(len(bodies)):
        assert np.allclose(ours[12 * b : 12 * b + 6], theirs[12 * b : 12 * b + 6], rtol=1e-13, atol=slack)
        for j in (6, 9):
            part = slice(12 * b + j, 12 * b + j + 3)
            assert np.allclose(turn @ ours[part], theirs[part], rtol=1e-12, atol=1e-15 + slack)
        assert np.allclose(log[:, b, 3:] @ turn.T, their_log[:, b, 3:], rtol=1e-11, atol=1e-17 + slack)
    assert np.allclose(ours[12 * len(bodies) :], theirs[12 * len(bodies) :], rtol=1e-11, atol=1e-18)


@pytest.mark.kernels
def test_the_order_of_the_bodies_means_nothing():
    names = ("one", "two", "three")
    first = everything()
    for order in ((2, 0, 1), (1, 2, 0)):
        other = everything(order)
        y = other.start.copy()
        for place, b in enumerate(order):
            y[13 * place : 13 * place + 13] = first.start[13 * b : 13 * b + 13]
        tail_first, tail_other = first.start[39:], y[39:]
        wheels = {0: tail_first[:3], 1: tail_first[3:4], 2: tail_first[:0]}  # three of "one", one of "two"; rods of "one"
        tail_other[:4] = np.concatenate([wheels[b] for b in order])
        tail_other[4:] = tail_first[4:]
        ours, log = pf.rates(first, 4.0)
        theirs, their_log = pf.rates(other, 4.0, y)
        for place, b in enumerate(order):
            assert [body.name for body in other.scenario.body][place] == names[b]
            assert np.allclose(theirs[12 * place : 12 * place + 12], ours[12 * b : 12 * b + 12], rtol=1e-13, atol=1e-16)
            assert np.allclose(their_log[:, place], log[:, b], rtol=1e-13, atol=1e-20)


@pytest.mark.kernels
def test_the_choice_of_inertial_axes_means_nothing():
    """All that does not lean on the Earth's axes: turned places, velocities, attitudes and field turn forces and no torque."""
    turn = Rotation.random(random_state=8)
    for load in LOADS:
        if load.name in ("oblateness", "drag", "solar_pressure", "user"):
            continue
        flight = load.flight()
        y = flight.start.copy()
        ours, log = pf.rates(flight, 0.0, y)
        for b in range(len(load.bodies)):
            row = y[13 * b : 13 * b + 13]
            row[:3], row[3:6] = turn.apply(row[:3]), turn.apply(row[3:6])
            row[6:10] = (turn * Rotation.from_quat(row[6:10])).as_quat()
        flight.plant.surroundings.uniform_field_i[:] = turn.apply(pf.UNIFORM)
        theirs, their_log = pf.rates(flight, 0.0, y)
        slack = 1e-8 if "line" in load.name else 0.0
        for b in range(len(load.bodies)):
            assert np.allclose(turn.apply(log[:, b, :3]), their_log[:, b, :3], rtol=1e-12, atol=1e-13 + slack)
            assert np.allclose(log[:, b, 3:], their_log[:, b, 3:], rtol=1e-11, atol=1e-16 + slack)
            assert np.allclose(ours[12 * b + 9 : 12 * b + 12], theirs[12 * b + 9 : 12 * b + 12], rtol=1e-12, atol=1e-16 + slack)
