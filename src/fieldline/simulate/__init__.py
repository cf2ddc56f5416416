"""Days not yet flown: scenario in, every signal out; and the telemetry that it would have sent down.

Names are loaded where they are first used: the plant's compiled loop costs a third of a second. The package answers
calls, `fieldline.simulate(scenario)`, because Python gives a package's name to whoever imports a part of it first, and
the function must not vanish behind it.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fieldline.simulate.ensemble import Choice, Normal, Uniform, simulate_many
    from fieldline.simulate.free_flight import FreeFlight, fly_free
    from fieldline.simulate.magnetometer import Magnetometer
    from fieldline.simulate.outcome import RunError, RunInterrupted
    from fieldline.simulate.run import simulate
    from fieldline.simulate.scenario.scenario import Scenario

_HOMES = {
    "simulate": "fieldline.simulate.run",
    "simulate_many": "fieldline.simulate.ensemble",
    "Normal": "fieldline.simulate.ensemble",
    "Uniform": "fieldline.simulate.ensemble",
    "Choice": "fieldline.simulate.ensemble",
    "Scenario": "fieldline.simulate.scenario.scenario",
    "RunError": "fieldline.simulate.outcome",
    "RunInterrupted": "fieldline.simulate.outcome",
    "FreeFlight": "fieldline.simulate.free_flight",
    "fly_free": "fieldline.simulate.free_flight",
    "Magnetometer": "fieldline.simulate.magnetometer",
}

__all__ = [
    "simulate",
    "simulate_many",
    "Normal",
    "Uniform",
    "Choice",
    "Scenario",
    "RunError",
    "RunInterrupted",
    "FreeFlight",
    "Magnetometer",
    "fly_free",
]


def __getattr__(name: str) -> Any:
    """Load a public name from where it lives."""
    if name not in _HOMES:
        raise AttributeError(f"module 'fieldline.simulate' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


class _Package(ModuleType):
    """The package, callable as the function that it is named for."""

    def __call__(self, scenario, *, seed=None, progress=None):
        """`fieldline.simulate.run.simulate`."""
        return import_module("fieldline.simulate.run").simulate(scenario, seed=seed, progress=progress)


sys.modules[__name__].__class__ = _Package
