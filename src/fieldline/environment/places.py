"""Positions and times as the user gives them, checked: shapes, units, sense."""

from __future__ import annotations

import numpy as np

from fieldline.errors import InputError

# The polar surface is 6,356.8 km from the centre and the field's models are published to 10 km below it.
LEAST_RADIUS_M = 6.346e6
MOST_RADIUS_M = 2.0e9  # five times as far as the Moon, past the tip of the Earth's shadow: rather a wrong unit


def as_positions(name: str, position, axes: str) -> np.ndarray:
    """(..., 3) floats [m], finite, outside the Earth; the message says what else they may be."""
    try:
        given = np.asarray(position)
        if given.dtype.kind not in "fiuO":  # complex numbers would lose a part, truth values become metres
            raise TypeError(f"not real numbers: {given.dtype}")
        rows = given.astype(float, copy=False)
    except (ValueError, TypeError) as error:
        raise InputError(f"{name} must be numbers (..., 3) [m], {axes} axes; got {position!r:.60}.") from error
    if rows.ndim == 0 or rows.shape[-1] != 3:
        hint = " Did you pass (3, N)? Use .T." if rows.ndim == 2 and rows.shape[0] == 3 else ""
        raise InputError(f"{name} must end in an axis of length 3, (..., 3) [m], {axes} axes; got {rows.shape}.{hint}")
    flat = rows.reshape(-1, 3)
    square = np.einsum("ij,ij->i", flat, flat)
    # One comparison finds all that is wrong, NaN included, and costs a healthy call next to nothing.
    fine = (square >= LEAST_RADIUS_M**2) & (square <= MOST_RADIUS_M**2)
    if not fine.all():
        raise InputError(_what_is_wrong(name, flat, fine))
    return rows


def one_time_each(places: tuple[int, ...], times: tuple[int, ...]) -> tuple[int, ...]:
    """The common shape of places and times: one of them single, or both alike; never each with every other."""
    if times == () or times == places:
        return places
    if places == ():
        return times
    raise InputError(
        f"time_utc has shape {times} and the positions {places}: give one time for all or one for each. "
        "For every position at every time, repeat them first (numpy.repeat, numpy.tile)."
    )


def _what_is_wrong(name: str, flat: np.ndarray, fine: np.ndarray) -> str:
    """A sentence about the first bad row, with a guess at its cause."""
    row = int(np.argmin(fine))
    where = f"{name} row {row} of {len(flat)}" if len(flat) > 1 else name
    if not np.isfinite(flat[row]).all():
        return f"{where} is not finite: {flat[row]} ({int((~np.isfinite(flat)).any(axis=1).sum())} such); drop them first."
    radius = float(np.linalg.norm(flat[row]))
    said = f"{where} is {radius:.4g} m from the Earth's centre"
    if radius > MOST_RADIUS_M:
        return f"{said}, five times as far as the Moon. Is it in millimetres? Multiply by 1e-3."
    if LEAST_RADIUS_M <= 1e3 * radius <= 4e8:
        return f"{said}, inside the Earth. Is it in kilometres? Multiply by 1e3."
    if abs(flat[row, 0]) <= 90.0 and abs(flat[row, 1]) <= 360.0:
        return (
            f"{said}, inside the Earth. Is it latitude, longitude and height? "
            "Convert with fieldline.frames.earth_rotation.itrs_from_geodetic."
        )
    return f"{said}, inside the Earth (least {LEAST_RADIUS_M:.4g} m). Geocentric metres are expected, not a height."
