"""A reel: it pays a line out and takes it in, at a rate or under a tension that flight software commands."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from fieldline.records import Record, RecordError


class Reel(Record):
    """A reel on the body at a line's end; the line that it holds at the start is part of that body's mass_kg."""

    mode: Literal["rate", "tension"] = Field(
        default="rate",
        description='"rate": the command is the rate at which the line is paid out [m/s]; "tension": the pull of its motor [N]',
    )
    total_length_m: float = Field(gt=0.0, description="the whole line, on the reel and out, without tension [m]")
    shortest_length_m: float = Field(
        default=1.0, gt=0.0, description="least length out [m]; a run in which it is taken in further ends there"
    )
    rate_m_s: float = Field(
        default=0.0, description="rate at the start, positive out; in mode rate also the command until a law speaks [m/s]"
    )
    rate_max_m_s: float = Field(default=20.0, gt=0.0, description="in mode rate: largest command, either sign [m/s]")
    lag_s: float = Field(default=1.0, gt=0.0, description="time constant with which the rate follows its command [s]")
    tension_n: float = Field(default=0.0, ge=0.0, description="in mode tension: pull of the motor until a law speaks [N]")
    tension_max_n: float = Field(default=1e3, gt=0.0, description="largest command of a tension [N]")
    effective_mass_kg: float = Field(
        default=5.0, gt=0.0, description="in mode tension: inertia of the drum over its radius squared [kg]"
    )

    @model_validator(mode="after")
    def _within_its_limits(self):
        """What holds until a law speaks is no more than what a law may ask for."""
        if self.mode == "rate" and abs(self.rate_m_s) > self.rate_max_m_s:
            raise RecordError([("rate_m_s", f"must be within rate_max_m_s = {self.rate_max_m_s:g} m/s; got {self.rate_m_s:g}")])
        if self.mode == "tension" and self.tension_n > self.tension_max_n:
            raise RecordError(
                [("tension_n", f"must be at most tension_max_n = {self.tension_max_n:g} N; got {self.tension_n:g}")]
            )
        return self
