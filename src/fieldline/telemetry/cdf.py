"""CDF tables, such as those of Swarm: variables along the records, vectors of three spread into axes, epochs as times."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np

from fieldline.errors import InputError
from fieldline.telemetry.table import Source, spread_vectors, table_of_arrays

_EPOCHS = {"CDF_EPOCH", "CDF_EPOCH16", "CDF_TIME_TT2000"}


def open_cdf(path: Path) -> Source:
    """A CDF file; fill values become NaN."""
    import cdflib

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            arrays, units = _variables(cdflib.CDF(path))
        except Exception as error:  # cdflib raises many kinds on a damaged file, all of which mean the same to a user
            raise InputError(f'"{path}" begins like a CDF file and cannot be read ({str(error)[:200]}).') from error
    longest = max((len(values) for values in arrays.values()), default=0)
    if longest == 0:
        raise InputError(f'CDF file "{path}" has no samples.')
    arrays = {name: values for name, values in arrays.items() if len(values) == longest}
    return table_of_arrays(path, "CDF", arrays, units)


def _variables(file) -> tuple[dict[str, np.ndarray], dict[str, str]]:
    """Columns and their units."""
    arrays: dict[str, np.ndarray] = {}
    units: dict[str, str] = {}
    info = file.cdf_info()
    for name in (*info.zVariables, *info.rVariables):
        inquiry = file.varinq(name)
        if not inquiry.Rec_Vary or inquiry.Last_Rec < 0:
            continue
        values = np.asarray(file.varget(name))
        attributes = file.varattsget(name)
        values = _times(values) if inquiry.Data_Type_Description in _EPOCHS else _filled(values, attributes.get("FILLVAL"))
        for part, column in spread_vectors(name, values).items():
            arrays[part] = column
            units[part] = str(attributes.get("UNITS", "")).strip()
    return arrays, units


def _times(values: np.ndarray) -> np.ndarray:
    from cdflib import cdfepoch

    return np.asarray(cdfepoch.to_datetime(values)).astype("datetime64[ns]")


def _filled(values: np.ndarray, fill) -> np.ndarray:
    """Fill values of a column of floats as NaN."""
    if fill is None or values.dtype.kind != "f" or np.ndim(fill) > 0:
        return values
    return np.where(values == fill, np.nan, values)
