"""`read_orbit`: which format a file has is told by its content, never by its name."""

from __future__ import annotations

import re
from pathlib import Path

from fieldline.errors import InputError, shown
from fieldline.files import read_text
from fieldline.frames.earth_orientation import EarthOrientation
from fieldline.orbit.element_orbit import ElementOrbit
from fieldline.orbit.element_set import ElementSet
from fieldline.orbit.oem import parse_oem
from fieldline.orbit.omm import parse_omm_csv, parse_omm_json, parse_omm_kvn, parse_omm_xml
from fieldline.orbit.orbit import Orbit
from fieldline.orbit.tle import is_element_line, parse_tle

EXPECTED = "Expected a TLE, an OMM (JSON, XML, KVN or CSV) or an OEM (KVN)."
ELEMENT_PARSERS = {
    "TLE": parse_tle,
    "OMM JSON": parse_omm_json,
    "OMM XML": parse_omm_xml,
    "OMM KVN": parse_omm_kvn,
    "OMM CSV": parse_omm_csv,
}


def read_orbit(path: str | Path, *, norad_id: int | None = None, eop: EarthOrientation | None = None) -> Orbit:
    """The orbit that a file holds: TLE, OMM (JSON, XML, KVN, CSV) or OEM (KVN), told apart by content.

    Parameters
    ----------
    path : the file; any name.
    norad_id : which satellite, where the file holds several.
    eop : measured Earth orientation for the Earth-fixed axes (`read_eop`); UT1 = UTC without it.

    Returns
    -------
    `Orbit`: state_i(time_utc) gives position (n, 3) [m] and velocity (n, 3) [m/s] in GCRS, position_e(time_utc) in ITRS.

    Errors: InputError for a file that is missing, empty, of another kind, damaged, or of several satellites.
    """
    text, source = read_text(path, "orbit file"), Path(path).name
    kind = orbit_kind(text, source)
    if kind == "OEM":
        if norad_id is not None:
            raise InputError(
                f'"{source}" is an OEM, which is not chosen from by catalogue number: leave --norad-id (norad_id) out.'
            )
        return parse_oem(text, source, eop)
    return _element_orbit(kind, ELEMENT_PARSERS[kind](text, source), source, norad_id, eop)


def orbit_kind(text: str, source: str) -> str:
    """Which of the known formats a text is in; InputError with what it looks like instead."""
    body = text.lstrip()
    opening = body[:4096].lower()
    if body.startswith("<"):
        return _xml_kind(opening, source)
    message = re.search(r"^\s*CCSDS_(\w+)_VERS\s*=", body, re.MULTILINE)
    if message:
        if message[1] in ("OMM", "OEM"):
            return "OEM" if message[1] == "OEM" else "OMM KVN"
        raise InputError(f'"{source}" is a CCSDS {shown(message[1])}. {EXPECTED}')
    lines = body.splitlines()
    if any(is_element_line(line.strip().replace("\t", " ")) for line in lines):
        return "TLE"
    if body.startswith(("{", "[")):
        return "OMM JSON"
    if "," in lines[0] and {"EPOCH", "MEAN_MOTION"} <= {word.strip().upper() for word in lines[0].split(",")}:
        return "OMM CSV"
    raise InputError(f'"{source}" holds no orbit: its first line is "{shown(lines[0], 60)}". {EXPECTED}{_guess(lines)}')


def _xml_kind(opening: str, source: str) -> str:
    """OMM, or what the tags say instead."""
    if re.search(r"<(\w+:)?(omm|ndm)\b", opening):
        return "OMM XML"
    if "<html" in opening or "<!doctype html" in opening:
        raise InputError(f'"{source}" is a web page, not an orbit: the download gave a page instead of the data. Fetch it again.')
    if re.search(r"<(\w+:)?oem\b", opening):
        raise InputError(f'"{source}" is an OEM in XML; only its text form (KVN) is read. Convert it, or use a TLE.')
    raise InputError(f'"{source}" is XML without an <omm> in it. {EXPECTED}')


def _guess(lines: list[str]) -> str:
    """What a file that is no orbit may be."""
    if any(line.strip()[:2] in ("1 ", "2 ") for line in lines):
        return " A line begins as a TLE's does and is too short: was the file cut?"
    if "," in lines[0] or ";" in lines[0]:
        return " It looks like a table: were telemetry and orbit given in each other's place?"
    return ""


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
