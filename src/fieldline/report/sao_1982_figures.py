"""Figures of the 1982 report's cases: stationary angles, their stability, and flights of a subsatellite on its tether."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fieldline.report.series import legend, line, room
from fieldline.report.theme import AXIS_COLOURS, FAINT, FOURTH, GREY, INK, label_outer, panels

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MICRORADIAN = 1e6
KIND_COLOURS = {"minimum": AXIS_COLOURS[0], "gyroscopic": AXIS_COLOURS[2], "flutter": AXIS_COLOURS[1], "divergence": FOURTH}
KIND_WORDS = {
    "minimum": "stable, a minimum",
    "gyroscopic": "stable by its spin",
    "flutter": "unstable",
    "divergence": "unstable, without swinging",
}


def stationary_figure(dataset: Any) -> Figure:
    """Angles over the spin, by their kind."""
    figure, axes = panels(1, 1, height_in=3.4)
    panel = axes[0, 0]
    draw_kinds(panel, dataset["spin"].values, np.degrees(dataset["theta"].values), dataset["kind"].values)
    panel.set(xscale="log", xlabel="spin [rad/s]", ylabel="tilt from the orbit normal [deg]", title=dataset.attrs["title"])
    panel.set(ylim=(0.0, 360.0), yticks=range(0, 361, 60), xlim=(dataset["spin"].values.min(), dataset["spin"].values.max()))
    decades(panel.xaxis)
    return figure


def decades(axis: Any) -> None:
    """Plain numbers on a logarithmic axis."""
    from matplotlib.ticker import FuncFormatter, NullFormatter

    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def draw_kinds(panel: Any, x: np.ndarray, angles: np.ndarray, kinds: np.ndarray) -> None:
    """Every solution (n, m) as a dot of its kind's colour."""
    for kind, colour in KIND_COLOURS.items():
        there = kinds == kind
        if there.any():
            where = np.broadcast_to(x[:, None], there.shape)[there]
            panel.plot(where, angles[there], ".", color=colour, markersize=3.0, markeredgewidth=0.0, label=KIND_WORDS[kind])
    legend(panel)


def stability_figure(dataset: Any) -> Figure:
    """Frequencies where it is stable, growth where it is not, and what the whole motion did."""
    degrees, n = np.degrees(dataset["theta"].values), dataset.attrs["orbital_rate_rad_s"]
    followed = "away" in dataset
    figure, axes = panels(3 if followed else 2, 1, height_in=6.0 if followed else 4.4, row_gap=0.26)
    for k, words in enumerate(("nutation", "slow turn")):
        for half in (degrees < 180.0, degrees > 180.0):  # between them the spin has no end
            label = words if half[0] else None
            line(axes[0, 0], degrees[half], dataset["frequency"].values[half, k] / n, AXIS_COLOURS[k], label, width=1.2)
    axes[0, 0].set(yscale="log", ylabel="frequency / n", title=dataset.attrs["title"])
    decades(axes[0, 0].yaxis)
    legend(axes[0, 0])
    line(axes[1, 0], degrees, dataset["growth"].values / n, INK)
    axes[1, 0].set_ylabel("growth / n")
    if followed:
        axes[2, 0].plot(degrees, dataset["away"].values, ".", color=INK, markersize=4.0)
        axes[2, 0].set(yscale="log", ylabel="farthest [rad]")
        decades(axes[2, 0].yaxis)
    for one in axes[:, 0]:
        _mark_unstable(one, dataset.attrs["critical_angle_deg"])
        one.set(xlim=(0.0, 360.0), xticks=range(0, 361, 45))
    label_outer(axes, ("tilt from the orbit normal [deg]",))
    return figure


def _mark_unstable(panel: Any, critical_deg: float) -> None:
    """A shade between the critical angle and its mirror."""
    if np.isfinite(critical_deg):
        panel.axvspan(critical_deg, 540.0 - critical_deg, color=FAINT, linewidth=0)


def chart_figure(dataset: Any) -> Figure:
    """Growth of the fastest unstable solution over spin and offset, with the critical spin."""
    figure, axes = panels(1, 1, height_in=4.2, right=0.93)
    panel, n = axes[0, 0], dataset.attrs["orbital_rate_rad_s"]
    growth = np.nanmax(dataset["growth"].values, axis=2) / n
    levels = (0.05, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 12.0)
    spin, offset = dataset["spin"].values, dataset["offset"].values
    filled = panel.contourf(spin, offset, growth.T, levels=levels, colors=_shades(len(levels)), extend="max")
    bar = figure.colorbar(filled, ax=panel, pad=0.015, fraction=0.035)
    bar.set_ticks(levels[1:])
    bar.ax.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    bar.set_label("growth of the inverted branch / n")
    line(panel, dataset["critical_spin"].values, offset, INK, "stable by its spin to the right", width=1.4)
    margin = dataset["margin"].values
    if margin.min() < 0.0 < margin.max():
        panel.contour(spin, offset, margin.T, levels=[0.0], colors=[FOURTH], linewidths=1.4)
        panel.plot([], [], color=FOURTH, label="four stationary angles to the lower left")
    panel.set(xscale="log", yscale="log", xlabel="spin [rad/s]", ylabel="offset [m]", title=dataset.attrs["title"])
    panel.set(xlim=(spin.min(), spin.max()), ylim=(offset.min(), offset.max()))
    decades(panel.xaxis)
    decades(panel.yaxis)
    legend(panel)
    return figure


def _shades(count: int) -> list:
    """From pale to deep."""
    pale, deep = np.array([0.99, 0.90, 0.82]), np.array([0.62, 0.22, 0.02])
    return [tuple(pale + (deep - pale) * k / max(count - 1, 1)) for k in range(count)]


def spin_figure(dataset: Any) -> Figure:
    """How far tilt and node are from where they began, the spin, the tension."""
    figure, axes = panels(4, 1, height_in=6.6, row_gap=0.3)
    seconds = dataset["seconds"].values
    for panel, name, words in zip(axes[:2, 0], ("theta_orbital", "psi_orbital"), ("tilt", "node"), strict=True):
        angle = np.unwrap(dataset[name].values)
        shift = MICRORADIAN * (angle - angle[0])
        small = np.abs(shift).max() < 1e3
        line(panel, seconds, shift if small else np.degrees(angle), INK, width=1.2)
        panel.set_ylabel(f"{words}, change\n[µrad]" if small else f"{words} [deg]")
        panel.set_ylim(room(shift if small else np.degrees(angle)))
    axes[0, 0].set_title(dataset.attrs["title"])
    _turning(axes[2, 0], seconds, dataset["phi"].values)
    _tension(axes[3, 0], dataset)
    return _finished(figure, axes, seconds)


def thruster_figure(dataset: Any) -> Figure:
    """The three Euler angles as the report plots them, and the tension."""
    figure, axes = panels(4, 1, height_in=6.8, row_gap=0.3)
    seconds = dataset["seconds"].values
    line(axes[0, 0], seconds, np.degrees(dataset["theta"].values), INK, width=1.2)
    axes[0, 0].set_title(dataset.attrs["title"])
    axes[0, 0].set_ylabel("tilt [deg]")
    for name, colour, words in (("psi", AXIS_COLOURS[0], "inertial axes"), ("psi_orbital", AXIS_COLOURS[1], "orbital axes")):
        line(axes[1, 0], seconds, np.degrees(np.unwrap(dataset[name].values)), colour, words, width=1.2)
    axes[1, 0].set_ylabel("node [deg]")
    legend(axes[1, 0])
    _turning(axes[2, 0], seconds, dataset["phi"].values)
    _tension(axes[3, 0], dataset)
    return _finished(figure, axes, seconds)


def annex_figure(dataset: Any) -> Figure:
    """The lever in and out of the plane, the tension, the attachment's way."""
    figure, axes = panels(3, 1, height_in=5.6, row_gap=0.3)
    seconds = dataset["seconds"].values
    lever = np.degrees(np.arcsin(np.clip(dataset["lever_o"].values, -1.0, 1.0)))
    for k, words in ((1, "in the plane"), (2, "out of it")):
        line(axes[0, 0], seconds, lever[:, k], AXIS_COLOURS[k - 1], words, width=1.2)
    axes[0, 0].set_title(dataset.attrs["title"])
    axes[0, 0].set_ylabel("lever [deg]")
    legend(axes[0, 0])
    _tension(axes[1, 0], dataset)
    for name, colour in (("along", AXIS_COLOURS[0]), ("across", AXIS_COLOURS[1])):
        line(axes[2, 0], seconds, 100.0 * dataset[name].values, colour, name, width=1.2)
    axes[2, 0].set_ylabel("attachment [cm]")
    legend(axes[2, 0])
    return _finished(figure, axes, seconds)


def _turning(panel: Any, seconds: np.ndarray, angle: np.ndarray) -> None:
    """An angle within half a turn, with a pause at each jump."""
    degrees = np.degrees(angle)
    degrees = np.where(np.append(np.abs(np.diff(degrees)) > 180.0, False), np.nan, degrees)
    panel.plot(seconds, degrees, color=INK, linewidth=1.2)
    panel.set(ylabel="spin angle [deg]", ylim=(-185.0, 185.0), yticks=range(-180, 181, 90))


def _tension(panel: Any, dataset: Any) -> None:
    """Elastic tension, and its value at rest."""
    tension = dataset["tension"].values
    panel.axhline(dataset.attrs["tension_n"], color=GREY, linewidth=0.8)
    line(panel, dataset["seconds"].values, tension, INK, width=1.2)
    panel.set(ylabel="tension [N]", ylim=room(np.append(tension, dataset.attrs["tension_n"]), least=0.02))


def _finished(figure: Figure, axes: Any, seconds: np.ndarray) -> Figure:
    """One time axis under all panels."""
    for one in axes[:, 0]:
        one.set_xlim(seconds[0], seconds[-1])
    label_outer(axes, ("time [s]",))
    return figure


OWN_FIGURES = {
    "sao_1982_stationary": stationary_figure,
    "sao_1982_stability": stability_figure,
    "sao_1982_stability_chart": chart_figure,
    "sao_1982_spin": spin_figure,
    "sao_1982_thruster": thruster_figure,
    "sao_1982_annex": annex_figure,
}
