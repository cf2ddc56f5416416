"""A massless line between points of two bodies: it pulls where it is stretched, and never pushes."""

from __future__ import annotations

from pydantic import Field

from fieldline.records import Record
from fieldline.records.names import Name
from fieldline.records.values import Vector

ORIGIN = (0.0, 0.0, 0.0)


class Line(Record):
    """A visco-elastic line: tension = stiffness strain + damping strain_rate where both stretch and tension are positive."""

    name: Name = Field(default="", description="name in results; by default line_1, line_2, ...")
    from_body: str = Field(min_length=1, description="name of the body at one end")
    from_point_b_m: Vector = Field(default=ORIGIN, description="attachment on it, from its centre of mass, its body axes [m]")
    to_body: str = Field(min_length=1, description="name of the body at the other end")
    to_point_b_m: Vector = Field(default=ORIGIN, description="attachment on it, from its centre of mass, its body axes [m]")
    rest_length_m: float = Field(gt=0.0, description="length without tension [m]")
    stiffness_n: float = Field(gt=0.0, description="axial stiffness, Young's modulus times cross-section: tension per strain [N]")
    damping_n_s: float = Field(default=0.0, ge=0.0, description="axial damping: tension per rate of strain [N s]")
