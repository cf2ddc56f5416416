"""A coil for a moment: turns, current, resistance, power and mass, from what is given of them.

With N turns of wire of conducting area A_w, combined section b = N A_w, turns of length l around an area a:

    M = N I a                                                                                               (13)
    R = N^2 l rho / b                                                                                       (14)
    P = I^2 R = M^2 l rho / (b a^2),     16 M^2 rho / (pi b D^3) for a circle                           (15, 16)
    m = b l sigma,                       pi D b sigma                                                       (17)
    P m = M^2 l^2 rho sigma / a^2,       16 M^2 rho sigma / D^2, whatever the section                       (18)
    N = E a b / (M l rho),               E b D / (4 M rho), for the voltage E                               (19)

Moment and shape leave two freedoms, and one thing from each of two of these three groups takes them:

    the turns   : turns, or current_a (turns are rounded up, so that the current stays within what is given)
    the wire    : wire (a gauge), wire_area_m2, or voltage_v (at the whole moment; turns do not enter)
    the section : power_w, mass_kg, or mass_per_watt_kg (what a watt of supply weighs: the least m + k P is taken)

A rod multiplies the winding's moment by the gain of its core (`core`), and its turns grow by their own thickness.

Numbers of equations: White, Shigemoto and Bourquin (1961), NASA TN D-1068; general section and loop by the same argument.
Valid for coil losses alone: no leads, no eddy currents, no driver.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, floor, pi, sqrt

from fieldline.design.loop import Given, Loop
from fieldline.design.wire import Conductor, gauge_name, nearest_gauge
from fieldline.errors import InputError

INSULATION_KG_M3 = 1400.0  # enamels of polyimide and polyester
HOT_A_M2 = 6e6  # current density above which a winding in vacuum needs a heat path
FINE_GAUGE = 42
MOST_TURNS = 1e9
ROUNDS = 60  # of the turn's length against the winding's thickness; each gains a digit or more


@dataclass(frozen=True, kw_only=True)
class Winding:
    """What was found: whole turns of one wire [m^2] and the length of one of them [m]."""

    turns: int
    wire_area_m2: float
    turn_length_m: float


def wound(given: Given, loop: Loop, metal: Conductor, resistivity: float) -> Winding:
    """Whole turns and the wire, by the groups above."""
    length = loop.turn_length_m(0.0)
    turns, area = 1.0, 0.0
    for _ in range(ROUNDS):
        turns, area = _freedoms(given, loop, metal, resistivity, length, turns, area)
        length = loop.turn_length_m(winding_area(turns, area, given.insulation_m))
    whole = _whole_turns(given, turns)
    if whole != turns and given.wire_group is None:
        area *= turns / whole  # the section was asked for, and it stays
    return Winding(
        turns=whole, wire_area_m2=area, turn_length_m=loop.turn_length_m(winding_area(whole, area, given.insulation_m))
    )


def winding_area(turns: float, wire_area_m2: float, insulation_m: float) -> float:
    """Cross-section [m^2] of the winding: each turn takes the square around its insulated wire."""
    return turns * outer_diameter(wire_area_m2, insulation_m) ** 2


def outer_diameter(wire_area_m2: float, insulation_m: float) -> float:
    """Diameter [m] of a round wire with its insulation."""
    return 2.0 * (sqrt(wire_area_m2 / pi) + insulation_m)


def insulation_mass(turns: float, wire_area_m2: float, insulation_m: float, turn_length_m: float) -> float:
    """Mass [kg] of the insulation."""
    annulus = pi * insulation_m * (2.0 * sqrt(wire_area_m2 / pi) + insulation_m)
    return INSULATION_KG_M3 * annulus * turns * turn_length_m


def section_of(given: Given, loop: Loop, metal: Conductor, resistivity: float, length: float, insulation_kg: float) -> float:
    """Combined section b [m^2] from power (15), mass (17), or the weight of a watt (least m + k P)."""
    squared = loop.ampere_turns**2
    if given.power_w is not None:
        return squared * resistivity * length / given.power_w  # (15)
    if given.mass_kg is not None:
        wire_kg = given.mass_kg - loop.core_mass_kg - insulation_kg
        if wire_kg <= 0.0:
            raise InputError(
                f"mass_kg = {given.mass_kg:g} leaves nothing for the wire: the core weighs {loop.core_mass_kg:.4g} kg and the "
                f"insulation {insulation_kg:.4g} kg. Allow more, or take a thinner core."
            )
        return wire_kg / (length * metal.density_kg_m3)  # (17)
    assert given.mass_per_watt_kg is not None
    return loop.ampere_turns * sqrt(given.mass_per_watt_kg * resistivity / metal.density_kg_m3)


def cautions(density_a_m2: float, wire_area_m2: float) -> tuple[str, ...]:
    """What a builder should know, in sentences."""
    told = []
    if density_a_m2 > HOT_A_M2:
        told.append(f"{1e-6 * density_a_m2:.1f} A/mm² heats a winding in vacuum; see to a heat path, or take more section.")
    gauge = nearest_gauge(wire_area_m2)
    if gauge is None or gauge > FINE_GAUGE:
        name = "thinner than the gauge tables" if gauge is None and wire_area_m2 < 1e-6 else gauge and gauge_name(gauge)
        told.append(f"the wire is {name or 'thicker than the gauge tables'}: hard to wind.")
    return tuple(told)


def _freedoms(given: Given, loop: Loop, metal: Conductor, resistivity: float, length: float, turns: float, area: float):
    """Turns (not yet whole) and wire area, with the turn's length as it is now."""
    if given.turns is not None:
        turns = float(given.turns)
    elif given.current_a is not None:
        turns = loop.ampere_turns / given.current_a  # (13)
    if given.wire_area_m2 is not None:
        area = given.wire_area_m2
    elif given.voltage_v is not None:
        area = loop.ampere_turns * resistivity * length / given.voltage_v  # (19), solved for b / N
    if given.section_group is None:
        return turns, area
    insulation_kg = insulation_mass(turns, area, given.insulation_m, length)
    section = section_of(given, loop, metal, resistivity, length, insulation_kg)
    return (turns, section / turns) if given.wire_group is None else (section / area, area)


def _whole_turns(given: Given, turns: float) -> int:
    """Up where a current or a power must not be passed, down for a mass, else to the nearest; one at least."""
    if not turns <= MOST_TURNS:
        raise InputError(
            f"such a coil would have {turns:.3g} turns; the most is {MOST_TURNS:g}. Is a unit wrong? Raise the current."
        )
    if given.current_a is not None or (given.power_w is not None and given.turns is None):
        return max(1, ceil(turns - 1e-6))
    if given.mass_kg is not None and given.turns is None:
        return max(1, floor(turns + 1e-6))
    return max(1, round(turns))
