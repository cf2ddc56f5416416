"""Figures 2 to 12 of Natanson, McLaughlin and Nicklas (1990), remade: `python docs/gallery/natanson_1990.py`.

Writes natanson_1990_fig02.png ... beside this file. Each figure is one function of one `run` of the case.
"""

from __future__ import annotations

import io
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import NullFormatter
from PIL import Image

from fieldline.cases.natanson_1990 import run

HERE = Path(__file__).parent
TRUE, FIRST, SECOND, FAINT = "#222222", "#0072b2", "#d55e00", "#9a9a9a"  # colours that the colour-blind tell apart
AXIS_COLOURS = ("#0072b2", "#d55e00", "#009e73")
ROOTS = ("the true root", "the false root")
TOUCHING = {"attitude": "random", "seed": 29, "ascending_node_deg": 293.0, "argument_deg": 59.0}  # discriminant meets zero
USUAL = {"attitude": "random", "seed": 51, "ascending_node_deg": 267.0, "argument_deg": 141.0}  # 5.7 deg at 120 s


def canvas(rows=1, height=3.4):
    """A figure with `rows` panels over one time axis."""
    figure, panels = plt.subplots(rows, 1, figsize=(7.6, height), sharex=True, squeeze=False, constrained_layout=True)
    for panel in panels[:, 0]:
        panel.grid(alpha=0.25, linewidth=0.6)
        panel.spines[["top", "right"]].set_visible(False)
        panel.set_xlim(0.0, 3552.0)
    panels[-1, 0].set_xlabel("time [s]")
    return figure, panels[:, 0]


def unwrapped(true_deg, found_deg=None):
    """True angles without jumps, or found ones beside them: no line crosses the figure."""
    true = np.degrees(np.unwrap(np.radians(true_deg)))
    return true if found_deg is None else true + (np.asarray(found_deg) - true + 180.0) % 360.0 - 180.0


def bounded(panel, true_deg, margin=60.0):
    """Room for the true curve and errors of `margin`; wilder ones leave the panel."""
    panel.set_ylim(np.min(true_deg) - margin, np.max(true_deg) + margin)


def finish(figure, number):
    """Save as a PNG of few colours, which is small."""
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=110)
    plt.close(figure)
    Image.open(drawn).convert("RGB").quantize(64).save(HERE / f"natanson_1990_fig{number:02d}.png", optimize=True)


def by_truth(values, arc):
    """The two roots' (n, 2) values in the order true, false; NaN where there is no root."""
    true = arc.chosen_nearest.values
    order = np.stack([true, 1 - true], axis=1).clip(0, 1)
    return np.where(true[:, None] < 0, np.nan, np.take_along_axis(np.asarray(values), order, axis=1)).T


def figure_2(arc):
    """Both roots."""
    figure, (panel,) = canvas()
    angles = by_truth((np.degrees(arc.angle_root) + 90.0) % 360.0 - 90.0, arc)
    for angle, label, colour in zip(angles, ROOTS, (FIRST, SECOND), strict=True):
        panel.plot(arc.seconds, angle, ".", ms=2.5, color=colour, label=label)
    shade(panel, arc)
    panel.set(ylabel="Φ on the circle [deg]", ylim=(-90, 270), yticks=np.arange(-90, 271, 90))
    panel.legend(frameon=False, ncols=3, loc="lower left", bbox_to_anchor=(0, 1.0), markerscale=3)
    finish(figure, 2)


def shade(panel, arc):
    """Grey where the discriminant is negative."""
    seconds, negative = arc.seconds.values, arc.status.values == 1
    if negative.any():
        panel.fill_between(
            seconds,
            0,
            1,
            where=negative,
            transform=panel.get_xaxis_transform(),
            color=FAINT,
            alpha=0.5,
            lw=2,
            label="no real root",
        )


def figure_3(arc):
    """The discriminant."""
    figure, (panel,) = canvas()
    panel.axhline(0.0, color=TRUE, lw=0.8)
    panel.plot(arc.seconds, arc.discriminant, color=FIRST, lw=1.4)
    shade(panel, arc)
    panel.set(ylabel="discriminant / (Q² + R²)")
    finish(figure, 3)


def figure_4(arc):
    """The paper's loss and the longer one, for both roots."""
    figure, panels = canvas(2, 5.0)
    true = arc.chosen_nearest.values
    for panel, name, words in zip(
        panels, ("paper", "robust"), ("one step to each side", "three steps to each side"), strict=True
    ):
        losses = by_truth(1e9 * arc[f"loss_{name}"], arc)
        for loss, label, colour in zip(losses, ROOTS, (FIRST, SECOND), strict=True):
            panel.semilogy(arc.seconds, loss, color=colour, lw=1.2, label=label)
        chosen = arc[f"chosen_{name}"].values
        share = 100 * np.mean((chosen == true)[(true >= 0) & (chosen >= 0)])
        panel.set_title(f"{words}: right in {share:.0f} %", fontsize=9, loc="left")
        panel.set_ylabel("loss [nT/s]")
        panel.yaxis.set_minor_formatter(NullFormatter())
    panels[0].legend(frameon=False, ncols=2, fontsize=8, loc="lower right", bbox_to_anchor=(1.0, 1.0))
    finish(figure, 4)


def euler_panels(arc, label, number):
    """Euler angles, estimated against true."""
    figure, panels = canvas(3, 5.4)
    for k, panel in enumerate(panels):
        true = unwrapped(arc.euler_true[:, k])
        panel.plot(arc.seconds, unwrapped(arc.euler_true[:, k], arc.euler[:, k]), ".", ms=3, color=SECOND, label=label)
        panel.plot(arc.seconds, true, color=TRUE, lw=1.0, label="true")
        bounded(panel, true, 60.0 if number == 10 else 5.0)
        panel.set_ylabel(f"angle {k + 1} [deg]")
    panels[0].legend(frameon=False, ncols=2, loc="lower left", bbox_to_anchor=(0, 1.0), markerscale=3)
    finish(figure, number)


def figure_6(arc):
    """The oscillating rates."""
    figure, (panel,) = canvas()
    for k, colour in enumerate(AXIS_COLOURS):
        rate = np.degrees(arc.omega_bi_b_true[:, k])
        panel.plot(arc.seconds, rate, color=colour, lw=0.7, label=f"ω{'xyz'[k]}")
        panel.axhline(float(rate.mean()), color=colour, lw=1.0, ls="-.")
    panel.set(ylabel="body rate [deg/s]", xlim=(0, 1200))
    panel.legend(frameon=False, ncols=3, loc="lower left", bbox_to_anchor=(0, 1.0))
    finish(figure, 6)


def figure_7(oscillating, steady):
    """What the oscillation does to the attitude."""
    figure, panels = canvas(3, 5.4)
    for k, panel in enumerate(panels):
        gap = (oscillating.euler_true[:, k] - steady.euler_true[:, k] + 180.0) % 360.0 - 180.0
        panel.plot(oscillating.seconds, gap, color=AXIS_COLOURS[k], lw=0.9)
        panel.set_ylabel(f"Δ angle {k + 1} [deg]")
    panels[0].set_title("Euler angles with oscillating rates, less those with their mean", fontsize=9, loc="left")
    finish(figure, 7)


def figure_8(arc):
    """The digits."""
    figure, panels = canvas(3, 5.4)
    for k, panel in enumerate(panels):
        panel.step(arc.seconds, 1e6 * arc.field_b[:, k], where="mid", color=SECOND, lw=1.0, label="measured, digits of 6.44 mG")
        panel.plot(arc.seconds, 1e6 * arc.field_b_true[:, k], color=TRUE, lw=0.9, label="computed")
        part = arc.field_b_true[100:175, k] * 1e6
        panel.set(ylabel=f"B{'xyz'[k]} [μT]", xlim=(800, 1400), ylim=(part.min() - 1.0, part.max() + 1.0))
    panels[0].legend(frameon=False, ncols=2, loc="lower left", bbox_to_anchor=(0, 1.0))
    finish(figure, 8)


def figure_9(digits, smooth):
    """Second derivatives from digits and from the exact field, same differences."""
    figure, panels = canvas(3, 5.4)
    for k, panel in enumerate(panels):
        panel.plot(digits.seconds, 1e12 * digits.field_second_b[:, k], color=SECOND, lw=0.8, label="of the digits")
        panel.plot(smooth.seconds, 1e12 * smooth.field_second_b[:, k], color=TRUE, lw=1.1, label="of the exact field")
        panel.set_ylabel(f"d²B{'xyz'[k]}/dt² [pT/s²]")
    panels[0].legend(frameon=False, ncols=2, loc="lower left", bbox_to_anchor=(0, 1.0))
    finish(figure, 9)


def figure_11(by_240, by_120):
    """Euler angles from the exact field of an oscillating body at two steps."""
    figure, panels = canvas(3, 5.4)
    for k, panel in enumerate(panels):
        true = unwrapped(by_240.euler_true[:, k])
        for arc, label, colour in ((by_120, "step 120 s", SECOND), (by_240, "step 240 s", FIRST)):
            found = unwrapped(arc.euler_true[:, k], arc.euler[:, k])
            panel.plot(arc.seconds, found, ".", ms=2.5, color=colour, label=label)
        panel.plot(by_240.seconds, true, color=TRUE, lw=1.0, label="true")
        bounded(panel, true, 40.0)
        panel.set_ylabel(f"angle {k + 1} [deg]")
    panels[0].legend(frameon=False, ncols=3, loc="lower left", bbox_to_anchor=(0, 1.0), markerscale=3)
    finish(figure, 11)


def figure_12(arc):
    """Rates from the exact field of an oscillating body."""
    figure, panels = canvas(4, 6.4)
    true, found = np.degrees(arc.omega_bi_b_true.values), np.degrees(arc.omega_bi_b.values)
    true = np.column_stack([true, np.linalg.norm(true, axis=1)])
    found = np.column_stack([found, np.linalg.norm(found, axis=1)])
    for k, panel in enumerate(panels):
        panel.plot(arc.seconds, true[:, k], color=FAINT, lw=0.8, label="true")
        panel.plot(arc.seconds, found[:, k], ".", ms=2.5, color=SECOND, label="found, step 120 s")
        middle = np.nanmedian(true[:, k])
        panel.set(ylabel=("ωx", "ωy", "ωz", "|ω|")[k] + " [deg/s]", ylim=(middle - 0.06, middle + 0.06))
    panels[0].legend(frameon=False, ncols=2, loc="lower left", bbox_to_anchor=(0, 1.0), markerscale=3)
    finish(figure, 12)


def figure_13(methods):
    """Beyond the paper: the same digits, other uses of them."""
    figure, (panel,) = canvas(height=3.8)
    for (label, errors), colour in zip(methods.items(), (FAINT, SECOND, FIRST), strict=True):
        panel.semilogy(next(iter(methods.values())).seconds, errors, ".", ms=3, color=colour, label=label)
    panel.set(ylabel="attitude error [deg]", ylim=(0.03, 200))
    panel.legend(frameon=False, ncols=3, fontsize=8, loc="lower left", bbox_to_anchor=(0, 1.0), markerscale=3)
    finish(figure, 13)


def main():
    """All of them."""
    exact = run(step_s=16.0, quantisation_tesla=0.0, choice="nearest", **TOUCHING)
    figure_2(exact)
    figure_3(exact)
    figure_4(exact)
    euler_panels(exact, "step 16 s, exact field", 5)
    oscillating = run(step_s=240.0, oscillation=True, choice="nearest", **USUAL)
    figure_6(oscillating)
    figure_7(oscillating, run(**USUAL))
    figure_8(oscillating)
    by_240 = run(step_s=240.0, quantisation_tesla=0.0, oscillation=True, choice="nearest", **USUAL)
    figure_9(oscillating, by_240)
    euler_panels(oscillating, "step 240 s, digits of 6.44 mG", 10)
    by_120 = run(step_s=120.0, quantisation_tesla=0.0, oscillation=True, choice="nearest", **USUAL)
    figure_11(by_240, by_120)
    figure_12(by_120)
    three = run(choice="nearest", **USUAL)
    long = run(smoothing="polynomial", window_s=960.0, fit_s=960.0, **USUAL)
    figure_13(
        {
            "three samples, 240 s apart": three.error_nearest,
            "polynomial over 960 s": long.error_nearest,
            "least squares over 960 s": long.error_fit,
        }
    )


if __name__ == "__main__":
    main()
