"""Rows of a text table as they come, from standard input or a file that still grows.

The first lines show the layout and the columns, as in a whole file; from then on each line becomes a row. A line that cannot
be read is passed over and counted: a stream cannot be sent back to be mended. A line that is not ended yet waits for its end.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, shown
from fieldline.telemetry.choice import Choice, choose
from fieldline.telemetry.clock import TimeColumn, to_utc
from fieldline.telemetry.mapping import Mapping
from fieldline.telemetry.position import position_in_itrs
from fieldline.telemetry.quality import FILL_BEYOND
from fieldline.telemetry.table import Source, Table
from fieldline.telemetry.text import Layout, cells_of, is_comment, layout_of

HEAD_LINES = 400  # within which a table must have shown itself


class Rows(NamedTuple):
    """n rows: UTC, the raw field [T], yaw [rad] and position [m, ITRS], NaN where there is none."""

    time_utc: np.ndarray
    field_s: np.ndarray
    yaw_rad: np.ndarray
    position_e: np.ndarray

    def where(self, rows) -> Rows:
        """Some of the rows."""
        return Rows(*(column[rows] for column in self))


class RowReader:
    """Lines in, rows out; `unreadable` counts lines that were none, `first_bad` shows the first of them."""

    def __init__(self, name: str, mapping: Mapping):
        self.name, self.mapping = Path(name), mapping
        self.head: list[str] = []
        self.layout: Layout | None = None
        self.choice: Choice | None = None
        self.index: list[int] = []
        self.factor: dict[str, float] = {}
        self.unreadable = 0
        self.first_bad = ""

    def feed(self, lines: Sequence[str]) -> Rows:
        """The rows of whole lines; none while the table has not shown its columns yet.

        Errors: InputError where the first lines are no table, or its columns cannot be told.
        """
        if self.choice is None:
            self.head += lines
            if not self._began():
                return no_rows()
            assert self.layout is not None
            lines, self.head = self.head[self.layout.first_line :], []
        return self._rows(lines)

    def finish(self) -> None:
        """No more lines: InputError where there never was a table."""
        if self.choice is None:
            if not any(line.strip() for line in self.head):
                raise InputError(f'"{self.name}" is empty: no line came.')
            layout_of(self.name, self.head)
            raise InputError(f'"{self.name}" ended before its first sample.')

    def columns(self) -> list[str]:
        """The names of the columns that are read, for the record."""
        assert self.choice is not None
        return [*self.choice.time.names, *self.choice.numbers()]

    def _began(self) -> bool:
        """Whether the lines so far show a header and a sample; the columns are chosen then."""
        told = [line for line in self.head if line.strip() and not is_comment(line)]
        if len(told) < 3:  # a header, perhaps its units, and a sample
            if len(self.head) > HEAD_LINES:
                raise InputError(f'"{self.name}": the first {HEAD_LINES} lines hold no table, only comments or blank lines.')
            return False
        self.layout = layout = layout_of(self.name, self.head)

        def read(numbers, texts, repair) -> Table:
            raise InputError(f'"{self.name}" is read row by row.')

        source = Source(path=self.name, kind="text", names=layout.names, peek=layout.peek, read=read, units=layout.units)
        self.choice = choice = choose(source, self.mapping)
        self.factor = {column.name: column.unit.factor if column.unit else np.nan for column in choice.columns()}
        names = [column.name for column in choice.magnetometer]
        if any(np.isnan(self.factor[name]) for name in names):
            raise InputError(
                f'"{self.name}": the magnetometer columns {", ".join(names)} do not say their unit, and a stream cannot be '
                "weighed beforehand: say --unit nT, or what it is."
            )
        self.index = [layout.names.index(name) for name in self.columns()]
        return True

    def _rows(self, lines: Sequence[str]) -> Rows:
        """Lines as rows, in the order of the file."""
        assert self.layout is not None and self.choice is not None
        layout, choice = self.layout, self.choice
        clocks, times, numbers = len(choice.time.names), [], []
        for line in lines:
            text = line.rstrip("\r\n")
            if not text.strip() or is_comment(text):
                continue
            cells = (
                text.split(layout.delimiter) if '"' not in text and layout.delimiter != " " else cells_of(text, layout.delimiter)
            )
            try:
                if len(cells) != len(layout.names):
                    raise ValueError
                values = [_number(cells[k], layout.decimal) for k in self.index[clocks:]]
                times.append(_utc(choice.time, [cells[k].strip() for k in self.index[:clocks]]))
                numbers.append(values)
            except (ValueError, InputError):
                if [cell.strip() for cell in cells] != layout.names:  # a header sent again is none to complain of
                    self.unreadable += 1
                    self.first_bad = self.first_bad or shown(text)
        return self._assembled(
            np.array(times, dtype="datetime64[ns]"), np.array(numbers, dtype=float).reshape(len(times), len(self.index) - clocks)
        )

    def _assembled(self, time_utc: np.ndarray, numbers: np.ndarray) -> Rows:
        """The columns that matter, in SI."""
        choice = self.choice
        assert choice is not None
        at = {name: k for k, name in enumerate(choice.numbers())}
        raw = np.stack([numbers[:, at[column.name]] for column in choice.magnetometer], axis=-1)
        field = raw * self.factor[choice.magnetometer[0].name]
        field[~np.isfinite(raw).all(axis=1) | (np.abs(raw) > FILL_BEYOND).any(axis=1) | (raw == 0.0).all(axis=1)] = np.nan
        empty = no_rows(len(time_utc))
        yaw, position = empty.yaw_rad, empty.position_e
        if "yaw" in choice.singles:
            name = choice.singles["yaw"].name
            yaw = numbers[:, at[name]] * self.factor[name]
        if choice.position is not None and len(time_utc):
            named = zip(choice.position.names, choice.position.units, strict=True)
            values = np.stack([numbers[:, at[name]] * unit.factor for name, unit in named], axis=-1)
            position = position_in_itrs(self.name, choice.position, values, time_utc)
        return Rows(time_utc, field, yaw, position)


def no_rows(count: int = 0) -> Rows:
    """Rows of nothing."""
    nothing = np.full((count, 3), np.nan)
    return Rows(np.full(count, np.datetime64("NaT"), "datetime64[ns]"), nothing, nothing[:, 0].copy(), nothing.copy())


def joined_rows(parts: Sequence[Rows]) -> Rows:
    """Rows one after the other."""
    return Rows(*(np.concatenate(column) for column in zip(no_rows(), *parts, strict=True)))


def _number(cell: str, decimal: str) -> float:
    """A cell's number, NaN for an empty one; ValueError where it is none."""
    text = cell.strip()
    if not text:
        return np.nan
    return float(text.replace(",", ".") if decimal == "," else text)


def _count(text: str) -> int | float:
    """A time that counts, whole where it is: nanoseconds need it."""
    return int(text) if text.lstrip("-").isdigit() else float(text)


def _utc(column: TimeColumn, cells: list[str]) -> np.datetime64:
    """One stamp as UTC: a plain ISO stamp at once, anything else as a whole file's column is read."""
    text = "T".join(cells)
    if column.kind == "iso" and len(text) >= 20 and text[-1] in "Zz":
        stamp = np.datetime64(text[:-1], "ns")
    else:
        values = np.array([text if column.kind in {"iso", "datetime"} else _count(text)])
        stamp = to_utc("the stream", column, values, lambda row: "a row")[0][0]
    if np.isnat(stamp):
        raise ValueError
    return stamp
