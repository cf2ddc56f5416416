"""The electric circuit of a line: a current that is given, an insulated wire, or a bare one."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, model_validator

from fieldline.records import Record, RecordError

Numbers = Annotated[tuple[float, ...], Field(strict=False)]
Pair = Annotated[tuple[float, float], Field(strict=False)]
MEANT_FOR = {
    "current_a": ("profile",),
    "times_s": ("profile",),
    "currents_a": ("profile",),
    "fractions": ("profile",),
    "shares": ("profile",),
    "current_max_a": ("profile",),
    "load_ohm": ("series", "bare"),
    "supply_v": ("series",),
    "contactor_ohm": ("series",),
    "collector_radius_m": ("series",),
    "collector_gain": ("series",),
    "emission_max_a": ("series",),
    "cathode": ("bare",),
    "cathode_drop_v": ("bare",),
    "ion_mass_u": ("bare",),
}  # the modes for which a key has a meaning; others have one for all


class LineCircuit(Record):
    """Current along a line, positive from from_body to to_body; it closes through the plasma."""

    mode: Literal["profile", "series", "bare"] = Field(
        description='"profile": the current is given; "series": an insulated wire between contactors, driven by its '
        'electromotive force; "bare": a wire that collects electrons over its length, with a cathode at one end'
    )
    commanded: bool = Field(
        default=False,
        description="a law on to_body commands it by the group current: the current [A] of a profile, else the part of full "
        "current, 0 to 1; 0 until the first command",
    )
    resistance_ohm_per_m: float = Field(default=0.0, ge=0.0, description="of the wire at its reference temperature [ohm/m]")
    temperature_coefficient_1_k: float = Field(
        default=0.0, ge=-0.02, le=0.02, description="growth of the resistance with temperature; needs [line.heat] [1/K]"
    )
    reference_temperature_k: float = Field(
        default=293.15, gt=0.0, le=2000.0, description="temperature at which the resistance holds [K]"
    )
    current_a: float | None = Field(default=None, description="profile: a constant current [A]")
    times_s: Numbers = Field(default=(), description="profile: times from the start, instead of a constant [s]")
    currents_a: Numbers = Field(default=(), description="profile: currents at these times, linear between them [A]")
    fractions: Numbers = Field(default=(), description="profile: places along the line, 0 at from_body to 1 [-]")
    shares: Numbers = Field(default=(), description="profile: part of the current at these places, linear between them [-]")
    current_max_a: float = Field(default=100.0, gt=0.0, description="profile: largest current that is obeyed, either sign [A]")
    load_ohm: float = Field(default=0.0, ge=0.0, description="series, bare: load in the circuit [ohm]")
    supply_v: float = Field(default=0.0, description="series: a source in the circuit, positive towards to_body [V]")
    contactor_ohm: float = Field(default=0.0, ge=0.0, description="series: of both contactors together [ohm]")
    collector_radius_m: Pair = Field(
        default=(0.0, 0.0),
        description="series: sphere that collects electrons at from_body and to_body; 0: a plasma contactor without limit [m]",
    )
    collector_gain: float = Field(
        default=1.0, gt=0.0, description="series: current of a sphere over Parker and Murphy's; TSS-1R: 2.5 [-]"
    )
    emission_max_a: Pair = Field(default=(1e3, 1e3), description="series: most that the ends can emit, from_body and to_body [A]")
    cathode: Literal["from", "to"] = Field(default="from", description="bare: the end at which electrons leave")
    cathode_drop_v: float = Field(default=20.0, ge=0.0, description="bare: what the cathode needs to emit [V]")
    ion_mass_u: float = Field(default=16.0, ge=1.0, le=100.0, description="bare: of the ions that the far part collects [u]")

    @model_validator(mode="after")
    def _holds_together(self):
        """Keys of the chosen mode only, tables that are tables."""
        found = []
        for key, modes in MEANT_FOR.items():
            if self.mode not in modes and getattr(self, key) != type(self).model_fields[key].default:
                found.append((key, f'has no meaning for mode = "{self.mode}"; leave it out'))
        if self.mode == "profile":
            found += self._profile_problems()
        elif self.resistance_ohm_per_m == 0.0:
            found.append(("resistance_ohm_per_m", f'must be more than zero for mode = "{self.mode}"'))
        if min(self.collector_radius_m) < 0.0 or min(self.emission_max_a) < 0.0:
            found.append(("collector_radius_m", "and emission_max_a must hold no negative number"))
        if found:
            raise RecordError(found)
        return self

    def _profile_problems(self) -> list[tuple[str, str]]:
        """One way of giving the current; tables of two columns, the first rising."""
        found = []
        ways = (self.current_a is not None) + bool(self.times_s or self.currents_a) + self.commanded
        if ways != 1:
            found.append(("current_a", 'is needed, or times_s and currents_a, or commanded: one of them, for mode = "profile"'))
        for place, value in (("times_s", "currents_a"), ("fractions", "shares")):
            at, values = getattr(self, place), getattr(self, value)
            if len(at) != len(values) or len(at) == 1:
                found.append((value, f"must have as many numbers as {place}, two at least; got {len(values)} and {len(at)}"))
            elif any(late <= early for early, late in pairwise(at)):
                found.append((place, "must rise from one to the next"))
        if self.fractions and not (0.0 <= self.fractions[0] and self.fractions[-1] <= 1.0):
            found.append(("fractions", "must be within 0 and 1"))
        return found
