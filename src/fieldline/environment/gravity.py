"""The Earth's gravity: a point, its oblateness, or spherical harmonics.

    a = -GM r / |r|^3                                                                                       (1)
      - 3/2 J2 GM R^2 / |r|^5 ((1 - 5 z^2/r^2) x, (1 - 5 z^2/r^2) y, (3 - 5 z^2/r^2) z)                      (2)
      + grad GM/r sum_n>=2 (R/r)^n sum_m P_nm (C_nm cos m lambda + S_nm sin m lambda)                         (3)

"point" is (1); "j2" is (1) and (2); "harmonic" is (1) and (3), summed by `environment.harmonics`, whose potential is

    -U = a sum (a/r)^(n+1) S_nm (g cos + h sin):   g = -GM/a^2 sqrt(2n+1) C,  h = -GM/a^2 sqrt(2n+1) S          (4)

since the full normalisation of P_nm is sqrt(2n+1) times Schmidt's. Axes e (ITRS); z is the pole.

The coefficients are those of EGM2008 to degree 70. They are published free of the permanent tide; no solid tide is
modelled here, so the deformation that the Moon and the Sun cause in the mean is put back (zero-tide):
C20 = C20(tide-free) - 4.1736e-9. Left out: the Moon's and the Sun's own pull (1e-6 m/s^2 in low orbit), tides that vary
(2e-7), relativity (1e-8), the drift of the low degrees (1e-11 a year of C20).

"harmonic" has its own GM, 3.986004415e14 (for terrestrial time), "point" and "j2" that of the constants, 3.986004418e14:
between them lies a metre along a low orbit's track in a day.

Sources: Pavlis, Holmes, Kenyon and Factor (2012), J. Geophys. Res. 117, B04406; IERS Conventions (2010), s. 6.1 and
6.2.2; Montenbruck and Gill, Satellite Orbits (2000), s. 3.2. Valid outside the sphere of radius R.
"""

from __future__ import annotations

from functools import cache
from importlib import resources
from math import sqrt
from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2, EARTH_J2
from fieldline.environment.harmonics import Basis, basis_for, field_table, potential_kernel, potential_table, synthesis_kernel
from fieldline.environment.places import as_positions
from fieldline.errors import InputError, nearest
from fieldline.frames.vectors import add, dot, put, scale, vec

MODELS = ("point", "j2", "harmonic")
MOST_DEGREE = 70
USUAL_DEGREE = 20  # what lies above is 2e-5 m/s^2 at 400 km
PERMANENT_TIDE_C20 = -4.1736e-9  # zero-tide minus tide-free, k2 = 0.3 as EGM2008 has it


class Gravity(NamedTuple):
    """A model of gravity as kernels take it; a part that is not there has j2 = 0 or empty tables."""

    gm: float  # [m^3/s^2]
    j2: float  # of equation (2)
    radius_m: float
    basis: Basis
    table: np.ndarray  # (6 L,) sums of the acceleration (3) [m/s^2]
    potential_table: np.ndarray  # (2 L,) of its potential


@njit(cache=True)
def gravity_kernel(r_e, gravity):
    """Acceleration [m/s^2] at r_e [m] (tuples, ITRS axes, outside the origin): equations (1) to (3)."""
    square = dot(r_e, r_e)
    inverse = gravity.gm / (square * sqrt(square))
    if gravity.j2 == 0.0:
        a_e = scale(-inverse, r_e)
    else:
        flat = 1.5 * gravity.j2 * gravity.radius_m * gravity.radius_m / square  # (2)
        polar = 5.0 * r_e[2] * r_e[2] / square
        across = -inverse * (1.0 + flat * (1.0 - polar))
        a_e = (across * r_e[0], across * r_e[1], -inverse * (1.0 + flat * (3.0 - polar)) * r_e[2])
    if gravity.table.shape[0] > 0:
        a_e = add(a_e, synthesis_kernel(r_e, gravity.basis, gravity.table))
    return a_e


@njit(cache=True)
def gravity_potential_kernel(r_e, gravity):
    """Potential energy per mass U [J/kg], negative: a = -grad U, and v^2/2 + U is conserved where the Earth stands still."""
    square = dot(r_e, r_e)
    distance = sqrt(square)
    polar = r_e[2] * r_e[2] / square
    flat = 0.5 * gravity.j2 * gravity.radius_m * gravity.radius_m / square * (1.0 - 3.0 * polar)
    value = -gravity.gm / distance * (1.0 + flat)
    if gravity.potential_table.shape[0] > 0:
        value += gravity.basis.radius_m * potential_kernel(r_e, gravity.basis, gravity.potential_table)
    return value


@njit(cache=True)
def _accelerations(position_e, gravity, out):
    """`gravity_kernel` at every row."""
    for k in range(position_e.shape[0]):
        put(out, k, gravity_kernel(vec(position_e, k), gravity))


def gravity_acceleration(position_e_m, gravity: Gravity | str = "harmonic") -> np.ndarray:
    """Acceleration (..., 3) [m/s^2], ITRS axes, by which the Earth draws bodies at (..., 3) [m], ITRS axes.

    gravity : a model of `gravity_model` or its name. InputError for places inside the Earth or not in metres.
    Without the centrifugal and Coriolis parts: what an inertial observer sees, in the axes of the moment.
    """
    model = gravity_model(gravity) if isinstance(gravity, str) else gravity
    position = as_positions("position_e_m", position_e_m, "ITRS")
    rows = np.ascontiguousarray(position.reshape(-1, 3))
    out = np.empty_like(rows)
    _accelerations(rows, model, out)
    return out.reshape(position.shape)


def gravity_model(name: str, degree: int | None = None) -> Gravity:
    """A model of the Earth's gravity for `gravity_kernel`.

    Parameters
    ----------
    name : "point", "j2" or "harmonic".
    degree : of "harmonic" alone, 2 to 70; 20 if not given. Left out above degree n at 400 km, RMS of the acceleration:
        6e-5 m/s^2 for 8, 2e-5 for 20, 7e-6 for 36 (J2 alone: 2e-4). A call costs about as much as a magnetic field
        of that degree: 0.4 microseconds for 8, 0.9 for 20, 3 for 36.

    Raises
    ------
    InputError : an unknown name, a degree outside its range or where there is none.
    """
    if name not in MODELS:
        raise InputError(f'unknown gravity "{name}"; {nearest(str(name), MODELS)}')
    if name == "harmonic":
        return _egm2008(_whole_degree(USUAL_DEGREE if degree is None else degree))
    if degree is not None:
        raise InputError(f'gravity "{name}" has no degree; leave it out, or take "harmonic" with degree = {degree!r}.')
    nothing = np.zeros(0)
    # Read-only like the tables of the harmonics: Numba compiles once for both.
    nothing.flags.writeable = False
    j2 = EARTH_J2 if name == "j2" else 0.0
    return Gravity(EARTH_GM_M3_S2, j2, EARTH_EQUATORIAL_RADIUS_M, basis_for(-1, -1, 1.0), nothing, nothing)


def harmonic_gravity(c, s, gm_m3_s2: float, radius_m: float) -> Gravity:
    """Gravity (1) and (3) of fully normalised coefficients c, s (N+1, N+1), indexed [n, m]; degrees 0 and 1 play no part.

    gm_m3_s2, radius_m : those with which the coefficients are given. Degree and order N, at least 2.
    """
    c, s = np.array(c, dtype=float), np.array(s, dtype=float)
    if c.ndim != 2 or c.shape != s.shape or c.shape[0] != c.shape[1] or len(c) < 3:
        raise InputError(f"c and s must be square and alike, (N+1, N+1) with N at least 2; got {c.shape} and {s.shape}.")
    degree = len(c) - 1
    factor = -gm_m3_s2 / radius_m**2 * np.sqrt(2.0 * np.arange(degree + 1) + 1.0)[:, None]  # (4)
    factor[:2] = 0.0
    s[:, 0] = 0.0  # they multiply sin 0
    g, h = factor * np.tril(c), factor * np.tril(s)
    basis = basis_for(degree + 1, degree + 1, radius_m)
    tables = field_table(g, h, degree), potential_table(g, h, degree)
    return Gravity(float(gm_m3_s2), 0.0, float(radius_m), basis, *tables)


@cache
def _egm2008(degree: int) -> Gravity:
    """EGM2008 to a degree, zero-tide."""
    head, *rows = _numbers("egm2008.txt")
    gm, radius = map(float, head)
    c, s = np.zeros((2, MOST_DEGREE + 1, MOST_DEGREE + 1))
    for n, m, cosine, sine in rows:
        c[int(n), int(m)], s[int(n), int(m)] = float(cosine), float(sine)
    c[2, 0] += PERMANENT_TIDE_C20
    kept = slice(degree + 1)
    return harmonic_gravity(c[kept, kept], s[kept, kept], gm, radius)


def _numbers(name: str) -> list[list[str]]:
    """The words of every line of a data file in the package, without comments."""
    text = (resources.files("fieldline") / "data" / name).read_text(encoding="ascii")
    return [line.split() for line in text.splitlines() if not line.startswith("#")]


def _whole_degree(degree) -> int:
    """`degree` if it is a whole number in its range."""
    whole = isinstance(degree, int | np.integer) and not isinstance(degree, bool)
    if not whole or not 2 <= degree <= MOST_DEGREE:
        raise InputError(f"degree of the gravity must be a whole number from 2 to {MOST_DEGREE}; got {degree!r}.")
    return int(degree)
