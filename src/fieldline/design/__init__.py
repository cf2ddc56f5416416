"""Design of what steers by the field: coils in air, rods with a core, their wire."""

from fieldline.design.coil_design import CoilDesign, design_coil
from fieldline.design.wire import CONDUCTORS, gauge_table

__all__ = ["design_coil", "CoilDesign", "gauge_table", "CONDUCTORS"]
