"""A thruster: a force along a fixed direction at a fixed point of the body, on or off in part of a control period."""

from __future__ import annotations

from pydantic import Field

from fieldline.records import Record
from fieldline.records.names import Name
from fieldline.records.values import Direction, Vector


class Thruster(Record):
    """A thruster; a command of 0 to 1 is the part of the control period in which it fires."""

    name: Name = Field(default="", description="name in results; by default thruster_1, thruster_2, ...")
    position_b_m: Vector = Field(description="point at which the force acts, from the centre of mass, body axes [m]")
    direction_b: Direction = Field(description="direction of the force on the body (opposite to the jet), body axes")
    force_n: float = Field(gt=0.0, description="force while it fires [N]")
    specific_impulse_s: float = Field(default=70.0, gt=0.0, lt=100_000.0, description="specific impulse [s]; 70: cold nitrogen")
    minimum_on_time_s: float = Field(default=0.0, ge=0.0, description="shortest firing [s]; shorter commands do nothing")
