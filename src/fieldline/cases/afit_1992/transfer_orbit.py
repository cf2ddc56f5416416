"""The climb that sizes the vertical conductors (section 5.1), and the length of the horizontal ones (section 5.4.1).

Printed: 1.75 N; 620 m (as "6S0"); 101 V; 325 kW at 20 ohm; 44 kW at 1 ohm, which is 29.0 (44.7 belongs to 2.05 ohm).
"""

from __future__ import annotations

import numpy as np

from fieldline.cases.afit_1992.earth import EARTH_RADIUS_M, GM_M3_S2, SOURCE
from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.erbs_like import number
from fieldline.constants import SECONDS_PER_DAY
from fieldline.design.conductor import ConductorDesign, design_conductor, farthest_hold, holding_length, spiral_radius

POINTS = 301
HOLD = {"current_a": 125.0, "field_tesla": 2.6e-5, "mean_motion_rad_s": 1.28e-6**0.5}
TOWERS = {"body_mass_kg": 31300.0, "kg_per_m": 7.3, "other_towers_m": 50.0 + 50.0 + 20.0 + 20.0}
SCALARS = {
    "thrust_n": ("N", "thrust along the velocity"),
    "length_m": ("m", "length of both vertical conductors"),
    "induced_voltage_v": ("V", "induced voltage in the low orbit"),
    "conductor_resistance_ohm": ("ohm", "resistance of the conductor"),
    "wire_field_tesla": ("T", "field of the current at its neighbour"),
    "wire_field_share": ("1", "the same over the Earth's"),
}


def transfer(
    mass_kg: float = 50_000.0,
    low_altitude_m: float = 300e3,
    high_altitude_m: float = 460e3,
    days: float = 30.0,
    *,
    current_a: float = 125.0,
    field_tesla: float = 2.26e-5,
    neighbour_m: float = 5.0,
):
    """The climb of (5.1) over `seconds`, and its conductor, voltage and supply as scalars.

    Returns
    -------
    Dataset: altitude_m over seconds; thrust_n, length_m, induced_voltage_v, power_w and efficiency (plasma: 1 and 20 ohm),
    wire_field_tesla; hold_length_m (above_m) of the horizontal conductors of the R-BAR formula, farthest_hold_m.
    """
    settings = dict(locals())
    number("days", days, 1e-3, 1e6)
    found = design_conductor(
        mass_kg=mass_kg,
        low_altitude_m=low_altitude_m,
        high_altitude_m=high_altitude_m,
        transfer_s=days * SECONDS_PER_DAY,
        current_a=current_a,
        field_tesla=field_tesla,
        neighbour_m=neighbour_m,
        gm_m3_s2=GM_M3_S2,
        earth_radius_m=EARTH_RADIUS_M,
    )
    return _dataset(found, settings)


def _dataset(found: ConductorDesign, settings: dict):
    """The climb and the numbers, with their units."""
    import xarray as xr

    seconds = np.linspace(0.0, settings["days"] * SECONDS_PER_DAY, POINTS)
    low = EARTH_RADIUS_M + settings["low_altitude_m"]
    altitude = spiral_radius(low, found.thrust_n / settings["mass_kg"], seconds, GM_M3_S2) - EARTH_RADIUS_M
    above = np.array([50.0, 100.0])
    lengths = [holding_length(x, **HOLD, **TOWERS) for x in above]
    bound = farthest_hold(**HOLD, kg_per_m=TOWERS["kg_per_m"])
    return xr.Dataset(
        {
            "altitude_m": ("seconds", altitude, {"units": "m", "long_name": "height over the equator"}),
            **{name: ((), getattr(found, name), {"units": u, "long_name": w}) for name, (u, w) in SCALARS.items()},
            "power_w": ("plasma_ohm", np.array(found.power_w), {"units": "W", "long_name": "power of the supply"}),
            "efficiency": ("plasma_ohm", np.array(found.efficiency), {"units": "1", "long_name": "work on the orbit over it"}),
            "hold_length_m": ("above_m", np.array(lengths), {"units": "m", "long_name": "each horizontal conductor of a hold"}),
            "farthest_hold_m": ((), bound, {"units": "m", "long_name": "from where no length is enough"}),
        },
        coords={"seconds": ("seconds", seconds, {"units": "s"}), "plasma_ohm": [1.0, 20.0], "above_m": above},
        attrs={
            "title": f"{settings['mass_kg'] / 1e3:g} t from {settings['low_altitude_m'] / 1e3:g} to "
            f"{settings['high_altitude_m'] / 1e3:g} km in {settings['days']:g} days",
            "case": "afit_1992_transfer",
            "source": f"{SOURCE}, chapter 5 and appendix C",
            "settings_json": settings_text(settings),
            "cautions": " ".join(found.cautions),
        },
    )
