"""NetCDF tables: every variable along the time dimension, vectors of three spread into axes, units from attributes."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from fieldline.errors import InputError
from fieldline.telemetry.table import Source, spread_vectors, table_of_arrays


def open_netcdf(path: Path) -> Source:
    """A NetCDF file (3 or 4)."""
    import xarray as xr

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what other writers leave out is not the user's concern
        try:
            with xr.open_dataset(path, engine="netcdf4") as dataset:
                return _open(path, dataset.load())
        except InputError:
            raise
        except Exception as error:  # the readers below raise many kinds, all of which mean a file that cannot be read
            raise InputError(f'"{path}" begins like a NetCDF file and cannot be read ({str(error)[:200]}).') from error


def _open(path: Path, dataset) -> Source:
    along = _sample_dimension(dataset)
    if not along or dataset.sizes[along] == 0:
        raise InputError(f'NetCDF file "{path}" has no samples; its dimensions are {dict(dataset.sizes)}.')
    arrays: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}
    for name, variable in dataset.variables.items():
        if variable.dims[:1] != (along,):
            continue
        for part, values in spread_vectors(str(name), variable.values).items():
            arrays[part] = values
            units[part] = str(variable.attrs.get("units", ""))
    return table_of_arrays(path, "NetCDF", arrays, units)


def _sample_dimension(dataset) -> str:
    """The dimension of the samples: the one called time, else that of a time coordinate, else the longest."""
    for name in dataset.sizes:
        if str(name).lower() == "time":
            return str(name)
    for variable in dataset.variables.values():
        if variable.dtype.kind == "M" and variable.ndim == 1:
            return str(variable.dims[0])
    return str(max(dataset.sizes, key=lambda name: dataset.sizes[name])) if dataset.sizes else ""
