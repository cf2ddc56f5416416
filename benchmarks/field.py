"""Cost of the magnetic field per point, against ppigrf and chaosmagpy, all in one run.

All evaluate IGRF-14 to degree 13 at the same geocentric points of low orbit. A peer that is not installed is left out
and a remark says so. Each figure is the best of several repetitions on one core.
"""

from __future__ import annotations

import timeit
from datetime import datetime
from importlib import resources

import numpy as np
from numba import njit

from fieldline.environment import field_gradient, field_model, magnetic_field
from fieldline.environment.field import field_kernel
from fieldline.frames.vectors import add, vec

POINTS = 20_000
EPOCH = np.datetime64("2020-01-01", "ns")  # an epoch of the model, where all calendars agree


def orbit(points: int):
    """Radius [km], colatitude and longitude [deg] along a near-polar orbit, one a second, and the positions [m]."""
    angle = 2.0 * np.pi * np.arange(points) / 5700.0
    colatitude = np.degrees(np.arccos(np.sin(np.radians(97.5)) * np.sin(angle)))
    longitude = np.mod(np.degrees(np.arctan2(np.cos(np.radians(97.5)) * np.sin(angle), np.cos(angle))), 360.0)
    radius = np.full(points, 6900.0)
    theta, phi = np.radians(colatitude), np.radians(longitude)
    up = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    return radius, colatitude, longitude, up * 6.9e6


@njit
def kernel_loop(position_e, params):
    """The kernel alone, as a compiled plant or filter calls it."""
    total = (0.0, 0.0, 0.0)
    for k in range(position_e.shape[0]):
        total = add(total, field_kernel(vec(position_e, k), params))
    return total


def cost(call, points: int, repeat: int = 5) -> float:
    """[us] a point, the best of `repeat` after one call that warms up."""
    call()
    once = timeit.timeit(call, number=1)
    number = max(1, int(0.05 / max(once, 1e-7)))
    return min(timeit.repeat(call, number=number, repeat=repeat)) / number / points * 1e6


def fieldline_rows(points: int):
    """(what, [us] a point) of Fieldline."""
    *_, position = orbit(points)
    series = EPOCH + np.arange(points) * np.timedelta64(1, "s")
    params = field_model("IGRF-14").at(EPOCH)
    return {
        "one call": cost(lambda: magnetic_field(position[0], EPOCH), 1),
        "bulk, one time": cost(lambda: magnetic_field(position, EPOCH), points),
        "bulk, a time each": cost(lambda: magnetic_field(position, series), points),
        "bulk gradient": cost(lambda: field_gradient(position, EPOCH), points),
        "bulk, degree 8": cost(lambda: magnetic_field(position, EPOCH, degree=8), points),
        "kernel in a compiled loop": cost(lambda: kernel_loop(position, params), points),
    }


def ppigrf_rows(points: int):
    """(what, [us] a point) of ppigrf, and its greatest difference [nT]; a time for each point it cannot take."""
    import ppigrf

    radius, colatitude, longitude, position = orbit(points)
    date = datetime(2020, 1, 1)
    magnitude = np.linalg.norm(np.squeeze(ppigrf.igrf_gc(radius, colatitude, longitude, date)), axis=0)
    rows = {
        "one call": cost(lambda: ppigrf.igrf_gc(radius[0], colatitude[0], longitude[0], date), 1),
        "bulk, one time": cost(lambda: ppigrf.igrf_gc(radius, colatitude, longitude, date), points),
    }
    return rows, difference(magnitude, position)


def chaosmagpy_rows(points: int):
    """(what, [us] a point) of chaosmagpy with the same coefficients, and its greatest difference [nT]."""
    import chaosmagpy
    from chaosmagpy.chaos import BaseModel

    radius, colatitude, longitude, position = orbit(points)
    with resources.as_file(resources.files("fieldline") / "data" / "igrf14.shc") as path:
        model = BaseModel.from_shc(str(path), leap_year=True)
    day = float(chaosmagpy.data_utils.mjd2000(2020, 1, 1))
    days = day + np.arange(points) / 86400.0
    magnitude = np.linalg.norm(model.synth_values(day, radius, colatitude, longitude), axis=0)
    rows = {
        "one call": cost(lambda: model.synth_values(day, radius[0], colatitude[0], longitude[0]), 1),
        "bulk, one time": cost(lambda: model.synth_values(day, radius, colatitude, longitude), points),
        "bulk, a time each": cost(lambda: model.synth_values(days, radius, colatitude, longitude), points),
    }
    return rows, difference(magnitude, position)


def difference(magnitude_nt, position) -> float:
    """[nT] greatest difference of the magnitudes from Fieldline's."""
    ours = np.linalg.norm(magnetic_field(position, EPOCH), axis=1) * 1e9
    return float(np.abs(ours - magnitude_nt).max())


def table(points: int = POINTS) -> tuple[list[tuple[str, ...]], list[str]]:
    """Rows (what, ours, each peer's) with a header, [us] a point and in brackets times ours; and remarks."""
    ours = fieldline_rows(points)
    peers, notes = {}, []
    for name, rows_of in (("ppigrf", ppigrf_rows), ("chaosmagpy", chaosmagpy_rows)):
        try:
            peers[name], apart = rows_of(points)
            notes.append(f"{name} differs by at most {apart:.0e} nT in magnitude.")
        except ImportError:
            notes.append(f"{name} is not installed and was left out.")
    rows = [("microseconds a point", "Fieldline", *peers)]
    for what, mine in ours.items():
        cells = (f"{rows_of[what]:.3g} ({rows_of[what] / mine:.0f} x)" if what in rows_of else "-" for rows_of in peers.values())
        rows.append((what, f"{mine:.3g}", *cells))
    return rows, notes
