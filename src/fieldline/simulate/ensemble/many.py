"""`fl.simulate_many`: a scenario flown many times, each time a little different.

Runs that the lanes cover fly sixteen at a time (`lane_loop`), others each in the plant's own loop; either way in threads,
since compiled loops let go of the interpreter. What a run draws and how it flies depend on its number alone.
"""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from os import cpu_count
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Any

import numpy as np

from fieldline.errors import InputError
from fieldline.simulate.ensemble.coverage import alike, block_of, covered
from fieldline.simulate.ensemble.dispersion import Disperse, drawn, streams
from fieldline.simulate.ensemble.lane_loop import fly_lanes
from fieldline.simulate.ensemble.lanes import LANES
from fieldline.simulate.flight import Flight
from fieldline.simulate.loop.records import SAME_TIME_S, Outcome
from fieldline.simulate.outcome import RunInterrupted

if TYPE_CHECKING:
    import xarray

    from fieldline.simulate.scenario.scenario import Scenario

MOST_RUNS = 1_000_000
BUDGET = 2000  # law calls of a block between two looks at whether to go on
UNFINISHED = int(Outcome.PAUSED)


@dataclass
class Run:
    """One run: what it was given, and what it left."""

    number: int
    seed: int
    changes: dict[str, Any]
    outcome: int = UNFINISHED
    ended_s: float = np.nan
    seconds: np.ndarray = field(default_factory=lambda: np.empty(0))
    state: np.ndarray = field(default_factory=lambda: np.empty((0, 0)))  # (outputs, numbers of the plant's state)
    actuators: np.ndarray = field(default_factory=lambda: np.empty((0, 0)))


def simulate_many(
    scenario: Scenario | str | Path,
    runs: int,
    *,
    disperse: Disperse = None,
    seed: int | None = None,
    workers: int | None = None,
    lanes: bool = True,
    progress: Callable[[float], None] | None = None,
) -> xarray.Dataset:
    """Fly a scenario many times: Monte Carlo.

    Parameters
    ----------
    scenario : a `Scenario`, or the path of its TOML file.
    runs : how many.
    disperse : what differs, {path: Normal | Uniform | Choice}, or a function (rng, run) -> {path: value}; paths as of
        `Scenario.replace`. Without it only the random numbers of sensors and starts differ.
    seed : in place of the scenario's; run k draws the same whatever `runs` and `workers` are.
    workers : threads; as many as there are processors if not given.
    lanes : False flies every run in the plant's own loop.
    progress : called with the fraction of runs that are done.

    Returns
    -------
    Dataset over `run`, `time` and `body`: position_i, velocity_i [m, m/s], q_bi (scalar last), omega_bi_b [rad/s], NaN
    after a run's end; torquer_moment; ended_s, outcome (word), seed of each run, and what it drew, under its path.

    Raises
    ------
    InputError : a run cannot be had as drawn; its number and what it drew are said.
    RunInterrupted : a KeyboardInterrupt; its `dataset` has the runs that were done.
    """
    from fieldline.simulate.ensemble.ensemble_dataset import dataset_of
    from fieldline.simulate.scenario.scenario import Scenario

    if isinstance(runs, bool) or not isinstance(runs, int) or not 1 <= runs <= MOST_RUNS:
        raise InputError(f"runs must be a whole number from 1 to {MOST_RUNS:,}; got {runs!r}.")
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int) or workers < 1):
        raise InputError(f"workers must be a whole number of at least 1; got {workers!r}.")
    if not isinstance(scenario, Scenario):
        scenario = Scenario.read(scenario)
    scenario.check()
    first_seed = scenario.seed if seed is None else seed
    made = [Run(k, s, drawn(disperse, rng, k)) for k, (rng, s) in enumerate(streams(first_seed, runs))]
    stop = Event()
    try:
        _fly_all(scenario, made, workers or cpu_count() or 1, lanes, stop, progress)
    except KeyboardInterrupt:
        done = sum(run.outcome != UNFINISHED for run in made)
        raise RunInterrupted(f"interrupted: {done} of {runs} runs are done.", dataset_of(scenario, made, first_seed)) from None
    return dataset_of(scenario, made, first_seed)


def _fly_all(scenario, runs: list[Run], workers: int, lanes: bool, stop: Event, progress) -> None:
    """All runs, in groups of LANES, on so many threads; the first error ends all."""
    groups = [runs[k : k + LANES] for k in range(0, len(runs), LANES)]
    done = 0
    with ThreadPoolExecutor(workers) as pool:
        futures = [pool.submit(_fly_group, scenario, group, lanes, stop) for group in groups]
        try:
            for future, group in zip(futures, groups, strict=True):
                future.result()
                done += len(group)
                if progress is not None:
                    progress(done / len(runs))
        except BaseException:
            stop.set()
            for future in futures:
                future.cancel()
            raise


def _fly_group(scenario, group: list[Run], lanes: bool, stop: Event) -> None:
    """Some runs on one thread: in lanes where all of them are covered and alike."""
    if stop.is_set():
        return
    flights = [_flight(scenario, run) for run in group]
    if lanes and all(covered(f) and alike(f, flights[0]) for f in flights):
        _fly_block(group, flights, stop)
        return
    for run, flight in zip(group, flights, strict=True):
        flight.fly(lambda _: _give_up(stop))
        if flight.interrupted:
            return
        _keep_flight(run, flight)


def _give_up(stop: Event) -> None:
    """Leave a flight whose ensemble was ended."""
    if stop.is_set():
        raise KeyboardInterrupt


def _flight(scenario, run: Run) -> Flight:
    """A run, ready to fly; errors say which it is."""
    try:
        return Flight(scenario.replace(**run.changes) if run.changes else scenario, run.seed)
    except InputError as error:
        given = ", ".join(f"{path} = {value}" for path, value in run.changes.items())
        raise InputError(f"run {run.number} ({given or 'as the scenario has it'}) cannot be flown: {error}") from error


def _keep_flight(run: Run, flight: Flight) -> None:
    """What the plant's loop left."""
    rows = int(flight.clock.rows[0])
    step = flight.scenario.time.output_step_s
    while rows and abs(flight.record.seconds[rows - 1] - (rows - 1) * step) > SAME_TIME_S:
        rows -= 1  # the state in which an event stopped the run: it is on no other run's time
    run.outcome, run.ended_s = int(flight.outcome), float(flight.clock.t[0])
    run.seconds, run.state = flight.record.seconds[:rows], flight.record.state[:rows]
    run.actuators = flight.record.actuators[:rows]


def _fly_block(group: list[Run], flights: list[Flight], stop: Event) -> None:
    """Runs in lanes, to the last one's end."""
    block = block_of(flights)
    while not fly_lanes(BUDGET, *block):
        if stop.is_set():
            return
    progress = block.progress
    for n, run in enumerate(group):
        rows = int(np.isfinite(progress.state[n, :, 0]).sum())
        run.outcome, run.ended_s = int(progress.outcome[n]), float(progress.ended[n])
        run.seconds, run.state = progress.seconds[:rows], progress.state[n, :rows]
        run.actuators = progress.dipole[n, :rows]
