"""Attitude as CSV: one row for each sample, units in the names.

`scipy.spatial.transform.Rotation.from_quat([q_bi_x, q_bi_y, q_bi_z, q_bi_w]).apply(v_b)` is v_i (GCRS).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fieldline.errors import InputError
from fieldline.files import write_whole
from fieldline.telemetry.delimited import iso_text, write_rows

AXES = "xyz"
# Variable of the Dataset, column pattern, factor from SI, decimals that the file keeps.
_VECTORS = (
    ("omega_bi_b", "omega_{}_deg_s", 180.0 / np.pi, 9),
    ("attitude_std_b", "attitude_std_{}_deg", 180.0 / np.pi, 9),
    ("omega_std_b", "omega_std_{}_deg_s", 180.0 / np.pi, 9),
    ("residual_b", "residual_{}_nT", 1e9, 6),
)


def attitude_columns(dataset) -> dict[str, np.ndarray]:
    """Columns of the file, in order, from the Dataset of `estimate_attitude`."""
    need = ["q_bi", "time", "used", *(name for name, _, _, _ in _VECTORS)]
    missing = [name for name in need if name not in dataset.variables]
    if missing:
        raise InputError(f"the Dataset has no {', '.join(missing)}; attitude files are written from that of estimate_attitude.")
    columns = {"time_utc": iso_text(dataset["time"].values)}
    for k, name in enumerate("xyzw"):
        columns[f"q_bi_{name}"] = np.round(dataset["q_bi"].values[:, k], 12)
    for variable, pattern, factor, decimals in _VECTORS:
        for k, axis in enumerate(AXES):
            columns[pattern.format(axis)] = np.round(dataset[variable].values[:, k] * factor, decimals)
    columns["used"] = dataset["used"].values.astype(bool)
    return columns


def write_attitude_csv(dataset, path: str | Path) -> Path:
    """Write `dataset` of `estimate_attitude` to `path`: whole or not at all."""
    columns = attitude_columns(dataset)

    def write(beside: Path) -> None:
        with open(beside, "wb") as sink:
            write_rows(sink, columns)

    return write_whole(path, write)
