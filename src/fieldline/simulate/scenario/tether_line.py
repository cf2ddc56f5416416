"""A line of a scenario: what it is, and how it moves at the start."""

from __future__ import annotations

from pydantic import Field, model_validator

from fieldline.records import RecordError
from fieldline.simulate.scenario.hang import LineStart
from fieldline.vehicle.line import Line


class TetherLine(Line):
    """A visco-elastic line: tension = stiffness strain + damping strain_rate where both stretch and tension are positive."""

    start: LineStart | None = Field(default=None, description="waves along it at the start; none by default")

    @model_validator(mode="after")
    def _can_wave(self):
        """Waves need nodes."""
        if self.start is not None and self.nodes == 0:
            raise RecordError([("start", "needs a line with nodes, and this one has none; give nodes")])
        if self.start is not None and self.start.skiprope_mode > self.nodes:
            raise RecordError([("start.skiprope_mode", f"must be at most the number of nodes, {self.nodes}")])
        return self
