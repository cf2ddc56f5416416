"""The result as an xarray Dataset: every signal on one time axis, with units, axes and a name that a person reads."""

from __future__ import annotations

import json

import numpy as np

from fieldline.estimation.reference import Reference
from fieldline.estimation.smoothing import Smoothed
from fieldline.telemetry import Telemetry

TIME, VECTOR = ("time",), ("time", "axis")


def attitude_dataset(
    telemetry: Telemetry, reference: Reference, field_b: np.ndarray, used: np.ndarray, smoothed: Smoothed, omega_b: np.ndarray,
    predicted_b: np.ndarray, verdict: dict, provenance: dict,
):  # fmt: skip
    """The Dataset of `estimate_attitude`; field_b is calibrated, the slow error still in it."""
    import xarray as xr

    from fieldline.environment import eclipse, sun_direction_i
    from fieldline.frames.earth_rotation import geodetic_from_itrs

    latitude, longitude, height = geodetic_from_itrs(reference.position_e)
    measured = field_b - smoothed.slow_b
    columns = {
        "q_bi": (("time", "quaternion"), continuous(smoothed.q_bi), "1", "attitude of body against GCRS axes, scalar last"),
        "omega_bi_b": (VECTOR, omega_b, "rad s-1", "rate of body against GCRS axes, body axes"),
        "attitude_std_b": (VECTOR, _std(smoothed.attitude_covariance_b), "rad", "1-sigma of the attitude about body axes"),
        "omega_std_b": (VECTOR, smoothed.rate_std_b, "rad s-1", "1-sigma of the rate"),
        "attitude_covariance_b": (
            ("time", "axis", "axis_2"), smoothed.attitude_covariance_b, "rad2", "covariance of the attitude error, body axes",
        ),
        "field_raw_s": (VECTOR, telemetry.field_s, "T", "magnetometer as the file gives it"),
        "field_b": (VECTOR, measured, "T", "magnetometer, calibrated, less its slow error"),
        "slow_error_b": (VECTOR, smoothed.slow_b, "T", "slow error of the calibrated magnetometer, found with the attitude"),
        "field_predicted_b": (VECTOR, predicted_b, "T", "field model in the estimated body axes"),
        "residual_b": (VECTOR, measured - predicted_b, "T", "measured less predicted field, body axes"),
        "used": (TIME, used, "1", "whether the sample was used"),
        "nis": (TIME, smoothed.nis / 3.0, "1", "normalised innovation squared per axis; expectation 1"),
        "innovation_b": (VECTOR, smoothed.white, "1", "innovation of the filter, whitened; unit variance expected"),
        "field_i": (VECTOR, reference.field_i, "T", "field model along the orbit, GCRS axes"),
        "position_i": (VECTOR, reference.position_i, "m", "position, GCRS axes"),
        "velocity_i": (VECTOR, reference.velocity_i, "m s-1", "velocity, GCRS axes"),
        "latitude_deg": (TIME, np.degrees(latitude), "degree", "geodetic latitude"),
        "longitude_deg": (TIME, np.degrees(longitude), "degree", "geodetic longitude"),
        "altitude_m": (TIME, height, "m", "height over the WGS84 ellipsoid"),
        "sun_i": (VECTOR, sun_direction_i(telemetry.time_utc), "1", "direction to the Sun, GCRS axes"),
        "sunlit": (TIME, eclipse(reference.position_i, telemetry.time_utc), "1", "share of the Sun's disc in view"),
    }  # fmt: skip
    coordinates = {"time": telemetry.time_utc, "axis": list("xyz"), "quaternion": list("xyzw"), "axis_2": list("xyz")}
    if telemetry.rate_b is not None:
        columns["gyro_b"] = (VECTOR, telemetry.rate_b, "rad s-1", "rate gyro as the file gives it, body axes")
    if telemetry.sun_sensor:
        coordinates["face"] = list(telemetry.sun_sensor)
        stacked = np.stack(list(telemetry.sun_sensor.values()), axis=1)
        columns["sun_sensor"] = (("time", "face"), stacked, "1", "sun-sensor readings as the file gives them")
    variables = {
        name: (dims, values, {"units": units, "long_name": words, **_axes(name)})
        for name, (dims, values, units, words) in columns.items()
    }
    attrs = {
        "title": f"Attitude of {telemetry.name} from its magnetometer",
        "Conventions": "CF-1.11",
        "verdict": verdict["sentence"],
        "usable": int(verdict["usable"]),
        "verdict_json": json.dumps(verdict),
        "provenance_json": json.dumps(provenance),
    }
    return xr.Dataset(variables, coordinates, attrs)


def _std(covariance: np.ndarray) -> np.ndarray:
    """(n, 3) roots of the diagonals."""
    return np.sqrt(np.maximum(covariance[:, [0, 1, 2], [0, 1, 2]], 0.0))


def _axes(name: str) -> dict:
    """Which axes a variable's components are in, from its name's last letter."""
    axes = {"i": "GCRS", "b": "body, the magnetometer's as the file gives them", "s": "raw sensor, the same as body"}
    letter = name.rsplit("_", 1)[-1]
    return {"axes": axes[letter]} if letter in axes else {}


def continuous(q: np.ndarray) -> np.ndarray:
    """(n, 4) quaternions whose sign does not jump from row to row; the first scalar is not negative."""
    flips = np.cumsum(np.r_[q[0, 3] < 0.0, np.sum(q[1:] * q[:-1], axis=1) < 0.0]) % 2
    return q * np.where(flips, -1.0, 1.0)[:, None]
