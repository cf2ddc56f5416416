"""An event: what is watched during a run, and whether it ends the run."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from fieldline.records import Record, RecordError
from fieldline.records.names import Name
from fieldline.vehicle.user_load import FunctionName

THRESHOLDS = {"eclipse": None, "altitude": "altitude_km", "rate": "rate_deg_s", "user": "function"}


class Event(Record):
    """The times at which a quantity crosses its threshold are found and kept."""

    kind: Literal["eclipse", "altitude", "rate", "user"] = Field(
        description='"eclipse": half of the Sun is hidden; "altitude", "rate": a threshold; "user": a function changes its sign'
    )
    name: Name = Field(default="", description="name in results; its kind by default")
    body: str = Field(default="", description="name of the body; the first by default")
    altitude_km: float | None = Field(default=None, ge=0.0, description='threshold of kind = "altitude", over the ellipsoid [km]')
    rate_deg_s: float | None = Field(
        default=None, gt=0.0, description='threshold of kind = "rate", size of the angular rate [deg/s]'
    )
    function: FunctionName | None = Field(default=None, description='kind = "user": "file.py:function" or "module:function"')
    parameters: dict[str, float] = Field(default={}, description="numbers handed to the function as an array, in this order")
    direction: Literal["both", "rising", "falling"] = Field(default="both", description="which crossings count")
    stop: bool = Field(default=False, description="whether the run ends at the first crossing")

    @model_validator(mode="after")
    def _one_threshold(self):
        """The threshold of the kind, and no other."""
        needed = THRESHOLDS[self.kind]
        found = []
        for key in filter(None, THRESHOLDS.values()):
            given = getattr(self, key) is not None
            if key == needed and not given:
                found.append((key, f'is missing: kind = "{self.kind}" needs it'))
            if key != needed and given:
                found.append((key, f'has no meaning for kind = "{self.kind}"; leave it out'))
        if self.parameters and self.kind != "user":
            found.append(("parameters", f'has no meaning for kind = "{self.kind}"; leave it out'))
        if found:
            raise RecordError(found)
        return self
