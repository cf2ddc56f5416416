"""The field in the target's axes over two sidereal days (appendix A), by the thesis's dipole and by IGRF-14.

Argument, node and Greenwich's angle are zero at the start, as in the thesis; the orbit does not precess. IGRF-14 is taken
at one date, the thesis's: its change over two days is nothing, its change since then moves the poles by three degrees.
"""

from __future__ import annotations

import numpy as np

from fieldline.cases.afit_1992.earth import ALTITUDE_M, POLE_LONGITUDE_DEG, SOURCE, SPIN_RAD_S, circle, day_of, direction_h
from fieldline.cases.ames_1961.dipole_field import settings_text, times
from fieldline.cases.erbs_like import number
from fieldline.environment.orbit_field import field_on_orbit_h
from fieldline.environment.orbital_dipole import orbit_field_h

INCLINATIONS_DEG = (0.0, 5.0, 11.5, 28.5, 60.0, 78.5, 90.0)
TWO_DAYS_S = 172_328.0
DATE = "1992-12-01"  # the thesis's


def field(
    inclination_deg: float = 28.5,
    *,
    altitude_m: float = ALTITUDE_M,
    duration_s: float = TWO_DAYS_S,
    step_s: float = 60.0,
    model: str = "IGRF-14",
    date: str = DATE,
):
    """The dipole and a model of the real field along the orbit, as a Dataset over `seconds`.

    Parameters
    ----------
    inclination_deg, altitude_m : of the circular orbit.      duration_s, step_s : what is drawn.
    model, date : of the field beside the dipole; see `fl.field_model`.

    Returns
    -------
    Dataset: dipole_h and model_h [T], axes h; the parts in the orbit's plane and across it of each; difference_rms.
    """
    number("inclination_deg", inclination_deg, 0.0, 180.0)
    settings = dict(locals())
    seconds, orbit = times(duration_s, step_s), circle(altitude_m)
    argument, node = np.degrees(orbit.mean_motion_rad_s * seconds), -np.degrees(SPIN_RAD_S * seconds)
    dipole_h = orbit_field_h(direction_h(inclination_deg, argument, node - POLE_LONGITUDE_DEG), orbit.strength_tesla)
    return _dataset(seconds, dipole_h, model_field_h(inclination_deg, argument, node, orbit.radius_m, model, date), settings)


def model_field_h(inclination_deg, argument_deg, node_longitude_deg, radius_m: float, model: str, date: str) -> np.ndarray:
    """(..., 3) [T] in axes h of a model of the field, at an argument of latitude and a node's longitude (they broadcast)."""
    angles = (np.radians(angle) for angle in (inclination_deg, argument_deg, node_longitude_deg))
    return field_on_orbit_h(radius_m, *angles, day_of(date), model)


def _dataset(seconds: np.ndarray, dipole_h: np.ndarray, model_h: np.ndarray, settings: dict):
    """The signals with their units."""
    import xarray as xr

    variables = {}
    for name, values in (("dipole", dipole_h), ("model", model_h)):
        words = {"dipole": "the thesis's dipole", "model": settings["model"]}[name]
        variables[f"{name}_h"] = (("seconds", "axis"), values, {"units": "T", "long_name": words, "axes": "h"})
        in_plane = np.hypot(values[:, 0], values[:, 1])
        variables[f"{name}_in_plane"] = ("seconds", in_plane, {"units": "T", "long_name": f"in the orbit's plane, {words}"})
    apart = np.linalg.norm(model_h - dipole_h, axis=1)
    size = np.sqrt((dipole_h**2).sum(axis=1).mean())
    return xr.Dataset(
        variables,
        coords={"seconds": ("seconds", seconds, {"units": "s"}), "axis": list("xyz")},
        attrs={
            "title": f"Field in the target's axes, inclination {settings['inclination_deg']:g} deg",
            "case": "afit_1992_field",
            "source": f"{SOURCE}, section 3.2 and appendix A",
            "settings_json": settings_text(settings),
            "difference_rms": float(np.sqrt((apart**2).mean()) / size),
            "difference_most": float(apart.max() / size),
        },
    )
