"""Measured Earth orientation: UT1 - UTC and the pole, from the files of the IERS.

    UT1 - UTC = (UT1 - TAI)(t) + leap seconds(t)                                        (1)

UT1 - TAI is interpolated linearly between the daily values, since it has no steps: the error of a straight line is
under 0.1 ms (5 cm at the equator); the pole is interpolated likewise. Sub-daily tides are left out: 0.1 ms and 1 mas.

Files: `finals2000A` (all, daily, data; fixed columns) and the C04 series (14 and 20; columns by blanks).
Source: IERS readme.finals2000A; IERS C04 headers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fieldline.errors import InputError
from fieldline.frames.time import as_utc, iso_utc

ARCSECOND_RAD = np.pi / 648000.0
MJD_UNIX_EPOCH = 40587.0
NS_PER_DAY = 86_400_000_000_000


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
