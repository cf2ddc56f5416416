"""The ground track on a plain graticule, coloured by the size of the residual, with the night side at mid-arc."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.report.geometry import terminator_latitude_deg
from fieldline.report.record import Record
from fieldline.report.theme import AXIS_COLOURS, GREY, INK, WARM, Picture, panels

DOTS = 1500  # along the track; each shows the mean of its share of the samples


def track_picture(record: Record) -> Picture:
    """Latitude against longitude; colour is the length of the residual, averaged along the track."""
    longitude, latitude, size = _thinned(record)
    figure, axes = panels(1, 1, height_in=4.7, right=0.9)
    one = axes[0, 0]
    _draw_night(one, record)
    ordered = np.argsort(size)
    limit = float(np.quantile(size, 0.98)) if len(size) else 1.0
    dots = one.scatter(
        longitude[ordered],
        latitude[ordered],
        c=size[ordered],
        s=9,
        cmap="viridis",
        vmin=0.0,
        vmax=limit,
        linewidths=0,
        rasterized=True,
    )
    _draw_ends(one, record)
    one.set_xlim(-180, 180)
    one.set_ylim(-90, 90)
    one.set_xticks(range(-180, 181, 30))
    one.set_yticks(range(-90, 91, 30))
    one.set_xlabel("longitude [deg east]")
    one.set_ylabel("latitude [deg north]")
    bar = figure.colorbar(dots, cax=figure.add_axes((0.915, 0.25, 0.014, 0.5)), extend="max")
    bar.set_label("|residual|  [nT]")
    bar.outline.set_visible(False)
    return Picture(
        "track",
        "Ground track",
        "Residuals that are large at high latitude are currents in the ionosphere, which no main-field model knows; those that "
        "begin at the edge of night (shaded at mid-arc) point to temperature or to solar-panel currents.",
        f"Ground track between latitudes {latitude.min():.0f} and {latitude.max():.0f} degrees, coloured by residual.",
        figure,
    )


def _thinned(record: Record) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Longitude, latitude [deg] and RMS residual [nT] of at most `DOTS` pieces of the track."""
    length = np.linalg.norm(record.values("residual_b", 1e9), axis=1)
    used = np.flatnonzero(record.used & np.isfinite(length))
    if not len(used):
        used, length = np.arange(len(length)), np.zeros_like(length)
    size = -(-len(used) // DOTS)
    starts = np.arange(0, len(used), size)
    counts = np.diff(np.append(starts, len(used)))
    rms = np.sqrt(np.add.reduceat(length[used] ** 2, starts) / counts)
    middle = used[starts + counts // 2]
    return record.values("longitude_deg")[middle], record.values("latitude_deg")[middle], rms


def _draw_ends(axes: Any, record: Record) -> None:
    """Where the arc starts and stops."""
    longitude, latitude = record.values("longitude_deg"), record.values("latitude_deg")
    for k, word, colour in ((0, "start", AXIS_COLOURS[2]), (-1, "end", AXIS_COLOURS[1])):
        axes.plot(longitude[k], latitude[k], marker="o", markersize=6, color=colour, markeredgecolor="white")
        side = -8 if longitude[k] > 120 else 8
        axes.annotate(
            word,
            (longitude[k], latitude[k]),
            (side, 4),
            textcoords="offset points",
            ha="right" if side < 0 else "left",
            color=INK,
        )


def _draw_night(axes: Any, record: Record) -> None:
    """The night side and the place under the Sun at mid-arc; the Earth's angle is that between track and orbit."""
    middle = len(record.seconds) // 2
    position, sun = record.values("position_i")[middle], record.values("sun_i")[middle]
    turned = np.degrees(np.arctan2(position[1], position[0])) - record.values("longitude_deg")[middle]
    sun_longitude = (np.degrees(np.arctan2(sun[1], sun[0])) - turned + 180.0) % 360.0 - 180.0
    sun_latitude = float(np.degrees(np.arcsin(sun[2] / np.linalg.norm(sun))))
    longitude = np.linspace(-180.0, 180.0, 181)
    edge = terminator_latitude_deg(longitude, sun_longitude, sun_latitude)
    axes.fill_between(longitude, edge, -90.0 if sun_latitude > 0 else 90.0, color=GREY, alpha=0.18, linewidth=0)
    axes.plot(sun_longitude, sun_latitude, marker="o", markersize=9, color=WARM, linestyle="none")
    axes.annotate("Sun", (sun_longitude, sun_latitude), (7, 5), textcoords="offset points", color=INK)
