"""Figures of the Smithsonian's report of 1982, remade: `python docs/gallery/sao_1982.py`.

Writes sao_1982_stationary.png ... beside this file: figures 2-3, 3-2 and 3-4 of the report, and what it has no figure of.
"""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from PIL import Image

from fieldline.cases.sao_1982 import PRINTED_SPIN_RAD_S, annex_run, spin, stability, stability_chart, stationary, thruster
from fieldline.cases.sao_1982.printed_tables import FIGURE_3_2A, FIGURE_3_4C, REPAIRED
from fieldline.report.sao_1982_figures import chart_figure, decades, draw_kinds, stability_figure
from fieldline.report.series import legend, line
from fieldline.report.theme import AXIS_COLOURS, INK, WARM, label_outer, panels, themed, write_png

HERE = Path(__file__).parent
MICRO = 1e6


def save(figure, name):
    """A PNG of a palette, which is small."""
    drawn = io.BytesIO()
    write_png(figure, drawn)
    Image.open(drawn).convert("RGB").quantize(200).save(HERE / f"sao_1982_{name}.png", optimize=True)


def figure_stationary():
    """Angles over the spin: the report's body, and one whose offset is a millimetre."""
    figure, axes = panels(2, 1, height_in=5.6, row_gap=0.24)
    spins = np.geomspace(1e-4, 0.2, 400)
    for panel, offset, words in zip(axes[:, 0], (0.5, 1e-3), ("0.5 m from the centre of mass", "1 mm from it"), strict=True):
        found = stationary(spins, offset_m=offset)
        draw_kinds(panel, spins, np.degrees(found["theta"].values), found["kind"].values)
        panel.set(xscale="log", xlim=(1e-4, 0.2), ylim=(0.0, 360.0), yticks=range(0, 361, 90), ylabel="tilt [deg]")
        panel.set_title(f"Attached {words}")
        decades(panel.xaxis)
    axes[0, 0].get_legend().remove()
    label_outer(axes, ("spin against the node [rad/s]",))
    save(figure, "stationary")


def figure_spin():
    """Figure 3-2: the printed tilt, three ways to place the body, the node and the spin angle."""
    figure, axes = panels(3, 1, height_in=6.0, row_gap=0.28)
    printed = np.array(list(FIGURE_3_2A.items()))
    axes[0, 0].plot(printed[:, 0], MICRO * (printed[:, 1] - np.radians(20.0)), "o", color=WARM, markersize=3.5, label="printed")
    for colour, name in zip(AXIS_COLOURS, ("centre", "attachment", "attachment-rigid"), strict=True):
        run = spin(spin_rad_s=PRINTED_SPIN_RAD_S, placement=name, output_step_s=2.0)
        seconds = run["seconds"].values
        line(axes[0, 0], seconds, MICRO * (run["theta"].values - np.radians(20.0)), colour, name, width=1.2)
        line(axes[1, 0], seconds, MICRO * (run["psi_orbital"].values - 0.5 * np.pi), colour, width=1.2)
    axes[0, 0].set(title="(a) tilt less 20 deg", ylabel="[µrad]")
    legend(axes[0, 0])
    axes[1, 0].set(title="(b) node in the turning axes, less 90 deg", ylabel="[µrad]")
    line(axes[2, 0], seconds, np.degrees(np.unwrap(run["phi"].values)), INK, width=1.2)
    axes[2, 0].set(title="(c) spin angle, without its jumps", ylabel="[deg]")
    for one in axes[:, 0]:
        one.set_xlim(0.0, 302.0)
    label_outer(axes, ("time [s]",))
    save(figure, "fig32")


def figure_thruster():
    """Figure 3-4: the three angles, and what is between the printed spin angle and ours."""
    figure, axes = panels(4, 1, height_in=7.6, row_gap=0.3)
    run = thruster(output_step_s=0.5)
    seconds, phi = run["seconds"].values, run["phi"].values
    line(axes[0, 0], seconds, np.degrees(run["theta"].values), INK, width=1.2)
    axes[0, 0].set(title="(a) tilt", ylabel="[deg]")
    for name, colour, words in (("psi", AXIS_COLOURS[0], "inertial axes"), ("psi_orbital", AXIS_COLOURS[1], "turning axes")):
        line(axes[1, 0], seconds, np.degrees(run[name].values), colour, words, width=1.2)
    axes[1, 0].set(title="(b) node", ylabel="[deg]")
    legend(axes[1, 0])
    jumps = np.append(np.abs(np.diff(phi)) > np.pi, False)
    axes[2, 0].plot(seconds, np.where(jumps, np.nan, np.degrees(phi)), color=INK, linewidth=1.2)
    times = np.arange(0.0, 501.0, 10.0)
    repaired = np.isin(times, REPAIRED)
    printed = np.array(FIGURE_3_4C)
    error = MICRO * (printed - run["phi"].sel(seconds=times).values)
    for there, colour, words in ((~repaired, WARM, "printed"), (repaired, AXIS_COLOURS[2], "printed, a digit repaired")):
        axes[2, 0].plot(times[there], np.degrees(printed[there]), "o", color=colour, markersize=3.5, label=words)
        axes[3, 0].plot(times[there], error[there], "o", color=colour, markersize=3.5)
    axes[2, 0].set(title="(c) spin angle", ylabel="[deg]", yticks=range(-180, 181, 90))
    legend(axes[2, 0])
    axes[3, 0].set(title="printed less computed spin angle", ylabel="[µrad]", ylim=(-1.6, 0.4))
    for one in axes[:, 0]:
        one.set_xlim(0.0, 503.0)
    label_outer(axes, ("time [s]",))
    save(figure, "fig34")


def figure_annex():
    """The annex's tests: where the lever goes, and the tension."""
    names = {
        "in-plane": "20 deg in the plane, both dampings",
        "in-plane-linear": "the same, joint free",
        "diagonal": "20 deg diagonally, both dampings",
        "diagonal-undamped": "the same, no damping",
        "diagonal-rates": "with rates, both dampings",
    }
    figure, axes = panels(len(names), 2, height_in=9.6, widths=(1.0, 2.6), row_gap=0.38, column_gap=0.13)
    for row, (name, words) in zip(axes, names.items(), strict=True):
        run = annex_run(name, output_step_s=0.1, duration_s=60.0)
        lever = np.degrees(np.arcsin(run["lever_o"].values))
        row[0].plot(lever[:, 1], lever[:, 2], color=INK, linewidth=0.9)
        row[0].set(
            xlim=(-30.0, 30.0),
            ylim=(-30.0, 30.0),
            xticks=(-20, 0, 20),
            yticks=(-20, 0, 20),
            ylabel="out [deg]",
            aspect="equal",
            anchor="W",
        )
        line(row[1], run["seconds"].values, run["tension"].values, INK, width=1.1)
        row[1].set(title=words, ylabel="tension [N]", xlim=(0.0, 60.0))
    label_outer(axes, ("in the plane [deg]", "time [s]"))
    axes[0, 0].set_title("lever from the line")
    save(figure, "annex")


with themed():
    figure_stationary()
    save(stability_figure(stability(orbits=20.0)), "stability")
    save(chart_figure(stability_chart()), "chart")
    figure_spin()
    figure_thruster()
    figure_annex()
