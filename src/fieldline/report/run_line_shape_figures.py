"""Figures of how a line hangs: snapshots in orbital axes, librations, the bow that goes round."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.analysis.line_shape import STRAIGHT
from fieldline.report.decimation import cloud
from fieldline.report.line_record import LineRecord
from fieldline.report.run_record import DEG
from fieldline.report.run_strokes import finish, fit, stroke
from fieldline.report.theme import AXIS_COLOURS, FOURTH, INK, WARM, Picture, label_outer, panels

SNAPSHOTS = 13
BEGIN, MIDDLE, END = AXIS_COLOURS[0], FOURTH, WARM  # colours of time, told apart on white and on black
PATH_DOTS = 6000
FAR_M = 5e3
SHORT_M = 0.1  # of a stretch, drawn in millimetres below it


def shape_pictures(line: LineRecord) -> list[Picture]:
    """All that a line has the signals for."""
    found = [snapshot_picture(line), libration_picture(line), skiprope_picture(line)]
    return [picture for picture in found if picture is not None]


def snapshot_picture(line: LineRecord) -> Picture:
    """The line at some times: as it is, and its deflection from the chord."""
    shape, run = line.shape, line.run
    rows = 2 if shape.bows else 1
    figure, axes = panels(
        rows, 2, height_in=4.1 + 2.6 * (rows - 1), heights=(1.5, 1.0)[:rows], row_gap=0.34, column_gap=0.24, right=0.965
    )
    shown = np.unique(np.linspace(0, len(run.seconds) - 1, SNAPSHOTS).astype(int))
    unit, factor = ("km", 1e-3) if shape.chord_m.max() > FAR_M else ("m", 1.0)
    for k in shown:
        out = np.isfinite(shape.point_o[k, :, 0])
        point, colour = factor * shape.point_o[k, out], time_colour(run.seconds[k] / run.seconds[-1])
        for column, across in enumerate((0, 1)):
            axes[0, column].plot(point[:, across], -point[:, 2], color=colour, linewidth=1.0)
            axes[0, column].plot(point[[0, -1], across], -point[[0, -1], 2], color=colour, linestyle="none", marker=".")
            if shape.bows:
                place = factor * shape.along_m[k, out]
                axes[1, column].plot(
                    place, shape.deflection_m[k, out, column], color=colour, linewidth=1.0, marker=".", markersize=3
                )
    for column, (title, label) in enumerate(
        (("in the orbital plane", "along the track"), ("across it", "against the orbit normal"))
    ):
        equal_scales(axes[0, column])
        axes[0, column].set_title(title)
        axes[0, column].set_xlabel(f"{label}  [{unit}]")
        if shape.bows:
            axes[1, column].set_title("deflection from the chord, " + ("in the plane" if column == 0 else "across it"))
            axes[1, column].set_ylabel("[m]")
            axes[1, column].set_xlabel(f"along the chord, from {run.bodies[line.ends[0]]}  [{unit}]")
            fit(axes[1, column], shape.deflection_m[shown, :, column], least=1e-6)
    axes[0, 0].set_ylabel(f"up  [{unit}]")
    _time_key(axes[0, 1], run.clock.label, run.time[-1])
    deflected = f"; at most {shape.largest_m.max():.3g} metres from the chord" if shape.bows else ""
    return Picture(
        f"shape_{line.name}",
        f"Shape of {line.name}",
        f"{len(shown)} moments evenly spaced over the run, from the mass centre of the bodies at the ends in its orbital axes"
        + (", above to scale, below with the deflection magnified." if shape.bows else ", to scale."),
        f"The line {line.name} at {len(shown)} moments, in the orbital plane and across it{deflected}.",
        figure,
    )


def libration_picture(line: LineRecord) -> Picture:
    """Angles of the chord, its length, the height of the lowest point."""
    shape, run = line.shape, line.run
    figure, axes = panels(3 + line.reels, 1, height_in=5.9 + 1.5 * line.reels, row_gap=0.36)
    angles = DEG * np.stack([shape.in_plane_rad, shape.across_rad], axis=1)
    for k, words in enumerate(("in the plane", "across it")):
        stroke(axes[0, 0], run, angles[:, k], k, words)
    fit(axes[0, 0], angles, least=1e-3)
    finish(axes[0, 0], run, "angle of the chord from the vertical", "deg")
    _length(line, axes[1, 0])
    if line.reels:
        stroke(axes[2, 0], run, line.values("feed_rate"), 1)
        fit(axes[2, 0], line.values("feed_rate"), least=1e-3)
        finish(axes[2, 0], run, "rate at which it is paid out", "m/s", keyed=False)
    lowest = 1e-3 * np.nanmin(line.height, axis=1)
    stroke(axes[-1, 0], run, lowest, 2)
    fit(axes[-1, 0], lowest, least=1e-3)
    finish(axes[-1, 0], run, "height of its lowest point over the ground", "km", keyed=False)
    label_outer(axes, (run.clock.label,))
    most = np.abs(angles).max(axis=0)
    return Picture(
        f"libration_{line.name}",
        f"Libration and length of {line.name}",
        "In the plane positive with the lower end ahead, across it positive against the orbit normal. Left alone on a circular "
        "orbit a taut line swings at 1.73 times the orbital rate in the plane and at twice that rate across it.",
        f"Librations over time, at most {most[0]:.3g} degrees in the plane and {most[1]:.3g} across it.",
        figure,
    )


def _length(line: LineRecord, axes: Any) -> None:
    """Distance of the ends: with the unstretched length where that changes, less it where it does not."""
    chord = line.shape.chord_m
    if line.reels:
        unit, factor = ("km", 1e-3) if chord.max() > FAR_M else ("m", 1.0)
        stroke(axes, line.run, factor * line.length, 1, "unstretched, out", width=1.6)
        stroke(axes, line.run, factor * chord, 0, "between its ends", width=0.8)
        fit(axes, factor * np.stack([chord, line.length]), least=1e-6)
        finish(axes, line.run, "length", unit)
        return
    longer = chord - line.length
    unit, factor = ("mm", 1e3) if np.abs(longer).max() < SHORT_M else ("m", 1.0)
    stroke(axes, line.run, factor * longer, 0)
    fit(axes, factor * longer, least=1e-3)
    finish(axes, line.run, f"distance of its ends, less its unstretched {line.length[0]:,.6g} m", unit, keyed=False)


def skiprope_picture(line: LineRecord) -> Picture | None:
    """The first half wave of the deflection: how large, which way round, how fast, and its path."""
    found, run = line.skiprope, line.run
    if found is None:
        return None
    figure, axes = panels(3, 2, height_in=5.2, widths=(1.55, 1.0), row_gap=0.4, column_gap=0.2, right=0.965)
    for k, (values, words) in enumerate(((found.semi_major_m, "larger semi-axis"), (found.semi_minor_m, "smaller"))):
        stroke(axes[0, 0], run, values, k, words)
    fit(axes[0, 0], np.stack([found.semi_major_m, found.semi_minor_m, 0.0 * found.semi_minor_m]), least=1e-6)
    finish(axes[0, 0], run, "skiprope", "m")
    stroke(axes[1, 0], run, found.sense, 2)
    axes[1, 0].set_ylim(-1.15, 1.15)
    finish(axes[1, 0], run, "sense: 1 right-handed about the line downwards, −1 left-handed", "", keyed=False)
    swings = found.semi_major_m > STRAIGHT * line.shape.chord_m
    period = np.where(swings, 2.0 * np.pi / np.maximum(found.rate_rad_s, 1e-9), np.nan)
    stroke(axes[2, 0], run, period, 3)
    fit(axes[2, 0], period, least=1e-3)
    finish(axes[2, 0], run, "period", "s", keyed=False)
    label_outer(axes[:, :1], (run.clock.label,))
    _bow_path(figure, axes, line)
    return Picture(
        f"skiprope_{line.name}",
        f"Skiprope of {line.name}",
        "The first half wave of the deflection about its mean over a period, as an ellipse: a circle where both semi-axes agree, "
        "a swing in one plane where the smaller is zero. Right: the path of that half wave, seen from above.",
        f"Amplitude, sense and period of the skiprope over time; at most {found.semi_major_m.max():.3g} metres.",
        figure,
    )


def _bow_path(figure: Any, axes: Any, line: LineRecord) -> None:
    """The half wave in the plane and across it, on the right of the figure."""
    place = axes[0, 1].get_gridspec()[:2, 1]
    for one in axes[:, 1]:
        one.remove()
    panel = figure.add_subplot(place)
    bow, seconds = line.shape.bow_m, line.run.seconds
    keep = cloud(bow[:, 0], bow[:, 1]) if len(bow) > PATH_DOTS else np.arange(len(bow))
    for part in np.array_split(keep, 24):
        if len(part):
            reach = np.append(part, min(part[-1] + 1, len(bow) - 1))
            panel.plot(bow[reach, 0], bow[reach, 1], color=time_colour(seconds[part[0]] / seconds[-1]), linewidth=0.6)
    panel.plot(0.0, 0.0, marker="+", color=INK, markersize=8)
    panel.set_title("path of the half wave")
    panel.set_xlabel("in the plane  [m]")
    panel.set_ylabel("across it  [m]")
    equal_scales(panel)
    panel.invert_yaxis()  # from above, with the flight to the right, the orbit's normal is up


def time_colour(share: float) -> str:
    """The colour of a time, 0 at the start and 1 at the end."""
    from matplotlib.colors import to_hex, to_rgb

    stops = np.array([to_rgb(one) for one in (BEGIN, MIDDLE, END)])
    red, green, blue = (float(np.interp(share, (0.0, 0.5, 1.0), stops[:, k])) for k in range(3))
    return to_hex((red, green, blue))


def equal_scales(axes: Any) -> None:
    """Equal scales, with room in the narrow direction."""
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)


def _time_key(axes: Any, label: str, last: float) -> None:
    """A small key of the colours of time."""
    for share in (0.0, 0.5, 1.0):
        axes.plot([], [], color=time_colour(share), linewidth=2.0, label=f"{share * last:.3g}")
    axes.legend(loc="upper right", title=label.split(" after ", maxsplit=1)[0], title_fontsize=8.0)
