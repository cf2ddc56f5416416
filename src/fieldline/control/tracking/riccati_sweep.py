"""The recursion of a linear-quadratic problem whose input changes along the way: cost, gradient, a Newton step.

    least  sum_k 1/2 (x_k - r_k)' Q (x_k - r_k) + 1/2 u_k' R u_k  +  1/2 (x_N - r_N)' P (x_N - r_N)
    x_k+1 = A x_k + B_k u_k + d_k,   lower_k <= u_k <= upper_k                                      (1)

For a set of controls that stay where they are, the step of the others to the least value is a Riccati recursion backwards
and a sweep forwards: N times what one Riccati step does, some 10,000 multiplications at twelve states and nine controls,
linear in N, where a dense factor is of the third order. Q and R are diagonals. `horizon` and `interior_point` find the set.

Source: Rao, Wright and Rawlings (1998), J. Optimization Theory and Applications 99(3):723.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.control.tracking.bounded_squares import FREE, free_step


class Horizon(NamedTuple):
    """Problem (1): A (n, n), B (N, n, m), d (N, n), r (N + 1, n), Q (n,), R (m,), P (n, n), lower, upper (N, m)."""

    A: np.ndarray
    B: np.ndarray
    d: np.ndarray
    r: np.ndarray
    Q: np.ndarray
    R: np.ndarray
    P: np.ndarray
    lower: np.ndarray
    upper: np.ndarray


class Sweep(NamedTuple):
    """What a solution works on; nothing of it outlives a call."""

    x: np.ndarray  # (N + 1, n)
    gradient: np.ndarray  # (N, m)
    held: np.ndarray  # (N, m) int64
    gain: np.ndarray  # (N, m, n)
    ahead: np.ndarray  # (N, m)
    step: np.ndarray  # (N, m)
    below: np.ndarray  # (N, m) multipliers of the lower bounds
    above: np.ndarray  # (N, m) of the upper
    barrier: np.ndarray  # (N, m) what stands in for the bounds; zero in the exchange


@njit(cache=True, error_model="numpy")
def _next(problem, k, x, u, out):
    """out = A x + B_k u + d_k."""
    A, B, d = problem.A, problem.B, problem.d
    for i in range(x.shape[0]):
        total = d[k, i]
        for j in range(x.shape[0]):
            total += A[i, j] * x[j]
        for j in range(u.shape[0]):
            total += B[k, i, j] * u[j]
        out[i] = total


@njit(cache=True, error_model="numpy")
def plan_cost(problem, u, x):
    """The cost of controls u (N, m) from x[0]; x is filled."""
    Q, R, P, r = problem.Q, problem.R, problem.P, problem.r
    N, n = u.shape[0], x.shape[1]
    total = 0.0
    for k in range(N):
        _next(problem, k, x[k], u[k], x[k + 1])
        for i in range(n):
            total += 0.5 * Q[i] * (x[k, i] - r[k, i]) ** 2
        for j in range(u.shape[1]):
            total += 0.5 * R[j] * u[k, j] * u[k, j]
    for i in range(n):
        for j in range(n):
            total += 0.5 * (x[N, i] - r[N, i]) * P[i, j] * (x[N, j] - r[N, j])
    return total


@njit(cache=True, error_model="numpy")
def plan_gradient(problem, u, x, gradient):
    """Gradient (N, m) by the costates; its largest size."""
    A, B, Q, R, P, r = problem.A, problem.B, problem.Q, problem.R, problem.P, problem.r
    N, n, m = u.shape[0], x.shape[1], u.shape[1]
    costate, before = np.zeros(n), np.zeros(n)
    for i in range(n):
        for j in range(n):
            costate[i] += P[i, j] * (x[N, j] - r[N, j])
    largest = 0.0
    for k in range(N - 1, -1, -1):
        for j in range(m):
            total = R[j] * u[k, j]
            for i in range(n):
                total += B[k, i, j] * costate[i]
            gradient[k, j] = total
            largest = max(largest, abs(total))
        for i in range(n):
            total = Q[i] * (x[k, i] - r[k, i])
            for j in range(n):
                total += A[j, i] * costate[j]
            before[i] = total
        costate[:] = before
    return largest


@njit(cache=True, error_model="numpy")
def _weighed(cost, transition, out):
    """out = cost transition, both (n, n) or (n, n) with (n, m)."""
    out[:] = 0.0
    for i in range(cost.shape[0]):
        for k in range(cost.shape[1]):
            c = cost[i, k]
            for j in range(transition.shape[1]):
                out[i, j] += c * transition[k, j]


@njit(cache=True, error_model="numpy")
def backward(problem, gradient, barrier, held, gain, ahead):
    """Gains (N, m, n) and constants (N, m) of the step in the controls that are free; False if a block is not positive.

    gradient (N, m) at the controls from which the step is taken; barrier (N, m) is added to R.
    """
    A, Q, R = problem.A, problem.Q, problem.R
    N, n, m = problem.B.shape
    cost, push = problem.P.copy(), np.zeros(n)
    pa, pb, block, across = np.empty((n, n)), np.empty((n, m)), np.empty((m, m)), np.empty((m, n))
    factor, column, slope, solved = np.empty((m, m)), np.empty(m), np.empty(m), np.empty(n)
    for k in range(N - 1, -1, -1):
        B = problem.B[k]
        _weighed(cost, A, pa)
        _weighed(cost, B, pb)
        block[:] = 0.0
        across[:] = 0.0
        for i in range(n):
            for j in range(m):
                b = B[i, j]
                for row in range(m):
                    block[j, row] += b * pb[i, row]
                for row in range(n):
                    across[j, row] += b * pa[i, row]
        for j in range(m):
            block[j, j] += R[j] + barrier[k, j]
            total = gradient[k, j]
            for i in range(n):
                total += B[i, j] * push[i]
            slope[j] = total
        if not free_step(block, slope, held[k], factor, column):
            return False
        ahead[k] = column
        _solve_all(factor, across, held[k], gain[k])
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += A[j, i] * push[j]
            for j in range(m):
                total += across[j, i] * column[j]
            solved[i] = total
        push[:] = solved
        for i in range(n):
            for j in range(n):
                cost[i, j] = 0.0
        for row in range(n):
            for i in range(n):
                a = A[row, i]
                if a != 0.0:
                    for j in range(n):
                        cost[i, j] += a * pa[row, j]
        for row in range(m):
            if held[k, row] == FREE:
                for i in range(n):
                    a = across[row, i]
                    for j in range(n):
                        cost[i, j] += a * gain[k, row, j]
        for i in range(n):
            cost[i, i] += Q[i]
            for j in range(i):
                mean = 0.5 * (cost[i, j] + cost[j, i])
                cost[i, j] = cost[j, i] = mean
    return True


@njit(cache=True, error_model="numpy")
def _solve_all(factor, across, held, gain):
    """gain = -block^-1 across (m, n) over the free rows, zero elsewhere, from the Cholesky factor that is there."""
    m, n = across.shape
    for i in range(m):
        gain[i, :] = 0.0
        if held[i] != FREE:
            continue
        for j in range(n):
            gain[i, j] = -across[i, j]
        for k in range(i):
            if held[k] == FREE:
                part = factor[i, k]
                for j in range(n):
                    gain[i, j] -= part * gain[k, j]
        for j in range(n):
            gain[i, j] /= factor[i, i]
    for i in range(m - 1, -1, -1):
        if held[i] != FREE:
            continue
        for k in range(i + 1, m):
            if held[k] == FREE:
                part = factor[k, i]
                for j in range(n):
                    gain[i, j] -= part * gain[k, j]
        for j in range(n):
            gain[i, j] /= factor[i, i]


@njit(cache=True, error_model="numpy")
def forward(problem, gain, ahead, step):
    """The step (N, m) of all controls."""
    A = problem.A
    N, n, m = problem.B.shape
    here, then = np.zeros(n), np.zeros(n)
    for k in range(N):
        for j in range(m):
            total = ahead[k, j]
            for i in range(n):
                total += gain[k, j, i] * here[i]
            step[k, j] = total
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += A[i, j] * here[j]
            for j in range(m):
                total += problem.B[k, i, j] * step[k, j]
            then[i] = total
        here[:] = then


@njit(cache=True, error_model="numpy")
def new_sweep(N, n, m):
    """Room for a solution."""
    return Sweep(
        np.zeros((N + 1, n)),
        np.zeros((N, m)),
        np.zeros((N, m), dtype=np.int64),
        np.zeros((N, m, n)),
        np.zeros((N, m)),
        np.zeros((N, m)),
        np.zeros((N, m)),
        np.zeros((N, m)),
        np.zeros((N, m)),
    )
