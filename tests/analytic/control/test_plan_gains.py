"""The gain of a plan without active limits: the solver's own plan, the law's own answer, and the regulator for a long one."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from numpy.testing import assert_allclose

from fieldline.control import LAWS
from fieldline.control.tracking import onboard_vehicle as own
from fieldline.control.tracking.by_prediction import _problem
from fieldline.control.tracking.horizon import best_controls
from fieldline.control.tracking.plan_gains import plan_gains
from fieldline.control.tracking.riccati_sweep import Horizon, new_sweep
from fieldline.design import tank_with_towers
from fieldline.sensing.measurement import new_measurement
from fieldline.vehicle import Thruster
from law_tests import CARRIER

pytestmark = pytest.mark.kernels
N = 7668.6 / 6.778e6


def test_it_is_the_first_control_of_the_solver():
    rng = np.random.default_rng(5)
    A, B = np.eye(5) + 0.1 * rng.standard_normal((5, 5)), 0.4 * rng.standard_normal((9, 5, 3))
    Q, R, P, start = rng.uniform(0.5, 2.0, 5), rng.uniform(0.1, 1.0, 3), 3.0 * np.eye(5), rng.standard_normal(5)
    free = np.full((9, 3), 1e9)
    given = Horizon(A, B, np.zeros((9, 5)), np.zeros((10, 5)), Q, R, P, -free, free)
    plan = np.zeros((9, 3))
    _, wrong = best_controls(given, start, plan, 20, new_sweep(9, 5, 3))
    assert wrong == 0
    assert_allclose(plan[0], -plan_gains(A, lambda k: B[k][None], Q, R, P, 9)[0] @ start, rtol=1e-9, atol=1e-12)


def test_a_long_plan_is_the_regulator():
    rng = np.random.default_rng(6)
    A, B = np.eye(4) + 0.2 * rng.standard_normal((4, 4)), rng.standard_normal((4, 2))
    P = scipy.linalg.solve_discrete_are(A, B, np.eye(4), np.eye(2))
    K = np.linalg.solve(np.eye(2) + B.T @ P @ B, B.T @ P @ A)
    for after, stages in ((np.zeros((4, 4)), 200), (P, 1)):
        assert_allclose(plan_gains(A, lambda _: B[None], np.ones(4), np.ones(2), after, stages)[0], K, rtol=1e-9, atol=1e-12)


def turning():
    seconds = np.arange(120) * 2.0 * np.pi / N / 120
    h = np.column_stack([1e-5 * np.cos(N * seconds), 5e-6 * np.sin(N * seconds), np.full(120, 2.5e-5)])
    return seconds, h @ np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]), h


def beside(place, rate=(0.0, 0.0, 0.0)):
    """A measurement in the target's turning axes, which are GCRS here."""
    m = new_measurement()
    velocity = rate + np.cross([0.0, 0.0, N], place)
    m.position_i[:], m.velocity_i[:] = np.array([6.778e6, 0.0, 0.0]) + place, np.array([0.0, 7668.6, 0.0]) + velocity
    m.relative_position_i[:], m.relative_velocity_i[:] = place, velocity
    m.q_bi[:], m.omega_bi_b[:], m.field_i[:] = (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, N), (1e-5, 0.0, 2.5e-5)
    m.valid[:] = 1.0
    return m


TANK = tank_with_towers(vertical_m=330.0, horizontal_m=310.0)


@pytest.fixture(scope="module")
def context():
    pair = [
        Thruster(name=name, position_b_m=(0.0, 0.0, -50.0 * way), direction_b=(0.0, 0.0, way), force_n=10.0)
        for name, way in (("south", 1.0), ("north", -1.0))
    ]
    return replace(
        CARRIER,
        inertia_kg_m2=np.diag(TANK.inertia_kg_m2),
        mean_motion_rad_s=N,
        mass_kg=TANK.mass_kg,
        radius_m=6.778e6,
        period_s=10.0,
        conductors=TANK.conductors,
        thrusters=tuple(pair),
        field_along_orbit=turning,
    )


def test_the_first_control_is_for_now_and_not_for_the_middle_of_its_stage(context):
    # 10 s before the end of its way at 20 mm/s the body still takes -2 n M y' upwards; half a stage later it stands.
    law, rate = LAWS["tracking-predictive"], -0.02
    table = {"from_h_m": [0.0, 30.0, 0.0], "move_s": 3000.0, "closing_rate_m_s": -rate, "disturbance_s": 0.0, "filter_s": 0.0}
    params = law.pack(table, context)
    command = law.kernel(2990.0, beside(np.array([0.0, 0.2, 0.0]), (0.0, rate, 0.0)), np.zeros(law.memory), params)
    push = np.zeros(3)
    for wire, current in zip(TANK.conductors, command[2:], strict=True):
        push += current * wire.length_m * np.cross(wire.direction_b, (1e-5, 0.0, 2.5e-5))
    assert push[0] == pytest.approx(-2.0 * N * TANK.mass_kg * rate, rel=0.05)


def test_the_law_within_its_limits_is_this_gain(context):
    law = LAWS["tracking-predictive"]
    place = np.array([0.0, 100.0, 0.0])
    params = law.pack({"place_h_m": place.tolist(), "disturbance_s": 0.0, "filter_s": 0.0}, context)
    m, base = int(params[own.CONTROLS]), own.law_at(params)
    first, memory = np.empty((6, m)), np.zeros(law.memory)
    own.effect_of(params, (1e-5, 0.0, 2.5e-5), first)
    stages = int(params[base])
    problem = _problem(0.0, first, memory, params, base, np.zeros((stages, m)))
    K = plan_gains(problem.A, lambda k: problem.B[k][None], problem.Q, problem.R, problem.P, stages)[0]
    limits = np.append(np.full(8, 125.0), 10.0)
    scales = params[base + 5 + 228 + m + 144 :][:12]
    rest = law.kernel(0.0, beside(place), np.zeros(law.memory), params)[2:]
    for error in ((0.02, 0.0, 0.0), (0.0, -0.05, 0.0), (0.01, 0.03, 0.02)):
        state = np.zeros(12)
        state[:6:2] = error
        told = law.kernel(0.0, beside(place + error), np.zeros(law.memory), params)[2:]
        expected = -(K @ (state / scales) * limits)[:8]
        assert_allclose(told - rest, expected, atol=2e-4 * np.abs(expected).max())
