"""Sizes of conductors that push by their current: for a climb, for a hold above a target, and what supply they take.

    F = M sqrt(GM) (1/sqrt(r1) - 1/sqrt(r2)) / T        a slow spiral between circles in the time T  (1)
    L = F / (I B)                                                                                   (2)
    V = (sqrt(GM/r) - we r) B L                         induced along a vertical wire over an equator (3)
    P = I V + I^2 (Rc + Rplasma)                        that the supply gives                        (4)
    B_wire = mu0 I / (2 pi d)                           of a current at a distance d                 (5)
    2 l I B = 3 n^2 x (Mc + 2 rho (l + rest))           a hold at x above the target, l each of two  (6)

(6) has an answer only for x < I B / (3 n^2 rho): beyond it a tower weighs more than its current can hold.

Source: Lawrence (1992), AFIT/GA/ENY/92D-05, sections 1, 5.1, 5.4 and appendix C; Jackson, Classical Electrodynamics, (5).
Valid for thrust far below weight (1), field and wire at right angles (2), a circular orbit near the equator (3).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, sqrt
from typing import Any

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2, EARTH_ROTATION_RATE_RAD_S, MU0_OVER_4PI
from fieldline.errors import InputError

LARGE_SHARE = 0.1  # of the Earth's field, from where a wire's own field is told of
MOST_ACCELERATION = 1e-3  # of gravity: above it a transfer is no slow spiral


def transfer_thrust(mass_kg: float, low_m: float, high_m: float, seconds: float, gm_m3_s2: float = EARTH_GM_M3_S2) -> float:
    """[N] along the velocity that takes a mass from radius low_m to high_m [m] in that time: equation (1)."""
    return mass_kg * sqrt(gm_m3_s2) * (1.0 / sqrt(low_m) - 1.0 / sqrt(high_m)) / seconds


def transfer_time(mass_kg: float, low_m: float, high_m: float, thrust_n: float, gm_m3_s2: float = EARTH_GM_M3_S2) -> float:
    """[s] of the same: equation (1)."""
    return transfer_thrust(mass_kg, low_m, high_m, 1.0, gm_m3_s2) / thrust_n


def spiral_radius(low_m: float, acceleration_m_s2: float, seconds, gm_m3_s2: float = EARTH_GM_M3_S2):
    """(...) radius [m] after `seconds` (...) of (1): r = GM / (v1 - a t)^2."""
    speed = sqrt(gm_m3_s2 / low_m) - acceleration_m_s2 * seconds
    return gm_m3_s2 / speed**2


def induced_voltage(
    radius_m: float, length_m: float, field_tesla: float, gm_m3_s2: float = EARTH_GM_M3_S2, spin_rad_s=EARTH_ROTATION_RATE_RAD_S
) -> float:
    """[V] along a vertical wire in a field across the orbit's plane: equation (3)."""
    return (sqrt(gm_m3_s2 / radius_m) - spin_rad_s * radius_m) * field_tesla * length_m


def wire_field(current_a: float, distance_m: float) -> float:
    """[T] of a long straight current: equation (5)."""
    return 2.0 * MU0_OVER_4PI * current_a / distance_m


def farthest_hold(current_a: float, field_tesla: float, mean_motion_rad_s: float, kg_per_m: float) -> float:
    """[m] above the target from where no length of tower holds itself: the bound of (6)."""
    return current_a * field_tesla / (3.0 * mean_motion_rad_s**2 * kg_per_m)


def holding_length(
    above_m: float,
    current_a: float,
    field_tesla: float,
    mean_motion_rad_s: float,
    *,
    body_mass_kg: float,
    kg_per_m: float,
    other_towers_m: float = 0.0,
) -> float:
    """[m] of each of two horizontal conductors that hold a vehicle above_m over (or under) its target: l of equation (6).

    body_mass_kg, kg_per_m : Mc and rho.      other_towers_m : `rest`, the sum of one of each other pair of towers.

    Raises
    ------
    InputError : where no length is enough, with the greatest height that has one.
    """
    weight = 3.0 * mean_motion_rad_s**2 * abs(above_m)
    gain = 2.0 * (current_a * field_tesla - weight * kg_per_m)
    if gain <= 0.0:
        limit = farthest_hold(current_a, field_tesla, mean_motion_rad_s, kg_per_m)
        raise InputError(
            f"no length of conductor holds {above_m:g} m: each metre of tower weighs more than {current_a:g} A in it can hold. "
            f"The most is under {limit:.1f} m; take more current, or a lighter tower."
        )
    return weight * (body_mass_kg + 2.0 * kg_per_m * other_towers_m) / gain


@dataclass(frozen=True, kw_only=True)
class ConductorDesign:
    """A vertical conductor for a climb, by (1) to (5); SI, units in the names. Made by `design_conductor`."""

    thrust_n: float
    length_m: float
    induced_voltage_v: float
    conductor_resistance_ohm: float
    resistance_ohm: tuple[float, float]  # whole circuit with the least and the most of the plasma
    voltage_v: tuple[float, float]
    power_w: tuple[float, float]
    energy_j: tuple[float, float]
    efficiency: tuple[float, float]  # work on the orbit over the supply's
    wire_field_tesla: float
    wire_field_share: float  # of the Earth's field
    cautions: tuple[str, ...]

    def record(self) -> dict[str, Any]:
        """Plain numbers and words, for JSON."""
        return {k: list(v) if isinstance(v, tuple) else v for k, v in vars(self).items()}

    def summary(self) -> str:
        """The table as text, with the cautions below it."""
        rows = [
            ("thrust", f"{self.thrust_n:.4g} N"),
            ("conductor, both halves", f"{self.length_m:.4g} m"),
            ("induced voltage", f"{self.induced_voltage_v:.4g} V"),
            ("resistance", f"{_range(self.resistance_ohm)} ohm, {self.conductor_resistance_ohm:.3g} of it the conductor's"),
            ("supply", f"{_range(self.voltage_v)} V, {_range(self.power_w, 1e-3)} kW"),
            ("energy", f"{_range(self.energy_j, 1.0 / 3.6e9)} MWh"),
            ("to the orbit", f"{_range(self.efficiency, 100.0)} % of it"),
            ("field beside the conductor", f"{1e9 * self.wire_field_tesla:,.0f} nT, {self.wire_field_share:.2f} of the Earth's"),
        ]
        width = max(len(name) for name, _ in rows) + 2
        return "\n".join([f"{name:<{width}}{value}" for name, value in rows] + [f"note: {one}" for one in self.cautions])


def design_conductor(
    *,
    mass_kg: float,
    low_altitude_m: float,
    high_altitude_m: float,
    transfer_s: float,
    current_a: float,
    field_tesla: float,
    conductor_ohm_per_m: float = 7.7e-5,
    plasma_ohm: tuple[float, float] = (1.0, 20.0),
    neighbour_m: float = 5.0,
    gm_m3_s2: float = EARTH_GM_M3_S2,
    earth_radius_m: float = EARTH_EQUATORIAL_RADIUS_M,
) -> ConductorDesign:
    """The vertical conductor that takes a mass from one circular orbit to a higher one in time, with its supply.

    field_tesla : across the orbit's plane, held constant.      plasma_ohm : least and most of the circuit through the plasma.
    neighbour_m : distance of the nearest other conductor.      The voltage is that of the low orbit, where it is largest.
    """
    _positive(locals())
    low, high = earth_radius_m + low_altitude_m, earth_radius_m + high_altitude_m
    if high <= low:
        raise InputError(
            f"high_altitude_m must be above low_altitude_m; got {high_altitude_m:g} and {low_altitude_m:g}. A descent needs no "
            "supply: its current comes from the orbit."
        )
    thrust = transfer_thrust(mass_kg, low, high, transfer_s, gm_m3_s2)
    length = thrust / (current_a * field_tesla)  # (2)
    induced = induced_voltage(low, length, field_tesla, gm_m3_s2)
    own = conductor_ohm_per_m * length
    ohms = tuple(own + r for r in plasma_ohm)
    volts = tuple(induced + current_a * r for r in ohms)
    watts = tuple(current_a * v for v in volts)  # (4)
    work = thrust * sqrt(gm_m3_s2 / low)
    share = wire_field(current_a, neighbour_m) / field_tesla
    told = []
    if share > LARGE_SHARE:
        told.append(f"at {neighbour_m:g} m the current's own field is {share:.2f} of the Earth's: space the conductors further.")
    if thrust / mass_kg > MOST_ACCELERATION * gm_m3_s2 / low**2:
        told.append("the thrust is no longer small beside the weight; equation (1) is too short.")
    return ConductorDesign(
        thrust_n=thrust,
        length_m=length,
        induced_voltage_v=induced,
        conductor_resistance_ohm=own,
        resistance_ohm=(ohms[0], ohms[1]),
        voltage_v=(volts[0], volts[1]),
        power_w=(watts[0], watts[1]),
        energy_j=(watts[0] * transfer_s, watts[1] * transfer_s),
        efficiency=(work / watts[0], work / watts[1]),
        wire_field_tesla=wire_field(current_a, neighbour_m),
        wire_field_share=share,
        cautions=tuple(told),
    )


def _range(pair: tuple[float, float], factor: float = 1.0) -> str:
    """Least to most, rising."""
    low, high = sorted(factor * one for one in pair)
    return f"{low:.4g} to {high:.4g}" if high > low else f"{low:.4g}"


def _positive(given: dict) -> None:
    """InputError that names an argument which is no positive number."""
    low, high = given["plasma_ohm"]
    checked = {**{k: v for k, v in given.items() if k != "plasma_ohm"}, "plasma_ohm[0]": low, "plasma_ohm[1]": high}
    for name, value in checked.items():
        if isinstance(value, bool) or not isinstance(value, int | float) or not isfinite(value) or value <= 0.0:
            raise InputError(f"{name} must be a positive number; got {value!r}.")
    if high < low:
        raise InputError(f"plasma_ohm must be the least and the most, rising; got {low:g} and {high:g}.")
    if given["field_tesla"] > 1e-2:
        raise InputError(f"field_tesla = {given['field_tesla']:g}; in orbit it is 1e-5 to 6e-5. Is it in nT? Multiply by 1e-9.")
