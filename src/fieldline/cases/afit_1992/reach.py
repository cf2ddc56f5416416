"""What the conductors reach around the orbit (section 4.1.3), and which of them may fail.

The thesis finds design 1 lost at odd quarter turns of an equatorial orbit, design 2 never; any three of design 2's eight
conductors may go. The first holds only where B = C (l2 = l3); of the sets of four, the two that leave no conductor along x,
or none along y, are lost.
"""

from __future__ import annotations

import numpy as np

from fieldline.analysis.controllability import controllability_now, controllability_over, orbital_scale, removable, words_of
from fieldline.cases.afit_1992.earth import ALTITUDE_M, SOURCE, SPIN_RAD_S, Circle, circle
from fieldline.cases.afit_1992.frozen_model import built, frozen_plant
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.erbs_like import number
from fieldline.control.electrodynamic import Plant
from fieldline.design.tracking_vehicle import TrackingVehicle
from fieldline.errors import InputError
from fieldline.mechanics.relative_motion import STATES

MOST_LOST = 7
RETURNED = 1e-3  # margin from which a motion counts as within reach again
STEP_S = 60.0


def controllability(
    inclination_deg: float = 0.0,
    design: int = 2,
    thruster: bool = True,
    *,
    node_deg: float = 0.0,
    vertical_m: float = 50.0,
    horizontal_m: float = 310.0,
    support_m: float = 50.0,
    arms: str = "centre",
    altitude_m: float = ALTITUDE_M,
    step_deg: float = 5.0,
    lost: int = 0,
):
    """Controllability around one orbit, with the field's node held (a day moves it by a turn), as a Dataset over field_angle_deg.

    Parameters
    ----------
    inclination_deg, node_deg : of the orbit; node from the austral pole's meridian.      design ... arms : the vehicle.
    step_deg : between instants.      lost : if 1 or more, every set of so many conductors is taken away in turn.

    Returns
    -------
    Dataset: margin, input_rank, input_least (of the scaled G's singular values), and of the orbit as a whole the Gramian's
    orbit_margin; with `lost`: subset_margin over subset, the least over the orbit.
    """
    settings = dict(locals())
    number("node_deg", node_deg, -1e6, 1e6)
    orbit, made = circle(altitude_m), built(settings)
    angles = np.arange(0.0, 360.0, number("step_deg", step_deg, 0.1, 90.0))
    plant, _ = frozen_plant(made, orbit, angles, inclination_deg, node_deg)
    if isinstance(lost, bool) or not isinstance(lost, int) or not 0 <= lost <= min(MOST_LOST, len(made.conductors) - 1):
        raise InputError(f"lost must be a number of conductors, 0 to {min(MOST_LOST, len(made.conductors) - 1)}; got {lost!r}.")
    return _dataset(made, plant, orbit, angles, settings)


def refuse_uncontrollable(
    made: TrackingVehicle, orbit: Circle, field_angle_deg: float, inclination_deg: float, node_deg: float
) -> None:
    """InputError where the frozen plant has a motion out of reach: which, why, and when in the orbit it returns."""
    plant, field_h = frozen_plant(made, orbit, field_angle_deg, inclination_deg, node_deg)
    scales = {"rate": orbit.mean_motion_rad_s, "scale": orbital_scale(orbit.mean_motion_rad_s)}
    now = controllability_now(plant.F, plant.G, **scales)
    if now.controllable:
        return
    part, whole = np.abs(field_h), float(np.linalg.norm(field_h))
    weak = [name for name, size in zip(("up", "along the track", "across the orbit"), part, strict=True) if size < 1e-6 * whole]
    why = f"the field has no part {' or '.join(weak)} here" if weak else "the conductors' arms and the field leave it out"
    seconds = np.arange(STEP_S, 2.0 * np.pi / SPIN_RAD_S, STEP_S)
    node = node_deg - np.degrees(SPIN_RAD_S * seconds)
    angle = field_angle_deg + np.degrees((orbit.mean_motion_rad_s - SPIN_RAD_S) * seconds)
    later = frozen_plant(made, orbit, angle, inclination_deg, node)[0]
    back = np.flatnonzero(controllability_now(later.F, later.G, **scales).margin > RETURNED)
    when = "it does not return within a day"
    if len(back):
        when = f"its margin is back to {RETURNED:g} after {seconds[back[0]]:.0f} s, as orbit and Earth turn on"
    raise InputError(
        f"not controllable at a field's angle of {field_angle_deg:g} deg: the motion in {words_of(now.motion, STATES)} cannot be "
        f"reached (margin {float(now.margin):.1e}), because {why}; {when}."
    )


def _dataset(made: TrackingVehicle, plant: Plant, orbit: Circle, angles: np.ndarray, settings: dict):
    """Margins over the angle and over the subsets."""
    import xarray as xr

    n = orbit.mean_motion_rad_s
    scales = {"rate": n, "scale": orbital_scale(n)}
    now = controllability_now(plant.F, plant.G, **scales)
    rank = (now.input_values > 1e-10 * now.input_values[:, :1]).sum(axis=1)
    whole = controllability_over(plant.F, plant.G, 2.0 * np.pi / (n - SPIN_RAD_S), **scales)
    variables = {
        "margin": ("field_angle_deg", now.margin, {"units": "1", "long_name": "smallest singular value of [s I - F, G]"}),
        "input_rank": ("field_angle_deg", rank, {"units": "1", "long_name": "rank of G"}),
        "input_least": ("field_angle_deg", now.input_values[:, 5] / now.input_values[:, 0], {"units": "1"}),
        "orbit_margin": ((), whole.margin, {"units": "1", "long_name": "least over greatest reach in an orbit"}),
    }
    coords: dict = {"field_angle_deg": ("field_angle_deg", angles, {"units": "deg"})}
    if settings["lost"]:
        found = removable(plant.F, plant.G, settings["lost"], of=range(len(made.conductors)), **scales)
        variables["subset_margin"] = ("subset", np.array([margin for _, margin in found]), {"units": "1"})
        coords["subset"] = ["+".join(plant.controls[k] for k in subset) for subset, _ in found]
    thruster = "with" if settings["thruster"] else "without"
    return xr.Dataset(
        variables,
        coords=coords,
        attrs={
            "title": f"Design {settings['design']} {thruster} thruster at {settings['inclination_deg']:g} deg: margin of control",
            "case": "afit_1992_controllability",
            "source": f"{SOURCE}, section 4.1.3",
            "settings_json": settings_text(settings),
            "threshold": 1e-6,
        },
    )
