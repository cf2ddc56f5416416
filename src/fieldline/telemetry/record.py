"""Telemetry: what a file of attitude sensors says, in SI units, with an account of how it was read.

Axes: `b` are the magnetometer's axes as the file gives them; `field_s` is the raw reading on the same axes before
calibration. A sample that `usable` marks False stays in its place, so that nothing shifts in time.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

import numpy as np

from fieldline.errors import InputError


@dataclass(frozen=True, slots=True, kw_only=True)
class Recognised:
    """One column of the file and what it was taken for: value in SI = factor * (number in the file) + offset."""

    column: str
    quantity: str
    axis: str = ""
    unit: str = ""
    factor: float = 1.0
    offset: float = 0.0
    why: str = "by its name"


@dataclass(frozen=True, slots=True, kw_only=True)
class Quality:
    """What was found wrong with the samples, counted; `step_s` is the median step and a gap is over 1.5 of it."""

    samples: int
    usable: int
    step_s: float
    gaps: int = 0
    missing_s: float = 0.0
    longest_gap_s: float = 0.0
    repeated: int = 0
    unordered: int = 0
    unreadable: int = 0
    nan: int = 0
    sentinel: int = 0
    stuck: int = 0
    held: int = 0
    saturated: int = 0
    spikes: int = 0
    notes: tuple[str, ...] = ()

    def sentences(self) -> list[str]:
        """The account in words: always the size and the gaps, then each fault that was found."""
        lines = [f"{self.samples:,} samples, {self.usable:,} of them usable, every {self.step_s:.6g} s"]
        if self.gaps:
            lines.append(
                f"{_count(self.gaps, 'gap')}, {self.missing_s:.6g} missing seconds, the longest {self.longest_gap_s:.6g} s"
            )
        for number, one, what in (
            (self.unreadable, "row", "that could not be read, dropped by repair"),
            (self.unordered, "time stamp", "out of order, sorted by repair"),
            (self.repeated, "repeated time stamp", "dropped by repair (the first of each is kept)"),
            (self.nan, "sample", "without a finite field, not used"),
            (self.sentinel, "sample", "with a fill value (all zeros, -9999, 32767 …), not used"),
            (self.stuck, "sample", "of a stuck sensor, not used"),
            (self.held, "sample", "that only hold the value before (the sensor is slower than the log), not used"),
            (self.saturated, "sample", "at the end of the sensor's range, not used"),
            (self.spikes, "spike", "far from its neighbours, not used"),
        ):
            if number:
                lines.append(f"{_count(number, one)} {what}")
        return lines + list(self.notes)


def _count(number: int, noun: str) -> str:
    """1 gap, 2,000 gaps."""
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Telemetry:
    """Samples of one satellite's attitude sensors.

    time_utc (n,) datetime64[ns], strictly increasing; field_s (n, 3) [T], raw, magnetometer's axes; usable (n,) bool;
    rate_b (n, 3) [rad/s] or None: rate gyro; sun_sensor: face ("-x", "+y" …) to raw readings (n,);
    dipole_command_b (n, 3) [A m2] or None; wheel_speed: name to (n,) [rad/s]; temperature_k (n,) [K] or None;
    position_e (n, 3) [m] ITRS or None; solar_current (n,) [A] or None; yaw_rad (n,) [rad] or None, the body's yaw about
    nadir against the orbital axes, by a sensor besides; recognition: column by column what was read as
    what; ignored: sentences on columns that looked useful and were not used; name and sha256 of the file.
    """

    time_utc: np.ndarray
    field_s: np.ndarray
    usable: np.ndarray
    rate_b: np.ndarray | None = None
    sun_sensor: dict[str, np.ndarray] = field(default_factory=dict)
    dipole_command_b: np.ndarray | None = None
    wheel_speed: dict[str, np.ndarray] = field(default_factory=dict)
    temperature_k: np.ndarray | None = None
    position_e: np.ndarray | None = None
    solar_current: np.ndarray | None = None
    yaw_rad: np.ndarray | None = None
    recognition: tuple[Recognised, ...] = ()
    ignored: tuple[str, ...] = ()
    quality: Quality
    name: str = "telemetry"
    sha256: str = ""

    def __post_init__(self):
        count = len(self.time_utc)
        if self.field_s.shape != (count, 3) or self.usable.shape != (count,):
            raise InputError(
                f"telemetry needs field_s (n, 3) and usable (n,) for {count} times; "
                f"got {self.field_s.shape} and {self.usable.shape}."
            )

    def __len__(self) -> int:
        return len(self.time_utc)

    @property
    def epoch_utc(self) -> np.datetime64:
        """The first sample's time, from which `seconds` counts."""
        return self.time_utc[0]

    @property
    def seconds(self) -> np.ndarray:
        """(n,) [s] since the first sample."""
        return (self.time_utc - self.time_utc[0]).astype(np.int64) * 1e-9

    @property
    def median_step_s(self) -> float:
        """[s] the usual time from one sample to the next."""
        return self.quality.step_s

    def slice(self, start: int | None = None, stop: int | None = None) -> Telemetry:
        """Samples start to stop (as Python counts), with every column; the quality account stays that of the file."""
        part = slice(start, stop)
        if len(self.time_utc[part]) == 0:
            raise InputError(f"slice({start}, {stop}) of {len(self)} samples is empty.")
        return self._each(lambda column: column[part])

    def rows(self, rows: slice) -> Telemetry:
        """The samples of a slice, steps and all, with every column; the median step is that of the samples taken."""
        taken = self._each(lambda column: column[rows])
        step = self.quality.step_s * (rows.step or 1)
        return dataclasses.replace(taken, quality=dataclasses.replace(self.quality, step_s=step))

    def _each(self, of) -> Telemetry:
        """A copy with `of` applied to every column."""

        def every(value):
            if isinstance(value, dict):
                return {key: of(column) for key, column in value.items()}
            return of(value) if isinstance(value, np.ndarray) else value

        changes = {f.name: every(getattr(self, f.name)) for f in dataclasses.fields(self)}
        return Telemetry(**changes)

    def recognised(self) -> list[str]:
        """What was read as what, a sentence for each quantity and unit."""
        groups: dict[tuple[str, str, str], list[Recognised]] = {}
        for record in self.recognition:
            groups.setdefault((record.quantity, record.unit, record.why), []).append(record)
        lines = []
        for (quantity, unit, why), records in groups.items():
            names = ", ".join(record.column + (f" ({record.axis})" if record.axis else "") for record in records)
            lines.append(f"{quantity.replace('_', ' ')}: {names}{f' in {unit}' if unit else ''}, {why}")
        return lines

    def describe(self) -> list[str]:
        """What was read, as what, and how good it is: sentences for the terminal and the report."""
        first, last = (str(time).replace("T", " ") for time in np.datetime_as_string(self.time_utc[[0, -1]], unit="s"))
        return [f"{self.name}: {first} to {last} UTC", *self.quality.sentences(), *self.recognised(), *self.ignored]
