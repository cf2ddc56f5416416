"""Figures of White, Shigemoto and Bourquin (1961), remade: `python docs/gallery/ames_1961.py`.

Writes ames_1961_fig01.png ... beside this file: figures 1, 2, 4 and 5 of the study, then what it has no figure of.
"""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from matplotlib.patches import Circle, FancyArrowPatch, Rectangle
from PIL import Image

from fieldline.cases.ames_1961 import coil, dump, field, observatory, pointing
from fieldline.report.ames_1961_figures import draw_components, own_figure
from fieldline.report.series import legend, line
from fieldline.report.theme import AXIS_COLOURS, FAINT, INK, label_outer, panels, themed, write_png

HERE = Path(__file__).parent
INCLINATIONS = {"(a)": 0.0, "(b)": 35.0, "(c)": 60.0, "(d)": 90.0}  # assumed: the study's captions are lost
RESPONSES = {
    "(a) Bx/B = 0.05, By = Bz, from 6 and 0 arcsec, sensor to 1.2 arcsec": {},
    "(b) Bx/B = 0.05, By = 0, from 6 and 6 arcsec, sensor to 1.2 arcsec": {"transverse": "y-zero", "error_arcsec": (6.0, 6.0)},
    "(c) Bx/B = 0.01, By = Bz, from 6 and 0 arcsec, sensor to 3 arcsec": {"field_ratio": 0.01, "sensor_limit_arcsec": 3.0},
    "(d) Bx/B = 0, as (c), with 100 dyne cm about z: divergent": {
        "field_ratio": 0.0,
        "sensor_limit_arcsec": 3.0,
        "disturbance_n_m": (0.0, 0.0, 1e-5),
    },
}


def save(figure, name):
    """A PNG of a palette, which is small."""
    drawn = io.BytesIO()
    write_png(figure, drawn)
    Image.open(drawn).convert("RGB").quantize(200).save(HERE / f"ames_1961_{name}.png", optimize=True)


def figure_1():
    """One orbit at 35 degrees."""
    orbit = field(35.0, duration_s=6050.0)
    figure, axes = panels(1, 1, height_in=3.3)
    panel, time = axes[0, 0], orbit["seconds"].values
    draw_components(panel, time, orbit["normalised_s"].values)
    line(panel, time, orbit["magnitude"].values / orbit.attrs["polar_field_tesla"], INK, "magnitude")
    panel.set(xlabel="time [s]", ylabel="over the polar field", xlim=(0.0, time[-1]))
    legend(panel)
    save(figure, "fig01")


def figure_2():
    """A day at four inclinations."""
    figure, axes = panels(4, 1, height_in=8.2, row_gap=0.34)
    for panel, (letter, inclination) in zip(axes[:, 0], INCLINATIONS.items(), strict=True):
        day = field(inclination)
        draw_components(panel, day["seconds"].values / 3600.0, day["normalised_s"].values)
        panel.set_title(f"{letter} inclination {inclination:g} deg: magnitude within 1 to {day.attrs['magnitude_ratio']:.3f}")
        panel.set(xlim=(0.0, 24.0), ylim=(-1.05, 1.05))
    legend(axes[0, 0])
    axes[1, 0].set_ylabel("components over the polar field")
    label_outer(axes, ("time [h]",))
    save(figure, "fig02")


def figure_4():
    """The loop of one axis."""
    figure, axes = panels(1, 1, height_in=2.6, right=0.99)
    panel = axes[0, 0]
    panel.set(xlim=(0.0, 11.4), ylim=(-1.55, 1.15))
    panel.axis("off")
    boxes = [
        (1.1, "sensor\nK, limited"),
        (3.1, "gain, rate\nK₁ + K₂ s"),
        (5.1, "coils (8), (10)\nM, limited"),
        (7.1, "field\nM × B"),
    ]
    for x, words in [*boxes, (9.3, "vehicle\n1 / (J s²)")]:
        panel.add_patch(Rectangle((x, -0.35), 1.5, 0.7, facecolor="none", edgecolor=INK, linewidth=1.0))
        panel.text(x + 0.75, 0.0, words, ha="center", va="center", fontsize=8.5)
    ends = [(0.0, 0.32), (0.6, 1.1), (2.6, 3.1), (4.6, 5.1), (6.6, 7.1), (8.6, 8.8), (9.04, 9.3), (10.8, 11.4)]
    for start, end in ends:
        panel.add_patch(
            FancyArrowPatch((start, 0.0), (end, 0.0), arrowstyle="-|>", mutation_scale=9, color=INK, shrinkA=0, shrinkB=0)
        )
    for x in (0.46, 8.92):
        panel.add_patch(Circle((x, 0.0), 0.13, facecolor="none", edgecolor=INK))
    panel.add_patch(
        FancyArrowPatch((8.92, 0.9), (8.92, 0.14), arrowstyle="-|>", mutation_scale=9, color=INK, shrinkA=0, shrinkB=0)
    )
    panel.plot([11.1, 11.1, 0.46], [0.0, -1.0, -1.0], color=INK)
    panel.add_patch(
        FancyArrowPatch((0.46, -1.0), (0.46, -0.14), arrowstyle="-|>", mutation_scale=9, color=INK, shrinkA=0, shrinkB=0)
    )
    panel.text(8.92, 0.98, "disturbance", ha="center", va="bottom", fontsize=8.5)
    panel.text(0.03, 0.12, "star", fontsize=8.5)
    panel.text(0.66, 0.12, "A", fontsize=8.5)
    panel.text(0.2, -0.33, "−", fontsize=11)
    panel.text(5.8, -0.93, "tracking line", ha="center", va="bottom", fontsize=8.5)
    panel.text(
        5.7,
        -1.42,
        "line / star = (K K₁ + K K₂ s) / (J s² + K K₂ s + K K₁),   ωn² = K K₁ / J,   2 ζ ωn = K K₂ / J",
        ha="center",
        fontsize=9,
    )
    save(figure, "fig04")


def figure_5():
    """The sensor's output in four fields."""
    figure, axes = panels(4, 1, height_in=8.2, row_gap=0.34)
    for panel, (title, settings) in zip(axes[:, 0], RESPONSES.items(), strict=True):
        run = pointing(duration_s=240.0, **settings)
        for k, name in enumerate("yz"):
            line(panel, run["seconds"].values, run["sensor"].values[:, k], AXIS_COLOURS[k + 1], name, width=1.4)
        limit = settings.get("sensor_limit_arcsec", 1.2)
        panel.axhspan(-0.1, 0.1, color=FAINT, linewidth=0)
        panel.set_title(title)
        panel.set(xlim=(0.0, 240.0), ylim=(-1.12 * limit, 1.12 * limit))
    legend(axes[0, 0])
    axes[1, 0].set_ylabel("sensor output [arcsec]")
    label_outer(axes, ("time [s]",))
    save(figure, "fig05")


def figure_observatory():
    """Three coils and two over the same day: errors, and the field along the line."""
    figure, axes = panels(3, 1, height_in=5.8, row_gap=0.34)
    for panel, coils in zip(axes[:2, 0], (3, 2), strict=True):
        day = observatory(coils)
        hours = day["seconds"].values / 3600.0
        panel.axhspan(-0.1, 0.1, color=FAINT, linewidth=0)
        for k, name in enumerate("yz"):
            line(panel, hours, day["error"].values[:, k], AXIS_COLOURS[k + 1], name)
        share = 100.0 * float(day["within_fraction"])
        panel.set_title(f"{coils} coils: {share:.2f} % of the day within 0.1 arcsec, {day.sizes['loss']} losses")
        panel.set(ylabel="error [arcsec]", ylim=(-0.55, 0.55), xlim=(0.0, 24.0))
        legend(panel)
    along = day["along_line"].values
    line(axes[2, 0], hours, along, INK)
    axes[2, 0].axhspan(-0.05, 0.05, color=FAINT, linewidth=0)
    axes[2, 0].set(ylabel="field along line / B", xlim=(0.0, 24.0))
    label_outer(axes, ("time [h]",))
    save(figure, "observatory")


def figure_loss():
    """One loss of the field, closely: when B_x passes zero slowly."""
    days = {coils: observatory(coils) for coils in (3, 2)}
    worst = int(np.argmax(days[2]["loss_error_arcsec"].values))
    middle = float(days[2]["loss_start_s"][worst])
    figure, axes = panels(3, 1, height_in=5.6, row_gap=0.34)
    for panel, coils in zip(axes[:2, 0], (3, 2), strict=True):
        part = days[coils].sel(seconds=slice(middle - 150.0, middle + 250.0))
        for k, name in enumerate("yz"):
            line(panel, part["seconds"].values - middle, part["error"].values[:, k], AXIS_COLOURS[k + 1], name, width=1.3)
        panel.axhspan(-0.1, 0.1, color=FAINT, linewidth=0)
        panel.set(ylabel="error [arcsec]", title=f"{coils} coils", xlim=(-150.0, 250.0), ylim=(-0.55, 0.15))
        legend(panel)
    line(axes[2, 0], part["seconds"].values - middle, part["along_line"].values, INK, width=1.3)
    axes[2, 0].set(ylabel="field along line / B", xlim=(-150.0, 250.0))
    label_outer(axes, ("time [s]",))
    save(figure, "loss")


def main():
    """All of them."""
    with themed():
        figure_1()
        figure_2()
        figure_4()
        figure_5()
        figure_observatory()
        figure_loss()
    save(own_figure(dump()), "dump")
    save(own_figure(coil()), "coil")


if __name__ == "__main__":
    main()
