"""Figures of a run's motion: rates, attitude against the orbital axes, distance from the target, and where it flew."""

from __future__ import annotations

import numpy as np

from fieldline.report.geometry import body_axes_from_nadir_deg, roll_pitch_yaw_deg
from fieldline.report.pointing import ARCSEC_BELOW_DEG, Pointing, pointing_of
from fieldline.report.run_record import DEG, RunRecord
from fieldline.report.run_strokes import finish, fit, fit_settled, is_wide, logarithmic, stroke
from fieldline.report.series import line, points
from fieldline.report.theme import AXES, AXIS_COLOURS, INK, Picture, label_outer, panels

HELD_DEG = 60.0  # angles within this are drawn as lines to their own scale
DOTS = 12_000


def rate_picture(record: RunRecord, b: int) -> Picture:
    """Angular rate of a body: three components and the size."""
    rate = record.of("omega_bi_b", b, DEG)
    size = np.linalg.norm(rate, axis=1)
    figure, axes = panels(2, 1, height_in=4.4, row_gap=0.3, heights=(1.3, 1.0))
    upper, lower = axes[:, 0]
    for k in range(3):
        stroke(upper, record, rate[:, k], k, f"about {AXES[k]}", width=0.8)
    fit(upper, rate, least=1e-3)
    finish(upper, record, "rate against inertial axes, body axes", "deg/s")
    line(lower, record.time, size, INK)
    if is_wide(size) or (size[0] > 20.0 * size[-1] > 0.0):
        logarithmic(lower, size)
    elif size.max() > 0.0:
        lower.set_ylim(0.0, 1.1 * size.max())
    finish(lower, record, "its size", "deg/s", keyed=False)
    label_outer(axes, (record.clock.label,))
    return Picture(
        record.tag("rates", b),
        record.of_body("Body rates", b),
        "Stays in the Earth's shadow are shaded. A body held to the orbital axes turns once per orbit, about 0.06 deg/s.",
        f"Angular rate over time, from {size[0]:.3g} to {size[-1]:.3g} degrees per second.",
        figure,
    )


def attitude_picture(record: RunRecord, b: int) -> Picture:
    """Roll, pitch and yaw against the orbital axes, and each body axis's angle from nadir."""
    stride = max(len(record.seconds) // DOTS, 1)
    q, position, velocity = (record.of(name, b)[::stride] for name in ("q_bi", "position_i", "velocity_i"))
    angles, nadir = roll_pitch_yaw_deg(q, position, velocity), body_axes_from_nadir_deg(q, position)
    time = record.time[::stride]
    figure, axes = panels(2, 1, height_in=4.6, row_gap=0.3)
    held = float(np.abs(angles).max()) < HELD_DEG
    for k, colour in enumerate(AXIS_COLOURS):
        draw = line if held else points
        draw(axes[0, 0], time, angles[:, k], colour, ("roll", "pitch", "yaw")[k])
        (line if held else points)(axes[1, 0], time, nadir[:, k], colour, f"body {AXES[k]}")
    if held:
        start = fit_settled(axes[0, 0], angles, least=1e-4)
    else:
        start = ""
        axes[0, 0].set_ylim(-195, 195)
        axes[0, 0].set_yticks((-180, -90, 0, 90, 180))
    axes[1, 0].set_ylim(-7, 187)
    axes[1, 0].set_yticks((0, 45, 90, 135, 180))
    finish(axes[0, 0], record, f"against the orbital axes: yaw, pitch, roll in this order{start}", "deg")
    finish(axes[1, 0], record, "angle of each body axis from nadir", "deg")
    label_outer(axes, (record.clock.label,))
    return Picture(
        record.tag("attitude", b),
        record.of_body("Attitude", b),
        "Orbital axes: x along the velocity, z to nadir. Level lines mean a body held to the Earth; a body held among the stars "
        "shows waves of one orbit.",
        f"Roll, pitch and yaw against the orbital axes, at most {np.abs(angles).max():.3g} degrees, and angles from nadir.",
        figure,
    )


def pointing_picture(record: RunRecord, b: int) -> Picture | None:
    """How far the body was from the target of its law, where it has one."""
    pointing = pointing_of(record, b)
    if pointing is None:
        return None
    unit, factor = unit_of_angle(pointing.size_deg)
    error, size = factor * pointing.error_deg, factor * pointing.size_deg
    figure, axes = panels(2, 1, height_in=4.4, row_gap=0.3)
    upper, lower = axes[:, 0]
    shown = [k for k in range(3) if pointing.labels[k]]
    for k in shown:
        stroke(upper, record, error[:, k], k, pointing.labels[k], width=0.8)
    start = fit_settled(upper, error[:, shown], least=1e-6)
    finish(upper, record, f"error about the body axes{start}", unit)
    line(lower, record.time, size, INK)
    if is_wide(size):
        logarithmic(lower, size, 5.0)
    else:
        lower.set_ylim(0.0, 1.1 * max(float(size.max()), 1e-9))
    finish(lower, record, "whole angle", unit, keyed=False)
    label_outer(axes, (record.clock.label,))
    return _pointing_words(record, b, pointing, figure)


def _pointing_words(record: RunRecord, b: int, pointing: Pointing, figure) -> Picture:
    """The picture with its words."""
    last = pointing.size_deg[3 * len(pointing.size_deg) // 4 :]
    unit, factor = unit_of_angle(last)
    rms = factor * float(np.sqrt(np.mean(last**2)))
    return Picture(
        record.tag("pointing", b),
        record.of_body("Pointing error", b),
        f"Truth against {pointing.words}; in the last quarter {rms:.3g} {unit} RMS.",
        f"Pointing error over time; root mean square {rms:.3g} {unit} in the last quarter.",
        figure,
    )


def unit_of_angle(degrees: np.ndarray) -> tuple[str, float]:
    """Degrees, or seconds of arc where half of the values are small."""
    return ("arcsec", 3600.0) if float(np.nanmedian(np.abs(degrees))) < ARCSEC_BELOW_DEG else ("deg", 1.0)


def place_picture(record: RunRecord) -> Picture:
    """Field in the axes of the first body that turns, its size, and the heights of all bodies."""
    turning = record.rigid[0] if record.rigid else 0
    field = record.of("field_b", turning, 1e6)
    figure, axes = panels(3, 1, height_in=5.6, row_gap=0.34, heights=(1.3, 1.0, 0.9))
    for k in range(3):
        stroke(axes[0, 0], record, field[:, k], k, AXES[k], width=0.7)
    fit(axes[0, 0], field, least=0.1)
    finish(axes[0, 0], record, record.of_body("field, body axes", turning), "µT")
    line(axes[1, 0], record.time, np.linalg.norm(field, axis=1), INK)
    finish(axes[1, 0], record, "its size", "µT", keyed=False)
    heights = record.values("altitude_m", 1e-3)[:, : len(record.bodies)]
    shown = range(min(heights.shape[1], 6))
    for b in shown:
        stroke(axes[2, 0], record, heights[:, b], b, record.bodies[b])
    fit(axes[2, 0], heights[:, list(shown)], least=1.0)
    finish(axes[2, 0], record, "height over the ellipsoid", "km", keyed=len(record.bodies) > 1)
    label_outer(axes, (record.clock.label,))
    dark = 100.0 * float((record.of("sunlit", turning) < 0.5).mean())
    return Picture(
        "field",
        "Field and place",
        f"Shaded: in the Earth's shadow, {dark:.3g} % of the run. The height's waves are the ellipsoid's and the orbit's.",
        f"Magnetic field in body axes and its size over time; height from {heights.min():.4g} to {heights.max():.4g} kilometres.",
        figure,
    )
