"""Tables in text: CSV and its relatives (comma, semicolon, tab, bar or blanks; decimal point or comma; gzip).

A regular file goes through Arrow's reader. Anything that Arrow refuses (a ragged row, a word among the numbers, a
comment in the middle) is read again row by row, which finds the line to name.
"""

from __future__ import annotations

import csv
import gzip
import io
import re
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fieldline.errors import InputError
from fieldline.telemetry.columns import recognise
from fieldline.telemetry.table import Source, Table, unique_names
from fieldline.telemetry.units import UNITS_OF, find_unit

HEAD_BYTES = 1 << 18
CHUNK_ROWS = 50_000
MISSING = ("", "nan", "NaN", "NAN", "na", "NA", "N/A", "n/a", "null", "NULL", "None", "none", "-", "--", "?")
_COMMENTS = ("#", "%", "//")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?$|[-+]?(nan|inf|infinity)$", re.I)
_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+([eE][-+]?\d+)?$")


@dataclass(frozen=True)
class Layout:
    """How a text table is written. `first_line` counts the physical lines before the first sample."""

    path: Path
    encoding: str
    packed: bool
    delimiter: str
    decimal: str
    names: list[str]
    first_line: int
    units: dict[str, str]
    peek: dict[str, str]


def open_text(path: Path) -> Source:
    """A text table: its layout is told from its first lines."""
    layout = find_layout(path)

    def read(numbers, texts, repair) -> Table:
        if layout.delimiter != " ":
            table = _read_regular(layout, numbers, texts)
            if table is not None:
                return table
        return _read_rows(layout, numbers, texts, repair)

    return Source(path=path, kind="text", names=layout.names, peek=layout.peek, read=read, units=layout.units)


def find_layout(path: Path) -> Layout:
    """The encoding, separator, decimal sign, header and units of a text table, from its first lines."""
    head, packed, whole = _head(path)
    encoding = _encoding(path, head)
    lines = head.decode(encoding, errors="replace").splitlines()
    return layout_of(path, lines if whole else lines[:-1], encoding, packed)  # the last is cut


def layout_of(path: Path, lines: Sequence[str], encoding: str = "utf-8", packed: bool = False) -> Layout:
    """The layout that the first lines of a table show; they must hold a sample at least."""
    _refuse_other_texts(path, lines)
    body = [(number, line) for number, line in enumerate(lines) if line.strip() and not is_comment(line)]
    if body and re.match(r"sep=.$", body[0][1].strip()):
        body = body[1:]
    if not body:
        raise InputError(f'telemetry file "{path}" holds no table: there are only comments or blank lines.')
    delimiter = _delimiter([line for _, line in body[:30]])
    header = cells_of(body[0][1], delimiter)
    rows = body[1:]
    if all(_is_number(cell, delimiter) for cell in header):
        rows = body
        header = _header_in_comments(lines[: body[0][0]], delimiter, len(header))
    names = unique_names([cell.strip().lstrip("\ufeff") for cell in header])
    units: dict[str, str] = {}
    if rows and _is_units_row(cells_of(rows[0][1], delimiter)):
        units = {name: cell.strip(" []()") for name, cell in zip(names, cells_of(rows[0][1], delimiter), strict=False)}
        rows = rows[1:]
    if not rows:
        raise InputError(f'telemetry file "{path}" has a header and no samples.')
    cells = [cells_of(line, delimiter) for _, line in rows[:200]]
    peek = {name: next((row[k] for row in cells if k < len(row) and row[k] not in MISSING), "") for k, name in enumerate(names)}
    comma = delimiter != "," and any(_DECIMAL_COMMA.match(cell) for row in cells for cell in row)
    return Layout(path, encoding, packed, delimiter, "," if comma else ".", names, rows[0][0], units, peek)


# What is often given by mistake: how it begins, and what to say.
_OTHER_TEXTS = (
    (r"<", "is a web page or XML, not a table; fetch the file itself, or export it as CSV"),
    (r"[\[{]", "is JSON, not a table; export it as CSV or Parquet"),
    (r"(.{0,30}\n)?1 [0-9A-Z ]{5}[UCS] ", "is a TLE; give it as --orbit, and the telemetry first"),
    (r"CCSDS_O[EM]M_VERS", "is an orbit message; give it as --orbit, and the telemetry first"),
)


def _refuse_other_texts(path: Path, lines: Sequence[str]) -> None:
    start = "\n".join(line for line in lines[:40] if line.strip())
    for pattern, what in _OTHER_TEXTS:
        if re.match(pattern, start.lstrip("\ufeff ")):
            raise InputError(f'"{path}" {what}.')


def _head(path: Path) -> tuple[bytes, bool, bool]:
    """The first bytes, unpacked; whether the file is packed; whether that is all of it."""
    with open(path, "rb") as file:
        packed = file.read(2) == b"\x1f\x8b"
    try:
        with gzip.open(path) if packed else open(path, "rb") as file:
            head = file.read(HEAD_BYTES)
            whole = not file.read(1)
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(f'telemetry file "{path}" is a damaged gzip file ({error}). Fetch it again.') from error
    if not head:
        raise InputError(f'telemetry file "{path}" is empty.')
    return head, packed, whole


def _encoding(path: Path, head: bytes) -> str:
    """UTF-8, UTF-16 by its mark, or Latin-1; binary files are refused."""
    if head[:2] in {b"\xff\xfe", b"\xfe\xff"}:
        return "utf-16"
    odd = sum(head.count(code) for code in range(32) if code not in b"\t\n\v\f\r")
    if b"\0" in head or odd > 0.01 * len(head):
        raise InputError(
            f'"{path}" is neither text nor a table that Fieldline knows (CSV, Parquet, NetCDF, CDF): it holds binary bytes.'
        )
    try:
        head[:-4].decode("utf-8") if len(head) > HEAD_BYTES - 4 else head.decode("utf-8")
    except UnicodeDecodeError as error:
        return "latin-1" if error.start < len(head) - 8 else "utf-8-sig"
    return "utf-8-sig"


def is_comment(line: str) -> bool:
    """Whether a line holds no row but a remark."""
    return line.lstrip("\ufeff \t").startswith(_COMMENTS)


def cells_of(line: str, delimiter: str) -> list[str]:
    """The cells of one line, without blanks and quotes around them."""
    if delimiter == " ":
        return [cell.strip('"') for cell in line.split()]
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])]
    except csv.Error:
        return line.split(delimiter)


def _delimiter(lines: Sequence[str]) -> str:
    """The separator that gives the most columns, the same number in most lines; a comma may be a decimal sign."""
    best, chosen = (0.0, 0), ","
    for delimiter in ("\t", ";", "|", ",", " "):
        counts = [len(cells_of(line, delimiter)) for line in lines]
        agree = counts.count(counts[0]) / len(counts)
        if counts[0] > 1 and (agree > 0.8, counts[0]) > best:
            best, chosen = (agree > 0.8, counts[0]), delimiter
        if delimiter in "\t;|" and counts[0] > 1 and agree > 0.8:
            return delimiter
    return chosen


def _is_number(cell: str, delimiter: str = ",") -> bool:
    return bool(_NUMBER.match(cell.strip()) or (delimiter != "," and _DECIMAL_COMMA.match(cell.strip())))


def _header_in_comments(lines: list[str], delimiter: str, count: int) -> list[str]:
    """The names in the last comment before the numbers, if they fit; else column_1, column_2 … for a mapping to name."""
    for line in reversed([line for line in lines if is_comment(line)]):
        cells = cells_of(line.lstrip("\ufeff #%/"), delimiter)
        if len(cells) == count and not any(_is_number(cell) for cell in cells):
            return cells
    return [f"column_{k + 1}" for k in range(count)]


def _is_units_row(cells: list[str]) -> bool:
    """Whether a row holds only units: no number, and at least a unit of a sensor."""
    cells = [cell.strip(" []()") for cell in cells]
    known = [cell for cell in cells if any(find_unit(cell, quantity) for quantity in UNITS_OF)]
    time_words = {"", "-", "s", "ms", "us", "ns", "utc", "iso", "sec", "seconds", "unix", "1"}
    return bool(known) and all(cell in known or cell.lower() in time_words for cell in cells) and not recognise(cells[0])


def _read_regular(layout: Layout, numbers: Sequence[str], texts: Sequence[str]) -> Table | None:
    """The columns through Arrow, or None where it stumbles."""
    import pyarrow as pa
    from pyarrow import csv as arrow_csv

    encoding = "utf8" if layout.encoding == "utf-8-sig" else layout.encoding
    wanted = list(dict.fromkeys((*numbers, *texts)))
    try:
        with pa.OSFile(str(layout.path)) as raw:
            stream = pa.CompressedInputStream(raw, "gzip") if layout.packed else raw
            table = arrow_csv.read_csv(
                stream,
                read_options=arrow_csv.ReadOptions(column_names=layout.names, skip_rows=layout.first_line, encoding=encoding),
                parse_options=arrow_csv.ParseOptions(delimiter=layout.delimiter),
                convert_options=arrow_csv.ConvertOptions(
                    include_columns=wanted,
                    column_types={name: pa.string() if name in texts else pa.float64() for name in wanted},
                    null_values=list(MISSING),
                    strings_can_be_null=False,
                    decimal_point=layout.decimal,
                ),
            )
    except (pa.ArrowException, OSError, UnicodeError, ValueError, EOFError):
        return None
    columns = {name: table.column(name).to_numpy() for name in wanted}
    return Table(columns=columns, place=lambda row: f"row {row + 1} (line {_line_of(layout, row)} of the file)")


def _rows(layout: Layout) -> Iterator[tuple[int, list[str]]]:
    """(line number, cells) of every sample, comments and blank lines left out."""
    opener = gzip.open if layout.packed else io.open
    with opener(layout.path, "rt", encoding=layout.encoding, errors="replace", newline="") as file:
        for line_number, line in enumerate(file, start=1):
            if line_number <= layout.first_line or not line.strip() or is_comment(line):
                continue
            yield line_number, cells_of(line.rstrip("\r\n"), layout.delimiter)


def _line_of(layout: Layout, row: int) -> int:
    """The line of the file that holds sample `row`."""
    for count, (line_number, _) in enumerate(_rows(layout)):
        if count == row:
            return line_number
    return -1


def _read_rows(layout: Layout, numbers: Sequence[str], texts: Sequence[str], repair: bool) -> Table:
    """The columns row by row: slower, and knows the line of every fault."""
    wanted = list(dict.fromkeys((*numbers, *texts)))
    index = [layout.names.index(name) for name in wanted]
    parts: dict[str, list[np.ndarray]] = {name: [] for name in wanted}
    lines: list[np.ndarray] = []
    dropped, chunk = 0, []
    try:
        for line_number, cells in _rows(layout):
            extra = [cell for cell in cells[len(layout.names) :] if cell]
            if len(cells) < len(layout.names) or extra:
                _refuse_ragged(layout, line_number, len(cells), repair)
                dropped += 1
                continue
            chunk.append((line_number, [cells[k] for k in index]))
            if len(chunk) == CHUNK_ROWS:
                dropped += _convert(layout, chunk, wanted, numbers, parts, lines, repair)
                chunk = []
    except (OSError, EOFError, zlib.error) as error:
        raise InputError(f'telemetry file "{layout.path}" is damaged ({error}). Fetch it again.') from error
    dropped += _convert(layout, chunk, wanted, numbers, parts, lines, repair)
    line_of = np.concatenate(lines) if lines else np.zeros(0, int)
    columns = {name: np.concatenate(values) if values else np.zeros(0) for name, values in parts.items()}
    return Table(columns=columns, dropped=dropped, place=lambda row: f"row {row + 1} (line {line_of[row]} of the file)")


def _refuse_ragged(layout: Layout, line_number: int, count: int, repair: bool) -> None:
    if not repair:
        raise InputError(
            f'"{layout.path}", line {line_number}: {count} columns where the header has {len(layout.names)}. '
            "Is the line cut off? Mend it, or drop such rows with --repair (repair=True)."
        )


def _convert(layout, chunk, wanted, numbers, parts, lines, repair) -> int:
    """Append a chunk of rows to `parts` and `lines`; the number of rows that repair dropped."""
    good = np.ones(len(chunk), dtype=bool)
    columns = {}
    for k, name in enumerate(wanted):
        cells = [row[k] for _, row in chunk]
        columns[name] = np.array(cells, dtype=object)
        if name in numbers:
            columns[name], bad = _numbers(cells, layout.decimal)
            if bad and not repair:
                line_number = chunk[bad[0]][0]
                raise InputError(
                    f'"{layout.path}", line {line_number}, column "{name}": "{cells[bad[0]]:.40}" is not a number. '
                    "Correct it, or drop such rows with --repair (repair=True)."
                )
            good[bad] = False
    for name in wanted:
        parts[name].append(columns[name][good])
    lines.append(np.array([line_number for line_number, _ in chunk], dtype=np.int64)[good])
    return int((~good).sum())


def _numbers(cells: list[str], decimal: str) -> tuple[np.ndarray, list[int]]:
    """The cells as numbers (missing ones NaN) and the places of those that are none."""
    values, bad = np.full(len(cells), np.nan), []
    for k, cell in enumerate(cells):
        text = cell.replace(",", ".") if decimal == "," else cell
        if _NUMBER.match(text):
            values[k] = float(text)
        elif cell not in MISSING:
            bad.append(k)
    return values, bad
