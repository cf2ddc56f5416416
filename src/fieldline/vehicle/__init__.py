"""What flies: bodies with their mass, inertia, loads and actuators, and the lines between them. Frozen records only."""

from fieldline.vehicle.conductor import Conductor
from fieldline.vehicle.hysteresis_rod import HysteresisRod
from fieldline.vehicle.line import Line
from fieldline.vehicle.line_circuit import LineCircuit
from fieldline.vehicle.line_heat import LineHeat
from fieldline.vehicle.magnetorquer import Magnetorquer
from fieldline.vehicle.surfaces import Drag, SolarPressure
from fieldline.vehicle.thruster import Thruster
from fieldline.vehicle.user_load import UserLoad
from fieldline.vehicle.vehicle import Vehicle
from fieldline.vehicle.wheel import Wheel

__all__ = [
    "Vehicle",
    "Magnetorquer",
    "Wheel",
    "Thruster",
    "HysteresisRod",
    "Drag",
    "SolarPressure",
    "UserLoad",
    "Line",
    "LineCircuit",
    "LineHeat",
    "Conductor",
]
