"""Two-line element sets: strict columns, checksums, several sets, with or without name lines.

Columns (from 1). Line 1: 3-7 catalogue number (alpha-5 allowed), 19-20 year, 21-32 day of year, 34-43 half the rate of
mean motion, 45-52 a sixth of its curvature, 54-61 B*, 69 checksum. Line 2: 3-7 number, 9-16 inclination, 18-25 node,
27-33 eccentricity, 35-42 argument of perigee, 44-51 mean anomaly [deg], 53-63 mean motion [rev/day], 69 checksum.
The checksum is the sum of the digits of columns 1-68, with 1 for each minus sign, modulo 10.

Years 57 to 99 are 1957 to 1999. Source: CelesTrak, NORAD Two-Line Element Set Format; Vallado et al. (2006), app. B.
"""

from __future__ import annotations

import re

import numpy as np

from fieldline.errors import InputError, shown
from fieldline.orbit.element_set import SGP4_XP, ElementSet

LINE_LENGTH = 69
SHORTEST_ELEMENT_LINE = 40  # shorter lines that begin with "1 " or "2 " are names
ALPHA5 = "ABCDEFGHJKLMNPQRSTUVWXYZ"  # without I and O
DECIMAL = re.compile(r"[+-]?\d*\.\d+|[+-]?\d+\.?")
EXPONENT = re.compile(r"([+-]?)(\d{1,5})([+-]?)(\d)")
BLANK_COLUMNS = {"1": (2, 9, 18, 33, 44, 53, 62, 64), "2": (2, 8, 17, 26, 34, 43, 52)}


def is_element_line(line: str) -> bool:
    """Whether a line looks like line 1 or 2 of a set, whole or damaged."""
    return line[:2] in ("1 ", "2 ") and len(line) > SHORTEST_ELEMENT_LINE


def parse_tle(text: str, source: str) -> list[ElementSet]:
    """All element sets of a text, in its order; InputError names `source`, the line and what is wrong."""
    sets: list[ElementSet] = []
    name, first = "", None  # the pending name line and line 1
    for number, raw in enumerate(text.splitlines(), start=1):
        line, where = raw.replace("\t", " ").strip(), f'"{source}" line {number}'
        if not line or line.startswith("#"):
            continue
        if not is_element_line(line):
            if first is not None:
                raise InputError(f'{where}: expected line 2 of the set begun in line {first[0]}, got "{shown(line)}".')
            name = _name(line, where)
        elif line[0] == "1":
            if first is not None:
                raise InputError(f"{where}: a second line 1; line 2 of the set begun in line {first[0]} is missing.")
            first = (number, _checked(line, where))
        else:
            if first is None:
                raise InputError(f"{where}: line 2 comes without its line 1 before it. Are the two lines swapped?")
            sets.append(_element_set(name, first, (number, _checked(line, where)), source))
            name, first = "", None
    if first is not None:
        raise InputError(f'"{source}": the file ends after line 1 of a set (line {first[0]}); its line 2 is missing.')
    return sets


def _name(line: str, where: str) -> str:
    """The satellite's name from a title line, with or without the leading "0 "."""
    if len(line) > SHORTEST_ELEMENT_LINE:
        raise InputError(f'{where} is neither a name nor an element line: "{shown(line)}...". Expected "1 " or "2 " first.')
    return line[2:].strip() if line.startswith("0 ") else line


def _checked(line: str, where: str) -> str:
    """The line, once its length, characters, blanks and checksum hold."""
    if not line.isascii():
        raise InputError(f"{where}: {next(c for c in line if not c.isascii())!r} does not belong in an element line.")
    if len(line) != LINE_LENGTH:
        raise InputError(
            f"{where} has {len(line)} characters; an element line has {LINE_LENGTH}, the last one its checksum. "
            "Was it cut, or were blanks lost when it was copied?"
        )
    for column in BLANK_COLUMNS[line[0]]:
        if line[column - 1] != " ":
            raise InputError(
                f'{where}: column {column} must be blank, it holds "{shown(line[column - 1])}". Have blanks been lost?'
            )
    computed, stated = checksum(line), line[-1]
    if str(computed) != stated:
        raise InputError(
            f'{where}: the checksum is "{shown(stated)}" and the digits before it sum to {computed}. A character was changed or '
            "blanks were lost at the line's end; fetch the set again."
        )
    return line


def checksum(line: str) -> int:
    """Sum of the digits of columns 1 to 68, 1 for each minus, modulo 10."""
    return sum(int(c) if c in "0123456789" else c == "-" for c in line[: LINE_LENGTH - 1]) % 10


def _element_set(name: str, first: tuple[int, str], second: tuple[int, str], source: str) -> ElementSet:
    """The set of two checked lines, each with its number in the file."""
    (n1, line1), (n2, line2) = first, second
    at1, at2 = f'"{source}" line {n1}', f'"{source}" line {n2}'
    norad_id = _catalogue_number(line1, at1)
    if _catalogue_number(line2, at2) != norad_id:
        raise InputError(f"{at2} is of object {line2[2:7]}, line 1 before it of {line1[2:7]}: the lines do not belong together.")
    if line1[62] == SGP4_XP:
        raise InputError(f"{at1}: ephemeris type 4 is SGP4-XP, which SGP4 cannot carry; get the plain elements (type 0).")
    try:
        return ElementSet(
            name=name,
            norad_id=norad_id,
            epoch_utc=_epoch(line1[18:32], at1),
            half_motion_rate_rev_day2=_decimal(line1[33:43], at1, "half the rate of mean motion"),
            sixth_motion_curvature_rev_day3=_exponent(line1[44:52], at1, "a sixth of the mean motion's curvature"),
            drag_per_radius=_exponent(line1[53:61], at1, "B*"),
            inclination_deg=_decimal(line2[8:16], at2, "the inclination"),
            node_deg=_decimal(line2[17:25], at2, "the node"),
            eccentricity=_decimal("." + line2[26:33].strip(), at2, "the eccentricity"),
            perigee_deg=_decimal(line2[34:42], at2, "the argument of perigee"),
            anomaly_deg=_decimal(line2[43:51], at2, "the mean anomaly"),
            motion_rev_day=_decimal(line2[52:63], at2, "the mean motion"),
        )
    except InputError as error:
        raise error if source in str(error) else InputError(f'"{source}" lines {n1} and {n2}: {error}') from None


def _catalogue_number(line: str, where: str) -> int:
    """Columns 3 to 7: digits, or a letter and four digits (alpha-5: A is 10, Z is 33)."""
    text = line[2:7].strip()
    if text.isdigit():
        return int(text)
    if len(text) == 5 and text[0] in ALPHA5 and text[1:].isdigit():
        return (ALPHA5.index(text[0]) + 10) * 10000 + int(text[1:])
    raise InputError(
        f'{where}: columns 3 to 7 hold "{shown(line[2:7])}", not a catalogue number (digits, or a letter and four digits).'
    )


def _epoch(text: str, where: str) -> np.datetime64:
    """Columns 19 to 32 of line 1: two digits of the year, day of the year with its fraction; exact to 1 ns."""
    match = re.fullmatch(r"([ \d]\d)([ \d]{2}\d)\.(\d{8})", text)
    day = int(match[2]) if match else 0
    if not match or not 1 <= day <= 366:
        raise InputError(
            f'{where}: the epoch "{shown(text)}" is no two-digit year and day of the year (1 to 366) with eight decimals.'
        )
    year = int(match[1]) + (1900 if int(match[1]) >= 57 else 2000)
    start = np.datetime64(f"{year:04d}-01-01", "ns")
    return start + np.timedelta64((day - 1) * 86_400_000_000_000 + int(match[3]) * 864_000, "ns")


def _decimal(text: str, where: str, what: str) -> float:
    """A plain number in fixed columns."""
    if not DECIMAL.fullmatch(text.strip()):
        raise InputError(f'{where}: {what} reads "{shown(text)}", which is no number.')
    return float(text)


def _exponent(text: str, where: str, what: str) -> float:
    """A number as " 73805-3": a decimal point before the digits, then a power of ten."""
    match = EXPONENT.fullmatch(text.strip().replace(" ", "+"))
    if not match:
        raise InputError(f'{where}: {what} reads "{shown(text)}"; expected a sign, five digits and an exponent, as " 73805-3".')
    return float(f"{match[1]}.{match[2]}e{match[3]}{match[4]}")
