"""Figures of what a line carries: tension along it, heat, current and power, and how its end bodies stand to it."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.report.line_record import LineRecord, lines_of
from fieldline.report.run_line_numbers import ZERO_CELSIUS_K
from fieldline.report.run_line_shape_figures import shape_pictures
from fieldline.report.run_record import RunRecord
from fieldline.report.run_strokes import finish, fit, stroke
from fieldline.report.theme import GREY, Picture, label_outer, panels

COLUMNS = 500  # of a map over time
WITH_SCALE = 0.928  # right margin that leaves room for the scale of a map
FAR_M = 5e3


def line_pictures(record: RunRecord) -> list[Picture]:
    """Every figure of every line that has figures."""
    return [picture for line in lines_of(record) for picture in _of_line(line)]


def _of_line(line: LineRecord) -> list[Picture]:
    """The figures of one line."""
    carried = [tension_picture(line), heat_picture(line), current_picture(line), end_picture(line)]
    return shape_pictures(line) + [picture for picture in carried if picture is not None]


def tension_picture(line: LineRecord) -> Picture:
    """Tension at the ends and where it is least, and along the whole line."""
    run, tension = line.run, line.tension
    along = tension.shape[1] > 1
    figure, axes = panels(1 + along, 1, height_in=2.7 + 2.2 * along, row_gap=0.3, right=WITH_SCALE if along else 0.978)
    if along:
        last = np.isfinite(tension).sum(axis=1) - 1
        ends = (tension[:, 0], tension[np.arange(len(tension)), last], np.nanmin(tension, axis=1))
        names = (run.bodies[line.ends[0]], run.bodies[line.ends[1]])
        for k, (values, words) in enumerate(zip(ends, (f"at {names[0]}", f"at {names[1]}", "least"), strict=True)):
            stroke(axes[0, 0], run, values, k, words, width=0.9)
        _map(figure, axes[1, 0], line, tension, "N")
        axes[1, 0].set_title("along the line")
    else:
        stroke(axes[0, 0], run, tension[:, 0], 0, width=0.9)
    fit(axes[0, 0], np.append(tension.ravel(), 0.0), least=1e-9)
    finish(axes[0, 0], run, "tension", "N", keyed=along)
    label_outer(axes, (run.clock.label,))
    slack = f"; without pull in {100.0 * line.slack.mean():.3g} percent of the outputs" if line.slack.any() else ""
    return Picture(
        f"tension_{line.name}",
        f"Tension of {line.name}",
        "A line pulls where it is longer than at rest and never pushes; where the tension is zero it is slack.",
        f"Tension over time, {np.nanmin(tension):.3g} to {np.nanmax(tension):.3g} newton{slack}.",
        figure,
    )


def heat_picture(line: LineRecord) -> Picture | None:
    """Temperature: coldest, mean and hottest segment, and along the line."""
    if not line.has("temperature"):
        return None
    run, warm = line.run, line.values("temperature") - ZERO_CELSIUS_K
    along = warm.shape[1] > 1
    figure, axes = panels(1 + along, 1, height_in=2.7 + 2.2 * along, row_gap=0.3, right=WITH_SCALE if along else 0.978)
    for k, (values, words) in enumerate(
        ((np.nanmin(warm, axis=1), "coldest"), (np.nanmax(warm, axis=1), "hottest"), (np.nanmean(warm, axis=1), "mean"))
    ):
        stroke(axes[0, 0], run, values, k, words, width=0.9)
    fit(axes[0, 0], warm, least=1e-3)
    finish(axes[0, 0], run, "temperature of its segments", "°C")
    if along:
        _map(figure, axes[1, 0], line, warm, "°C")
        axes[1, 0].set_title("along the line")
    label_outer(axes, (run.clock.label,))
    return Picture(
        f"temperature_{line.name}",
        f"Temperature of {line.name}",
        "Sunlight, the Earth's light and heat, air and current warm it, radiation cools it; shaded: the Earth's shadow.",
        f"Temperature over time, {np.nanmin(warm):.3g} to {np.nanmax(warm):.3g} degrees Celsius.",
        figure,
    )


def current_picture(line: LineRecord) -> Picture | None:
    """Current, electromotive force and power, those that there are."""
    run, rows = line.run, []
    if line.has("current"):
        current = line.values("current")
        most, least = np.nanmax(current, axis=1), np.nanmin(current, axis=1)
        spread = np.max(most - least) > 1e-9 * np.max(np.abs(most))
        ends = ((most, "largest along the line"), (least, "smallest"))
        rows.append(("current, positive towards " + run.bodies[line.ends[1]], "A", ends if spread else ((most, ""),)))
    rows += [
        (words, unit, ((line.values(kind), ""),))
        for kind, words, unit in (("emf", "electromotive force", "V"), ("power", "power delivered", "W"))
        if line.has(kind) and line.values(kind).any()
    ]
    forces = [
        (1e3 * np.linalg.norm(line.values(kind), axis=1), words)
        for kind, words in (("lorentz_force_i", "of the field"), ("drag_force_i", "of the air"))
        if line.has(kind)
    ]
    if forces:
        rows.append(("force on the line", "mN", forces))
    if not rows:
        return None
    figure, axes = panels(len(rows), 1, height_in=0.95 + 1.6 * len(rows), row_gap=0.4)
    for panel, (words, unit, signals) in zip(axes[:, 0], rows, strict=True):
        for k, (values, label) in enumerate(signals):
            stroke(panel, run, values, k, label or None, width=0.9)
        fit(panel, np.stack([values for values, _ in signals]), least=1e-9)
        finish(panel, run, words, unit, keyed=any(label for _, label in signals))
    label_outer(axes, (run.clock.label,))
    shown = " · ".join(f"{words.partition(',')[0]} up to {np.nanmax(np.abs(s[0][0])):.3g} {unit}" for words, unit, s in rows)
    return Picture(
        f"current_{line.name}",
        f"Current, power and forces of {line.name}" if line.has("current") else f"Air on {line.name}",
        "The line's motion through the field drives the current; the field pushes the line back, or ahead where power is spent."
        if line.has("current") else "The air turns with the Earth; it pushes most where the line hangs lowest.",
        f"Over time: {shown}.",
        figure,
    )  # fmt: skip


def end_picture(line: LineRecord) -> Picture | None:
    """Angle between the lever of each attachment and the line."""
    angles = {run_name: angle for run_name, angle in ((_end_name(line, end), line.lever_angle_deg(end)) for end in (0, 1))
              if angle is not None}  # fmt: skip
    if not angles:
        return None
    figure, axes = panels(len(angles), 1, height_in=0.95 + 1.75 * len(angles), row_gap=0.36)
    for k, (panel, (name, angle)) in enumerate(zip(axes[:, 0], angles.items(), strict=True)):
        stroke(panel, line.run, angle, k, width=0.9)
        fit(panel, np.append(angle, 0.0), least=1e-6)
        finish(panel, line.run, name, "deg", keyed=False)
    label_outer(axes, (line.run.clock.label,))
    worst = max(float(angle.max()) for angle in angles.values())
    return Picture(
        f"ends_{line.name}",
        f"End bodies of {line.name}",
        "Angle between the lever of the attachment, from the centre of mass, and the line there: zero where the line pulls "
        "straight through the centre of mass, above 90 degrees where it wraps round the body.",
        f"Angle of the end bodies against the line over time, at most {worst:.3g} degrees.",
        figure,
    )


def _end_name(line: LineRecord, end: int) -> str:
    """The name of the body at an end."""
    return line.run.bodies[line.ends[end]]


def _map(figure: Any, axes: Any, line: LineRecord, values: np.ndarray, unit: str) -> None:
    """(n, s) values over time and along the line, as an image with its scale; empty where the line is not out."""
    size = -(-len(values) // COLUMNS)
    starts = np.arange(0, len(values), size)
    some = np.isfinite(values)
    total = np.add.reduceat(np.where(some, values, 0.0), starts, axis=0)
    count = np.add.reduceat(some.astype(float), starts, axis=0)
    mean = np.where(count > 0.0, total / np.maximum(count, 1.0), np.nan)
    edges = np.append(line.run.time[starts], line.run.time[-1])
    length = line.spacing_m * np.arange(values.shape[1] + 1)
    metre, factor = ("km", 1e-3) if length[-1] > FAR_M else ("m", 1.0)
    drawn = axes.pcolormesh(edges, factor * length, np.ma.masked_invalid(mean.T), cmap="cividis", rasterized=True)
    axes.set_xlim(line.run.time[0], line.run.time[-1])
    axes.set_ylabel(f"from {_end_name(line, 0)}  [{metre}]")
    axes.grid(False)
    axes.spines[["left", "bottom"]].set_color(GREY)
    box = axes.get_position()
    scale = figure.add_axes((box.x1 + 0.008, box.y0, 0.010, box.height))
    figure.colorbar(drawn, cax=scale).outline.set_visible(False)
    scale.set_title(unit, fontsize=8.0, loc="left")
