"""Time: UTC at the border as `numpy.datetime64`, seconds from a stated epoch inside, Julian dates for erfa.

    TT = UTC + (leap seconds) + 32.184 s            (through erfa, which carries the table of leap seconds)

UTC differences over a leap second are one second short; telemetry in Unix time has the same gap, and the next leap
second after 2017 has not been announced, so elapsed seconds are taken as UTC differences.
"""

from __future__ import annotations

import warnings

import numpy as np

from fieldline.errors import InputError

UNIX_EPOCH_JD = 2440587.5
NS = np.timedelta64(1, "ns")


def as_utc(time_utc, name: str = "time_utc") -> np.ndarray:
    """datetime64[ns] array of any datetime64, ISO 8601 text or `datetime`; naive values are UTC, offsets are applied."""
    given = np.asarray(time_utc)
    if given.dtype.kind != "M":
        given = _parsed(given, name)
    times = given.astype("datetime64[ns]", copy=False)
    if np.isnat(times).any():
        raise InputError(f"{name} holds {int(np.isnat(times).sum())} missing times (NaT); drop those samples first.")
    if given.dtype != times.dtype and (given.astype("datetime64[s]") != times.astype("datetime64[s]")).any():
        # Nanoseconds in 64 bits end there; NumPy wraps round in silence, and 0001-01-01 would become the year 1754.
        raise InputError(f"{name} holds times outside the years 1678 to 2261, such as {given.min()}. Missing values?")
    return times


def _parsed(given: np.ndarray, name: str) -> np.ndarray:
    """Text or `datetime` objects as datetime64 of the unit that holds them."""
    try:
        if given.dtype.kind in "biufc" and given.size:
            raise TypeError("plain numbers have no epoch")
        with warnings.catch_warnings(action="ignore", category=UserWarning):  # NumPy applies an offset, but warns of it
            return given.astype("datetime64")
    except (ValueError, TypeError) as error:
        shown = str(given.flat[0] if given.ndim else given)
        raise InputError(f"{name} must be UTC as numpy.datetime64 or ISO 8601 text; got {shown!r:.60}.") from error


def seconds_since(time_utc: np.ndarray, epoch_utc: np.datetime64) -> np.ndarray:
    """(n,) [s] from epoch to each time."""
    return (as_utc(time_utc) - np.datetime64(epoch_utc, "ns")).astype(np.int64) * 1e-9


def utc_julian(time_utc) -> tuple[np.ndarray, np.ndarray]:
    """UTC as a two-part Julian date: whole days and the fraction, which together keep nanoseconds."""
    ns = as_utc(time_utc).astype(np.int64)
    day = 86_400_000_000_000
    whole = np.floor_divide(ns, day)
    return UNIX_EPOCH_JD + whole.astype(float), (ns - whole * day) / day


def decimal_year(time_utc) -> np.ndarray:
    """Calendar year with its fraction, as geomagnetic models count: 2023-07-02T12:00 is 2023.5."""
    times = as_utc(time_utc)
    year = times.astype("datetime64[Y]")
    start = year.astype("datetime64[ns]")
    length = (year + 1).astype("datetime64[ns]") - start
    return year.astype(int) + 1970 + (times - start).astype(np.int64) / length.astype(np.int64)


def iso_utc(time_utc, digits: int = 3) -> list[str] | str:
    """ISO 8601 text with a trailing Z; a scalar gives a string."""
    unit = {0: "s", 3: "ms", 6: "us", 9: "ns"}[digits]
    text = np.datetime_as_string(as_utc(time_utc), unit=unit, timezone="UTC")
    return str(text) if np.ndim(text) == 0 else [str(t) for t in text]
