"""A figure of a body that changes its orbit: height and inclination over time, as they are and as means of an orbit."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2, SECONDS_PER_DAY
from fieldline.report.run_record import DEG, RunRecord
from fieldline.report.run_strokes import COLOURS, finish, fit
from fieldline.report.series import line
from fieldline.report.theme import GREY, INK, Picture, label_outer, panels

LAW = "orbit-by-current"
LEAST_CHANGE_M = 1e3  # of the mean axis, from which on a run without lines and without the law has this figure


def orbit_picture(record: RunRecord, b: int) -> Picture | None:
    """Semi-major axis and inclination of body b, where its law changes them or where they changed much by themselves."""
    wanted = _wanted(record, b)
    if wanted is None and (record.scenario.line or record.seconds[-1] < 6000.0):  # on a line a body's own elements swing with it
        return None
    found = _elements(record, b)
    if found is None:
        return None
    axis, tilt = found
    period = 2.0 * np.pi * np.sqrt(np.median(axis) ** 3 / EARTH_GM_M3_S2)
    means = [orbit_mean(record.seconds, values, period) for values in (axis, tilt)]
    if wanted is None and not _changes(means[0]):
        return None
    figure, axes = panels(2, 1, height_in=4.6, row_gap=0.3)
    targets = wanted or {}
    for panel, values, mean, name, title, unit in (
        (axes[0, 0], 1e-3 * (axis - EARTH_EQUATORIAL_RADIUS_M), means[0], "altitude_km", "height of the semi-major axis", "km"),
        (axes[1, 0], DEG * tilt, means[1], "inclination_deg", "inclination", "deg"),
    ):
        seen = 1e-3 * (mean - EARTH_EQUATORIAL_RADIUS_M) if unit == "km" else DEG * mean
        _draw(panel, record, values, seen, targets.get(name))
        finish(panel, record, title, unit)
    label_outer(axes, (record.clock.label,))
    return Picture(
        record.tag("orbit", b),
        record.of_body("Orbit", b),
        _words(record.seconds, *means, targets),
        "Height of the semi-major axis and inclination over time, osculating and as means over an orbit.",
        figure,
    )


def orbit_mean(seconds: np.ndarray, values: np.ndarray, period_s: float) -> np.ndarray:
    """(n,) means of (n,) values over one period about each time; NaN where less than half of it is left on a side."""
    total = np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(seconds))])
    first, last = seconds - 0.5 * period_s, seconds + 0.5 * period_s
    mean = (np.interp(last, seconds, total) - np.interp(first, seconds, total)) / period_s
    return np.where((first >= seconds[0]) & (last <= seconds[-1]), mean, np.nan)


def _wanted(record: RunRecord, b: int) -> dict[str, float] | None:
    """What the law of body b wants of its orbit, or None where it has no such law."""
    for one in record.scenario.software:
        if one.law == LAW and one.body == record.bodies[b]:
            told = one.parameters
            return {name: float(told[name]) for name in ("altitude_km", "inclination_deg") if told.get(name) is not None}
    return None


def _elements(record: RunRecord, b: int) -> tuple[np.ndarray, np.ndarray] | None:
    """(n,) semi-major axis [m] and inclination [rad], or None where a state is not of an ellipse."""
    r, v = record.of("position_i", b), record.of("velocity_i", b)
    distance, h = np.linalg.norm(r, axis=1), np.cross(r, v)
    inverse = 2.0 / distance - (v * v).sum(axis=1) / EARTH_GM_M3_S2
    if not (inverse > 0.0).all():
        return None
    return 1.0 / inverse, np.arctan2(np.hypot(h[:, 0], h[:, 1]), h[:, 2])


def _changes(mean: np.ndarray) -> bool:
    """Whether the mean axis changed."""
    seen = mean[np.isfinite(mean)]
    return len(seen) > 1 and float(np.ptp(seen)) > LEAST_CHANGE_M


def _draw(panel: Any, record: RunRecord, values: np.ndarray, mean: np.ndarray, wanted: float | None) -> None:
    """Osculating, mean, and what is wanted, where it is near enough to be drawn without hiding the rest."""
    line(panel, record.time, values, GREY, "osculating", width=0.7)
    seen = np.isfinite(mean)
    shown = values
    if seen.any():
        line(panel, record.time[seen], mean[seen], COLOURS[0], "mean of an orbit", width=1.6)
    if wanted is not None and abs(wanted - float(np.median(values))) < 10.0 * float(np.ptp(values)):
        panel.axhline(wanted, color=INK, linewidth=0.9, linestyle=(0, (4, 2.5)), label="wanted")
        shown = np.append(values, wanted)
    fit(panel, shown, least=1e-4)


def _words(seconds: np.ndarray, axis: np.ndarray, tilt: np.ndarray, wanted: dict[str, float]) -> str:
    """How fast it changed, and where it is to go."""
    seen = np.flatnonzero(np.isfinite(axis))
    units = {"altitude_km": "km", "inclination_deg": "deg"}
    asked = " and ".join(f"{value:.6g} {units[name]}" for name, value in wanted.items())
    begin = f"Wanted: {asked}. " * bool(asked) + "The oblateness swings both twice an orbit; what lasts is in the means."
    if len(seen) < 2:
        return f"{begin} The run is too short for them."
    first, last = seen[0], seen[-1]
    days = (seconds[last] - seconds[first]) / SECONDS_PER_DAY
    climb, turn = 1e-3 * (axis[last] - axis[first]), DEG * (tilt[last] - tilt[first])
    return (
        f"{begin} In {24.0 * days:.3g} hours they change by {climb:+.3g} km and {turn:+.2g} deg: {climb / days:+.3g} km and "
        f"{turn / days:+.2g} deg a day."
    ).replace("-", "−")
