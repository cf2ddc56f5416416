"""Parquet tables: flat columns, vectors as lists of three or as structures, times with or without a zone."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fieldline.errors import InputError
from fieldline.telemetry.table import AXES, Source, Table

_UNIT_KEYS = (b"units", b"unit", b"UNITS")


def open_parquet(path: Path) -> Source:
    """A Parquet file; only the columns that are asked for are read."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        file = pq.ParquetFile(path)
        schema = file.schema_arrow
        first = next(file.iter_batches(batch_size=1), None)
    except (pa.ArrowException, OSError, ValueError) as error:
        raise InputError(f'"{path}" begins like a Parquet file and is damaged ({error}).') from error
    if first is None or first.num_rows == 0:
        raise InputError(f'telemetry file "{path}" has columns and no samples.')
    parts: dict[str, tuple[str, object]] = {}
    units: dict[str, str] = {}
    for field in schema:
        given = next((field.metadata[key].decode() for key in _UNIT_KEYS if field.metadata and key in field.metadata), "")
        for name, element in _parts(field, first.column(field.name)):
            parts[name] = (field.name, element)
            units[name] = given
    peek = {name: _column(first.column(whole), element)[0] for name, (whole, element) in parts.items()}

    def read(numbers: Sequence[str], texts: Sequence[str], repair: bool) -> Table:
        wanted = list(dict.fromkeys((*numbers, *texts)))
        try:
            table = file.read(columns=list(dict.fromkeys(parts[name][0] for name in wanted)))
        except (pa.ArrowException, OSError, ValueError) as error:
            raise InputError(f'Parquet file "{path}" is damaged ({error}).') from error
        columns = {}
        for name in wanted:
            whole, element = parts[name]
            columns[name] = _column(table.column(whole), element)
            if name in numbers:
                columns[name] = _as_numbers(path, name, columns[name])
        return Table(columns=columns)

    return Source(path=path, kind="Parquet", names=list(parts), peek=peek, read=read, units=units)


def _parts(field, column) -> list[tuple[str, object]]:
    """(name, element) of a column: one for numbers and times, three for vectors, one for each field of a structure."""
    import pyarrow as pa

    kind = field.type
    if pa.types.is_struct(kind):
        return [(f"{field.name}.{kind.field(k).name}", kind.field(k).name) for k in range(kind.num_fields)]
    if pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind):
        value = column[0].as_py()
        return [(f"{field.name}.{axis}", k) for k, axis in enumerate(AXES)] if value is not None and len(value) == 3 else []
    return [(field.name, None)]


def _column(column, element) -> np.ndarray:
    """A flat array of a column, of one field of its structures (text) or of one element of its vectors (number)."""
    import pyarrow as pa
    import pyarrow.compute as pc

    if element is not None:
        get = pc.struct_field if isinstance(element, str) else pc.list_element
        column = get(column, element)
    return column.to_numpy(zero_copy_only=False) if isinstance(column, pa.Array) else column.to_numpy()


def _as_numbers(path: Path, name: str, values: np.ndarray) -> np.ndarray:
    """float64, or an error that names the first row which is no number."""
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        for row, value in enumerate(values):
            try:
                float(value if value is not None else "nan")
            except (TypeError, ValueError):
                raise InputError(f'"{path}", row {row + 1}, column "{name}": "{value!s:.40}" is not a number.') from None
        return np.array([np.nan if value is None else float(value) for value in values])
