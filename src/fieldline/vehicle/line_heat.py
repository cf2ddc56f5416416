"""What warms and cools a line, and what its temperature changes."""

from __future__ import annotations

from pydantic import Field

from fieldline.records import Record


class LineHeat(Record):
    """Temperature of each segment: sunlight, the Earth's infrared and albedo, air, current, radiation."""

    absorptivity: float = Field(gt=0.0, le=1.0, description="part of sunlight that the surface takes in [-]")
    emissivity: float = Field(gt=0.0, le=1.0, description="of the surface in the infrared [-]")
    specific_heat_j_kg_k: float = Field(gt=0.0, description="of the line's material [J/kg/K]")
    expansion_1_k: float = Field(
        default=0.0, ge=-1e-3, le=1e-3, description="growth of the unstretched length with temperature, per kelvin [1/K]"
    )
    reference_temperature_k: float = Field(
        default=293.15, gt=0.0, le=2000.0, description="temperature at which the unstretched length holds [K]"
    )
    start_temperature_k: float = Field(default=293.15, gt=0.0, le=2000.0, description="temperature at the start [K]")

    @property
    def growth_at_start(self) -> float:
        """Unstretched length at the start over that at the reference temperature [-]."""
        return 1.0 + self.expansion_1_k * (self.start_temperature_k - self.reference_temperature_k)
