"""A run's Dataset as the arrays that figures draw, body by body, in the units of the page."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fieldline.report.record import TimeAxis, dark_spells
from fieldline.report.theme import INK

DEG = 180.0 / np.pi
MOST_BODIES = 6  # of a run that have figures of their own


@dataclass(frozen=True)
class RunRecord(TimeAxis):
    """A Dataset of `fieldline.simulate` with its time axis and its scenario."""

    dataset: Any

    @cached_property
    def time_utc(self) -> np.ndarray:
        """(n,) datetime64[ns] of the outputs."""
        return self.dataset["time"].values.astype("datetime64[ns]")

    @cached_property
    def scenario(self) -> Any:
        """The scenario that was flown."""
        from fieldline.simulate.scenario.scenario import Scenario

        return Scenario.from_toml(self.dataset.attrs["scenario_toml"])

    @cached_property
    def provenance(self) -> dict[str, Any]:
        """Models, versions, seed."""
        return json.loads(self.dataset.attrs.get("provenance_json", "{}"))

    @property
    def complete(self) -> bool:
        """Whether the run went to its end."""
        return bool(self.dataset.attrs.get("complete", 0))

    @cached_property
    def bodies(self) -> list[str]:
        """Names of all bodies."""
        return [body.name for body in self.scenario.body]

    @cached_property
    def rigid(self) -> list[int]:
        """Indices of the bodies that turn, the first few."""
        return [b for b, body in enumerate(self.scenario.body) if body.kind == "rigid"][:MOST_BODIES]

    def of_body(self, words: str, b: int) -> str:
        """Words with the body's name where there are several."""
        return f"{words}: {self.bodies[b]}" if len(self.bodies) > 1 else words

    def tag(self, name: str, b: int) -> str:
        """A figure's name, of a body where there are several."""
        return f"{name}_{b + 1}" if len(self.bodies) > 1 else name

    def has(self, *names: str) -> bool:
        """Whether the Dataset carries all of these variables."""
        return all(name in self.dataset for name in names)

    def values(self, name: str, factor: float = 1.0) -> np.ndarray:
        """A variable times a factor, as floats, time first."""
        return np.asarray(self.dataset[name].values, dtype=float) * factor

    def of(self, name: str, b: int, factor: float = 1.0) -> np.ndarray:
        """A variable of one body."""
        return np.asarray(self.dataset[name].isel(body=b).values, dtype=float) * factor

    def names(self, kind: str, b: int) -> list[str]:
        """body.actuator of a kind, as the Dataset has them."""
        return [f"{self.bodies[b]}.{name}" for name in self.scenario.body[b].names_of(kind)]

    def seconds_of(self, clock: str) -> np.ndarray:
        """A sensor's times [s] since the first output."""
        return (self.dataset[clock].values.astype("datetime64[ns]") - self.time_utc[0]).astype(np.int64) * 1e-9

    def shade(self, axes: Any, b: int = 0) -> None:
        """Shade the stays in the Earth's shadow, and let the axis span the run."""
        for start, stop in dark_spells(self.seconds, self.of("sunlit", b)):
            axes.axvspan(start / self.clock.unit_s, stop / self.clock.unit_s, color=INK, alpha=0.06, linewidth=0)
        axes.set_xlim(self.time[0], self.time[-1])
