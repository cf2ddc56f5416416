"""Conductors, their map and plant; controllability; the regulator of an instant: closed forms, differences, python-control."""

import control
import numpy as np
import pytest
from scipy.linalg import solve_continuous_lyapunov

from fieldline import electrodynamic_map
from fieldline.analysis import controllability_now, controllability_over, removable, steady_state
from fieldline.control.electrodynamic import electrodynamic_plant
from fieldline.control.frozen_regulator import frozen_regulator, respond
from fieldline.control.steady_hold import held_share, holding_controls, most_held_share
from fieldline.design import tank_with_towers
from fieldline.environment.orbital_dipole import dipole_direction_h, orbit_field_h, orbit_gradient_h
from fieldline.errors import InputError, NoEstimateError
from fieldline.mechanics.lorentz import conductor_loads
from fieldline.vehicle import Conductor, Thruster
from fieldline.vehicle.conductor import wires_b

N, R0 = 1.1316188e-3, 6.778e6
FIELD = np.array([8.0e-6, -3.0e-6, 2.5e-5])
ORBIT = {"mean_motion_rad_s": N, "radius_m": R0}
TANK = tank_with_towers()


def body(vehicle):
    return {"mass_kg": vehicle.mass_kg, "inertia_kg_m2": vehicle.inertia_kg_m2}


def test_one_conductor():
    wire = Conductor(position_b_m=(0.0, 3.0, 0.0), direction_b=(2.0, 0.0, 0.0), length_m=10.0)
    loads = electrodynamic_map([wire], (0.0, 0.0, 4e-5))[:, 0]
    assert loads == pytest.approx([0.0, -4e-4, 0.0, 0.0, 0.0, 0.0])  # x times z is -y; the arm lies along the force
    loads = electrodynamic_map([wire], (0.0, 4e-5, 0.0))[:, 0]
    assert loads == pytest.approx([0.0, 0.0, 4e-4, 1.2e-3, 0.0, 0.0])
    assert electrodynamic_map([wire], np.ones((5, 2, 3)) * 1e-5).shape == (5, 2, 6, 1)


def test_force_is_across_the_field_and_does_no_work_on_it():
    field = np.random.default_rng(2).normal(size=(50, 3)) * 3e-5
    loads = electrodynamic_map(TANK, field)
    across = np.einsum("ni,nij->nj", field, loads[:, :3, :8])
    assert np.abs(across).max() < 1e-12 * np.abs(loads).max() * 1e-4
    assert loads[:, :, 8] == pytest.approx(np.tile([0.0, 0.0, 1.0, 0.0, 0.0, 0.0], (50, 1)))


def test_a_split_conductor_is_the_same():
    whole = Conductor(position_b_m=(1.0, 2.0, 3.0), direction_b=(1.0, 1.0, 0.0), length_m=8.0)
    half = [
        Conductor(position_b_m=tuple(np.array([1.0, 2.0, 3.0]) + side * np.array([1.0, 1.0, 0.0]) / 2**0.5),
                  direction_b=(1.0, 1.0, 0.0), length_m=4.0)
        for side in (-2.0, 2.0)
    ]  # fmt: skip
    parts = electrodynamic_map(half, FIELD).sum(axis=1)
    assert parts == pytest.approx(electrodynamic_map([whole], FIELD)[:, 0], abs=1e-18)


def test_the_map_is_the_derivative_of_the_nonlinear_loads():
    wires = wires_b(TANK.conductors)
    linear = electrodynamic_map(TANK.conductors, FIELD)
    for k in range(8):
        step = np.zeros(8)
        step[k] = 1.0
        difference = (conductor_loads(step, *wires, FIELD) - conductor_loads(-step, *wires, FIELD)) / 2.0
        assert difference == pytest.approx(linear[:, k], abs=1e-16)


def test_states_change_the_loads_of_a_current_in_second_order_only():
    # A small current and a small angle or place: what the linear plant leaves out falls with their product.
    direction = dipole_direction_h(0.5, 1.0, 2.0, -1.37)
    field, gradient = orbit_field_h(direction, 2.6e-5), orbit_gradient_h(direction, 2.6e-5, R0)
    wires, linear = wires_b(TANK.conductors), electrodynamic_map(TANK.conductors, orbit_field_h(direction, 2.6e-5))
    current = np.linspace(-1.0, 2.0, 8)
    left = []
    for size in (1.0, 0.1):
        place, angles = size * np.array([300.0, -200.0, 100.0]), size * np.array([0.02, -0.03, 0.01])
        loads = conductor_loads(size * current, *wires, field + gradient @ place, angles)
        left.append(np.abs(loads - linear @ (size * current)).max())
    assert left[0] / left[1] == pytest.approx(100.0, rel=0.1)


def test_the_dipole_and_its_gradient():
    def exact(place):
        r = np.array([R0, 0.0, 0.0]) + place
        u, m = r / np.linalg.norm(r), direction * 2.6e-5 * R0**3
        return (3.0 * (m @ u) * u - m) / np.linalg.norm(r) ** 3

    direction = dipole_direction_h(0.9, 2.0, -0.7, -1.2)
    assert np.linalg.norm(direction) == pytest.approx(1.0, rel=1e-14)
    assert orbit_field_h(direction, 2.6e-5) == pytest.approx(exact(np.zeros(3)), rel=1e-13)
    gradient = orbit_gradient_h(direction, 2.6e-5, R0)
    differences = np.column_stack([(exact(100.0 * e) - exact(-100.0 * e)) / 200.0 for e in np.eye(3)])
    assert gradient == pytest.approx(differences, abs=1e-8 * np.abs(gradient).max())
    assert np.trace(gradient) == pytest.approx(0.0, abs=1e-27) and gradient == pytest.approx(gradient.T)


def test_regulator_is_python_controls():
    plant = electrodynamic_plant(TANK, FIELD, **ORBIT, **body(TANK))
    scale = np.repeat([1.0, 0.01], 6) * np.tile([1.0, N], 6)
    weights = 10.0 * np.repeat([1.0, 1e6], 6)
    found = frozen_regulator(plant.F, plant.G, plant.H, weights, 2.0, rate=N, scale=scale)
    # python-control in scaled numbers, its gain brought back
    f, g = plant.F * scale / scale[:, None] / N, plant.G / scale[:, None] / N
    gain, _, poles = control.lqr(f, g, np.diag(weights * scale**2), 2.0 * np.eye(9))
    assert found.gain == pytest.approx(np.asarray(gain) / scale, rel=1e-5, abs=1e-7 * np.abs(found.gain).max())
    assert np.sort(found.poles.real) == pytest.approx(np.sort(poles.real) * N, rel=1e-5)
    closed = control.ss(plant.F - plant.G @ found.gain, plant.G @ found.prefilter, plant.H, np.zeros((6, 6)))
    assert np.asarray(control.dcgain(closed)) == pytest.approx(np.eye(6), abs=1e-6)
    seconds = np.linspace(0.0, 4000.0, 401)
    reference = np.tile([20.0, -10.0, 5.0, 0.0, 0.0, 0.0], (401, 1))
    start = np.zeros(12)
    start[0] = 40.0
    own = respond(plant.F, plant.G, found, start, reference, seconds)
    theirs = control.forced_response(closed, seconds, reference.T, start)
    assert own.state[:, :6:2] == pytest.approx(theirs.outputs[:3].T, abs=1e-6)


def test_controllability_of_what_is_known():
    F = np.diag([1.0, 2.0, 3.0])
    G = np.array([[1.0], [0.0], [1.0]])
    found = controllability_now(F, G, rate=1.0)
    assert not found.controllable and found.eigenvalue == 2.0 and abs(found.motion[1]) == pytest.approx(1.0)
    many = controllability_now(F, np.stack([G, np.ones((3, 1))]), rate=1.0)
    assert many.controllable.tolist() == [False, True]
    assert np.linalg.matrix_rank(control.ctrb(F, np.ones((3, 1)))) == 3
    # The margin is the distance to the nearest uncontrollable pair: of (double integrator, b) it is known to be near |b|.
    small = controllability_now([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], rate=1.0)
    assert float(small.margin) == pytest.approx(1.0)


def test_over_a_period_a_turning_input_reaches_what_an_instant_does_not():
    # Two unit masses at rest, a push along a direction that turns: each instant reaches a line, the turn the plane.
    turn = 2.0 * np.pi * np.arange(64) / 64
    F = np.zeros((2, 2))
    G = np.stack([np.cos(turn), np.sin(turn)], axis=-1)[..., None]
    assert not controllability_now(F, G, rate=1.0).controllable.any()
    over = controllability_over(F, G, 2.0 * np.pi, rate=1.0)
    assert over.controllable and over.margin == pytest.approx(1.0, rel=1e-9)
    assert over.reach == pytest.approx(np.full(2, np.sqrt(np.pi)), rel=1e-9)
    stuck = controllability_over(F, np.broadcast_to(G[:1], G.shape), 2.0 * np.pi, rate=1.0)
    assert not stuck.controllable and abs(stuck.motion[1]) == pytest.approx(1.0)


def test_the_gramian_over_a_long_period_is_lyapunovs():
    F, G = np.array([[0.0, 1.0], [-1.0, -0.2]]), np.array([[0.0], [1.0]])
    period = 60.0  # long enough for the infinite Gramian
    over = controllability_over(F, np.broadcast_to(G, (6000, 2, 1)), period, rate=1.0)
    gramian = solve_continuous_lyapunov(F, -G @ G.T)
    assert over.reach**2 == pytest.approx(np.linalg.eigvalsh(gramian), rel=1e-3)


def test_steady_state_controllability():
    # Two outputs, one control: only one combination is held.
    F, G, H = -np.eye(2), np.array([[1.0], [1.0]]), np.eye(2)
    found = steady_state(F, G, H, rate=1.0)
    assert not found.controllable and abs(found.lost @ [1.0, 1.0]) < 1e-12
    assert steady_state(F, np.eye(2), H, rate=1.0).controllable


def test_what_cannot_be_held_is_what_lies_along_the_field():
    plant = electrodynamic_plant(TANK.conductors, FIELD, **ORBIT, **body(TANK))
    found = steady_state(plant.F, plant.G, plant.H, rate=N, scale=np.repeat([1.0, 0.01], 6) * np.tile([1.0, N], 6))
    assert not found.controllable
    # -3 n^2 M x Bx + n^2 M z Bz = 0 is held, and nothing else
    lost = FIELD * [-3.0, 0.0, 1.0]
    assert abs(found.lost[:3] @ lost) == pytest.approx(np.linalg.norm(lost), rel=1e-9)
    held = np.array([FIELD[2], 7.0e-5, 3.0 * FIELD[0], 0.0, 0.0, 0.0]) * 1e6
    u = holding_controls(plant.F, plant.G, plant.H, held)
    assert plant.F @ (plant.H.T @ held) + plant.G @ u == pytest.approx(np.zeros(12), abs=1e-15)
    with pytest.raises(NoEstimateError, match="along the field"):
        holding_controls(plant.F, plant.G, plant.H, held + np.eye(6)[0])


def test_shares_that_limits_hold():
    F, H = np.zeros((2, 2)), np.eye(2)
    F[0, 0] = F[1, 1] = 1.0
    G = np.array([[1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    share, u = most_held_share(F, G, H, [-10.0, -1.0], [2.0, 3.0, np.inf])
    assert share == pytest.approx(0.5) and u == pytest.approx([2.0, 3.0, 0.5])
    assert held_share(holding_controls(F, G, H, [-10.0, -1.0]), [2.0, 3.0, np.inf]) == pytest.approx(0.4)
    with pytest.raises(InputError, match="limits must be positive"):
        most_held_share(F, G, H, [1.0, 1.0], [0.0, 1.0, 1.0])


def test_removable_counts():
    F, G = np.diag([1.0, 2.0]), np.array([[1.0, 0.0, 1.0], [0.0, 1.0, 1.0]])
    found = dict(removable(F, G, 2, rate=1.0))
    assert {subset for subset, margin in found.items() if margin > 1e-6} == {(0, 1)}
    with pytest.raises(InputError, match="lost must be between 1 and 2"):
        removable(F, G, 3, rate=1.0)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: Conductor(position_b_m=(0, 0, 0), direction_b=(1, 0, 0), length_m=0.0), "length_m"),
        (lambda: Conductor(position_b_m=(0, 0, 0), direction_b=(0, 0, 0), length_m=1.0), "direction_b must be a direction"),
        (lambda: Conductor(position_b_m=(0, 0, 0), direction_b=(1, 0, 0), length_m=1.0, current_max_a=0.0), "current_max_a"),
        (lambda: electrodynamic_map([], FIELD), "needs a conductor or a thruster"),
        (lambda: electrodynamic_map(["wire"], FIELD), "holds Conductor and Thruster records; got str"),
        (lambda: electrodynamic_map(3, FIELD), "a vehicle has conductors and thrusters"),
        (lambda: electrodynamic_map(TANK, (1.0, 2.0)), r"end in an axis of length 3"),
        (lambda: electrodynamic_map(TANK, (0.0, 0.0, 26000.0)), "Is it in nT"),
        (lambda: tank_with_towers(tower_kg_per_m=-1.0), "tower_kg_per_m must be a positive number"),
    ],
)
def test_bad_input(call, words):
    with pytest.raises(InputError, match=words):
        call()


def test_parallel_conductors_say_what_they_cannot_push():
    wires = [Conductor(position_b_m=(0.0, y, 0.0), direction_b=(0.0, s, 0.0), length_m=9.0) for y, s in ((5, 1), (-5, -1))]
    given = {**ORBIT, "mass_kg": 100.0, "inertia_kg_m2": (5.0, 6.0, 7.0)}
    with pytest.raises(InputError, match=r"lie along \(0, 1, 0\) .* no force along that direction"):
        electrodynamic_plant(wires, FIELD, **given)
    jet = Thruster(position_b_m=(0.0, 0.0, 0.0), direction_b=(0.0, 1.0, 0.0), force_n=1.0)
    assert electrodynamic_plant([*wires, jet], FIELD, **given).controls == ("conductor_1", "conductor_2", "thruster_1")


def test_weights_and_plants_that_no_regulator_helps():
    with pytest.raises(InputError, match="state_weights must be positive"):
        frozen_regulator(np.eye(2), np.eye(2), np.eye(2), [1.0, 0.0], 1.0)
    with pytest.raises(NoEstimateError, match="out of reach"):
        frozen_regulator(np.eye(2), np.array([[1.0], [0.0]]), np.eye(2), 1.0, 1.0)
