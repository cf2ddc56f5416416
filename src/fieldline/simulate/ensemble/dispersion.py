"""What differs between the runs of an ensemble: a table of paths and distributions, or a function of one's own.

    disperse = {
        "body.0.rate_deg_s": Uniform([-180, -180, -180], [180, 180, 180]),
        "body.0.residual_dipole_a_m2": Normal(0.0, [0.01, 0.01, 0.01]),
        "orbit.elements.raan_deg": Uniform(0.0, 360.0),
    }

Each run draws from a stream of its own, spawned from the seed by the number of the run (SeedSequence.spawn), path by path
in the order of the table: neither the number of runs nor that of workers changes what a run draws.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fieldline.errors import InputError


@dataclass(frozen=True)
class Normal:
    """Independent normal numbers; mean and standard deviation in the path's unit, numbers or sequences."""

    mean: Any
    std: Any

    def draw(self, rng: np.random.Generator) -> np.ndarray:
        """One value, of the shape that mean and std have together."""
        return rng.normal(self.mean, self.std)


@dataclass(frozen=True)
class Uniform:
    """Independent numbers, all alike between low and high; numbers or sequences in the path's unit."""

    low: Any
    high: Any

    def draw(self, rng: np.random.Generator) -> np.ndarray:
        """One value, of the shape that low and high have together."""
        return rng.uniform(self.low, self.high)


@dataclass(frozen=True)
class Choice:
    """One of some values, each as likely, in the unit of the key that it is drawn for."""

    values: tuple[Any, ...]

    def draw(self, rng: np.random.Generator) -> Any:
        """One of them."""
        return self.values[int(rng.integers(len(self.values)))]


Dispersion = Normal | Uniform | Choice
Disperse = Mapping[str, Dispersion] | Callable[[np.random.Generator, int], Mapping[str, Any]] | None


def streams(seed: int, runs: int) -> list[tuple[np.random.Generator, int]]:
    """For each run: what it draws from, and the seed that it then flies with."""
    made = []
    for child in np.random.SeedSequence(seed).spawn(runs):
        drawing, flying = child.spawn(2)
        made.append((np.random.default_rng(drawing), int(flying.generate_state(1, np.uint64)[0] >> np.uint64(1))))
    return made


def drawn(disperse: Disperse, rng: np.random.Generator, run: int) -> dict[str, Any]:
    """The changes of one run: paths and plain values.

    Errors: InputError for a distribution that is none, or for a function that does not return a table.
    """
    if disperse is None:
        return {}
    if callable(disperse):
        table = disperse(rng, run)
        if not isinstance(table, Mapping):
            raise InputError(f"disperse(rng, run) must return a table of paths and values; got {type(table).__name__}.")
        return {path: _plain(value) for path, value in table.items()}
    for path, distribution in disperse.items():
        if not isinstance(distribution, Dispersion):
            raise InputError(
                f'disperse["{path}"] must be Normal, Uniform or Choice; got {type(distribution).__name__}. '
                'For example {"body.0.mass_kg": Normal(4.0, 0.1)}.'
            )
    return {path: _plain(distribution.draw(rng)) for path, distribution in disperse.items()}


def _plain(value: Any) -> Any:
    """Lists and floats, as scenarios take them."""
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value
