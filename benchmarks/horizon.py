"""The plan of `tracking-predictive` solved by ours, OSQP, Clarabel and DAQP: the same problems, call after call.

The problems are those of the law itself: the tank of the templates at 28.5 degrees, 125 A, 10 N, told to go 100 m along the
track at once; its error moves by its own linear equations under what ours plans. Twelve states, nine controls, 30 stages
of 90 s, a call every 10 s. Every peer is kept warm as it can be: OSQP keeps its pattern and takes new numbers, DAQP (dense,
its states eliminated) the last active set; Clarabel, an interior-point method, starts afresh.
"""

from __future__ import annotations

import time
from typing import NamedTuple

import numpy as np
from scipy import sparse

from fieldline.cases.afit_1992.flown import vehicle_scenario
from fieldline.control import LAWS
from fieldline.control.tracking import by_prediction as law
from fieldline.control.tracking import onboard_vehicle as own
from fieldline.control.tracking.horizon import best_controls
from fieldline.control.tracking.riccati_sweep import Horizon, new_sweep
from fieldline.design import tank_with_towers
from fieldline.simulate.assembly.design import Design

CALLS, CALL_S = 400, 10.0
STEP_M = 100.0


class Call(NamedTuple):
    """One problem: the horizon, the state it starts from, and what the stage's loads are told beforehand."""

    problem: Horizon
    start: np.ndarray


def calls(count: int = CALLS) -> list[Call]:
    """The problems of a step along the track, as the law meets them."""
    from scipy.linalg import expm

    made = tank_with_towers(vertical_m=330.0, horizontal_m=310.0)
    scenario = vehicle_scenario(made, "tracking-predictive", {}, inclination_deg=28.5, place_m=np.zeros(3), rate_hz=1.0 / CALL_S)
    context = Design(scenario, None)(1, CALL_S)
    params = LAWS["tracking-predictive"].pack({}, context)
    m, base = int(params[own.CONTROLS]), own.law_at(params)
    stages, fields = int(params[base + law.STAGES]), base + law.HEAD + 228 + m + 144 + 12 + 2
    scale = params[fields - 14 : fields - 2]
    both = np.zeros((12 + 6, 12 + 6))
    motion = params[own.MOTION : own.TABLE].reshape(6, 12)
    both[0:12:2, 1:12:2], both[1:12:2, :12] = np.eye(6), motion
    both[1:12:2, 12:] = np.diag(1.0 / params[own.MASS : own.MASS + 6])
    small = expm(both * CALL_S)
    error = np.zeros(12)
    error[2] = STEP_M
    effect, memory = np.zeros((6, m)), np.zeros(law.PLAN_MEMORY)
    plan, sweep, holds = np.zeros((stages, m)), new_sweep(stages, 12, m), np.zeros((stages, m))
    size = np.maximum(params[own.TABLE + own.UPPER :: own.WIDTH][:m], 1e-300)
    found = []
    for k in range(count):
        own.effect_of(params, law.field_ahead(k * CALL_S, params, fields), effect)
        problem = law._problem(k * CALL_S, effect, memory, params, base, holds)
        found.append(Call(problem, error / scale))
        best_controls(problem, error / scale, plan, 200, sweep)
        error = small[:12, :12] @ error + small[:12, 12:] @ effect @ (holds[0] + plan[0] * size)
    return found


def ours(given: list[Call], most_steps: int = 25) -> tuple[np.ndarray, np.ndarray]:
    """(seconds of each call, controls (k, N, m)), warm from the last plan."""
    N, m = given[0].problem.lower.shape
    plan, sweep = np.zeros((N, m)), new_sweep(N, 12, m)
    best_controls(given[0].problem, given[0].start, plan.copy(), most_steps, new_sweep(N, 12, m))
    taken, plans = np.empty(len(given)), np.empty((len(given), N, m))
    for k, one in enumerate(given):
        start = time.perf_counter()
        best_controls(one.problem, one.start, plan, most_steps, sweep)
        taken[k], plans[k] = time.perf_counter() - start, plan
    return taken, plans


def cost(one: Call, controls) -> float:
    """The cost of a plan (N, m), brought within the bounds, from the equations as they stand."""
    p, x, total = one.problem, one.start, 0.0
    for k, u in enumerate(np.clip(controls, p.lower, p.upper)):
        total += 0.5 * float((p.Q * (x - p.r[k]) ** 2).sum() + (p.R * u * u).sum())
        x = p.A @ x + p.B[k] @ u + p.d[k]
    return total + 0.5 * float((x - p.r[-1]) @ p.P @ (x - p.r[-1]))


def stacked(one: Call):
    """(P, q, A, low, high) over z = (x_1 .. x_N, u_0 .. u_N-1): the sparse form, states kept."""
    p, (N, m) = one.problem, one.problem.lower.shape
    weights = [np.diag(p.Q)] * (N - 1) + [p.P] + [np.diag(p.R)] * N
    P = sparse.block_diag(weights, format="csc")
    q = np.concatenate([-(p.Q * p.r[1:N]).ravel(), -p.P @ p.r[N], np.zeros(N * m)])
    carry = sparse.eye(N * 12) - sparse.kron(sparse.eye(N, k=-1), p.A)
    push = sparse.block_diag([sparse.coo_matrix(_full(b)) for b in p.B])
    A = sparse.bmat([[carry, -push], [None, sparse.eye(N * m)]], format="csc")
    ahead = p.d.copy()
    ahead[0] += p.A @ one.start
    low = np.concatenate([ahead.ravel(), p.lower.ravel()])
    return P, q, A, low, np.concatenate([ahead.ravel(), p.upper.ravel()])


def _full(block) -> np.ndarray:
    """A block whose zeros stay in the pattern, which must not change from call to call."""
    return np.where(block == 0.0, 1e-300, block)


def by_osqp(given: list[Call], tolerance: float = 1e-6) -> tuple[np.ndarray, np.ndarray]:
    """OSQP, updated and warm; as `ours`."""
    import osqp

    N, m = given[0].problem.lower.shape
    solver, taken, plans = osqp.OSQP(), np.empty(len(given)), np.empty((len(given), N, m))
    for k, one in enumerate(given):
        P, q, A, low, high = stacked(one)
        start = time.perf_counter()
        if k == 0:
            solver.setup(
                P, q, A, low, high, verbose=False, eps_abs=tolerance, eps_rel=tolerance, max_iter=20_000, polishing=False
            )
        else:
            solver.update(q=q, l=low, u=high, Ax=A.data)
        z = solver.solve(raise_error=False).x
        taken[k], plans[k] = time.perf_counter() - start, z[N * 12 :].reshape(N, m)
    return taken, plans


def by_clarabel(given: list[Call]) -> tuple[np.ndarray, np.ndarray]:
    """Clarabel at its own tolerances, 1e-8; as `ours`."""
    import clarabel

    N, m = given[0].problem.lower.shape
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    taken, plans = np.empty(len(given)), np.empty((len(given), N, m))
    for k, one in enumerate(given):
        P, q, A, low, high = stacked(one)
        rows = N * 12
        constraints = sparse.vstack([A[:rows], A[rows:], -A[rows:]], format="csc")
        right = np.concatenate([low[:rows], high[rows:], -low[rows:]])
        cones = [clarabel.ZeroConeT(rows), clarabel.NonnegativeConeT(2 * N * m)]
        start = time.perf_counter()
        z = clarabel.DefaultSolver(sparse.triu(P, format="csc"), q, constraints, right, cones, settings).solve().x
        taken[k], plans[k] = time.perf_counter() - start, np.array(z)[rows:].reshape(N, m)
    return taken, plans


def condensed(one: Call) -> tuple[np.ndarray, np.ndarray]:
    """(H (Nm, Nm), g (Nm,)) of the controls alone, the states eliminated."""
    p, (N, m) = one.problem, one.problem.lower.shape
    by, x = np.zeros((12, N * m)), one.start
    H, g = np.diag(np.tile(p.R, N)), np.zeros(N * m)
    for k in range(N):
        by, x = p.A @ by, p.A @ x + p.d[k]
        by[:, m * k : m * (k + 1)] += p.B[k]
        weight = np.diag(p.Q) if k < N - 1 else p.P
        H += by.T @ weight @ by
        g += by.T @ weight @ (x - p.r[k + 1])
    return H, g


def by_daqp(given: list[Call]) -> tuple[np.ndarray, np.ndarray]:
    """DAQP, dense, its time with that of the elimination; cold, as its function of Python has it; as `ours`."""
    import daqp

    N, m = given[0].problem.lower.shape
    taken, plans = np.empty(len(given)), np.empty((len(given), N, m))
    none, kinds = np.zeros((0, N * m)), np.zeros(N * m, dtype=np.int32)
    for k, one in enumerate(given):
        start = time.perf_counter()
        H, g = condensed(one)
        z = daqp.solve(H, g, none, one.problem.upper.ravel().copy(), one.problem.lower.ravel().copy(), kinds)[0]
        taken[k], plans[k] = time.perf_counter() - start, np.array(z).reshape(N, m)
    return taken, plans


SOLVERS = {
    "ours": ours,
    "OSQP, 1e-6": by_osqp,
    "OSQP, 1e-3": lambda c: by_osqp(c, 1e-3),
    "Clarabel": by_clarabel,
    "DAQP": by_daqp,
}
VERSIONS = {"ours": "", "OSQP, 1e-6": "osqp", "OSQP, 1e-3": "osqp", "Clarabel": "clarabel", "DAQP": "daqp"}


class Row(NamedTuple):
    """How a solver did: times [s], how far its cost was over the least of all, how far its first controls (of 1) from ours."""

    name: str
    median_s: float
    longest_s: float
    over: float
    first_off: float


def scattered(given: list[Call], count: int = 300, seed: int = 0) -> list[Call]:
    """The same horizons from starts far and wide: 1 m to 1 km, 0.06 to 12 degrees; nothing to be warm from."""
    rng, found = np.random.default_rng(seed), []
    for _ in range(count):
        place, angle = 10.0 ** rng.uniform(0.0, 3.0), 10.0 ** rng.uniform(-1.0, 1.3)
        start = np.concatenate([place * rng.normal(size=6) * np.tile([1.0, 0.3], 3), angle * rng.normal(size=6)])
        found.append(Call(given[rng.integers(len(given))].problem, start))
    return found


def by_ours_cold(given: list[Call]) -> tuple[np.ndarray, np.ndarray]:
    """Ours, each call from nothing."""
    each = [ours([one]) for one in given]
    return np.array([one[0][0] for one in each]), np.array([one[1][0] for one in each])


def compared(given: list[Call], solvers) -> list[Row]:
    """Each solver that is installed on the same calls."""
    found = {}
    for name, solver in solvers.items():
        try:
            found[name] = solver(given)
        except ImportError:
            continue
    costs = {name: np.array([cost(one, u) for one, u in zip(given, plans, strict=True)]) for name, (_, plans) in found.items()}
    least = np.maximum(np.min(list(costs.values()), axis=0), 1e-300)
    rows = []
    for name, (taken, plans) in found.items():
        off = np.abs(plans[:, 0] - found["ours"][1][:, 0])
        rows.append(
            Row(name, float(np.median(taken)), float(taken.max()), float((costs[name] / least - 1.0).max()), float(off.max()))
        )
    return rows


def flown_and_scattered() -> tuple[list[Row], list[Row]]:
    """The rows of a step along the track, kept warm, and of starts far and wide, cold (OSQP's pattern needs no set-up there)."""
    given = calls()
    return compared(given, SOLVERS), compared(scattered(given), SOLVERS | {"ours": by_ours_cold})


def chapter(markdown) -> list[str]:
    """The section of the page: the plan against solvers of others."""
    tables = []
    for words, rows in zip(("a step of 100 m, warm", "starts far and wide, cold"), flown_and_scattered(), strict=True):
        head = (words, "median", "longest", "cost over the least", "first controls off")
        told = [
            (one.name + _version(one.name), f"{1e3 * one.median_s:.2f} ms", f"{1e3 * one.longest_s:.1f} ms", *sizes)
            for one in rows
            for sizes in [(f"{max(one.over, 0.0):.0e}", f"{one.first_off:.0e}")]
        ]
        tables += markdown([head, *told])
    text = (
        "The plan of `tracking-predictive`: 12 states, 9 controls, 30 stages, the same problems for all. First controls in parts "
        "of their limits. What is over the least there is a call that a solver gives up or ends too early."
    )
    return ["### The plan against other solvers", "", text, "", *tables]


def _version(name: str) -> str:
    """Which release was measured."""
    from importlib.metadata import version

    return f" ({version(VERSIONS[name])})" if VERSIONS[name] else ""


if __name__ == "__main__":
    for rows in flown_and_scattered():
        print(*rows, sep="\n")
