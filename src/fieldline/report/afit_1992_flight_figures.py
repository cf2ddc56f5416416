"""Figures of the tracking vehicle flown: a day on the plant, the range of the linear motion, docking, a change of orbit."""

from __future__ import annotations

from typing import Any

from fieldline.report.afit_1992_figures import powers
from fieldline.report.series import legend, line, room
from fieldline.report.theme import AXIS_COLOURS, FOURTH, GREY, INK, WARM, label_outer, panels

HOUR_S, DAY_S = 3600.0, 86400.0
GOOD = 0.01


def flown_figure(dataset: Any) -> Any:
    """Place, angle and currents over the day."""
    figure, axes = panels(3, 1, height_in=6.0, row_gap=0.32)
    hours = dataset["seconds"].values / HOUR_S
    place, current = dataset["place_h_m"].values, dataset["current_a"].values
    for k, words in enumerate(("up", "along", "across")):
        line(axes[0, 0], hours, place[:, k], AXIS_COLOURS[k], words, width=1.2)
    line(axes[1, 0], hours, dataset["angle_deg"].values, INK, width=1.0)
    for k, name in enumerate(dataset["conductor"].values[::2]):
        line(axes[2, 0], hours, current[:, 2 * k], (*AXIS_COLOURS, FOURTH)[k % 4], str(name), width=1.0)
    axes[0, 0].set_ylabel("place [m]")
    axes[0, 0].set_title(dataset.attrs["title"])
    axes[1, 0].set_ylabel("off [deg]")
    axes[2, 0].set_ylabel("current [A]")
    for panel, values, least in zip(axes[:, 0], (place, dataset["angle_deg"].values, current), (1.0, 1e-3, 1.0), strict=True):
        panel.set_ylim(*room(values, least=least))
        panel.set_xlim(hours[0], hours[-1])
    for panel in (axes[0, 0], axes[2, 0]):
        legend(panel)
    label_outer(axes, ("time [h]",))
    return figure


def range_figure(dataset: Any) -> Any:
    """Errors of place and pitch on logarithmic scales."""
    figure, axes = panels(1, 2, height_in=3.2, column_gap=0.24)
    for k, words in enumerate(dataset["direction"].values):
        axes[0, 0].plot(
            dataset["offset_m"].values, dataset["place_error"].values[k], ".-", color=AXIS_COLOURS[k], label=str(words)
        )
    axes[0, 1].plot(dataset["angle_deg"].values, dataset["pitch_error"].values, ".-", color=INK)
    for panel, title, label in (
        (axes[0, 0], "place, over an orbit", "start from the target [m]"),
        (axes[0, 1], f"pitch: 1 % at {float(dataset['good_to_deg']):.1f} deg", "amplitude [deg]"),
    ):
        panel.set_xscale("log")
        panel.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
        panel.xaxis.set_minor_formatter(lambda value, _: "")
        powers(panel)
        panel.axhline(GOOD, color=WARM, linewidth=0.8)
        panel.set_title(title)
        panel.set_xlabel(label)
    axes[0, 0].set_ylabel("error of the linear motion")
    legend(axes[0, 0])
    return figure


def docking_figure(dataset: Any) -> Any:
    """How the six quantities of contact are spread."""
    figure, axes = panels(2, 3, height_in=4.6, row_gap=0.5, column_gap=0.2)
    for panel, name in zip(axes.ravel(), dataset["quantity"].values, strict=True):
        values = dataset[str(name)].values
        factor, unit = (1e3, "m" + dataset[str(name)].attrs["units"].replace(" s-1", "/s")) if values.max() < 0.5 else (1.0, "m")
        panel.hist(factor * values, bins=20, color=AXIS_COLOURS[0])
        panel.set_title(str(name).rsplit("_m", 1)[0].rsplit("_deg", 1)[0].replace("_", " "))
        panel.set_xlabel(unit.replace("degree", "deg"))
    axes[0, 0].set_ylabel("runs")
    axes[1, 0].set_ylabel("runs")
    return figure


def change_figure(dataset: Any) -> Any:
    """Height and inclination over the days, three ways."""
    figure, axes = panels(2, 1, height_in=4.4, row_gap=0.32)
    days = dataset["seconds"].values / DAY_S
    if "flown_seconds" in dataset.coords:
        flown = dataset["flown_seconds"].values / DAY_S
        line(axes[0, 0], flown, dataset["flown_altitude_m"].values / 1e3, GREY, "flown", width=2.4)
        line(axes[1, 0], flown, dataset["flown_inclination_deg"].values, GREY, "flown", width=2.4)
    line(axes[0, 0], days, dataset["closed_altitude_m"].values / 1e3, WARM, "constant thrust", dashed=True)
    line(axes[0, 0], days, dataset["altitude_m"].values / 1e3, AXIS_COLOURS[0], "averaged", width=1.2)
    line(axes[1, 0], days, dataset["inclination_deg"].values, AXIS_COLOURS[0], "averaged", width=1.2)
    axes[0, 0].set_ylabel("height [km]")
    axes[1, 0].set_title("inclination [deg]")
    axes[0, 0].set_title(f"{dataset.attrs['title']}; {float(dataset['energy_j']) / 3.6e6:.4g} kWh")
    for panel in axes[:, 0]:
        panel.set_xlim(days[0], days[-1])
        panel.yaxis.set_major_formatter(lambda value, _: f"{value:.7g}")
        legend(panel)
    label_outer(axes, ("time [days]",))
    return figure


OWN_FIGURES = {
    "afit_1992_flown": flown_figure,
    "afit_1992_linear_range": range_figure,
    "afit_1992_docking": docking_figure,
    "afit_1992_orbit_change": change_figure,
}
