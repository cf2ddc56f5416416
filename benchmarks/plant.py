"""The plant against C (`plant.c`) and Basilisk, laws in plain Python, the first step of a new process, and ensembles.

C flies the same arithmetic and must agree to 1e-9 after 100 steps. Basilisk evaluates its field once a step, so that its
figure stands beside ours with the field once a step and at every stage. All of a table run in turns, in one process.
"""

from __future__ import annotations

import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

import peer_basilisk
from fieldline.simulate.ensemble import Uniform, simulate_many
from fieldline.simulate.ensemble.coverage import block_of
from fieldline.simulate.ensemble.lane_loop import fly_lanes
from fieldline.simulate.ensemble.lanes import LANES
from fieldline.simulate.flight import Flight
from measure import best_of_each, timed, wall
from satellite import FLAGS, constants, plant_in_c, scenario

AGREE = 1e-9  # relative: the same arithmetic but for rounding
STEPS = 5000  # of a flight in one timed call: coming from Python costs it 0.4 ms
FEW = 100  # of the others: the shorter a call, the more of them are not interrupted
SCALE = np.repeat([7e6, 7.5e3, 1.0, 0.06], [3, 3, 4, 3])  # of position, velocity, attitude and rate
C_LANES = 8
PLAIN = {"law": "plain_law.py:b_dot", "rate_hz": 1.0, "commands": ["dipole"], "memory": 4, "compiled": False}
# As Basilisk has it: no gravity gradient, no residual dipole.
BARE = {"body.0.gravity_gradient": False, "body.0.residual_dipole_a_m2": [0.0, 0.0, 0.0]}
SPREAD = {"body.0.rate_deg_s": Uniform([-10.0] * 3, [10.0] * 3)}


def flying(**changes):
    """A call that flies STEPS more steps of a flight; a new one begins where a day is over."""
    chosen = scenario(**changes)
    flights = [Flight(chosen)]

    def call() -> None:
        if flights[0].clock.steps[0] + STEPS >= 86_400:
            flights[0] = Flight(chosen)
        flights[0]._fly_on(STEPS)  # one call of the compiled loop, as `fly` makes many

    return call


def in_c(fly, flight: Flight, lanes: int):
    """A call that flies FEW steps of plant.c from the start."""
    start = np.ascontiguousarray(np.repeat(flight.start[:, None], lanes, axis=1))
    return lambda: fly(start.copy(), FEW, 1.0, constants(flight))  # the flight owns the arrays that C reads


def apart(fly, lanes: int, **changes) -> float:
    """Greatest difference between plant.c and the plant after 100 steps, over the size of each number."""
    flight = Flight(scenario(**changes))
    y = np.ascontiguousarray(np.repeat(flight.start[:, None], lanes, axis=1))
    fly(y, 100, 1.0, constants(flight))
    flight._fly_on(100)
    return float((np.abs(y - flight.y[:, None]).max(axis=1) / SCALE).max())


def checked(folder: Path, lanes: int):
    """plant.c, found to agree with the plant; None without a compiler."""
    fly = plant_in_c(folder, lanes)
    for update in ("stage", "step") if fly else ():
        far = apart(fly, lanes, **{"integrator.field_update": update})
        if not far < AGREE:
            raise SystemExit(f"the plant and its C twin are {far:.1e} apart (field per {update}); {AGREE:g} was expected.")
    return fly


def c_table(folder: Path) -> list[tuple[str, ...]]:
    """(what, thousand steps a second, C, ratio)."""
    fly = checked(folder, 1)
    rows = [("one satellite, one core", "thousand steps/s", "C", "Fieldline / C")]
    for words, update in (("field at every stage", "stage"), ("field once a step", "step")):
        change = {"integrator.field_update": update}
        calls = {"plant": flying(**change)}
        if fly:
            calls["C"] = in_c(fly, Flight(scenario(**change)), 1)
        rate = {name: (FEW if name == "C" else STEPS) / seconds / 1e3 for name, seconds in best_of_each(calls).items()}
        beside = (f"{rate['C']:.0f}", f"{rate['plant'] / rate['C']:.2f}") if fly else ("no compiler", "-")
        rows.append((words, f"{rate['plant']:.0f}", *beside))
    return rows


def basilisk_table() -> list[tuple[str, ...]]:
    """(what, ours, Basilisk's, ratio), thousand steps a second; without Basilisk one row that says so."""
    try:
        peers = peer_basilisk.flights()
    except ImportError:
        return [("steps/s", "Basilisk"), ("Basilisk (`pip install bsk`) is not installed", "-")]
    once, no_law = {"integrator.field_update": "step"}, {"software": [], "body.0.magnetometer": None, **BARE}
    ours = {
        ("field once a step, no law", "without a law"): flying(**no_law, **once),
        ("field at every stage, no law", "without a law"): flying(**no_law),
        ("field once a step, law in plain Python", "with a law in Python"): flying(**BARE, **once, software=[PLAIN]),
        ("field at every stage, law in plain Python", "with a law in Python"): flying(**BARE, software=[PLAIN]),
    }
    calls = {**ours, **{name: lambda advance=advance: advance(FEW) for name, advance in peers.items()}}
    rate = {name: (FEW if name in peers else STEPS) / seconds / 1e3 for name, seconds in best_of_each(calls, rounds=40).items()}
    hoped = ("25", "8", "25", "")
    rows = [("the same satellite", "Fieldline", "Basilisk", "ratio", "hoped for")]
    for name, goal in zip(ours, hoped, strict=True):
        rows.append((name[0], f"{rate[name]:.0f}", f"{rate[name[1]]:.1f}", f"{rate[name] / rate[name[1]]:.0f}", goal))
    return rows


def day_table() -> list[tuple[str, ...]]:
    """(what, seconds, hoped for): a day with a law in Python, and the first step of a second process."""
    first = "import sys; sys.path.insert(0, sys.argv[1]); from satellite import *; Flight(scenario())._fly_on(1)"
    command = (sys.executable, "-W", "ignore", "-c", first, str(Path(__file__).parent))
    wall(*command)
    day = min(timed(Flight(scenario(software=[PLAIN])).fly) for _ in range(2))
    start = min(wall(*command) for _ in range(3))
    return [
        ("", "seconds", "hoped for"),
        ("a day, 86,400 steps, with a law in plain Python at 1 Hz", f"{day:.1f}", "under 3"),
        ("a second process to its first step", f"{start:.2f}", "under 1"),
    ]


def in_lanes():
    """A call that flies FEW steps of a full block."""
    block = [block_of([Flight(scenario())] * LANES)]

    def call() -> None:
        if block[0].progress.call[0] + FEW >= 86_400:
            block[0] = block_of([Flight(scenario())] * LANES)
        fly_lanes(FEW, *block[0])

    return call


def ensemble_table(folder: Path) -> list[tuple[str, ...]]:
    """(what, million steps of all satellites a second and core, of C in lanes)."""
    fly = checked(folder, C_LANES)
    calls = {"one after the other": flying(), f"{LANES} in lanes": in_lanes()}
    many = {"one after the other": STEPS, f"{LANES} in lanes": FEW * LANES}
    if fly:
        name = f"C, {C_LANES} in lanes"
        calls[name], many[name] = in_c(fly, Flight(scenario()), C_LANES), FEW * C_LANES
    rate = {name: many[name] / seconds / 1e6 for name, seconds in best_of_each(calls, rounds=60).items()}
    rows = [("one core", "million steps/s", "of C in lanes")]
    best = rate.get(f"C, {C_LANES} in lanes")
    return rows + [(name, f"{value:.2f}", f"{value / best:.2f}" if best else "-") for name, value in rate.items()]


def scaling(runs: int = 1000, calls: int = 600) -> tuple[float, float, float]:
    """[s] to fly an ensemble for so many seconds on one thread and on two, in turns; and [ms] to set one run up."""
    chosen = scenario(**{"time.duration_s": 3600.0})
    flights = [Flight(chosen) for _ in range(LANES)]
    blocks = [block_of(flights) for _ in range(0, runs, LANES)]

    def fly(workers: int) -> None:
        for block in blocks:
            block.progress.call[0] = 0
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(lambda block: fly_lanes(calls, *block), blocks))

    taken = best_of_each({1: lambda: fly(1), 2: lambda: fly(2)}, rounds=5)
    short = chosen.replace(**{"time.duration_s": 60.0})
    setting_up = timed(lambda: simulate_many(short, 100, disperse=SPREAD, workers=1)) * 10.0
    return taken[1], taken[2], setting_up


def chapter(markdown) -> list[str]:
    """The chapter of docs/benchmarks.md."""
    with tempfile.TemporaryDirectory() as name:
        alone, lanes = c_table(Path(name)), ensemble_table(Path(name))
    one, two, setting_up = scaling()
    text = (
        "A tumbling 3U: orbit with J2, IGRF-14 to degree 13, rigid body, residual dipole, gravity gradient, B-dot at 1 Hz, RK4 "
        f"at 1 s. `benchmarks/plant.c` is the same arithmetic in C ({' '.join(FLAGS[:3])}), with one field a second more for the "
        "reading, as the plant. Hoped for: at least 0.8 of C; in lanes 0.5."
    )
    scaled = (
        f"1,000 satellites, 600 s: {one:.2f} s on one thread, {two:.2f} s on two: {one / two:.2f} times (hoped for: 1.8). "
        f"Setting a run up takes {setting_up:.1f} ms besides."
    )
    return [
        "## The plant", "", text, "", *markdown(alone), *markdown(basilisk_table()),
        "Basilisk: 2.12 from PyPI, gravity with J2, WMM2025 once a step, `MtbEffector`, RK4; thousand steps a second.", "",
        *markdown(day_table()), "### Many satellites", "", *markdown(lanes), scaled, "",
    ]  # fmt: skip
