"""Density of the electrons of the ionosphere's F layer, where tethers collect their current.

    constant:  n_e everywhere
    chapman:   n_e = N exp((1 - z - exp(-z)) / 2),   z = (h - h_m) / H                                      (1)
               ln N and h_m go from night to day with w = (1 + tanh(cos chi / 0.25)) / 2                    (2)
    table:     ln n_e linear between given heights, by day and by night, weighed by the same w

(1) is Chapman's layer with recombination quadratic in the density; H differs below and above the peak, because above it
diffusion and not production rules. chi: the Sun's distance from the zenith. A table holds its ends' values outside.

The defaults are round numbers for middle latitudes and moderate solar activity: 1e12 / m^3 at 300 km by day and 1e11 at
350 km by night. The real layer departs from them by a factor of 3 either way with solar activity, season, latitude (the
crests beside the magnetic equator) and the hour: after sunset the layer decays over hours, which (2) does not know.

Source: Schunk and Nagy (2009), Ionospheres, 2nd ed., s. 9.5 (Chapman's layer) and 11.5 (the F layer).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, log, tanh
from typing import NamedTuple

import numpy as np

from fieldline.compiled import kernel
from fieldline.environment.places import as_positions
from fieldline.errors import InputError, nearest
from fieldline.frames.geodetic import geodetic_kernel
from fieldline.frames.vectors import dot, norm, vec

MODELS = ("none", "constant", "chapman", "table")
VACUUM, CONSTANT, CHAPMAN, TABULATED = range(4)
TWILIGHT = 0.25  # of cos chi in (2): the change takes some 30 degrees of the Sun's height
FURTHEST = 600.0  # exponent of exp(-z) far below the peak, where the density is zero


class Plasma(NamedTuple):
    """A model of the electron density as kernels take it; what a kind does not use is empty or zero."""

    kind: int  # VACUUM, CONSTANT, CHAPMAN or TABULATED
    density: float  # [1/m^3]
    log_peak: tuple[float, float]  # ln of [1/m^3], by night and by day
    peak_m: tuple[float, float]  # height of the peak, by night and by day
    below_m: float  # H of (1) below the peak
    above_m: float  # and above it
    heights_m: np.ndarray  # (n,) of a table
    log_density: np.ndarray  # (2, n) ln of [1/m^3], by night and by day
    temperature_ev: float  # of the electrons


@kernel
def daylight(cos_zenith):
    """w of equation (2): 0 by night, 1 by day."""
    return 0.5 * (1.0 + tanh(cos_zenith / TWILIGHT))


@kernel
def chapman(height, peak, peak_height, below, above):
    """n_e [1/m^3] of equation (1), heights in [m]."""
    z = (height - peak_height) / (above if height > peak_height else below)
    return peak * exp(0.5 * (1.0 - z - exp(min(-z, FURTHEST))))


@kernel
def electron_density_kernel(r_e, sun_e, plasma):
    """n_e [1/m^3] at r_e [m] with the Sun towards sun_e (tuples of any length above zero, ITRS axes)."""
    if plasma.kind == VACUUM:
        return 0.0
    if plasma.kind == CONSTANT:
        return plasma.density
    _, _, height = geodetic_kernel(r_e)
    day = daylight(dot(r_e, sun_e) / (norm(r_e) * norm(sun_e)))
    if plasma.kind == CHAPMAN:
        peak = exp((1.0 - day) * plasma.log_peak[0] + day * plasma.log_peak[1])
        peak_height = (1.0 - day) * plasma.peak_m[0] + day * plasma.peak_m[1]
        return chapman(height, peak, peak_height, plasma.below_m, plasma.above_m)
    return exp(_between(height, day, plasma))


@kernel
def _between(height, day, plasma):
    """ln n_e of the table."""
    heights, values = plasma.heights_m, plasma.log_density
    k = 0
    while k < heights.shape[0] - 2 and height > heights[k + 1]:
        k += 1
    u = min(max((height - heights[k]) / (heights[k + 1] - heights[k]), 0.0), 1.0)
    low = (1.0 - day) * values[0, k] + day * values[1, k]
    high = (1.0 - day) * values[0, k + 1] + day * values[1, k + 1]
    return (1.0 - u) * low + u * high


@kernel
def _densities(position_e, sun_e, plasma, out):
    """`electron_density_kernel` at every row."""
    for k in range(position_e.shape[0]):
        out[k] = electron_density_kernel(vec(position_e, k), vec(sun_e, k), plasma)


def electron_density(position_e_m, sun_e, plasma: Plasma) -> np.ndarray:
    """Density (...) [1/m^3] of electrons at places (..., 3) [m] with the Sun in directions (..., 3), both ITRS axes."""
    position = as_positions("position_e_m", position_e_m, "ITRS")
    sun = np.broadcast_to(np.asarray(sun_e, dtype=float), position.shape)
    out = np.empty(position.size // 3)
    rows = (np.ascontiguousarray(part.reshape(-1, 3)) for part in (position, sun))
    _densities(*rows, plasma, out)
    return out.reshape(position.shape[:-1])


def plasma_model(
    name: str,
    *,
    density_m3: float = 0.0,
    peak_day_m3: float = 1e12,
    peak_night_m3: float = 1e11,
    peak_height_day_m: float = 300e3,
    peak_height_night_m: float = 350e3,
    scale_below_m: float = 50e3,
    scale_above_m: float = 100e3,
    heights_m: Sequence[float] = (),
    day_m3: Sequence[float] = (),
    night_m3: Sequence[float] = (),
    temperature_ev: float = 0.1,
) -> Plasma:
    """A model of the ionosphere for `electron_density_kernel`.

    Parameters
    ----------
    name : "none" (no current is collected), "constant", "chapman" or "table".
    density_m3 : of "constant" [1/m^3].
    peak_..., scale_... : of "chapman": density and height of the peak by day and by night, H below and above it [m].
    heights_m, day_m3, night_m3 : of "table": rising heights over WGS84 [m] and densities there; the same by night
        where only day_m3 is given.
    temperature_ev : of the electrons, Boltzmann's constant times it [eV].

    Raises
    ------
    InputError : unknown name, a number that is not positive, a table that does not rise or whose columns differ in length.
    """
    if name not in MODELS:
        raise InputError(f'unknown plasma "{name}"; {nearest(str(name), MODELS)}')
    peaks = {"peak_day_m3": peak_day_m3, "peak_night_m3": peak_night_m3}
    heights = {"peak_height_day_m": peak_height_day_m, "peak_height_night_m": peak_height_night_m}
    scales = {"scale_below_m": scale_below_m, "scale_above_m": scale_above_m, "temperature_ev": temperature_ev}
    needed = {"density_m3": density_m3} if name == "constant" else {}
    for key, value in {**peaks, **heights, **scales, **needed}.items():
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{key} of the plasma must be a positive number; got {value}.")
    table = _table(heights_m, day_m3, night_m3) if name == "table" else (np.zeros(2), np.zeros((2, 2)))
    return Plasma(
        kind=MODELS.index(name),
        density=float(density_m3),
        log_peak=(log(peak_night_m3), log(peak_day_m3)),
        peak_m=(float(peak_height_night_m), float(peak_height_day_m)),
        below_m=float(scale_below_m),
        above_m=float(scale_above_m),
        heights_m=table[0],
        log_density=table[1],
        temperature_ev=float(temperature_ev),
    )


def _table(heights_m, day_m3, night_m3) -> tuple[np.ndarray, np.ndarray]:
    """Heights and the logarithms by night and by day, checked."""
    heights = np.array(heights_m, dtype=float)
    day = np.array(day_m3, dtype=float)
    night = np.array(night_m3, dtype=float) if len(night_m3) else day
    if heights.ndim != 1 or len(heights) < 2 or not heights.shape == day.shape == night.shape:
        raise InputError(
            "a table of the plasma needs two heights at least and a density for each; "
            f"got {heights.size} heights, {day.size} by day, {night.size} by night."
        )
    if not (np.isfinite(heights).all() and np.all(np.diff(heights) > 0.0)):
        raise InputError("heights_m of the plasma must rise from one to the next.")
    both = np.array([night, day])
    if not (np.isfinite(both).all() and np.all(both > 0.0)):
        raise InputError(f"densities of the plasma must be positive; got {both.min()}. Leave out heights without electrons.")
    return heights, np.log(both)
