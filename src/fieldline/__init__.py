"""Fieldline: spacecraft that sense, steer by, or hang in the Earth's magnetic field.

    import fieldline as fl

    telemetry = fl.read_telemetry("flight.csv")
    orbit = fl.read_orbit("sat.tle")
    estimate = fl.estimate_attitude(telemetry, orbit)
    fl.write_report(estimate, "flight.html")

Names are loaded where they are first used (PEP 562), so that `import fieldline` costs milliseconds.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOMES = {
    "read_telemetry": "fieldline.telemetry",
    "Telemetry": "fieldline.telemetry",
    "read_orbit": "fieldline.orbit",
    "orbit_from_positions": "fieldline.orbit",
    "magnetic_field": "fieldline.environment",
    "field_gradient": "fieldline.environment",
    "field_model": "fieldline.environment",
    "sun_direction_i": "fieldline.environment",
    "eclipse": "fieldline.environment",
    "calibrate": "fieldline.estimation.calibrate",
    "Calibration": "fieldline.estimation.calibration",
    "estimate_attitude": "fieldline.estimation",
    "estimate_skiprope": "fieldline.estimation.skiprope_telemetry",
    "write_report": "fieldline.report",
    "electrodynamic_map": "fieldline.control.electrodynamic",
    "allocate": "fieldline.control.tracking.allocation",
    "approach": "fieldline.simulate.approach",
    "simulate": "fieldline.simulate",
    "simulate_many": "fieldline.simulate",
    "line_shape": "fieldline.simulate.line_shape",
    "tether_modes": "fieldline.analysis.tether",
    "Normal": "fieldline.simulate",
    "Uniform": "fieldline.simulate",
    "Choice": "fieldline.simulate",
    "Scenario": "fieldline.simulate.scenario",
    "FieldlineError": "fieldline.errors",
    "InputError": "fieldline.errors",
    "NoEstimateError": "fieldline.errors",
}

__all__ = [
    "__version__",
    "read_telemetry",
    "Telemetry",
    "read_orbit",
    "orbit_from_positions",
    "magnetic_field",
    "field_gradient",
    "field_model",
    "sun_direction_i",
    "eclipse",
    "calibrate",
    "Calibration",
    "estimate_attitude",
    "estimate_skiprope",
    "write_report",
    "electrodynamic_map",
    "allocate",
    "approach",
    "simulate",
    "simulate_many",
    "Normal",
    "Uniform",
    "Choice",
    "line_shape",
    "tether_modes",
    "Scenario",
    "FieldlineError",
    "InputError",
    "NoEstimateError",
]

if TYPE_CHECKING:
    from fieldline.analysis.tether import tether_modes
    from fieldline.control.electrodynamic import electrodynamic_map
    from fieldline.control.tracking.allocation import allocate
    from fieldline.environment import eclipse, field_gradient, field_model, magnetic_field, sun_direction_i
    from fieldline.errors import FieldlineError, InputError, NoEstimateError
    from fieldline.estimation import estimate_attitude
    from fieldline.estimation.calibrate import calibrate
    from fieldline.estimation.calibration import Calibration
    from fieldline.estimation.skiprope_telemetry import estimate_skiprope
    from fieldline.orbit import orbit_from_positions, read_orbit
    from fieldline.report import write_report
    from fieldline.simulate.approach import approach
    from fieldline.simulate.ensemble import Choice, Normal, Uniform, simulate_many
    from fieldline.simulate.line_shape import line_shape
    from fieldline.simulate.run import simulate
    from fieldline.simulate.scenario import Scenario
    from fieldline.telemetry import Telemetry, read_telemetry


def __getattr__(name: str) -> Any:
    """Load a public name from where it lives; later uses find it here."""
    if name not in _HOMES:
        raise AttributeError(f"module 'fieldline' has no attribute {name!r}")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """All public names, loaded or not."""
    return sorted(__all__)
