"""Position columns: geodetic, geocentric (Swarm) or Cartesian in named axes, as ITRS positions in metres.

    geocentric:  r_e = radius (cos lat cos lon, cos lat sin lon, sin lat)                    (1)

Inertial axes (GCRS, J2000, TEME) turn into ITRS with the Earth; "eci" alone does not say which it is (TEME and GCRS are
0.3 degrees apart in 2023, 40 km in low orbit), so it is not used until the mapping names it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError
from fieldline.telemetry.columns import split_axis, split_unit, words_of
from fieldline.telemetry.table import AXES
from fieldline.telemetry.units import Unit, find_unit

_LATITUDE = {"latitude", "lat", "geolat"}
_LONGITUDE = {"longitude", "lon", "lng", "long", "geolon"}
_ALTITUDE = {"altitude", "alt", "height", "hgt"}
_RADIUS = {"radius", "rad", "r"}
_FRAMES = {"ecef": "ITRS", "itrf": "ITRS", "itrs": "ITRS", "ecr": "ITRS", "gcrs": "GCRS", "gcrf": "GCRS", "j2000": "J2000"}
_FRAMES |= {"eme2000": "J2000", "teme": "TEME", "eci": "ECI"}
_NEUTRAL = set(
    "pos position r sat sc satellite spacecraft geodetic geocentric wgs 84 wgs84 gps gnss orbit s c geod fix nav".split()
)
EARTH_FIXED_RANGE_M = (6.2e6, 5.0e7)


class Position(NamedTuple):
    """Three columns in their order and units, and the axes that they are in."""

    names: tuple[str, str, str]
    units: tuple[Unit, Unit, Unit]
    axes: str
    why: str


def _kind(name: str) -> tuple[str, str, str]:
    """(part, frame, unit text) of a name: part is "latitude", "x" …, or "" where the name is no position."""
    stem, unit_text = split_unit(name)
    words = words_of(stem.replace("J2000", "j2000").replace("EME2000", "eme2000"))
    words = _join_years(words)
    axis, rest = split_axis(words)
    frame = next((_FRAMES[word] for word in rest if word in _FRAMES), "")
    extra = set(rest) - set(_FRAMES) - _NEUTRAL
    if axis and not extra and (frame or set(rest) & {"pos", "position", "r"} or not rest):
        return axis, frame, unit_text
    for part, names in (("latitude", _LATITUDE), ("longitude", _LONGITUDE), ("altitude", _ALTITUDE), ("radius", _RADIUS)):
        if set(words) & names and not set(words) - names - _NEUTRAL:
            return part, "geocentric" if "geocentric" in words else "", unit_text
    return "", "", ""


def _join_years(words: list[str]) -> list[str]:
    """The words with "j", "2000" put together again."""
    text = " ".join(words).replace("j 2000", "j2000").replace("eme 2000", "eme2000")
    return text.split()


def find_position(
    names: Sequence[str], units: Mapping[str, str], axes: str = "", length: Unit | None = None
) -> tuple[Position | None, list[str]]:
    """The position columns of a file, or None with sentences on what is missing to use those that there are.

    axes, length : what the user says of the Cartesian columns' axes and of the unit of lengths.
    """
    parts: dict[str, list[tuple[str, str, str]]] = {}
    for name in names:
        part, frame, unit_text = _kind(name)
        if part:
            parts.setdefault(part, []).append((name, frame, unit_text or units.get(name, "")))
    if {"latitude", "longitude"} <= set(parts) and set(parts) & {"altitude", "radius"} and axes in {"", "geodetic", "geocentric"}:
        return _spherical(parts, length)
    if {"x", "y", "z"} <= set(parts):
        return _cartesian(parts, axes, length)
    return None, []


def _spherical(parts, length: Unit | None) -> tuple[Position | None, list[str]]:
    third = "radius" if "radius" in parts else "altitude"
    (latitude, frame, first), (longitude, _, second), (size, _, third_unit) = (
        parts[part][0] for part in ("latitude", "longitude", third)
    )
    names = (latitude, longitude, size)
    said = ", ".join(names)
    if third == "altitude" and frame == "geocentric":
        return None, [f"{said}: a geocentric latitude needs the radius, not an altitude; not used as the position"]
    length = length or find_unit(third_unit, "position")
    degree = Unit("deg", np.pi / 180.0)
    angles = [find_unit(text, "angle") if text else degree for text in (first, second)]
    if length is None or angles[0] is None or angles[1] is None:
        return None, [f"{said}: the unit of {size} is not stated; not used as the position ([units] position = …)"]
    axes = "geocentric" if third == "radius" else "geodetic"
    return Position(names, (angles[0], angles[1], length), axes, "by their names"), []


def _cartesian(parts, axes: str, length: Unit | None) -> tuple[Position | None, list[str]]:
    for frame in ("ITRS", "GCRS", "J2000", "TEME", "ECI", ""):
        chosen = [item for axis in AXES for item in parts[axis] if item[1] == frame][:3]
        if len(chosen) < 3 or any(chosen[k] not in parts[axis] for k, axis in enumerate(AXES)):
            continue
        names = (chosen[0][0], chosen[1][0], chosen[2][0])
        said = ", ".join(names)
        units = [length or find_unit(text, "position") for _, _, text in chosen]
        known = [unit for unit in units if unit is not None]
        if frame in {"ECI", ""} and not axes:
            if len(known) < 3:
                return None, []
            which = "inertial axes, but not which" if frame else "no axes"
            return None, [f"{said}: the names say {which}; not used as the position ([axes] position = GCRS, TEME …)"]
        if len(known) < 3:
            return None, [f"{said}: no unit is stated; not used as the position ([units] position = …)"]
        return Position(names, (known[0], known[1], known[2]), axes or frame, "by their names"), []
    return None, []


def position_in_itrs(path, position: Position, values: np.ndarray, time_utc: np.ndarray) -> np.ndarray:
    """(n, 3) [m] ITRS of the columns' values in SI (radians, metres); NaN where any of them is."""
    good = np.isfinite(values).all(axis=1)
    result = np.full(values.shape, np.nan)
    if not good.any():
        return result
    result[good] = _convert(position.axes, values[good], time_utc[good])
    radius = float(np.median(np.linalg.norm(result[good], axis=1)))
    low, high = EARTH_FIXED_RANGE_M
    if not low < radius < high:
        raise InputError(
            f'"{path}": the position columns {", ".join(position.names)} put the satellite {radius / 1e3:.6g} km '
            f"from the Earth's centre; expected {low / 1e3:.0f} to {high / 1e3:.0f} km. "
            "Check their units, or state them: [units] position = …"
        )
    return result


def _convert(axes: str, values: np.ndarray, time_utc: np.ndarray) -> np.ndarray:
    if axes == "ITRS":
        return values
    if axes == "geocentric":
        latitude, longitude, radius = values.T
        flat = radius * np.cos(latitude)
        return np.stack([flat * np.cos(longitude), flat * np.sin(longitude), radius * np.sin(latitude)], axis=-1)  # (1)
    from fieldline.frames.earth_rotation import dcm_ei, dcm_it, itrs_from_geodetic

    if axes == "geodetic":
        return itrs_from_geodetic(*values.T)
    inertial = values
    if axes == "TEME":
        inertial = np.einsum("nij,nj->ni", dcm_it(time_utc), values)
    return np.einsum("nij,nj->ni", dcm_ei(time_utc), inertial)  # J2000 is 0.7 m from GCRS in low orbit (frame bias)
