"""What a design is judged by: Floquet multipliers, margins, periodic regulators with their residual and cost, controllability."""

from fieldline.analysis.controllability import controllability_now, controllability_over, removable, steady_state
from fieldline.analysis.floquet import characteristic_exponents, floquet_multipliers, monodromy
from fieldline.analysis.margins import frozen_margins, guaranteed, periodic_margins
from fieldline.analysis.periodic_riccati import periodic_regulator

__all__ = [
    "periodic_regulator",
    "frozen_margins",
    "periodic_margins",
    "guaranteed",
    "monodromy",
    "floquet_multipliers",
    "characteristic_exponents",
    "controllability_now",
    "controllability_over",
    "removable",
    "steady_state",
]
