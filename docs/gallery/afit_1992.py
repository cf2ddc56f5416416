"""Figures of Lawrence (1992), remade: `python docs/gallery/afit_1992.py`.

Writes afit_1992_field.png and others beside this file: appendix A, what the thesis asks of it, chapter 4, appendix E.
"""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from PIL import Image

from fieldline.cases.afit_1992 import (
    controllability,
    docking_standards,
    field,
    flown,
    linear_range,
    lost_field,
    lqr,
    orbit_change,
    turning_field,
    vehicle,
)
from fieldline.cases.afit_1992.field_in_orbit import INCLINATIONS_DEG
from fieldline.errors import NoEstimateError
from fieldline.report.afit_1992_figures import MICROTESLA, lost_figure, lqr_figure, powers, vehicle_figure
from fieldline.report.case_figure import case_figure
from fieldline.report.series import legend, line
from fieldline.report.theme import AXIS_COLOURS, GREY, INK, label_outer, panels, themed, write_png

HERE = Path(__file__).parent
SMALL = 1e-17


def save(figure, name):
    """A PNG of a palette, which is small."""
    drawn = io.BytesIO()
    write_png(figure, drawn)
    Image.open(drawn).convert("RGB").quantize(200).save(HERE / f"afit_1992_{name}.png", optimize=True)


def appendix_a():
    """Seven inclinations over two sidereal days: the field in the plane and across it."""
    figure, axes = panels(len(INCLINATIONS_DEG), 2, height_in=11.5, row_gap=0.32, column_gap=0.12)
    for row, inclination in zip(axes, INCLINATIONS_DEG, strict=True):
        days = field(inclination)
        hours = days["seconds"].values / 3600.0
        for panel, in_plane in zip(row, (True, False), strict=True):
            for name, colour in (("model", AXIS_COLOURS[0] if in_plane else AXIS_COLOURS[2]), ("dipole", GREY)):
                values = days[f"{name}_in_plane"].values if in_plane else days[f"{name}_h"].values[:, 2]
                line(panel, hours, MICROTESLA * values, colour, "IGRF-14" if name == "model" else "dipole", width=0.9)
            panel.set(xlim=(0.0, hours[-1]), ylim=(0.0, 62.0) if in_plane else (-14.0, 36.0))
            panel.axhline(0.0, color=INK, linewidth=0.6)
        row[0].set_title(f"{inclination:g} deg: in the orbit's plane [µT]")
        row[1].set_title(f"{inclination:g} deg: across it [µT]")
    for panel in axes[0]:
        legend(panel)
    label_outer(axes, ("time [h]", "time [h]"))
    save(figure, "field")


def lost():
    """The least of each part against the inclination, dipole and IGRF-14."""
    save(lost_figure(lost_field(np.arange(0.0, 90.5, 1.0), step_deg=3.0)), "lost_field")


def margins():
    """Design 1, design 2, and design 2 with thruster around an equatorial orbit; and the sets of three and four that fail."""
    figure, axes = panels(2, 1, height_in=5.4, row_gap=0.42)
    runs = {
        "design 1, l = 310, 50, 50 m": {"design": 1, "thruster": False, "vertical_m": 310.0, "horizontal_m": 50.0},
        "design 1, l = 50, 310, 50 m": {"design": 1, "thruster": False},
        "design 2": {"thruster": False},
        "design 2, thruster": {},
    }
    for colour, (words, given) in zip((AXIS_COLOURS[1], GREY, AXIS_COLOURS[0], AXIS_COLOURS[2]), runs.items(), strict=True):
        found = controllability(0.0, step_deg=2.5, **given)
        margin = np.maximum(found["margin"].values, SMALL)
        line(axes[0, 0], found["field_angle_deg"].values, margin, colour, words, width=1.4)
    axes[0, 0].set(xlabel="angle of the field u - θg - λ [deg]", ylabel="margin", xlim=(0.0, 357.5))
    legend(axes[0, 0])
    for count, colour in ((1, AXIS_COLOURS[2]), (2, GREY), (3, AXIS_COLOURS[0]), (4, AXIS_COLOURS[1])):
        found = controllability(0.0, thruster=False, step_deg=15.0, lost=count)
        margin = np.sort(np.maximum(found["subset_margin"].values, SMALL))
        axes[1, 0].plot(np.arange(1, len(margin) + 1), margin, ".", color=colour, label=f"{count} lost", markersize=5.0)
    axes[1, 0].set(xlabel="set of lost conductors, the worst first (design 2, no thruster)", ylabel="least margin")
    legend(axes[1, 0])
    for panel in axes[:, 0]:
        powers(panel)
        panel.axhline(1e-6, color=INK, linewidth=0.6)
    save(figure, "margins")


def stepping():
    """The largest current of a V-BAR against the number of steps of its command."""
    figure, axes = panels(1, 1, height_in=2.8)
    steps = (1, 2, 3, 5, 8, 12, 20)
    for every, colour in ((500.0, AXIS_COLOURS[1]), (1000.0, AXIS_COLOURS[2]), (2000.0, AXIS_COLOURS[0])):
        peaks = [float(lqr("v-bar", steps=k, step_every_s=every, duration_s=every * k + 6000.0)["peak_current_a"]) for k in steps]
        axes[0, 0].plot(steps, peaks, ".-", color=colour, label=f"a step every {every:g} s", markersize=5.0)
    axes[0, 0].axhline(125.0, color=INK, linewidth=0.7)
    axes[0, 0].set(xlabel="steps from 100 to 50 m", ylabel="largest current [A]", xscale="log", yscale="log")
    axes[0, 0].set_xticks(steps, [str(k) for k in steps])
    axes[0, 0].set_yticks((10, 25, 50, 125, 250), ("10", "25", "50", "125", "250"))
    axes[0, 0].minorticks_off()
    legend(axes[0, 0])
    save(figure, "stepping")


def inclined():
    """Multipliers over a day against the inclination: frozen gains, each instant's, and those that know how the field turns."""
    figure, axes = panels(2, 1, height_in=5.6, row_gap=0.42)
    cases = list(zip(("standoff", "r-bar", "v-bar"), AXIS_COLOURS, strict=True))
    low, high = np.append(1e-3, np.arange(3.0, 61.0, 3.0)), np.append(1e-3, np.arange(6.0, 91.0, 6.0))
    for case, colour in cases:
        found = [log_multiplier(case, "frozen", i, 30.0) for i in low]
        axes[0, 0].plot(low, found, ".-", color=colour, label=case, markersize=4.0)
        found = [log_multiplier(case, "periodic", i, 60.0) for i in high]
        axes[1, 0].plot(high, found, ".-", color=colour, markersize=4.0)
        found = [log_multiplier(case, "scheduled", i, 60.0) for i in high]
        axes[1, 0].plot(high, found, "o", color=colour, markersize=7.0, fillstyle="none")
    axes[0, 0].set(title="frozen gains", ylim=(-100.0, 150.0), xlim=(0.0, 60.0))
    axes[1, 0].set(title="gains over the day; rings: each instant's own", ylim=(-100.0, 40.0), xlim=(0.0, 90.0))
    for panel in axes[:, 0]:
        panel.axhline(0.0, color=INK, linewidth=0.7)
        panel.set(xlabel="inclination [deg]", ylabel="log of the multiplier, a day")
    legend(axes[0, 0])
    save(figure, "turning_field")


def log_multiplier(case, controller, inclination, step_s):
    """Over a day; NaN where there is no such gain."""
    try:
        return float(turning_field(case, controller, inclination, step_s=step_s)["log_multiplier"])
    except NoEstimateError:
        return np.nan


if __name__ == "__main__":
    with themed():
        appendix_a()
        lost()
        margins()
        save(vehicle_figure(vehicle()), "vehicle")
        for case in ("standoff", "r-bar", "v-bar", "z-bar"):
            save(lqr_figure(lqr(case)), case.replace("-", "_"))
        stepping()
        inclined()
    for name, found in (
        ("flown", flown("standoff", "frozen", 28.5, duration_s=22_000.0)),
        ("linear_range", linear_range()),
        ("docking", docking_standards(100)),
        ("orbit_change", orbit_change(days=2.0, flown_days=2.0)),
    ):
        save(case_figure(found), name)
