"""Flight by current: allocation, prediction, the periodic regulator and a docking run, against SciPy and python-control.

The plan of the predictive law against OSQP, Clarabel and DAQP is in `horizon`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np
from numba import njit

import horizon
from fieldline.cases.afit_1992.earth import POLE_LONGITUDE_DEG, SPIN_RAD_S, circle
from fieldline.cases.afit_1992.flown import flown
from fieldline.cases.afit_1992.frozen_model import built, frozen_plant
from fieldline.control.controllable import orbital_scale
from fieldline.control.electrodynamic import electrodynamic_map
from fieldline.control.tracking.allocation import COST, allocate_kernel
from fieldline.design import tank_with_towers

CALLS = 200
WEIGHTS = np.array([1.0, 1.0, 1.0, 0.01, 0.01, 0.01])
DAY_S = 86_164.0


@njit
def _many(effects, wanted, weight, cost, lower, upper):
    """Every allocation from a cold start."""
    u, held = np.zeros(lower.shape[0]), np.zeros(lower.shape[0], dtype=np.int64)
    for k in range(effects.shape[0]):
        u[:], held[:] = 0.0, 0
        allocate_kernel(effects[k], wanted[k], weight, cost, lower, upper, COST, u, held)


def best(run: Callable[[], object], times: int = 5) -> float:
    """[s] the shortest of several runs, after one that compiles."""
    run()
    taken = []
    for _ in range(times):
        start = time.perf_counter()
        run()
        taken.append(time.perf_counter() - start)
    return min(taken)


def allocation_s() -> tuple[float, float]:
    """[s] a call of eight conductors and a thruster pair: ours, and SciPy's lsq_linear (bvls)."""
    from scipy.optimize import lsq_linear

    vehicle, rng = tank_with_towers(), np.random.default_rng(1)
    effects = np.array([electrodynamic_map(vehicle, 2e-5 * rng.normal(size=3)) for _ in range(CALLS)])
    wanted = rng.normal(size=(CALLS, 6)) / WEIGHTS * 10.0 ** rng.uniform(-2.0, 1.0, size=(CALLS, 1))
    upper = np.array([125.0] * 8 + [10.0])
    ours = best(lambda: _many(effects, wanted, WEIGHTS, np.ones(9), -upper, upper)) / CALLS
    rows = WEIGHTS[:, None] * effects * upper
    small = [np.sqrt(COST * (row**2).sum(axis=0).max()) * np.eye(9) for row in rows]

    def scipys():
        for row, right, one in zip(rows, wanted, small, strict=True):
            stacked = np.vstack([row, one])
            lsq_linear(stacked, np.concatenate([WEIGHTS * right, np.zeros(9)]), (-1.0, 1.0), method="bvls")

    return ours, best(scipys, 2) / CALLS


def regulator_s() -> tuple[float, float | None]:
    """[s] of the periodic regulator over a sidereal day at 1-minute steps; of python-control for as many frozen instants."""
    from fieldline.analysis.periodic_riccati import periodic_regulator

    orbit, made = circle(), built({"vertical_m": 50.0, "horizontal_m": 310.0})
    n = orbit.mean_motion_rad_s
    count = round(DAY_S / 60.0)
    seconds = np.arange(count) * DAY_S / count
    node = -np.degrees(SPIN_RAD_S * seconds) - POLE_LONGITUDE_DEG
    angle = np.degrees(round(n / SPIN_RAD_S) * SPIN_RAD_S * seconds) + node
    plant, _ = frozen_plant(made, orbit, angle, 28.5, node)
    scale = orbital_scale(n)
    F, G = plant.F * scale / scale[:, None] / n, plant.G / scale[:, None] / n
    weights = np.diag(np.repeat([1.0, orbit.radius_m], 6) * scale * scale)
    ours = best(lambda: periodic_regulator(F, G, weights, np.eye(9), n * DAY_S), 3)
    try:
        import control
    except ImportError:
        return ours, None
    few = 24
    peer = best(lambda: [control.lqr(F, g, weights, np.eye(9)) for g in G[:: count // few]], 1)
    return ours, peer * count / few


def flight_s(controller: str, rate_hz: float) -> float:
    """[s] of a day of the standoff at 28.5 degrees on the plant."""
    return best(lambda: flown("standoff", controller, 28.5, rate_hz=rate_hz), 2)


def docking_factor() -> float:
    """Times real time of the docking template."""
    from fieldline.simulate.run import simulate
    from fieldline.simulate.scenario.scenario import Scenario
    from fieldline.simulate.scenario.templates import template

    scenario = Scenario.from_toml(template("docking", "docking"))
    return float(simulate(scenario)["seconds"][-1]) / best(lambda: simulate(scenario), 3)


def chapter(markdown: Callable[[Sequence[Sequence[str]]], list[str]]) -> list[str]:
    """The chapter of the page."""
    ours, scipys = allocation_s()
    regulator, peer = regulator_s()
    rows = [
        ("one core", "measured", "hoped for", "peer"),
        ("allocation, a call", f"{1e6 * ours:.1f} µs", "under 20 µs", f"SciPy lsq_linear {1e6 * scipys:.0f} µs"),
        (
            "periodic regulator, 12 states, 9 controls, a sidereal day at 1 min",
            f"{regulator:.2f} s",
            "under 5 s",
            "" if peer is None else f"python-control, as many frozen regulators: {peer:.1f} s",
        ),
        ("predictive control, a day at 0.1 Hz, plant included", f"{flight_s('predictive', 0.1):.1f} s", "under 30 s", ""),
        ("regulator over the day, a day at 1 Hz, plant included", f"{flight_s('periodic', 1.0):.1f} s", "", ""),
        ("docking run, times real time", f"{docking_factor():,.0f}", "over 5,000", ""),
    ]
    text = (
        "Eight conductors and a pair of thrusters on a rigid body beside its target. The days are the thesis's standoff in its "
        "dipole at 28.5 degrees; the docking flies in IGRF-14 with J2 and air."
    )
    return ["## Flight by current", "", text, "", *markdown(rows), *horizon.chapter(markdown)]
