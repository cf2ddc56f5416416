"""The satellite that the plant's benchmarks fly: a tumbling 3U, J2, the field to degree 13 at every stage, B-dot at 1 Hz."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np

from fieldline.simulate.flight import Flight
from fieldline.simulate.scenario.scenario import Scenario

HERE = Path(__file__).parent
SOURCE = HERE / "plant.c"
FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-shared", "-fPIC")
TOML = """
name = "benchmark"
time = { start_utc = 2026-03-01T00:00:00Z, duration_s = 86400.0, output_step_s = 60.0 }
integrator = { method = "rk4", step_s = 1.0 }
orbit.state = { position_km = [6878.0, 0.0, 0.0], velocity_km_s = [0.0, 1.0, 7.54] }

[[body]]
name = "sat"
mass_kg = 4.0
inertia_kg_m2 = [0.02, 0.03, 0.035]
residual_dipole_a_m2 = [0.01, -0.005, 0.008]
gravity_gradient = true
rate_deg_s = [3.0, 2.0, 1.0]
magnetometer = { rate_hz = 1.0 }
magnetorquer = [
    { axis_b = [1, 0, 0], moment_max_a_m2 = 0.2 },
    { axis_b = [0, 1, 0], moment_max_a_m2 = 0.2 },
    { axis_b = [0, 0, 1], moment_max_a_m2 = 0.2 },
]

[[software]]
law = "b-dot"
rate_hz = 1.0
"""


class Constants(ctypes.Structure):
    """`plant` of plant.c."""

    _fields_ = (
        [(name, ctypes.c_double) for name in ("gm", "j2", "oblate_radius", "field_radius")]
        + [(name, ctypes.c_void_p) for name in ("recursion", "table")]
        + [(name, ctypes.c_double) for name in ("era_start", "era_rate", "node_step")]
        + [("nodes", ctypes.c_void_p)]
        + [(name, ctypes.c_double * n) for name, n in (("inertia", 9), ("inverse", 9), ("residual", 3))]
        + [(name, ctypes.c_double) for name in ("gain", "moment_max", "gradient")]
        + [(name, ctypes.c_ssize_t) for name in ("degree", "order", "node_count", "hold")]
    )


def scenario(**changes) -> Scenario:
    """The satellite, some of its values changed."""
    return Scenario.from_toml(TOML, folder=HERE).replace(**changes)


def constants(flight: Flight) -> Constants:
    """What a flight flies with, for plant.c."""
    surroundings, bodies = flight.plant.surroundings, flight.plant.bodies
    gravity, field, ephemeris = surroundings.gravity, surroundings.field, surroundings.ephemeris
    nine, three = ctypes.c_double * 9, ctypes.c_double * 3
    return Constants(
        gravity.gm, gravity.j2, gravity.radius_m, field.basis.radius_m,
        field.basis.recursion.ctypes.data, field.table.ctypes.data,
        ephemeris.era_start, ephemeris.era_rate, ephemeris.node_step_s, ephemeris.intermediate.ctypes.data,
        nine(*bodies.inertia[0]), nine(*bodies.inertia_inv[0]), three(*bodies.residual[0]),
        flight.parameters[0][0], flight.actuators.limit[0], bodies.gravity_gradient[0],
        field.basis.degree, field.basis.order, len(ephemeris.intermediate), flight.scenario.integrator.field_update == "step",
    )  # fmt: skip


def plant_in_c(folder: Path, lanes: int = 1):
    """`fly(y (13, lanes) in place, steps, step_s, constants)` compiled in a folder; None where there is no compiler."""
    compiler = shutil.which("gcc")
    if compiler is None:
        return None
    library = folder / f"plant{lanes}.so"
    subprocess.run([compiler, *FLAGS, f"-DLANES={lanes}", "-o", library, SOURCE, "-lm"], check=True)
    function = ctypes.CDLL(str(library)).fly

    def fly(y: np.ndarray, steps: int, step_s: float, made: Constants) -> None:
        function(y.ctypes.data_as(ctypes.c_void_p), ctypes.c_long(steps), ctypes.c_double(step_s), ctypes.byref(made))

    return fly
