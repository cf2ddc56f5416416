"""The best controls over a horizon: exact against a dense bounded least-squares solution, and against the regulator."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fieldline.control.controllable import orbital_scale
from fieldline.control.electrodynamic import electrodynamic_map
from fieldline.control.tracking.horizon import best_controls
from fieldline.control.tracking.interior_point import interior_controls
from fieldline.control.tracking.riccati_sweep import Horizon, new_sweep
from fieldline.design import tank_with_towers
from fieldline.mechanics.relative_motion import input_matrix, motion_matrix

pytestmark = pytest.mark.kernels
N, STATES, CONTROLS = 12, 6, 4


def problem(seed: int, tight: float = 0.3) -> tuple[Horizon, np.ndarray]:
    """A chain of integrators with inputs that turn, and a start far off."""
    rng = np.random.default_rng(seed)
    A = np.eye(STATES) + 0.2 * np.diag(np.ones(STATES - 1), 1) + 0.02 * rng.normal(size=(STATES, STATES))
    B = 0.3 * rng.normal(size=(N, STATES, CONTROLS))
    bounds = tight * (0.5 + rng.uniform(size=(N, CONTROLS)))
    low = -bounds
    low[:, 0] = 0.0  # pushes only
    low[3, 1] = bounds[3, 1] = 0.0  # and one that is out for a stage
    d, r = 0.02 * rng.normal(size=(N, STATES)), 0.1 * rng.normal(size=(N + 1, STATES))
    P = np.eye(STATES) + 0.2
    return Horizon(A, B, d, r, np.linspace(0.5, 2.0, STATES), np.full(CONTROLS, 0.05), P, low, bounds), rng.normal(size=STATES)


def dense(given: Horizon, start):
    """(controls, cost of any controls) by SciPy, the states eliminated."""
    from scipy.linalg import cholesky
    from scipy.optimize import lsq_linear

    free, by = np.zeros((N + 1, STATES)), np.zeros((N + 1, STATES, N * CONTROLS))
    free[0] = start
    for k in range(N):
        free[k + 1] = given.A @ free[k] + given.d[k]
        by[k + 1] = given.A @ by[k]
        by[k + 1][:, CONTROLS * k : CONTROLS * (k + 1)] += given.B[k]
    roots = [np.diag(np.sqrt(given.Q))] * N + [cholesky(given.P)]
    rows = [root @ one for root, one in zip(roots, by, strict=True)] + [np.diag(np.sqrt(np.tile(given.R, N)))]
    right = [root @ (ref - one) for root, ref, one in zip(roots, given.r, free, strict=True)] + [np.zeros(N * CONTROLS)]
    stacked, right = np.vstack(rows), np.concatenate(right)
    low, high = given.lower.ravel(), given.upper.ravel() + 1e-13
    found = lsq_linear(stacked, right, (low, high), method="bvls", tol=1e-14, max_iter=5000).x
    return found.reshape(N, CONTROLS), lambda u: 0.5 * float(((stacked @ u.ravel() - right) ** 2).sum())


@pytest.mark.parametrize("seed", range(6))
def test_the_same_as_a_dense_solution(seed):
    given, start = problem(seed, tight=0.1 * (seed + 1))
    u, sweep = np.zeros((N, CONTROLS)), new_sweep(N, STATES, CONTROLS)
    taken, wrong = best_controls(given, start, u, 100, sweep)
    best, cost = dense(given, start)
    assert wrong == 0 and taken < 40
    assert (u >= given.lower).all() and (u <= given.upper).all() and (np.abs(u) == given.upper).any()
    assert cost(u) <= cost(best) * (1.0 + 1e-9)
    assert_allclose(u, best, atol=1e-6)
    taken, wrong = best_controls(given, start, u, 100, sweep)
    assert (taken, wrong) == (1, 0)  # warm from itself


def test_without_limits_it_is_the_regulator():
    given, start = problem(1)
    wide = given._replace(lower=np.full((N, CONTROLS), -1e9), upper=np.full((N, CONTROLS), 1e9), d=0.0 * given.d, r=0.0 * given.r)
    u, sweep = np.zeros((N, CONTROLS)), new_sweep(N, STATES, CONTROLS)
    assert best_controls(wide, start, u, 10, sweep) == (1, 0)
    P, gain = wide.P, None
    for k in range(N - 1, -1, -1):
        B = wide.B[k]
        gain = np.linalg.solve(np.diag(wide.R) + B.T @ P @ B, B.T @ P @ wide.A)
        P = np.diag(wide.Q) + wide.A.T @ P @ (wide.A - B @ gain)
    assert_allclose(u[0], -gain @ start, rtol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_from_far_off_it_ends_where_the_exchange_alone_goes_round_in_a_circle(seed):
    given, start = problem(seed, tight=0.02)
    u, sweep = np.zeros((N, CONTROLS)), new_sweep(N, STATES, CONTROLS)
    taken, wrong = best_controls(given, 30.0 * start, u, 50, sweep)
    _, cost = dense(given, 30.0 * start)
    assert wrong == 0 and taken < 60
    assert (u >= given.lower).all() and (u <= given.upper).all()
    slope, step = np.empty(u.size), 1e-4 * given.upper[0, 2]
    for k in range(u.size):  # a quadratic's central difference is its derivative
        more, less = u.ravel().copy(), u.ravel().copy()
        more[k], less[k] = more[k] + step, less[k] - step
        slope[k] = (cost(more) - cost(less)) / (2.0 * step)
    low, high = given.lower.ravel(), given.upper.ravel()
    at_low, at_high, size = u.ravel() == low, u.ravel() == high, np.abs(slope).max()
    assert (slope[at_low & ~at_high] > -1e-6 * size).all() and (slope[at_high & ~at_low] < 1e-6 * size).all()
    assert np.abs(slope[~at_low & ~at_high]).max(initial=0.0) < 1e-6 * size


@pytest.mark.parametrize("tight", [0.02, 0.3])
def test_the_interior_point_comes_to_the_same_end_by_itself(tight):
    given, start = problem(5, tight=tight)
    u, sweep = np.zeros((N, CONTROLS)), new_sweep(N, STATES, CONTROLS)
    sweep.x[0] = start
    taken = interior_controls(given, u, 50, sweep)
    best, cost = dense(given, start)
    assert 5 < taken < 30 and (sweep.barrier == 0.0).all()
    assert (u >= given.lower).all() and (u <= given.upper).all()
    assert cost(u) <= cost(best) * (1.0 + 1e-9)
    exact, held = np.zeros((N, CONTROLS)), sweep.held.copy()
    assert best_controls(given, start, exact, 50, new_sweep(N, STATES, CONTROLS))[1] == 0
    assert_allclose(u, exact, atol=1e-6)
    free = given.upper > given.lower
    assert (held[free] == np.where(exact == given.lower, 1, np.where(exact == given.upper, 2, 0))[free]).all()


# least costs that other solvers find of the problem below: OSQP 1.1.3 (to 1e-10), Clarabel 0.11.1 (to 1e-8), DAQP 0.11.0
PEERS = {"OSQP": 960.555237658816, "Clarabel": 960.555237984897, "DAQP": 960.555237658517}


def vehicles_problem() -> tuple[Horizon, np.ndarray]:
    """A tank with towers 40 m ahead of its place and turned, over the equator: 12 states, 9 controls, 20 stages of 2 min."""
    from scipy.linalg import expm

    tank, n, stage, stages = tank_with_towers(vertical_m=330.0, horizontal_m=310.0), 1.1316e-3, 120.0, 20
    both = np.zeros((18, 18))
    both[:12, :12] = motion_matrix(n, 6.778e6, tank.inertia_kg_m2)
    both[:12, 12:] = input_matrix(tank.mass_kg, tank.inertia_kg_m2, np.eye(6))
    scale = orbital_scale(n)
    turned = expm(both * stage)
    A, pushes = turned[:12, :12] * scale / scale[:, None], turned[:12, 12:] / scale[:, None]
    angle = n * stage * (np.arange(stages) + 0.5)
    fields = np.column_stack([1e-5 * np.cos(angle), 5e-6 * np.sin(angle), np.full(stages, 2.5e-5)])
    limits = np.array([125.0] * 8 + [10.0])
    B = np.array([pushes @ electrodynamic_map(tank, one) * limits for one in fields])
    start = np.zeros(12)
    start[2], start[8] = 40.0, 0.02
    high = np.ones((stages, 9))
    high[:, 0] = 0.2
    zeros = np.zeros((stages + 1, 12))
    return Horizon(A, B, zeros[1:], zeros, np.full(12, 0.1), np.full(9, 1.0), 20.0 * np.eye(12), -high, high), start / scale


def test_the_same_least_cost_as_osqp_clarabel_and_daqp_on_the_vehicles_own_problem():
    given, start = vehicles_problem()
    u, sweep = np.zeros(given.lower.shape), new_sweep(len(given.B), 12, 9)
    _, wrong = best_controls(given, start, u, 50, sweep)
    cost, x = 0.0, start
    for k, row in enumerate(u):
        cost += 0.5 * float(given.Q @ (x * x) + given.R @ (row * row))
        x = given.A @ x + given.B[k] @ row
    cost += 0.5 * float(x @ given.P @ x)
    assert wrong == 0 and 0.2 < (sweep.held > 0).mean() < 0.3
    assert_allclose(sweep.x[-1], x, atol=1e-9)
    assert cost == pytest.approx(PEERS["DAQP"], rel=1e-11)
    assert cost <= min(PEERS.values()) * (1.0 + 1e-12)
    assert cost == pytest.approx(PEERS["OSQP"], rel=1e-11) and cost == pytest.approx(PEERS["Clarabel"], rel=1e-9)
    assert_allclose(u[0], [0.2, *[1.0] * 7, 0.0803011561722], atol=1e-9)  # DAQP's first controls
