"""The best controls over a horizon within limits: a linear-quadratic problem whose input changes along the way.

    least  sum_k 1/2 (x_k - r_k)' Q (x_k - r_k) + 1/2 u_k' R u_k  +  1/2 (x_N - r_N)' P (x_N - r_N)
    x_k+1 = A x_k + B_k u_k + d_k,   lower_k <= u_k <= upper_k                                      (1)

An active set by exchange of whole blocks: for a set of controls held at their bounds the least value over the others is a
Riccati recursion backwards and a sweep forwards; then every held control that its bound no longer holds is let go, and
every other that has left the bounds is held, all at once. No line search, no penalty: where nothing is left to exchange,
the solution is exact. Should the number of wrong controls stop falling, one at a time is exchanged, the last in order,
which cannot cycle. From a shifted last plan one to three steps do.

Each step costs N times what one Riccati step does, some 10,000 multiplications at twelve states and nine controls: linear in N,
where a dense solver's is of the third order. Q and R are diagonals.

Sources: Judice and Pires (1994), Computers and Operations Research 21(5):587 (exchange); Hintermueller, Ito and Kunisch
(2002), SIAM J. Optimization 13(3):865 (why it converges fast); Rao, Wright and Rawlings (1998), J. Optimization Theory and
Applications 99(3):723 (the recursion).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.control.tracking.bounded_squares import AT_LOWER, AT_UPPER, FREE, free_step

PATIENCE = 6  # steps without fewer wrong controls, after which one is exchanged at a time
SETTLED = 1e-10  # of the largest gradient at the first step


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
def _cost(problem, u, x):
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
def _gradient(problem, u, x, gradient):
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
def _exchange(problem, u, gradient, held, slack, one):
    """Let go what its bound no longer holds, hold what has left the bounds (all, or the last alone); how many were wrong."""
    N, m = u.shape
    wrong = 0
    for k in range(N - 1, -1, -1):
        for j in range(m):
            low, high = problem.lower[k, j], problem.upper[k, j]
            if low == high:
                held[k, j], u[k, j] = AT_LOWER, low
                continue
            now = held[k, j]
            if now == FREE:
                then = (
                    AT_LOWER
                    if u[k, j] < low - 1e-12 * (high - low)
                    else AT_UPPER
                    if u[k, j] > high + 1e-12 * (high - low)
                    else FREE
                )
            else:
                pull = -gradient[k, j] if now == AT_LOWER else gradient[k, j]
                then = FREE if pull > slack else now
            if then != now:
                if wrong == 0 or not one:
                    held[k, j] = then
                wrong += 1
            if held[k, j] == AT_LOWER:
                u[k, j] = low
            elif held[k, j] == AT_UPPER:
                u[k, j] = high
    return wrong


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
def _backward(problem, gradient, held, gain, ahead):
    """Gains (N, m, n) and constants (N, m) of the step in the controls that are free; False if a block is not positive."""
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
            block[j, j] += R[j]
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
def _forward(problem, gain, ahead, step):
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
    )


@njit(cache=True, error_model="numpy")
def best_controls(problem, start, u, most_steps, sweep):
    """Solve (1) from the state start (n,) in place of u (N, m), warm from it and from sweep.held.

    Returns (steps taken, number of controls that are still wrong: 0 where the solution is exact); sweep.x has the states.
    """
    N, m = u.shape
    sweep.x[0] = start
    for k in range(N):
        for j in range(m):
            u[k, j] = min(max(u[k, j], problem.lower[k, j]), problem.upper[k, j])
    _cost(problem, u, sweep.x)
    slack = SETTLED * _gradient(problem, u, sweep.x, sweep.gradient)
    _exchange(problem, u, sweep.gradient, sweep.held, 1e300, False)
    fewest, patience, wrong = N * m + 1, PATIENCE, 0
    for taken in range(1, most_steps + 1):
        _cost(problem, u, sweep.x)
        _gradient(problem, u, sweep.x, sweep.gradient)
        if not _backward(problem, sweep.gradient, sweep.held, sweep.gain, sweep.ahead):
            return taken, N * m
        _forward(problem, sweep.gain, sweep.ahead, sweep.step)
        for k in range(N):
            for j in range(m):
                u[k, j] += sweep.step[k, j]
        _cost(problem, u, sweep.x)
        _gradient(problem, u, sweep.x, sweep.gradient)
        wrong = _exchange(problem, u, sweep.gradient, sweep.held, slack, patience <= 0)
        if wrong == 0:
            return taken, 0
        if wrong < fewest:
            fewest, patience = wrong, PATIENCE
        else:
            patience -= 1
    for k in range(N):
        for j in range(m):
            u[k, j] = min(max(u[k, j], problem.lower[k, j]), problem.upper[k, j])
    return most_steps, wrong
