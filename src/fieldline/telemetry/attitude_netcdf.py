"""Attitude as NetCDF 4: the whole Dataset of `estimate_attitude`, every variable with its units, axes and provenance."""

from __future__ import annotations

import errno
from pathlib import Path

import numpy as np

from fieldline.files import write_whole

_PER_MILLISECOND = {"milliseconds": 1_000_000, "microseconds": 1_000, "nanoseconds": 1}


def write_attitude_netcdf(dataset, path: str | Path) -> Path:
    """Write `dataset` to `path`, compressed: whole or not at all. `xarray.open_dataset` gives it back."""

    def write(beside: Path) -> None:
        try:
            dataset.to_netcdf(beside, engine="netcdf4", format="NETCDF4", encoding=_encoding(dataset))
        except RuntimeError as error:  # the HDF library reports a full disk as "HDF error"
            raise OSError(errno.EIO, f"the NetCDF library stopped ({error}), as it does when the disk is full") from error

    return write_whole(path, write)


def _encoding(dataset) -> dict[str, dict]:
    """Lossless compression of the large variables, and whole numbers of a unit that holds every time exactly."""
    encoding: dict[str, dict] = {}
    for name, variable in dataset.variables.items():
        if variable.dtype.kind == "M":
            ns = variable.values.astype("datetime64[ns]").astype(np.int64)
            unit = next(unit for unit, length in _PER_MILLISECOND.items() if not (ns % length).any())
            encoding[str(name)] = {
                "units": f"{unit} since 1970-01-01T00:00:00",
                "dtype": "int64",
                "calendar": "proleptic_gregorian",
            }
        elif variable.dtype.kind in "fi" and variable.size > 1000:
            encoding[str(name)] = {"zlib": True, "complevel": 1, "shuffle": True}
    return encoding
