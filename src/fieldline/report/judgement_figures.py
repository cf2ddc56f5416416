"""Figures of the judges: a gyro and sun sensors that the estimate did not use, predicted against measured."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.report.geometry import to_body
from fieldline.report.record import Record
from fieldline.report.series import legend, points, room
from fieldline.report.theme import AXES, AXIS_COLOURS, GREY, INK, Picture, label_outer, panels

DEG = 180.0 / np.pi
FACE_SIGN = {"-": -1.0, "+": 1.0}


def gyro_picture(record: Record) -> Picture | None:
    """The gyro less the estimated rate, about each axis."""
    if not record.has("gyro_b"):
        return None
    difference = record.values("gyro_b", DEG) - record.values("omega_bi_b", DEG)
    offset = np.nanmedian(difference, axis=0)
    figure, axes = panels(3, 1, height_in=4.6, row_gap=0.34)
    for k, one in enumerate(axes[:, 0]):
        points(one, record.time, difference[:, k], AXIS_COLOURS[k])
        one.axhline(offset[k], color=INK, linewidth=0.9)
        one.set_title(f"about {AXES[k]}: median {offset[k]:+.3f} deg/s")
        one.set_ylim(room(difference[:, k], tails=0.003, share=0.2))
        one.set_xlim(record.time[0], record.time[-1])
        one.set_ylabel("[deg/s]")
    label_outer(axes, (record.clock.label,))
    return Picture(
        "gyro",
        "The unseen gyro, less the estimate",
        "A level cloud off zero is the gyro's own bias; a slope or a wave is an error of one of the two.",
        f"Gyro less estimated rate; medians {offset[0]:+.3f}, {offset[1]:+.3f}, {offset[2]:+.3f} degrees per second.",
        figure,
    )


def sun_picture(record: Record) -> Picture | None:
    """Each face's reading against the predicted cosine of the Sun, and both over a short sunlit piece."""
    if not record.has("sun_sensor", "sun_i", "sunlit"):
        return None
    faces = [str(face) for face in record.dataset["face"].values]
    readings = record.values("sun_sensor")
    cosine, lit = _cosines(record, faces), record.values("sunlit") > 0.5
    figure, axes = panels(len(faces), 2, height_in=0.9 + 1.45 * len(faces), widths=(1.0, 1.75), column_gap=0.12)
    window = _sunlit_piece(record, lit)
    for row, face in enumerate(faces):
        full = max(float(np.nanquantile(readings[:, row], 0.995)), 1e-12)
        share = 100.0 * readings[:, row] / full
        _draw_face(axes[row], record, cosine[:, row], share, lit, window, face)
    axes[0, 1].set_title("a short sunlit piece")
    legend(axes[0, 0])
    legend(axes[0, 1])
    label_outer(axes, ("predicted cosine to the Sun", record.clock.label))
    return Picture(
        "sun",
        "The unseen sun sensors",
        "Left, readings should be low below zero cosine and rise along a line above it; dots in the upper left corner are "
        "misses (or light from the Earth). Right, the pulses should rise and fall together.",
        f"Sun-sensor readings of the faces {', '.join(faces)} against the cosine that the estimate predicts.",
        figure,
    )


def _cosines(record: Record, faces: list[str]) -> np.ndarray:
    """(n, faces) predicted cosine of the angle between each face's normal and the Sun, in eclipse too."""
    sun_b = to_body(record.values("q_bi"), record.values("sun_i"))
    return np.stack([FACE_SIGN[face[0]] * sun_b[:, "xyz".index(face[1])] for face in faces], axis=-1)


def _sunlit_piece(record: Record, lit: np.ndarray) -> slice:
    """A short window in the middle of the sunlit samples."""
    minute = record.minute()
    sunlit = np.flatnonzero(lit)
    if not len(sunlit):
        return minute
    half = (minute.stop - minute.start) // 2
    middle = int(sunlit[len(sunlit) // 2])
    return slice(max(middle - half, 0), min(middle + half + 1, len(lit)))


def _draw_face(
    pair: Any, record: Record, cosine: np.ndarray, share: np.ndarray, lit: np.ndarray, window: slice, face: str
) -> None:
    """One face: the cloud on the left, the pulses on the right."""
    colour = AXIS_COLOURS["xyz".index(face[1])]
    points(pair[0], cosine[lit], share[lit], colour, "in sunlight")
    points(pair[0], cosine[~lit], share[~lit], GREY, "in eclipse")
    pair[0].axvline(0.0, color=INK, linewidth=0.7)
    pair[0].set_xlim(-1.05, 1.05)
    pair[0].set_ylabel(f"{face}  [% of max]")
    time = record.time[window]
    pulse = np.maximum(cosine, 0.0) * lit
    brightest = max(float(np.quantile(pulse, 0.995)), 0.1)  # both on the scale of their own brightest
    pair[1].plot(time, 100.0 * pulse[window] / brightest, color=INK, linewidth=0.9, label="predicted")
    pair[1].plot(
        time, share[window], color=colour, linestyle="none", marker="o", markersize=3, markeredgewidth=0, label="measured"
    )
    for one in pair:
        one.set_ylim(-8, 118)
        one.set_yticks((0, 50, 100))
    pair[1].tick_params(labelleft=False)
    if len(time) > 1:
        pair[1].set_xlim(time[0], time[-1])
