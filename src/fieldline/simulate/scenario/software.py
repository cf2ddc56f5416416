"""A task of the flight software: a law or an estimator, with its rate, delay and parameters."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from fieldline.records import Record, RecordError
from fieldline.records.names import Name
from fieldline.records.words import came
from fieldline.vehicle.user_load import is_function_name

Command = Literal["dipole", "wheel_torque", "thrust", "current", "reel", "attachment"]
ORDER = ("dipole", "wheel_torque", "thrust", "current", "reel", "attachment")


def _plain(value: Any) -> bool:
    """Whether a value is one that a law's parameters may hold."""
    if isinstance(value, list | tuple):
        return all(_plain(one) for one in value)
    return isinstance(value, bool | str) or _numeric(value)


def _numeric(value: Any) -> bool:
    """Whether a value is a finite number or a list of them."""
    if isinstance(value, list | tuple):
        return all(_numeric(one) for one in value)
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300


class Software(Record):
    """A task that reads the measurement of a body and commands its actuators, at its own rate."""

    name: Name = Field(default="", description="name in results and messages; the law's name by default")
    body: str = Field(default="", description="name of the body; may be left out where there is one body")
    law: str = Field(
        min_length=1, description='name of a law of the library, or the user\'s "file.py:function" or "module:function"'
    )
    role: Literal["controller", "estimator"] = Field(
        default="controller", description="a controller returns commands; an estimator attitude and rate as known on board"
    )
    rate_hz: float = Field(default=1.0, gt=0.0, le=1e5, description="calls per second [Hz]")
    phase_s: float = Field(default=0.0, ge=0.0, description="time of the first call after the start [s]")
    delay_s: float = Field(default=0.0, ge=0.0, description="time from a call to when its command acts [s], below one period")
    parameters: dict[str, Any] = Field(
        default={},
        description="the law's own parameters by name; for a law of your own: numbers, handed over as an array in this order",
    )
    commands: Annotated[tuple[Command, ...], Field(strict=False)] = Field(
        default=(), description=f"for a law of the user's own: what it returns, in the order {', '.join(ORDER)}"
    )
    memory: int | None = Field(
        default=None, ge=0, le=1_000_000, description="for a law of the user's own: numbers that it keeps between calls"
    )
    compiled: bool = Field(default=True, description="for a law of the user's own: compile it with Numba; false: plain Python")

    @property
    def is_users(self) -> bool:
        """Whether the law is a function of the user's own."""
        return is_function_name(self.law)

    @field_validator("parameters")
    @classmethod
    def _plain_parameters(cls, table: dict[str, Any]) -> dict[str, Any]:
        """Finite numbers, truth values, text, and lists of them: what a law can take and a file can hold."""
        for key, value in table.items():
            if not _plain(value):
                raise ValueError(f"must hold finite numbers, true, false, text, or lists of them; {key[:40]} is {came(value)}")
        return table

    @model_validator(mode="after")
    def _declares_enough(self):
        """A user's controller says what it commands; a law of the library knows."""
        found = []
        if self.delay_s >= 1.0 / self.rate_hz:
            period = 1.0 / self.rate_hz
            found.append(("delay_s", f"must be less than the period of a call, {period:g} s; got {self.delay_s:g}"))
        if tuple(sorted(set(self.commands), key=ORDER.index)) != self.commands:
            found.append(("commands", f"must be in the order {', '.join(ORDER)}, each once"))
        if self.is_users and self.role == "controller" and not self.commands:
            found.append(("commands", 'is missing: a law of your own says what it returns, for example commands = ["dipole"]'))
        if self.role == "estimator" and self.commands:
            found.append(("commands", "has no meaning for an estimator, which returns attitude and rate; leave it out"))
        if self.is_users:
            found += [
                (f"parameters.{key}", f"must be a number or a list of numbers; got {came(value)}")
                for key, value in self.parameters.items()
                if not _numeric(value)
            ]
        else:
            given = [key for key in ("commands", "memory") if getattr(self, key)]
            found += [(key, "has a meaning for a law of your own alone; this one knows it") for key in given]
        if found:
            raise RecordError(found)
        return self
