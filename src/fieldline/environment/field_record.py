"""What a magnetic field model is: when it holds, where it comes from, and its numbers as kernels take them.

A model is a sum of spherical harmonics, piecewise linear in time, and of dipoles fixed in the Earth; most have one of
the two. `FieldModel.at(time_utc)` freezes it at a time for compiled loops.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from fieldline.environment.coefficients import GaussCoefficients
from fieldline.environment.harmonics import Basis, basis_for, field_table, gradient_table
from fieldline.errors import InputError
from fieldline.frames.time import as_utc, decimal_year, iso_utc

MOST_YEARS_CARRIED = 20.0  # past a model's end, on request
NO_DIPOLES = np.zeros((0, 3))


class FieldParams(NamedTuple):
    """A model frozen at one time, for `field_kernel`."""

    basis: Basis
    table: np.ndarray
    dipole_position_e: np.ndarray
    dipole_moment_e: np.ndarray


class FieldTables(NamedTuple):
    """A model over its years, for the loops over many points: tables (E, K L) at epochs (E,) [decimal year]."""

    basis: Basis
    epochs: np.ndarray
    tables: np.ndarray
    dipole_position_e: np.ndarray
    dipole_moment_e: np.ndarray


@dataclass(frozen=True, eq=False, kw_only=True)
class FieldModel:
    """A model of the Earth's field: what it is called, when it holds, where it comes from, and its numbers.

    years : first and last decimal year, both included      predictive_from : year after which it is a forecast, or None
    degree, order : highest of its harmonics, 0 for dipoles alone      source : citation
    coefficients : Gauss coefficients or None      dipole_position_e, dipole_moment_e : (D, 3) [m], [A m^2], ITRS axes
    """

    name: str
    version: str
    years: tuple[float, float]
    predictive_from: float | None
    source: str
    degree: int = 0
    order: int = 0
    coefficients: GaussCoefficients | None = None
    dipole_position_e: np.ndarray = field(default_factory=lambda: NO_DIPOLES)
    dipole_moment_e: np.ndarray = field(default_factory=lambda: NO_DIPOLES)

    def __post_init__(self):
        self.dipole_position_e.flags.writeable = self.dipole_moment_e.flags.writeable = False

    def truncated(self, degree: int | None = None, order: int | None = None) -> FieldModel:
        """The model up to a degree and an order; None leaves it as it is."""
        if degree is None and order is None:
            return self
        if self.coefficients is None:
            raise InputError(f'{self.name} is a sum of dipoles and has no degree; leave "degree" and "order" out.')
        degree = _whole("degree", self.degree if degree is None else degree, 1, self.degree, self.name)
        order = _whole("order", min(self.order, degree) if order is None else order, 0, degree, f"degree {degree}")
        kept = self.coefficients.truncated(degree, order)
        return replace(self, degree=degree, order=order, coefficients=kept)

    def years_of(self, time_utc) -> np.ndarray:
        """Decimal years of UTC times, all inside the model's."""
        years = decimal_year(time_utc)
        first, last = self.years
        if years.size and (years.min() < first or years.max() > last):
            raise InputError(self._outside(years, as_utc(time_utc)))
        return years

    def stamp(self, time_utc) -> dict:
        """What was used, for the provenance of a result that spans `time_utc`."""
        years = np.atleast_1d(self.years_of(time_utc))
        first, last = (float(years.min()), float(years.max())) if years.size else (None, None)
        predictive = last is not None and self.predictive_from is not None and last > self.predictive_from
        return {
            "model": self.name,
            "version": self.version,
            "degree": self.degree,
            "order": self.order,
            "first_year": first,
            "last_year": last,
            "predictive": predictive,
            "source": self.source,
        }

    def at(self, time_utc) -> FieldParams:
        """The model at one time, for compiled loops over a span in which the secular variation does not matter.

        In low orbit the field changes by up to 0.4 nT a day, 150 nT a year.
        """
        if np.ndim(time_utc) != 0:
            raise InputError(f"FieldModel.at takes one time; got {np.shape(time_utc)}. Use magnetic_field for a series.")
        year = float(self.years_of(time_utc))
        basis, epochs, tables, position, moment = self.field_tables
        k = min(int(np.searchsorted(epochs, year, side="right")), len(epochs) - 1)
        step = (year - epochs[k - 1]) / (epochs[k] - epochs[k - 1])
        return FieldParams(basis, tables[k - 1] + step * (tables[k] - tables[k - 1]), position, moment)

    @cached_property
    def field_tables(self) -> FieldTables:
        """Tables of the field [T]."""
        if self.coefficients is None:
            return self._dipoles_alone()
        c = self.coefficients
        basis = basis_for(self.degree + 1, self.order + 1, c.radius_m)
        tables = field_table(c.g, c.h, self.order)
        return FieldTables(basis, c.epochs, tables, self.dipole_position_e, self.dipole_moment_e)

    @cached_property
    def gradient_tables(self) -> FieldTables:
        """Tables of the gradient [T/m]."""
        if self.coefficients is None:
            return self._dipoles_alone()
        c = self.coefficients
        basis = basis_for(self.degree + 2, self.order + 2, c.radius_m)
        tables = gradient_table(c.g, c.h, self.order, c.radius_m)
        return FieldTables(basis, c.epochs, tables, self.dipole_position_e, self.dipole_moment_e)

    def _dipoles_alone(self) -> FieldTables:
        """No harmonics, hence empty tables, the same at all times."""
        nothing = basis_for(-1, -1, 1.0)
        epochs, tables = np.array(self.years), np.zeros((2, 0))
        # Read-only like those of the harmonics: Numba compiles once for both.
        epochs.flags.writeable = tables.flags.writeable = False
        return FieldTables(nothing, epochs, tables, self.dipole_position_e, self.dipole_moment_e)

    def _outside(self, years: np.ndarray, times: np.ndarray) -> str:
        """Why these times cannot be served, and what can."""
        first, last = self.years
        worst = int(np.argmin(years) if years.min() < first else np.argmax(years))
        year = float(years.flat[worst])
        asked = f"time_utc holds {iso_utc(times.flat[worst], 0)}, but {self.name} covers {first:g} to {last:g}. "
        if 1900.0 <= year <= 2030.0:
            return asked + 'Use "IGRF-14" (1900 to 2030).'
        if last < year <= last + MOST_YEARS_CARRIED and self.coefficients is not None:
            carried = f'Carry its secular variation on with field_model("{self.name}", until_year={np.ceil(year):g}), '
            return asked + carried + "and expect some 20 nT more error a year."
        return asked + 'No model here reaches that year but "centred-dipole" and "displaced-dipoles", with moments given.'


def _whole(name: str, value, least: int, most: int, of: str) -> int:
    """`value` if it is a whole number in its range."""
    whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not whole or not least <= value <= most:
        raise InputError(f"{name} must be a whole number from {least} to {most} for {of}; got {value!r}.")
    return int(value)
