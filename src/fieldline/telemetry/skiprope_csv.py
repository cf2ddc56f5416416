"""Skiprope as CSV: a row for each time of the answer, units in the names; the next three crossings of the chosen plane last.

phase: a1 = a cos(phase), a2 = a sin(phase). sense: 1 from the orbit's normal towards the rear, -1 back, 0 not to be told.
plane: azimuth of the tether's middle from the orbit's normal towards the rear. u, v: its place along velocity and normal.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fieldline.errors import InputError
from fieldline.files import write_whole
from fieldline.telemetry.delimited import iso_text, write_rows

DEGREE = 180.0 / np.pi
# Name in the answer, column, factor from SI, decimals.
_COLUMNS = (
    ("amplitude_rad", "amplitude_deg", DEGREE, 6),
    ("frequency_hz", "frequency_hz", 1.0, 9),
    ("sense", "sense", 1, 0),
    ("phase_rad", "phase_deg", DEGREE, 4),
    ("deflection_m", "deflection_m", 1.0, 4),
    ("amplitude_std_rad", "amplitude_std_deg", DEGREE, 6),
    ("frequency_std_hz", "frequency_std_hz", 1.0, 9),
    ("phase_std_rad", "phase_std_deg", DEGREE, 4),
    ("deflection_std_m", "deflection_std_m", 1.0, 4),
    ("plane_rad", "plane_deg", DEGREE, 4),
    ("plane_std_rad", "plane_std_deg", DEGREE, 4),
    ("major_rad", "major_deg", DEGREE, 6),
    ("minor_rad", "minor_deg", DEGREE, 6),
)


def skiprope_columns(answer: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Columns of the file, in order, from the answer's arrays by name: `time`, amplitude_rad …, crossing_time (m, 3)."""
    need = ["time", "position_m", "trusted", "crossing_time", *(name for name, _, _, _ in _COLUMNS)]
    missing = [name for name in need if name not in answer]
    if missing:
        raise InputError(f"the answer has no {', '.join(missing)}; skiprope files are written from that of estimate_skiprope.")
    columns = {"time_utc": _stamps(answer["time"])}
    for name, column, factor, decimals in _COLUMNS:
        values = np.asarray(answer[name])
        columns[column] = values.astype(np.int64) if decimals == 0 else np.round(values * factor, decimals)
    for k, name in enumerate(("u_m", "v_m")):
        columns[name] = np.round(np.asarray(answer["position_m"])[:, k], 4)
    columns["trusted"] = np.asarray(answer["trusted"]).astype(bool)
    for k in range(np.shape(answer["crossing_time"])[1]):
        columns[f"crossing_{k + 1}_utc"] = _stamps(np.asarray(answer["crossing_time"])[:, k])
        columns[f"crossing_{k + 1}_std_s"] = np.round(np.asarray(answer["crossing_std_s"])[:, k], 3)
        side = np.where(np.asarray(answer["crossing_towards"])[:, k], "1", "0")
        columns[f"crossing_{k + 1}_towards"] = np.where(columns[f"crossing_{k + 1}_utc"] == "", "", side)
    return columns


def write_skiprope_csv(dataset, path: str | Path) -> Path:
    """Write the Dataset of `estimate_skiprope` to `path`: whole or not at all."""
    columns = skiprope_columns({str(name): variable.values for name, variable in dataset.variables.items()})

    def write(beside: Path) -> None:
        with open(beside, "wb") as sink:
            write_rows(sink, columns)

    return write_whole(path, write)


def skiprope_line(columns: Mapping[str, np.ndarray], row: int = -1) -> str:
    """One row of the columns as a line of the file, as `write_skiprope_csv` writes it."""
    sink = io.BytesIO()
    at = row % len(columns["time_utc"])
    write_rows(sink, {name: values[at : at + 1] for name, values in columns.items()}, header=False)
    return sink.getvalue().decode().rstrip("\n")


def _stamps(times) -> np.ndarray:
    """(n,) ISO 8601 to the millisecond, empty where there is none."""
    values = np.asarray(times, dtype="datetime64[ns]")
    if not len(values):
        return np.zeros(0, dtype="U24")
    known = ~np.isnat(values)
    rounded = (values.astype(np.int64) + 500_000) // 1_000_000
    text = iso_text(np.where(known, rounded, 0).astype("datetime64[ms]"))
    return np.where(known, text, "")
