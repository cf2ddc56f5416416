"""What the CCSDS text formats share: lines of KEY = VALUE, epochs, and time systems.

    UTC = TAI - leap seconds,   TAI = TT - 32.184 s = GPS + 19 s                        (1)

TDB stands for TT: they differ by 2 ms at most, 15 m along a low orbit. Source: CCSDS 502.0-B-3, s. 7.5.
"""

from __future__ import annotations

import re

import numpy as np

from fieldline.errors import InputError, shown
from fieldline.frames.earth_orientation import MJD_UNIX_EPOCH, NS_PER_DAY, leap_seconds

CALENDAR = re.compile(r"(\d{4})-(\d{2})-(\d{2})[T ](\d{2}:\d{2}:\d{2}(?:\.\d*)?)Z?")
DAY_OF_YEAR = re.compile(r"(\d{4})-(\d{3})[T ](\d{2}:\d{2}:\d{2}(?:\.\d*)?)Z?")
SECONDS_BEHIND_TAI = {"UTC": None, "TAI": 0.0, "GPS": 19.0, "TT": -32.184, "TDB": -32.184}
YEARS = (1957, 2200)


def key_value(line: str, where: str) -> tuple[str, str]:
    """Key and value of one line."""
    key, equals, value = line.partition("=")
    if not equals:
        raise InputError(f'{where} should read KEY = VALUE, it reads "{shown(line)}".')
    return key.strip().upper(), value.strip()


def parse_epoch(text: str, where: str) -> np.datetime64:
    """An epoch as 2023-08-24T10:40:13.779 or 2023-236T10:40:13.779, to 1 ns."""
    text = text.strip()
    calendar, ordinal = CALENDAR.fullmatch(text), DAY_OF_YEAR.fullmatch(text)
    try:
        if calendar and text.isascii():
            day, clock = np.datetime64(f"{calendar[1]}-{calendar[2]}-{calendar[3]}", "ns"), calendar[4]
        elif ordinal and text.isascii() and 1 <= int(ordinal[2]) <= 366:
            start = np.datetime64(f"{ordinal[1]}-01-01", "D")
            day, clock = (start + (int(ordinal[2]) - 1)).astype("datetime64[ns]"), ordinal[3]
        else:
            raise ValueError("it is neither year-month-day nor year-day of year")
        if not YEARS[0] <= int(text[:4]) <= YEARS[1]:
            raise ValueError(f"its year lies outside {YEARS[0]} to {YEARS[1]}")
        return day + _time_of_day(clock)
    except ValueError as error:
        raise InputError(f'{where} reads "{shown(text)}", no time as 2023-08-24T10:40:13.779: {error}.') from None


def _time_of_day(clock: str) -> np.timedelta64:
    """Hours, minutes and seconds with any number of decimals."""
    hours, minutes, seconds = clock.split(":")
    whole, _, decimals = seconds.partition(".")
    if int(hours) > 23 or int(minutes) > 59 or int(whole) > 59:
        raise ValueError("hours, minutes or seconds are over their range (leap seconds cannot be carried)")
    ns = ((int(hours) * 60 + int(minutes)) * 60 + int(whole)) * 10**9 + int((decimals + "0" * 9)[:9])
    return np.timedelta64(ns, "ns")


def utc_from(times: np.ndarray, time_system: str, where: str) -> np.ndarray:
    """(n,) datetime64[ns] UTC of times in another system, equation (1)."""
    system = time_system.upper()
    if system not in SECONDS_BEHIND_TAI:
        raise InputError(f"{where}: TIME_SYSTEM is {shown(time_system)}; known: {', '.join(SECONDS_BEHIND_TAI)}.")
    behind = SECONDS_BEHIND_TAI[system]
    if behind is None:
        return times
    tai = times + np.timedelta64(round(behind * 1e9), "ns")
    utc = tai
    for _ in range(2):  # the leap seconds count in UTC, which differs from TAI by half a minute
        leaps = leap_seconds(utc.astype(np.int64) / NS_PER_DAY + MJD_UNIX_EPOCH)
        utc = tai - (leaps * 1e9).astype("timedelta64[ns]")
    return utc
