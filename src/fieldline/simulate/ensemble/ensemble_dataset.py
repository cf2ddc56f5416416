"""The runs of an ensemble as one xarray Dataset."""

from __future__ import annotations

from importlib import metadata
from typing import TYPE_CHECKING

import numpy as np

from fieldline.dynamics.parameters import STATE
from fieldline.simulate.loop.records import Outcome

if TYPE_CHECKING:
    import xarray

AXES = ["x", "y", "z"]


def dataset_of(scenario, runs, seed: int) -> xarray.Dataset:
    """All runs that were done; NaN where a run has no output."""
    import xarray

    runs = [run for run in runs if run.outcome != int(Outcome.PAUSED)]
    seconds = max((run.seconds for run in runs), key=len, default=np.empty(0))
    bodies = [body.name for body in scenario.body]
    state = _filled([run.state[:, : STATE * len(bodies)] for run in runs], len(seconds), STATE * len(bodies))
    state = state.reshape(len(runs), len(seconds), len(bodies), STATE)
    data = xarray.Dataset(
        coords={
            "run": np.array([run.number for run in runs], dtype=np.int64),
            "time": scenario.time.start + np.round(1e9 * seconds).astype("timedelta64[ns]"),
            "seconds": ("time", seconds, {"units": "s", "long_name": "time since the start"}),
            "body": bodies,
            "axis": AXES,
            "quaternion": ["x", "y", "z", "w"],
        }
    )
    for name, part, last, units, long_name in (
        ("position_i", slice(0, 3), "axis", "m", "position"),
        ("velocity_i", slice(3, 6), "axis", "m s-1", "velocity"),
        ("q_bi", slice(6, 10), "quaternion", "1", "attitude, scalar last"),
        ("omega_bi_b", slice(10, 13), "axis", "rad s-1", "angular rate"),
    ):
        data[name] = (("run", "time", "body", last), state[..., part], {"units": units, "long_name": long_name})
    _torquers(data, scenario, runs, len(seconds))
    words = [Outcome(run.outcome).name.lower() for run in runs]
    data["ended_s"] = ("run", np.array([run.ended_s for run in runs]), {"units": "s", "long_name": "when the run ended"})
    data["outcome"] = ("run", np.array(words, dtype=str), {"long_name": "how the run ended"})
    data["seed"] = ("run", np.array([run.seed for run in runs], dtype=np.int64), {"long_name": "seed that the run flew with"})
    _draws(data, runs)
    data.attrs = {
        "title": f"{scenario.name}: {len(runs)} runs",
        "scenario_toml": scenario.to_toml(),
        "seed": seed,
        "source": f"fieldline {metadata.version('fieldline')}",
    }
    return data


def _filled(parts, rows: int, columns: int) -> np.ndarray:
    """(runs, rows, columns), NaN below each part."""
    out = np.full((len(parts), rows, columns), np.nan)
    for k, part in enumerate(parts):
        out[k, : len(part)] = part
    return out


def _torquers(data, scenario, runs, rows: int) -> None:
    """Moments of the torquers, one column each."""
    names = [f"{body.name}:{k}" for body in scenario.body for k in range(len(body.magnetorquer))]
    if not names:
        return
    moments = _filled([run.actuators[:, : len(names)] for run in runs], rows, len(names))
    data.coords["torquer"] = names
    data["torquer_moment"] = (("run", "time", "torquer"), moments, {"units": "A m2", "long_name": "moment of the torquers"})


def _draws(data, runs) -> None:
    """What each run drew, one variable a path that all runs drew as numbers of one shape."""
    for path in runs[0].changes if runs else ():
        try:
            values = np.array([run.changes[path] for run in runs], dtype=float)
        except (KeyError, TypeError, ValueError):
            continue
        dims = ("run", *(f"{path}_{j}" for j in range(values.ndim - 1)))
        data[path] = (dims, values, {"long_name": f"drawn for {path}"})
