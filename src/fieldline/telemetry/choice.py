"""Which columns of a file serve which quantity: the user's word first, then the names; what is doubtful is asked.

The magnetometer and the time must be found. Every other quantity is a help: where its columns are ambiguous or lack a
unit they are left out and a sentence says so.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from fieldline.errors import InputError, nearest
from fieldline.telemetry.clock import TimeColumn, find_time, time_kind
from fieldline.telemetry.columns import Column, recognise, split_unit
from fieldline.telemetry.mapping import Mapping
from fieldline.telemetry.position import Position, find_position
from fieldline.telemetry.table import AXES, Source, listed
from fieldline.telemetry.units import DEGREE, Unit, find_unit, parse_unit

_OPTIONAL_VECTORS = ("gyro", "dipole_command")
_NO_UNIT = Unit("", 1.0)
_WHEEL_WORDS = {
    "wheel",
    "wheels",
    "rw",
    "rwa",
    "reaction",
    "momentum",
    "reactionwheel",
    "momentumwheel",
    "speed",
    "rate",
    "omega",
}


@dataclass(kw_only=True)
class Choice:
    """Chosen columns: names and units. The magnetometer's unit may be missing (None) until its numbers are seen."""

    time: TimeColumn
    magnetometer: tuple[Column, Column, Column]
    mag_stated: bool
    vectors: dict[str, tuple[Column, ...]] = field(default_factory=dict)
    singles: dict[str, Column] = field(default_factory=dict)
    sun_sensor: dict[str, Column] = field(default_factory=dict)
    wheel_speed: dict[str, Column] = field(default_factory=dict)
    position: Position | None = None
    told: frozenset[str] = frozenset()
    ignored: list[str] = field(default_factory=list)

    def columns(self) -> list[Column]:
        """Every chosen column of numbers, the position's apart."""
        several = [column for columns in self.vectors.values() for column in columns]
        return [*self.magnetometer, *several, *self.singles.values(), *self.sun_sensor.values(), *self.wheel_speed.values()]

    def numbers(self) -> list[str]:
        """Names of all columns to read as numbers."""
        return list(dict.fromkeys([*(c.name for c in self.columns()), *(self.position.names if self.position else ())]))


def choose(source: Source, mapping: Mapping) -> Choice:
    """The columns of `source` to read."""
    check_names(source, mapping)
    time = _choose_time(source, mapping)
    found = [column for name in source.names if (column := recognise(name, source.units.get(name, ""))) is not None]
    found = [column for column in found if column.name != time.name]
    choice = Choice(
        time=time,
        magnetometer=_choose_magnetometer(source, mapping, found),
        mag_stated="magnetometer" in mapping.units,
        told=frozenset(mapping.columns),
    )
    taken = {column.name for column in choice.magnetometer} | _names_in(mapping)
    found = [column for column in found if column.name not in taken]
    for quantity in _OPTIONAL_VECTORS:
        _choose_vector(source, mapping, found, quantity, choice)
    for quantity in ("temperature", "solar_current", "yaw"):
        _choose_single(source, mapping, found, quantity, choice)
    _choose_named(source, mapping, found, choice)
    _choose_position(source, mapping, choice)
    return choice


def check_names(source: Source, mapping: Mapping) -> None:
    """Refuse a mapping that names a column which the file does not have."""
    for quantity in mapping.columns:
        for name in _named(source, mapping, quantity):
            if name not in source.names:
                raise InputError(
                    f'"{source.path}" has no column "{name}" (asked for as {quantity}); {nearest(name, source.names)}.'
                )


def _names_in(mapping: Mapping) -> set[str]:
    """Every column name in the mapping."""
    named = mapping.columns.values()
    return {name for names in named for name in (names.values() if isinstance(names, dict) else names)}


def _named(source: Source, mapping: Mapping, quantity: str) -> list[str]:
    """The columns given for a quantity; one name of a vector stands for its three axes."""
    names = mapping.columns.get(quantity, ())
    names = list(names.values()) if isinstance(names, dict) else list(names)
    if len(names) == 1 and names[0] not in source.names and f"{names[0]}.x" in source.names:
        return [f"{names[0]}.{axis}" for axis in AXES]
    return names


def _choose_time(source: Source, mapping: Mapping) -> TimeColumn:
    name, kind = mapping.single("time"), str(mapping.units.get("time", ""))
    if not name:
        found = find_time(source.path, source.names, source.units, source.peek, told=bool(kind))
        name = found.name
        if not kind:
            return found
    return time_kind(source.path, name, source.units.get(name, ""), source.peek.get(name, ""), kind)


def _given(source: Source, mapping: Mapping, quantity: str) -> tuple[Column, ...]:
    """Columns that the user names, with the unit that he states or that their names carry."""
    names = _named(source, mapping, quantity)
    if quantity in {"magnetometer", *_OPTIONAL_VECTORS} and len(names) == 1:
        raise InputError(
            f'"{source.path}": column "{names[0]}" is no vector; the {quantity.replace("_", " ")} needs three columns.'
        )
    units = [_unit(source, mapping, quantity, name) for name in names]
    return tuple(
        Column(name, quantity, axis, unit, "told")
        for name, axis, unit in zip(names, AXES if len(names) == 3 else ("",), units, strict=False)
    )


def _unit(source: Source, mapping: Mapping, quantity: str, name: str) -> Unit | None:
    if quantity in mapping.units:
        return parse_unit(mapping.units[quantity], quantity, f"units.{quantity}")
    return find_unit(split_unit(name)[1] or source.units.get(name, ""), quantity)


def _with_unit(mapping: Mapping, column: Column) -> Column:
    """The column with the unit that the user states for its quantity, if he does."""
    if column.quantity not in mapping.units:
        return column
    return column._replace(unit=parse_unit(mapping.units[column.quantity], column.quantity, f"units.{column.quantity}"))


def _groups(found: Sequence[Column], quantity: str) -> dict[str, dict[str, list[Column]]]:
    """Instruments of a quantity: group to axis to columns."""
    groups: dict[str, dict[str, list[Column]]] = {}
    for column in found:
        if column.quantity == quantity:
            groups.setdefault(column.group, {}).setdefault(column.axis, []).append(column)
    return groups


def _choose_magnetometer(source: Source, mapping: Mapping, found: Sequence[Column]) -> tuple[Column, Column, Column]:
    if "magnetometer" in mapping.columns:
        columns = _given(source, mapping, "magnetometer")
    else:
        columns = _find_magnetometer(source, found)
        columns = tuple(_with_unit(mapping, column) for column in columns)
    units = {column.unit.name for column in columns if column.unit}
    if len(units) > 1 or (units and None in [column.unit for column in columns]):
        said = ", ".join(f"{column.name} in {column.unit.name if column.unit else 'no unit'}" for column in columns)
        raise InputError(
            f'"{source.path}": the magnetometer\'s axes have different units: {said}. '
            "Correct the names, or state one unit with --unit."
        )
    return columns[0], columns[1], columns[2]


def _find_magnetometer(source: Source, found: Sequence[Column]) -> tuple[Column, ...]:
    groups = _groups(found, "magnetometer")
    complete = {name: axes for name, axes in groups.items() if all(axis in axes for axis in AXES)}
    double = [columns for axes in complete.values() for columns in axes.values() if len(columns) > 1]
    if double:
        names = " and ".join(column.name for column in double[0])
        raise InputError(f'"{source.path}": {names} are both the magnetometer\'s {double[0][0].axis}. {_ask(complete)}')
    if len(complete) > 1:
        raise InputError(f'"{source.path}" has {len(complete)} magnetometers. {_ask(complete)}')
    if complete:
        axes = next(iter(complete.values()))
        return tuple(axes[axis][0] for axis in AXES)
    for axes in groups.values():
        missing = [axis for axis in AXES if axis not in axes]
        have = ", ".join(column.name for columns in axes.values() for column in columns)
        raise InputError(
            f'"{source.path}": the magnetometer has no {" and no ".join(missing)} axis; '
            f"found {have} among: {listed(source.names)}. "
            "All three axes are needed; name them with --mag-columns bx,by,bz if they go by other names."
        )
    raise InputError(
        f'"{source.path}" has no magnetometer that is recognised among: {listed(source.names)}. '
        "Name its columns with --mag-columns bx,by,bz (and --unit nT), or in a mapping; "
        "recognised names are such as mag_x_nT, Bx [uT], B_VFM."
    )


def _ask(groups) -> str:
    """The question which of several instruments to take."""
    choices = "; ".join("--mag-columns " + ",".join(axes[axis][0].name for axis in AXES) for axes in groups.values())
    return f"Say which to use: {choices}."


def _choose_vector(source: Source, mapping: Mapping, found: Sequence[Column], quantity: str, choice: Choice) -> None:
    word = quantity.replace("_", " ")
    if quantity in mapping.columns:
        columns = _given(source, mapping, quantity)
        _need_units(source, quantity, columns)
        choice.vectors[quantity] = columns
        return
    complete = {name: axes for name, axes in _groups(found, quantity).items() if all(axis in axes for axis in AXES)}
    if len(complete) > 1:
        choice.ignored.append(
            f"{len(complete)} columns of vectors look like a {word} ({', '.join(complete)}); none is used until you name one"
        )
        return
    for axes in complete.values():
        columns = tuple(_with_unit(mapping, axes[axis][0]) for axis in AXES)
        if any(column.unit is None or column.unit.factor != column.unit.factor for column in columns):
            names = ", ".join(column.name for column in columns)
            choice.ignored.append(f"{names}: a {word} without a unit is not used; state it: [units] {quantity} = …")
        else:
            choice.vectors[quantity] = columns


def _need_units(source: Source, quantity: str, columns: Sequence[Column]) -> None:
    for column in columns:
        if column.unit is None:
            raise InputError(
                f'"{source.path}": the unit of "{column.name}" ({quantity.replace("_", " ")}) is not stated. '
                f"Add [units] {quantity} = … to a mapping."
            )


def _choose_single(source: Source, mapping: Mapping, found: Sequence[Column], quantity: str, choice: Choice) -> None:
    word = quantity.replace("_", " ")
    if quantity in mapping.columns:
        columns = _given(source, mapping, quantity)
        _need_units(source, quantity, columns)
        choice.singles[quantity] = columns[0]
        return
    columns = [_with_unit(mapping, column) for column in found if column.quantity == quantity]
    if quantity == "temperature" and len(columns) > 1:
        near = [column for column in columns if column.words & {"mag", "mgm", "mtm", "tam", "magnetometer"}]
        columns = near or columns
    if len(columns) > 1:
        choice.ignored.append(
            f"{len(columns)} columns look like a {word} ({', '.join(c.name for c in columns)}); none is used until you name one"
        )
    elif columns and columns[0].unit is None:
        choice.ignored.append(f"{columns[0].name}: a {word} without a unit is not used; state it: [units] {quantity} = …")
    elif columns:
        choice.singles[quantity] = columns[0]


def _choose_named(source: Source, mapping: Mapping, found: Sequence[Column], choice: Choice) -> None:
    """Sun sensors by face and wheels by name."""
    for quantity, chosen in (("sun_sensor", choice.sun_sensor), ("wheel_speed", choice.wheel_speed)):
        given = mapping.columns.get(quantity)
        if isinstance(given, dict):
            for key, name in given.items():
                unit = _NO_UNIT if quantity == "sun_sensor" else _unit(source, mapping, quantity, name)
                chosen[key] = Column(name, quantity, key, unit, "told")
            _need_units(source, quantity, list(chosen.values()))
            continue
        for column in found:
            if column.quantity != quantity:
                continue
            column = _with_unit(mapping, column)
            word = quantity.replace("_", " ")
            key = column.axis or _wheel_name(column.group)
            if key in chosen:
                choice.ignored.append(f"{column.name}: {chosen[key].name} is {word} {key} already; not used")
            elif column.unit is None or column.unit.factor != column.unit.factor:
                choice.ignored.append(f"{column.name}: a {word} without a unit is not used; state it: [units] {quantity} = …")
            else:
                chosen[key] = column


def _wheel_name(group: str) -> str:
    """What tells a wheel from the others in its column's name: its number, or what remains beside "wheel_speed"."""
    words = [word for word in group.split("_") if word not in _WHEEL_WORDS]
    return next((word for word in words if word.isdigit()), "_".join(words) or "1")


def _choose_position(source: Source, mapping: Mapping, choice: Choice) -> None:
    if "position" not in mapping.columns:
        length = parse_unit(mapping.units["position"], "position", "units.position") if "position" in mapping.units else None
        choice.position, notes = find_position(source.names, source.units, mapping.position_axes, length)
        choice.ignored.extend(notes)
        return
    if not mapping.position_axes:
        raise InputError(
            'the mapping names position columns but not their axes. Add [axes] position = "ITRS" (or GCRS, TEME, geodetic …).'
        )
    names = _named(source, mapping, "position")
    if len(names) != 3:
        raise InputError(f'"{source.path}": column "{names[0]}" is no vector; the position needs three columns.')
    spherical = mapping.position_axes in {"geodetic", "geocentric"}
    units = []
    for k, name in enumerate(names):
        if spherical and k < 2:
            units.append(find_unit(split_unit(name)[1] or source.units.get(name, ""), "angle") or Unit("deg", DEGREE))
            continue
        unit = _unit(source, mapping, "position", name)
        if unit is None:
            raise InputError(
                f'"{source.path}": the unit of "{name}" (position) is not stated. Add [units] position = "km" or "m".'
            )
        units.append(unit)
    choice.position = Position((names[0], names[1], names[2]), (units[0], units[1], units[2]), mapping.position_axes, "as told")
