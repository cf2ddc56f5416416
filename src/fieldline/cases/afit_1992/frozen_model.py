"""The linear plant of an instant: F, G, H of chapter 4.

The printed F has 3 n/(2 r0) from x' to p3'', from a rate of axes c that is not theirs; it is left out here (`printed=True`
puts it in; it moves no pole). The angle of the field is the thesis's u - thetag - lambda in an equatorial orbit.
"""

from __future__ import annotations

import numpy as np

from fieldline.analysis.controllability import controllability_now, orbital_scale, steady_state
from fieldline.cases.afit_1992.earth import ALTITUDE_M, FIELD_ANGLE_DEG, SOURCE, Circle, circle, frozen_field_h
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.erbs_like import number
from fieldline.control.electrodynamic import Plant, electrodynamic_plant
from fieldline.design.tracking_vehicle import TrackingVehicle, tank_with_towers
from fieldline.mechanics.relative_motion import OUTPUTS, STATES


def linear_model(
    design: int = 2,
    thruster: bool = True,
    *,
    field_angle_deg: float = FIELD_ANGLE_DEG,
    inclination_deg: float = 0.0,
    node_deg: float = 0.0,
    vertical_m: float = 50.0,
    horizontal_m: float = 310.0,
    support_m: float = 50.0,
    arms: str = "centre",
    altitude_m: float = ALTITUDE_M,
    printed: bool = False,
):
    """F (12, 12), G (12, m), H (6, 12) with their labels, and whether they are controllable and can be held.

    Parameters
    ----------
    design, thruster, vertical_m, horizontal_m, support_m, arms : the vehicle; see `vehicle`.
    field_angle_deg : u - thetag - lambda.      inclination_deg, node_deg : of the orbit; node from the austral pole's meridian.
    printed : with the term of the print that is no physics.

    Returns
    -------
    Dataset: F, G, H, field_h [T], pole [1/s]; margin (of `analysis.controllability_now`), steady_margin.
    """
    settings = dict(locals())
    for name, angle in (("field_angle_deg", field_angle_deg), ("node_deg", node_deg)):
        number(name, angle, -1e6, 1e6)
    orbit, made = circle(altitude_m), built(settings)
    plant, field_h = frozen_plant(made, orbit, field_angle_deg, inclination_deg, node_deg)
    if printed:
        plant.F[11, 1] = 1.5 * orbit.mean_motion_rad_s / orbit.radius_m
    return _dataset(plant, field_h, orbit, settings)


def built(settings: dict) -> TrackingVehicle:
    """The vehicle of a case's settings."""
    keys = ("design", "thruster", "vertical_m", "horizontal_m", "support_m", "arms")
    return tank_with_towers(**{key: settings[key] for key in keys if key in settings})


def frozen_plant(
    made: TrackingVehicle, orbit: Circle, field_angle_deg=FIELD_ANGLE_DEG, inclination_deg: float = 0.0, node_deg=0.0
) -> tuple[Plant, np.ndarray]:
    """The plant at an angle of the field, or at several, and that field (..., 3) [T]; angle and node broadcast."""
    number("inclination_deg", inclination_deg, 0.0, 180.0)
    field_h = frozen_field_h(orbit, field_angle_deg, inclination_deg, node_deg)
    plant = electrodynamic_plant(
        made,
        field_h,
        mean_motion_rad_s=orbit.mean_motion_rad_s,
        radius_m=orbit.radius_m,
        mass_kg=made.mass_kg,
        inertia_kg_m2=made.inertia_kg_m2,
    )
    return plant, field_h


def _dataset(plant: Plant, field_h: np.ndarray, orbit: Circle, settings: dict):
    """Matrices with their labels, and the verdicts."""
    import xarray as xr

    scales = {"rate": orbit.mean_motion_rad_s, "scale": orbital_scale(orbit.mean_motion_rad_s)}
    now, held = controllability_now(plant.F, plant.G, **scales), steady_state(plant.F, plant.G, plant.H, **scales)
    poles = np.linalg.eigvals(plant.F)
    scalars = {
        "margin": (now.margin, "smallest singular value of [s I - F, G], scaled; above 1e-6: controllable"),
        "steady_margin": (held.margin, "smallest over largest singular value of [[F, G], [H, 0]], scaled; zero: not held"),
    }
    return xr.Dataset(
        {
            "F": (("state", "state_also"), plant.F, {"long_name": "motion by itself, SI"}),
            "G": (("state", "control"), plant.G, {"long_name": "effect of amperes and newtons, SI"}),
            "H": (("output", "state_also"), plant.H, {"long_name": "places and angles"}),
            "field_h": ("axis", field_h, {"units": "T", "long_name": "field at the target", "axes": "h"}),
            "pole_real": ("mode", poles.real, {"units": "s-1"}),
            "pole_imag": ("mode", poles.imag, {"units": "rad s-1"}),
            **{name: ((), float(value), {"units": "1", "long_name": words}) for name, (value, words) in scalars.items()},
        },
        coords={
            "state": list(STATES),
            "state_also": list(STATES),
            "control": list(plant.controls),
            "output": list(OUTPUTS),
            "axis": list("xyz"),
        },
        attrs={
            "title": f"Design {settings['design']} at a field's angle of {settings['field_angle_deg']:g} deg",
            "case": "afit_1992_model",
            "source": f"{SOURCE}, chapter 4 and appendix F",
            "settings_json": settings_text(settings),
            "mean_motion_rad_s": orbit.mean_motion_rad_s,
        },
    )
