"""What a command reads: telemetry and orbit, as the options say, with a line of progress for each."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fieldline.cli.progress import Progress
from fieldline.errors import InputError


@dataclass(frozen=True, kw_only=True)
class Source:
    """Options on how telemetry and orbit are read."""

    orbit: Path | None = None
    mapping: Path | None = None
    mag_columns: str | None = None
    time_column: str | None = None
    unit: str | None = None
    repair: bool = False
    eop: Path | None = None
    norad_id: int | None = None
    max_orbit_age_days: float = 30.0


def read_flight(path: Path, source: Source, progress: Progress) -> Any:
    """One file's Telemetry."""
    from fieldline.telemetry import read_telemetry

    progress(f"reading {path.name}", 0, 1)
    telemetry = read_telemetry(
        path,
        mapping=source.mapping,
        mag_columns=three_names(source.mag_columns),
        time_column=source.time_column,
        unit=source.unit,
        repair=source.repair,
    )
    progress(f"reading {path.name}", 1, 1, _span(telemetry))
    return telemetry


def orbit_for(telemetry: Any, source: Source, progress: Progress) -> Any:
    """The orbit of the file that was given, or of the telemetry's own position columns, checked for the telemetry's times."""
    from fieldline.orbit import orbit_from_positions, read_orbit

    eop = earth_orientation(source.eop)
    if source.orbit is not None:
        orbit = read_orbit(source.orbit, norad_id=source.norad_id, eop=eop)
    elif telemetry.position_e is not None:
        orbit = orbit_from_positions(telemetry.time_utc, telemetry.position_e)
    else:
        raise InputError(
            f'"{telemetry.name}" has no position columns that were recognised, so an orbit is needed: '
            "--orbit FILE with a TLE, OMM or OEM of the satellite."
        )
    warnings = orbit.check(telemetry.time_utc, max_age_days=source.max_orbit_age_days)
    progress("orbit", 1, 1, _orbit_words(orbit, telemetry.time_utc))
    for warning in warnings:
        progress(f"warning: {warning}", 1, 1)
    return orbit


def earth_orientation(path: Path | None) -> Any:
    """The file of --eop, read; None without it."""
    if path is None:
        return None
    from fieldline.frames.earth_orientation import read_eop

    return read_eop(path)


def three_names(text: str | None) -> tuple[str, ...] | None:
    """a,b,c as three column names."""
    if text is None:
        return None
    names = tuple(one.strip() for one in text.split(","))
    if len(names) != 3 or not all(names):
        raise InputError(f'--mag-columns needs the three columns x,y,z with commas between them; got "{text}".')
    return names


def _span(telemetry: Any) -> str:
    """5,586 samples, 2023-08-24 14:44:09 to 16:17:28 UTC, 14 missing seconds."""
    start, stop = np.datetime_as_string(telemetry.time_utc[[0, -1]], unit="s")
    until = stop[11:] if stop[:10] == start[:10] else stop.replace("T", " ")
    missing = f", {telemetry.quality.missing_s:.6g} missing seconds" if telemetry.quality.missing_s else ""
    return f"{len(telemetry.time_utc):,} samples, {start.replace('T', ' ')} to {until} UTC{missing}"


def _orbit_words(orbit: Any, time_utc: np.ndarray) -> str:
    """TLE 52191, age 0.2 d."""
    about = orbit.describe(time_utc)
    age = about.get("age_days")  # least and greatest, for element sets alone
    name = about.get("name") or about.get("norad_id") or ""
    if about.get("kind") == "positions":
        return f"positions of the {name}"
    return f"{about.get('kind', 'orbit')} {name}" + (f", age {max(age):.1f} d" if age else "")
