"""Figures 5, 6 and 7 of Polites (1991), NASA TP-3123, remade, and two it has not: `python docs/gallery/tp3123.py`.

Writes tp3123_fig05.png ... beside this file. Each is drawn from one `run` of the case.
"""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from PIL import Image

from fieldline.cases.tp3123 import run
from fieldline.estimation.skiprope import (
    group_delay_s,
    midpoint_position,
    tether_azimuth,
    tilt_azimuth,
    tune,
)
from fieldline.report.series import legend, line
from fieldline.report.theme import AXIS_COLOURS, FAINT, GREY, INK, WARM, label_outer, panels, themed, write_png
from fieldline.report.tp3123_figures import field_figure, filters_figure, magnetometer_figure, read_case

HERE = Path(__file__).parent
LENGTH_M = 20e3
GUESSES = (0.6, 0.8, 1.2, 1.5)


def save(figure, name):
    """A PNG of a palette, which is small."""
    drawn = io.BytesIO()
    write_png(figure, drawn)
    Image.open(drawn).convert("RGB").quantize(128).save(HERE / f"tp3123_{name}.png", optimize=True)


def plane_figure(case):
    """Where the tether's middle is, and the error of its plane by the paper's rule and with the filter's delay in it."""
    figure, axes = panels(1, 2, height_in=3.9, widths=(1.0, 1.9), column_gap=0.2)
    seconds, reading = case.seconds.values, read_case(case)
    late = read_case(case, azimuth_delay_s=float(group_delay_s(0.005, 0.005)))
    one_turn = (seconds >= 3000.0) & (seconds <= 3200.0)
    tilt, azimuth = case.cone_rad.values[one_turn], case.cone_azimuth_rad.values[one_turn]
    out = tilt * LENGTH_M / np.pi
    found = midpoint_position(reading, seconds[one_turn], LENGTH_M)
    left, right = axes[0]
    left.plot(out * np.sin(azimuth), -out * np.cos(azimuth), color=INK, lw=1.4, label="true")
    left.plot(*found.T, color=WARM, lw=1.4, label="read")
    for at in (0, 25):
        left.plot(
            [out[at] * np.sin(azimuth[at]), found[at, 0]], [-out[at] * np.cos(azimuth[at]), found[at, 1]], color=GREY, lw=0.8
        )
    left.set(
        xlabel="U, along the velocity [m]", ylabel="V, along the normal [m]", aspect="equal", xlim=(-100, 100), ylim=(-100, 100)
    )
    legend(left)
    settled = seconds >= 800.0
    for one, colour, label in ((reading, WARM, "azimuth now (paper)"), (late, AXIS_COLOURS[0], "azimuth 318 s ago")):
        error = tilt_azimuth(one, seconds).azimuth_rad - case.cone_azimuth_rad.values
        line(right, seconds[settled], np.degrees((error + np.pi) % (2 * np.pi) - np.pi)[settled], colour, label, width=0.9)
    std = np.degrees(tether_azimuth(reading, seconds).std_rad.mean())
    right.axhspan(-std, std, color=FAINT, alpha=0.6, linewidth=0, zorder=0)
    right.set(xlabel="time [s]", ylabel="error of the plane [deg]", xlim=(800, seconds[-1]))
    legend(right)
    save(figure, "plane")


def retuning_figure(case):
    """The third output from four wrong filters, and from the one that each leads to."""
    figure, axes = panels(2, 1, height_in=4.4, row_gap=0.28)
    seconds = case.seconds.values
    shown = (seconds >= 2000.0) & (seconds <= 3200.0)
    for guess, colour in zip(GUESSES, (*AXIS_COLOURS, WARM), strict=True):
        tuning = tune(seconds, case.corrected.values, guess * 0.005, settle_s=800.0)
        first = tune(seconds, case.corrected.values, guess * 0.005, settle_s=800.0, most_passes=1)
        for panel, filtered in zip(axes[:, 0], (first.filtered, tuning.filtered), strict=True):
            line(panel, seconds[shown], 1e3 * filtered[shown, 2], colour, f"{guess:g}", width=1.1)
    axes[0, 0].set_title("first pass, tuned to a guess of so many times the true frequency")
    axes[1, 0].set_title("second pass, tuned to the period of the first")
    legend(axes[0, 0])
    for panel in axes[:, 0]:
        panel.set(ylabel="C₃ [mrad]", xlim=(2000, 3200), ylim=(-15, 15))
    label_outer(axes, ("time [s]",))
    save(figure, "retuning")


def main():
    """All of them."""
    case = run()
    with themed():
        save(field_figure(case), "fig05")
        save(magnetometer_figure(case), "fig06")
        save(filters_figure(case), "fig07")
        plane_figure(case)
        retuning_figure(case)


if __name__ == "__main__":
    main()
