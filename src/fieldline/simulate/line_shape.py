"""`line_shape`: how a line of a run hangs in orbital axes, from the Dataset of the run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fieldline.analysis.line_shape import LineShape, Skiprope, shape_of_line, skiprope_of
from fieldline.errors import InputError, nearest

if TYPE_CHECKING:
    import xarray

POSITION = "line_position_i_"


def line_shape(dataset: xarray.Dataset, name: str = "") -> xarray.Dataset:
    """Chord, librations, deflection, bow and skiprope of a line of a run over time; equations in `fieldline.analysis.line_shape`.

    Parameters
    ----------
    dataset : of `fieldline.simulate`, whole or partial, in memory or opened from its NetCDF file.
    name : the line; the first one by default.

    Returns
    -------
    Dataset over time: point_o (point, axis) [m] from the mass centre of the bodies at its ends, in that centre's orbital axes;
    chord [m]; in_plane, across [rad], of the chord pointed down the line; along (point) [m] from the from_body; deflection
    (point, lateral) [m] from the chord, in the plane and across it; bow (lateral) [m], its first half wave. Where it swings for
    a period or more also skiprope_semi_major, skiprope_semi_minor [m], skiprope_phase [rad], skiprope_rate [rad/s] and
    skiprope_sense, 1 where it goes round right-handed about the direction down the line, -1 left-handed, 0 in one plane.

    Errors: InputError where the Dataset has no such line.
    """
    import xarray

    name = name_of_line(dataset, name)
    shape = shape_in_run(dataset, name)
    point, lateral = ("time", "point"), ("time", "lateral")
    words: dict[str, tuple[Any, Any, str, str]] = {
        "point_o": ((*point, "axis"), shape.point_o, "m", "points from the mass centre of the bodies at the ends"),
        "chord": ("time", shape.chord_m, "m", "distance of the ends"),
        "in_plane": ("time", shape.in_plane_rad, "rad", "libration in the plane, positive with the lower end ahead"),
        "across": ("time", shape.across_rad, "rad", "libration across the plane, positive against the orbit's normal"),
        "along": (point, shape.along_m, "m", "place of the points along the chord, from the from_body"),
        "deflection": ((*point, "lateral"), shape.deflection_m, "m", "deflection from the chord"),
        "bow": (lateral, shape.bow_m, "m", "first half wave of the deflection"),
    }
    found = skiprope_of(shape, dataset["seconds"].values)
    if found is not None:
        words |= _skiprope(found)
    return xarray.Dataset(
        {key: (dims, values, {"units": units, "long_name": text}) for key, (dims, values, units, text) in words.items()},
        coords={"time": dataset["time"].values, "axis": ["x", "y", "z"], "lateral": ["in_plane", "across"]},
        attrs={"line": name, "title": f"shape of {name}"},
    )


def _skiprope(found: Skiprope) -> dict[str, tuple[str, np.ndarray, str, str]]:
    """The variables of a skiprope."""
    return {
        "skiprope_semi_major": ("time", found.semi_major_m, "m", "larger semi-axis of the bow's ellipse about its mean"),
        "skiprope_semi_minor": ("time", found.semi_minor_m, "m", "smaller semi-axis of it"),
        "skiprope_phase": ("time", found.phase_rad, "rad", "phase of the bow about its mean, from in_plane to across"),
        "skiprope_rate": ("time", found.rate_rad_s, "rad s-1", "angular frequency of it"),
        "skiprope_sense": ("time", found.sense, "1", "1 right-handed about the direction down the line, -1 left-handed"),
    }


def lines_in_run(dataset: Any) -> list[str]:
    """Names of the lines whose shape a run's Dataset holds."""
    return [str(key).removeprefix(POSITION) for key in dataset.data_vars if str(key).startswith(POSITION)]


def name_of_line(dataset: Any, name: str) -> str:
    """The name of a line that there is; "" is the first."""
    names = lines_in_run(dataset)
    if not names:
        raise InputError("the Dataset holds no line; expected a run of fieldline.simulate whose scenario has a [[line]].")
    if name and name not in names:
        raise InputError(f'the run has no line "{name}"; {nearest(name, names)}')
    return name or names[0]


def ends_of_line(scenario: Any, name: str) -> tuple[int, int]:
    """Indices of a line's from_body and to_body."""
    for k, line in enumerate(scenario.line, start=1):
        if name in (line.name, f"line_{k}"):
            return scenario.index_of(line.from_body), scenario.index_of(line.to_body)
    raise InputError(f'the scenario of the run has no line "{name}".')


def shape_in_run(dataset: Any, name: str, scenario: Any = None) -> LineShape:
    """A line's shape about the mass centre of the bodies at its ends."""
    from fieldline.simulate.scenario.scenario import Scenario

    flown = scenario or Scenario.from_toml(dataset.attrs["scenario_toml"])
    ends = list(ends_of_line(flown, name))
    masses = [flown.body[b].mass_kg for b in ends]
    place, moving = (np.average(dataset[key].values[:, ends], axis=1, weights=masses) for key in ("position_i", "velocity_i"))
    return shape_of_line(dataset[POSITION + name].values, dataset[f"line_velocity_i_{name}"].values, place, moving)
