"""The user's word on columns, units and axes: a small TOML file, a dictionary of the same shape, or flags.

[columns]
time = "obc_time"
magnetometer = ["hx", "hy", "hz"]
gyro = ["acc_x", "acc_y", "acc_z"]
sun_sensor = { "-x" = "css1", "+x" = "css2" }

[units]
time = "unix_ms"
magnetometer = "mG"

[axes]
position = "ITRS"
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping as MappingType
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fieldline.errors import InputError, nearest

VECTORS = ("magnetometer", "gyro", "dipole_command", "position")
SINGLES = ("time", "temperature", "solar_current", "yaw")
NAMED = ("sun_sensor", "wheel_speed")
QUANTITIES = (*VECTORS, *SINGLES, *NAMED)
_SHORT = {"mag": "magnetometer", "dipole": "dipole_command", "wheel": "wheel_speed", "css": "sun_sensor", "sun": "sun_sensor"}
POSITION_AXES = ("ITRS", "GCRS", "J2000", "TEME", "geodetic", "geocentric")
_FACES = ("+x", "-x", "+y", "-y", "+z", "-z")


@dataclass(frozen=True, kw_only=True)
class Mapping:
    """Columns by quantity (names of vectors in the order x, y, z; named ones as a dictionary), units, position's axes."""

    columns: dict[str, tuple[str, ...] | dict[str, str]] = field(default_factory=dict)
    units: dict[str, str | float] = field(default_factory=dict)
    position_axes: str = ""

    def single(self, quantity: str) -> str:
        """The one column given for a quantity, or ""."""
        return next(iter(self.columns.get(quantity, ())), "")


def read_mapping(mapping, columns=None, units=None, mag_columns=None, time_column=None, unit=None) -> Mapping:
    """One mapping of a TOML file or dictionary and of flags, which win over it."""
    where, tables = _tables(mapping)
    unknown = set(tables) - {"columns", "units", "axes"}
    if unknown:
        raise InputError(f'{where}: unknown table "{min(unknown)}"; {nearest(min(unknown), ("columns", "units", "axes"))}.')
    for key, table in tables.items():
        if not isinstance(table, MappingType):
            raise InputError(f"{where}: [{key}] must be a table of names; got {table!r:.40}.")
    wanted = _canonical(tables.get("columns", {}), where, "columns") | _canonical(columns or {}, "columns", "columns")
    stated = _canonical(tables.get("units", {}), where, "units") | _canonical(units or {}, "units", "units")
    if mag_columns is not None:
        wanted["magnetometer"] = mag_columns
    if time_column is not None:
        wanted["time"] = time_column
    if unit is not None:
        stated["magnetometer"] = unit
    for key, value in stated.items():
        if not isinstance(value, (str, int, float)) or isinstance(value, bool):
            raise InputError(f'{where}: units.{key} must be a unit such as "nT"; got {value!r:.40}.')
    return Mapping(
        columns={quantity: _names(where, quantity, value) for quantity, value in wanted.items()},
        units=stated,
        position_axes=_axes(tables.get("axes", {}), where),
    )


def _tables(mapping) -> tuple[str, dict]:
    """Where the mapping comes from, for messages, and its tables."""
    if mapping is None:
        return "mapping", {}
    if isinstance(mapping, MappingType):
        return "mapping", dict(mapping)
    path = Path(mapping)
    try:
        return f'mapping "{path}"', tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f'mapping "{path}" cannot be read: {error.strerror}.') from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f'mapping "{path}" is no TOML: {error}.') from error


def _canonical(table: MappingType, where: str, what: str) -> dict:
    """The table with full names of quantities."""
    result = {}
    for key, value in table.items():
        quantity = _SHORT.get(key, key)
        if quantity not in QUANTITIES:
            raise InputError(f'{where}: unknown quantity "{key}" in {what}; {nearest(str(key), QUANTITIES)}.')
        result[quantity] = value
    return result


def _names(where: str, quantity: str, value) -> tuple[str, ...] | dict[str, str]:
    """Column names of a quantity, checked for their number."""
    if quantity in NAMED:
        if not isinstance(value, MappingType) or not all(isinstance(v, str) for v in value.values()):
            raise InputError(f'{where}: columns.{quantity} must name each column, as {{ "-x" = "css1" }}; got {value!r:.60}.')
        odd = [key for key in value if quantity == "sun_sensor" and key not in _FACES]
        if odd:
            raise InputError(f'{where}: columns.sun_sensor: "{odd[0]}" is no face; faces are {", ".join(_FACES)}.')
        return dict(value)
    if isinstance(value, str):
        value = (value,) if quantity in SINGLES else tuple(part.strip() for part in value.split(","))
    if not isinstance(value, Sequence) or not all(isinstance(name, str) and name for name in value):
        raise InputError(f"{where}: columns.{quantity} must be names of columns; got {value!r:.60}.")
    allowed = (1,) if quantity in SINGLES else (1, 3)
    if len(value) not in allowed:
        expected = "one column" if quantity in SINGLES else 'three columns, as ["bx", "by", "bz"], or one column of vectors'
        raise InputError(f"{where}: columns.{quantity} must be {expected}; got {len(value)}: {', '.join(value)}.")
    if len(set(value)) < len(value):
        raise InputError(f"{where}: columns.{quantity} names a column twice: {', '.join(value)}.")
    return tuple(value)


def _axes(table: MappingType, where: str) -> str:
    """The axes of the position columns, as stated."""
    unknown = set(table) - {"position"}
    if unknown:
        raise InputError(f'{where}: [axes] holds "position" only; got "{min(unknown)}".')
    axes = table.get("position", "")
    if not axes:
        return ""
    found = {name.lower(): name for name in POSITION_AXES} | {"ecef": "ITRS", "itrf": "ITRS", "eme2000": "J2000", "gcrf": "GCRS"}
    if str(axes).lower() not in found:
        raise InputError(f'{where}: axes.position = "{axes}" is not known; {nearest(str(axes), POSITION_AXES)}.')
    return found[str(axes).lower()]
