"""Figures of the field: measured and predicted on each other, and its magnitude before and after calibration."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.report.record import MICROTESLA, MagnitudeRecord, Record, lengths
from fieldline.report.series import legend, line, points, room
from fieldline.report.theme import AXES, AXIS_COLOURS, GREY, INK, Picture, label_outer, panels


def field_picture(record: Record) -> Picture:
    """Each axis of the calibrated field with the prediction over it: the whole arc, and a minute of it."""
    measured, predicted = record.values("field_b", MICROTESLA), record.values("field_predicted_b", MICROTESLA)
    figure, axes = panels(3, 2, height_in=5.6, widths=(1.75, 1.0), column_gap=0.11)
    window = record.minute()
    for k in range(3):
        whole, short = axes[k]
        points(whole, record.time, measured[:, k], GREY, "measured, calibrated")
        line(whole, record.time, predicted[:, k], AXIS_COLOURS[k], "predicted", gap=record.widest, width=0.7)
        _zoom(short, record, window, measured[:, k], predicted[:, k], AXIS_COLOURS[k])
        whole.set_ylabel(f"B{AXES[k]}  [µT]")
        limits = room(np.stack([measured[record.used, k], predicted[record.used, k]]))
        whole.set_ylim(limits)
        short.set_ylim(limits)
        whole.set_xlim(record.time[0], record.time[-1])
        short.tick_params(labelleft=False)
    legend(axes[0, 0])
    axes[0, 0].set_title("the whole arc")
    axes[0, 1].set_title("a short piece of it")
    label_outer(axes, (record.clock.label, f"{record.clock.label.split()[0]}"))
    rms = float(np.sqrt(np.nanmean((measured - predicted)[record.used] ** 2)))
    return Picture(
        "field",
        "Measured and predicted field",
        "The line should pass through the dots on every axis, in the short piece above all; where it does not, "
        "the attitude or the calibration is wrong.",
        f"Three axes of the magnetic field over time, measured and predicted; they differ by {rms:.2f} microtesla RMS per axis.",
        figure,
    )


def _zoom(axes: Any, record: Record, window: slice, measured: np.ndarray, predicted: np.ndarray, colour: str) -> None:
    """The short piece, its dots large; the prediction stands at the samples, so a straight line joins them."""
    time = record.time[window]
    axes.plot(time, predicted[window], color=colour, linewidth=1.1)
    axes.plot(time, measured[window], color=GREY, linestyle="none", marker="o", markersize=2.8, markeredgewidth=0)
    if len(time) > 1:
        axes.set_xlim(time[0], time[-1])


def magnitude_picture(record: Record) -> Picture:
    """The magnitude of an estimate's field as it came, after calibration, and its difference from the model."""
    before, after, model = (lengths(record.values(name, MICROTESLA)) for name in ("field_raw_s", "field_b", "field_i"))
    return magnitudes_picture(MagnitudeRecord(record.time_utc, before, after, model, record.used))


def magnitudes_picture(record: MagnitudeRecord, name: str = "magnitude", of: str = "") -> Picture:
    """Magnitudes before and after calibration; `of` says of which flight."""
    figure, axes = panels(3, 1, height_in=5.4, heights=(1.0, 1.0, 0.8), row_gap=0.32)
    rows = axes[:, 0]
    left = record.after - record.model
    for one, values, title in ((rows[0], record.before, "as the file gives it"), (rows[1], record.after, "after calibration")):
        points(one, record.time, values, AXIS_COLOURS[0], "measured")
        line(one, record.time, record.model, INK, "model", width=1.4, gap=record.widest)
        one.set_ylim(room(np.concatenate([values[record.used], record.model]), tails=0.0005, share=0.12))
        one.set_ylabel("|B|  [µT]")
        one.set_title(title)
        legend(one)
    points(rows[2], record.time, left, AXIS_COLOURS[1])
    rows[2].axhline(0.0, color=INK, linewidth=0.8)
    rows[2].set_ylim(room(left[record.used], tails=0.001, share=0.2))
    rows[2].set_ylabel("[µT]")
    rows[2].set_title("after calibration, less the model")
    for one in rows:
        one.set_xlim(record.time[0], record.time[-1])
    label_outer(axes, (record.clock.label,))
    rms = [float(np.sqrt(np.nanmean(d[record.used] ** 2))) for d in (record.before - record.model, left)]
    return Picture(
        name,
        "Magnitude before and after calibration" + (f": {of}" if of else ""),
        f"Calibration took the difference from the model from {rms[0]:.3g} to {rms[1]:.3g} µT RMS; "
        "what is left should scatter about zero without waves.",
        f"Field magnitude against the model: {rms[0]:.3g} microtesla RMS apart before, {rms[1]:.3g} after calibration.",
        figure,
    )
