"""A cylinder with towers that carry conductors: mass, inertia, and the records of what flies.

Axes b: x up (the cylinder's own), y along the track, z across. Two towers on each axis; those along z carry no current but
a cross of conductors at their ends (design 2), or are conductors themselves (design 1). A tower is a thin rod, rho kg/m:

    M = Mcyl + 2 rho (l1 + l2 + lt + lc1 + lc2)                                                     (1)
    A, B, C : the cylinder's Mcyl (a^2/2, (3 a^2 + h^2)/12, the same) and for each rod l^2/12 + arm^2 across it   (2)

The arm of a conductor's force is that of its middle: (l1 + h)/2, l2/2 + a, lt + a, as in (2). The thesis has l1/2, l2/2
and lt in its input matrix although its own (2) puts the rods on the hull: `arms="centre"` gives those, 3 to 48 % shorter.

Source: Lawrence (1992), AFIT/GA/ENY/92D-05, sections 3.3, 3.4 and appendix D (whose table has l1 and l2 exchanged).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fieldline.errors import InputError

if TYPE_CHECKING:
    from fieldline.vehicle import Conductor, Thruster

ARMS = ("hull", "centre")
DESIGNS = (1, 2)


@dataclass(frozen=True, kw_only=True)
class TrackingVehicle:
    """Mass, principal inertia, conductors and thrusters of a tracking vehicle; SI, body axes as the module's."""

    mass_kg: float
    tower_mass_kg: float
    inertia_kg_m2: tuple[float, float, float]
    conductors: tuple[Conductor, ...]
    thrusters: tuple[Thruster, ...]


def tank_with_towers(
    *,
    vertical_m: float = 50.0,
    horizontal_m: float = 310.0,
    support_m: float = 50.0,
    cross_vertical_m: float = 20.0,
    cross_horizontal_m: float = 20.0,
    design: int = 2,
    thruster: bool = True,
    arms: str = "hull",
    tank_mass_kg: float = 31300.0,
    tank_length_m: float = 46.88,
    tank_radius_m: float = 4.206,
    tower_kg_per_m: float = 7.3,
    current_max_a: float = 125.0,
    thrust_max_n: float = 10.0,
) -> TrackingVehicle:
    """The vehicle of (1) and (2); the defaults are a Space Shuttle's empty tank with the towers of the thesis's examples.

    vertical_m, horizontal_m : l1, l2 of the towers along x and y.      support_m : lt of those along z.
    cross_vertical_m, cross_horizontal_m : lc1, lc2 of the crosses (design 2 only).      design : 1 or 2.
    thruster : a pair on the z axis that pushes along it, either way.      arms : "hull" or "centre", see the module.
    """
    _check(locals())
    l1, l2, lt = vertical_m, horizontal_m, support_m
    lc1, lc2 = (cross_vertical_m, cross_horizontal_m) if design == 2 else (0.0, 0.0)
    a, h = tank_radius_m, tank_length_m
    across = tank_mass_kg * (3.0 * a * a + h * h) / 12.0
    inertia = [tank_mass_kg * a * a / 2.0, across, across]
    for length, axis, arm in ((l1, 0, (l1 + h) / 2.0), (l2, 1, l2 / 2.0 + a), (lt, 2, lt / 2.0 + a)):
        _add_pair(inertia, length, axis, axis, arm, tower_kg_per_m)
    for length, axis in ((lc1, 0), (lc2, 1)):
        _add_pair(inertia, length, axis, 2, lt + a, tower_kg_per_m)
    towers = 2.0 * tower_kg_per_m * (l1 + l2 + lt + lc1 + lc2)
    own = (l1 / 2.0, l2 / 2.0, lt) if arms == "centre" else ((l1 + h) / 2.0, l2 / 2.0 + a, lt + a)
    conductors = _conductors(design, (l1, l2, lt, lc1, lc2), own, lt / 2.0 + (0.0 if arms == "centre" else a), current_max_a)
    moments = inertia[0], inertia[1], inertia[2]
    return TrackingVehicle(
        mass_kg=tank_mass_kg + towers,
        tower_mass_kg=towers,
        inertia_kg_m2=moments,
        conductors=conductors,
        thrusters=_pair(lt, thrust_max_n) if thruster else (),
    )


def _add_pair(inertia: list[float], length: float, axis: int, place: int, arm: float, density: float) -> None:
    """Two rods along `axis`, their middles at +-arm along axis `place`, added to the principal moments: (2)."""
    for about in range(3):
        own = length**2 / 12.0 if about != axis else 0.0
        moved = arm**2 if about != place else 0.0
        inertia[about] += 2.0 * length * density * (own + moved)


def _conductors(design: int, lengths, arms, z_middle: float, limit: float) -> tuple[Conductor, ...]:
    """The records, in the thesis's order and with its letters: up, down, east, west, north, south."""
    from fieldline.vehicle import Conductor

    l1, l2, lt, lc1, lc2 = lengths
    pairs = [("I1", "ud", 0, 0, l1, arms[0]), ("I2", "ew", 1, 1, l2, arms[1])]
    if design == 1:
        pairs.append(("I3", "ns", 2, 2, lt, z_middle))
    else:
        pairs += [("I1", "ns", 0, 2, lc1, arms[2]), ("I2", "ns", 1, 2, lc2, arms[2])]
    made = []
    for name, ends, axis, place, length, arm in pairs:
        for letter, side in zip(ends, (1.0, -1.0), strict=True):
            position = tuple(side * arm if k == place else 0.0 for k in range(3))
            direction = tuple(1.0 if k == axis else 0.0 for k in range(3))
            made.append(
                Conductor(name=name + letter, position_b_m=position, direction_b=direction, length_m=length, current_max_a=limit)
            )
    return tuple(made)


def _pair(support_m: float, thrust_max_n: float) -> tuple[Thruster, ...]:
    """One column for both thrusters: positive fires the southern one, northwards."""
    from fieldline.vehicle import Thruster

    at = (0.0, 0.0, -support_m)
    return (Thruster(name="T", position_b_m=at, direction_b=(0.0, 0.0, 1.0), force_n=thrust_max_n, specific_impulse_s=3000.0),)


def _check(given: dict) -> None:
    """InputError for what no vehicle can have."""
    if given["design"] not in DESIGNS:
        raise InputError(f"design must be 1 (six conductors) or 2 (eight, with crosses); got {given['design']!r}.")
    if given["arms"] not in ARMS:
        raise InputError(
            f'arms must be "hull" (conductors begin there) or "centre" (as the thesis has it); got {given["arms"]!r}.'
        )
    if not isinstance(given["thruster"], bool):
        raise InputError(f"thruster must be true or false; got {given['thruster']!r}.")
    for name, value in given.items():
        if name in ("design", "thruster", "arms"):
            continue
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < 1e9:
            raise InputError(f"{name} must be a positive number; got {value!r}.")
