"""The vehicle of the examples: an empty Space Shuttle tank with towers (appendix D), and what the gravity gradient does to it.

The towers' mass is 6,570 kg, not the printed 6,670; the table of appendix D has l1 and l2 exchanged. Both examples break
the thesis's own rule, C > B > A: one grows in pitch (e-fold in 537 s), the other in roll and yaw (1,281 s).
"""

from __future__ import annotations

import numpy as np

from fieldline.cases.afit_1992.earth import ALTITUDE_M, SOURCE, circle
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.design.tracking_vehicle import TrackingVehicle, tank_with_towers
from fieldline.mechanics.relative_motion import attitude_poles
from fieldline.vehicle.conductor import names_of

AXES = ("x", "y", "z")


def vehicle(
    vertical_m: float = 50.0,
    horizontal_m: float = 310.0,
    *,
    support_m: float = 50.0,
    cross_vertical_m: float = 20.0,
    cross_horizontal_m: float = 20.0,
    design: int = 2,
    arms: str = "centre",
    altitude_m: float = ALTITUDE_M,
    tank_mass_kg: float = 31300.0,
    tower_kg_per_m: float = 7.3,
):
    """Mass properties, poles and conductors as a Dataset.

    Parameters
    ----------
    vertical_m, horizontal_m, support_m, cross_vertical_m, cross_horizontal_m : towers l1, l2, lt, lc1, lc2.
    design : 1, six conductors, or 2, eight.      arms : "centre" as in the thesis, or "hull".
    altitude_m : of the target.      tank_mass_kg, tower_kg_per_m : Mcyl and rho.

    Returns
    -------
    Dataset: mass_kg, tower_mass_kg, inertia_kg_m2 (axis), pole (mode) [1/s], growth_s, stable, ordered (C > B > A) and the
    conductors' length_m, position_b_m, direction_b.
    """
    settings = dict(locals())
    made = tank_with_towers(**{key: value for key, value in settings.items() if key != "altitude_m"})
    orbit = circle(altitude_m)
    return _dataset(made, orbit.mean_motion_rad_s, settings)


def _dataset(made: TrackingVehicle, mean_motion: float, settings: dict):
    """Everything with its units."""
    import xarray as xr

    poles = attitude_poles(mean_motion, made.inertia_kg_m2)
    lengths = np.array([one.length_m for one in made.conductors])
    along = np.array([one.direction_b for one in made.conductors])
    at = np.array([one.position_b_m for one in made.conductors])
    scalars = {
        "mass_kg": (made.mass_kg, "kg", "mass"),
        "tower_mass_kg": (made.tower_mass_kg, "kg", "mass of the towers"),
        "growth_s": (poles.growth_s, "s", "time in which the fastest angle grows e-fold; inf if none does"),
        "stable": (float(poles.stable), "1", "1 if no angle grows by itself"),
        "ordered": (float(poles.ordered), "1", "1 if C > B > A"),
    }
    return xr.Dataset(
        {
            **{name: ((), value, {"units": unit, "long_name": words}) for name, (value, unit, words) in scalars.items()},
            "inertia_kg_m2": ("axis", np.array(made.inertia_kg_m2), {"units": "kg m2", "long_name": "principal moments A, B, C"}),
            "pole_real": ("mode", np.concatenate([poles.pitch, poles.roll_yaw]).real, {"units": "s-1", "long_name": "growth"}),
            "pole_imag": ("mode", np.concatenate([poles.pitch, poles.roll_yaw]).imag, {"units": "rad s-1"}),
            "length_m": ("conductor", lengths, {"units": "m", "long_name": "length of the conductor"}),
            "position_b_m": (("conductor", "axis"), at, {"units": "m", "long_name": "where its force acts", "axes": "b"}),
            "direction_b": (("conductor", "axis"), along, {"units": "1", "long_name": "positive current", "axes": "b"}),
        },
        coords={
            "axis": list(AXES),
            "conductor": names_of(made.conductors),
            "mode": ["pitch", "pitch_also", *(f"roll_yaw_{k}" for k in range(1, 5))],
        },
        attrs={
            "title": f"Tank with towers, {settings['vertical_m']:g} m up and down, {settings['horizontal_m']:g} m along",
            "case": "afit_1992_vehicle",
            "source": f"{SOURCE}, sections 3.3, 3.4 and appendix D",
            "settings_json": settings_text(settings),
            "mean_motion_rad_s": mean_motion,
        },
    )
