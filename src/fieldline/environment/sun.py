"""Where the Sun is.

    r_sun = - r_earth (heliocentric, IAU SOFA's epv00)                                                      (1)
    r(t) = Hermite cubic through positions and velocities at whole days of TT                               (2)

Geometric, axes of the GCRS. Aberration and the light's eight minutes together turn the direction by 0.0057 deg and are
left out; epv00 itself is good to 1e-5 deg over 1900 to 2100, and (2) departs from it by less than 1e-9 rad. Seen from
a low orbit instead of the Earth's centre the Sun stands up to 0.0027 deg elsewhere. Together: good to 0.01 deg.

Source: IAU SOFA, epv00 (after VSOP2000), through erfa; IAU 2012 B2 for the astronomical unit.
"""

from __future__ import annotations

import numpy as np

from fieldline.constants import ASTRONOMICAL_UNIT_M, SECONDS_PER_DAY
from fieldline.errors import InputError
from fieldline.frames.time import as_utc, decimal_year, utc_julian

TT_MINUS_TAI_S = 32.184
FIRST_YEAR, LAST_YEAR = 1900.0, 2100.0


def sun_position_i(time_utc) -> np.ndarray:
    """The Sun's centre from the Earth's, (..., 3) [m], GCRS axes, equations (1) and (2).

    Parameters
    ----------
    time_utc : (...) datetime64, 1900 to 2100.

    Raises
    ------
    InputError : a time outside these years.
    """
    times = as_utc(time_utc)
    years = decimal_year(times)
    if years.size and (years.min() < FIRST_YEAR or years.max() >= LAST_YEAR):
        raise InputError(
            f"time_utc holds years {years.min():.1f} to {years.max():.1f}; the Sun's ephemeris covers 1900 to 2100. "
            "Is the epoch of the time column right?"
        )
    whole, part = utc_julian(times.ravel())
    part = part + _tt_minus_utc_s(times.ravel()) / SECONDS_PER_DAY
    carry = np.floor(part)
    position = _between_days(whole + carry, part - carry)
    return position.reshape((*times.shape, 3)) * ASTRONOMICAL_UNIT_M


def sun_direction_i(time_utc) -> np.ndarray:
    """Unit vectors from the Earth's centre to the Sun's, (..., 3), GCRS axes; to 0.01 deg from any low orbit.

    time_utc : (...) datetime64, 1900 to 2100; InputError outside.
    """
    position = sun_position_i(time_utc)
    return position / np.linalg.norm(position, axis=-1, keepdims=True)


def _between_days(day: np.ndarray, part: np.ndarray) -> np.ndarray:
    """(n, 3) [au]: Hermite cubic (2) between whole Julian days of TT, so that a long series costs one call a day."""
    days, index = np.unique(day, return_inverse=True)
    start, start_rate = _sun_au(days)
    end, end_rate = _sun_au(days + 1.0)
    s = part[:, None]
    return (
        (1.0 + 2.0 * s) * (1.0 - s) ** 2 * start[index]
        + s * (1.0 - s) ** 2 * start_rate[index]
        + s * s * (3.0 - 2.0 * s) * end[index]
        - s * s * (1.0 - s) * end_rate[index]
    )


def _sun_au(days: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Position [au] and velocity [au/day] of the Sun from the Earth (1), at Julian days of TT."""
    import erfa

    heliocentric, _ = erfa.epv00(days, 0.0)
    return -heliocentric["p"], -heliocentric["v"]


def _tt_minus_utc_s(times: np.ndarray) -> np.ndarray:
    """(n,) [s]; before 1972 the first step of UTC is taken, which is within a minute (7e-4 deg of the Sun)."""
    import erfa

    steps = erfa.leap_seconds.get()
    months = (12 * (steps["year"].astype(int) - 1970) + steps["month"] - 1).astype("datetime64[M]")
    after_1972 = steps["year"] >= 1972
    starts = months[after_1972].astype("datetime64[ns]")
    index = np.searchsorted(starts, times, side="right") - 1
    return steps["tai_utc"][after_1972][np.maximum(index, 0)] + TT_MINUS_TAI_S
