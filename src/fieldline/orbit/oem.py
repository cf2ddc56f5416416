"""Orbit ephemeris messages (CCSDS 502.0, KVN): segments of states, turned to GCRS as they are read.

    ITRF:     r_i = dcm_ei^T r_e,   v_i = dcm_ei^T (v_e + omega_e x r_e)                  (1)
    EME2000:  r_i = B^T r_j         with the frame bias B (23 milliarcseconds)          (2)
    TEME:     r_i = dcm_it r_t                                                          (3)
    GCRF and ICRF have the axes of GCRS.

Each segment is interpolated by itself, as it states (Lagrange or Hermite and the degree), otherwise Hermite of degree 7,
and within its useable span only. Times may be UTC, TAI, GPS, TT or TDB. Covariance blocks are passed over.

Source: CCSDS 502.0-B-3, s. 5; frame bias: IERS Conventions (2010), s. 5.2, in ERFA.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from fieldline.constants import EARTH_ROTATION_RATE_RAD_S
from fieldline.errors import InputError, shown
from fieldline.frames.earth_orientation import EarthOrientation
from fieldline.frames.earth_rotation import dcm_ei, dcm_it
from fieldline.orbit.ccsds import key_value, parse_epoch, utc_from
from fieldline.orbit.ephemeris_orbit import EphemerisOrbit
from fieldline.orbit.interpolation import PolynomialPath

INERTIAL = {"GCRF": "gcrs", "ICRF": "gcrs", "GCRS": "gcrs", "EME2000": "bias", "J2000": "bias", "TEME": "teme"}
DEFAULT_DEGREE = 7
DEGREE_MAX = 15
SPEED_MAX_KM_S = 20.0  # leaving the Earth for good takes 11
METHODS = ("HERMITE", "LAGRANGE", "LINEAR")


@dataclass
class _Segment:
    """What a segment holds as text: its keys, and its data lines with their numbers in the file."""

    line: int
    keys: dict[str, str] = field(default_factory=dict)
    rows: list[tuple[int, list[str]]] = field(default_factory=list)


def parse_oem(text: str, source: str, eop: EarthOrientation | None = None) -> EphemerisOrbit:
    """The orbit of all segments of one object; InputError names `source`, the line and what is wrong."""
    segments = list(_segments(text, source))
    if not segments:
        raise InputError(f'"{source}" is an OEM without a segment (META_START ... META_STOP, then states).')
    objects = sorted({s.keys.get("OBJECT_ID") or s.keys.get("OBJECT_NAME", "") for s in segments})
    if len(objects) > 1:
        raise InputError(f'"{source}" holds several objects: {shown(", ".join(objects), 100)}. Keep one object in a file.')
    paths = sorted((_path(segment, source, eop) for segment in segments), key=lambda path: path.first_utc)
    return EphemerisOrbit(
        name=segments[0].keys.get("OBJECT_NAME") or objects[0] or source, kind="OEM", eop=eop, paths=tuple(paths)
    )


def _segments(text: str, source: str) -> Iterator[_Segment]:
    """The file cut into segments."""
    segment, inside, covariance = None, "", False
    for number, raw in enumerate(text.splitlines(), start=1):
        line = raw.strip()
        word = line.split(maxsplit=1)[0] if line else ""
        if not line or word == "COMMENT":
            continue
        if word == "META_START":
            if segment is not None:
                yield segment
            segment, inside = _Segment(number), "meta"
        elif word == "META_STOP":
            inside = "data"
        elif word in ("COVARIANCE_START", "COVARIANCE_STOP"):
            covariance = word == "COVARIANCE_START"
        elif segment is None or covariance:
            continue
        elif inside == "meta":
            key, value = key_value(line, f'"{source}" line {number}')
            segment.keys[key] = value
        else:
            segment.rows.append((number, line.split()))
    if segment is not None:
        if inside == "meta":
            raise InputError(f'"{source}": the segment begun in line {segment.line} has no META_STOP. Was the file cut?')
        yield segment


def _path(segment: _Segment, source: str, eop: EarthOrientation | None) -> PolynomialPath:
    """One segment as a path in GCRS axes."""
    where = f'"{source}", segment of line {segment.line}'
    keys = segment.keys
    if keys.get("CENTER_NAME", "EARTH").upper() != "EARTH":
        raise InputError(f"{where}: CENTER_NAME is {shown(keys['CENTER_NAME'])}; only orbits about the Earth are known.")
    system = keys.get("TIME_SYSTEM", "UTC")
    times = utc_from(_epochs(segment, source), system, where)
    _refuse_disorder(times, segment, source)
    position, velocity = _states(segment, source)
    position_i, velocity_i = to_gcrs(position, velocity, times, keys.get("REF_FRAME", ""), where, eop)
    useable = [_useable(keys, key, system, where) for key in ("USEABLE_START_TIME", "USEABLE_STOP_TIME")]
    method, degree = _interpolation(keys, where)
    return PolynomialPath.through(times, position_i, velocity_i, method=method, degree=degree, useable=useable)


def _epochs(segment: _Segment, source: str) -> np.ndarray:
    """(n,) datetime64[ns], in the segment's own time system."""
    if len(segment.rows) < 2:
        raise InputError(f'"{source}", segment of line {segment.line}: {len(segment.rows)} states; two at least are needed.')
    return np.array([parse_epoch(words[0], f'"{source}" line {n}') for n, words in segment.rows], dtype="datetime64[ns]")


def _refuse_disorder(times: np.ndarray, segment: _Segment, source: str) -> None:
    """States must come in the order of time."""
    late = np.flatnonzero(np.diff(times) <= np.timedelta64(0, "ns"))
    if late.size:
        number, words = segment.rows[late[0] + 1]
        raise InputError(f'"{source}" line {number}: the time {words[0]} is not after the one before it.')


def _states(segment: _Segment, source: str) -> tuple[np.ndarray, np.ndarray]:
    """Position [m] and velocity [m/s], (n, 3), in the segment's own axes."""
    for number, words in segment.rows:
        if len(words) not in (7, 10):
            raise InputError(
                f'"{source}" line {number} has {len(words)} columns; expected a time, three positions [km] and three '
                "velocities [km/s] (and three accelerations, which are not used)."
            )
    try:
        states = np.array([[float(word) for word in words[1:7]] for _, words in segment.rows])
    except ValueError as error:
        raise InputError(f'"{source}", segment of line {segment.line}: {shown(str(error), 80)}.') from None
    _refuse_other_units(states, f'"{source}", segment of line {segment.line}')
    return states[:, :3] * 1000.0, states[:, 3:] * 1000.0


def _refuse_other_units(states: np.ndarray, where: str) -> None:
    """Kilometres and kilometres a second, or InputError."""
    with np.errstate(over="ignore", invalid="ignore"):
        radius, speed = (np.linalg.norm(part, axis=1) for part in (states[:, :3], states[:, 3:]))
    if not (radius.min() > 1e3 and radius.max() < 1e7):
        raise InputError(
            f"{where}: distances run from {radius.min():.6g} to {radius.max():.6g} km from the Earth's centre. "
            "An OEM states kilometres: is it written in metres?"
        )
    if not speed.max() < SPEED_MAX_KM_S:
        raise InputError(
            f"{where}: speeds run to {speed.max():.6g} km/s; near the Earth they stay below {SPEED_MAX_KM_S:g}. "
            "An OEM states km/s: is it written in m/s?"
        )


def to_gcrs(position, velocity, times, frame: str, where: str, eop: EarthOrientation | None = None):
    """States (n, 3) of a named frame in GCRS axes, equations (1) to (3)."""
    import erfa

    name = frame.upper().replace(" ", "")
    if name.startswith("ITRF") or name == "WGS84":
        turn = np.swapaxes(dcm_ei(times, eop), -1, -2)
        pole_e = np.einsum("nji,nj->ni", turn, dcm_ei(times)[:, 2])  # the axis of rotation, off z by polar motion
        velocity = velocity + EARTH_ROTATION_RATE_RAD_S * np.cross(pole_e, position)
    elif INERTIAL.get(name) == "gcrs":
        return position, velocity
    elif INERTIAL.get(name) == "bias":
        turn = np.broadcast_to(erfa.bp06(2451545.0, 0.0)[0].T, (len(times), 3, 3))
    elif INERTIAL.get(name) == "teme":
        turn = dcm_it(times)
    else:
        raise InputError(f'{where}: REF_FRAME is "{shown(frame)}"; known: {", ".join(INERTIAL)}, ITRF (any year), WGS84.')
    return np.einsum("nij,nj->ni", turn, position), np.einsum("nij,nj->ni", turn, velocity)


def _useable(keys: dict[str, str], key: str, system: str, where: str) -> np.datetime64 | None:
    """An end of the useable span, where it is stated."""
    return utc_from(parse_epoch(keys[key], f"{where}: {key}")[None], system, where)[0] if key in keys else None


def _interpolation(keys: dict[str, str], where: str) -> tuple[str, int]:
    """Method and degree as stated, or Hermite of degree 7."""
    method = keys.get("INTERPOLATION", "HERMITE").upper()
    if method not in METHODS:
        raise InputError(f"{where}: INTERPOLATION is {shown(method)}; known: {', '.join(METHODS)}.")
    stated = keys.get("INTERPOLATION_DEGREE", "1" if method == "LINEAR" else str(DEFAULT_DEGREE))
    if not (stated.isascii() and stated.isdigit() and 1 <= int(stated) <= DEGREE_MAX):
        raise InputError(f'{where}: INTERPOLATION_DEGREE is "{shown(stated)}"; expected 1 to {DEGREE_MAX}.')
    return ("LAGRANGE", 1) if method == "LINEAR" else (method, int(stated))
