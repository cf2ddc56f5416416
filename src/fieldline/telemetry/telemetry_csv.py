"""Telemetry as CSV, in SI units and with names that `read_telemetry` recognises, so that it reads back equal in every bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fieldline.files import write_whole
from fieldline.telemetry.delimited import iso_text, write_rows
from fieldline.telemetry.record import Telemetry

AXES = "xyz"
_VECTORS = (
    ("field_s", "mag_{}_T"),
    ("rate_b", "gyro_{}_rad_s"),
    ("dipole_command_b", "dipole_{}_A_m2"),
    ("position_e", "{}_itrs_m"),
)
_SINGLES = (("temperature_k", "mag_temperature_K"), ("solar_current", "solar_current_A"), ("yaw_rad", "yaw_rad"))


def telemetry_columns(telemetry: Telemetry) -> dict[str, np.ndarray]:
    """Columns of the file, in order."""
    columns = {"time_utc": iso_text(telemetry.time_utc)}
    for attribute, pattern in _VECTORS:
        values = getattr(telemetry, attribute)
        if values is not None:
            columns |= {pattern.format(axis): values[:, k] for k, axis in enumerate(AXES)}
    for face, values in telemetry.sun_sensor.items():
        columns[f"css_{'p' if face[0] == '+' else 'm'}{face[1]}"] = values
    for name, values in telemetry.wheel_speed.items():
        columns[f"wheel_speed_{name}_rad_s"] = values
    for attribute, name in _SINGLES:
        values = getattr(telemetry, attribute)
        if values is not None:
            columns[name] = values
    return {name: values if values.dtype.kind == "U" else np.asarray(values, dtype=float) for name, values in columns.items()}


def write_telemetry_csv(telemetry: Telemetry, path: str | Path) -> Path:
    """Write `telemetry` to `path`, raw values in SI units: whole or not at all."""
    columns = telemetry_columns(telemetry)

    def write(beside: Path) -> None:
        with open(beside, "wb") as sink:
            write_rows(sink, columns)

    return write_whole(path, write)
