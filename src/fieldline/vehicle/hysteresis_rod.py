"""A rod of soft magnetic material that lags behind the field and so takes energy from the rotation."""

from __future__ import annotations

from pydantic import Field, model_validator

from fieldline.records import Record, RecordError
from fieldline.records.values import Direction


class HysteresisRod(Record):
    """A hysteresis rod along one axis of the body, by the loop of its apparent (mounted) material constants."""

    axis_b: Direction = Field(description="axis of the rod, body axes; made a unit vector")
    volume_m3: float = Field(gt=0.0, lt=1.0, description="volume of the material [m^3]")
    saturation_tesla: float = Field(gt=0.0, lt=3.0, description="flux density at saturation [T]")
    coercivity_a_m: float = Field(gt=0.0, description="coercive force: field strength at which the flux density is zero [A/m]")
    remanence_tesla: float = Field(gt=0.0, description="flux density left at zero field strength [T], below saturation")

    @model_validator(mode="after")
    def _loop_closes(self):
        """Remanence below saturation."""
        if self.remanence_tesla >= self.saturation_tesla:
            limit = f"must be less than saturation_tesla, {self.saturation_tesla:g}"
            raise RecordError([("remanence_tesla", f"{limit}; got {self.remanence_tesla:g}")])
        return self
