"""Figures of the 1961 study's cases: the field, a pointing, momentum dumped, the coil, a day of the observatory.

`own_figure` draws what a Dataset's attribute "case" names; the gallery draws the study's own figures with the same strokes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fieldline.report.coil_figures import trade_figure
from fieldline.report.series import legend, line
from fieldline.report.theme import AXIS_COLOURS, FAINT, FOURTH, GREY, INK, label_outer, panels, themed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MICROTESLA = 1e6
HOUR_S = 3600.0


def own_figure(dataset: Any) -> Figure:
    """The figure of the case that the Dataset names."""
    with themed():
        return OWN_FIGURES[dataset.attrs["case"]](dataset)


def field_figure(dataset: Any) -> Figure:
    """Components over the field above the pole, and the magnitude."""
    figure, axes = panels(2, 1, height_in=4.4, heights=(2.0, 1.0), row_gap=0.25)
    time, label = clock(dataset)
    draw_components(axes[0, 0], time, dataset["normalised_s"].values)
    axes[0, 0].set_title(dataset.attrs["title"])
    axes[0, 0].set_ylabel("over the polar field")
    legend(axes[0, 0])
    line(axes[1, 0], time, dataset["magnitude"].values * MICROTESLA, INK)
    axes[1, 0].set_ylabel("magnitude [µT]")
    return _finished(figure, axes, time, label)


def pointing_figure(dataset: Any) -> Figure:
    """What the sensor puts out, the coils' moments, the roll."""
    figure, axes = panels(3, 1, height_in=5.6, row_gap=0.34)
    time = dataset["seconds"].values
    for k, name in enumerate("yz"):
        line(axes[0, 0], time, dataset["sensor"].values[:, k], AXIS_COLOURS[k + 1], name, width=1.3)
    axes[0, 0].set_title(dataset.attrs["title"])
    axes[0, 0].set_ylabel("sensor [arcsec]")
    legend(axes[0, 0])
    draw_components(axes[1, 0], time, dataset["moment"].values)
    axes[1, 0].set_ylabel("moment [A m²]")
    legend(axes[1, 0])
    line(axes[2, 0], time, dataset["roll_angle"].values, INK)
    axes[2, 0].set_ylabel("roll [deg]")
    return _finished(figure, axes, time, "time [s]")


def dump_figure(dataset: Any) -> Figure:
    """Components of the momentum, and what is left of it with its part along the field."""
    from matplotlib.ticker import FuncFormatter

    figure, axes = panels(2, 1, height_in=4.6, row_gap=0.3)
    time = dataset["seconds"].values / dataset.attrs["period_s"]
    draw_components(axes[0, 0], time, dataset["momentum"].values)
    axes[0, 0].set_title(dataset.attrs["title"])
    axes[0, 0].set_ylabel("momentum [N m s]")
    legend(axes[0, 0])
    size = np.linalg.norm(dataset["momentum"].values, axis=1)
    line(axes[1, 0], time, size, INK, "|H|", width=1.3)
    line(axes[1, 0], time, np.abs(dataset["along_field"].values), FOURTH, "|H| along the field")
    axes[1, 0].set_yscale("log")
    axes[1, 0].yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes[1, 0].set_ylim(0.5 * size.min(), 1.6 * size.max())
    axes[1, 0].set_ylabel("[N m s]")
    legend(axes[1, 0])
    return _finished(figure, axes, time, "orbits")


def coil_figure(dataset: Any) -> Figure:
    """The trade of power against mass."""
    power, mass = dataset["trade_power_w"].values, dataset["trade_mass_kg"].values
    return trade_figure(mass, power, float(dataset["mass_kg"]), float(dataset["power_w"]), dataset.attrs["title"])


def observatory_figure(dataset: Any) -> Figure:
    """Errors, the field along the line with its weak stretches shaded, moments, and roll or its wheel."""
    figure, axes = panels(4, 1, height_in=7.2, row_gap=0.3)
    time, label = clock(dataset)
    for k, name in enumerate("yz"):
        line(axes[0, 0], time, dataset["error"].values[:, k], AXIS_COLOURS[k + 1], name)
    share, limit = 100.0 * float(dataset["within_fraction"]), dataset.attrs["tolerance_arcsec"]
    axes[0, 0].set_title(f"{dataset.attrs['title']}: {share:.2f} % of the time within {limit:g} arcsec")
    axes[0, 0].set_ylabel("error [arcsec]")
    axes[0, 0].axhspan(-limit, limit, color=FAINT, linewidth=0)
    legend(axes[0, 0])
    line(axes[1, 0], time, dataset["along_line"].values, INK)
    axes[1, 0].axhspan(-0.05, 0.05, color=FAINT, linewidth=0)
    axes[1, 0].set_ylabel("field along line / B")
    draw_components(axes[2, 0], time, dataset["moment"].values)
    axes[2, 0].set_ylabel("moment [A m²]")
    legend(axes[2, 0])
    wheel = "wheel_momentum" in dataset
    line(axes[3, 0], time, dataset["wheel_momentum" if wheel else "roll_angle"].values, GREY)
    axes[3, 0].set_ylabel("roll wheel [N m s]" if wheel else "roll [deg]")
    return _finished(figure, axes, time, label)


def draw_components(axes: Any, time: np.ndarray, values: np.ndarray) -> None:
    """x, y and z in their colours."""
    for k, name in enumerate("xyz"):
        line(axes, time, values[:, k], AXIS_COLOURS[k], name, width=1.2)


def clock(dataset: Any) -> tuple[np.ndarray, str]:
    """Time in hours where the run is long, else in seconds, and its label."""
    seconds = dataset["seconds"].values
    return (seconds / HOUR_S, "time [h]") if seconds[-1] > 3.0 * HOUR_S else (seconds, "time [s]")


def _finished(figure: Figure, axes: Any, time: np.ndarray, label: str) -> Figure:
    """The same time axis under all panels."""
    for one in axes[:, 0]:
        one.set_xlim(time[0], time[-1])
    label_outer(axes, (label,))
    return figure


OWN_FIGURES = {
    "ames_1961_field": field_figure,
    "ames_1961_pointing": pointing_figure,
    "ames_1961_dump": dump_figure,
    "ames_1961_coil": coil_figure,
    "ames_1961_observatory": observatory_figure,
}
