"""An orbit from tabulated states or positions: one or more paths in GCRS axes, never extrapolated."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from fieldline.errors import InputError
from fieldline.frames.time import as_utc, iso_utc
from fieldline.orbit.orbit import MAX_AGE_DAYS, Orbit


class Path(Protocol):
    """A piece of an orbit between two times, in GCRS axes."""

    first_utc: np.datetime64
    last_utc: np.datetime64

    @property
    def words(self) -> str:
        """How it was made."""
        ...

    def state(self, flat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Position [m] and velocity [m/s], (n, 3)."""
        ...


@dataclass(frozen=True, kw_only=True, eq=False)
class EphemerisOrbit(Orbit):
    """Orbit of one satellite from paths, ordered by their first time; where two overlap the later one serves."""

    paths: tuple[Path, ...]
    remarks: tuple[str, ...] = ()  # warnings found when it was made
    _first: np.ndarray = field(init=False, repr=False)
    _last: np.ndarray = field(init=False, repr=False)

    def __post_init__(self):
        object.__setattr__(self, "_first", np.array([p.first_utc for p in self.paths], dtype="datetime64[ns]"))
        object.__setattr__(self, "_last", np.array([p.last_utc for p in self.paths], dtype="datetime64[ns]"))

    def covers(self, time_utc) -> np.ndarray:
        """(...) whether each time lies within a path."""
        times = as_utc(time_utc)
        return (self._serving(times.reshape(-1)) >= 0).reshape(times.shape)

    def check(self, time_utc, max_age_days: float = MAX_AGE_DAYS) -> list[str]:
        """Remarks on the table; InputError where it does not cover a time (an age has no meaning here)."""
        flat = as_utc(time_utc).reshape(-1)
        self._plan(flat)
        return self._warnings(flat)

    def _serving(self, flat: np.ndarray) -> np.ndarray:
        """(n,) which path serves each time, -1 where none does."""
        index = np.searchsorted(self._first, flat, side="right") - 1
        index[flat > self._last[np.maximum(index, 0)]] = -1
        lost = np.flatnonzero(index < 0)
        for k, path in enumerate(self.paths if lost.size else ()):  # an earlier path may outlast a later one
            within = (flat[lost] >= path.first_utc) & (flat[lost] <= path.last_utc)
            index[lost[within]] = k
        return index

    def _plan(self, flat: np.ndarray) -> np.ndarray:
        """(n,) which path serves each time; InputError outside all."""
        index = self._serving(flat)
        outside = index < 0
        if outside.any():
            spans = [f"{iso_utc(a, 0)} to {iso_utc(b, 0)}" for a, b in zip(self._first, self._last, strict=True)]
            more = f" and {len(spans) - 4} more spans" if len(spans) > 4 else ""
            raise InputError(
                f"{self.name} ({self.kind}) covers {', '.join(spans[:4])}{more}; {int(outside.sum())} of {flat.size} samples "
                f"lie outside, the first at {iso_utc(flat[outside].min(), 0)}. Nothing is extrapolated: cut the telemetry."
            )
        return index

    def _states(self, flat: np.ndarray, plan: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """States from the serving paths."""
        position_i, velocity_i = np.empty((2, flat.size, 3))
        for index in np.unique(plan):
            mine = plan == index
            position_i[mine], velocity_i[mine] = self.paths[index].state(flat[mine])
        return position_i, velocity_i

    def _account(self, flat: np.ndarray) -> dict:
        """Spans and interpolation of the paths in use."""
        used = [self.paths[k] for k in np.unique(self._serving(flat)) if k >= 0]
        return {"paths": [{"from": iso_utc(p.first_utc), "to": iso_utc(p.last_utc), "interpolation": p.words} for p in used]}

    def _warnings(self, flat: np.ndarray) -> list[str]:
        return list(self.remarks)
