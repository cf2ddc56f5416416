"""The best controls over a horizon within limits, from anywhere: a primal-dual interior-point method on `riccati_sweep`.

    (H + D) du = -g + mu (1/(u - lower) - 1/(upper - u)),   D = z/(u - lower) + y/(upper - u)       (1)

g, H: gradient and Hessian of the cost over all controls, never formed; z, y: multipliers of the bounds; D is a diagonal
that is added to R, so a step costs what any other sweep does. A share of the mean of z (u - lower) and y (upper - u) is
aimed at, the smaller the longer the last step was; u stays strictly inside. Ten to twenty sweeps, whatever the start.

Source: Wright (1997), Primal-Dual Interior-Point Methods, SIAM, ch. 5; Rao, Wright and Rawlings (1998).
"""

from __future__ import annotations

from numba import njit

from fieldline.control.tracking.bounded_squares import AT_LOWER, AT_UPPER, FREE
from fieldline.control.tracking.riccati_sweep import backward, forward, plan_cost, plan_gradient

INSIDE = 0.05  # of the width, from the bounds at least at the start
TO_THE_WALL = 0.995  # of the way to a bound that a step may go
CLOSE = 1e-13  # mean complementarity, of that at the start, where the method ends
LONG = 0.9  # share of a step from which little centring is needed


@njit(cache=True, error_model="numpy")
def _begun(problem, u, sweep):
    """u inside its bounds, multipliers of the gradient's size, all free; mean complementarity, and the number of free ones."""
    scale = 0.0
    count = 0
    for k in range(u.shape[0]):
        for j in range(u.shape[1]):
            low, high = problem.lower[k, j], problem.upper[k, j]
            sweep.held[k, j] = FREE if low < high else AT_LOWER
            edge = INSIDE * (high - low)
            u[k, j] = min(max(u[k, j], low + edge), high - edge) if low < high else low
    plan_cost(problem, u, sweep.x)
    scale = max(plan_gradient(problem, u, sweep.x, sweep.gradient), 1e-300)
    mean = 0.0
    for k in range(u.shape[0]):
        for j in range(u.shape[1]):
            sweep.below[k, j] = sweep.above[k, j] = scale if sweep.held[k, j] == FREE else 0.0
            if sweep.held[k, j] == FREE:
                mean += scale * (problem.upper[k, j] - problem.lower[k, j])
                count += 2
    return mean / max(count, 1), count


@njit(cache=True, error_model="numpy")
def _aimed(problem, u, mu, sweep):
    """Barrier and right-hand side of (1), the latter in place of the gradient."""
    for k in range(u.shape[0]):
        for j in range(u.shape[1]):
            if sweep.held[k, j] == FREE:
                under, over = u[k, j] - problem.lower[k, j], problem.upper[k, j] - u[k, j]
                sweep.barrier[k, j] = sweep.below[k, j] / under + sweep.above[k, j] / over
                sweep.gradient[k, j] += mu / over - mu / under


@njit(cache=True, error_model="numpy")
def _share(value, change, share):
    """The part of a step that leaves a positive value positive, `share` at most."""
    return min(share, -TO_THE_WALL * value / change) if change < 0.0 else share


@njit(cache=True, error_model="numpy")
def _stepped(problem, u, mu, sweep):
    """Take the longest common step within bounds: (its share, the sum of complementarity after it)."""
    share = 1.0
    for k in range(u.shape[0]):
        for j in range(u.shape[1]):
            if sweep.held[k, j] == FREE:
                du = sweep.step[k, j]
                under, over = u[k, j] - problem.lower[k, j], problem.upper[k, j] - u[k, j]
                share = _share(under, du, share)
                share = _share(over, -du, share)
                share = _share(sweep.below[k, j], (mu - sweep.below[k, j] * du) / under - sweep.below[k, j], share)
                share = _share(sweep.above[k, j], (mu + sweep.above[k, j] * du) / over - sweep.above[k, j], share)
    total = 0.0
    for k in range(u.shape[0]):
        for j in range(u.shape[1]):
            if sweep.held[k, j] == FREE:
                du = sweep.step[k, j]
                under, over = u[k, j] - problem.lower[k, j], problem.upper[k, j] - u[k, j]
                sweep.below[k, j] += share * ((mu - sweep.below[k, j] * du) / under - sweep.below[k, j])
                sweep.above[k, j] += share * ((mu + sweep.above[k, j] * du) / over - sweep.above[k, j])
                u[k, j] += share * du
                total += sweep.below[k, j] * (u[k, j] - problem.lower[k, j])
                total += sweep.above[k, j] * (problem.upper[k, j] - u[k, j])
    return share, total


@njit(cache=True, error_model="numpy")
def interior_controls(problem, u, most_sweeps, sweep):
    """Solve (1) of `riccati_sweep` from sweep.x[0] in place of u (N, m), to CLOSE; sweeps taken.

    sweep.held is left with the bounds that hold; sweep.x has the states, sweep.barrier is zero again.
    """
    mean, count = _begun(problem, u, sweep)
    least, share, taken = CLOSE * mean, 0.0, 0
    while taken < most_sweeps and count > 0 and mean > least:
        taken += 1
        mu = mean * (0.02 if share > LONG else 0.3)
        plan_cost(problem, u, sweep.x)
        plan_gradient(problem, u, sweep.x, sweep.gradient)
        _aimed(problem, u, mu, sweep)
        if not backward(problem, sweep.gradient, sweep.barrier, sweep.held, sweep.gain, sweep.ahead):
            break
        forward(problem, sweep.gain, sweep.ahead, sweep.step)
        share, total = _stepped(problem, u, mu, sweep)
        mean = total / count
    _named(problem, u, sweep)
    sweep.barrier[:] = 0.0
    plan_cost(problem, u, sweep.x)
    return taken


@njit(cache=True, error_model="numpy")
def _named(problem, u, sweep):
    """sweep.held: the bounds whose multiplier, in widths of the largest one's, is more than the distance to them."""
    largest = 1e-300
    for k in range(u.shape[0]):
        for j in range(u.shape[1]):
            largest = max(largest, sweep.below[k, j], sweep.above[k, j])
    for k in range(u.shape[0]):
        for j in range(u.shape[1]):
            if sweep.held[k, j] == FREE:
                width = problem.upper[k, j] - problem.lower[k, j]
                if sweep.below[k, j] / largest > (u[k, j] - problem.lower[k, j]) / width:
                    sweep.held[k, j] = AT_LOWER
                elif sweep.above[k, j] / largest > (problem.upper[k, j] - u[k, j]) / width:
                    sweep.held[k, j] = AT_UPPER
