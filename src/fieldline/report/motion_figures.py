"""Figures of the motion: rates with their bands, and the attitude with its uncertainty."""

from __future__ import annotations

import numpy as np

from fieldline.report.geometry import body_axes_from_nadir_deg, roll_pitch_yaw_deg
from fieldline.report.record import Record
from fieldline.report.series import legend, line, points, room, spread
from fieldline.report.theme import AXES, AXIS_COLOURS, FOURTH, GREY, Picture, label_outer, panels

DEG = 180.0 / np.pi


def rate_picture(record: Record) -> Picture:
    """Body rates with their one-sigma bands; a gyro that was not used lies under them."""
    rate, std = record.values("omega_bi_b", DEG), record.values("omega_std_b", DEG)
    gyro = record.values("gyro_b", DEG) if record.has("gyro_b") else None
    figure, axes = panels(3, 1, height_in=5.0, row_gap=0.14)
    for k, one in enumerate(axes[:, 0]):
        if gyro is not None:
            points(one, record.time, gyro[:, k], GREY, "gyro, as the file gives it")
        spread(one, record.time, rate[:, k], std[:, k], AXIS_COLOURS[k], "1σ", gap=record.widest)
        line(one, record.time, rate[:, k], AXIS_COLOURS[k], "estimate", gap=record.widest)
        shown = [rate[:, k] - std[:, k], rate[:, k] + std[:, k]] + ([gyro[:, k]] if gyro is not None else [])
        one.set_ylim(room(np.concatenate(shown), tails=0.002, share=0.15, least=1e-3))
        one.set_xlim(record.time[0], record.time[-1])
        one.set_ylabel(f"ω{AXES[k]}  [deg/s]")
    legend(axes[0, 0])
    label_outer(axes, (record.clock.label,))
    middle = ", ".join(f"{m:.3f}" for m in np.nanmedian(rate, axis=0))
    seen = (
        " The gyro's dots were not seen by the estimate: a constant distance is the gyro's bias, a changing one is an error."
        if gyro is not None
        else " A band wider than the changes of the line means that the data do not see them."
    )
    return Picture(
        "rates",
        "Body rates",
        "The bands are one standard deviation." + seen,
        f"Rates about the three body axes over time; medians {middle} degrees per second.",
        figure,
    )


def attitude_picture(record: Record) -> Picture:
    """Quaternion, angles to the orbital axes and to nadir, each for the whole arc and a short piece; below, one sigma."""
    q = record.values("q_bi")
    angles = roll_pitch_yaw_deg(q, record.values("position_i"), record.values("velocity_i"))
    nadir = body_axes_from_nadir_deg(q, record.values("position_i"))
    figure, axes = panels(3, 2, height_in=5.6, widths=(1.75, 1.0), column_gap=0.11, row_gap=0.3)
    window = record.minute()
    quaternion_colours = (*AXIS_COLOURS, FOURTH)
    for column, (part, size) in enumerate(((slice(None), 0.0), (window, 4.5))):
        time = record.time[part]
        for k in range(4):
            points(axes[0, column], time, q[part, k], quaternion_colours[k], f"q{'xyzw'[k]}", size=size)
        for k in range(3):
            points(axes[1, column], time, angles[part, k], AXIS_COLOURS[k], ("roll", "pitch", "yaw")[k], size=size)
            points(axes[2, column], time, nadir[part, k], AXIS_COLOURS[k], f"body {AXES[k]}", size=size)
        for row, (low, high, step) in enumerate(((-1, 1, 0.5), (-180, 180, 90), (0, 180, 45))):
            margin = 0.04 * (high - low)
            axes[row, column].set_ylim(low - margin, high + margin)
            axes[row, column].set_yticks(np.arange(low, high + step / 2, step))
            axes[row, column].tick_params(labelleft=column == 0)
            if len(time) > 1:
                axes[row, column].set_xlim(time[0], time[-1])
    titles = ("quaternion q_bi, scalar last", "against the orbital axes", "angle of the body axes from nadir")
    for row, (title, unit) in enumerate(zip(titles, ("", "[deg]", "[deg]"), strict=True)):
        axes[row, 0].set_title(title)
        axes[row, 0].set_ylabel(unit)
        legend(axes[row, 0])
    axes[0, 1].set_title("a short piece of it")
    label_outer(axes, (record.clock.label, record.clock.label.split()[0]))
    return Picture(
        "attitude",
        "Attitude",
        "A held satellite shows level lines in the two lower rows, a spinner a level line for the axis it spins about; a jump "
        "in the nadir angles would be an error. Orbital axes: x along the velocity, z to nadir; turned by yaw, pitch, roll.",
        "Quaternion, roll pitch and yaw against the orbital axes, and the angle of each body axis from nadir, over time.",
        figure,
    )


def uncertainty_picture(record: Record) -> Picture:
    """One sigma of attitude and rate over time, body axes."""
    attitude, rate = record.values("attitude_std_b", DEG), record.values("omega_std_b", DEG)
    figure, axes = panels(1, 2, height_in=2.7, column_gap=0.2)
    for one, values, title in zip(axes[0], (attitude, rate), ("attitude, 1σ [deg]", "rate, 1σ [deg/s]"), strict=True):
        for k in range(3):
            line(one, record.time, values[:, k], AXIS_COLOURS[k], f"about {AXES[k]}", gap=record.widest)
        one.set_ylim(0.0, 1.08 * max(float(np.nanquantile(values, 0.999)), 1e-9))
        one.set_xlim(record.time[0], record.time[-1])
        one.set_xlabel(record.clock.label)
        one.set_title(title)
        legend(one)
    middle = ", ".join(f"{m:.2g}" for m in np.nanmedian(attitude, axis=0))
    return Picture(
        "uncertainty",
        "Uncertainty",
        "Largest at the ends of the arc and where the field hardly turns; a magnetometer sees nothing of a turn about the field "
        "at an instant.",
        f"One standard deviation of attitude and rate over time; medians of the attitude {middle} degrees about x, y, z.",
        figure,
    )
