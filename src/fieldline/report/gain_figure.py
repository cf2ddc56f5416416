"""The slow common gain of the magnetometer that a calibration found."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.report.record import Clock
from fieldline.report.theme import AXIS_COLOURS, INK, Picture, panels


def gain_picture(calibration: dict[str, Any], start_utc: np.datetime64, dark: list[tuple[float, float]]) -> Picture | None:
    """Gain against time, with eclipses shaded; none where the calibration has no gain.

    calibration : its summary, with `gain_knots_s` and `gain_values`, and `gain_curve_s` and `gain_curve` where the course
    between the knots is known.        dark : (start, stop) [s] of each eclipse.
    """
    knots, values = (np.asarray(calibration.get(key) or [], dtype=float) for key in ("gain_knots_s", "gain_values"))
    if len(knots) < 2 or len(knots) != len(values):
        return None
    clock = Clock.of(start_utc, float(knots[-1]))
    figure, axes = panels(1, 1, height_in=2.5)
    one = axes[0, 0]
    for start, stop in dark:
        one.axvspan(start / clock.unit_s, stop / clock.unit_s, color=INK, alpha=0.08, linewidth=0)
    curve_s, curve = (np.asarray(calibration.get(key) or [], dtype=float) for key in ("gain_curve_s", "gain_curve"))
    if len(curve) < 2:
        curve_s, curve = knots, values
    one.plot(curve_s / clock.unit_s, curve, color=AXIS_COLOURS[0], linewidth=1.5)
    one.plot(knots / clock.unit_s, values, color=AXIS_COLOURS[0], linestyle="none", marker="o", markersize=4)
    one.axhline(1.0, color=INK, linewidth=0.8, linestyle=(0, (4, 2.5)))
    one.set_xlabel(clock.label)
    one.set_ylabel("gain")
    one.set_xlim(knots[0] / clock.unit_s, knots[-1] / clock.unit_s)
    return Picture(
        "gain",
        "Slow gain",
        "Common to the three axes. A curve that follows the eclipse (shaded) points to temperature; one that follows nothing, "
        "to a wrong orbit or clock.",
        f"Gain of the magnetometer over time, between {values.min():.3f} and {values.max():.3f}.",
        figure,
    )
