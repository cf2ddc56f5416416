"""A coil or rod whose dipole is commanded: torque = dipole x field."""

from __future__ import annotations

from pydantic import Field, model_validator

from fieldline.records import Record, RecordError
from fieldline.records.names import Name
from fieldline.records.values import Direction


class Magnetorquer(Record):
    """A magnetic torquer along one axis of the body."""

    name: Name = Field(default="", description="name in results; by default torquer_1, torquer_2, ...")
    axis_b: Direction = Field(description="axis of the dipole, body axes; made a unit vector")
    moment_max_a_m2: float = Field(gt=0.0, description="largest dipole, either sign [A m^2]")
    time_constant_s: float = Field(
        default=0.0, ge=0.0, description="first-order lag of the dipole behind its command [s]; 0: none"
    )
    quantum_a_m2: float = Field(default=0.0, ge=0.0, description="step of the command [A m^2]; 0: continuous")

    @model_validator(mode="after")
    def _steps_fit(self):
        """A quantum above the largest dipole could command nothing."""
        if self.quantum_a_m2 > self.moment_max_a_m2:
            limit = f"must be at most moment_max_a_m2, {self.moment_max_a_m2:g}"
            raise RecordError([("quantum_a_m2", f"{limit}; got {self.quantum_a_m2:g}")])
        return self
