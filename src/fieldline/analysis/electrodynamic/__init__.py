"""Lines with current: when the field does not turn them, how it shakes them otherwise, how fast it brings them down.

balance      current's centroid, end masses of a self-balanced line, the dimensionless torque
libration    equations of a rigid line with current, periodic solution, Floquet multipliers
decay        electrodynamic drag of a bare line over orbit and day, rate of descent
"""

from fieldline.analysis.electrodynamic.balance import balanced_mass, bare_centroid, current_centroid, torque_ratio
from fieldline.analysis.electrodynamic.decay import bare_decay, descent_time
from fieldline.analysis.electrodynamic.libration import libration_multipliers, libration_rates, periodic_libration

__all__ = [
    "current_centroid",
    "bare_centroid",
    "balanced_mass",
    "torque_ratio",
    "libration_rates",
    "periodic_libration",
    "libration_multipliers",
    "bare_decay",
    "descent_time",
]
