"""The skiprope of a stream: an estimate every so often, of the rows within a memory, as a whole file of them would give it.

Estimates are due at whole multiples of a step since 1970. The one due at a time is made of the rows before it, once a row at
or after it has come; so the answers do not depend on how the rows were cut into pieces, nor on a restart between them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, NoEstimateError
from fieldline.estimation.skiprope_telemetry.dataset import answer_of, utc_after
from fieldline.estimation.skiprope_telemetry.plane import COUNT
from fieldline.estimation.skiprope_telemetry.solving import SkipropeSettings, Solved, solve_rows
from fieldline.orbit import Orbit
from fieldline.telemetry.averaging import SECOND_NS
from fieldline.telemetry.recent import Recent
from fieldline.telemetry.skiprope_csv import skiprope_columns, skiprope_line
from fieldline.telemetry.stream import Rows

FORMAT = "fieldline skiprope state 1"
MEMORY_PERIODS, MEMORY_S = 20.0, 4000.0
EVERY_PERIODS, EVERY_S = 0.5, 100.0  # three times as long for the harmonic method, which takes three times as long
LONGEST_MEMORY_S = 86400.0
_VECTORS = {"position_m": 2, "crossing_time": COUNT, "crossing_std_s": COUNT, "crossing_towards": COUNT}


class Said(NamedTuple):
    """What a stream gives: a row of the table ("line"), or a sentence ("word")."""

    kind: str
    text: str


class SkipropeStream:
    """Rows in, lines and words out. `latest` is the newest estimate, None before the first.

    memory_s : of the rows that an estimate is made of; twenty periods, or 4,000 s.      every_s : between estimates; half a
    period, or 100 s; for the harmonic method a period and a half, or 300 s.
    """

    def __init__(
        self,
        settings: SkipropeSettings,
        orbit: Orbit | None = None,
        *,
        memory_s: float | None = None,
        every_s: float | None = None,
    ):
        period = None if settings.frequency_hz is None else 1.0 / settings.frequency_hz
        usual = MEMORY_S if period is None else MEMORY_PERIODS * period
        memory = usual if memory_s is None else memory_s
        pace = 3.0 if settings.method == "harmonic" else 1.0
        usual = pace * (EVERY_S if period is None else EVERY_PERIODS * period)
        every = usual if every_s is None else every_s
        if not 1.0 <= every <= memory <= LONGEST_MEMORY_S:
            raise InputError(
                f"an estimate every {every:g} s of a memory of {memory:g} s: the step must be 1 s or more, and the memory no "
                f"shorter than the step and no longer than {LONGEST_MEMORY_S:g} s."
            )
        self.settings, self.orbit = settings, orbit
        self.every_ns = max(round(every), 1) * SECOND_NS
        self.recent = Recent(memory)
        if not settings.averages:
            self.recent.fast = False
        self.due_ns: int | None = None
        self.lines = 0
        self.status = ""
        self.told_beyond = False  # that the table of lengths does not reach the rows
        self.latest: Solved | None = None

    @property
    def header(self) -> str:
        """The names of the columns of the lines."""
        return ",".join(skiprope_columns(_nothing(np.datetime64(0, "ns"))))

    def take(self, rows: Rows) -> list[Said]:
        """Add rows as they came; what there is to say after them."""
        said: list[Said] = []
        while len(rows.time_utc):
            ns = rows.time_utc.astype(np.int64)
            late = self.recent.late(ns)
            if late:  # rows from before the newest move no clock until they are enough
                said += self._add(rows.where(slice(0, late)))
                rows = rows.where(slice(late, None))
                continue
            ns = ns[: (np.flatnonzero(np.diff(ns) <= 0) + 1).min(initial=len(ns))]
            beyond = np.flatnonzero(ns >= self.due_ns) if self.due_ns is not None else np.arange(1)
            count = int(beyond[0]) if len(beyond) else len(ns)
            if count:
                said += self._add(rows.where(slice(0, count)))
                rows = rows.where(slice(count, None))
                continue
            if self.due_ns is not None:
                said += self._estimate(self.due_ns)
            self.due_ns = (int(ns[0]) // self.every_ns + 1) * self.every_ns
        return said

    def finish(self) -> list[Said]:
        """An estimate of all rows to the newest, where one came after the last estimate."""
        if self.recent.last_ns is None:
            return []
        return self._estimate(self.recent.last_ns + 1)

    def _add(self, rows: Rows) -> list[Said]:
        before = self.recent.counts["restarts"], self.recent.clock_changes
        said = [Said("word", one) for one in self.recent.take(rows)]
        if (self.recent.counts["restarts"], self.recent.clock_changes) != before and self.recent.last_ns is not None:
            self.due_ns = (self.recent.last_ns // self.every_ns + 1) * self.every_ns
        return said

    def _estimate(self, until_ns: int) -> list[Said]:
        """A line, and a sentence where the state of things has changed."""
        rows = self.recent.stretch(until_ns)
        self.latest = None
        at = np.datetime64(until_ns, "ns") if not len(rows.time_utc) else rows.time_utc[-1]
        answer, status = _nothing(at), ""
        try:
            self.latest = solved = solve_rows(rows, self.orbit, self.settings)
            status = "nothing"
            words = solved.estimate.verdict
            if solved.estimate.detected:
                answer = {name: column[1][-1:] for name, column in answer_of(solved).items()}
                answer["time"] = utc_after(solved.rows.time_utc[0], solved.estimate.seconds[-1:])
                status = "trusted" if solved.estimate.trusted[-1] else "not to be trusted yet"
        except NoEstimateError as error:
            status, words = "waiting", str(error)
        said = [] if status == self.status else [Said("word", f"{_iso(at)}: {words}")]
        if self.settings.lengths is not None and self.latest is not None and not self.told_beyond:
            beyond = self.settings.lengths.beyond(self.latest.rows.time_utc)
            said += [Said("word", f"{_iso(at)}: {one}") for one in beyond]
            self.told_beyond = bool(beyond)
        self.status = status
        self.lines += 1
        return [*said, Said("line", skiprope_line(skiprope_columns(answer)))]

    def state(self) -> dict:
        """All that is needed to go on, in plain types."""
        return {
            "format": FORMAT,
            "settings": self._told(),
            "recent": self.recent.state(),
            "due_ns": self.due_ns,
            "lines": self.lines,
            "status": self.status,
        }

    def resume(self, state: dict, where: str) -> None:
        """Go on from a state; InputError where it is none, or was made with other settings."""
        if not isinstance(state, dict) or state.get("format") != FORMAT:
            raise InputError(f"{where} is no state of a skiprope stream of this version. Remove it to begin anew.")
        told = self._told()
        kept = state.get("settings")
        for name, value in told.items():
            if not isinstance(kept, dict) or kept.get(name) != value:
                was = kept.get(name) if isinstance(kept, dict) else None
                raise InputError(
                    f"{where} was made with {name} = {was}, and {value} is asked for now. Ask for the same, or remove it to "
                    "begin anew."
                )
        try:
            self.recent = Recent.from_state(state["recent"])
            self.due_ns = None if state["due_ns"] is None else int(state["due_ns"])
            self.lines, self.status = int(state["lines"]), str(state["status"])
        except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
            raise InputError(f"{where} is damaged ({type(error).__name__}: {error}). Remove it to begin anew.") from error

    def _told(self) -> dict:
        return {**self.settings.described(), "memory_ns": self.recent.memory_ns, "every_ns": self.every_ns}


def _nothing(at: np.datetime64) -> dict:
    """The answer of a time without one."""
    blank = np.array([np.nan])
    names = [f"{one}{kind}_rad" for one in ("amplitude", "phase", "plane", "major", "minor") for kind in ("", "_std")]
    answer = dict.fromkeys([*names, "frequency_hz", "frequency_std_hz", "deflection_m", "deflection_std_m"], blank)
    answer |= {name: np.full((1, size), np.nan) for name, size in _VECTORS.items()}
    answer["crossing_time"] = np.full((1, COUNT), np.datetime64("NaT", "ns"))
    answer["crossing_towards"] = np.zeros((1, COUNT), dtype=bool)
    return answer | {"time": np.array([at]), "sense": np.array([0]), "trusted": np.array([False])}


def _iso(time: np.datetime64) -> str:
    return str(np.datetime_as_string(time, unit="s")) + "Z"
