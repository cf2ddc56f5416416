"""A file of samples as a table: the names of its columns, the units it states, and the columns that are asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from fieldline.errors import InputError

AXES = "xyz"


@dataclass(frozen=True, kw_only=True)
class Table:
    """Columns (n,) as read: float64, datetime64[ns] or text (object). `dropped` rows could not be read (repair)."""

    columns: dict[str, np.ndarray]
    dropped: int = 0
    place: Callable[[int], str] = lambda row: f"row {row + 1}"


@dataclass(frozen=True, kw_only=True)
class Source:
    """An opened file. `peek` holds a first value of each column; `read(numbers, texts, repair)` gives the table."""

    path: Path
    kind: str
    names: Sequence[str]
    peek: Mapping[str, object]
    read: Callable[[Sequence[str], Sequence[str], bool], Table]
    units: Mapping[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def open_table(path) -> Source:
    """Open a table of any known kind, told by its first bytes and not by its name."""
    path = Path(path)
    if not path.exists():
        raise InputError(f'telemetry file "{path}" does not exist. Check the path.')
    if path.is_dir():
        raise InputError(f'"{path}" is a folder; name the telemetry file in it.')
    try:
        with open(path, "rb") as file:
            first = file.read(8)
    except OSError as error:
        raise InputError(f'telemetry file "{path}" cannot be read: {error.strerror}.') from error
    if not first:
        raise InputError(f'telemetry file "{path}" is empty.')
    if first[:4] == b"PAR1":
        from fieldline.telemetry.parquet import open_parquet as opener
    elif first[:4] in {b"CDF\x01", b"CDF\x02", b"CDF\x05", b"\x89HDF"}:
        from fieldline.telemetry.netcdf import open_netcdf as opener
    elif first[:4] in {b"\xcd\xf3\x00\x01", b"\xcd\xf2\x60\x02", b"\x00\x00\xff\xff"}:
        from fieldline.telemetry.cdf import open_cdf as opener
    elif first[:4] in {b"PK\x03\x04", b"\xd0\xcf\x11\xe0"}:
        raise InputError(f'"{path}" is a spreadsheet or an archive; export the sheet as CSV, or unpack the archive, first.')
    else:
        from fieldline.telemetry.text import open_text as opener
    return opener(path)


def listed(names: Sequence[str]) -> str:
    """Column names for a message: all of them, or the first forty."""
    short = [name[:60] for name in names[:40]]
    return ", ".join(short) + (f" and {len(names) - 40} more" if len(names) > 40 else "")


def unique_names(names: Sequence[str]) -> list[str]:
    """The names with repeated ones numbered, as "mag_x (2)"."""
    seen: dict[str, int] = {}
    unique = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        unique.append(name if seen[name] == 1 else f"{name} ({seen[name]})")
    return unique


def table_of_arrays(path: Path, kind: str, arrays: dict[str, np.ndarray], units: dict[str, str], notes=()) -> Source:
    """A source whose columns are in memory already."""

    def read(numbers, texts, repair) -> Table:
        chosen = {}
        for name in (*numbers, *texts):
            values = arrays[name]
            if name in numbers:
                try:
                    values = np.asarray(values, dtype=float)
                except (TypeError, ValueError) as error:
                    raise InputError(f'"{path}": column "{name}" holds {values.dtype} where numbers are expected.') from error
            chosen[name] = values
        return Table(columns=chosen)

    peek = {name: values[0] for name, values in arrays.items() if len(values)}
    return Source(path=path, kind=kind, names=list(arrays), peek=peek, read=read, units=units, notes=tuple(notes))


def spread_vectors(name: str, values: np.ndarray) -> dict[str, np.ndarray]:
    """A column (n,) as it is, one of vectors (n, 3) as name.x, name.y, name.z; other shapes give nothing."""
    if values.ndim == 1:
        return {name: values}
    if values.ndim == 2 and values.shape[1] == 3:
        return {f"{name}.{axis}": values[:, k] for k, axis in enumerate(AXES)}
    return {}
