"""`read_orbit`: which format a file has is told by its content, never by its name."""

from __future__ import annotations

from pathlib import Path

from fieldline.errors import InputError
from fieldline.frames.earth_orientation import EarthOrientation
from fieldline.orbit.element_orbit import ElementOrbit
from fieldline.orbit.element_set import ElementSet
from fieldline.orbit.orbit import Orbit
from fieldline.orbit.tle import parse_tle

EXPECTED = "Expected a TLE, an OMM (JSON, XML, KVN, CSV) or an OEM (KVN)."


def read_orbit(path: str | Path, *, norad_id: int | None = None, eop: EarthOrientation | None = None) -> Orbit:
    """The orbit that a file holds: TLE, OMM (JSON, XML, KVN, CSV) or OEM (KVN), told apart by content.

    Parameters
    ----------
    path : the file; any name.
    norad_id : which satellite, where the file holds several.
    eop : measured Earth orientation for the Earth-fixed axes (`read_eop`); UT1 = UTC without it.

    Errors: InputError for a file that is missing, empty, of another kind, damaged, or of several satellites.
    """
    text, source = read_text(path), Path(path).name
    return _element_orbit("TLE", parse_tle(text, source), source, norad_id, eop)


def read_text(path: str | Path) -> str:
    """A text file's content, UTF-8 with or without its mark."""
    return Path(path).read_bytes().decode("utf-8-sig")


def _element_orbit(kind: str, sets: list[ElementSet], source: str, norad_id: int | None, eop) -> ElementOrbit:
    """One satellite's sets, ordered by epoch; of sets with the same epoch the file's last one stays."""
    ids = sorted({s.norad_id for s in sets})
    if norad_id is not None and norad_id not in ids:
        raise InputError(f'"{source}" holds NORAD {_listing(ids)}, not {norad_id}.')
    if norad_id is None and len(ids) > 1:
        raise InputError(f'"{source}" holds {len(ids)} satellites, NORAD {_listing(ids)}: choose one with --norad-id (norad_id).')
    chosen = ids[0] if norad_id is None else norad_id
    mine = {s.epoch_utc: s for s in sets if s.norad_id == chosen}
    ordered = tuple(mine[epoch] for epoch in sorted(mine))
    name = next((s.name for s in reversed(ordered) if s.name), "") or f"NORAD {chosen}"
    return ElementOrbit(name=name, kind=kind, norad_id=chosen, eop=eop, sets=ordered)


def _listing(ids: list[int]) -> str:
    """The first few numbers of a list."""
    return ", ".join(map(str, ids[:8])) + (f" and {len(ids) - 8} more" if len(ids) > 8 else "")
