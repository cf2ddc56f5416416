"""A reaction or momentum wheel: it takes up momentum about its axis and gives the body the opposite."""

from __future__ import annotations

from pydantic import Field, model_validator

from fieldline.records import Record, RecordError
from fieldline.records.names import Name
from fieldline.records.values import Direction


class Wheel(Record):
    """A wheel fixed to one axis of the body."""

    name: Name = Field(default="", description="name in results; by default wheel_1, wheel_2, ...")
    axis_b: Direction = Field(description="spin axis, body axes; made a unit vector")
    momentum_n_m_s: float = Field(default=0.0, description="momentum about the axis at the start [N m s], relative to the body")
    momentum_max_n_m_s: float = Field(gt=0.0, description="largest momentum, either sign [N m s]; the wheel is saturated there")
    torque_max_n_m: float = Field(gt=0.0, description="largest motor torque, either sign [N m]")
    quantum_n_m: float = Field(default=0.0, ge=0.0, description="step of the torque command [N m]; 0: continuous")

    @model_validator(mode="after")
    def _limits_hold(self):
        """The start and the quantum lie within the limits."""
        found = []
        if abs(self.momentum_n_m_s) > self.momentum_max_n_m_s:
            limit = f"must lie within +-momentum_max_n_m_s, {self.momentum_max_n_m_s:g}"
            found.append(("momentum_n_m_s", f"{limit}; got {self.momentum_n_m_s:g}"))
        if self.quantum_n_m > self.torque_max_n_m:
            found.append(("quantum_n_m", f"must be at most torque_max_n_m, {self.torque_max_n_m:g}; got {self.quantum_n_m:g}"))
        if found:
            raise RecordError(found)
        return self
