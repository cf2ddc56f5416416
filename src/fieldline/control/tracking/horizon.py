"""The best controls over a horizon within limits: the linear-quadratic problem (1) of `riccati_sweep`, solved exactly.

An active set by exchange of whole blocks: for a set of controls held at their bounds the least value over the others is one
sweep; then every held control that its bound no longer holds is let go, and every other that has left the bounds is held,
all at once. No line search, no penalty: where nothing is left to exchange, the solution is exact. From a shifted last plan
one to three sweeps do.

From far off the exchange may go round in a circle. Where the number of wrong controls stops falling, `interior_point`
takes over, which always comes to the end, and the exchange makes its solution exact.

Sources: Judice and Pires (1994), Computers and Operations Research 21(5):587 (exchange); Hintermueller, Ito and Kunisch
(2002), SIAM J. Optimization 13(3):865 (why it converges fast).
"""

from __future__ import annotations

from numba import njit

from fieldline.control.tracking.bounded_squares import AT_LOWER, AT_UPPER, FREE
from fieldline.control.tracking.interior_point import interior_controls
from fieldline.control.tracking.riccati_sweep import backward, forward, plan_cost, plan_gradient

PATIENCE = 4  # sweeps without fewer wrong controls, after which the exchange gives up
SETTLED = 1e-10  # of the largest gradient at the first sweep
WITHIN = 1e-12  # of a bound's width


@njit(cache=True, error_model="numpy")
def _clipped(problem, u):
    """u brought within the bounds."""
    for k in range(u.shape[0]):
        for j in range(u.shape[1]):
            u[k, j] = min(max(u[k, j], problem.lower[k, j]), problem.upper[k, j])


@njit(cache=True, error_model="numpy")
def _kept(now, value, low, high, gradient, slack):
    """Whether one control is free or at which bound, after a sweep."""
    if now == FREE:
        room = WITHIN * (high - low)
        return AT_LOWER if value < low - room else AT_UPPER if value > high + room else FREE
    pull = -gradient if now == AT_LOWER else gradient
    return FREE if pull > slack else now


@njit(cache=True, error_model="numpy")
def _exchange(problem, u, gradient, held, slack):
    """Let go what its bound no longer holds, hold what has left the bounds; how many were wrong."""
    wrong = 0
    for k in range(u.shape[0]):
        for j in range(u.shape[1]):
            low, high = problem.lower[k, j], problem.upper[k, j]
            if low == high:
                held[k, j], u[k, j] = AT_LOWER, low
                continue
            then = _kept(held[k, j], u[k, j], low, high, gradient[k, j], slack)
            wrong += then != held[k, j]
            held[k, j] = then
            if then != FREE:
                u[k, j] = low if then == AT_LOWER else high
    return wrong


@njit(cache=True, error_model="numpy")
def _settled(problem, u, most_sweeps, slack, sweep):
    """Exchange from the plan and the held set that are there: (sweeps taken, controls that are still wrong)."""
    N, m = u.shape
    fewest, patience, wrong = N * m + 1, PATIENCE, N * m
    _exchange(problem, u, sweep.gradient, sweep.held, 1e300)
    for taken in range(1, most_sweeps + 1):
        plan_cost(problem, u, sweep.x)
        plan_gradient(problem, u, sweep.x, sweep.gradient)
        if not backward(problem, sweep.gradient, sweep.barrier, sweep.held, sweep.gain, sweep.ahead):
            return taken, N * m
        forward(problem, sweep.gain, sweep.ahead, sweep.step)
        u += sweep.step
        plan_cost(problem, u, sweep.x)
        plan_gradient(problem, u, sweep.x, sweep.gradient)
        wrong = _exchange(problem, u, sweep.gradient, sweep.held, slack)
        if wrong == 0:
            return taken, 0
        patience = PATIENCE if wrong < fewest else patience - 1
        fewest = min(fewest, wrong)
        if patience == 0:
            return taken, wrong
    return most_sweeps, wrong


@njit(cache=True, error_model="numpy")
def best_controls(problem, start, u, most_sweeps, sweep):
    """Solve (1) from the state start (n,) in place of u (N, m), warm from it and from sweep.held.

    At most `most_sweeps` of each kind: exchange, interior point, exchange. Returns (sweeps taken, number of controls that are
    still wrong: 0 where the solution is exact); sweep.x has the states.
    """
    sweep.x[0] = start
    sweep.barrier[:] = 0.0
    _clipped(problem, u)
    plan_cost(problem, u, sweep.x)
    slack = SETTLED * plan_gradient(problem, u, sweep.x, sweep.gradient)
    taken, wrong = _settled(problem, u, most_sweeps, slack, sweep)
    if wrong > 0:
        taken += interior_controls(problem, u, most_sweeps, sweep)
        inside = u.copy()
        plan_gradient(problem, u, sweep.x, sweep.gradient)
        more, wrong = _settled(problem, u, most_sweeps, slack, sweep)
        taken += more
        if wrong > 0:
            u[:] = inside
    _clipped(problem, u)
    plan_cost(problem, u, sweep.x)
    return taken, wrong
