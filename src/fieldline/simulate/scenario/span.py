"""When a run starts, how long it lasts, and how often its signals are kept."""

from __future__ import annotations

from datetime import date, datetime
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from fieldline.frames.time import as_utc
from fieldline.records import Record, RecordError

SECONDS_PER_DAY = 86400.0
MOST_DAYS = 36525.0
LEAST_S = 1e-6  # times are kept to the nanosecond


def _utc_text(value: Any) -> str:
    """ISO 8601 UTC of a TOML date and time, or of text."""
    if isinstance(value, datetime | date | np.datetime64):
        value = value.isoformat() if not isinstance(value, np.datetime64) else str(value)
    if not isinstance(value, str):
        raise ValueError(f"must be a date and time in UTC, such as 2026-03-01T00:00:00Z; got {value!r:.40}")
    try:
        time = as_utc(value, "start_utc")
    except ValueError:
        raise ValueError(f'must be a date and time in UTC, such as 2026-03-01T00:00:00Z; got "{value[:40]}"') from None
    return str(np.datetime_as_string(time, unit="auto" if time.astype(np.int64) % 86_400_000_000_000 else "s")) + "Z"


class Span(Record):
    """When the run starts, how long it lasts, how often its signals are kept."""

    start_utc: Annotated[str, BeforeValidator(_utc_text), WithJsonSchema({"type": "string", "format": "date-time"})] = Field(
        description="start of the run, UTC, ISO 8601"
    )
    duration_s: float | None = Field(default=None, ge=LEAST_S, description="length of the run [s]; this or duration_orbits")
    duration_orbits: float | None = Field(default=None, gt=0.0, description="length of the run in orbits of the first body")
    output_step_s: float = Field(default=10.0, ge=LEAST_S, description="time between the samples that are kept [s]")

    @model_validator(mode="after")
    def _one_duration(self):
        """Exactly one duration, of a length that a run can have."""
        found = []
        given = [key for key in ("duration_s", "duration_orbits") if getattr(self, key) is not None]
        if len(given) != 1:
            found.append(("", f"give exactly one of duration_s and duration_orbits; got {' and '.join(given) or 'neither'}"))
        if self.duration_s is not None and self.duration_s > MOST_DAYS * SECONDS_PER_DAY:
            found.append(("duration_s", f"must be at most {MOST_DAYS:g} days; got {self.duration_s / SECONDS_PER_DAY:.6g} days"))
        if self.duration_s is not None and self.output_step_s > self.duration_s:
            found.append(("output_step_s", f"must be at most duration_s, {self.duration_s:g}; got {self.output_step_s:g}"))
        if found:
            raise RecordError(found)
        return self

    @property
    def start(self) -> np.datetime64:
        """The start as datetime64[ns]."""
        return np.datetime64(self.start_utc.removesuffix("Z"), "ns")

    def length_s(self, period_s: float) -> float:
        """Length of the run [s], given the orbital period of the first body [s]."""
        return self.duration_s or (self.duration_orbits or 0.0) * period_s
