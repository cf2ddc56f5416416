"""What a design is judged by: Floquet multipliers, periodic regulators with their residual and cost, controllability."""

from fieldline.analysis.controllability import controllability_now, controllability_over, removable, steady_state
from fieldline.analysis.floquet import characteristic_exponents, floquet_multipliers, monodromy
from fieldline.analysis.periodic_riccati import periodic_regulator

__all__ = [
    "periodic_regulator",
    "monodromy",
    "floquet_multipliers",
    "characteristic_exponents",
    "controllability_now",
    "controllability_over",
    "removable",
    "steady_state",
]
