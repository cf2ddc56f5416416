"""Progress on stderr: a line for every finished stage, and on a terminal a bar for the one that runs.

The estimator calls `progress(stage, done, total, words="")`; a stage is finished when done reaches total.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Protocol

DOTTED_TO = 24  # the column that the dots reach


class Progress(Protocol):
    """What an estimator calls to say how far it is."""

    def __call__(self, stage: str, done: float, total: float, words: str = "") -> None:
        """`done` of `total` of a stage; the words stand in its line."""


@contextmanager
def progress_on_stderr(quiet: bool) -> Iterator[Progress]:
    """A silent progress, plain lines, or lines with a bar where stderr is a terminal."""
    if quiet:
        yield lambda stage, done, total, words="": None
    elif not sys.stderr.isatty():
        yield PlainProgress()
    else:
        with _bars() as bars:
            yield TerminalProgress(bars)


def line_of(stage: str, words: str) -> str:
    """For example: reading flight.csv ……… 5,586 samples."""
    dots = "…" * max((DOTTED_TO - len(stage)) // 2, 1)
    return f"{stage} {dots} {words}" if words else stage


class PlainProgress:
    """A line for each finished stage, in order, once."""

    def __init__(self) -> None:
        self.told: set[str] = set()

    def __call__(self, stage: str, done: float, total: float, words: str = "") -> None:
        """Print the stage when it is finished."""
        line = line_of(stage, words)
        if done >= total and line not in self.told:
            self.told.add(line)
            print(line, file=sys.stderr, flush=True)


class TerminalProgress:
    """The same lines, with a live bar for the stage under way."""

    def __init__(self, bars: Any) -> None:
        self.bars = bars
        self.tasks: dict[str, Any] = {}
        self.plain = PlainProgress()

    def __call__(self, stage: str, done: float, total: float, words: str = "") -> None:
        """Move the stage's bar, or replace it by its line."""
        if done >= total:
            if stage in self.tasks:
                self.bars.remove_task(self.tasks.pop(stage))
            self.plain(stage, done, total, words)
        elif stage in self.tasks:
            self.bars.update(self.tasks[stage], completed=done, total=total, words=words)
        else:
            self.tasks[stage] = self.bars.add_task(stage, completed=done, total=total, words=words)


def _bars() -> Any:
    """Rich's bars, which vanish when done; ordinary prints appear above them."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

    columns = (
        TextColumn("{task.description}"),
        BarColumn(bar_width=24),
        TaskProgressColumn(),
        TextColumn("{task.fields[words]}"),
    )
    return Progress(*columns, console=Console(stderr=True), transient=True, refresh_per_second=10)
