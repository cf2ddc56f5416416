"""A line between points of two bodies: it pulls where it is stretched, and never pushes."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from fieldline.records import Record, RecordError
from fieldline.records.names import Name
from fieldline.records.values import Direction, Vector
from fieldline.vehicle.line_circuit import LineCircuit
from fieldline.vehicle.line_heat import LineHeat
from fieldline.vehicle.reel import Reel
from fieldline.vehicle.user_load import UserLoad

ORIGIN = (0.0, 0.0, 0.0)
MOST_NODES = 2000
SHRUNK, GROWN = 0.5, 2.0  # of a line's length, by its temperature at the start


class Stretch(Record):
    """A part of a line with properties of its own; the parts follow each other from from_body on."""

    length_m: float = Field(gt=0.0, description="unstretched length of this part [m]")
    stiffness_n: float | None = Field(default=None, gt=0.0, description="axial stiffness [N]; the line's by default")
    damping_n_s: float | None = Field(default=None, ge=0.0, description="axial damping [N s]; the line's by default")
    mass_per_length_kg_m: float | None = Field(default=None, gt=0.0, description="mass per length [kg/m]; the line's by default")
    diameter_m: float | None = Field(
        default=None, ge=0.0, description="diameter, of a tape its circumference over pi [m]; the line's by default"
    )


class Slider(Record):
    """An attachment that moves along an axis of its body; a law commands its place by the group attachment."""

    end: Literal["from", "to"] = Field(default="from", description="which end of the line moves")
    axis_b: Direction = Field(description="direction of travel, axes of that body; made a unit vector")
    travel_m: float = Field(gt=0.0, description="largest way from the middle, either side [m]")
    speed_m_s: float = Field(gt=0.0, description="speed at which it moves [m/s]")
    start_m: float = Field(default=0.0, description="place at the start [m]")

    @model_validator(mode="after")
    def _within(self):
        """The start is within the travel."""
        if abs(self.start_m) > self.travel_m:
            raise RecordError([("start_m", f"must be within travel_m = {self.travel_m:g} m; got {self.start_m:g}")])
        return self


class Line(Record):
    """A visco-elastic line: tension = stiffness strain + damping strain_rate where both stretch and tension are positive."""

    name: Name = Field(default="", description="name in results; by default line_1, line_2, ...")
    from_body: str = Field(min_length=1, description="name of the body at one end")
    from_point_b_m: Vector = Field(default=ORIGIN, description="attachment on it, from its centre of mass, its body axes [m]")
    to_body: str = Field(min_length=1, description="name of the body at the other end, where a reel is, if any")
    to_point_b_m: Vector = Field(default=ORIGIN, description="attachment on it, from its centre of mass, its body axes [m]")
    rest_length_m: float = Field(gt=0.0, description="length without tension [m]; with a reel, what is out at the start")
    stiffness_n: float = Field(gt=0.0, description="axial stiffness, Young's modulus times cross-section: tension per strain [N]")
    damping_n_s: float = Field(default=0.0, ge=0.0, description="axial damping: tension per rate of strain [N s]")
    from_joint_damping_n_m_s: float = Field(
        default=0.0, ge=0.0, description="angular damping where it leaves from_body: torque per rate of the angle [N m s]"
    )
    to_joint_damping_n_m_s: float = Field(default=0.0, ge=0.0, description="the same at to_body [N m s]")
    nodes: int = Field(
        default=0, ge=0, le=MOST_NODES, description="point masses along it, evenly spaced; with a reel, when all of it is out"
    )
    mass_per_length_kg_m: float = Field(default=0.0, ge=0.0, description="mass per unstretched length [kg/m]; 0: without mass")
    diameter_m: float = Field(
        default=0.0, ge=0.0, description="diameter, of a tape its circumference over pi, for air, light and plasma [m]"
    )
    drag_coefficient: float = Field(default=2.2, ge=0.0, description="of the line across the flow [-]")
    stretch: Annotated[tuple[Stretch, ...], Field(strict=False)] = Field(
        default=(), description="parts of other materials; the line's own keys hold for what is not given and for the rest of it"
    )
    heat: LineHeat | None = Field(default=None, description="temperature of its segments, which length and resistance follow")
    circuit: LineCircuit | None = Field(default=None, description="current along it")
    reel: Reel | None = Field(default=None, description="a reel on to_body that pays the line out and takes it in")
    slider: Annotated[tuple[Slider, ...], Field(strict=False)] = Field(
        default=(), description="attachments that move along an axis of their body"
    )
    load: Annotated[tuple[UserLoad, ...], Field(strict=False)] = Field(
        default=(), description="loads of the user's own, on each node: given r_i, v_i, length from from_body, mass of the node"
    )

    @model_validator(mode="after")
    def _holds_together(self):
        """Nodes have mass; parts fit in the length; a reel holds what is out."""
        found = []
        if self.nodes > 0 and self.mass_per_length_kg_m == 0.0:
            found.append(("mass_per_length_kg_m", "must be more than zero for a line with nodes; or leave nodes out"))
        if self.nodes == 0 and self.load:
            found.append(("load", "acts on nodes, and the line has none; give nodes"))
        if self.heat is not None and (self.mass_per_length_kg_m == 0.0 or self.diameter_m == 0.0):
            found.append(("heat", "needs mass_per_length_kg_m and diameter_m above zero: what warms up, and what it is lit on"))
        if self.heat is not None and not SHRUNK < self.heat.growth_at_start < GROWN:
            told = f"makes the line {self.heat.growth_at_start:.3g} times as long at start_temperature_k as at the reference"
            found.append(("heat.expansion_1_k", f"{told}; between {SHRUNK:g} and {GROWN:g} times is possible. Is it in 1/K?"))
        if self.circuit is not None and self.circuit.temperature_coefficient_1_k != 0.0 and self.heat is None:
            found.append(("circuit.temperature_coefficient_1_k", "needs [line.heat], which gives the line a temperature"))
        if self.circuit is not None and self.circuit.mode == "bare" and self.diameter_m == 0.0:
            found.append(("circuit", "needs diameter_m above zero: a bare line collects over its surface"))
        whole = self.whole_length_m
        parts = sum(one.length_m for one in self.stretch)
        if parts > whole * (1.0 + 1e-9):
            found.append(("stretch", f"must not be longer together than the line, {whole:g} m; got {parts:g} m"))
        if self.reel is not None and self.reel.total_length_m < self.rest_length_m:
            found.append(
                (
                    "reel.total_length_m",
                    f"must be at least what is out, rest_length_m = {self.rest_length_m:g} m; it is the whole line",
                )
            )
        if self.reel is not None and self.reel.shortest_length_m > self.rest_length_m:
            found.append(
                (
                    "reel.shortest_length_m",
                    f"must be at most what is out at the start, rest_length_m = {self.rest_length_m:g} m; "
                    f"got {self.reel.shortest_length_m:g} m",
                )
            )
        if found:
            raise RecordError(found)
        return self

    @property
    def mass_on_reel_kg(self) -> float:
        """Mass of what its reel holds at the start [kg]: that of the parts beyond rest_length_m."""
        found, place = 0.0, 0.0
        for part in (*self.stretch, self):
            end = self.whole_length_m if part is self else place + part.length_m
            linear = self.mass_per_length_kg_m if part.mass_per_length_kg_m is None else part.mass_per_length_kg_m
            found += linear * max(0.0, end - max(place, self.rest_length_m))
            place = end
        return found

    @property
    def whole_length_m(self) -> float:
        """Unstretched length, on the reel and out [m]."""
        return self.rest_length_m if self.reel is None else self.reel.total_length_m
