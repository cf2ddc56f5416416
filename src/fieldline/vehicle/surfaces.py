"""What air and light push on: a constant area with a centre of pressure."""

from __future__ import annotations

from pydantic import Field

from fieldline.records import Record
from fieldline.records.values import Vector

ORIGIN = (0.0, 0.0, 0.0)


class Drag(Record):
    """Aerodynamic drag on a constant area: force = 1/2 density speed^2 drag_coefficient area, against the relative wind."""

    area_m2: float = Field(gt=0.0, description="area that meets the flow [m^2]")
    drag_coefficient: float = Field(default=2.2, gt=0.0, le=10.0, description="drag coefficient [-]")
    center_of_pressure_b_m: Vector = Field(
        default=ORIGIN, description="where the drag acts, from the centre of mass, body axes [m]"
    )


class SolarPressure(Record):
    """Pressure of sunlight on a constant area that faces the Sun: none in the Earth's shadow."""

    area_m2: float = Field(gt=0.0, description="area that faces the Sun [m^2]")
    reflectivity_coefficient: float = Field(
        default=1.3, ge=0.0, le=2.0, description="C_r: 1 where all light is absorbed, 2 where it is all thrown back [-]"
    )
    center_of_pressure_b_m: Vector = Field(
        default=ORIGIN, description="where the light pushes, from the centre of mass, body axes [m]"
    )
