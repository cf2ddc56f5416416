"""Figures of the motion: rates with their bands, and the attitude with its uncertainty."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.report.geometry import body_axes_from_nadir_deg, roll_pitch_yaw_deg
from fieldline.report.record import Record
from fieldline.report.series import legend, line, points, room, spread
from fieldline.report.theme import AXES, AXIS_COLOURS, FOURTH, GREY, Picture, label_outer, panels

DEG = 180.0 / np.pi
ATTITUDE_DOTS = 20_000  # of a long arc, evenly; each has ten dots in the figure


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
    """Quaternion, angles to the orbital axes and to nadir, each for the whole arc and a short piece."""
    figure, axes = panels(3, 2, height_in=5.6, widths=(1.75, 1.0), column_gap=0.11, row_gap=0.3)
    stride = max(len(record.seconds) // ATTITUDE_DOTS, 1)
    for column, (part, size) in enumerate(((slice(None, None, stride), 0.0), (record.minute(), 4.5))):
        _draw_attitude(axes[:, column], record, part, size)
        axes[0, column].set_ylim(-1.08, 1.08)
        axes[0, column].set_yticks((-1, -0.5, 0, 0.5, 1))
        axes[1, column].set_ylim(-195, 195)
        axes[1, column].set_yticks((-180, -90, 0, 90, 180))
        axes[2, column].set_ylim(-7, 187)
        axes[2, column].set_yticks((0, 45, 90, 135, 180))
        for one in axes[:, column]:
            one.tick_params(labelleft=column == 0)
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


def _draw_attitude(column: Any, record: Record, part: slice, size: float) -> None:
    """One column: quaternion, roll-pitch-yaw, angles from nadir, of a part of the samples."""
    q, position, velocity = (record.values(name)[part] for name in ("q_bi", "position_i", "velocity_i"))
    angles, nadir = roll_pitch_yaw_deg(q, position, velocity), body_axes_from_nadir_deg(q, position)
    time = record.time[part]
    for k, colour in enumerate((*AXIS_COLOURS, FOURTH)):
        points(column[0], time, q[:, k], colour, f"q{'xyzw'[k]}", size=size)
    for k, colour in enumerate(AXIS_COLOURS):
        points(column[1], time, angles[:, k], colour, ("roll", "pitch", "yaw")[k], size=size)
        points(column[2], time, nadir[:, k], colour, f"body {AXES[k]}", size=size)
    if len(time) > 1:
        for one in column:
            one.set_xlim(time[0], time[-1])


def uncertainty_picture(record: Record) -> Picture:
    """One sigma of attitude and rate over time, body axes."""
    attitude, rate = record.values("attitude_std_b", DEG), record.values("omega_std_b", DEG)
    figure, axes = panels(1, 2, height_in=2.7, column_gap=0.2)
    for one, values, title in zip(axes[0], (attitude, rate), ("attitude, 1σ [deg]", "rate, 1σ [deg/s]"), strict=True):
        for k in range(3):
            line(one, record.time, values[:, k], AXIS_COLOURS[k], f"about {AXES[k]}", gap=record.widest)
        _limit(one, values)
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


def _limit(axes: Any, values: np.ndarray) -> None:
    """From zero where the values are alike; logarithmic where the worst is far above the usual."""
    known = values[np.isfinite(values) & (values > 0.0)]
    if not len(known):
        return
    worst = float(known.max())
    if worst < 12.0 * float(np.median(known)):
        axes.set_ylim(0.0, 1.08 * worst)
        return
    axes.set_yscale("log")
    low, high = 0.8 * float(known.min()), 1.3 * worst
    axes.set_ylim(low, high)
    axes.set_yticks([m * 10.0**k for k in range(-6, 4) for m in (1, 3) if low < m * 10.0**k < high])
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.yaxis.set_minor_formatter(lambda value, _: "")
