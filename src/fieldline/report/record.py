"""An estimate's Dataset as the arrays that figures draw: read once, in the units of the page (µT, deg, deg/s, min)."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

MICROTESLA = 1e6


class TimeAxis:
    """What follows from `time_utc` (n,) datetime64[ns]: seconds, and the axis that figures draw against."""

    time_utc: np.ndarray

    @cached_property
    def seconds(self) -> np.ndarray:
        """(n,) [s] since the first sample."""
        return (self.time_utc - self.time_utc[0]).astype(np.int64) * 1e-9

    @cached_property
    def clock(self) -> Clock:
        """The time axis of the whole arc."""
        return Clock.of(self.time_utc[0], float(self.seconds[-1]))

    @cached_property
    def time(self) -> np.ndarray:
        """(n,) time in the clock's unit."""
        return self.seconds / self.clock.unit_s

    @cached_property
    def step_s(self) -> float:
        """The median step [s]."""
        return float(np.median(np.diff(self.seconds))) if len(self.seconds) > 1 else 1.0

    @cached_property
    def widest(self) -> float:
        """The widest step, in the clock's unit, that a line is drawn over."""
        return 5.5 * self.step_s / self.clock.unit_s


@dataclass(frozen=True)
class Record(TimeAxis):
    """A Dataset of `estimate_attitude` with its time axis and its verdict."""

    dataset: Any

    @cached_property
    def time_utc(self) -> np.ndarray:
        """(n,) datetime64[ns]."""
        return self.dataset["time"].values.astype("datetime64[ns]")

    @cached_property
    def verdict(self) -> dict[str, Any]:
        """The machine-readable verdict."""
        return json.loads(self.dataset.attrs.get("verdict_json", "{}"))

    @cached_property
    def provenance(self) -> dict[str, Any]:
        """What made the estimate: versions, hashes, settings."""
        return json.loads(self.dataset.attrs.get("provenance_json", "{}"))

    @cached_property
    def used(self) -> np.ndarray:
        """(n,) bool: samples that the estimator used."""
        return self.dataset["used"].values.astype(bool) if self.has("used") else np.ones(len(self.seconds), dtype=bool)

    def has(self, *names: str) -> bool:
        """Whether the Dataset carries all of these variables."""
        return all(name in self.dataset for name in names)

    def values(self, name: str, factor: float = 1.0) -> np.ndarray:
        """A variable times a factor, as floats, time first."""
        return np.asarray(self.dataset[name].values, dtype=float) * factor

    def minute(self) -> slice:
        """A short window in the middle of the used samples: a minute, or 40 steps where sampling is slower."""
        n = len(self.seconds)
        length = max(60.0, 40.0 * self.step_s)
        used = np.flatnonzero(self.used)
        middle = self.seconds[used[len(used) // 2]] if len(used) else self.seconds[n // 2]
        first = int(np.searchsorted(self.seconds, middle - 0.5 * length))
        last = int(np.searchsorted(self.seconds, middle + 0.5 * length, side="right"))
        return slice(first, max(last, min(first + 2, n)))


@dataclass(frozen=True)
class MagnitudeRecord(TimeAxis):
    """Magnitudes over time [µT]: as the file gives them, after calibration, and the model's; used (n,) bool."""

    time_utc: np.ndarray
    before: np.ndarray
    after: np.ndarray
    model: np.ndarray
    used: np.ndarray


def dark_spells(seconds: np.ndarray, sunlit: np.ndarray) -> list[tuple[float, float]]:
    """Start and stop [s] of each stay where less than half of the Sun is seen."""
    dark = np.concatenate([[False], sunlit < 0.5, [False]])
    edges = np.flatnonzero(dark[1:] != dark[:-1])
    return [(float(seconds[a]), float(seconds[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def lengths(vectors: np.ndarray) -> np.ndarray:
    """(n,) lengths of (n, 3)."""
    return np.sqrt(np.einsum("ij,ij->i", vectors, vectors))


@dataclass(frozen=True)
class Clock:
    """A time axis: what one unit is in seconds, and the words beside the axis."""

    unit_s: float
    label: str

    @staticmethod
    def of(start_utc: np.datetime64, length_s: float) -> Clock:
        """Seconds, minutes, hours or days, as suits the length."""
        units = ((1.0, "s", 300.0), (60.0, "min", 5 * 3600.0), (3600.0, "h", 4 * 86400.0), (86400.0, "days", np.inf))
        unit_s, word, _ = next(unit for unit in units if length_s <= unit[2])
        return Clock(unit_s, f"{word} after {np.datetime_as_string(start_utc, unit='s').replace('T', ' ')} UTC")
