"""Read telemetry: a table of samples becomes a `Telemetry` in SI units with an account of what was read and found."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fieldline.errors import InputError
from fieldline.files import sha256_of
from fieldline.frames.time import as_utc
from fieldline.telemetry.choice import Choice, choose
from fieldline.telemetry.clock import joined, to_utc
from fieldline.telemetry.columns import Column
from fieldline.telemetry.field_size import check_size
from fieldline.telemetry.mapping import read_mapping
from fieldline.telemetry.position import position_in_itrs
from fieldline.telemetry.quality import FILL_BEYOND, find_faults
from fieldline.telemetry.record import Quality, Recognised, Telemetry
from fieldline.telemetry.table import AXES, Table, open_table

GAP_STEPS = 1.5
COARSE_CLOCK = 0.3  # a share of repeated stamps that no fault explains


def read_telemetry(
    path, *, mapping=None, columns=None, units=None, mag_columns=None, time_column=None, unit=None, repair: bool = False
) -> Telemetry:
    """Read a table of attitude sensors: CSV and its relatives, Parquet, NetCDF or CDF, told by its content.

    Parameters
    ----------
    path : the file.
    mapping : a TOML file, or a dictionary of the same shape, with tables columns, units and axes (docs/telemetry.md).
    columns, units : dictionaries by quantity that win over the mapping, as columns={"magnetometer": ("bx", "by", "bz")}.
    mag_columns, time_column, unit : the same for the magnetometer's three columns, the time and the magnetometer's unit.
    repair : sort unordered time stamps, and drop repeated ones and rows that cannot be read, counting each; without it
        they are refused with their row.

    Errors: `InputError` for anything that cannot be read, is ambiguous, or cannot be a field in low orbit.
    """
    path = Path(path)
    source = open_table(path)
    said = read_mapping(mapping, columns, units, mag_columns, time_column, unit)
    choice = choose(source, said)
    table = source.read(choice.numbers(), choice.time.names, repair)
    time_utc, time_notes = to_utc(path, choice.time, joined(choice.time, table.columns), table.place, repair)
    table, time_utc, counts = _in_order(path, table, time_utc, choice, repair)
    raw = np.stack([table.columns[column.name] for column in choice.magnetometer], axis=-1)
    _check_field(path, choice, raw)
    factor = choice.magnetometer[0].unit.factor if choice.magnetometer[0].unit else float("nan")
    seconds = (time_utc - time_utc[0]).astype(np.int64) * 1e-9
    notes = check_size(path, choice.magnetometer, raw, factor, choice.mag_stated)
    faults = find_faults(seconds, raw, factor)
    if faults.any().all():
        raise InputError(f'"{path}": no sample of the magnetometer is usable: {_count_faults(faults)}.')
    quality = _account(seconds, faults, counts, notes)
    return _assemble(path, choice, table, time_utc, raw * factor, ~faults.any(), quality, [*source.notes, *time_notes])


def telemetry_of(
    time_utc,
    field_s,
    *,
    rate_b=None,
    sun_sensor=None,
    dipole_command_b=None,
    wheel_speed=None,
    temperature_k=None,
    position_e=None,
    solar_current=None,
    yaw_rad=None,
    name: str = "telemetry",
) -> Telemetry:
    """Telemetry of arrays in SI units, as a simulation makes them, with the faults looked for as in a file.

    time_utc (n,), strictly increasing; field_s (n, 3) [T]; the others as in `Telemetry`.
    """
    time_utc, field_s = as_utc(time_utc), np.asarray(field_s, dtype=float)
    if field_s.shape != (len(time_utc), 3) or len(time_utc) < 2:
        raise InputError(f"field_s must be (n, 3) [T] for n >= 2 times; got {field_s.shape} for {len(time_utc)} times.")
    seconds = (time_utc - time_utc[0]).astype(np.int64) * 1e-9
    if (np.diff(seconds) <= 0.0).any():
        raise InputError(f"time_utc must increase; sample {int(np.argmax(np.diff(seconds) <= 0.0)) + 1} does not.")
    faults = find_faults(seconds, field_s, 1.0)
    return Telemetry(
        time_utc=time_utc,
        field_s=field_s,
        usable=~faults.any(),
        rate_b=rate_b,
        sun_sensor=sun_sensor or {},
        dipole_command_b=dipole_command_b,
        wheel_speed=wheel_speed or {},
        temperature_k=temperature_k,
        position_e=position_e,
        solar_current=solar_current,
        yaw_rad=yaw_rad,
        quality=_account(seconds, faults, {}, ()),
        name=name,
    )


def _in_order(path, table: Table, time_utc: np.ndarray, choice: Choice, repair: bool):
    """The table with increasing times, and the counts of what repair did; without repair the first bad row is named."""
    missing = np.isnat(time_utc)
    if missing.any() and not repair:
        raise InputError(
            f'"{path}", {table.place(int(np.argmax(missing)))}: the time column "{choice.time.name}" is empty. '
            "Fill it, or drop such rows with --repair (repair=True)."
        )
    ns = time_utc.astype(np.int64)
    step = np.diff(ns)
    wrong = np.flatnonzero(step <= 0) if not missing.any() else np.zeros(0, int)
    if len(wrong) and not repair:
        row = int(wrong[0]) + 1
        coarse = "The clock column is coarser than the sampling: use a finer one. " if np.mean(step == 0) > COARSE_CLOCK else ""
        what = "repeats" if step[wrong[0]] == 0 else "is before"
        raise InputError(
            f'"{path}", {table.place(row)}: the time {_iso(time_utc[row])} {what} that of the row before it '
            f"({_iso(time_utc[row - 1])}); {len(wrong):,} of {len(ns):,} rows are so. "
            f"{coarse}Use --repair (repair=True) to sort them and drop repeated ones."
        )
    kept = np.flatnonzero(~missing)
    unordered = int((np.diff(ns[kept]) < 0).sum())
    kept = kept[np.argsort(ns[kept], kind="stable")]
    repeated = np.concatenate(([False], np.diff(ns[kept]) == 0)) if len(kept) else np.zeros(0, bool)
    kept = kept[~repeated]
    if len(kept) < 2:
        raise InputError(
            f'"{path}" has {len(kept)} sample{"" if len(kept) == 1 else "s"}; at least two are needed, of different times.'
        )
    counts = {"unreadable": table.dropped + int(missing.sum()), "unordered": unordered, "repeated": int(repeated.sum())}
    ordered = Table(columns={name: values[kept] for name, values in table.columns.items()}, place=table.place)
    return ordered, time_utc[kept], counts


def _iso(time) -> str:
    return np.datetime_as_string(time, unit="ms") + "Z"


def _check_field(path, choice: Choice, raw: np.ndarray) -> None:
    """Refuse a magnetometer without numbers, or one that never moves."""
    names = ", ".join(column.name for column in choice.magnetometer)
    good = raw[(np.abs(raw) < FILL_BEYOND).all(axis=1)]
    if not len(good):
        raise InputError(f'"{path}": the magnetometer columns {names} hold no sample with three finite numbers.')
    span = np.ptp(good, axis=0)
    if not span.any():
        raise InputError(
            f'"{path}": the magnetometer columns {names} never change ({", ".join(f"{v:.6g}" for v in good[0])}). '
            "A constant field is a dead or unread sensor; in orbit the field turns all the time."
        )
    dead = [column.name for column, width in zip(choice.magnetometer, span, strict=True) if width == 0.0]
    if dead and len(good) >= 100:
        raise InputError(
            f'"{path}": the magnetometer column {" and ".join(dead)} never changes while the others do: a dead axis.'
        )


def _count_faults(faults) -> str:
    return ", ".join(f"{int(part.sum()):,} {name}" for name, part in faults._asdict().items() if part.any())


def _account(seconds: np.ndarray, faults, counts: dict[str, int], notes) -> Quality:
    """Gaps of the time stamps and the faults, counted."""
    step = np.diff(seconds)
    usual = float(np.median(step))
    gap = step[step > GAP_STEPS * usual]
    return Quality(
        samples=len(seconds),
        usable=int((~faults.any()).sum()),
        step_s=usual,
        gaps=len(gap),
        missing_s=float((gap - usual).sum()),
        longest_gap_s=float(gap.max()) if len(gap) else 0.0,
        **counts,
        **{name: int(part.sum()) for name, part in faults._asdict().items()},
        notes=tuple(notes),
    )


def _si(table: Table, column: Column) -> np.ndarray:
    """A column in SI units."""
    unit = column.unit
    assert unit is not None  # `choose` leaves out columns without one
    return table.columns[column.name] * unit.factor + unit.offset


def _assemble(path, choice: Choice, table: Table, time_utc, field_s, usable, quality: Quality, notes) -> Telemetry:
    vectors = {q: np.stack([_si(table, column) for column in columns], axis=-1) for q, columns in choice.vectors.items()}
    singles = {quantity: _si(table, column) for quantity, column in choice.singles.items()}
    position = None
    if choice.position:
        raw = [table.columns[name] * unit.factor for name, unit in zip(choice.position.names, choice.position.units, strict=True)]
        position = position_in_itrs(path, choice.position, np.stack(raw, axis=-1), time_utc)
    return Telemetry(
        time_utc=time_utc,
        field_s=field_s,
        usable=usable,
        rate_b=vectors.get("gyro"),
        sun_sensor={face: _si(table, column) for face, column in choice.sun_sensor.items()},
        dipole_command_b=vectors.get("dipole_command"),
        wheel_speed={name: _si(table, column) for name, column in choice.wheel_speed.items()},
        temperature_k=singles.get("temperature"),
        position_e=position,
        solar_current=singles.get("solar_current"),
        yaw_rad=singles.get("yaw"),
        recognition=_recognition(choice),
        ignored=(*notes, *choice.ignored),
        quality=quality,
        name=path.name,
        sha256=sha256_of(path),
    )


def _recognition(choice: Choice) -> tuple[Recognised, ...]:
    """What every column was taken for."""
    records = [Recognised(column=choice.time.name, quantity="time", unit=choice.time.kind, why=choice.time.why)]
    for column in choice.columns():
        unit = column.unit
        assert unit is not None  # as above
        why = "as told" if column.quantity in choice.told else "by its name"
        records.append(
            Recognised(
                column=column.name,
                quantity=column.quantity,
                axis=column.axis,
                unit=unit.name,
                factor=unit.factor,
                offset=unit.offset,
                why=why,
            )
        )
    if choice.position:
        labels = AXES if choice.position.axes not in {"geodetic", "geocentric"} else ("latitude", "longitude", "altitude")
        for name, unit, label in zip(choice.position.names, choice.position.units, labels, strict=True):
            records.append(
                Recognised(
                    column=name,
                    quantity="position",
                    axis=f"{choice.position.axes} {label}",
                    unit=unit.name,
                    factor=unit.factor,
                    why=choice.position.why,
                )
            )
    return tuple(records)
