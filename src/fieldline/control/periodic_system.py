"""Linear systems with periodic coefficients: transition over a step, and the Riccati equation over a period.

A period T is cut into N equal steps h at nodes t_k = k h; a coefficient is given at the nodes, (N, ...), or once. Between
nodes it is followed to fourth order: the midpoint from four neighbours, the step by the Magnus series

    X(t + h) = exp(O) X(t),   O = h/6 (a0 + 4 am + a1) - h^2/12 [a0, a1]                           (28)

Regulator: dx/dt = a x + b u, cost the integral of x'q x + u'r u. State and costate p = P x pass a step as

    x1 = A x0 - G p1,   p0 = A' p1 + H x0                                                          (29)

whose A, G, H come from exp of the Hamiltonian matrix ((a, -b r^-1 b'), (-q, -a')) if u may change at any time, or from the
discrete problem that is equivalent to the held input if u is constant over a step. Two steps, 1 then 2, are one (Chu, Fan,
Lin and Wang's doubling, used on unequal steps):

    W = (I + G1 H2)^-1,  A = A2 W A1,  G = G2 + A2 W G1 A2',  H = H1 + A1' H2 W A1                 (30)

N of them give the whole period as one step; that step doubled again and again gives H -> P at the period's start,
quadratically; one sweep backwards,

    P0 = H + A' P1 (I + G P1)^-1 A                                                                 (31)

gives P at every node, and the difference after the full turn is the residual.

Sources: Iserles and Norsett (1999), Phil. Trans. R. Soc. A 357:983 (28); Chu, Fan, Lin and Wang (2004), Structure-preserving
algorithms for periodic discrete-time algebraic Riccati equations, Int. J. Control 77(8):767 (29) to (31); Van Loan (1978),
IEEE Trans. Automatic Control 23(3):395 (the held problem's integrals). Units are the caller's.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

MOST_DOUBLINGS = 60  # 2^60 periods
SMALL_NORM = 0.25  # where twelve terms of the exponential's series leave less than rounding


class Steps(NamedTuple):
    """(N, n, n) matrices A, G, H of equation (29)."""

    A: np.ndarray
    G: np.ndarray
    H: np.ndarray


class Held(NamedTuple):
    """The problem of an input that is held over each step: x1 = phi x0 + gamma u, cost x'q x + 2 x's u + u'r u."""

    phi: np.ndarray
    gamma: np.ndarray
    q: np.ndarray
    s: np.ndarray
    r: np.ndarray


def exponentials(matrices: np.ndarray) -> np.ndarray:
    """(N, n, n) exponentials of (N, n, n) matrices: scaling, twelve terms, squaring."""
    largest = float(np.abs(matrices).sum(axis=-2).max(initial=0.0))
    squarings = max(0, int(np.ceil(np.log2(largest / SMALL_NORM)))) if largest > SMALL_NORM else 0
    scaled = matrices / 2.0**squarings
    identity = np.eye(matrices.shape[-1])
    result = identity + scaled / 12.0
    for k in range(11, 0, -1):
        result = identity + scaled @ result / k
    for _ in range(squarings):
        result = result @ result
    return result


def magnus(a: np.ndarray, step_s: float) -> np.ndarray:
    """(N, n, n) exponents O of equation (28) for a (N, n, n) on a closed ring of nodes."""
    if a.shape[0] == 1:
        return a * step_s
    after = np.roll(a, -1, axis=0)
    middle = (9.0 * (a + after) - np.roll(a, 1, axis=0) - np.roll(a, -2, axis=0)) / 16.0
    bend = a @ after - after @ a
    return step_s / 6.0 * (a + 4.0 * middle + after) - step_s**2 / 12.0 * bend  # (28)


def transitions(a: np.ndarray, period_s: float) -> np.ndarray:
    """(N, n, n) transition matrices over each step of dx/dt = a(t) x, a (N, n, n) at the nodes."""
    return exponentials(magnus(a, period_s / a.shape[0]))


def _mt(m: np.ndarray) -> np.ndarray:
    return np.swapaxes(m, -1, -2)


def _cost_scale(g: np.ndarray, q: np.ndarray) -> float:
    """A factor on the cost that brings both off-diagonal blocks of the Hamiltonian to one size; P scales with it."""
    up, down = float(np.abs(g).max()), float(np.abs(q).max())
    return float(2.0 ** np.round(0.5 * np.log2(up / down))) if up > 0.0 and down > 0.0 else 1.0


def reach(b, r) -> np.ndarray:
    """(N, n, n) matrices b r^-1 b'."""
    return b @ np.linalg.solve(r, _mt(b))


def continuous_steps(a, g, q, period_s: float) -> tuple[Steps, float]:
    """Steps of an input that may change at any time, g = b r^-1 b', and the factor by which their cost was multiplied."""
    factor = _cost_scale(g, q)
    return _passed(transitions(_hamiltonian(a, g / factor, q * factor), period_s)), factor


def continuous_instants(a, g, q, step_s: float) -> tuple[Steps, float]:
    """The same for coefficients that stay as they are at each node, whatever the others are."""
    factor = _cost_scale(g, q)
    return _passed(exponentials(step_s * _hamiltonian(a, g / factor, q * factor))), factor


def _hamiltonian(a, g, q) -> np.ndarray:
    """(N, 2 n, 2 n) of state and costate."""
    return np.concatenate([np.concatenate([a, -g], axis=2), np.concatenate([-q, -_mt(a)], axis=2)], axis=1)


def _passed(phi: np.ndarray) -> Steps:
    """Equation (29) from the transitions of state and costate."""
    n = phi.shape[1] // 2
    xx, xp, px, pp = phi[:, :n, :n], phi[:, :n, n:], phi[:, n:, :n], phi[:, n:, n:]
    G = -_mt(np.linalg.solve(_mt(pp), _mt(xp)))
    H = -np.linalg.solve(pp, px)
    return _symmetric_steps(xx + G @ px, G, H)


def held_problem(a, b, q, r, period_s: float) -> Held:
    """The discrete problem of an input held over each step, exact for constant coefficients (Van Loan's integrals)."""
    step = period_s / b.shape[0]
    return _held(magnus(_cost_and_motion(a, b, q, r), step), *b.shape[1:])


def held_instants(a, b, q, r, step_s: float) -> Held:
    """The same for coefficients that stay as they are at each node, whatever the others are."""
    return _held(step_s * _cost_and_motion(a, b, q, r), *b.shape[1:])


def _cost_and_motion(a, b, q, r) -> np.ndarray:
    """(N, 2 (n + m), 2 (n + m)) Van Loan's matrices of state and input."""
    count, n, m = b.shape
    f = np.zeros((count, n + m, n + m))
    f[:, :n, :n], f[:, :n, n:] = a, b
    weight = np.zeros_like(f)
    weight[:, :n, :n], weight[:, n:, n:] = q, r
    return np.concatenate([np.concatenate([-_mt(f), weight], axis=2), np.concatenate([0.0 * f, f], axis=2)], axis=1)


def _held(exponents: np.ndarray, n: int, m: int) -> Held:
    """The discrete problem from the exponents of Van Loan's matrices over each step."""
    phi, k = exponentials(exponents), n + m
    forward = phi[:, k:, k:]
    cost = _mt(forward) @ phi[:, :k, k:]
    cost = 0.5 * (cost + _mt(cost))
    return Held(forward[:, :n, :n], forward[:, :n, n:], cost[:, :n, :n], cost[:, :n, n:], cost[:, n:, n:])


def held_steps(held: Held) -> tuple[Steps, float]:
    """Steps of a held input: the cross cost is taken into A and H."""
    across = np.linalg.solve(held.r, _mt(held.s))
    A = held.phi - held.gamma @ across
    H = held.q - held.s @ across
    G = held.gamma @ np.linalg.solve(held.r, _mt(held.gamma))
    factor = _cost_scale(G, H)
    return _symmetric_steps(A, G / factor, H * factor), factor


def _symmetric_steps(A, G, H) -> Steps:
    """What rounding took from the symmetry of G and H is given back; contiguous for the kernels."""
    return Steps(*(np.ascontiguousarray(m) for m in (A, 0.5 * (G + _mt(G)), 0.5 * (H + _mt(H)))))


def _join(first: Steps, second: Steps) -> Steps:
    """Equation (30) for a batch of pairs."""
    W = np.linalg.inv(np.eye(first.A.shape[-1]) + first.G @ second.H)
    left = second.A @ W
    G = second.G + left @ first.G @ _mt(second.A)
    H = first.H + _mt(first.A) @ second.H @ W @ first.A
    return Steps(left @ first.A, 0.5 * (G + _mt(G)), 0.5 * (H + _mt(H)))


def _whole_period(steps: Steps) -> Steps:
    """All steps as one, joined in pairs, pairs of pairs and so on: each level is one batch."""
    while steps.A.shape[0] > 1:
        even = 2 * (steps.A.shape[0] // 2)
        pairs = _join(Steps(*(m[0:even:2] for m in steps)), Steps(*(m[1:even:2] for m in steps)))
        steps = Steps(*(np.concatenate([pair, m[even:]]) for pair, m in zip(pairs, steps, strict=True)))
    return steps


def _doubled(period: Steps, tolerance: float) -> tuple[np.ndarray, int]:
    """(P at the period's start, number of doublings or -1): H settles as the period is doubled."""
    for k in range(MOST_DOUBLINGS):
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                double = _join(period, period)
        except np.linalg.LinAlgError:
            return period.H[0], -1
        size = np.abs(double.H).max()
        if not np.isfinite(size) or not np.isfinite(double.G).all():
            return period.H[0], -1
        if np.abs(double.H - period.H).max() <= tolerance * size:
            return double.H[0], k + 1
        period = double
    return period.H[0], -1


def _sweep(P_end: np.ndarray, steps: Steps) -> tuple[np.ndarray, np.ndarray]:
    """P (N, n, n) backwards from P_end by (31), and the closed loop's steps (I + G P1)^-1 A."""
    P, closed = np.empty_like(steps.A), np.empty_like(steps.A)
    identity = np.eye(P_end.shape[0])
    after = P_end
    for k in range(P.shape[0] - 1, -1, -1):
        closed[k] = np.linalg.solve(identity + steps.G[k] @ after, steps.A[k])
        here = steps.H[k] + steps.A[k].T @ after @ closed[k]
        after = P[k] = 0.5 * (here + here.T)
    return P, closed


def periodic_solution(steps: Steps, tolerance: float = 1e-12) -> tuple[np.ndarray, np.ndarray, float, int]:
    """P (N, n, n) at the nodes, the closed loop's step matrices (N, n, n), the residual, and the doublings (-1: no end).

    Residual: |P after a full turn backwards - P| / |P|, greatest elements. P is in the steps' own scale of cost.
    """
    start, doublings = _doubled(_whole_period(steps), tolerance)
    if doublings < 0:
        return steps.H, steps.A, float("inf"), doublings
    before = _sweep(start, steps)[0][0]  # a turn takes off what rounding left in the doubling
    P, closed = _sweep(before, steps)
    residual = float(np.abs(P[0] - before).max() / max(np.abs(before).max(), 1e-300))
    return P, closed, residual, doublings


def instants_solution(steps: Steps, tolerance: float = 1e-12) -> tuple[np.ndarray, np.ndarray]:
    """P (N, n, n) of each step as if its coefficients stayed for ever, and how far the last doubling moved it (N,), relative.

    All instants are doubled at once; not finite, or not settled, where no regulator of that instant exists.
    """
    lost, moved = np.zeros(steps.A.shape[0], dtype=bool), np.full(steps.A.shape[0], np.inf)
    for _ in range(MOST_DOUBLINGS):
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                double = _join(steps, steps)
                size = np.maximum(np.abs(double.H).max(axis=(1, 2)), 1e-300)
                moved = np.abs(double.H - steps.H).max(axis=(1, 2)) / size
        except np.linalg.LinAlgError:
            return steps.H, np.full_like(moved, np.inf)
        lost |= ~np.isfinite(moved + np.abs(double.G).max(axis=(1, 2)))
        steps = Steps(*(np.where(lost[:, None, None], 0.0, one) for one in double))
        if lost.all() or moved[~lost].max() <= tolerance:
            break
    return steps.H, np.where(lost, np.inf, moved)


def disturbance_costate(P: np.ndarray, closed: np.ndarray, push: np.ndarray) -> np.ndarray:
    """(N, n, k) costates s of disturbances that are known: p = P x + s.

    push (N, n, k): what each of k disturbances, periodic like the rest, adds to the state over a step. Backwards,

        s0 = A_closed' (s1 + P1 push),   the same after a full turn                                (31a)
    """
    count = P.shape[0]

    def turn(last):
        s = np.empty_like(push)
        for k in range(count - 1, -1, -1):
            last = s[k] = closed[k].T @ (last + P[(k + 1) % count] @ push[k])
        return s

    forced = turn(np.zeros_like(push[0]))[0]
    return turn(np.linalg.solve(np.eye(P.shape[1]) - product(closed).T, forced))


def product(steps):
    """steps[N-1] ... steps[0]: the transition over the whole period."""
    whole = np.eye(steps.shape[1])
    for step in steps:
        whole = step @ whole
    return whole


def held_gains(held: Held, P: np.ndarray) -> np.ndarray:
    """(N, m, n) gains K of u_k = -K_k x_k for a held input, from P at the nodes in the cost's own scale."""
    return gains_before(held, np.roll(P, -1, axis=0))


def gains_before(held: Held, after: np.ndarray) -> np.ndarray:
    """(N, m, n) gains of a held input from P (N, n, n) at each step's end."""
    back = _mt(held.gamma) @ after
    return np.linalg.solve(held.r + back @ held.gamma, back @ held.phi + _mt(held.s))


def continuous_gains(b: np.ndarray, r: np.ndarray, P: np.ndarray) -> np.ndarray:
    """(N, m, n) gains K = r^-1 b' P of u = -K x at the nodes."""
    return np.linalg.solve(r, _mt(b) @ P)
