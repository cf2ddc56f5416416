"""Figures of what was known on board and read by the sensors, each less the truth.

A reading is compared where an output stands at its time to a millisecond: between outputs the truth is not kept.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from fieldline.report.run_record import DEG, RunRecord
from fieldline.report.run_strokes import COLOURS, finish, fit, smallest_on_top, stroke
from fieldline.report.series import points
from fieldline.report.theme import AXES, Picture, label_outer, panels

SAME_TIME_S = 1e-3
ARCSEC = 3600.0 * DEG
LEAST = {"nT": 1.0, "deg/s": 1e-5, "deg": 1e-4, "arcsec": 0.1, "m": 0.1, "": 0.1}  # heights of panels without any error
ABOUT = ("about x", "about y", "about z")


def knowledge_picture(record: RunRecord, b: int) -> Picture | None:
    """Attitude and rate as known on board, less the truth."""
    rows = []
    if record.has("q_bi_known"):
        error = attitude_error(record.of("q_bi", b), record.of("q_bi_known", b))
        if np.isfinite(error).any():
            small = float(np.nanmedian(np.abs(error))) < 1e-3
            rows.append(
                (error * (ARCSEC if small else DEG), "attitude known on board, less the truth", "arcsec" if small else "deg")
            )
    if record.has("omega_bi_b_known"):
        error = record.of("omega_bi_b_known", b, DEG) - record.of("omega_bi_b", b, DEG)
        if np.isfinite(error).any():
            rows.append((error, "rate known on board, less the truth", "deg/s"))
    if not rows:
        return None
    figure, axes = panels(len(rows), 1, height_in=0.9 + 1.75 * len(rows), row_gap=0.32)
    for one, (error, title, unit) in zip(axes[:, 0], rows, strict=True):
        for k in range(3):
            stroke(one, record, error[:, k], k, ABOUT[k], width=0.7, gap=record.widest)
        fit(one, error, tails=0.0005, least=LEAST[unit])
        smallest_on_top(one, error)
        finish(one, record, title, unit)
    label_outer(axes, (record.clock.label,))
    rms = [f"{np.sqrt(np.nanmean(error**2)):.3g} {unit}" for error, _, unit in rows]
    return Picture(
        record.tag("knowledge", b),
        record.of_body("Known on board", b),
        f"RMS per axis {' and '.join(rms)}. A control law cannot be better than this. It is what the last reading said: it ages "
        "until the next, so that part of the error is the turn since then.",
        f"Error of attitude and rate known on board over time, RMS {' and '.join(rms)}.",
        figure,
    )


def attitude_error(truth: np.ndarray, known: np.ndarray) -> np.ndarray:
    """(n, 3) [rad] rotation vector from the true to the known attitude, body axes; NaN where nothing is known."""
    from scipy.spatial.transform import Rotation

    error = np.full((len(truth), 3), np.nan)
    good = np.isfinite(known).all(axis=1) & (np.abs(known).sum(axis=1) > 0.0)
    if good.any():
        error[good] = (Rotation.from_quat(truth[good]).inv() * Rotation.from_quat(known[good])).as_rotvec()
    return error


@dataclass(frozen=True)
class Residual:
    """A sensor's readings less the truth, or its readings where the truth is not kept."""

    title: str
    unit: str
    seconds: np.ndarray
    values: np.ndarray
    labels: tuple[str, ...]


def sensor_picture(record: RunRecord, b: int) -> Picture | None:
    """A panel for each sensor of a body."""
    rows = [one for one in residuals(record, b) if len(one.seconds) and np.isfinite(one.values).any()]
    if not rows:
        return None
    figure, axes = panels(len(rows), 1, height_in=0.9 + 1.6 * len(rows), row_gap=0.36)
    for one, row in zip(axes[:, 0], rows, strict=True):
        time = row.seconds / record.clock.unit_s
        for k, label in enumerate(row.labels):
            points(one, time, row.values[:, k], COLOURS[k % len(COLOURS)], label)
        fit(one, row.values, tails=0.0005, least=LEAST[row.unit])
        smallest_on_top(one, row.values)
        finish(one, record, row.title, row.unit)
    label_outer(axes, (record.clock.label,))
    told = ", ".join(f"{row.title.split(',')[0]} {np.sqrt(np.nanmean(row.values**2)):.3g} {row.unit}".rstrip() for row in rows)
    return Picture(
        record.tag("sensors", b),
        record.of_body("Sensors", b),
        "A level line away from zero is a bias; waves that follow the field are scale errors and misalignment; width is noise.",
        f"Readings of the sensors less the truth; RMS: {told}.",
        figure,
    )


def residuals(record: RunRecord, b: int) -> Iterator[Residual]:
    """All sensors of a body."""
    body = record.bodies[b]
    for key, variable, factor, unit in (("magnetometer", "field_b", 1e9, "nT"), ("gyro", "omega_bi_b", DEG, "deg/s")):
        if record.has(f"{key}_{body}"):
            seconds, read, row = at_outputs(record, f"{key}_{body}")
            yield Residual(f"{key}, less the truth", unit, seconds, factor * (read - record.of(variable, b)[row]), AXES)
    if record.has(f"star_tracker_{body}"):
        seconds, read, row = at_outputs(record, f"star_tracker_{body}")
        error = ARCSEC * attitude_error(record.of("q_bi", b)[row], read)
        yield Residual("star tracker, less the truth", "arcsec", seconds, error, ABOUT)
    if record.has(f"navigation_{body}"):
        seconds, read, row = at_outputs(record, f"navigation_{body}")
        yield Residual("navigation, less the truth", "m", seconds, read - record.of("position_i", b)[row], AXES)
    if record.has(f"sun_sensor_{body}"):
        readings = record.values(f"sun_sensor_{body}")
        labels = tuple(normal_words(one) for one in record.values(f"sun_sensor_normal_{body}"))
        yield Residual("sun sensors, their readings", "", record.seconds_of(f"time_sun_sensor_{body}"), readings, labels)


def normal_words(normal: np.ndarray) -> str:
    """+x, or the three numbers."""
    k = int(np.argmax(np.abs(normal)))
    if abs(normal[k]) > 1.0 - 1e-9:
        return f"{'+' if normal[k] > 0 else '−'}{AXES[k]}"
    return " ".join(f"{v:.2g}" for v in normal)


def at_outputs(record: RunRecord, name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times [s], readings, and rows of the outputs at the same times."""
    seconds = record.seconds_of(f"time_{name}")
    if not len(seconds):
        return seconds, record.values(name), np.zeros(0, dtype=int)
    row = np.clip(np.searchsorted(record.seconds, seconds - SAME_TIME_S), 0, len(record.seconds) - 1)
    same = np.abs(record.seconds[row] - seconds) <= SAME_TIME_S
    return seconds[same], record.values(name)[same], row[same]
