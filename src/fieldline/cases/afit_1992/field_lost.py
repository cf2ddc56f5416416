"""Where the field in the orbit's plane vanishes, and where the part across it does: at 11.5 and 78.5 degrees?

A day takes an orbit over every argument of latitude at every longitude of its node, nearly: the least of each part is
looked for on that torus and refined. For a dipole tilted by 11.5 degrees the part in the plane vanishes at one longitude
of the node, all around the orbit, and only at an inclination of 11.5; the part across at 78.5 and above. In the real field
the first asks two numbers to vanish at two coordinates: it does so at single points, over a range of inclinations; the
second vanishes along lines, from some inclination on.
"""

from __future__ import annotations

import numpy as np

from fieldline.cases.afit_1992.earth import ALTITUDE_M, POLE_LATITUDE_DEG, SOURCE, circle, inclinations_of
from fieldline.cases.afit_1992.field_in_orbit import DATE, INCLINATIONS_DEG, model_field_h
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.erbs_like import number

ZOOMS = 6  # of a fifth each, from the grid's step
ZOOM_POINTS = 11
SEEDS = 6  # lowest places of the grid that are refined


def lost_field(
    inclinations_deg=INCLINATIONS_DEG,
    *,
    altitude_m: float = ALTITUDE_M,
    step_deg: float = 3.0,
    model: str = "IGRF-14",
    date: str = DATE,
):
    """The least field in the orbit's plane and across it, over all arguments and nodes, as a Dataset over inclination_deg.

    in_plane_least, across_least [T] (zero where it changes sign); in_plane_share, the time with less than a twentieth of
    the RMS in the plane, across_share the same across; and where: argument_deg, node_longitude_deg of the first;
    in_plane_least_dipole, across_least_dipole of the thesis's dipole, in closed form.
    """
    inclinations = inclinations_of(inclinations_deg)
    radius = circle(altitude_m).radius_m
    ring = np.arange(0.0, 360.0, number("step_deg", step_deg, 0.5, 15.0))
    argument, node = (one.ravel() for one in np.meshgrid(ring, ring, indexing="ij"))
    rows = [_at(i, argument, node, radius, step_deg, model, date) for i in inclinations]
    settings = {"altitude_m": altitude_m, "step_deg": step_deg, "model": model, "date": date}
    dataset = _dataset(inclinations, np.array(rows), settings)
    for name, values in zip(("in_plane", "across"), _dipole_least(inclinations, circle(altitude_m).strength_tesla), strict=True):
        words = f"the same of the thesis's dipole, {name.replace('_', ' ')}"
        dataset[f"{name}_least_dipole"] = ("inclination_deg", values, {"units": "T", "long_name": words})
    return dataset


def _dipole_least(inclinations: np.ndarray, strength: float) -> tuple[np.ndarray, np.ndarray]:
    """[T] of a tilted dipole: its least angle from the normal is |i - tilt|, its greatest i + tilt (mirrored beyond 90)."""
    tilt, i = 90.0 + POLE_LATITUDE_DEG, np.minimum(inclinations, 180.0 - inclinations)
    return strength * np.abs(np.sin(np.radians(i - tilt))), strength * np.cos(np.radians(np.minimum(i + tilt, 90.0)))


def _at(inclination: float, argument, node, radius: float, step: float, model: str, date: str) -> list[float]:
    """One inclination's numbers, in the order of `NAMES`."""
    field_h = model_field_h(inclination, argument, node, radius, model, date)
    plane, across = np.hypot(field_h[:, 0], field_h[:, 1]), field_h[:, 2]
    least, u, w = min(_refined(inclination, argument[k], node[k], step, radius, model, date) for k in np.argsort(plane)[:SEEDS])
    least_across = 0.0 if across.min() < 0.0 < across.max() else float(np.abs(across).min())
    shares = [float((size < 0.05 * np.sqrt((size**2).mean())).mean()) for size in (plane, np.abs(across))]
    return [least, least_across, *shares, u, w]


def _refined(inclination, argument, node, step, radius, model, date) -> tuple[float, float, float]:
    """(least in-plane field [T], argument, node) near a place of the grid, by grids that shrink about it."""
    best = (np.inf, argument, node)
    for _ in range(ZOOMS):
        offsets = step * np.linspace(-1.0, 1.0, ZOOM_POINTS)
        u, w = np.meshgrid(argument + offsets, node + offsets, indexing="ij")
        field_h = model_field_h(inclination, u, w, radius, model, date)
        size = np.hypot(field_h[..., 0], field_h[..., 1])
        k = np.unravel_index(size.argmin(), size.shape)
        best = min(best, (float(size[k]), float(u[k]), float(w[k])))
        _, argument, node = best
        step *= 0.2
    return best[0], best[1] % 360.0, best[2] % 360.0


NAMES = {
    "in_plane_least": ("T", "least field in the orbit's plane"),
    "across_least": ("T", "least field across it; zero where it changes sign"),
    "in_plane_share": ("1", "time with under a twentieth of the RMS in the plane"),
    "across_share": ("1", "time with under a twentieth of the RMS across"),
    "argument_deg": ("deg", "argument of latitude of the least in the plane"),
    "node_longitude_deg": ("deg", "longitude of the node there"),
}


def _dataset(inclinations: np.ndarray, rows: np.ndarray, settings: dict):
    """The numbers with their units."""
    import xarray as xr

    variables = {
        name: ("inclination_deg", rows[:, k], {"units": unit, "long_name": words})
        for k, (name, (unit, words)) in enumerate(NAMES.items())
    }
    return xr.Dataset(
        variables,
        coords={"inclination_deg": ("inclination_deg", inclinations, {"units": "deg"})},
        attrs={
            "title": f"Where parts of the field vanish, {settings['model']}",
            "case": "afit_1992_lost_field",
            "source": f"{SOURCE}, sections 4.1.3 and 6",
            "settings_json": settings_text(settings),
        },
    )
