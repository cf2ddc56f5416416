"""What a vehicle with conductors can reach at each inclination and place of the orbit.

At every argument of latitude, the least margin over all longitudes of the node, which a day goes through: a chart of
inclination against argument. Beside it, per inclination, the least of the input's sixth singular value over its first: zero
where the vehicle cannot hold a place (conductors alone: everywhere).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fieldline.analysis.controllability import THRESHOLD, controllability_now, orbital_scale
from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2
from fieldline.control.electrodynamic import electrodynamic_plant
from fieldline.environment.orbit_field import field_on_orbit_h
from fieldline.errors import InputError

if TYPE_CHECKING:
    from fieldline.design import TrackingVehicle

LOW_M, HIGH_M = 1e5, 1e8
WEAK = 1e-3  # margin below which a place counts as weak
ZOOMS = 7
ZOOM_POINTS = 7


def vehicle_survey(
    vehicle: TrackingVehicle,
    altitude_m: float,
    inclinations_rad,
    *,
    model: str = "IGRF-14",
    time_utc: Any = "2025-01-01",
    arguments: int = 24,
    nodes: int = 12,
):
    """Margins of control over inclination and argument of latitude, an xarray Dataset.

    Parameters
    ----------
    vehicle : with mass, inertia, conductors, thrusters.      altitude_m : of the circular orbit.
    inclinations_rad : (k,).      model, time_utc : of the field.      arguments, nodes : how many of each are looked at.

    Returns
    -------
    Dataset: margin (inclination_deg, argument_deg), the least over the nodes; least_margin, weak_share (of all instants, with
    a margin under 1e-3) and hold (inclination_deg).
    """
    inclinations = np.atleast_1d(np.asarray(inclinations_rad, dtype=float))
    if inclinations.ndim != 1 or not ((inclinations >= 0.0) & (inclinations <= np.pi)).all():
        raise InputError("inclinations must lie between 0 and 180 deg.")
    if not LOW_M <= altitude_m <= HIGH_M:
        raise InputError(f"altitude_m must lie between {LOW_M:g} and {HIGH_M:g}; got {altitude_m:g}. Is it in km?")
    if min(arguments, nodes) < 1 or arguments * nodes > 100_000:
        raise InputError(f"arguments and nodes must be 1 or more, 100,000 places in all; got {arguments} and {nodes}.")
    rows = [_one(vehicle, altitude_m, i, model, time_utc, arguments, nodes) for i in inclinations]
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    return _dataset(inclinations, 360.0 * np.arange(arguments) / arguments, columns, altitude_m, model)


def _one(vehicle, altitude_m, inclination, model, time_utc, arguments, nodes) -> tuple[np.ndarray, float, float, float]:
    """(least margin at each argument, share of weak instants, least sixth over first singular value, least margin found)."""
    u, w = (2.0 * np.pi * np.arange(count) / count for count in (arguments, nodes))
    place = {"vehicle": vehicle, "altitude_m": altitude_m, "inclination": inclination, "model": model, "time_utc": time_utc}
    now = _margins(u[:, None], w, **place)
    values = now.input_values
    sixth = values[..., 5] / values[..., 0] if values.shape[-1] > 5 else np.zeros(now.margin.shape)
    k, j = np.unravel_index(now.margin.argmin(), now.margin.shape)
    least = _refined(float(u[k]), float(w[j]), 2.0 * np.pi / np.array([arguments, nodes]), float(now.margin[k, j]), place)
    return now.margin.min(axis=1), float((now.margin < WEAK).mean()), float(sixth.min()), least


def _margins(argument, node, *, vehicle, altitude_m, inclination, model, time_utc):
    """Controllability at arguments and nodes [rad], which broadcast."""
    radius = EARTH_EQUATORIAL_RADIUS_M + altitude_m
    n = float(np.sqrt(EARTH_GM_M3_S2 / radius**3))
    field_h = field_on_orbit_h(radius, inclination, argument, node, np.datetime64(time_utc), model)
    plant = electrodynamic_plant(
        vehicle,
        field_h,
        mean_motion_rad_s=n,
        radius_m=radius,
        mass_kg=vehicle.mass_kg,
        inertia_kg_m2=vehicle.inertia_kg_m2,
    )
    return controllability_now(plant.F, plant.G, rate=n, scale=orbital_scale(n))


def _refined(argument: float, node: float, step: np.ndarray, least: float, place: dict) -> float:
    """The least margin near the least of the grid, by grids that shrink about it: a zero lies between samples."""
    for _ in range(ZOOMS):
        offsets = np.linspace(-1.0, 1.0, ZOOM_POINTS)
        u, w = np.meshgrid(argument + step[0] * offsets, node + step[1] * offsets, indexing="ij")
        margin = _margins(u, w, **place).margin
        k = np.unravel_index(margin.argmin(), margin.shape)
        argument, node, least = float(u[k]), float(w[k]), min(least, float(margin[k]))
        step = 0.25 * step
    return least


def _dataset(inclinations, arguments, columns, altitude_m: float, model: str):
    """The chart and the columns with their units."""
    import xarray as xr

    margin, weak, hold, least = columns

    over = "inclination_deg"
    return xr.Dataset(
        {
            "margin": ((over, "argument_deg"), margin, {"units": "1", "long_name": "least margin of control over the nodes"}),
            "least_margin": (over, least, {"units": "1", "long_name": "least margin of control, refined between samples"}),
            "weak_share": (over, weak, {"units": "1", "long_name": f"share of instants with a margin under {WEAK:g}"}),
            "hold": (over, hold, {"units": "1", "long_name": "least sixth over first singular value of the inputs"}),
        },
        coords={
            over: (over, np.degrees(inclinations), {"units": "deg"}),
            "argument_deg": ("argument_deg", arguments, {"units": "deg", "long_name": "argument of latitude"}),
        },
        attrs={"altitude_m": altitude_m, "model": model, "threshold": THRESHOLD},
    )
