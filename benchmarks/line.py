"""Lines with nodes: explicit steps against plain C, cost against nodes, work against precision, and MoorDyn.

The line is 20 km of 8.35 g/m and E A = 320 kN between 500 kg and an orbiter of 86 t, 220 km up, damped as tau = c / E A
says. C is `benchmarks/line.c`, built at run time and first found to agree with the plant. What is compared in precision
is one day with the lower body let go at 20 degrees in the plane and 5 out of it, skiprope of 20 m: the largest error of
any place on the line at the end, against the implicit method at a tenth of the tightest tolerance shown, which the tests
hold against DOP853.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from fieldline.dynamics.layout import starts_in_state
from fieldline.simulate.flight import Flight
from fieldline.simulate.scenario import Scenario
from measure import best_of_each, timed
from satellite import FLAGS

HERE = Path(__file__).parent
STEPS = 4000  # in one timed call: coming from Python costs it 0.4 ms
NODES = (10, 30, 100, 300, 1000)
DAY_S = 86_400.0
TAU_S = 0.05
AGREE = 1e-9  # relative: the same arithmetic but for rounding
TOML = """
name = "benchmark"
time = { start_utc = 2026-03-01T00:00:00Z, duration_s = 86400.0, output_step_s = 86400.0 }
environment = { gravity = "point" }
orbit.state = { position_km = [6598.137, 0.0, 0.0], velocity_km_s = [0.0, 7.772549, 0.0] }

[[body]]
name = "orbiter"
kind = "point"
mass_kg = 86363.0

[[body]]
name = "satellite"
kind = "point"
mass_kg = 500.0
hang = { in_plane_deg = 20.0, out_of_plane_deg = 5.0 }

[[line]]
name = "tether"
from_body = "satellite"
to_body = "orbiter"
rest_length_m = 20000.0
stiffness_n = 3.2e5
mass_per_length_kg_m = 8.35e-3
start.skiprope_amplitude_m = 20.0
"""


class Constants(ctypes.Structure):
    """`line` of line.c."""

    _fields_ = [
        ("gm", ctypes.c_double),
        ("rest", ctypes.c_double),
        ("stiffness", ctypes.c_double),
        ("damping", ctypes.c_double),
        ("mass", ctypes.c_void_p),
        ("points", ctypes.c_long),
    ]


def scenario(nodes: int, tau_s: float = TAU_S, **integrator):
    """The line with so many nodes; `integrator`: keys of that table."""
    import tomllib

    table = tomllib.loads(TOML)
    table["line"][0] |= {"nodes": nodes, "damping_n_s": 3.2e5 * tau_s}
    return Scenario.from_dict(table | {"integrator": integrator})


def held_step(nodes: int, tau_s: float = TAU_S) -> float:
    """The longest step that a scenario may ask of rk4 [s], a hundredth off."""
    from fieldline.simulate.scenario.line_stiffness import fastest_along

    return 0.99 * fastest_along(scenario(nodes, tau_s, method="rosenbrock"), 0)[1]


def points(flight: Flight, y: np.ndarray) -> np.ndarray:
    """(points, 6) places and velocities from end to end of a state."""
    nodes, feeds, _ = starts_in_state(flight.plant)
    return np.vstack([y[13:19], y[nodes:feeds].reshape(-1, 6), y[:6]])


def line_in_c(folder: Path):
    """fly(y (points, 6), steps, step_s, flight); None without a compiler."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    library = folder / "line.so"
    subprocess.run([compiler, *FLAGS, "-o", library, HERE / "line.c", "-lm"], check=True)
    function = ctypes.CDLL(str(library)).fly

    def fly(y: np.ndarray, steps: int, step_s: float, flight: Flight) -> None:
        lines, masses = flight.plant.lines, flight.plant.bodies.mass
        segment = lines.linear_mass * lines.rest
        mass = np.array([masses[1], *np.zeros(len(y) - 2), masses[0]])
        mass[:-1] += 0.5 * segment
        mass[1:] += 0.5 * segment
        made = Constants(
            flight.plant.surroundings.gravity.gm, lines.rest[0], lines.stiffness[0], lines.damping[0], mass.ctypes.data, len(y)
        )
        function(y.ctypes.data_as(ctypes.c_void_p), ctypes.c_long(steps), ctypes.c_double(step_s), ctypes.byref(made))

    return fly


def flying(chosen, steps: int = STEPS):
    """A call that flies so many more steps; a new flight begins where a day is over."""
    flights = [Flight(chosen)]

    def call() -> None:
        if flights[0].outcome != 0 or flights[0].clock.t[0] + steps * chosen.integrator.step_s >= 0.9 * DAY_S:
            flights[0] = Flight(chosen)
        flights[0]._fly_on(steps)  # one call of the compiled loop, as `fly` makes many

    return call


def c_table(folder: Path, nodes: int = 50) -> list[tuple[str, ...]]:
    """(what, thousand steps a second, C, ratio)."""
    fly, step = line_in_c(folder), held_step(nodes)
    chosen = scenario(nodes, method="rk4", step_s=step)
    rows = [("one core", "thousand steps/s", "C", "Fieldline / C")]
    calls = {"plant": flying(chosen)}
    if fly:
        flight = Flight(chosen)
        y = points(flight, flight.y)
        fly(y, 100, step, flight)
        flight._fly_on(100)
        far = np.abs(y / points(flight, flight.y) - 1.0)[:, [0, 4]].max()
        if not far < AGREE:
            raise SystemExit(f"the line and its C twin are {far:.1e} apart; {AGREE:g} was expected.")
        calls["C"] = lambda: fly(y.copy(), STEPS, step, flight)
    rate = {name: STEPS / seconds / 1e3 for name, seconds in best_of_each(calls).items()}
    beside = (f"{rate['C']:.0f}", f"{rate['plant'] / rate['C']:.2f}") if fly else ("no compiler", "-")
    rows.append((f"{nodes} nodes, rk4", f"{rate['plant']:.0f}", *beside))
    return rows


def nodes_table() -> list[tuple[str, ...]]:
    """(nodes, microseconds of a step and nanoseconds a node, explicit and implicit)."""
    rows = [("nodes", "rk4 [us a step]", "[ns a node]", "rosenbrock [us a step]", "[ns a node]")]
    loose = {"relative_tolerance": 1e-2, "position_tolerance_m": 1e6}
    for nodes in NODES:
        chosen = {
            "rk4": scenario(nodes, method="rk4", step_s=held_step(nodes)),
            "rosenbrock": scenario(nodes, method="rosenbrock", step_s=1.0, step_max_s=1.0, **loose),
        }
        steps = max(20, 20_000 // nodes)
        taken = best_of_each({name: flying(one, steps) for name, one in chosen.items()}, rounds=10)
        each = [1e6 * taken[name] / steps for name in chosen]
        rows.append((f"{nodes:,}", *(text for us in each for text in (f"{us:.1f}", f"{1e3 * us / nodes:.0f}"))))
    return rows


def flown(chosen) -> tuple[Flight, float]:
    """A day, and what it took [s]."""
    flight = Flight(chosen)
    taken = timed(flight.fly)
    return flight, taken


def implicit(nodes: int, tau_s: float, tolerance_m: float):
    """The scenario at a tolerance of place."""
    return scenario(nodes, tau_s, method="rosenbrock", relative_tolerance=1e-13, position_tolerance_m=tolerance_m)


def explicit(nodes: int, tau_s: float) -> list[tuple]:
    """(name, scenario): what one does without an implicit method, rk4 at its longest step and at half of it, dop853.

    The stretch, not the tolerance, sets dop853's step: looser than these it refuses more steps than it saves, or is lost.
    """
    steps = held_step(nodes, tau_s) * np.array([1.0, 0.5])
    tries = [(f"rk4, {one:.3g} s", scenario(nodes, tau_s, method="rk4", step_s=one)) for one in steps]
    for relative, metres in ((1e-9, 1e-2), (1e-7, 1.0)):
        loose = {"relative_tolerance": relative, "position_tolerance_m": metres, "velocity_tolerance_m_s": 0.1 * metres}
        tries.append((f"dop853, {metres:g} m", scenario(nodes, tau_s, method="dop853", **loose)))
    return tries


def work_precision(nodes: int = 50, tau_s: float = TAU_S) -> list[tuple[str, float, int, float]]:
    """(method, seconds of one core, steps, largest error [m]) of a day."""
    tolerances = (1e-1, 1e-2, 1e-3, 5e-4, 1e-4)
    truth, _ = flown(implicit(nodes, tau_s, 1e-5))
    tries = [(f"rosenbrock, {one:g} m", implicit(nodes, tau_s, one)) for one in tolerances]
    tries += explicit(nodes, tau_s)
    found = []
    for name, chosen in tries:
        flight, taken = flown(chosen)
        error = np.abs(points(flight, flight.y)[:, :3] - points(truth, truth.y)[:, :3]).max()
        found.append((name, taken, int(flight.clock.steps[0]), float(error)))
    return found


def precision_table(nodes: int = 50, tau_s: float = TAU_S) -> list[tuple[str, ...]]:
    """The work-precision figures as a table, and how much cheaper a metre is."""
    found = work_precision(nodes, tau_s)
    rows = [(f"{nodes} nodes, tau = {tau_s:g} s, a day", "seconds", "steps", "error [m]")]
    rows += [(name, f"{taken:.2f}", f"{steps:,}", f"{error:.1e}") for name, taken, steps, error in found]
    implicitly, explicitly = (
        [one[1] for one in found if (one[0][:3] == "ros") is kind and one[3] < 1.0] for kind in (True, False)
    )
    if implicitly and explicitly:
        rows.append(("cheaper at 1 m (hoped for: 20)", f"{min(explicitly) / min(implicitly):.0f} times", "", ""))
    return rows


def moordyn_table(nodes: int = 50) -> list[tuple[str, ...]]:
    """(what, million segment evaluations a second): MoorDyn's rk4 beside the plant's, on a chain of as many segments."""
    rows = [("one core", "million segments/s", "times MoorDyn (hoped for: 20)")]
    chosen = scenario(nodes, method="rk4", step_s=held_step(nodes))
    mine = 4.0 * STEPS * (nodes + 1) / best_of_each({"plant": flying(chosen)})["plant"] / 1e6
    try:
        import peer_moordyn

        theirs = peer_moordyn.segments_per_second(nodes) / 1e6
    except ImportError:
        return [
            *rows,
            (f"the plant, {nodes} nodes", f"{mine:.1f}", "-"),
            ("MoorDyn (`pip install moordyn`) is not installed", "-", "-"),
        ]
    return [*rows, (f"the plant, {nodes} nodes", f"{mine:.1f}", f"{mine / theirs:.0f}"), ("MoorDyn, rk4", f"{theirs:.2f}", "1")]


def chapter(markdown) -> list[str]:
    """The chapter of docs/benchmarks.md."""
    with tempfile.TemporaryDirectory() as name:
        alone = c_table(Path(name))
    text = (
        "20 km of 8.35 g/m, E A = 320 kN, between points of 500 kg and 86 t; tau = c / E A is 0.05 s. `benchmarks/line.c` is "
        f"the same arithmetic in C ({' '.join(FLAGS[:3])}). Hoped for: equal to C; linear in nodes; the implicit method 20 times "
        "cheaper at 1 m over a day; 20 times as many segments a second as MoorDyn."
    )
    return [
        "## Lines with nodes", "", text, "", *markdown(alone), *markdown(nodes_table()), *markdown(precision_table()),
        *markdown(moordyn_table()),
    ]  # fmt: skip
