"""Measured Earth orientation: UT1 - UTC and the pole, from the files of the IERS.

    UT1 - UTC = (UT1 - TAI)(t) + leap seconds(t)                                        (1)

UT1 - TAI is interpolated linearly between the daily values, since it has no steps: the error of a straight line is
under 0.25 ms (12 cm at the equator); the pole is interpolated likewise. Sub-daily tides are left out: 0.1 ms and 1 mas.

Files: `finals2000A` (all, daily, data; fixed columns) and the C04 series (14 and 20; columns by blanks).
Source: IERS readme.finals2000A; IERS C04 headers.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fieldline.errors import InputError, shown
from fieldline.files import read_text
from fieldline.frames.time import as_utc, iso_utc

ARCSECOND_RAD = np.pi / 648000.0
MJD_UNIX_EPOCH = 40587.0
NS_PER_DAY = 86_400_000_000_000
FINALS_LINE = re.compile(r"[ \d]\d[ \d]\d[ \d]\d \d{5}\.\d\d ", re.ASCII)  # two digits each of year, month, day; MJD
C04_LINE = re.compile(r"\s*(19|20)\d\d\s+\d{1,2}\s+\d{1,2}\s+\d+(\.\d*)?\s", re.ASCII)


@dataclass(frozen=True, eq=False)
class EarthOrientation:
    """Daily UT1 - TAI [s] and pole x, y [arcseconds] at increasing UTC days `mjd`."""

    name: str
    mjd: np.ndarray
    ut1_minus_tai_s: np.ndarray
    pole_x_arcsec: np.ndarray
    pole_y_arcsec: np.ndarray

    def ut1_minus_utc_s(self, time_utc) -> np.ndarray:
        """UT1 - UTC [s] at (...) times, equation (1)."""
        mjd = self._covered(time_utc)
        return np.interp(mjd, self.mjd, self.ut1_minus_tai_s) + leap_seconds(mjd)

    def pole_rad(self, time_utc) -> tuple[np.ndarray, np.ndarray]:
        """Pole x and y [rad] at (...) times."""
        mjd = self._covered(time_utc)
        x, y = (np.interp(mjd, self.mjd, axis) for axis in (self.pole_x_arcsec, self.pole_y_arcsec))
        return x * ARCSECOND_RAD, y * ARCSECOND_RAD

    def _covered(self, time_utc) -> np.ndarray:
        """Modified Julian dates of the times, refused outside the file's days."""
        times = as_utc(time_utc)
        mjd = times.astype(np.int64) / NS_PER_DAY + MJD_UNIX_EPOCH
        if mjd.size and (mjd.min() < self.mjd[0] or mjd.max() > self.mjd[-1]):
            raise InputError(
                f'the Earth orientation file "{self.name}" covers {day_of(self.mjd[0])} to {day_of(self.mjd[-1])}; the samples '
                f"run from {iso_utc(times.min(), 0)} to {iso_utc(times.max(), 0)}. Get a newer file, or leave it out (UT1 = UTC)."
            )
        return mjd


def read_eop(path: str | Path) -> EarthOrientation:
    """Earth orientation from a file of the IERS: finals2000A or C04, told apart by content; InputError for others."""
    text, name = read_text(path, "Earth orientation file"), Path(path).name
    lines = [(number, line) for number, line in enumerate(text.splitlines(), start=1) if line.strip()]
    fixed = [row for row in lines if FINALS_LINE.match(row[1])]
    free = [row for row in lines if C04_LINE.match(row[1])]
    parse, rows = (_finals_row, fixed) if len(fixed) > len(free) else (_c04_row, free)
    table = np.array([values for number, line in rows if (values := parse(line, f'"{name}" line {number}'))])
    if len(table) < 2:
        raise InputError(
            f'"{name}" holds no Earth orientation: {len(table)} days were found, two at least are needed. Expected finals2000A '
            "(fixed columns) or a C04 series of the IERS."
        )
    mjd, pole_x, pole_y, ut1_minus_utc = table.T
    late = np.flatnonzero(np.diff(mjd) <= 0.0)
    if late.size:
        raise InputError(f'"{name}": the day {day_of(mjd[late[0] + 1])} comes after {day_of(mjd[late[0]])}; days must increase.')
    return EarthOrientation(name, mjd, ut1_minus_utc - leap_seconds(mjd), pole_x, pole_y)


def _finals_row(line: str, where: str) -> tuple[float, ...] | None:
    """MJD, pole x, y and UT1-UTC of a line of finals2000A; None for the empty days at its end."""
    fields = line[7:15], line[18:27], line[37:46], line[58:68]
    return _row(fields, where) if all(field.strip() for field in fields) else None


def _c04_row(line: str, where: str) -> tuple[float, ...]:
    """MJD, pole x, y and UT1-UTC of a line of C04, of 2020 (with an hour before the MJD) or before."""
    words = line.split()
    start = 3 if float(words[3]) > 1000.0 else 4
    return _row(words[start : start + 4], where)


def _row(fields, where: str) -> tuple[float, ...]:
    """Four numbers that can be a day's orientation."""
    try:
        mjd, pole_x, pole_y, ut1_minus_utc = (float(field) for field in fields)
    except ValueError:
        words = shown(" ".join(fields), 60)
        raise InputError(f'{where}: MJD, pole x, pole y and UT1-UTC read "{words}", not four numbers.') from None
    if not (30000.0 < mjd < 90000.0 and abs(pole_x) < 2.0 and abs(pole_y) < 2.0 and abs(ut1_minus_utc) < 1.0):
        raise InputError(
            f"{where}: MJD {mjd:g}, pole {pole_x:g}, {pole_y:g} arcseconds and UT1-UTC {ut1_minus_utc:g} s cannot be a day's "
            "orientation; expected under 2 arcseconds and 1 s. Have columns shifted?"
        )
    return mjd, pole_x, pole_y, ut1_minus_utc


def leap_seconds(mjd) -> np.ndarray:
    """TAI - UTC [s] at modified Julian dates, from 1972 on whole seconds."""
    import erfa

    table = erfa.leap_seconds.get()
    table = table[table["year"] >= 1972]
    starts = np.array([_mjd(f"{entry['year']:04d}-{entry['month']:02d}-01") for entry in table])
    row = np.maximum(np.searchsorted(starts, np.asarray(mjd, dtype=float), side="right") - 1, 0)
    return table["tai_utc"][row].astype(float)


def day_of(mjd: float) -> str:
    """A modified Julian date as a calendar day."""
    return str(np.datetime64("1970-01-01") + np.timedelta64(int(mjd - MJD_UNIX_EPOCH), "D"))


def _mjd(day: str) -> float:
    """The modified Julian date at the beginning of a calendar day."""
    return (np.datetime64(day) - np.datetime64("1970-01-01")).astype(int) + MJD_UNIX_EPOCH
