"""The time column: which one it is, how it counts, and its values as UTC.

Known counts: ISO 8601 text, Unix time in s, ms, us or ns, Julian and modified Julian date, GPS and TAI seconds, and
seconds since an epoch that the mapping states. GPS time is TAI - 19 s since 1980-01-06; UTC comes from erfa's table of
leap seconds. Local time is refused: no file says where its clock's summer time began.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, nearest
from fieldline.telemetry.columns import split_unit, words_of
from fieldline.telemetry.table import listed

_PER_SECOND = {"unix_s": 1.0, "unix_ms": 1e3, "unix_us": 1e6, "unix_ns": 1e9}
KINDS = ("iso", *_PER_SECOND, "jd", "mjd", "gps_s", "tai_s")
_WORDS = set(
    "time timestamp timestamps utc unix epoch posix datetime date jd julian mjd modified gps tai ts iso 8601 t clock obc onboard "
    "sc spacecraft sample measurement s sec secs second seconds ms us ns msec usec nsec millis micros nanos milliseconds "
    "microseconds nanoseconds days day d since 1970 stamp gmt z".split()
)
_LOCAL = set(
    "local lt lct lmt lst clt clst cet cest est edt cst cdt mst mdt pst pdt ist jst kst msk bst wet west eet eest aest aedt sgt "
    "brt art hst akst nzst".split()
)
_OFFSET = re.compile(r"(utc|gmt)[\s_]*[+-][\s_]*\d|[+-]\d\d:?\d\d\b", re.I)
_TEXT_OFFSET = re.compile(r"[T ]\d{1,2}:?\d\d.*([+-]\d\d:?(\d\d)?)\s*$")
_DATE = re.compile(r"\s*\d{4}[-/]\d\d?[-/]\d\d?\s*$")
_TIME_OF_DAY = re.compile(r"\s*\d\d?:\d\d(:\d\d(\.\d+)?)?\s*Z?\s*$")
_UNIT_WORDS = {"s": "s", "sec": "s", "secs": "s", "second": "s", "seconds": "s", "ms": "ms", "msec": "ms", "millis": "ms"}
_UNIT_WORDS |= {"milliseconds": "ms", "us": "us", "usec": "us", "micros": "us", "microseconds": "us", "ns": "ns"}
_UNIT_WORDS |= {"nsec": "ns", "nanos": "ns", "nanoseconds": "ns"}
FIRST, LAST = np.datetime64("1957-10-04", "ns"), np.datetime64("2100-01-01", "ns")
_LOCAL_ADVICE = (
    "Attitude needs UTC: convert the column (an hour of error turns the field along the orbit by 240 degrees), "
    "write the offset into each stamp (2023-08-24T11:44:09-03:00), or name another column with --time-column."
)


class TimeColumn(NamedTuple):
    """A column and how it counts; `why` is told to the user; `epoch` for seconds since one; `clock`: the time of day."""

    name: str
    kind: str
    why: str
    epoch: np.datetime64 | None = None
    clock: str = ""

    @property
    def names(self) -> list[str]:
        """The columns to read: one, or a date and its time of day."""
        return [self.name, self.clock] if self.clock else [self.name]


def _is_text(value) -> bool:
    return isinstance(value, str) and not re.fullmatch(r"\s*[-+]?[\d.,]+([eE][-+]?\d+)?\s*", value)


def _number(value) -> float:
    try:
        return float(str(value).replace(",", "."))
    except ValueError:
        return float("nan")


def is_local(name: str) -> bool:
    """Whether a name speaks of local time: local_time, time_CLT, time_UTC-3."""
    words = set(words_of(name))
    return bool(
        (words & _LOCAL and words & (_WORDS | {"local"}) and words <= _WORDS | _LOCAL)
        or (words & _WORDS and _OFFSET.search(name))
    )


def rank(name: str, unit: str, value) -> int | None:
    """How well a column serves as the time (0 best), or None when it is none."""
    base, unit_text = split_unit(name)
    words = set(words_of(base)) | set(words_of(unit_text))
    if isinstance(value, np.datetime64):
        return 0 if "utc" in words else 1
    if not words <= _WORDS or not words - set(_UNIT_WORDS) - {"d", "day", "days"}:
        return None
    for place, some in enumerate(
        ({"utc", "gmt"}, {"unix", "posix"}, {"timestamp", "datetime", "epoch", "iso"}, {"time", "date", "ts"})
    ):
        if words & some:
            return place
    return 5 if words <= {"t", *_UNIT_WORDS} else 4


def find_time(path, names: Sequence[str], units, peek, *, told: bool = False) -> TimeColumn:
    """The best time column of a file and how it counts, or (`told`) of which the user says how it counts."""
    ranked = [(order, name) for name in names if (order := rank(name, units.get(name, ""), peek.get(name))) is not None]
    local = [name for name in names if is_local(name)]
    good = sorted((item for item in ranked if item[1] not in local), key=lambda item: item[0])
    for name in local:
        if not good and isinstance(peek.get(name), str) and _TEXT_OFFSET.search(peek[name]):
            return TimeColumn(name, "iso", "its stamps carry their offset from UTC")
    if not good and local:
        raise InputError(f'"{path}": the time column "{local[0]}" is in local time. {_LOCAL_ADVICE}')
    if not good:
        raise InputError(
            f'"{path}" has no time column that is recognised among: {listed(names)}. '
            "Name it with --time-column, or in a mapping ([columns] time = …); "
            "known names: time_utc, utc, timestamp, unix_s, unix_ms, jd, mjd, gps_s."
        )
    name = good[0][1]
    if told:
        return TimeColumn(name, "", "")
    dates, clocks = ([n for _, n in good if pattern.match(str(peek.get(n, "")))] for pattern in (_DATE, _TIME_OF_DAY))
    if dates and clocks and (name in dates or name in clocks):
        return TimeColumn(dates[0], "iso", f"with the time of day in {clocks[0]}", clock=clocks[0])
    return time_kind(path, name, units.get(name, ""), peek.get(name))


def time_kind(path, name: str, unit: str, value, given: str = "") -> TimeColumn:
    """How a column counts: as the user says, by its type, by its name, or by a size that only one count can have."""
    if given:
        return _given_kind(path, name, given)
    if isinstance(value, np.datetime64):
        return TimeColumn(name, "datetime", "a date column")
    if _is_text(value):
        return TimeColumn(name, "iso", "ISO 8601 text")
    base, unit_text = split_unit(name)
    words = words_of(base) + words_of(unit_text)
    for kind in ("mjd", "jd"):
        if kind in words or ("julian" in words and ("modified" in words) == (kind == "mjd")):
            return TimeColumn(name, kind, "by its name")
    for scale in ("gps", "tai"):
        if scale in words:
            return TimeColumn(name, f"{scale}_s", "by its name")
    named = next((_UNIT_WORDS[word] for word in reversed([*words, *words_of(unit)]) if word in _UNIT_WORDS), "")
    size = abs(_number(value))
    fits = [kind for kind, per_second in _PER_SECOND.items() if 5e8 <= size / per_second <= 4.1e9]
    if fits and (not named or fits[0] == f"unix_{named}"):
        return TimeColumn(name, fits[0], "by its name" if named else f"{size:.10g} can only be Unix time in {fits[0][5:]}")
    if fits:
        raise InputError(
            f'"{path}": the time column "{name}" says {named}, but {size:.10g} looks like Unix time in {fits[0][5:]}. '
            f'State it in a mapping: [units] time = "{fits[0]}".'
        )
    raise InputError(
        f'"{path}": the time column "{name}" begins with {value!s:.30}, which is no date and no Unix time. '
        "If it counts seconds from a start, "
        'state it in a mapping: [units] time = "s since 2023-08-24T14:44:09Z"; other counts: ' + ", ".join(KINDS) + "."
    )


def _given_kind(path, name: str, given: str) -> TimeColumn:
    """The count that a mapping states: a known one, or "s since 2023-08-24T14:44:09Z"."""
    since = re.fullmatch(r"\s*(\w+)\s+since\s+(.+?)\s*", given)
    if since and since.group(1) in _UNIT_WORDS:
        epoch = _iso_times(path, "units.time", np.array([since.group(2)], dtype=object), lambda row: "the mapping")[0]
        return TimeColumn(name, f"since_{_UNIT_WORDS[since.group(1)]}", f"in {given.strip()}, as told", epoch)
    kind = {"unix": "unix_s", "gps": "gps_s", "tai": "tai_s", "utc": "iso"}.get(given.lower(), given.lower())
    if kind not in KINDS:
        raise InputError(f'units.time = "{given}" is not known: {nearest(given, KINDS)}; or "s since 2023-08-24T14:44:09Z".')
    return TimeColumn(name, kind, f"as {kind}, as told")


def to_utc(path, column: TimeColumn, values: np.ndarray, place, repair: bool = False) -> tuple[np.ndarray, list[str]]:
    """(n,) datetime64[ns] of the column's values, NaT where one is missing (or bad, with repair); sentences on what was done."""
    notes: list[str] = []
    if column.kind == "datetime":
        times = values.astype("datetime64[ns]")
    elif column.kind == "iso":
        times = _iso_times(path, column.name, values, place, repair)
        if any(isinstance(value, str) and _TEXT_OFFSET.search(value) for value in values[:1000]):
            notes.append(f"{column.name}: stamps with an offset were converted to UTC")
        elif not any(isinstance(value, str) and value.rstrip().endswith(("Z", "z")) for value in values[:1]):
            notes.append(f"{column.name}: stamps without a zone were read as UTC")
    else:
        times = _counted(column, _as_numbers(path, column.name, values, place, repair))
    return _within_years(path, column, times, values, place, repair), notes


def joined(column: TimeColumn, columns: dict[str, np.ndarray]) -> np.ndarray:
    """The values of the time column, a date joined with its time of day."""
    values = columns[column.name]
    if not column.clock:
        return values
    pairs = zip(values, columns[column.clock], strict=True)
    return np.array([f"{str(date).strip()}T{str(clock).strip()}" for date, clock in pairs], dtype=object)


def _as_numbers(path, name: str, values: np.ndarray, place, repair: bool) -> np.ndarray:
    """Text or numbers as int64 where all are whole (nanoseconds need it), else float64."""
    if values.dtype.kind in "iuf":
        return values
    import pandas as pd

    text = pd.Series(values, dtype="str").str.strip().str.replace(",", ".", regex=False)
    numbers = np.asarray(pd.to_numeric(text.where(text != "", None), errors="coerce"))
    bad = np.flatnonzero(
        ~np.isfinite(numbers.astype(float)) & ~text.str.lower().isin(["", "nan", "na", "null", "none"]).to_numpy()
    )
    if len(bad) and not repair:
        raise InputError(f'"{path}", {place(int(bad[0]))}, column "{name}": "{values[bad[0]]!s:.40}" is not a time.')
    return numbers


def _counted(column: TimeColumn, numbers: np.ndarray) -> np.ndarray:
    """Numbers of a count as UTC: whole part and fraction apart, so that no nanosecond is lost to rounding."""
    unit = column.kind.rpartition("_")[2]
    if column.kind in {"jd", "mjd"}:
        days = numbers - (2440587.5 if column.kind == "jd" else 40587.0)
        return _nanoseconds(days, 86_400_000_000_000)
    scale = {"s": 10**9, "ms": 10**6, "us": 10**3, "ns": 1}[unit]
    times = _nanoseconds(numbers, scale)
    if column.epoch is not None:
        return np.asarray(times.astype("timedelta64[ns]") + column.epoch)
    if column.kind in {"gps_s", "tai_s"}:
        return _from_tai(times, column.kind)
    return times


def _nanoseconds(numbers: np.ndarray, scale: int) -> np.ndarray:
    """Numbers times scale as datetime64[ns] from 1970, NaT where not finite or beyond the range of datetime64."""
    if numbers.dtype.kind in "iu":
        good = np.abs(numbers.astype(float)) * scale < 9e18
        return np.where(good, np.where(good, numbers, 0).astype(np.int64) * scale, np.iinfo(np.int64).min).astype(
            "datetime64[ns]"
        )
    good = np.isfinite(numbers) & (np.abs(np.where(np.isfinite(numbers), numbers, 0.0)) * scale < 9e18)
    safe = np.where(good, numbers, 0.0)
    whole = np.floor(safe)
    ns = whole.astype(np.int64) * scale + np.rint((safe - whole) * scale).astype(np.int64)
    return np.where(good, ns, np.iinfo(np.int64).min).astype("datetime64[ns]")


def _from_tai(times: np.ndarray, kind: str) -> np.ndarray:
    """UTC of TAI or GPS seconds: the leap seconds are looked up twice, as they are tabulated by UTC."""
    tai = times if kind == "tai_s" else times + np.timedelta64(315964800 + 19, "s")
    return np.asarray(tai - _leap(np.asarray(tai - _leap(tai))))


def _leap(utc: np.ndarray) -> np.ndarray:
    """TAI - UTC at each time, looked up per day."""
    import erfa

    days, where = np.unique(utc.astype("datetime64[D]"), return_inverse=True)
    known = ~np.isnat(days)
    leap = np.zeros(len(days), dtype="timedelta64[ns]")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # erfa warns of years after its table: no leap second is announced for them
        for k in np.flatnonzero(known):
            year, month, day = (int(part) for part in str(days[k]).split("-"))
            if 1972 <= year < 2100:
                leap[k] = np.timedelta64(round(float(erfa.dat(year, month, day, 0.0)) * 1e9), "ns")
    return leap[where]


def _iso_times(path, name: str, values: np.ndarray, place, repair: bool = False) -> np.ndarray:
    """ISO 8601 text as UTC; a stamp that is none is named."""
    import pandas as pd

    text = pd.Series(values, dtype="str").str.strip()
    missing = text.isna() | text.str.lower().isin(["", "nan", "nat", "null", "none", "na"])
    text = text.mask(missing, None)
    if len(text) and not missing.iloc[0] and re.match(r"\d{4}/\d", str(text.iloc[0])):
        text = text.str.replace("/", "-", regex=False)
    day_of_year = len(text) > 0 and re.match(r"\d{4}-\d{3}[T ]", str(text.iloc[0])) is not None
    form = "%Y-%jT%H:%M:%S.%f" if day_of_year else "ISO8601"
    if day_of_year:
        text = text.str.rstrip("Zz").str.replace(" ", "T", regex=False)
        text = text.where(text.str.contains(".", regex=False), text + ".0")
    times = pd.to_datetime(text, format=form, utc=True, errors="coerce")
    bad = np.flatnonzero(times.isna().to_numpy() & ~missing.to_numpy())
    if len(bad) and not repair:
        raise InputError(
            f'"{path}", {place(int(bad[0]))}, column "{name}": "{values[bad[0]]!s:.40}" is no ISO 8601 time '
            "(2023-08-24T14:44:09.5Z). Dates with the day or month first cannot be told apart; write the year first."
        )
    return times.dt.tz_localize(None).to_numpy().astype("datetime64[ns]")


def _within_years(path, column: TimeColumn, times: np.ndarray, values: np.ndarray, place, repair: bool) -> np.ndarray:
    """The times, without those that no satellite has seen: refused, or (repair, and fewer than one in ten) made NaT."""
    known = ~np.isnat(times)
    if not known.any():
        raise InputError(f'"{path}": no row of the time column "{column.name}" is a time within the years 1957 to 2100.')
    odd = known & ((times < FIRST) | (times > LAST))
    if odd.any() and (not repair or odd.mean() > 0.1):
        row = int(np.argmax(odd))
        raise InputError(
            f'"{path}", {place(row)}: the time column "{column.name}", read as {column.kind}, gives {str(times[row])[:19]} '
            f"from {values[row]!s:.30}, outside 1957 to 2100. If it counts otherwise, state it in a mapping: "
            '[units] time = "unix_ms", "gps_s", …'
        )
    return np.where(odd, np.datetime64("NaT", "ns"), times)
