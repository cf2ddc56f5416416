"""A spinning subsatellite that leans against its tether: where it can stay, whether it does, and how it moves.

configuration   the stationary angles (16) to (26) of the 1982 study, for any mass properties
stability       the linear motion about them (37), its right characteristic equation, maps
motion          the whole motion of the axis under the tether's pull, and its two integrals
"""

from fieldline.analysis.spinning_subsatellite.configuration import (
    SpinningSubsatellite,
    first_order_angles,
    four_angle_margin,
    spin_for_angle,
    stationary_angles,
)
from fieldline.analysis.spinning_subsatellite.motion import axis_motion, jacobi_integral
from fieldline.analysis.spinning_subsatellite.stability import (
    characteristic_coefficients,
    critical_angle,
    critical_spin,
    growth_rate,
    kind_of,
    stability_map,
)

__all__ = [
    "SpinningSubsatellite",
    "spin_for_angle",
    "stationary_angles",
    "first_order_angles",
    "four_angle_margin",
    "characteristic_coefficients",
    "growth_rate",
    "kind_of",
    "critical_angle",
    "critical_spin",
    "stability_map",
    "axis_motion",
    "jacobi_integral",
]
