"""`tether_modes`: the modes of a hanging line as a Dataset, and the closed forms that they are held against."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fieldline.analysis.tether.eigenmodes import Families, eigenmotions
from fieldline.analysis.tether.grid import chain_grid, continuum_grid
from fieldline.analysis.tether.statics import Anchor, Hanging, hang
from fieldline.analysis.tether.strand import Stretches, cut, positive, stretches_of
from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2
from fieldline.errors import InputError, nearest

if TYPE_CHECKING:
    import xarray as xr

MOST_NODES = 500  # the cost grows with the cube: 500 nodes take a quarter of a minute
SHOWN = 13  # modes of each family that are told of a continuum: those that its polynomials hold to nine digits or more
LENGTHS = ("unstretched", "stretched")
GM_BOUNDS = (3.98e14, 3.99e14)  # [m^3/s^2], with what older programs used
SHORTEST_M = 1.0  # below it the pulls of points so near to each other have no digits left


def tether_modes(
    length_m,
    mass_per_length_kg_m,
    axial_stiffness_n,
    lower_mass_kg: float,
    upper_mass_kg: float,
    upper_altitude_m: float,
    nodes: int | None = None,
    *,
    length: str = "unstretched",
    gm_m3_s2: float = EARTH_GM_M3_S2,
) -> xr.Dataset:
    """Modes of a line that hangs straight down from a body in a circular orbit about a point Earth.

    Parameters
    ----------
    length_m : [m]; several lengths for a line of several materials, from the lower end to the upper.
    mass_per_length_kg_m, axial_stiffness_n : [kg/m] of unstretched length, [N]: Young's modulus times cross-section; one, or
        one a material. A massless line has 0 and `nodes` 0 or None.
    lower_mass_kg, upper_mass_kg : bodies at the ends, as points [kg]; 0 for a free end.
    upper_altitude_m : of the upper end above the equatorial radius 6378136.6 m [m].
    nodes : point masses along the line, evenly spaced, as the plant has them; 0: all mass at the ends; None: the continuum.
    length : "unstretched" or "stretched" (hanging in orbit), which of the two length_m is.
    gm_m3_s2 : the Earth's gravitational constant.

    Returns
    -------
    Dataset. For each family F of `in_plane` (mode 0 is the libration, mode k has k half waves), `out_of_plane` (the same)
    and `along_line` (mode k has k half waves, the bodies taking part):
    F_frequency [rad/s], F_ratio (over the orbital rate) and F_shape (F_mode, point), 1 where it is largest and in phase with
    cos(wt). The Coriolis force makes every motion in the plane an ellipse: in_plane_stretch (up) and along_line_sway (along
    the track) go with sin(wt). Beside them radius, height, rest_height (point) [m], tension (station) [N] with
    station_rest_height [m], orbital_rate [rad/s]. All modes of a line with nodes, 13 of each family of a continuum.

    Raises
    ------
    InputError : numbers that cannot be; a line that reaches the ground, or that is too soft to hang.
    """
    hanging = hanging_line(
        length_m,
        mass_per_length_kg_m,
        axial_stiffness_n,
        lower_mass_kg,
        upper_mass_kg,
        EARTH_EQUATORIAL_RADIUS_M + positive("upper_altitude_m", upper_altitude_m, "m"),
        nodes,
        length=length,
        gm_m3_s2=gm_m3_s2,
    )
    most = SHOWN if nodes is None and np.any(np.asarray(mass_per_length_kg_m, dtype=float) > 0.0) else None
    return _dataset(hanging, eigenmotions(hanging, gm_m3_s2), most)


def hanging_line(
    length_m,
    mass_per_length_kg_m,
    axial_stiffness_n,
    lower_mass_kg: float,
    upper_mass_kg: float,
    radius_m: float,
    nodes: int | None = None,
    *,
    length: str = "unstretched",
    anchor: Anchor = "upper",
    gm_m3_s2: float = EARTH_GM_M3_S2,
) -> Hanging:
    """The state of rest alone, arguments as of `tether_modes`; `anchor`: what is at radius_m [m] from the Earth's centre."""
    count = _nodes(nodes)
    gm = positive("gm_m3_s2", gm_m3_s2, "m^3/s^2")
    if not GM_BOUNDS[0] <= gm <= GM_BOUNDS[1]:
        bounds = " to ".join(f"{one:g}" for one in GM_BOUNDS)
        raise InputError(f"gm_m3_s2 must be the Earth's, {bounds} m^3/s^2; got {gm:g}. Is it in km^3/s^2? Multiply by 1e9.")
    lower, upper = (
        positive(name, value, "kg", zero=True)
        for name, value in (("lower_mass_kg", lower_mass_kg), ("upper_mass_kg", upper_mass_kg))
    )
    stretches = stretches_of(length_m, mass_per_length_kg_m, axial_stiffness_n, massless=not count)
    if stretches.length.sum() < SHORTEST_M:
        raise InputError(f"length_m must be {SHORTEST_M:g} m or more together; got {stretches.length.sum():g} m.")
    if length not in LENGTHS:
        raise InputError(f'length is "{length}"; {nearest(str(length), LENGTHS)}')
    radius = positive("radius_m", radius_m, "m")
    if count is None and not stretches.linear_mass.any():
        count = 0
    _massive(stretches, lower, upper, count)
    top = radius if anchor == "upper" else radius + float(stretches.length.sum())
    if top - stretches.length.sum() <= EARTH_EQUATORIAL_RADIUS_M:
        raise InputError(
            f"length_m = {stretches.length.sum():g} m from {top - EARTH_EQUATORIAL_RADIUS_M:g} m of altitude reaches the ground. "
            "Are length_m and upper_altitude_m in metres?"
        )
    if length == "unstretched":
        return _hung(stretches, lower, upper, count, radius, anchor, gm_m3_s2)
    return _to_length(stretches, lower, upper, count, radius, anchor, gm_m3_s2)


def _hung(stretches: Stretches, lower: float, upper: float, count: int | None, radius: float, anchor, gm: float) -> Hanging:
    """With the unstretched lengths given."""
    grid = continuum_grid(stretches, lower, upper) if count is None else chain_grid(cut(stretches, count), lower, upper)
    return hang(grid, radius, anchor, gm)


def _to_length(stretches: Stretches, lower: float, upper: float, count: int | None, radius: float, anchor, gm: float) -> Hanging:
    """With the stretched length given: all unstretched lengths are shortened by the same part until it is met."""
    asked = float(stretches.length.sum())
    for _ in range(60):
        hanging = _hung(stretches, lower, upper, count, radius, anchor, gm)
        miss = asked / float(hanging.height[-1])
        stretches = stretches._replace(length=stretches.length * miss)
        if abs(miss - 1.0) < 1e-14:
            break
    return hanging


def _nodes(nodes) -> int | None:
    """A whole number of nodes, or None."""
    if nodes is None:
        return None
    if isinstance(nodes, bool) or not isinstance(nodes, int | np.integer) or not 0 <= nodes <= MOST_NODES:
        raise InputError(f"nodes must be a whole number from 0 to {MOST_NODES}, or None for the continuum; got {nodes!r}.")
    return int(nodes)


def _massive(stretches: Stretches, lower: float, upper: float, count: int | None) -> None:
    """Every point that moves has mass."""
    if not stretches.linear_mass.all():
        for name, mass in (("lower_mass_kg", lower), ("upper_mass_kg", upper)):
            if mass == 0.0:
                raise InputError(f"{name} must be above zero on a line without mass; give mass_per_length_kg_m, or a mass.")
        if count is None:
            raise InputError("mass_per_length_kg_m must be above zero for every material of a continuum; give nodes=0 instead.")


def _dataset(hanging: Hanging, families: Families, most: int | None) -> xr.Dataset:
    """What `tether_modes` returns."""
    import xarray as xr

    grid = hanging.grid
    data = xr.Dataset(
        {
            "orbital_rate": ((), hanging.rate, {"units": "rad s-1", "long_name": "rate of the orbit"}),
            "radius": ("point", hanging.radius, {"units": "m", "long_name": "from the Earth's centre"}),
            "height": ("point", hanging.height, {"units": "m", "long_name": "above the lower end, stretched"}),
            "rest_height": ("point", grid.place, {"units": "m", "long_name": "above the lower end, unstretched"}),
            "mass": ("point", grid.mass, {"units": "kg", "long_name": "mass of each point, bodies included"}),
            "tension": ("station", hanging.tension, {"units": "N", "long_name": "tension at rest"}),
            "station_rest_height": ("station", grid.station, {"units": "m", "long_name": "of the station, unstretched"}),
        }
    )
    for name, motions, first, beside in (
        ("in_plane", families.in_plane, 0, "in_plane_stretch"),
        ("out_of_plane", families.out_of_plane, 0, ""),
        ("along_line", families.along_line, 1, "along_line_sway"),
    ):
        mode = f"{name}_mode"
        rate = motions.rate[:most]
        data.coords[mode] = np.arange(first, first + len(rate))
        words = name.replace("_", " ")
        data[f"{name}_frequency"] = (mode, rate, {"units": "rad s-1", "long_name": f"angular frequency {words}"})
        data[f"{name}_ratio"] = (
            mode,
            rate / hanging.rate,
            {"units": "1", "long_name": f"frequency {words} over the orbital rate"},
        )
        shape = {"units": "1", "long_name": f"displacement {words}, with cos(wt)"}
        data[f"{name}_shape"] = ((mode, "point"), motions.shape[:most], shape)
        if beside:
            coriolis = {"units": "1", "long_name": "displacement in the plane at right angles to it, with sin(wt)"}
            data[beside] = ((mode, "point"), motions.beside[:most], coriolis)
    return data
