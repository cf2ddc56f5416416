"""One figure for any case: truth and estimate on each other, and below them what says how good the estimate is.

A variable `name` with a partner `name_true` makes a panel, a line for the truth and dots for the estimate; the floats over
time alone (losses, errors, a discriminant) make a panel for each first word of their names. A case whose attribute "case"
is known to `ames_1961_figures`, `sao_1982_figures`, `tp3123_figures` or `afit_1992_figures` is drawn there.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fieldline.errors import InputError
from fieldline.report import afit_1992_figures, afit_1992_flight_figures, ames_1961_figures, sao_1982_figures, tp3123_figures
from fieldline.report.record import Clock
from fieldline.report.series import legend, line, points
from fieldline.report.theme import AXIS_COLOURS, FOURTH, INK, WARM, label_outer, panels, themed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLOURS = (*AXIS_COLOURS, FOURTH, WARM, INK)
SHOWN_IN = {"rad s-1": ("deg/s", 180.0 / np.pi), "rad": ("deg", 180.0 / np.pi), "T": ("µT", 1e6), "1": ("", 1.0)}
PANEL_HEIGHT_IN = 1.55


def case_figure(dataset: Any) -> Figure:
    """The figure of a case's Dataset, its own where it has one; InputError where it has nothing over time."""
    known: dict[str, Any] = {}
    for room in (ames_1961_figures, sao_1982_figures, tp3123_figures, afit_1992_figures, afit_1992_flight_figures):
        known |= room.OWN_FIGURES
    own = known.get(str(dataset.attrs.get("case", "")))
    if own is not None:
        with themed():
            return own(dataset)
    pairs, singles = pairs_of(dataset), singles_of(dataset)
    count = len(pairs) + len(singles)
    if "time" not in dataset.coords or not count:
        raise InputError("the case's Dataset has no signal over time to draw.")
    time_utc = dataset["time"].values.astype("datetime64[ns]")
    seconds = (time_utc - time_utc[0]).astype(np.int64) * 1e-9
    clock = Clock.of(time_utc[0], float(seconds[-1]))
    time = seconds / clock.unit_s
    with themed():
        figure, axes = panels(count, 1, height_in=0.9 + PANEL_HEIGHT_IN * count, row_gap=0.34)
        for one, name in zip(axes[:, 0], pairs, strict=False):
            _draw_pair(one, time, dataset, name)
        for one, (name, members) in zip(axes[len(pairs) :, 0], singles.items(), strict=True):
            _draw_singles(one, time, dataset, name, members)
        for one in axes[:, 0]:
            one.set_xlim(time[0], time[-1])
        label_outer(axes, (clock.label,))
    return figure


def pairs_of(dataset: Any) -> list[str]:
    """Names of the signals over time that the truth is there for, but for quaternions, whose sign is free."""
    found = [str(name) for name in dataset.data_vars if f"{name}_true" in dataset and dataset[name].ndim == 2]
    return [name for name in found if dataset[name].dims[0] == "time" and not name.startswith("q_")]


def singles_of(dataset: Any) -> dict[str, list[str]]:
    """Names of the floats over time alone, by the first word of the name."""
    groups: dict[str, list[str]] = {}
    for name, variable in dataset.data_vars.items():
        if variable.dims == ("time",) and variable.dtype.kind == "f" and np.isfinite(variable.values).any():
            groups.setdefault(str(name).split("_")[0], []).append(str(name))
    return groups


def _draw_pair(axes: Any, time: np.ndarray, dataset: Any, name: str) -> None:
    """Components of the truth as lines and of the estimate as dots."""
    unit, factor = _unit(dataset[name])
    truth, found = dataset[f"{name}_true"].values * factor, dataset[name].values * factor
    labels = [str(label) for label in dataset[dataset[name].dims[1]].values]
    for k, label in enumerate(labels):
        line(axes, time, _without_wraps(truth[:, k], unit), COLOURS[k])
        points(axes, time, found[:, k], COLOURS[k], label)
    axes.set_title(f"{dataset[name].attrs.get('long_name', name)}: truth (lines), estimate (dots)")
    axes.set_ylabel(unit)
    legend(axes)


def _draw_singles(axes: Any, time: np.ndarray, dataset: Any, name: str, members: list[str]) -> None:
    """The members of a group over each other."""
    unit, factor = _unit(dataset[members[0]])
    for k, member in enumerate(members):
        line(axes, time, dataset[member].values * factor, COLOURS[k % len(COLOURS)], member.removeprefix(name).strip("_") or None)
    title = dataset[members[0]].attrs.get("long_name", name)
    axes.set_title(title if title.startswith(name) or len(members) > 1 else f"{name} {title}")
    axes.set_ylabel(unit)
    if len(members) > 1:
        legend(axes)


def _without_wraps(values: np.ndarray, unit: str) -> np.ndarray:
    """Angles with a pause where they jump over half a turn, so that no line crosses the panel."""
    jumps = np.flatnonzero(np.abs(np.diff(values)) > 180.0) if unit == "deg" else []
    broken = values.copy()
    broken[jumps] = np.nan
    return broken


def _unit(variable: Any) -> tuple[str, float]:
    """The unit that a panel shows and its factor."""
    unit = str(variable.attrs.get("units", ""))
    return SHOWN_IN.get(unit, (unit, 1.0))
