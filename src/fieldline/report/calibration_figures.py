"""Figures of the magnetometer's slow faults: its common gain, and the error that was found with the attitude."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fieldline.report.record import Clock, Record
from fieldline.report.series import legend, line
from fieldline.report.theme import AXES, AXIS_COLOURS, INK, Picture, panels

Spells = Sequence[tuple[float, float]]


def gain_picture(calibration: dict[str, Any], start_utc: np.datetime64, dark: Spells) -> Picture | None:
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
    _shade(one, dark, clock)
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
        "Common to the three axes; eclipse is shaded. A curve that follows the eclipse points to temperature; one that "
        "follows nothing, to a wrong orbit or clock.",
        f"Gain of the magnetometer over time, between {curve.min():.3f} and {curve.max():.3f}.",
        figure,
    )


def slow_error_picture(record: Record, dark: Spells) -> Picture | None:
    """The slow error of each axis that was found together with the attitude."""
    if not record.has("slow_error_b"):
        return None
    slow = record.values("slow_error_b", 1e9)
    if not np.nanmax(np.abs(slow), initial=0.0) > 0.0:
        return None
    figure, axes = panels(1, 1, height_in=2.8)
    one = axes[0, 0]
    _shade(one, dark, record.clock)
    for k in range(3):
        line(one, record.time, slow[:, k], AXIS_COLOURS[k], AXES[k], gap=record.widest)
    one.set_xlim(record.time[0], record.time[-1])
    one.set_xlabel(record.clock.label)
    one.set_ylabel("[nT]")
    legend(one)
    largest = float(np.nanmax(np.abs(slow)))
    return Picture(
        "slow_error",
        "Slow error of the magnetometer",
        "What the calibration left and the estimator took for an error of the sensor, not of the attitude; eclipse is shaded. "
        "A step at its edge is a current that changes there.",
        f"Slow error of the three axes over time, up to {largest:.0f} nanotesla.",
        figure,
    )


def _shade(axes: Any, dark: Spells, clock: Clock) -> None:
    """The eclipses."""
    for start, stop in dark:
        axes.axvspan(start / clock.unit_s, stop / clock.unit_s, color=INK, alpha=0.08, linewidth=0)
