"""The last stretch of a stream: rows in their order, averaged over seconds where they come fast, in bounded memory.

Streams misbehave. A row of a time that is known is a repeat and is passed over; so is one from before the newest. Where the
clock goes back and stays there, what came before is forgotten once SETBACK_ROWS rows agree on it, unless they say what is
known of those times already: then they are sent again. A silence longer than the memory forgets too. Fewer rows than that
after a leap ahead, and a clock that then goes on from before it, were the leap's fault: they alone are dropped. Each is told in
words.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError
from fieldline.telemetry.averaging import SECOND_NS, averaged, comes_fast, whole_seconds
from fieldline.telemetry.stream import Rows, joined_rows, no_rows

FIRST_ROWS = 16  # which say how fast rows come
SETBACK_ROWS = 30
NEVER = int(np.iinfo(np.int64).min)
SAME_FIELD_TESLA = 1e-6  # a row sent again is as near to what is known of its time
GAP_S = 60.0  # a longer silence is told
COUNTS = ("rows", "repeated", "behind", "without_field", "gaps", "restarts")


class Before(NamedTuple):
    """What there was before a leap of the clock ahead, and how many rows have come since."""

    done: Rows
    pending: Rows
    last_ns: int
    since: int


class Recent:
    """`rows` is the stretch; `take` adds to it and says what was odd; `counts` counts since the beginning."""

    def __init__(self, memory_s: float):
        self.memory_ns = int(memory_s * SECOND_NS)
        self.counts = dict.fromkeys(COUNTS, 0)
        self.fast: bool | None = None
        self.resumed = False
        self.told_again = False
        self.before: Before | None = None
        self.clock_changes = 0  # after which the newest row may be an older one
        self._forget()

    def _forget(self) -> None:
        self.done: list[Rows] = []
        self.pending = no_rows()  # of the second that is not over, or the first rows
        self.behind: list[Rows] = []
        self.last_ns: int | None = None

    @property
    def rows(self) -> Rows:
        """The stretch so far, whole seconds only."""
        self.done = [joined_rows(self.done)]
        return self.done[0]

    @property
    def newest_utc(self) -> np.datetime64 | None:
        """The time of the newest row."""
        return None if self.last_ns is None else np.datetime64(self.last_ns, "ns")

    def take(self, rows: Rows) -> list[str]:
        """Add rows in the order in which they came; sentences on what was odd about them."""
        if not len(rows.time_utc):
            return []
        self.counts["rows"] += len(rows.time_utc)
        self.counts["without_field"] += int((~np.isfinite(rows.field_s).all(axis=1)).sum())
        told = []
        while len(rows.time_utc):
            ns = rows.time_utc.astype(np.int64)
            known = NEVER if self.last_ns is None else self.last_ns
            before = np.maximum.accumulate(np.concatenate(([known], ns)))[:-1]
            newer = ns > before
            change = np.flatnonzero(newer != newer[0])
            count = int(change[0]) if len(change) else len(ns)  # rows of one kind, in their order
            told += self._append(rows.where(slice(0, count))) if newer[0] else self._odd(rows.where(slice(0, count)), known)
            rows = rows.where(slice(count, None))
        return told

    def late(self, ns: np.ndarray) -> int:
        """How many of the first rows are not newer than the newest, up to those of which a setback is judged."""
        if self.last_ns is None:
            return 0
        run = int((np.flatnonzero(ns > self.last_ns)).min(initial=len(ns)))
        return min(run, SETBACK_ROWS - sum(len(part.time_utc) for part in self.behind))

    def _odd(self, rows: Rows, newest: int) -> list[str]:
        """Rows that are not newer than the newest."""
        ns = rows.time_utc.astype(np.int64)
        repeated = ns == newest
        self.counts["repeated"] += int(repeated.sum())
        self.counts["behind"] += int((~repeated).sum())
        if self.resumed and self._is_sent_again(rows):  # a stream that begins anew after a restart sends what is known
            told, self.told_again = self.told_again, True
            words = (
                f"rows from {_iso(ns[0])} on are from before the newest, {_iso(newest)}, and passed over until newer ones come."
            )
            return [] if told else [words]
        first = self.counts["repeated"] + self.counts["behind"] == len(ns)
        told = []
        if first:
            what = "repeats a time" if repeated[0] else "is from before the newest"
            told.append(f"the row of {_iso(ns[0])} {what}; it and others like it are passed over and counted.")
        self.behind.append(rows.where(~repeated))
        late = joined_rows(self.behind)
        self.behind = [late]
        if len(late.time_utc) >= SETBACK_ROWS:
            self.behind = []
            told += self._set_back(late)
        return told

    def _set_back(self, late: Rows) -> list[str]:
        """Many rows from before the newest: sent again, or of a clock that was set back."""
        if self._is_known(late):
            told, self.told_again = self.told_again, True
            first = _iso(late.time_utc[0].astype(np.int64))
            return [] if told else [f"rows from {first} on were sent again; passed over."]
        ns = late.time_utc.astype(np.int64)
        rising = ns > np.maximum.accumulate(np.concatenate(([NEVER], ns)))[:-1]
        self.clock_changes += 1
        if self.before is not None and ns.min() > self.before.last_ns:
            return self._leap_undone(self.before, late.where(rising))
        words = (
            f"the clock went back from {_iso(self.last_ns)} to {_iso(ns[0])} and goes on from there: what came before is "
            "forgotten, and the estimate begins anew."
        )
        self.counts["restarts"] += 1
        self.counts["behind"] -= int(rising.sum())
        self._forget()
        self._append(late.where(rising))
        return [words]

    def _leap_undone(self, before: Before, late: Rows) -> list[str]:
        """The rows since a leap ahead dropped, as outnumbered by those that go on from before it."""
        words = (
            f"{before.since} rows up to {_iso(self.last_ns)} were ahead of the clock: dropped, and the rest goes on from before."
        )
        self.counts["behind"] -= len(late.time_utc)
        self.done, self.pending, self.last_ns, self.before = [before.done], before.pending, before.last_ns, None
        self._append(late)
        return [words]

    def _is_sent_again(self, rows: Rows) -> bool:
        """Whether the first rows after a restart may be of a stream that begins anew: known, or older than all that is kept."""
        first, kept = rows.time_utc.min(), self.rows.time_utc
        if self.before is not None and first.astype(np.int64) > self.before.last_ns:
            return False
        return not len(kept) or first < kept[0] or self._is_known(rows)

    def _is_known(self, late: Rows) -> bool:
        """Whether rows say of their times what the stretch says."""
        stretch = self.rows
        have = np.isfinite(stretch.field_s).all(axis=1)
        times, at = stretch.time_utc[have].astype(np.int64), late.time_utc.astype(np.int64)
        if not len(times) or at.min() < times[0] - SECOND_NS:
            return False
        origin = times[0]
        there = np.stack([np.interp(at - origin, times - origin, stretch.field_s[have, k]) for k in range(3)], axis=-1)
        return bool(np.nanmedian(np.linalg.norm(late.field_s - there, axis=1)) < SAME_FIELD_TESLA)

    def _append(self, rows: Rows) -> list[str]:
        """Rows that are newer than all before."""
        ns = rows.time_utc.astype(np.int64)
        told = []
        if self.before is not None:
            since = self.before.since + len(ns)
            self.before = self.before._replace(since=since) if since < SETBACK_ROWS else None
        if self.last_ns is not None:
            silence = int(ns[0]) - self.last_ns
            if silence > GAP_S * SECOND_NS and len(ns) < SETBACK_ROWS:
                self.before = Before(self.rows, self.pending, self.last_ns, len(ns))
            if silence > self.memory_ns:
                told.append(f"no row for {silence / SECOND_NS:.0f} s, longer than the memory: the estimate begins anew.")
                self.counts["restarts"] += 1
                self._forget()
            elif silence > GAP_S * SECOND_NS:
                told.append(f"no row for {silence / SECOND_NS:.0f} s before {_iso(ns[0])}.")
                self.counts["gaps"] += 1
        self.resumed, self.told_again, self.behind, self.last_ns = False, False, [], int(ns[-1])
        waiting = joined_rows([self.pending, rows])
        if self.fast is None:
            if len(waiting.time_utc) < FIRST_ROWS:
                self.pending = waiting
                return told
            self.fast = comes_fast(waiting.time_utc)
        if self.fast:
            seconds = whole_seconds(waiting.time_utc)
            over = seconds < seconds[-1]
            self.pending, waiting = waiting.where(~over), averaged(waiting.where(over))
        else:
            self.pending = no_rows()
        self.done.append(waiting)
        if len(self.done) > 1 and self.last_ns - self._first_ns() > 1.25 * self.memory_ns:
            self.done = [self._recent(self.rows)]
        return told

    def _first_ns(self) -> int:
        first = next((part.time_utc[0] for part in self.done if len(part.time_utc)), np.datetime64(self.last_ns, "ns"))
        return int(first.astype(np.int64))

    def _recent(self, rows: Rows) -> Rows:
        """The rows within the memory of the newest."""
        assert self.last_ns is not None
        return rows.where(rows.time_utc.astype(np.int64) > self.last_ns - self.memory_ns)

    def stretch(self, until_ns: int | None = None) -> Rows:
        """The rows within the memory before a time, that of the newest by default, which is then among them."""
        if self.last_ns is None:
            return no_rows()
        until = self.last_ns + 1 if until_ns is None else until_ns
        rows = joined_rows([self.rows, averaged(self.pending) if self.fast else self.pending])
        ns = rows.time_utc.astype(np.int64)
        return rows.where((ns >= until - self.memory_ns) & (ns < until))

    def state(self) -> dict:
        """All of it, in plain types that JSON holds to the last bit."""
        return {
            "memory_ns": self.memory_ns,
            "counts": dict(self.counts),
            "fast": self.fast,
            "last_ns": self.last_ns,
            "done": _plain(self._recent(self.rows) if self.last_ns is not None else no_rows()),
            "pending": _plain(self.pending),
            "before": None if self.before is None else [*map(_plain, self.before[:2]), *self.before[2:]],
        }

    @classmethod
    def from_state(cls, state: dict) -> Recent:
        """A stretch that goes on; what the stream sends again of it is passed over in silence."""
        recent = cls(state["memory_ns"] / SECOND_NS)
        recent.counts = {name: int(state["counts"][name]) for name in COUNTS}
        recent.fast, recent.last_ns = state["fast"], state["last_ns"]
        recent.done, recent.pending = [_rows(state["done"])], _rows(state["pending"])
        if state.get("before"):
            done, pending, last_ns, since = state["before"]
            recent.before = Before(_rows(done), _rows(pending), int(last_ns), int(since))
        recent.resumed = True
        if recent.last_ns is not None and not isinstance(recent.last_ns, int):
            raise InputError("the newest time of the state is no whole number of nanoseconds.")
        return recent


def _plain(rows: Rows) -> dict:
    """Rows as lists; NaN as None, which JSON has a word for."""

    def listed(values: np.ndarray) -> list:
        return np.where(np.isfinite(values), values, None).tolist()

    empty = not np.isfinite(rows.position_e).any()
    return {
        "time_ns": rows.time_utc.astype(np.int64).tolist(),
        "field_s": listed(rows.field_s),
        "yaw_rad": listed(rows.yaw_rad) if np.isfinite(rows.yaw_rad).any() else [],
        "position_e": [] if empty else listed(rows.position_e),
    }


def _rows(plain: dict) -> Rows:
    """Rows of lists."""
    count = len(plain["time_ns"])
    blank = no_rows(count)
    columns = []
    for name, shape in (("field_s", (count, 3)), ("yaw_rad", (count,)), ("position_e", (count, 3))):
        values = np.array(plain[name], dtype=float) if plain[name] else getattr(blank, name)
        columns.append(values.reshape(shape))
    return Rows(np.array(plain["time_ns"], dtype=np.int64).astype("datetime64[ns]"), *columns)


def _iso(ns) -> str:
    return np.datetime_as_string(np.datetime64(int(ns), "ns"), unit="s") + "Z"
