"""The loop that a coil's turns follow, the ampere-turns that it needs, and what is given of the winding.

A circle of diameter D, a rectangle of two sides, or a rod: a winding over the whole length of a core.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, sqrt

from fieldline.design.core import MU0, CoreAlloy, core_gain, core_induction, demagnetising_factor
from fieldline.errors import InputError

PEAK_OVER_MEAN = 1.5  # of the induction in a slender rod


@dataclass(frozen=True, kw_only=True)
class Given:
    """What the user fixed of the winding; None what not. Units in the names."""

    turns: int | None = None
    current_a: float | None = None
    wire_area_m2: float | None = None
    voltage_v: float | None = None
    power_w: float | None = None
    mass_kg: float | None = None
    mass_per_watt_kg: float | None = None
    insulation_m: float = 0.0

    def __post_init__(self):
        groups = (self.turns_group, self.wire_group, self.section_group)
        if sum(one is not None for one in groups) != 2:
            raise InputError(self._count(groups))

    @property
    def turns_group(self) -> str | None:
        """Which of the turns' group is given."""
        return self._one("turns", "current_a")

    @property
    def wire_group(self) -> str | None:
        """Which of the wire's."""
        return self._one("wire_area_m2", "voltage_v")

    @property
    def section_group(self) -> str | None:
        """Which of the section's."""
        return self._one("power_w", "mass_kg", "mass_per_watt_kg")

    def _one(self, *names: str) -> str | None:
        given = [name for name in names if getattr(self, name) is not None]
        if len(given) > 1:
            shown = " and ".join("wire" if name == "wire_area_m2" else name for name in given)
            raise InputError(f"{shown} fix the same thing for a given moment and shape; give one of them. {FREEDOMS}")
        return given[0] if given else None

    def _count(self, groups) -> str:
        named = ["wire" if one == "wire_area_m2" else one for one in groups if one is not None]
        if len(named) == 3:
            return f"{', '.join(named)} are one too many for a given moment and shape; leave one of them out. {FREEDOMS}"
        have = f"{named[0]} alone leaves" if named else "moment and shape leave"
        return f"{have} the coil open. {FREEDOMS}"


FREEDOMS = (
    "A coil takes one from each of two groups: turns or current_a; wire, wire_area_m2 or voltage_v; power_w, mass_kg or "
    "mass_per_watt_kg."
)


@dataclass(frozen=True, kw_only=True)
class Loop:
    """Shape and what it asks of the winding: area [m^2] of a turn, perimeter [m] of the bare form, ampere-turns, core.

    core_length_m is None for air. A rod's turns lie on each other over its length, so they lengthen as they pile up.
    """

    words: str
    area_m2: float
    perimeter_m: float
    ampere_turns: float
    core_length_m: float | None = None
    core_mass_kg: float = 0.0
    gain: float = 1.0
    demagnetising: float = 0.0
    core_tesla: float = 0.0
    saturation_tesla: float = 0.0

    def turn_length_m(self, winding_area_m2: float) -> float:
        """Mean length of a turn when the winding has that cross-section; constant without a core."""
        return self.perimeter_m + (0.0 if self.core_length_m is None else pi * winding_area_m2 / self.core_length_m)


def circle(moment_a_m2: float, diameter_m: float) -> Loop:
    """A circular loop in air."""
    area = 0.25 * pi * diameter_m**2
    words = f"circle of {diameter_m:g} m"
    return Loop(words=words, area_m2=area, perimeter_m=pi * diameter_m, ampere_turns=moment_a_m2 / area)


def rectangle(moment_a_m2: float, sides_m: tuple[float, float]) -> Loop:
    """A rectangular loop in air."""
    one, other = sides_m
    words = f"rectangle of {one:g} m by {other:g} m"
    area = one * other
    return Loop(words=words, area_m2=area, perimeter_m=2.0 * (one + other), ampere_turns=moment_a_m2 / area)


def rod(moment_a_m2: float, length_m: float, diameter_m: float, alloy: CoreAlloy, shape: str) -> Loop:
    """A winding over the whole of a cylindrical core; refused where the core would saturate."""
    if length_m <= diameter_m:
        raise InputError(f"core_length_m must be above core_diameter_m; got {length_m:g} and {diameter_m:g} m.")
    area = 0.25 * pi * diameter_m**2
    factor = demagnetising_factor(length_m / diameter_m, shape)
    gain = core_gain(alloy.relative_permeability, factor)
    volume = area * length_m
    induction = core_induction(moment_a_m2, gain, factor, volume)
    if induction >= alloy.saturation_tesla:
        least = MU0 * moment_a_m2 / alloy.saturation_tesla
        raise InputError(
            f"{moment_a_m2:g} A m² would need {induction:.2f} T in the core, but {alloy.name} saturates at "
            f"{alloy.saturation_tesla:g} T: it takes {1e6 * least:.3g} cm³ of core at least, this one has {1e6 * volume:.3g}. "
            f"At this length the diameter must be above {1e3 * sqrt(4.0 * least / (pi * length_m)):.3g} mm."
        )
    return Loop(
        words=f"rod of {length_m:g} m by {1e3 * diameter_m:g} mm, {alloy.name}",
        area_m2=area,
        perimeter_m=pi * diameter_m,
        ampere_turns=moment_a_m2 / (area * gain),
        core_length_m=length_m,
        core_mass_kg=alloy.density_kg_m3 * volume,
        gain=gain,
        demagnetising=factor,
        core_tesla=induction,
        saturation_tesla=alloy.saturation_tesla,
    )
