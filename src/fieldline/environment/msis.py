"""NRLMSIS 2.1 as a table that compiled loops can read.

The model's own program takes a microsecond a place and runs outside them, so it is asked on a grid: 36 heights from 100 to
1,000 km, evenly in ln(h - 60 km); 19 latitudes; 24 hour angles of the Sun; every three hours over the span, since at one
solar time the density also goes with the longitude. Spans longer than 30 days have a node every ten days instead, each the
mean of eight hours of the day, which leaves the longitudes out (2 to 4 % RMS).

Read back by `density_kernel` the table is within 0.3 % RMS of the model from 100 to 1,000 km and within 3 % everywhere
(most of it from the three hours; near a pole). Its density is of all species, anomalous oxygen among them. Above 1,000 km
one scale height carries on, which is 8 % RMS off to 1,100 km and too thin by a third at 1,200.

The F10.7 flux and the Ap index are the user's and constant: nothing is ever looked up or fetched. Without storms: the daily
Ap alone is used. Source: Emmert et al. (2022), J. Geophys. Res. Space Physics 127, e2022JA030896; the `pymsis` package.
"""

from __future__ import annotations

import numpy as np

from fieldline.environment.atmosphere import HEIGHT_ORIGIN_M
from fieldline.environment.sun import sun_position_i
from fieldline.errors import InputError
from fieldline.frames.earth_rotation import dcm_ei
from fieldline.frames.time import as_utc

LOWEST_M, HIGHEST_M, HEIGHTS = 100e3, 1000e3, 36
LATITUDES, HOURS = 19, 24
FINE_STEP_S, COARSE_STEP_S = 10800.0, 864000.0
FINE_SPAN_S = 30.0 * 86400.0
HOURS_OF_A_MEAN = 8
LIMITS = {"f107_sfu": (50.0, 400.0), "f107_average_sfu": (50.0, 400.0), "ap": (0.0, 400.0), "duration_s": (0.0, 3.2e8)}


def msis_table(start_utc, duration_s: float, f107_sfu: float, f107_average_sfu: float, ap: float) -> dict:
    """ln of the density [kg/m^3] on the grid (times, latitudes, hour angles, heights), with `node_step_s` and `heights_m`.

    Parameters and errors as `fieldline.environment.atmosphere.atmosphere_model`.
    """
    values = {"f107_sfu": f107_sfu, "f107_average_sfu": f107_average_sfu, "ap": ap, "duration_s": duration_s}
    for name, value in values.items():
        least, most = LIMITS[name]
        if not isinstance(value, int | float | np.number) or not least <= value <= most:
            raise InputError(f"{name} of the atmosphere must lie within {least:g} and {most:g}; got {value!r}.")
    start = as_utc(start_utc, "start_utc")
    if start.ndim:
        raise InputError(f"start_utc must be one time; got shape {start.shape}.")
    fine = duration_s <= FINE_SPAN_S
    step = FINE_STEP_S if fine else COARSE_STEP_S
    hours = [0.0] if fine else 86400.0 / HOURS_OF_A_MEAN * (np.arange(HOURS_OF_A_MEAN) - (HOURS_OF_A_MEAN - 1) / 2)
    nodes = []
    for k in range(int(np.ceil(duration_s / step)) + 1):
        around = [start + np.timedelta64(round((k * step + hour) * 1e9), "ns") for hour in hours]
        nodes.append(np.mean([_snapshot(time, f107_sfu, f107_average_sfu, ap) for time in around], axis=0))
    return {"log_density": np.array(nodes), "node_step_s": step, "heights_m": grid_heights_m()}


def grid_heights_m() -> np.ndarray:
    """The grid's heights [m]."""
    ends = np.log([LOWEST_M - HEIGHT_ORIGIN_M, HIGHEST_M - HEIGHT_ORIGIN_M])
    return HEIGHT_ORIGIN_M + np.exp(np.linspace(*ends, HEIGHTS))


def _snapshot(time_utc, f107: float, f107_average: float, ap: float) -> np.ndarray:
    """ln of the density (latitudes, hour angles, heights) at one time."""
    pymsis = _pymsis()
    sun_e = dcm_ei(time_utc) @ sun_position_i(time_utc)
    longitude_deg = np.degrees(np.arctan2(sun_e[1], sun_e[0])) + 360.0 / HOURS * np.arange(HOURS)
    latitude_deg = np.linspace(-90.0, 90.0, LATITUDES)
    # Every argument given: left out, pymsis would fetch the indices from the network.
    grid = pymsis.calculate(
        [time_utc], longitude_deg, latitude_deg, 1e-3 * grid_heights_m(), [f107], [f107_average], [[ap] * 7], version=2.1
    )
    return np.log(np.swapaxes(grid[0, ..., pymsis.Variable.MASS_DENSITY], 0, 1).astype(float))


def _pymsis():
    """The package, or how to get it."""
    try:
        import pymsis
    except ImportError as error:
        raise InputError(
            "the atmosphere \"msis\" needs the package pymsis, which is not installed: pip install 'fieldline[msis]'. "
            'Or take "layered".'
        ) from error
    return pymsis
