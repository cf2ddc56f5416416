"""Figures of the tracking vehicle's cases: its build, its matrices, what it reaches, an approach, the field, a climb."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from fieldline.report.series import legend, line, room
from fieldline.report.theme import AXIS_COLOURS, FOURTH, GREY, INK, WARM, label_outer, panels, themed

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MICROTESLA = 1e6
HOUR_S = 3600.0
DAY_S = 86400.0
PAIRS = {"I1": AXIS_COLOURS[0], "I2": AXIS_COLOURS[1], "I3": AXIS_COLOURS[2]}
LEAST_SPANS = (2.0, 1.0, 1.0, 0.5)  # m, nrad, A, N: less is rounding
DARK = 1e-17  # margins below this are drawn at it: a zero has no logarithm


def own_figure(dataset: Any) -> Figure:
    """The figure of the case that the Dataset names."""
    with themed():
        return OWN_FIGURES[dataset.attrs["case"]](dataset)


def vehicle_figure(dataset: Any) -> Figure:
    """The conductors from the north and from ahead."""
    figure, axes = panels(1, 2, height_in=3.6, column_gap=0.2)
    for panel, (across, up) in zip(axes[0], (("y", "x"), ("z", "x")), strict=True):
        for name in dataset["conductor"].values:
            one = dataset.sel(conductor=name)
            half = 0.5 * float(one["length_m"]) * one["direction_b"]
            ends = [one["position_b_m"] + side * half for side in (-1.0, 1.0)]
            x, y = ([float(end.sel(axis=axis)) for end in ends] for axis in (across, up))
            colour, dot = PAIRS[str(name)[:2]], np.ptp(x) + np.ptp(y) < 1e-9
            panel.plot(x, y, color=colour, linewidth=2.2, marker="o" if dot else "", markersize=4.0)
        panel.set_xlabel(f"{across} [m]")
        panel.set_aspect("equal", adjustable="datalim")
    axes[0, 0].set_ylabel("x, up [m]")
    axes[0, 0].set_title(dataset.attrs["title"])
    growth = float(dataset["growth_s"])
    axes[0, 1].set_title("does not grow by itself" if np.isinf(growth) else f"grows e-fold in {growth:.0f} s by itself")
    return figure


def model_figure(dataset: Any) -> Figure:
    """Sizes of F's and G's entries on a scale of powers of ten."""
    figure, axes = panels(1, 2, height_in=4.2, column_gap=0.3)
    for panel, name in zip(axes[0], ("F", "G"), strict=True):
        size = np.abs(dataset[name].values)
        shown = np.log10(np.where(size > 0.0, size, np.nan))
        image = panel.imshow(shown, cmap="viridis", aspect="auto")
        figure.colorbar(image, ax=panel, shrink=0.9)
        panel.set_title(f"{name}: powers of ten, SI")
        panel.grid(visible=False)
        columns = dataset[dataset[name].dims[1]].values
        panel.set_xticks(range(len(columns)), columns, rotation=90, fontsize=6.5)
        panel.set_yticks(range(12), dataset["state"].values if name == "F" else [""] * 12, fontsize=6.5)
    figure.subplots_adjust(bottom=0.24, left=0.1)
    return figure


def controllability_figure(dataset: Any) -> Figure:
    """The margin around the orbit, and the sets of conductors that may fail."""
    subsets = "subset" in dataset.coords
    figure, axes = panels(2 if subsets else 1, 1, height_in=4.6 if subsets else 2.8, row_gap=0.45)
    angle = dataset["field_angle_deg"].values
    line(axes[0, 0], angle, np.maximum(dataset["margin"].values, DARK), AXIS_COLOURS[0], width=1.4)
    axes[0, 0].axhline(dataset.attrs["threshold"], color=WARM, linewidth=0.8)
    axes[0, 0].set(xlabel="angle of the field [deg]", ylabel="margin", xlim=(angle[0], angle[-1]))
    powers(axes[0, 0])
    axes[0, 0].set_title(dataset.attrs["title"])
    if subsets:
        margin = np.sort(np.maximum(dataset["subset_margin"].values, DARK))
        axes[1, 0].plot(np.arange(1, len(margin) + 1), margin, ".", color=AXIS_COLOURS[1], markersize=4.0)
        powers(axes[1, 0])
        axes[1, 0].axhline(dataset.attrs["threshold"], color=WARM, linewidth=0.8)
        axes[1, 0].set(xlabel="sets of lost conductors, the worst first", ylabel="least margin")
    return figure


def powers(axes: Any) -> None:
    """A logarithmic scale with plain numbers."""
    from matplotlib.ticker import FuncFormatter

    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def survey_figure(survey: Any, title: str) -> Figure:
    """The chart of margins: inclination against argument of latitude, in powers of ten."""
    with themed():
        figure, axes = panels(1, 1, height_in=3.8)
        panel = axes[0, 0]
        shown = np.log10(np.maximum(survey["margin"].values, 1e-6))
        mesh = panel.pcolormesh(
            survey["argument_deg"].values,
            survey["inclination_deg"].values,
            shown,
            cmap="viridis",
            shading="nearest",
            vmin=-6.0,
            vmax=0.0,
        )
        figure.colorbar(mesh, ax=panel, pad=0.02).set_label("margin, power of ten")
        panel.set(xlabel="argument of latitude [deg]", ylabel="inclination [deg]")
        panel.set_title(title)
        panel.grid(visible=False)
        return figure


def lqr_figure(dataset: Any) -> Figure:
    """Places, angles, currents and thrust."""
    figure, axes = panels(4, 1, height_in=7.4, row_gap=0.3)
    seconds = dataset["seconds"].values
    state, control = dataset["state_of"].values, dataset["control_of"].values
    for k, name in enumerate("xyz"):
        line(axes[0, 0], seconds, dataset["reference_m"].values[:, k], GREY, dashed=True)
        line(axes[0, 0], seconds, state[:, 2 * k], AXIS_COLOURS[k], name, width=1.3)
        line(axes[1, 0], seconds, 1e9 * state[:, 6 + 2 * k], AXIS_COLOURS[k], f"ψ{k + 1}", width=1.2)
    axes[0, 0].set_title(dataset.attrs["title"])
    axes[0, 0].set_ylabel("place [m]")
    axes[1, 0].set_ylabel("angle [nrad]")
    names = [str(name) for name in dataset["control"].values]
    wires = [k for k, name in enumerate(names) if name.startswith("I")]
    for k in wires[::2]:  # the two of a pair lie on each other
        colour = (*AXIS_COLOURS, FOURTH)[k // 2 % 4]
        line(axes[2, 0], seconds, control[:, k], colour, names[k], width=1.2)
        line(axes[2, 0], seconds, control[:, k + 1], INK, dashed=True, width=0.7)
    axes[2, 0].set_ylabel("current [A]")
    axes[2, 0].set_title(f"largest current {float(dataset['peak_current_a']):.4g} A; dashed: the other of the pair")
    rest = [k for k in range(len(names)) if k not in wires]
    for k in rest:
        line(axes[3, 0], seconds, control[:, k], INK, names[k], width=1.2)
    axes[3, 0].set_ylabel("thrust [N]")
    drawn = state[:, :6:2], 1e9 * state[:, 6::2], control[:, wires], control[:, rest]
    for panel, values, least in zip(axes[:, 0], drawn, LEAST_SPANS, strict=True):
        panel.set_ylim(*room(values, least=least))
    for panel in axes[:3, 0]:
        legend(panel)
    for panel in axes[:, 0]:
        panel.set_xlim(seconds[0], seconds[-1])
    label_outer(axes, ("time [s]",))
    return figure


def failures_figure(dataset: Any) -> Figure:
    """Least margins of all sets, by how many conductors are lost, a panel for each inclination."""
    inclinations = dataset["inclination_deg"].values
    figure, axes = panels(1, len(inclinations), height_in=3.0, column_gap=0.1)
    lost = dataset["lost_count"].values
    for panel, inclination in zip(axes[0], inclinations, strict=True):
        margin = np.maximum(dataset["least_margin"].sel(inclination_deg=inclination).values, DARK)
        spread = np.concatenate([np.linspace(-0.3, 0.3, count) for count in np.unique(lost, return_counts=True)[1]])
        panel.plot(lost + spread, margin, ".", color=AXIS_COLOURS[0], markersize=4.0)
        panel.axhline(1e-6, color=WARM, linewidth=0.8)
        panel.set_ylim(1e-18, 1.0)
        powers(panel)
        panel.tick_params(labelleft=panel is axes[0, 0])
        panel.set_xticks(np.unique(lost))
        panel.set_xlabel("conductors lost")
        panel.set_title(f"{inclination:g} deg")
    axes[0, 0].set_ylabel("least margin")
    return figure


def turning_figure(dataset: Any) -> Figure:
    """Growth of the instant's loop and the size of its gain over the time."""
    figure, axes = panels(2, 1, height_in=4.2, row_gap=0.3)
    hours = dataset["seconds"].values / HOUR_S
    line(axes[0, 0], hours, 1e3 * dataset["growth"].values, AXIS_COLOURS[0], width=1.2)
    axes[0, 0].axhline(0.0, color=INK, linewidth=0.6)
    axes[0, 0].set_ylabel("growth [1/ks]")
    share, verdict = 100.0 * float(dataset["unstable_share"]), float(dataset["log_multiplier"])
    axes[0, 0].set_title(f"{dataset.attrs['title']}, log of the multiplier {verdict:.1f}; growing {share:.0f} % of the time")
    line(axes[1, 0], hours, dataset["gain_norm"].values, AXIS_COLOURS[2], width=1.2)
    powers(axes[1, 0])
    axes[1, 0].set_ylabel("norm of the gain")
    for panel in axes[:, 0]:
        panel.set_xlim(hours[0], hours[-1])
    label_outer(axes, ("time [h]",))
    return figure


def field_figure(dataset: Any) -> Figure:
    """Up, along and across: the dipole and the model on each other."""
    figure, axes = panels(3, 1, height_in=5.4, row_gap=0.3)
    hours = dataset["seconds"].values / HOUR_S
    model = json.loads(dataset.attrs["settings_json"])["model"]
    for k, (panel, words) in enumerate(zip(axes[:, 0], ("up", "along", "across"), strict=True)):
        line(panel, hours, MICROTESLA * dataset["model_h"].values[:, k], AXIS_COLOURS[k], model, width=0.9)
        line(panel, hours, MICROTESLA * dataset["dipole_h"].values[:, k], GREY, "dipole", width=0.9)
        panel.set_ylabel(f"{words} [µT]")
        panel.set_xlim(hours[0], hours[-1])
        panel.axhline(0.0, color=INK, linewidth=0.5)
        legend(panel)
    axes[0, 0].set_title(dataset.attrs["title"])
    label_outer(axes, ("time [h]",))
    return figure


def lost_figure(dataset: Any) -> Figure:
    """The least of each part over the inclination."""
    figure, axes = panels(1, 1, height_in=3.2)
    panel, inclination = axes[0, 0], dataset["inclination_deg"].values
    for part, colour, words in (("in_plane", AXIS_COLOURS[0], "in the orbit's plane"), ("across", AXIS_COLOURS[2], "across it")):
        panel.plot(inclination, MICROTESLA * dataset[f"{part}_least"].values, color=colour, label=words, linewidth=1.5)
        dipole = MICROTESLA * dataset[f"{part}_least_dipole"].values
        panel.plot(inclination, dipole, color=colour, linewidth=1.0, linestyle=(0, (4, 2.5)), label=f"{words}, dipole")
    panel.set(xlabel="inclination [deg]", ylabel="least field [µT]")
    panel.set_title(dataset.attrs["title"])
    legend(panel)
    return figure


def transfer_figure(dataset: Any) -> Figure:
    """Height over time."""
    figure, axes = panels(1, 1, height_in=2.8)
    days = dataset["seconds"].values / DAY_S
    line(axes[0, 0], days, dataset["altitude_m"].values / 1e3, AXIS_COLOURS[0], width=1.4)
    axes[0, 0].set(xlabel="time [days]", ylabel="height [km]", xlim=(0.0, days[-1]))
    power = " to ".join(f"{watts / 1e3:.1f}" for watts in dataset["power_w"].values)
    length, thrust = float(dataset["length_m"]), float(dataset["thrust_n"])
    axes[0, 0].set_title(f"{dataset.attrs['title']}: {thrust:.3g} N, {length:.0f} m of conductor, {power} kW")
    return figure


OWN_FIGURES = {
    "afit_1992_vehicle": vehicle_figure,
    "afit_1992_model": model_figure,
    "afit_1992_controllability": controllability_figure,
    "afit_1992_failures": failures_figure,
    "afit_1992_lqr": lqr_figure,
    "afit_1992_turning_field": turning_figure,
    "afit_1992_field": field_figure,
    "afit_1992_lost_field": lost_figure,
    "afit_1992_transfer": transfer_figure,
}
