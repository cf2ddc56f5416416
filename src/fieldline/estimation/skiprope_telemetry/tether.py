"""What is known of the tether besides its length: how the length changes, the masses, the satellite's swing upon it.

A satellite that swings at f_s on its tether leans further than the tether's end at f, and its deflection is corrected by

    d = a L / pi / g,   g = 1 / (1 - (f / f_s)^2)                                                               (1)

Lengths come from a table of text with a header: a column `time_utc` and one of `length_m`, `tether_length_m`, `length_km`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fieldline.errors import InputError, shown
from fieldline.estimation.skiprope.reeled import in_metres
from fieldline.estimation.skiprope.rotary import LEAST_TURNING
from fieldline.estimation.skiprope.solution import SkipropeEstimate

COLUMNS = {"length_m": 1.0, "tether_length_m": 1.0, "length_km": 1e3, "tether_length_km": 1e3}
MOST_BEYOND_S = 60.0  # of a table of lengths that ends before the telemetry does
NEAREST_SWING = 2.0  # of a swing's frequency over the skiprope's: nearer ones are no correction


@dataclass(frozen=True, eq=False)
class TetherLengths:
    """Lengths [m] (k,) at rising times UTC (k,), straight between them and constant outside."""

    time_utc: np.ndarray
    length_m: np.ndarray

    def __post_init__(self):
        times, length = np.asarray(self.time_utc, dtype="datetime64[ns]"), np.asarray(self.length_m, dtype=float)
        object.__setattr__(self, "time_utc", times)
        object.__setattr__(self, "length_m", length)
        if times.ndim != 1 or times.shape != length.shape or len(times) < 2:
            raise InputError(f"tether lengths need two times or more, one length each; got {times.shape} and {length.shape}.")
        if not (np.diff(times.astype(np.int64)) > 0).all() or np.isnat(times).any():
            raise InputError("the times of the tether's lengths must rise from row to row; sort them and drop repeats.")
        if not (np.isfinite(length).all() and (length >= 1.0).all() and (length <= 1e6).all()):
            raise InputError(f"the tether's lengths must be from 1 to 1e6 m; got {length.min():g} to {length.max():g}.")

    def at(self, time_utc) -> np.ndarray:
        """[m] at times (n,)."""
        since = (np.asarray(time_utc, dtype="datetime64[ns]") - self.time_utc[0]).astype(np.int64)
        return np.interp(since, (self.time_utc - self.time_utc[0]).astype(np.int64), self.length_m)

    def of_record(self, time_utc) -> None:
        """InputError where no row of a record at times (n,) lies within the table."""
        times = np.asarray(time_utc, dtype="datetime64[ns]")
        if times[-1] < self.time_utc[0] or times[0] > self.time_utc[-1]:
            own, rows = (np.datetime_as_string(x[[0, -1]], unit="s") for x in (self.time_utc, times))
            raise InputError(
                f"the table of the tether's lengths, {own[0]}Z to {own[1]}Z, and the telemetry, {rows[0]}Z to {rows[1]}Z, have "
                "no time in common: give the lengths of this flight, or --tether-length-m alone."
            )

    def beyond(self, time_utc) -> tuple[str, ...]:
        """A remark where rows at times (n,) lie outside the table, whose first and last length are held there."""
        times = np.asarray(time_utc, dtype="datetime64[ns]")
        early = int((self.time_utc[0] - times[0]).astype(np.int64)) * 1e-9
        late = int((times[-1] - self.time_utc[-1]).astype(np.int64)) * 1e-9
        words = []
        if early > MOST_BEYOND_S:
            words.append(f"begins {early:.0f} s after the first row")
        if late > MOST_BEYOND_S:
            words.append(f"ends {late:.0f} s before the last row")
        if not words:
            return ()
        return (f"The tether may have moved unseen: the table of its lengths {' and '.join(words)}; lengths are held there.",)

    def described(self) -> dict:
        """For the record, plain types."""
        words = np.datetime_as_string(self.time_utc[[0, -1]], unit="s")
        return {
            "rows": len(self.length_m), "from_utc": f"{words[0]}Z", "to_utc": f"{words[1]}Z",
            "from_m": float(self.length_m[0]), "to_m": float(self.length_m[-1]), "mean_m": float(self.length_m.mean()),
        }  # fmt: skip


def read_tether_lengths(path) -> TetherLengths:
    """A table of lengths; it may be the telemetry itself. InputError where there is none in it."""
    import pandas as pd

    file = Path(path)
    if not file.is_file():
        raise InputError(f'the tether\'s lengths "{shown(str(path))}": there is no such file.')
    try:
        table = pd.read_csv(file, comment="#", skipinitialspace=True)
    except (ValueError, UnicodeDecodeError) as error:
        raise InputError(f'"{file.name}" is no table of text: {error}') from None
    names = {str(name).strip().lower(): name for name in table.columns}
    lengths = [name for name in COLUMNS if name in names]
    if "time_utc" not in names or not lengths:
        raise InputError(
            f'"{file.name}" needs a column time_utc and one of {", ".join(COLUMNS)}; it has {shown(", ".join(names), 200)}.'
        )
    times = pd.to_datetime(table[names["time_utc"]], utc=True, errors="coerce", format="ISO8601")
    values = np.asarray(pd.to_numeric(table[names[lengths[0]]], errors="coerce"), dtype=float) * COLUMNS[lengths[0]]
    good = times.notna().to_numpy() & np.isfinite(values)
    if good.sum() < 2:
        raise InputError(f'"{file.name}": {int(good.sum())} rows hold a time (UTC, ISO 8601) and a length; two are needed.')
    return TetherLengths(times[good].dt.tz_localize(None).to_numpy(dtype="datetime64[ns]"), values[good])


def swing_taken_off(estimate: SkipropeEstimate, swing) -> tuple[SkipropeEstimate, tuple[str, ...]]:
    """The estimate with its deflections corrected by (1), and what to say of it.

    swing : [Hz], or "found": the strongest motion that swings in the spectrum, above twice the skiprope's frequency.
    """
    if swing is None or not estimate.detected or not len(estimate.seconds):
        return estimate, ()
    fastest = float(estimate.frequency_hz.max())
    if swing == "found":
        above = [
            one
            for one in estimate.detection.others
            if one.frequency_hz > NEAREST_SWING * fastest and abs(one.turning) < LEAST_TURNING
        ]
        if not above:
            return estimate, ("No swing of the satellite was found in the spectrum: deflections are not corrected for it.",)
        swing = max(above, key=lambda one: one.amplitude_rad).frequency_hz
    if swing < NEAREST_SWING * fastest:
        raise InputError(
            f"the satellite's swing at {1e3 * swing:.3g} mHz is below twice the skiprope's frequency, {1e3 * fastest:.3g} mHz: "
            "its lean is no measure of the tether's then. Check --swing-hz."
        )
    less = 1.0 - (estimate.frequency_hz / swing) ** 2  # (1)
    words = (
        f"The satellite swings at {1e3 * swing:.3g} mHz and leans {100.0 * (1.0 / float(np.median(less)) - 1.0):.2g} % further "
        "than its tether: taken off the deflection, not off the amplitude."
    )
    return replace(estimate, **in_metres(estimate, less)), (words,)
