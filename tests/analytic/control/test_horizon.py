"""The best controls over a horizon: exact against a dense bounded least-squares solution, and against the regulator."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fieldline.control.tracking.horizon import Horizon, best_controls, new_sweep

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
