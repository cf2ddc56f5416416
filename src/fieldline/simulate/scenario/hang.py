"""How a body hangs on a line at the start, and what runs along a line at the start."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from fieldline.records import Record, RecordError


class Hang(Record):
    """A body at the end of a straight, taut line whose other end is on an earlier body, at rest or swinging as a rod."""

    line: str = Field(default="", description="name of the line; may be left out where one line ends on this body")
    upward: bool = Field(default=False, description="whether it is above the other body, away from the Earth")
    in_plane_deg: float = Field(
        default=0.0,
        gt=-90.0,
        lt=90.0,
        description="angle from the vertical in the plane of the orbit, its lower end ahead: positive [deg]",
    )
    out_of_plane_deg: float = Field(
        default=0.0, gt=-90.0, lt=90.0, description="angle out of it, lower end against the orbit normal positive [deg]"
    )
    in_plane_rate_deg_s: float = Field(default=0.0, description="rate of in_plane_deg [deg/s]")
    out_of_plane_rate_deg_s: float = Field(default=0.0, description="rate of out_of_plane_deg [deg/s]")
    balanced: bool = Field(
        default=True,
        description="whether the other body's speed is changed by what a state of rest asks of it, so that a circular orbit is "
        "one of the whole; false: that body keeps its orbit as given",
    )


class LineStart(Record):
    """Waves laid over a straight line at the start: a skiprope or a swing, and a pulse along it."""

    skiprope_amplitude_m: float = Field(default=0.0, ge=0.0, description="largest deflection from the straight line [m]")
    skiprope_phase_deg: float = Field(default=0.0, description="its angle from the plane of the orbit [deg]")
    skiprope_sense: Literal["right-handed", "left-handed", "plane"] = Field(
        default="right-handed", description='round the direction down the line, or "plane": a swing at that angle'
    )
    skiprope_mode: int = Field(default=1, ge=1, description="half waves along the line")
    pulse_amplitude_m: float = Field(default=0.0, description="largest displacement along the line, towards to_body positive [m]")
    pulse_middle: float = Field(
        default=0.5, ge=0.0, le=1.0, description="where it is, as part of the length from from_body on [-]"
    )
    pulse_width_m: float | None = Field(default=None, gt=0.0, description="its width [m]; a tenth of the line by default")
    pulse_towards: Literal["a", "b", "both"] = Field(
        default="both", description='where it runs: "a" to from_body, "b" to to_body, "both": two halves'
    )

    @model_validator(mode="after")
    def _says_something(self):
        """A width belongs to a pulse."""
        if self.pulse_width_m is not None and self.pulse_amplitude_m == 0.0:
            raise RecordError([("pulse_width_m", "has a meaning with pulse_amplitude_m alone; give that too")])
        return self
