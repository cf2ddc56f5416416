"""The Earth's magnetic field at places and times: value, gradient and secular rate.

    B(r, t) = B_k(r) + (t - t_k) / (t_k+1 - t_k) (B_k+1(r) - B_k(r))                                       (1)

The coefficients are interpolated between the model's epochs, which is (1) exactly since B is linear in them: once for a
call at one time, once per sample for a series (a third of the cost of a synthesis at degree 13, where the second
synthesis that (1) read literally would take costs another whole).

Only the field of the Earth's core and large-scale crust: outer currents add 10 to 50 nT in quiet and several hundred in
storms, the crust's small scales some 10 nT in low orbit.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from fieldline.environment.dipoles import dipoles_gradient_kernel, dipoles_kernel
from fieldline.environment.field_record import FieldModel
from fieldline.environment.field_registry import field_model
from fieldline.environment.harmonics import gradient_kernel, synthesis_kernel
from fieldline.environment.places import as_positions, one_time_each
from fieldline.frames.time import as_utc
from fieldline.frames.vectors import add, put, vec


@njit(cache=True)
def field_kernel(r_e, params):
    """B [T], ITRS axes, at r_e [m] (tuple) of a model frozen in time (`FieldModel.at`)."""
    harmonic = synthesis_kernel(r_e, params.basis, params.table)
    return add(harmonic, dipoles_kernel(r_e, params.dipole_position_e, params.dipole_moment_e))


@njit(cache=True)
def table_at(year, rate, epochs, tables, table):
    """Fill `table` with the coefficients at a decimal year (1), or with their rate per year."""
    k = 0
    while k < epochs.shape[0] - 2 and year >= epochs[k + 1]:
        k += 1
    span = 1.0 / (epochs[k + 1] - epochs[k])
    if rate:
        for j in range(table.shape[0]):
            table[j] = span * (tables[k + 1, j] - tables[k, j])
    else:
        part = span * (year - epochs[k])
        for j in range(table.shape[0]):
            table[j] = tables[k, j] + part * (tables[k + 1, j] - tables[k, j])


@njit(cache=True)
def _fields(position_e, years, rate, basis, epochs, tables, dipole_position_e, dipole_moment_e, table, out):
    """B or its rate per year at every row; `years` has one entry, or one a row."""
    for k in range(position_e.shape[0]):
        if k == 0 or (years.shape[0] > 1 and years[k] != years[k - 1]):
            table_at(years[k], rate, epochs, tables, table)
        r_e = vec(position_e, k)
        field = synthesis_kernel(r_e, basis, table)
        if not rate:
            field = add(field, dipoles_kernel(r_e, dipole_position_e, dipole_moment_e))
        put(out, k, field)


@njit(cache=True)
def _gradients(position_e, years, basis, epochs, tables, dipole_position_e, dipole_moment_e, table, out):
    """dB_i/dx_j at every row, as nine columns."""
    for k in range(position_e.shape[0]):
        if k == 0 or (years.shape[0] > 1 and years[k] != years[k - 1]):
            table_at(years[k], False, epochs, tables, table)
        r_e = vec(position_e, k)
        harmonic = gradient_kernel(r_e, basis, table)
        dipoles = dipoles_gradient_kernel(r_e, dipole_position_e, dipole_moment_e)
        for j in range(9):
            out[k, j] = harmonic[j] + dipoles[j]


def magnetic_field(
    position_e_m, time_utc, model: str | FieldModel = "IGRF-14", *, degree: int | None = None, order: int | None = None
) -> np.ndarray:
    """The Earth's main field at places and times, equation (1).

    Parameters
    ----------
    position_e_m : (..., 3) [m], ITRS axes.
    time_utc : datetime64, one for all places or one for each (shape (...)); one place with many times is fine too.
    model : name in `MAGNETIC_FIELDS` or a FieldModel (`field_model` makes those that take options).
    degree, order : highest degree and order of the harmonics, the model's own by default.

    Returns
    -------
    (..., 3) [T], ITRS axes.

    Raises
    ------
    InputError : places inside the Earth or not in metres, shapes that do not match, a time outside the model's years,
        an unknown model, a degree or order that it does not have.

    Source: `field_model(model).source`; synthesis as in `fieldline.environment.harmonics`.
    Valid outside the Earth and well inside the magnetopause; see the head of this file for what is left out.
    """
    model = field_model(model, degree=degree, order=order)
    position, years, shape = _prepared(position_e_m, time_utc, model)
    out = np.empty((len(position), 3))
    tables = model.field_tables
    _fields(position, years, False, *tables, np.empty(tables.tables.shape[1]), out)
    return out.reshape(shape)


def field_rate(
    position_e_m, time_utc, model: str | FieldModel = "IGRF-14", *, degree: int | None = None, order: int | None = None
) -> np.ndarray:
    """Secular rate of the field at a place fixed in the Earth, (..., 3) [T/s], ITRS axes; arguments as `magnetic_field`.

    Piecewise constant in decimal years, so the rate per second is a leap year's a 366th smaller; at an epoch it is
    the rate of the years that follow.
    """
    model = field_model(model, degree=degree, order=order)
    position, years, shape = _prepared(position_e_m, time_utc, model)
    out = np.empty((len(position), 3))
    tables = model.field_tables
    _fields(position, years, True, *tables, np.empty(tables.tables.shape[1]), out)
    return out.reshape(shape) / _year_length_s(time_utc)[..., None]


def field_gradient(
    position_e_m, time_utc, model: str | FieldModel = "IGRF-14", *, degree: int | None = None, order: int | None = None
) -> np.ndarray:
    """Gradient tensor (..., 3, 3) [T/m], ITRS axes: [i, j] = dB_i / dx_j; arguments as `magnetic_field`.

    Symmetric and without trace by construction, since B has neither curl nor divergence outside its sources.
    """
    model = field_model(model, degree=degree, order=order)
    position, years, shape = _prepared(position_e_m, time_utc, model)
    out = np.empty((len(position), 9))
    tables = model.gradient_tables
    _gradients(position, years, *tables, np.empty(tables.tables.shape[1]), out)
    return out.reshape((*shape, 3))


def _prepared(position_e_m, time_utc, model: FieldModel):
    """Checked places as rows, decimal years (1,) or (n,), and the shape of the vectors to return."""
    position = as_positions("position_e_m", position_e_m, "ITRS")
    times = as_utc(time_utc)
    shape = one_time_each(position.shape[:-1], times.shape)
    years = np.atleast_1d(model.years_of(times)).ravel()
    if position.shape[:-1] != shape:
        position = np.broadcast_to(position, (*shape, 3))
    return np.ascontiguousarray(position.reshape(-1, 3)), years, (*shape, 3)


def _year_length_s(time_utc) -> np.ndarray:
    """[s] of the calendar year of each time."""
    year = as_utc(time_utc).astype("datetime64[Y]")
    length = (year + 1).astype("datetime64[s]") - year.astype("datetime64[s]")
    return length.astype(float)
