"""Which conductors may fail, at which inclinations: every set, over a day of the dipole's field.

A set may fail at an inclination if the rest keeps the plant controllable at every instant looked at. An instant at which
even the whole vehicle is lost (the field along the normal, or none across) says nothing about a set: such instants have
no volume, and sampled ones miss them. What is counted is the share of instants with a margin of 1e-3, and the least margin.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from fieldline.analysis.controllability import THRESHOLD, controllability_now, orbital_scale
from fieldline.cases.afit_1992.earth import ALTITUDE_M, SOURCE, circle, inclinations_of, whole
from fieldline.cases.afit_1992.frozen_model import built, frozen_plant
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.erbs_like import number
from fieldline.errors import InputError

WEAK = 1e-3
MOST_INSTANTS = 2000


def failures(
    inclinations_deg=(0.0, 28.5, 51.6),
    most_lost: int = 4,
    *,
    thruster: bool = True,
    design: int = 2,
    vertical_m: float = 50.0,
    horizontal_m: float = 310.0,
    support_m: float = 50.0,
    arms: str = "centre",
    altitude_m: float = ALTITUDE_M,
    angle_step_deg: float = 72.0,
    node_step_deg: float = 120.0,
):
    """Margins with every set of up to `most_lost` conductors gone, an xarray Dataset over inclination_deg and subset.

    Parameters
    ----------
    inclinations_deg : of the orbits.      thruster, design ... arms : the vehicle; the thruster does not fail.
    angle_step_deg, node_step_deg : of the instants: angle of the field, and longitude of the node from the pole's meridian.

    Returns
    -------
    Dataset: least_margin and good_share (of the instants, with a margin of 1e-3 or more), both over (inclination_deg, subset);
    lost_count (subset); fatal (inclination_deg, subset): 1 where the least margin is under 1e-6 and no smaller set's within
    it already is, so that the fatal sets listed are the smallest.
    """
    settings = dict(locals())
    inclinations = inclinations_of(inclinations_deg)
    orbit, made = circle(altitude_m), built(settings)
    count = len(made.conductors)
    most = whole("most_lost", most_lost, 1, count - 1)
    angle = np.arange(0.0, 360.0, number("angle_step_deg", angle_step_deg, 1.0, 360.0))
    node = np.arange(0.0, 360.0, number("node_step_deg", node_step_deg, 1.0, 360.0))
    if len(angle) * len(node) > MOST_INSTANTS:
        raise InputError(f"{len(angle) * len(node):,} instants are too many; at most {MOST_INSTANTS:,}. Take longer steps.")
    sets = [subset for lost in range(1, most + 1) for subset in combinations(range(count), lost)]
    margins = []
    for inclination in inclinations:
        plant, _ = frozen_plant(made, orbit, (angle[:, None] + 0.0 * node).ravel(), inclination, np.tile(node, len(angle)))
        margins.append([_margin(plant, subset, orbit.mean_motion_rad_s) for subset in sets])
        names = plant.controls
    labels = ["+".join(names[k] for k in subset) for subset in sets]
    return _dataset(inclinations, sets, labels, np.array(margins), settings)


def _margin(plant, subset, mean_motion: float) -> np.ndarray:
    """(instants,) margins without the conductors of a set."""
    kept = [k for k in range(plant.G.shape[-1]) if k not in subset]
    return controllability_now(plant.F, plant.G[..., kept], rate=mean_motion, scale=orbital_scale(mean_motion)).margin


def _dataset(inclinations: np.ndarray, sets: list, labels: list[str], margins: np.ndarray, settings: dict):
    """Margins (inclination, subset, instant) as what is told of them."""
    import xarray as xr

    least = margins.min(axis=2)
    lost = least < THRESHOLD
    fatal = np.zeros_like(lost)
    for k, subset in enumerate(sets):
        within = [j for j, other in enumerate(sets) if set(other) < set(subset)]
        fatal[:, k] = lost[:, k] & ~lost[:, within].any(axis=1)
    over = ("inclination_deg", "subset")
    thruster = "with" if settings["thruster"] else "without"
    return xr.Dataset(
        {
            "least_margin": (over, least, {"units": "1", "long_name": "least margin of control without the set"}),
            "good_share": (over, (margins >= WEAK).mean(axis=2), {"units": "1", "long_name": "instants with a margin of 1e-3"}),
            "fatal": (over, fatal.astype(float), {"units": "1", "long_name": "1 for the smallest sets that are fatal"}),
            "lost_count": ("subset", np.array([len(subset) for subset in sets]), {"units": "1", "long_name": "conductors lost"}),
        },
        coords={"inclination_deg": ("inclination_deg", inclinations, {"units": "deg"}), "subset": labels},
        attrs={
            "title": f"Design {settings['design']} {thruster} thruster: margins with conductors lost",
            "case": "afit_1992_failures",
            "source": f"{SOURCE}, section 4.1.3",
            "settings_json": settings_text(settings),
        },
    )
