"""A simulated run as the telemetry that it would have sent down, for estimators to be tried on with the truth known.

    telemetry = telemetry_of_run(fl.simulate("tumble.toml"))
    write_telemetry_csv(telemetry, "flight.csv")            # fieldline attitude flight.csv

One sample for each reading of the magnetometer, with the position in it, so that no orbit file is needed. The position is
interpolated between the outputs by a cubic spline: 1 mm off where outputs are 10 s apart, 2 m at 60 s, in low orbit
(5 r n^4 h^4 / 384), some times that next to the first and the last output.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fieldline.errors import InputError, nearest

if TYPE_CHECKING:
    import xarray

    from fieldline.telemetry import Telemetry

FACES = {"+x": (1, 0, 0), "-x": (-1, 0, 0), "+y": (0, 1, 0), "-y": (0, -1, 0), "+z": (0, 0, 1), "-z": (0, 0, -1)}


def telemetry_of_run(dataset: xarray.Dataset, body: str | None = None) -> Telemetry:
    """What the sensors of one body said.

    Parameters
    ----------
    dataset : of `fieldline.simulate`; readings in SI, over times of their own.
    body : name of the body; the first that carries a magnetometer by default.

    Returns
    -------
    Telemetry at the magnetometer's times: its raw readings; the gyro's and sun sensors' readings nearest in time, NaN where
    none is within half of a step; the torquers' dipole, where the outputs are as dense as the commands; the position in
    ITRS. `ignored` says what was left out and why.

    Errors: InputError where there is no such body, it has no magnetometer, or it was read less than twice.
    """
    from fieldline.telemetry import Quality, Telemetry

    body = body_with_magnetometer(dataset, body)
    time, field_s = _readings(dataset, f"magnetometer_{body}")
    outputs = dataset["time"].values.astype("datetime64[ns]")
    within = (time >= outputs[0]) & (time <= outputs[-1])
    time, field_s = time[within], field_s[within]
    if len(time) < 2:
        raise InputError(
            f'the magnetometer of "{body}" was read {len(time)} times between the first and the last output; telemetry needs 2.'
        )
    ignored: list[str] = []
    faces, notes = _sun_sensors(dataset, body, time)
    dipole, note = _dipole(dataset, body, time)
    ignored += [*notes, *([note] if note else [])]
    usable = np.isfinite(field_s).all(axis=1)
    step = float(np.median(np.diff(time).astype(np.int64))) * 1e-9
    return Telemetry(
        time_utc=time,
        field_s=field_s,
        usable=usable,
        rate_b=_nearest(dataset, f"gyro_{body}", time),
        sun_sensor=faces,
        dipole_command_b=dipole,
        position_e=_position_e(dataset, body, time),
        ignored=tuple(ignored),
        quality=Quality(samples=len(time), usable=int(usable.sum()), step_s=step),
        name=f"{dataset.attrs.get('title', 'run')}, {body}",
    )


def body_with_magnetometer(dataset: xarray.Dataset, body: str | None) -> str:
    """The body asked for, or the first that has one."""
    bodies = [str(name) for name in dataset["body"].values]
    sensing = [name for name in bodies if f"magnetometer_{name}" in dataset]
    if body is not None and body not in bodies:
        raise InputError(f'the run has no body "{body}"; {nearest(body, bodies)}')
    if not sensing or (body is not None and body not in sensing):
        who = f'the body "{body}"' if body is not None else "no body"
        has = "has no magnetometer" if body is not None else "of the run has a magnetometer"
        raise InputError(f"{who} {has}, so there is no telemetry of it. Give it one: [body.magnetometer] rate_hz = 1.0")
    return body if body is not None else sensing[0]


def _readings(dataset, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Times and readings of a sensor."""
    clock = str(dataset[name].dims[0])
    return dataset[clock].values.astype("datetime64[ns]"), np.asarray(dataset[name].values, dtype=float)


def _nearest(dataset, name: str, time: np.ndarray) -> np.ndarray | None:
    """A sensor's readings nearest to each time, NaN where none is within half of the longer of the two steps."""
    if name not in dataset:
        return None
    theirs, values = _readings(dataset, name)
    if len(theirs) < 2:
        return None
    after = np.clip(np.searchsorted(theirs, time), 1, len(theirs) - 1)
    index = np.where(time - theirs[after - 1] <= theirs[after] - time, after - 1, after)
    step = min(np.median(np.diff(theirs)), np.median(np.diff(time)))
    near = np.abs(theirs[index] - time) <= step // 2
    return np.where(near[:, None], values[index], np.nan)


def _sun_sensors(dataset, body: str, time: np.ndarray) -> tuple[dict[str, np.ndarray], list[str]]:
    """Readings by face, and a sentence where a sensor does not look along an axis."""
    readings = _nearest(dataset, f"sun_sensor_{body}", time)
    if readings is None:
        return {}, []
    faces, skewed = {}, 0
    for k, normal in enumerate(dataset[f"sun_sensor_normal_{body}"].values):
        face = next((name for name, axis in FACES.items() if np.allclose(normal, axis, atol=1e-6)), None)
        if face is None or face in faces:
            skewed += 1
        else:
            faces[face] = readings[:, k]
    return faces, [f"{skewed} sun sensors that do not look along an axis of the body, or share one, left out"] if skewed else []


def _dipole(dataset, body: str, time: np.ndarray) -> tuple[np.ndarray | None, str]:
    """Dipole of the body's torquers [A m^2] as the outputs hold it, or why it is left out."""
    from fieldline.simulate.scenario.scenario import Scenario

    if "torquer_moment" not in dataset:
        return None, ""
    scenario = Scenario.from_toml(dataset.attrs["scenario_toml"])
    record = scenario.body[scenario.index_of(body)]
    tasks = [task for task in scenario.software if scenario.body[scenario.index_of(task.body)].name == body]
    mine = [f"{body}.{name}" for name in record.names_of("magnetorquer")]
    if not mine or not tasks:
        return None, ""
    if record.duty_cycle or any(scenario.time.output_step_s * task.rate_hz > 1.0 + 1e-9 for task in tasks):
        return (
            None,
            "the torquers' dipole left out: it changes between outputs (output_step_s at most a law's period, no duty cycle)",
        )
    axes = np.array([torquer.axis_b for torquer in record.magnetorquer])
    moment = dataset["torquer_moment"].sel(magnetorquer=mine).values @ axes
    outputs = dataset["time"].values.astype("datetime64[ns]")
    return moment[np.searchsorted(outputs, time, side="right") - 1], ""


def _position_e(dataset, body: str, time: np.ndarray) -> np.ndarray:
    """(n, 3) [m] ITRS."""
    from scipy.interpolate import CubicSpline

    from fieldline.frames.earth_rotation import itrs_from_geodetic

    outputs = dataset["time"].values.astype("datetime64[ns]")
    seconds, at = ((one - outputs[0]).astype(np.int64) * 1e-9 for one in (outputs, time))
    flown = dataset.sel(body=body)
    latitude, longitude = (np.radians(flown[name].values) for name in ("latitude_deg", "longitude_deg"))
    return CubicSpline(seconds, itrs_from_geodetic(latitude, longitude, flown["altitude_m"].values))(at)
