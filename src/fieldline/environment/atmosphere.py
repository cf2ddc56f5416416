"""Density of the upper atmosphere.

    layers:  rho = rho_k exp(-(h - h_k) / H_k),  k the highest layer with h_k <= h                         (1)
    table:   ln rho = cubic in x = ln(h - 60 km), latitude and hour angle of the Sun, linear in time       (2)

"none" is a vacuum; "exponential" is (1) with one layer, given by the user; "layered" is (1) with the 28 layers of the
usual reference (US Standard Atmosphere 1976 to 25 km, CIRA-72 for an exospheric temperature of 1,000 K above); "msis" is
(2), a table of NRLMSIS 2.1 made by `environment.msis`. Heights are geodetic, over WGS84. Below its lowest height the table
holds that height's density; layers go on growing, so that an exponential may refer to any height. Above the highest, density
goes on falling exponentially.

The real density departs from any of these: from MSIS by 15 % in the mean and by 100 % in storms; from "layered", which
knows no Sun, MSIS itself differs by a factor of 4 either way at 400 km and of 7 at 600 km over a solar cycle.

Source: Vallado (2013), Fundamentals of Astrodynamics and Applications, 4th ed., s. 8.6.2 and table 8-4.
"""

from __future__ import annotations

from math import atan2, exp, log, pi
from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.environment.cubic import cubic_place, cubic_weights
from fieldline.environment.places import as_positions
from fieldline.errors import InputError, nearest
from fieldline.frames.geodetic import geodetic_kernel
from fieldline.frames.vectors import vec

MODELS = ("none", "exponential", "layered", "msis")
NONE, LAYERS, TABLE = 0, 1, 2
HEIGHT_ORIGIN_M = 60e3  # of x in (2): scale heights grow about as the height over it, so that ln rho is all but straight

# Base height [km], density there [kg/m^3], scale height [km]: Vallado (2013), table 8-4.
REFERENCE_LAYERS = (
    (0.0, 1.225, 7.249),
    (25.0, 3.899e-2, 6.349),
    (30.0, 1.774e-2, 6.682),
    (40.0, 3.972e-3, 7.554),
    (50.0, 1.057e-3, 8.382),
    (60.0, 3.206e-4, 7.714),
    (70.0, 8.770e-5, 6.549),
    (80.0, 1.905e-5, 5.799),
    (90.0, 3.396e-6, 5.382),
    (100.0, 5.297e-7, 5.877),
    (110.0, 9.661e-8, 7.263),
    (120.0, 2.438e-8, 9.473),
    (130.0, 8.484e-9, 12.636),
    (140.0, 3.845e-9, 16.149),
    (150.0, 2.070e-9, 22.523),
    (180.0, 5.464e-10, 29.740),
    (200.0, 2.789e-10, 37.105),
    (250.0, 7.248e-11, 45.546),
    (300.0, 2.418e-11, 53.628),
    (350.0, 9.518e-12, 53.298),
    (400.0, 3.725e-12, 58.515),
    (450.0, 1.585e-12, 60.828),
    (500.0, 6.967e-13, 63.822),
    (600.0, 1.454e-13, 71.835),
    (700.0, 3.614e-14, 88.667),
    (800.0, 1.170e-14, 124.64),
    (900.0, 5.245e-15, 181.05),
    (1000.0, 3.019e-15, 268.00),
)


class Atmosphere(NamedTuple):
    """A model of the density as kernels take it; what a kind does not use is empty."""

    kind: int  # NONE, LAYERS or TABLE
    base_m: np.ndarray  # (n,) height at which each layer begins
    density: np.ndarray  # (n,) there [kg/m^3]
    scale_m: np.ndarray  # (n,)
    log_density: np.ndarray  # (times, latitudes, hour angles, heights) ln of [kg/m^3]
    node_step_s: float
    x_first: float  # x of (2) at the first height, and its spacing
    x_step: float
    top_scale_m: float  # scale height above the last height


@njit(cache=True)
def density_kernel(r_e, sun_e, t, atmosphere):
    """Density [kg/m^3] at r_e [m] with the Sun towards sun_e (tuples, ITRS axes), t [s] after the table's start."""
    if atmosphere.kind == NONE:
        return 0.0
    sin_latitude, cos_latitude, height = geodetic_kernel(r_e)
    if atmosphere.kind == LAYERS:
        return _layers(height, atmosphere)
    latitude = atan2(sin_latitude, cos_latitude)
    hour_angle = atan2(r_e[1] * sun_e[0] - r_e[0] * sun_e[1], r_e[0] * sun_e[0] + r_e[1] * sun_e[1])
    return _table(height, latitude, hour_angle, t, atmosphere)


@njit(cache=True)
def _layers(height, atmosphere):
    """Equation (1)."""
    k = atmosphere.base_m.shape[0] - 1
    while k > 0 and height < atmosphere.base_m[k]:
        k -= 1
    above = height - atmosphere.base_m[k]
    return atmosphere.density[k] * exp(-above / atmosphere.scale_m[k])


@njit(cache=True)
def _table(height, latitude, hour_angle, t, atmosphere):
    """Equation (2), the two times about t weighed linearly."""
    table = atmosphere.log_density
    times, latitudes, hours, heights = table.shape
    x = (log(max(height - HEIGHT_ORIGIN_M, 1.0)) - atmosphere.x_first) / atmosphere.x_step
    top = heights - 1.0
    up, up_weights = cubic_place(x, heights)
    north, north_weights = cubic_place((latitude / pi + 0.5) * (latitudes - 1), latitudes)
    turn = (hour_angle / (2.0 * pi) + 1.0) * hours
    east = int(turn)
    east_weights = cubic_weights(turn - east)
    late = min(max(t / atmosphere.node_step_s, 0.0), times - 1.0)
    first = min(int(late), max(times - 2, 0))
    late -= first
    total = 0.0
    for n in range(2 if late > 0.0 else 1):
        share = late if n == 1 else 1.0 - late
        for i in range(4):
            for j in range(4):
                hour = (east - 1 + j) % hours
                along = 0.0
                for k in range(4):
                    along += up_weights[k] * table[first + n, north + i, hour, up + k]
                total += share * north_weights[i] * east_weights[j] * along
    if x > top:
        highest = HEIGHT_ORIGIN_M + exp(atmosphere.x_first + top * atmosphere.x_step)
        total -= (height - highest) / atmosphere.top_scale_m
    return exp(total)


@njit(cache=True)
def _densities(position_e, sun_e, seconds, atmosphere, out):
    """`density_kernel` at every row."""
    for k in range(position_e.shape[0]):
        out[k] = density_kernel(vec(position_e, k), vec(sun_e, k), seconds[k], atmosphere)


def density(position_e_m, sun_e, seconds, atmosphere: Atmosphere) -> np.ndarray:
    """Density (...) [kg/m^3] at places (..., 3) [m] with the Sun in directions (..., 3), both ITRS axes.

    seconds : (...) [s] since the start for which an MSIS atmosphere was made; other models do not look at it.
    """
    position = as_positions("position_e_m", position_e_m, "ITRS")
    shape = position.shape[:-1]
    sun = np.broadcast_to(np.asarray(sun_e, dtype=float), position.shape)
    times = np.broadcast_to(np.asarray(seconds, dtype=float), shape)
    out = np.empty(position.size // 3)
    rows = (np.ascontiguousarray(part.reshape(-1, 3)) for part in (position, sun))
    _densities(*rows, np.ascontiguousarray(times.ravel()), atmosphere, out)
    return out.reshape(shape)


def atmosphere_model(
    name: str,
    *,
    density_kg_m3: float | None = None,
    height_m: float | None = None,
    scale_height_m: float | None = None,
    start_utc=None,
    duration_s: float | None = None,
    f107_sfu: float | None = None,
    f107_average_sfu: float | None = None,
    ap: float | None = None,
) -> Atmosphere:
    """A model of the atmosphere for `density_kernel`.

    Parameters
    ----------
    name : "none", "exponential", "layered" or "msis".
    density_kg_m3, height_m, scale_height_m : of "exponential": density at a height [m] over WGS84, and its scale height [m].
    start_utc, duration_s : of "msis": the span that the table must serve; beyond it the first and last density stay.
    f107_sfu, f107_average_sfu, ap : of "msis": solar radio flux of the day before and its mean over 81 days [10^-22 W/m^2/Hz],
        50 to 400, and the daily planetary index, 0 to 400; constant over the span, never looked up.

    Raises
    ------
    InputError : an unknown model, a parameter that it lacks or does not take, a number out of its range, MSIS not installed.
    """
    given = {
        "exponential": {"density_kg_m3": density_kg_m3, "height_m": height_m, "scale_height_m": scale_height_m},
        "msis": {
            "start_utc": start_utc,
            "duration_s": duration_s,
            "f107_sfu": f107_sfu,
            "f107_average_sfu": f107_average_sfu,
            "ap": ap,
        },
    }
    if name not in MODELS:
        raise InputError(f'unknown atmosphere "{name}"; {nearest(str(name), MODELS)}')
    for model, parameters in given.items():
        _all_or_none(name, model, parameters)
    if name == "msis":
        from fieldline.environment.msis import msis_table

        return table_atmosphere(**msis_table(**given["msis"]))
    if name == "exponential":
        _in_range("density_kg_m3", density_kg_m3, 1e-30, 10.0)
        _in_range("height_m", height_m, -1e4, 1e7)
        _in_range("scale_height_m", scale_height_m, 1e3, 1e6)
        return _layer_atmosphere([(height_m, density_kg_m3, scale_height_m)])
    if name == "layered":
        return _layer_atmosphere([(1e3 * base, start, 1e3 * scale) for base, start, scale in REFERENCE_LAYERS])
    return _layer_atmosphere([])._replace(kind=NONE)


def table_atmosphere(log_density, node_step_s: float, heights_m) -> Atmosphere:
    """Atmosphere (2) of ln density (times, latitudes, hour angles, heights).

    Latitudes run evenly from pole to pole, hour angles evenly eastward from the Sun's meridian without its repetition, heights
    evenly in x, times every node_step_s [s]. At least four of each but the times.
    """
    log_density = np.ascontiguousarray(log_density, dtype=float)
    x = np.log(np.asarray(heights_m, dtype=float) - HEIGHT_ORIGIN_M)
    fall = np.mean(log_density[..., -2] - log_density[..., -1])
    top_scale = float((heights_m[-1] - heights_m[-2]) / fall)
    step = float((x[-1] - x[0]) / (len(x) - 1))
    return _layer_atmosphere([])._replace(
        kind=TABLE,
        log_density=log_density,
        node_step_s=float(node_step_s),
        x_first=float(x[0]),
        x_step=step,
        top_scale_m=top_scale,
    )


def _layer_atmosphere(layers) -> Atmosphere:
    """Atmosphere (1) of rows base [m], density [kg/m^3], scale height [m]."""
    columns = np.array(layers, dtype=float).reshape(-1, 3).T
    return Atmosphere(LAYERS, *(np.ascontiguousarray(column) for column in columns), np.zeros((0, 0, 0, 0)), 1.0, 0.0, 1.0, 1.0)


def _all_or_none(name: str, model: str, parameters: dict) -> None:
    """Every parameter of the chosen model is given, and none of another."""
    given = [key for key, value in parameters.items() if value is not None]
    if name == model and len(given) < len(parameters):
        missing = ", ".join(key for key in parameters if key not in given)
        raise InputError(f'the atmosphere "{name}" needs {missing} too.')
    if name != model and given:
        raise InputError(f'the atmosphere "{name}" takes no {", ".join(given)}: these belong to "{model}".')


def _in_range(name: str, value, least: float, most: float) -> None:
    """Refuse what is no number between two limits."""
    if not isinstance(value, int | float | np.number) or not least <= value <= most:
        raise InputError(f"{name} of the atmosphere must lie within {least:g} and {most:g}; got {value!r}.")
