"""The whole scenario: one record, read from TOML or made in Python."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PrivateAttr, model_validator

from fieldline.records import Record, RecordError
from fieldline.records.names import Name
from fieldline.simulate.scenario.body import Body
from fieldline.simulate.scenario.environment import Environment
from fieldline.simulate.scenario.event import Event
from fieldline.simulate.scenario.integrator import Integrator
from fieldline.simulate.scenario.orbit_start import OrbitStart
from fieldline.simulate.scenario.software import Software
from fieldline.simulate.scenario.span import Span
from fieldline.simulate.scenario.tether_line import TetherLine

MOST_BODIES = 10_000


class Scenario(Record):
    """What flies, where and when, under which flight software; numbers in the unit that each key names.

        scenario = Scenario.read("detumble.toml")
        slower = scenario.replace(**{"body.0.rate_deg_s": [1.0, 0.0, 0.0]})

    `fieldline scenario schema` and the page on scenarios tell of every key, with its unit and default.
    """

    name: Name = Field(default="scenario", min_length=1, description="name of the scenario")
    description: str = Field(default="", description="what it is about")
    seed: int = Field(default=0, ge=0, le=2**63 - 1, description="seed of everything that is drawn at random")
    time: Span = Field(description="start, duration and output of the run")
    integrator: Integrator = Field(default=Integrator(), description="method and step")
    environment: Environment = Field(default=Environment(), description="magnetic field, gravity, air")
    orbit: OrbitStart | None = Field(default=None, description="where the first body starts")
    body: Annotated[tuple[Body, ...], Field(strict=False, min_length=1, max_length=MOST_BODIES)] = Field(
        description="the bodies, in the order of the results"
    )
    line: Annotated[tuple[TetherLine, ...], Field(strict=False)] = Field(default=(), description="lines between bodies")
    software: Annotated[tuple[Software, ...], Field(strict=False)] = Field(default=(), description="tasks of the flight software")
    event: Annotated[tuple[Event, ...], Field(strict=False)] = Field(default=(), description="events that are watched")

    _folder: Path = PrivateAttr(default=Path())
    _text: str = PrivateAttr(default="")

    @model_validator(mode="after")
    def _fits_together(self):
        """What no table can check by itself; see `checks`."""
        from fieldline.simulate.scenario.checks import problems

        found = list(problems(self))
        if found:
            raise RecordError(found)
        return self

    def __eq__(self, other: object) -> bool:
        """Whether all keys agree; where they were read from does not matter."""
        return isinstance(other, Scenario) and self.model_dump() == other.model_dump()

    __hash__ = None  # tables of parameters are no keys of a dict

    @classmethod
    def read(cls, path: str | Path) -> Scenario:
        """The scenario of a TOML file; files that it names are looked for beside it.

        Errors: InputError with every problem, each with the path of its key; or with the line of a slip in the syntax.
        """
        from fieldline.files import read_text

        path = Path(path)
        return cls.from_toml(read_text(path, "scenario"), source=path.name, folder=path.parent)

    @classmethod
    def from_toml(cls, text: str, *, source: str = "scenario", folder: str | Path = ".") -> Scenario:
        """The scenario of a TOML text; `source` names it in messages, `folder` is where the files that it names lie."""
        from fieldline.simulate.scenario.toml import parse

        scenario = cls.from_dict(parse(text, source), source)
        scenario._folder, scenario._text = Path(folder), text
        return scenario

    def to_toml(self) -> str:
        """The scenario as TOML: what differs from the defaults; `from_toml` gives the same scenario back."""
        from fieldline.simulate.scenario.toml import written

        return written(self.to_dict())

    def replace(self, **changes: Any) -> Scenario:
        """A copy with some values changed, each key a path such as "body.0.mass_kg" or "time.duration_s".

        The copy is checked as a whole. None takes a key out. Errors: InputError names a path that leads nowhere.
        """
        from fieldline.simulate.scenario.paths import changed

        scenario = type(self).from_dict(changed(self.to_dict(), changes), self.name)
        scenario._folder = self._folder
        return scenario

    def check(self) -> list[str]:
        """Warnings; InputError lists what the files, laws and models that it names refuse."""
        from fieldline.simulate.scenario.outside import check

        return check(self)

    @property
    def folder(self) -> Path:
        """Where the files that the scenario names are looked for."""
        return self._folder

    def files(self) -> list[str]:
        """Names of the files that it needs beside it: orbits, Earth orientation, the user's functions."""
        orbits = [self.orbit, *(body.orbit for body in self.body)]
        named = [one.tle for one in orbits if one is not None and one.tle is not None]
        named += [self.environment.earth_orientation or ""]
        functions = [one.law for one in self.software] + [one.function or "" for one in self.event]
        functions += [one.function for owner in (*self.body, *self.line) for one in owner.load]
        named += [name.rpartition(":")[0] for name in functions if ".py:" in name]
        return sorted({name.strip() for name in named if name.strip() and "\n" not in name.strip()})

    @property
    def sha256(self) -> str:
        """Hex digest of the text that it was read from, or of `to_toml()`, for the record."""
        from hashlib import sha256

        return sha256((self._text or self.to_toml()).encode()).hexdigest()

    def index_of(self, body: str) -> int:
        """Index of a body by name; "" is the first."""
        return 0 if not body else [one.name for one in self.body].index(body)
