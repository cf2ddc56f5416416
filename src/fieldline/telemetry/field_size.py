"""Can the magnetometer's numbers be a field in low orbit? If not, which unit would make them one?

In low orbit |B| is 1.5e-5 to 7e-5 T. The raw reading carries a bias that may be several times the field, so its size may
reach ten times that; but the bias stands still, so what varies is at most the field turning over: twice 7e-5 T and the
errors of scale.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fieldline.errors import InputError
from fieldline.telemetry.columns import Column
from fieldline.telemetry.quality import FILL_BEYOND

SIZE_TESLA = (1.0e-5, 7.0e-4)  # the 95 % quantile of the raw size
SPREAD_MAX_TESLA = 1.8e-4  # the 95 % quantile of the distance from the median
AXES_RATIO, AXES_SAMPLES = 300.0, 100  # noise alone is more than a 300th of the field
ROWS_RATIO, ROWS_SHARE, ROWS_DISTINCT = 50.0, 0.05, 10  # a step in the sorted sizes that no field in orbit and no bias makes
_TYPICAL_SPREAD = 3.5e-5
_UNITS = (("nT", 1e-9), ("uT", 1e-6), ("mG", 1e-7), ("G", 1e-4), ("mT", 1e-3), ("T", 1.0))


def sizes(field_s: np.ndarray) -> tuple[float, float]:
    """95 % quantiles of the size and of the distance from the median of samples (n, 3) that are no fill values."""
    good = field_s[(np.abs(field_s) < FILL_BEYOND).all(axis=1)]
    size = np.linalg.norm(good, axis=1)
    spread = np.linalg.norm(good - np.median(good, axis=0), axis=1)
    return float(np.quantile(size, 0.95)), float(np.quantile(spread, 0.95))


def is_plausible(size: float, spread: float) -> bool:
    """Whether a raw size and spread [T] can come from a field in low orbit."""
    return SIZE_TESLA[0] <= size <= SIZE_TESLA[1] and spread <= SPREAD_MAX_TESLA


def likely_units(numbers: np.ndarray) -> list[str]:
    """Units that make the numbers (n, 3) a field in low orbit, the likeliest first."""
    size, spread = sizes(numbers)
    fits = [(name, factor) for name, factor in _UNITS if is_plausible(size * factor, spread * factor)]
    return [name for name, _ in sorted(fits, key=lambda fit: abs(math.log(max(spread, 0.3 * size) * fit[1] / _TYPICAL_SPREAD)))]


def _question(path, columns: Sequence[Column], numbers: np.ndarray) -> InputError:
    """The question which unit the magnetometer's columns are in."""
    names = ", ".join(column.name for column in columns)
    size, _ = sizes(numbers)
    likely = likely_units(numbers)
    if likely:
        guess = f"Their size, {size:.4g}, would fit {' or '.join(likely)}; if it is {likely[0]}, say --unit {likely[0]}."
    else:
        guess = f"Their size, {size:.4g}, fits no usual unit; if they are counts, give the scale, as --unit '15.36 nT'."
    return InputError(f'"{path}": the magnetometer columns {names} do not say their unit. {guess}')


def check_size(path, columns: Sequence[Column], numbers: np.ndarray, factor: float, stated: bool) -> list[str]:
    """Ask about numbers that cannot be a field in low orbit in their unit; a unit that the user states is kept, and said."""
    unit = columns[0].unit
    if unit is None or math.isnan(factor):
        raise _question(path, columns, numbers)
    if not stated:
        _check_axes(path, columns, numbers)
        _check_rows(path, columns, numbers)
    size, spread = (value * factor for value in sizes(numbers))
    if is_plausible(size, spread):
        return []
    what = f"as {unit.name} their size is {size:.3g} T and they vary by {spread:.3g} T"
    if stated:
        return [f"the magnetometer's numbers do not look like a field in low orbit: {what}; the unit was kept as you stated it"]
    likely = [name for name in likely_units(numbers) if name != unit.name]
    advice = f"They look like {' or '.join(likely)}: say --unit {likely[0]}" if likely else "State their unit with --unit"
    raise InputError(
        f'"{path}": the magnetometer columns {", ".join(c.name for c in columns)} cannot be a field in low orbit: {what}; '
        f"expected {SIZE_TESLA[0]:.0e} to {SIZE_TESLA[1]:.0e} T, varying by at most {SPREAD_MAX_TESLA:.1e} T. {advice} "
        f"(or --unit {unit.name} if that is what they are)."
    )


def _check_axes(path, columns: Sequence[Column], numbers: np.ndarray) -> None:
    """Ask about an axis that reads hundreds of times less than another: a unit of its own that its name does not tell."""
    good = numbers[(np.abs(numbers) < FILL_BEYOND).all(axis=1)]
    if len(good) < AXES_SAMPLES:
        return
    reach = np.quantile(np.abs(good), 0.95, axis=0)
    small, large = int(np.argmin(reach)), int(np.argmax(reach))
    if reach[small] * AXES_RATIO < reach[large]:
        raise InputError(
            f'"{path}": {columns[small].name} reads {reach[large] / max(reach[small], 1e-300):.3g} times less than '
            f"{columns[large].name}. Is it in another unit, or unread? Correct it, or state the unit of all three with --unit."
        )


def _check_rows(path, columns: Sequence[Column], numbers: np.ndarray) -> None:
    """Ask about rows that read tens of times less than the others: two units in one file. Repeated fill values are none."""
    rows = np.flatnonzero((np.abs(numbers) < FILL_BEYOND).all(axis=1) & numbers.any(axis=1))
    if len(rows) < AXES_SAMPLES:
        return
    size = np.linalg.norm(numbers[rows], axis=1)
    middle = np.sort(size)[int(ROWS_SHARE * len(size)) : len(size) - int(ROWS_SHARE * len(size))]
    step = middle[1:] / middle[:-1]
    at = int(np.argmax(step))
    if step[at] < ROWS_RATIO:
        return
    small = size < np.sqrt(middle[at] * middle[at + 1])
    if min(len(np.unique(numbers[rows[part]], axis=0)) for part in (small, ~small)) < ROWS_DISTINCT:
        return
    change = rows[np.flatnonzero(small != small[0])[0]] + 1
    times = np.median(size[~small]) / np.median(size[small])
    raise InputError(
        f'"{path}": {", ".join(column.name for column in columns)} read about {times:.2g} times less in {int(small.sum()):,} of '
        f"{len(rows):,} rows than in the others; the first change is at row {change:,}. Two units in one file? Bring "
        "all rows to one, or split the file there."
    )
