"""`fl.simulate`: a scenario in, every signal out."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from fieldline.errors import InputError, shown
from fieldline.simulate.outcome import RunError, RunInterrupted, sentence

if TYPE_CHECKING:
    import xarray

    from fieldline.simulate.scenario.scenario import Scenario


def simulate(
    scenario: Scenario | str | Path, *, seed: int | None = None, progress: Callable[[float], None] | None = None
) -> xarray.Dataset:
    """Fly a scenario: bodies, loads, sensors and flight software from its start to its end.

    Parameters
    ----------
    scenario : a `Scenario`, or the path of its TOML file.
    seed : in place of the scenario's; the same scenario and seed give the same bits.
    progress : called with the fraction done, a few times a second.

    Returns
    -------
    Dataset over `time` (every output_step_s) and `body`: position_i, velocity_i [m, m/s], q_bi (scalar last), omega_bi_b
    [rad/s], field_i and field_b [T], sunlit, latitude_deg, longitude_deg, altitude_m; force_i [N] and torque_b [N m] of
    every load over `load`; torquer_moment, wheel_momentum, wheel_torque, thrust, rod_induction where there are such;
    readings of each sensor on times of their own (magnetometer_NAME over time_magnetometer_NAME); attitude and rate as
    known on board (q_bi_known, omega_bi_b_known); events. Attributes: outcome in words, complete (0 or 1), the scenario
    itself, provenance_json.

    Raises
    ------
    InputError : what the scenario names cannot be had.
    RunError : an InputError; a law, a load or the step failed in the run. Its `dataset` has what was simulated.
    RunInterrupted : a KeyboardInterrupt; its `dataset` has what was simulated.
    """
    from fieldline.simulate.flight import Flight
    from fieldline.simulate.run_dataset import dataset_of
    from fieldline.simulate.scenario.scenario import Scenario

    if not isinstance(scenario, Scenario | str | PathLike):
        raise InputError(f"scenario must be a Scenario or the path of its TOML file; got {shown(repr(scenario))}.")
    if not isinstance(scenario, Scenario):
        scenario = Scenario.read(scenario)
    scenario.check()
    flight = Flight(scenario, seed)
    flight.fly(progress)
    dataset = dataset_of(flight)
    if flight.interrupted:
        raise RunInterrupted(sentence(flight), dataset)
    if not flight.complete:
        raise RunError(sentence(flight), dataset) from flight.host.error
    return dataset
