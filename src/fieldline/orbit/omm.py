"""Orbit mean-elements messages (CCSDS 502.0) in JSON, XML, KVN and CSV, one or many in a file.

The keys are the standard's own (EPOCH, MEAN_MOTION, ECCENTRICITY, ...; CelesTrak and Space-Track write the same), and
only what SGP4 can carry is taken: TEME axes, UTC, the centre of the Earth, theory SGP4 (SGP4-XP is refused).

Source: CCSDS 502.0-B-3, s. 4; CelesTrak, A New Way to Obtain GP Data.
"""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterator

from fieldline.errors import InputError, shown
from fieldline.orbit.ccsds import key_value, parse_epoch
from fieldline.orbit.element_set import SGP4_XP, ElementSet

REQUIRED = {
    "INCLINATION": "inclination_deg",
    "RA_OF_ASC_NODE": "node_deg",
    "ECCENTRICITY": "eccentricity",
    "ARG_OF_PERICENTER": "perigee_deg",
    "MEAN_ANOMALY": "anomaly_deg",
    "MEAN_MOTION": "motion_rev_day",
    "BSTAR": "drag_per_radius",
}
OPTIONAL = {"MEAN_MOTION_DOT": "half_motion_rate_rev_day2", "MEAN_MOTION_DDOT": "sixth_motion_curvature_rev_day3"}
MUST_BE = {"CENTER_NAME": {"EARTH"}, "REF_FRAME": {"TEME"}, "TIME_SYSTEM": {"UTC"}, "MEAN_ELEMENT_THEORY": {"SGP4", "SGP/SGP4"}}


def parse_omm_json(text: str, source: str) -> list[ElementSet]:
    """One object or an array of objects, values as numbers or text."""
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(f'"{source}" begins like JSON and is not: {shown(str(error), 80)}. Was the file cut?') from None
    records = content if isinstance(content, list) else [content]
    if not records or not all(isinstance(record, dict) for record in records):
        raise InputError(f'"{source}" is JSON, but no OMM object or array of them; expected keys as EPOCH and MEAN_MOTION.')
    return [_element_set(record, f'"{source}" message {k}') for k, record in enumerate(records, start=1)]


def parse_omm_xml(text: str, source: str) -> list[ElementSet]:
    """Each <omm> of the file, alone or inside an <ndm>."""
    from xml.etree import ElementTree

    if re.search(r"<!(DOCTYPE|ENTITY)", text, re.IGNORECASE):
        raise InputError(f'"{source}" is XML with a document type of its own; an OMM has none, and it is not read.')
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise InputError(f'"{source}" begins like XML and is not: {shown(str(error), 80)}. Was the file cut?') from None
    sets = []
    for message in (element for element in root.iter() if _plain(element.tag) == "omm"):
        fields = {_plain(leaf.tag): (leaf.text or "") for leaf in message.iter() if not len(leaf)}
        sets.append(_element_set(fields, f'"{source}" message {len(sets) + 1}'))
    return sets or _refuse_empty(source, "XML without an <omm> element")


def parse_omm_kvn(text: str, source: str) -> list[ElementSet]:
    """Each message from CCSDS_OMM_VERS to the next."""
    messages: list[dict[str, str]] = []
    for number, line in enumerate(text.splitlines(), start=1):
        if not line.strip() or line.split()[0] in ("COMMENT", "META_START", "META_STOP"):
            continue
        key, value = key_value(line, f'"{source}" line {number}')
        if key == "CCSDS_OMM_VERS":
            messages.append({})
        elif messages:
            messages[-1][key] = value
    return [_element_set(fields, f'"{source}" message {k}') for k, fields in enumerate(messages, start=1)]


def parse_omm_csv(text: str, source: str) -> list[ElementSet]:
    """CelesTrak's table: a header of OMM keys, a message in each row."""
    try:
        rows = list(csv.DictReader(io.StringIO(text), strict=True))
    except csv.Error as error:
        raise InputError(f'"{source}" is no whole table: {shown(str(error), 80)}.') from None
    sets = [_element_set(row, f'"{source}" row {k}') for k, row in enumerate(rows, start=1)]
    return sets or _refuse_empty(source, "a header of OMM keys without a row")


def _element_set(fields: dict, where: str) -> ElementSet:
    """The elements of one message's keys."""
    fields = dict(_clean(fields))
    _refuse_other_theories(fields, where)
    values = {name: _number(fields, key, where) for key, name in REQUIRED.items()}
    values |= {name: _number(fields, key, where) for key, name in OPTIONAL.items() if key in fields}
    number = _number(fields, "NORAD_CAT_ID", where) if "NORAD_CAT_ID" in fields else 0.0
    if not 0 <= number < 1e10 or number != int(number):
        raise InputError(f'{where}: NORAD_CAT_ID is "{shown(fields["NORAD_CAT_ID"])}", not a catalogue number.')
    if "EPOCH" not in fields:
        raise InputError(f"{where}: EPOCH is missing.")
    epoch = parse_epoch(fields["EPOCH"], f"{where}: EPOCH")
    try:
        return ElementSet(name=fields.get("OBJECT_NAME", ""), norad_id=int(number), epoch_utc=epoch, **values)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _clean(fields: dict) -> Iterator[tuple[str, str]]:
    """Upper-case keys and text values, without empty ones."""
    for key, value in fields.items():
        if isinstance(key, str) and value is not None and not isinstance(value, (list, dict)):
            text = str(value).strip()
            if text:
                yield key.strip().upper(), text


def _refuse_other_theories(fields: dict[str, str], where: str) -> None:
    """Only what SGP4 can carry passes."""
    for key, allowed in MUST_BE.items():
        if key in fields and fields[key].upper() not in allowed:
            raise InputError(f"{where}: {key} is {shown(fields[key])}; SGP4 elements have {' or '.join(sorted(allowed))}.")
    if fields.get("EPHEMERIS_TYPE") == SGP4_XP:
        raise InputError(f"{where}: EPHEMERIS_TYPE 4 is SGP4-XP, which SGP4 cannot carry; get the plain elements (type 0).")


def _number(fields: dict[str, str], key: str, where: str) -> float:
    """A value as a number; the unit that KVN allows behind it is dropped."""
    if key not in fields:
        raise InputError(f"{where}: {key} is missing; SGP4 needs {', '.join(REQUIRED)} and EPOCH.")
    text = re.sub(r"\s*\[[^\]]*\]$", "", fields[key])
    try:
        return float(text)
    except ValueError:
        raise InputError(f'{where}: {key} reads "{shown(fields[key])}", which is no number.') from None


def _plain(tag) -> str:
    """An XML tag without its namespace."""
    return tag.rpartition("}")[2] if isinstance(tag, str) else ""


def _refuse_empty(source: str, what: str) -> list[ElementSet]:
    """For a file of the right kind that holds nothing."""
    raise InputError(f'"{source}" is {what}: there is no orbit in it.')
