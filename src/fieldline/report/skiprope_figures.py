"""Figures of a skiprope estimate: signals, the tether seen along the radius, how the estimate settles, the spectrum."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fieldline.report.record import TimeAxis
from fieldline.report.series import legend, line, points, room, spread
from fieldline.report.theme import AXIS_COLOURS, FAINT, FOURTH, GREY, INK, WARM, Picture, label_outer, panels

DEGREE = 180.0 / np.pi
MILLIHERTZ = 1e3
SUBSCRIPTS = "₁₂₃"
ELLIPSES = 12  # in a turn
THIN, THIN_STROKE = 0.02, 4.0  # of the figure's reach, and [points]: an ellipse thinner than that would hide under the path
TURNS = 4.0  # of which the azimuth is drawn
FEWEST_PERIODS = 2.0  # of a line, in the record, for the spectrum to show it
TURN = np.linspace(0.0, 2.0 * np.pi, 49)


@dataclass(frozen=True)
class SkipropeRecord(TimeAxis):
    """A Dataset of `estimate_skiprope`; the time axis is that of its samples."""

    dataset: Any

    @cached_property
    def time_utc(self) -> np.ndarray:
        """(n,) datetime64[ns] of the samples."""
        return self.dataset["sample_time"].values.astype("datetime64[ns]")

    @cached_property
    def verdict(self) -> dict[str, Any]:
        """The machine-readable verdict."""
        return json.loads(self.dataset.attrs["verdict_json"])

    @cached_property
    def provenance(self) -> dict[str, Any]:
        """What made the estimate."""
        return json.loads(self.dataset.attrs["provenance_json"])

    @property
    def detected(self) -> bool:
        """Whether there is an answer to draw."""
        return bool(self.verdict["detected"])

    def at(self, times: np.ndarray) -> np.ndarray:
        """UTC times on the axis of the figures."""
        return (times.astype("datetime64[ns]") - self.time_utc[0]).astype(np.int64) * 1e-9 / self.clock.unit_s

    def values(self, name: str, factor: float = 1.0) -> np.ndarray:
        """A variable times a factor, time first."""
        return np.asarray(self.dataset[name].values, dtype=float) * factor

    @cached_property
    def trusted_from(self) -> float | None:
        """The time on the axis from which the estimate may be trusted."""
        after = self.verdict["trusted_after_s"]
        return None if after is None else after / self.clock.unit_s


def signals_picture(record: SkipropeRecord) -> Picture:
    """Corrected signals, what the filter makes of them, and the reading marks on the third."""
    corrected = record.values("corrected_rad", DEGREE)
    figure, axes = panels(3, 1, height_in=5.6, row_gap=0.16)
    for k, one in enumerate(axes[:, 0]):
        middle = np.nanmedian(corrected[:, k])
        points(one, record.time, corrected[:, k] - middle, GREY, "corrected, less its median", size=2.0)
        if record.detected:
            filtered = record.values("filtered_rad", DEGREE)[:, k]
            line(one, record.time, filtered, AXIS_COLOURS[k], "through the bandpass", gap=record.widest, width=1.3)
        one.set_ylim(room(corrected[:, k] - middle, tails=0.002, share=0.1, least=0.01))
        one.set_xlim(record.time[0], record.time[-1])
        one.set_ylabel(f"C{SUBSCRIPTS[k]} [deg]")
        _until_trusted(one, record)
    if "mark_time" in record.dataset:
        at = record.at(record.dataset["mark_time"].values)
        style = {"linestyle": "none", "marker": "v", "markersize": 5.0, "color": WARM, "zorder": 4}
        axes[2, 0].plot(at, record.values("mark_amplitude_rad", DEGREE), label="highest: in the field's plane", **style)
    legend(axes[2, 0])
    label_outer(axes, (record.clock.label,))
    return Picture(
        "signals",
        "Corrected and filtered signals",
        "The measured field less the known one, over its size (equation 7 of TP-3123). C₁ and C₂ fade where the field is "
        "level; C₃ keeps its size. Marks: where C₃ is highest the satellite leans towards the field. The grey stretch is too "
        "early to trust.",
        "Three corrected signals over time and what the bandpass filter leaves of them, with reading marks on the third.",
        figure,
    )


def place_picture(record: SkipropeRecord) -> Picture | None:
    """The tether's middle seen along the radius: the last turn, its uncertainty, and the plane whose crossings are asked."""
    if not record.detected:
        return None
    position = record.values("position_m")
    covariance = record.values("position_covariance_m2")
    rows = _last_turns(record, 1.0)
    figure, axes = panels(1, 2, height_in=4.4, widths=(1.0, 1.15), column_gap=0.24)
    left, right = axes[0]
    reach = 1.25 * float(np.max(np.hypot(*position[rows].T) + 2.0 * np.sqrt(np.max(np.abs(covariance[rows]), axis=(1, 2)))))
    dashed = {"color": FOURTH, "linewidth": 1.0, "linestyle": (0, (4, 2.5)), "label": _plane_words(record)}
    left.plot(*(reach * np.outer([-1.0, 1.0], _direction(record)).T), **dashed)
    for row in rows[:: max(len(rows) // ELLIPSES, 1)]:
        _draw_ellipse(left, position[row], covariance[row], reach)
    left.plot(*_smooth(position[rows]).T, color=AXIS_COLOURS[0], linewidth=1.2)
    left.plot(*position[rows[-1]], "o", color=WARM, markersize=7.0)
    left.annotate("last", position[rows[-1]], textcoords="offset points", xytext=(7, 5), color=INK, fontsize=8)
    left.axhline(0.0, color=FAINT, linewidth=0.8, zorder=0)
    left.axvline(0.0, color=FAINT, linewidth=0.8, zorder=0)
    left.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    left.set(xlabel="U, along the velocity [m]", ylabel="V, along the orbit's normal [m]")
    left.set_title("seen from above, last turn")
    legend(left)
    _draw_azimuth(right, record)
    return Picture(
        "place",
        "Where the tether's middle is",
        "Left, looking down along the radius: the last turn with ellipses of two standard deviations; the dashed line is the "
        f"plane whose crossings are asked ({record.verdict['settings']['plane']}), as it stands at the next crossing. Right, "
        "the azimuth over the last turns with a band of two standard deviations.",
        "Path of the tether's middle in the last turn, seen from above, with its uncertainty, and its azimuth over time.",
        figure,
    )


def settling_picture(record: SkipropeRecord) -> Picture | None:
    """Amplitude, deviation of the plane, and frequency over time."""
    if not record.detected:
        return None
    time = record.at(record.dataset["time"].values)
    figure, axes = panels(3, 1, height_in=4.8, row_gap=0.16)
    amplitude, std = record.values("amplitude_rad", DEGREE), record.values("amplitude_std_rad", DEGREE)
    top, middle, low = axes[:, 0]
    spread(top, time, amplitude, std, AXIS_COLOURS[0])
    line(top, time, amplitude, AXIS_COLOURS[0], "round part", width=1.3)
    for name, words in (("major_rad", "half axes"), ("minor_rad", None)):
        line(top, time, record.values(name, DEGREE), GREY, words, dashed=True)
    legend(top)
    top.set_ylim(0.0, 1.2 * float(np.nanquantile(record.values("major_rad", DEGREE), 0.98)))
    top.set_ylabel("tilt [deg]")
    line(middle, time, record.values("plane_std_rad", DEGREE), AXIS_COLOURS[1], "plane, 1σ", width=1.3)
    line(middle, time, record.values("yaw_std_rad", DEGREE), INK, "floor: yaw and azimuth of the field", dashed=True)
    middle.set_ylim(0.0, 1.3 * float(np.nanquantile(record.values("plane_std_rad", DEGREE), 0.98)))
    middle.set_ylabel("1σ [deg]")
    legend(middle)
    frequency, width = record.values("frequency_hz", MILLIHERTZ), record.values("frequency_std_hz", MILLIHERTZ)
    spread(low, time, frequency, width, AXIS_COLOURS[2])
    line(low, time, frequency, AXIS_COLOURS[2], width=1.3)
    low.set_ylim(room(np.concatenate([frequency - width, frequency + width]), least=0.02 * float(np.nanmedian(frequency))))
    low.set_ylabel("frequency [mHz]")
    for one in axes[:, 0]:
        one.set_xlim(time[0], time[-1])
        _until_trusted(one, record)
    label_outer(axes, (record.clock.label,))
    return Picture(
        "settling",
        "How the estimate settles",
        "The grey stretch is too early to trust. Below the dashed line no magnetometer alone can bring the plane's deviation: "
        "yaw of the satellite and azimuth error of the known field look the same to it.",
        "Tilt with its half axes, standard deviation of the plane, and frequency, over time.",
        figure,
    )


def spectrum_picture(record: SkipropeRecord) -> Picture:
    """Both turning parts over frequency, the threshold, the line that was taken and the others."""
    frequency = MILLIHERTZ * record.values("frequency")
    shown = frequency >= MILLIHERTZ * FEWEST_PERIODS / float(record.seconds[-1])
    figure, axes = panels(1, 1, height_in=3.4)
    one = axes[0, 0]
    forward, backward = (record.values(f"spectrum_{name}_rad", DEGREE) for name in ("forward", "backward"))
    threshold = record.values("spectrum_threshold_rad", DEGREE)
    one.plot(frequency[shown], forward[shown], color=AXIS_COLOURS[0], label="turning from the normal towards the rear")
    one.plot(frequency[shown], backward[shown], color=AXIS_COLOURS[1], label="turning back")
    known = shown & np.isfinite(threshold)
    one.plot(frequency[known], threshold[known], color=INK, linestyle=(0, (4, 2.5)), linewidth=0.9, label="threshold")
    if record.detected:
        one.axvline(MILLIHERTZ * record.verdict["frequency_hz"], color=WARM, linewidth=5.0, alpha=0.3, zorder=0, label="taken")
    one.set(xscale="log", yscale="log", xlabel="frequency [mHz]", ylabel="amplitude [deg]")
    values = np.concatenate([forward[shown], backward[shown]])
    one.set_ylim(max(float(np.quantile(values, 0.05)), 1e-6), 2.0 * float(values.max()))
    one.set_xlim(frequency[shown][0], frequency[-1])
    for axis in (one.xaxis, one.yaxis):
        axis.set_major_formatter(lambda value, _: f"{value:g}")
        axis.set_minor_formatter(lambda value, _: "")
    legend(one)
    return Picture(
        "spectrum",
        "Spectrum of the turning motion",
        "A skiprope turns: one of the two parts is larger. What swings in a plane, as a pendulous motion does, has both alike. "
        f"Noise alone would cross the threshold anywhere in the band once in {1.0 / record.verdict['false_alarm']:.0f} records.",
        "Amplitude of the two turning parts over frequency, with the detection threshold.",
        figure,
    )


def _until_trusted(axes: Any, record: SkipropeRecord) -> None:
    """Grey over the time before the estimate may be trusted."""
    if record.detected:
        until = record.time[-1] if record.trusted_from is None else record.trusted_from
        axes.axvspan(record.time[0], until, color=FAINT, alpha=0.6, linewidth=0, zorder=0)


def _draw_azimuth(axes: Any, record: SkipropeRecord) -> None:
    """The azimuth of the tether's middle over the last turns, broken where the scale ends."""
    rows = _last_turns(record, TURNS)
    time = record.at(record.dataset["time"].values)[rows]
    angle, std = record.values("plane_rad", DEGREE)[rows], record.values("plane_std_rad", DEGREE)[rows]
    breaks = np.flatnonzero(np.abs(np.diff(angle)) > 180.0) + 1
    for part in np.split(np.arange(len(rows)), breaks):
        axes.fill_between(time[part], (angle - 2.0 * std)[part], (angle + 2.0 * std)[part], color=AXIS_COLOURS[0], alpha=0.25)
        axes.plot(time[part], angle[part], color=AXIS_COLOURS[0], linewidth=1.2)
    axes.set(xlabel=record.clock.label, ylabel="azimuth of the middle [deg]", ylim=(-190, 190), xlim=(time[0], time[-1]))
    axes.set_yticks([-180, -90, 0, 90, 180])
    axes.set_title("from the orbit's normal (0) towards the rear (90)")


def _last_turns(record: SkipropeRecord, turns: float) -> np.ndarray:
    """The rows of the last so many periods, and the one before them."""
    time = record.dataset["time"].values.astype("datetime64[ns]").astype(np.int64) * 1e-9
    period = turns / float(record.values("frequency_hz")[-1])
    first = int(np.searchsorted(time, time[-1] - period))
    return np.arange(max(min(first, len(time) - 2) - 1, 0), len(time))


def _smooth(points_m: np.ndarray) -> np.ndarray:
    """A smooth curve through places that follow each other evenly."""
    if len(points_m) < 4:
        return points_m
    from scipy.interpolate import CubicSpline

    at = np.arange(len(points_m))
    return CubicSpline(at, points_m)(np.linspace(0, len(points_m) - 1, 12 * len(points_m)))


def _direction(record: SkipropeRecord) -> np.ndarray:
    """(2,) along the plane that is crossed next, in (U, V)."""
    azimuth = float(record.values("crossing_plane_rad")[-1, 0])
    return np.array([-np.sin(azimuth), np.cos(azimuth)])


def _plane_words(record: SkipropeRecord) -> str:
    """What the dashed plane is."""
    word = record.verdict["settings"]["plane"]
    return {"field": "the field's plane", "orbit": "the orbit's plane", "normal": "across the flight"}.get(
        word, f"plane at {word}"
    )


def _draw_ellipse(axes: Any, middle: np.ndarray, covariance: np.ndarray, reach: float) -> None:
    """Two standard deviations about a place, as a stroke where they are thin."""
    outline = _ellipse(middle, covariance)
    if 2.0 * np.sqrt(max(float(np.linalg.eigvalsh(covariance)[0]), 0.0)) > THIN * reach:
        axes.fill(*outline, color=AXIS_COLOURS[0], alpha=0.3, linewidth=0)
        return
    end = int(np.linalg.norm(outline - middle[:, None], axis=0).argmax())
    far = np.stack([outline[:, end], 2.0 * middle - outline[:, end]], axis=1)
    axes.plot(*far, color=AXIS_COLOURS[0], alpha=0.3, linewidth=THIN_STROKE, solid_capstyle="butt")


def _ellipse(middle: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """(2, k) outline of two standard deviations."""
    size, axes = np.linalg.eigh(covariance)
    circle = np.stack([np.cos(TURN), np.sin(TURN)])
    return middle[:, None] + 2.0 * axes @ (np.sqrt(np.maximum(size, 0.0))[:, None] * circle)
