"""A flight as an xarray Dataset: every signal with its unit, axes and meaning, and where it comes from."""

from __future__ import annotations

import json
from importlib import metadata
from typing import TYPE_CHECKING

import numpy as np

from fieldline.dynamics.load_log import LOADS
from fieldline.dynamics.parameters import STATE
from fieldline.frames.matrices import matvec
from fieldline.simulate.assembly.boards import KINDS
from fieldline.simulate.assembly.lines import line_names, sliders
from fieldline.simulate.assembly.plant import each
from fieldline.simulate.line_dataset import put_lines
from fieldline.simulate.loop.records import TASK
from fieldline.simulate.outcome import sentence

if TYPE_CHECKING:
    import xarray

AXES = ["x", "y", "z"]
ACTUATORS = (
    ("magnetorquer", "torquer_moment", "A m2", "dipole of each torquer along its axis"),
    ("wheel", "wheel_torque", "N m", "motor torque on each wheel, as commanded"),
    ("thruster", "thrust", "1", "part of the control period in which each thruster is told to fire"),
    ("conductor", "conductor_current", "A", "current of each conductor"),
    ("circuit", "circuit_command", "1", "what the circuit of each line is told"),
    ("reel", "reel_command", "1", "what each reel is told: rate [m/s] or tension [N]"),
    ("slider", "slider_place", "m", "place of each sliding attachment along its axis"),
)  # dimension, variable, unit and meaning of each kind, in the order of the loop's axis of actuators
SENSOR_UNITS = {
    "magnetometer": ("T", "reading of the magnetometer", "b"),
    "gyro": ("rad s-1", "reading of the gyro", "b"),
    "sun_sensor": ("1", "readings of the sun sensors", "faces"),
    "star_tracker": ("1", "attitude by the star tracker, scalar last", "bi"),
    "navigation": ("m", "position as known on board", "i"),
}


def dataset_of(flight) -> xarray.Dataset:
    """Everything that a flight has simulated so far."""
    import xarray

    rows = int(flight.clock.rows[0])
    start = flight.scenario.time.start
    seconds = flight.record.seconds[:rows]
    time = start + np.round(1e9 * seconds).astype("timedelta64[ns]")
    data = xarray.Dataset(
        coords={
            "time": time,
            "seconds": ("time", seconds, {"units": "s", "long_name": "time since the start"}),
            "body": [body.name for body in flight.scenario.body],
            "axis": AXES,
            "quaternion": ["x", "y", "z", "w"],
        }
    )
    _motion(data, flight, rows)
    _surroundings(data, flight, rows)
    _loads(data, flight, rows)
    _actuators(data, flight, rows)
    put_lines(data, flight, rows)
    _known(data, flight, rows)
    _readings(data, flight, start)
    _events(data, flight, start)
    data.attrs = attributes(flight)
    return data


def put(data, name: str, dims, values, units: str, long_name: str, axes: str = "") -> None:
    """One variable with its attributes."""
    attrs = {"units": units, "long_name": long_name}
    data[name] = (dims, values, attrs | ({"axes": axes} if axes else {}))


def _bodies(flight, rows: int) -> np.ndarray:
    """(rows, bodies, 13) states."""
    count = len(flight.scenario.body)
    return flight.record.state[:rows, : STATE * count].reshape(rows, count, STATE)


def _motion(data, flight, rows: int) -> None:
    """Place, velocity, attitude and rate."""
    state = _bodies(flight, rows)
    vector = ("time", "body", "axis")
    put(data, "position_i", vector, state[..., 0:3], "m", "position from the Earth's centre", "i")
    put(data, "velocity_i", vector, state[..., 3:6], "m s-1", "velocity", "i")
    put(data, "q_bi", ("time", "body", "quaternion"), state[..., 6:10], "1", "attitude, scalar last: body to inertial", "bi")
    put(data, "omega_bi_b", vector, state[..., 10:13], "rad s-1", "angular rate", "b")


def _surroundings(data, flight, rows: int) -> None:
    """Field, Sun, place over the ground."""
    from scipy.spatial.transform import Rotation

    from fieldline.environment.ephemeris import dcm_ei_kernel
    from fieldline.frames.earth_rotation import geodetic_from_itrs

    state, field_i = _bodies(flight, rows), flight.record.field_i[:rows]
    count = state.shape[1]
    turned = Rotation.from_quat(state[..., 6:10].reshape(-1, 4)).inv().apply(field_i.reshape(-1, 3))
    ephemeris = flight.plant.surroundings.ephemeris
    place_e = np.empty((rows, count, 3))
    for k, t in enumerate(flight.record.seconds[:rows]):
        dcm_ei = dcm_ei_kernel(t, ephemeris)
        for b in range(count):
            place_e[k, b] = matvec(dcm_ei, tuple(state[k, b, :3]))
    latitude, longitude, height = geodetic_from_itrs(place_e)
    vector, scalar = ("time", "body", "axis"), ("time", "body")
    put(data, "field_i", vector, field_i, "T", "the Earth's magnetic field", "i")
    put(data, "field_b", vector, turned.reshape(rows, count, 3), "T", "the Earth's magnetic field", "b")
    put(data, "sunlit", scalar, flight.record.sunlit[:rows], "1", "visible part of the Sun's disc")
    put(data, "latitude_deg", scalar, np.degrees(latitude), "degree", "geodetic latitude")
    put(data, "longitude_deg", scalar, np.degrees(longitude), "degree", "longitude, east positive")
    put(data, "altitude_m", scalar, height, "m", "height over the WGS 84 ellipsoid")


def _loads(data, flight, rows: int) -> None:
    """Force and torque of every load that did anything."""
    log = flight.record.loads[:rows]
    acting = [k for k in range(len(LOADS)) if np.any(log[:, k])]
    data.coords["load"] = [LOADS[k] for k in acting]
    dims = ("time", "load", "body", "axis")
    put(data, "force_i", dims, log[:, acting, :, 0:3], "N", "force of each load", "i")
    put(data, "torque_b", dims, log[:, acting, :, 3:6], "N m", "torque of each load", "b")


def _actuators(data, flight, rows: int) -> None:
    """Torquers, wheels, thrusters, conductors, reels, sliders and rods, each kind that there is."""
    bodies, lines = flight.scenario.body, line_names(flight.scenario)
    count, wheels = len(bodies), _names(bodies, "wheel")
    reeled = [name for name, line in zip(lines, flight.scenario.line, strict=True) if line.reel is not None]
    circuits = [lines[k] for k in flight.actuators.target[flight.actuators.ends[3] : flight.actuators.ends[4]]]
    sliding = [f"{lines[k]}.slider_{j + 1}" for j, (k, _) in enumerate(sliders(flight.scenario))]
    first = 0
    for (kind, name, units, words), names, last in zip(
        ACTUATORS,
        (
            _names(bodies, "magnetorquer"),
            wheels,
            _names(bodies, "thruster"),
            _names(bodies, "conductor"),
            circuits,
            reeled,
            sliding,
        ),
        flight.actuators.ends,
        strict=True,
    ):
        if names:
            data.coords[kind] = names
            put(data, name, ("time", kind), flight.record.actuators[:rows, first:last], units, words)
        first = last
    rods = each(bodies, "hysteresis_rod")
    rest = flight.record.state[:rows, STATE * count :]
    if wheels:
        put(data, "wheel_momentum", ("time", "wheel"), rest[:, : len(wheels)], "N m s", "momentum of each wheel about its axis")
    if rods:
        data.coords["rod"] = [f"{bodies[b].name}.rod_{k + 1}" for k, (b, _) in enumerate(rods)]
        inductions = rest[:, len(wheels) : len(wheels) + len(rods)]
        put(data, "rod_induction", ("time", "rod"), inductions, "T", "induction of each hysteresis rod")


def _names(bodies, kind: str) -> list[str]:
    """body.actuator of all of a kind, in the plant's order."""
    return [f"{body.name}.{name}" for body in bodies for name in body.names_of(kind)]


def _known(data, flight, rows: int) -> None:
    """Attitude and rate as known on board, where anything is known."""
    known = flight.record.known[:rows]
    if np.isfinite(known[..., :4]).any():
        put(data, "q_bi_known", ("time", "body", "quaternion"), known[..., :4], "1", "attitude as known on board", "bi")
    if np.isfinite(known[..., 4:]).any():
        put(data, "omega_bi_b_known", ("time", "body", "axis"), known[..., 4:], "rad s-1", "rate as known on board", "b")


def _readings(data, flight, start) -> None:
    """Every sensor's readings, on times of their own: `magnetometer_NAME` over `time_magnetometer_NAME`."""
    samples = flight.record.samples[: int(flight.clock.samples[0])]
    kinds = {number: key for key, number in KINDS.items()}
    for j, (kind, who) in enumerate(zip(flight.schedule.kind, flight.schedule.who, strict=True)):
        if kind == TASK or kind not in kinds:
            continue
        key, body = kinds[kind], flight.scenario.body[who]
        mine = samples[samples[:, 0] == j]
        units, words, axes = SENSOR_UNITS[key]
        width = {"star_tracker": 4, "sun_sensor": len(body.sun_sensor.normals_b) if body.sun_sensor else 0}.get(key, 3)
        column = {"star_tracker": "quaternion", "sun_sensor": f"face_{body.name}"}.get(key, "axis")
        clock = f"time_{key}_{body.name}"
        data.coords[clock] = start + np.round(1e9 * mine[:, 1]).astype("timedelta64[ns]")
        put(data, f"{key}_{body.name}", (clock, column), mine[:, 2 : 2 + width], units, words, axes)
        if key == "sun_sensor":
            data[f"sun_sensor_normal_{body.name}"] = ((column, "axis"), np.array(body.sun_sensor.normals_b))


def _events(data, flight, start) -> None:
    """Times, names and directions of the events that were found."""
    if not flight.scenario.event:
        return
    found = flight.events.found[: min(int(flight.clock.events[0]), len(flight.events.found))]
    found = found[found[:, 1] <= flight.clock.t[0] + 1e-9]
    found = found[np.argsort(found[:, 1], kind="stable")]
    names = [event.name or event.kind for event in flight.scenario.event]
    data["event_time"] = ("event", start + np.round(1e9 * found[:, 1]).astype("timedelta64[ns]"))
    data["event_name"] = ("event", np.array([names[int(k)] for k in found[:, 0]], dtype=object))
    data["event_direction"] = ("event", found[:, 2].astype(np.int8), {"long_name": "1 rising, -1 falling"})


def inputs_of(scenario) -> dict[str, str]:
    """SHA-256 of every file that a scenario names: orbits, Earth orientation, the user's functions."""
    from fieldline.files import sha256_of

    return {name: sha256_of(scenario.folder / name) for name in scenario.files()}


def attributes(flight) -> dict:
    """Provenance: scenario, seed, models, versions, outcome."""
    scenario = flight.scenario
    model = scenario.environment.field_model()
    end = scenario.time.start + np.timedelta64(round(1e9 * flight.duration_s), "ns")
    provenance = {
        "versions": {name: metadata.version(name) for name in ("fieldline", "numba", "numpy", "pyerfa")},
        "scenario": scenario.name,
        "scenario_sha256": scenario.sha256,
        "inputs": inputs_of(scenario),
        "seed": flight.seed,
        "field_model": "uniform" if model is None else model.stamp([scenario.time.start, end]),
        "gravity": scenario.environment.gravity,
        "atmosphere": scenario.environment.atmosphere.model,
        "method": scenario.integrator.method,
        "steps": {"taken": int(flight.clock.steps[0]), "refused": int(flight.clock.steps[1])},
        "laws": [
            {"task": task.name, "law": task.record.law, "rate_hz": task.record.rate_hz, "runs": int(runs), **task.settings}
            for task, runs in zip(flight.software, flight.tasks.runs, strict=True)
        ],
    }
    return {
        "title": scenario.name,
        "complete": int(flight.complete),
        "outcome": sentence(flight),
        "scenario_toml": scenario.to_toml(),
        "provenance_json": json.dumps(provenance, sort_keys=True),
        "Conventions": "CF-1.11",
    }
