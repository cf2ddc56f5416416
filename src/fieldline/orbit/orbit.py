"""What every orbit can do: state, Earth-fixed position, its own limits, and a description for the record."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from fieldline.frames.earth_orientation import EarthOrientation
from fieldline.frames.earth_rotation import NO_EOP_STATEMENT, dcm_ei
from fieldline.frames.time import as_utc

BLOCK = 131072  # samples that are worked on at once: about 40 MB of temporary arrays
MAX_AGE_DAYS = 30.0


@dataclass(frozen=True, kw_only=True, eq=False)
class Orbit(ABC):
    """A satellite's path in time; times are UTC, positions [m] and velocities [m/s].

    `kind` says from what it was read; `eop` is the measured Earth orientation that Earth-fixed axes are made with,
    or None for UT1 = UTC.
    """

    name: str
    kind: str
    norad_id: int | None = None
    eop: EarthOrientation | None = None

    def state_i(self, time_utc) -> tuple[np.ndarray, np.ndarray]:
        """Position (..., 3) [m] and velocity (..., 3) [m/s], GCRS axes, at (...) times."""
        times = as_utc(time_utc)
        flat = times.reshape(-1)
        plan = self._plan(flat)
        position_i, velocity_i = np.empty((2, flat.size, 3))
        for start in range(0, flat.size, BLOCK):
            block = slice(start, start + BLOCK)
            position_i[block], velocity_i[block] = self._states(flat[block], plan[block])
        shape = (*times.shape, 3)
        return position_i.reshape(shape), velocity_i.reshape(shape)

    def position_e(self, time_utc) -> np.ndarray:
        """Position (..., 3) [m], ITRS axes, at (...) times."""
        times = as_utc(time_utc)
        flat = times.reshape(-1)
        position = self.state_i(flat)[0]
        for start in range(0, flat.size, BLOCK):
            block = slice(start, start + BLOCK)
            position[block] = np.einsum("nij,nj->ni", dcm_ei(flat[block], self.eop), position[block])
        return position.reshape(*times.shape, 3)

    def describe(self, time_utc) -> dict:
        """What was used for these times, for the record: plain values that JSON can hold."""
        times = as_utc(time_utc).reshape(-1)
        return {
            "name": self.name,
            "kind": self.kind,
            "norad_id": self.norad_id,
            "earth_orientation": self.eop.name if self.eop else NO_EOP_STATEMENT,
            **self._account(times),
            "warnings": self._warnings(times),
        }

    def covers(self, time_utc) -> np.ndarray:
        """(...) whether each time lies within what the orbit serves; elements serve all, however badly."""
        return np.ones(np.shape(time_utc), dtype=bool)

    @abstractmethod
    def check(self, time_utc, max_age_days: float = MAX_AGE_DAYS) -> list[str]:
        """Warnings about these times; raises InputError when the orbit must not be used for them."""

    @abstractmethod
    def _plan(self, flat: np.ndarray) -> np.ndarray:
        """(n,) what part of the orbit serves each time; raises InputError outside its reach."""

    @abstractmethod
    def _states(self, flat: np.ndarray, plan: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Position and velocity (n, 3), GCRS axes, of one block."""

    @abstractmethod
    def _account(self, flat: np.ndarray) -> dict:
        """What `describe` says beyond the name."""

    @abstractmethod
    def _warnings(self, flat: np.ndarray) -> list[str]:
        """Sentences about these times, without refusal."""
