"""Figures of several bodies: how far apart, how they move about the first one, and how hard their lines pull."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.report.decimation import cloud
from fieldline.report.geometry import orbital_axes_i
from fieldline.report.line_record import lines_of
from fieldline.report.run_record import MOST_BODIES, RunRecord
from fieldline.report.run_strokes import COLOURS, finish, fit, stroke
from fieldline.report.theme import INK, Picture, label_outer, panels

PATH_DOTS = 4000
STEADY = 1e-4  # share of a distance within which its changes alone are drawn


def separation_picture(record: RunRecord) -> Picture | None:
    """Distances from the first body, and the pull of lines on each body."""
    others = range(1, min(len(record.bodies), MOST_BODIES + 1))
    if not others:
        return None
    pulls = line_pulls(record)
    figure, axes = panels(1 + bool(pulls), 1, height_in=2.7 + 1.9 * bool(pulls), row_gap=0.32)
    place = record.values("position_i")
    distances = np.stack([np.linalg.norm(place[:, b] - place[:, 0], axis=1) for b in others], axis=1)
    less, words, (unit, factor) = 0.0, "", _length_unit(distances)
    if len(others) == 1 and np.ptp(distances) < STEADY * distances.max():
        less, unit, factor = float(np.median(distances)), "mm", 1e3
        words = f", less {less:,.3f} m"
    for b in others:
        stroke(axes[0, 0], record, factor * (distances[:, b - 1] - less), b - 1, record.bodies[b])
    finish(axes[0, 0], record, f"distance of centres from {record.bodies[0]}{words}", unit)
    for b, pull in pulls.items():
        stroke(axes[1, 0], record, pull, b, record.bodies[b], width=0.8)
    if pulls:
        fit(axes[1, 0], np.stack(list(pulls.values())), least=1e-9)
        finish(axes[1, 0], record, "pull of the lines on each body", "N")
    label_outer(axes, (record.clock.label,))
    strongest = max((float(pull.max()) for pull in pulls.values()), default=0.0)
    return Picture(
        "separation",
        "Separation" + (" and tension" if pulls else ""),
        "A line pulls where it is longer than at rest and is slack, without any pull, where it is shorter." if pulls else
        "Bodies on neighbouring orbits drift along the track unless their periods agree.",
        f"Distance between bodies over time; the strongest pull of a line is {strongest:.3g} newton.",
        figure,
    )  # fmt: skip


def line_pulls(record: RunRecord) -> dict[int, np.ndarray]:
    """(n,) [N] pull of all lines together on each body that they are tied to; of one line's bodies the first alone.

    The tension is taken, not the load "lines" of the run: that has the weight of the half segments at the ends in it.
    """
    pulls: dict[int, np.ndarray] = {}
    for line in lines_of(record):
        for end, b in enumerate(line.ends):
            pulls[b] = pulls.get(b, 0.0) + line.pull_i(end)
    pulled = sorted(pulls)[:MOST_BODIES]
    return {b: np.linalg.norm(pulls[b], axis=1) for b in (pulled[:1] if len(record.scenario.line) == 1 else pulled)}


def relative_picture(record: RunRecord) -> Picture | None:
    """Paths of the other bodies about the first, in its orbital plane and across it."""
    others = range(1, min(len(record.bodies), MOST_BODIES + 1))
    if not others:
        return None
    paths = {b: relative_o(record, b) for b in others}
    unit, factor = _length_unit(np.linalg.norm(np.concatenate(list(paths.values())), axis=1))
    figure, axes = panels(1, 2, height_in=4.4, column_gap=0.24)
    for b, path in paths.items():
        _draw_path(axes[0, 0], factor * path[:, 0], -factor * path[:, 2], b, record.bodies[b])
        _draw_path(axes[0, 1], factor * path[:, 1], -factor * path[:, 2], b, None)
    for one, title, label in (
        (axes[0, 0], "in the orbital plane", "along the track"),
        (axes[0, 1], "across it", "against the orbit normal"),
    ):
        one.plot(0.0, 0.0, marker="+", color=INK, markersize=9)
        one.set_title(title)
        one.set_xlabel(f"{label}  [{unit}]")
        _square(one)
    axes[0, 0].set_ylabel(f"up  [{unit}]")
    if len(paths) > 1:
        from fieldline.report.series import legend

        legend(axes[0, 0])
    return Picture(
        "relative",
        f"Motion about {record.bodies[0]}",
        f"Seen from {record.bodies[0]} (+), in its orbital axes; dots: the starts. Both scales are the same in each panel.",
        "Paths of the other bodies relative to the first, in the orbital plane and across it.",
        figure,
    )


def relative_o(record: RunRecord, b: int) -> np.ndarray:
    """(n, 3) [m] place of body b from the first, in the first's orbital axes."""
    place, velocity = record.of("position_i", 0), record.of("velocity_i", 0)
    return np.einsum("nij,nj->ni", orbital_axes_i(place, velocity), record.of("position_i", b) - place)


def _draw_path(axes: Any, x: np.ndarray, y: np.ndarray, b: int, label: str | None) -> None:
    """A path with its start marked, thinned where there are more dots than pixels."""
    keep = cloud(x, y) if len(x) > PATH_DOTS else slice(None)
    colour = COLOURS[(b - 1) % len(COLOURS)]
    axes.plot(x[keep], y[keep], color=colour, linewidth=0.8, label=label)
    axes.plot(x[0], y[0], marker="o", color=colour, markersize=4.5)


def _square(axes: Any) -> None:
    """Equal scales, with room in the narrow direction."""
    (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
    half = 0.55 * max(x1 - x0, y1 - y0)
    box = axes.get_position()
    width, height = box.width * axes.figure.get_figwidth(), box.height * axes.figure.get_figheight()
    scale = half / min(width, height)
    middle_x, middle_y = 0.5 * (x0 + x1), 0.5 * (y0 + y1)
    axes.set_xlim(middle_x - scale * width, middle_x + scale * width)
    axes.set_ylim(middle_y - scale * height, middle_y + scale * height)


def _length_unit(metres: np.ndarray) -> tuple[str, float]:
    """Metres, or kilometres where the greatest is above 5 km."""
    return ("km", 1e-3) if float(np.max(metres)) > 5e3 else ("m", 1.0)
