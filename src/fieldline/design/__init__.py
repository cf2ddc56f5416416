"""Design of what steers by the field: coils in air, rods with a core, their wire; conductors, and vehicles that carry them."""

from fieldline.design.coil_design import CoilDesign, design_coil
from fieldline.design.conductor import ConductorDesign, design_conductor
from fieldline.design.tracking_vehicle import TrackingVehicle, tank_with_towers
from fieldline.design.wire import CONDUCTORS, gauge_table

__all__ = [
    "design_coil",
    "CoilDesign",
    "gauge_table",
    "CONDUCTORS",
    "design_conductor",
    "ConductorDesign",
    "tank_with_towers",
    "TrackingVehicle",
]
