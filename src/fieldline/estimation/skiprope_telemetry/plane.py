"""The vertical plane whose crossings are asked for.

    "field"    the plane of the vertical and the Earth's field, which turns along the orbit (rule 3 of TP-3123)
    "orbit"    the plane of the orbit, azimuth -90 deg: towards is ahead, along the velocity
    "normal"   the plane across the flight, azimuth 0: towards is along the orbit's normal
    a number   the azimuth in degrees, from the orbit's normal towards against the flight

A plane that turns is met where the tether's azimuth reaches the plane's of that moment; beyond the last sample the field's
azimuth is carried on at its last rate. The field's direction is taken to be known to 2 deg, which is that times the tangent of
its elevation in its azimuth, besides the floor that yaw and azimuth share: where the field is steep its plane is badly known, and
the deviations of its crossings are larger.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, nearest
from fieldline.estimation.skiprope.signals import SkipropeSignals
from fieldline.estimation.skiprope.solution import SkipropeEstimate

NAMED_DEG = {"orbit": -90.0, "normal": 0.0}
PASSES = 4  # for a plane that turns: each takes the error down by its rate over the tether's, a hundredth or so
LAST_S = 120.0  # over which the last rate is taken
COUNT = 3
MOST_DOUBT_RAD = np.pi / np.sqrt(12.0)  # of a plane of which nothing is known


class Crossings(NamedTuple):
    """Of m rows, (m, 3): [s] of the next crossings, their standard deviations, whether towards, and the plane's azimuth."""

    seconds: np.ndarray
    std_s: np.ndarray
    towards: np.ndarray
    plane_rad: np.ndarray


@dataclass(frozen=True)
class Plane:
    """A plane by its word or azimuth [deg]; made by `plane_of`."""

    word: str
    azimuth_deg: float | None  # None: the field's

    def azimuth_rad(self, seconds, signals: SkipropeSignals) -> np.ndarray:
        """The plane's azimuth at times [s]."""
        times = np.asarray(seconds, dtype=float)
        if self.azimuth_deg is not None:
            return np.full(times.shape, np.radians(self.azimuth_deg))
        known = np.unwrap(signals.geometry.azimuth_rad)
        last = signals.seconds[-1]
        kept = signals.seconds >= last - LAST_S
        rate = np.polyfit(signals.seconds[kept] - last, known[kept], 1)[0] if kept.sum() > 1 else 0.0
        return np.interp(times, signals.seconds, known) + rate * np.maximum(times - last, 0.0)

    def doubt_rad(self, seconds, signals: SkipropeSignals) -> np.ndarray:
        """Standard deviation of the plane's azimuth at times [s], besides the floor."""
        from fieldline.estimation.skiprope.estimate import USUAL

        times = np.asarray(seconds, dtype=float)
        if self.azimuth_deg is not None:
            return np.zeros(times.shape)
        steep = np.interp(times, signals.seconds, np.abs(np.tan(signals.geometry.elevation_rad)))
        return np.minimum(USUAL.elevation_rad * steep, MOST_DOUBT_RAD)


def plane_of(given) -> Plane:
    """The plane that a word or a number of degrees names."""
    text = str(given).strip().lower()
    if text == "field":
        return Plane("field", None)
    if text in NAMED_DEG:
        return Plane(text, NAMED_DEG[text])
    try:
        azimuth = float(text)
    except ValueError:
        azimuth = np.nan
    if not np.isfinite(azimuth) or abs(azimuth) > 360.0:
        raise InputError(
            f'plane "{given}" is neither field, orbit, normal nor an azimuth in degrees; {nearest(text, ("field", *NAMED_DEG))}'
        )
    return Plane(f"{azimuth:g} deg", azimuth)


def next_crossings(estimate: SkipropeEstimate, signals: SkipropeSignals, plane: Plane, half_turn_rad: float = np.pi) -> Crossings:
    """The next three crossings after each row of the estimate; none where nothing was detected.

    half_turn_rad : from the lean to the tether, pi as the estimate takes it, 0 for a tether that goes up.
    """
    rows = len(estimate.seconds) if estimate.detected else 0
    seconds, std, side = np.empty((rows, COUNT)), np.empty((rows, COUNT)), np.empty((rows, COUNT), dtype=bool)
    azimuth = np.empty((rows, COUNT))
    if not rows:
        return Crossings(seconds, std, side, azimuth)
    everything = slice(0, rows)
    floor = estimate.yaw_std_rad
    for k in range(COUNT):
        at = estimate.seconds
        for _ in range(PASSES if plane.azimuth_deg is None else 1):
            azimuth[:, k] = plane.azimuth_rad(at, signals)
            doubtful = replace(estimate, yaw_std_rad=np.hypot(floor, plane.doubt_rad(at, signals)))
            with np.errstate(divide="ignore", invalid="ignore"):  # a row without any deflection crosses nothing
                found = doubtful.crossings(azimuth[:, k], COUNT + 1, row=everything)
            at = _later(found.seconds, at, k, estimate)
        pick = np.abs(found.seconds - at[:, None]).argmin(axis=1)
        index = np.arange(rows)
        seconds[:, k], std[:, k], side[:, k] = at, found.std_s[index, pick], found.towards[index, pick]
    return Crossings(seconds, std, side ^ (half_turn_rad == 0.0), azimuth)


def _later(times: np.ndarray, before: np.ndarray, k: int, estimate: SkipropeEstimate) -> np.ndarray:
    """Of each row's crossings the one that the search is after: the k-th at first, then the nearest to the last found."""
    if np.array_equal(before, estimate.seconds):
        return times[:, k]
    return times[np.arange(len(times)), np.abs(times - before[:, None]).argmin(axis=1)]
