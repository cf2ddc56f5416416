"""Rows of numbers as text, quickly and in bounded memory: blocks of rows through Arrow's CSV writer.

Numbers appear in the shortest form that reads back as the same float64; a missing one is an empty cell.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import BinaryIO

import numpy as np

BLOCK_ROWS = 100_000


def write_rows(sink: BinaryIO, columns: Mapping[str, np.ndarray], *, delimiter: str = ",", header: bool = True) -> None:
    """Write columns (n,) of floats, integers, bools (as 1 and 0) or text."""
    import pyarrow as pa
    from pyarrow import csv

    types = {"f": pa.float64(), "i": pa.int64(), "u": pa.int64(), "b": pa.int8(), "U": pa.string()}
    schema = pa.schema([(name, types[values.dtype.kind]) for name, values in columns.items()])
    count = len(next(iter(columns.values())))
    options = csv.WriteOptions(include_header=False, delimiter=delimiter, quoting_style="none")
    if header:
        sink.write((delimiter.join(columns) + "\n").encode())
    with csv.CSVWriter(sink, schema, write_options=options) as writer:
        for start in range(0, count, BLOCK_ROWS):
            part = slice(start, start + BLOCK_ROWS)
            arrays = [
                pa.array(values[part].astype(np.int8) if values.dtype.kind == "b" else values[part], type=kind, from_pandas=True)
                for values, kind in zip(columns.values(), schema.types, strict=True)
            ]
            writer.write_batch(pa.record_batch(arrays, schema=schema))


def iso_text(time_utc: np.ndarray, zone: str = "Z") -> np.ndarray:
    """(n,) ISO 8601 text with as many digits of the second as the times need: 3, 6 or 9."""
    ns = time_utc.astype("datetime64[ns]").astype(np.int64)
    unit = "ms" if not (ns % 1_000_000).any() else "us" if not (ns % 1000).any() else "ns"
    text = np.datetime_as_string(time_utc, unit=unit)
    return np.char.add(text, zone) if zone else text
