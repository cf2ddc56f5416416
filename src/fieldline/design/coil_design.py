"""A designed coil: every number of it, in words, as a record, and beside what it could have been (the trade curve)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fieldline.design.coil import cautions, insulation_mass, outer_diameter, winding_area, wound
from fieldline.design.core import SHAPES, alloy
from fieldline.design.loop import PEAK_OVER_MEAN, Given, Loop, circle, rectangle, rod
from fieldline.design.wire import Conductor, conductor, gauge_area, gauge_name, gauge_number, nearest_gauge
from fieldline.errors import InputError

CURVE_POINTS = 121
CURVE_REACH = 16.0  # of the section, to both sides of the chosen one


@dataclass(frozen=True, kw_only=True)
class CoilDesign:
    """A coil that gives moment_a_m2 at current_a; SI, units in the names. Made by `design_coil`.

    section_area_m2 : conducting area of all turns, b.      winding_area_m2 : what the winding takes, insulation and gaps.
    mass_kg : wire, insulation and core.      product_w_kg : power times mass of the wire's metal, (18).
    """

    loop: Loop
    metal: Conductor
    temperature_c: float
    insulation_m: float
    moment_a_m2: float
    torque_n_m: float | None
    field_tesla: float | None
    gauge: str | None
    turns: int
    current_a: float
    ampere_turns: float
    voltage_v: float
    resistance_ohm: float
    power_w: float
    wire_diameter_m: float
    wire_area_m2: float
    wire_length_m: float
    section_area_m2: float
    winding_area_m2: float
    current_density_a_m2: float
    wire_mass_kg: float
    insulation_mass_kg: float
    core_mass_kg: float
    mass_kg: float
    product_w_kg: float
    cautions: tuple[str, ...]

    def record(self) -> dict[str, Any]:
        """Plain numbers and words, for JSON."""
        own = {k: v for k, v in vars(self).items() if k not in ("loop", "metal", "cautions")}
        head = {"shape": self.loop.words, "material": self.metal.name, "resistivity_ohm_m": self.resistivity_ohm_m}
        core = {}
        if self.loop.core_length_m is not None:
            core = {
                "core_gain": self.loop.gain,
                "demagnetising_factor": self.loop.demagnetising,
                "core_tesla": self.loop.core_tesla,
                "core_saturation_tesla": self.loop.saturation_tesla,
            }
        return head | own | core | {"cautions": list(self.cautions)}

    @property
    def resistivity_ohm_m(self) -> float:
        """Of the wire at its temperature."""
        return self.metal.resistivity_at(self.temperature_c)

    def rows(self) -> list[tuple[str, str]]:
        """Names and values with their units, for a table."""
        wire = f"{1e3 * self.wire_diameter_m:.4g} mm, {1e6 * self.wire_area_m2:.4g} mm²"
        rows = [
            ("shape", self.loop.words),
            ("moment", f"{self.moment_a_m2:.4g} A m²"),
            ("ampere-turns", f"{self.ampere_turns:.4g} A"),
            ("turns", f"{self.turns:,}"),
            ("current", f"{self.current_a:.4g} A"),
            ("voltage", f"{self.voltage_v:.4g} V"),
            ("resistance", f"{self.resistance_ohm:.4g} ohm at {self.temperature_c:g} °C"),
            ("power", f"{self.power_w:.4g} W"),
            ("mass", f"{self.mass_kg:.4g} kg"),
            ("wire", f"{self.gauge + ', ' if self.gauge else ''}{self.metal.name}, {wire}, {self.wire_length_m:.4g} m"),
            ("current density", f"{1e-6 * self.current_density_a_m2:.4g} A/mm²"),
            ("winding", f"{1e6 * self.winding_area_m2:.4g} mm² in section"),
            ("power times mass", f"{self.product_w_kg:.4g} W kg, whatever the section"),
        ]
        if self.torque_n_m is not None and self.field_tesla is not None:
            rows.insert(2, ("torque", f"{self.torque_n_m:.4g} N m across {1e9 * self.field_tesla:,.0f} nT"))
        if self.loop.core_length_m is None:
            return rows
        rows[-1] = ("power times mass", f"{self.product_w_kg:.4g} W kg of wire")
        return [
            *rows,
            (
                "core",
                f"gain {self.loop.gain:.4g}, demagnetising factor {self.loop.demagnetising:.4g}, {self.core_mass_kg:.4g} kg",
            ),
            ("induction", f"{self.loop.core_tesla:.3g} T in the mean, saturation {self.loop.saturation_tesla:g} T"),
        ]

    def summary(self) -> str:
        """The table as text, with the cautions below it."""
        rows = self.rows()
        width = max(len(name) for name, _ in rows) + 2
        return "\n".join([f"{name:<{width}}{value}" for name, value in rows] + [f"note: {one}" for one in self.cautions])

    def trade_curve(self):
        """Power against mass for the same moment and shape, as an xarray Dataset over section_area_m2.

        power_w, mass_kg (wire, insulation in proportion, core), wire_mass_kg, product_w_kg; the chosen point's in attrs.
        """
        import xarray as xr

        section = self.section_area_m2 * np.geomspace(1.0 / CURVE_REACH, CURVE_REACH, CURVE_POINTS)
        length = np.array([self.loop.turn_length_m(self.winding_area_m2 * s / self.section_area_m2) for s in section])
        power = self.ampere_turns**2 * self.resistivity_ohm_m * length / section  # (15)
        wire = section * length * self.metal.density_kg_m3  # (17)
        mass = wire * (1.0 + self.insulation_mass_kg / self.wire_mass_kg) + self.core_mass_kg
        variables = {
            "power_w": ("section_area_m2", power, {"units": "W", "long_name": "power at the whole moment"}),
            "mass_kg": ("section_area_m2", mass, {"units": "kg", "long_name": "mass of wire, insulation and core"}),
            "wire_mass_kg": ("section_area_m2", wire, {"units": "kg", "long_name": "mass of the wire's metal"}),
            "product_w_kg": ("section_area_m2", power * wire, {"units": "W kg", "long_name": "power times mass of the metal"}),
        }
        coordinate = ("section_area_m2", section, {"units": "m2", "long_name": "conducting area of all turns"})
        chosen = {"chosen_section_area_m2": self.section_area_m2, "power_w": self.power_w, "mass_kg": self.mass_kg}
        return xr.Dataset(variables, coords={"section_area_m2": coordinate}, attrs=chosen | {"shape": self.loop.words})


def design_coil(
    *,
    moment_a_m2: float | None = None,
    torque_n_m: float | None = None,
    field_tesla: float | None = None,
    diameter_m: float | None = None,
    sides_m: tuple[float, float] | None = None,
    core: str = "air",
    core_length_m: float | None = None,
    core_diameter_m: float | None = None,
    core_alloy: str = "4-79-permalloy",
    core_shape: str = "ellipsoid",
    wire: str | None = None,
    wire_area_m2: float | None = None,
    turns: int | None = None,
    current_a: float | None = None,
    voltage_v: float | None = None,
    power_w: float | None = None,
    mass_kg: float | None = None,
    mass_per_watt_kg: float | None = None,
    material: str | Conductor = "copper",
    temperature_c: float = 20.0,
    insulation_m: float = 0.0,
) -> CoilDesign:
    """The coil of a moment, or of a torque across a field, by equations (13) to (19) of `fieldline.design.coil`.

    Parameters
    ----------
    moment_a_m2, or torque_n_m and field_tesla : what the coil must do; the field across the coil's axis.
    diameter_m, or sides_m : a circle or a rectangle in air. core="rod" : core_length_m, core_diameter_m, core_alloy
        (`fieldline.design.core.ALLOYS`), core_shape ("ellipsoid" or "cylinder": which demagnetising factor).
    wire (a gauge), wire_area_m2, turns, current_a, voltage_v, power_w, mass_kg, mass_per_watt_kg : one from each of two
        of the groups that `fieldline.design.coil` names; voltage at the whole moment, mass with core and insulation.
    material, temperature_c : of the wire. insulation_m : its thickness on the wire's radius.

    Raises
    ------
    InputError : too little or too much given, a number that is not positive, a core that saturates or does not fit.
    """
    settings = dict(locals())
    _positive(settings)
    moment = _moment(moment_a_m2, torque_n_m, field_tesla)
    loop = _loop(moment, settings)
    metal = conductor(material)
    resistivity = metal.resistivity_at(temperature_c)
    if wire is not None and wire_area_m2 is not None:
        raise InputError("wire and wire_area_m2 are two names of one thing; give one of them.")
    area = gauge_area(gauge_number(wire)) if wire is not None else wire_area_m2
    kept = ("turns", "current_a", "voltage_v", "power_w", "mass_kg", "mass_per_watt_kg", "insulation_m")
    given = Given(wire_area_m2=area, **{name: settings[name] for name in kept})
    found = wound(given, loop, metal, resistivity)
    named = gauge_name(gauge_number(wire)) if wire is not None else _about(found.wire_area_m2)
    return _design(loop, metal, resistivity, found, moment, settings, named)


def _design(loop: Loop, metal: Conductor, resistivity: float, found, moment: float, settings: dict, gauge: str | None):
    """All that follows from turns, wire and shape."""
    n, area, length = found.turns, found.wire_area_m2, found.turn_length_m
    insulation = settings["insulation_m"]
    current = loop.ampere_turns / n  # (13)
    section = n * area
    resistance = n * n * length * resistivity / section  # (14)
    power = current * current * resistance  # (15)
    wire_kg = section * length * metal.density_kg_m3  # (17)
    insulation_kg = insulation_mass(n, area, insulation, length)
    told = list(cautions(current / area, area))
    if loop.core_tesla * PEAK_OVER_MEAN > loop.saturation_tesla > 0.0:
        told.append("the middle of the core may saturate: its induction is up to half as much again as the mean.")
    return CoilDesign(
        loop=loop,
        metal=metal,
        temperature_c=settings["temperature_c"],
        insulation_m=insulation,
        moment_a_m2=moment,
        torque_n_m=settings["torque_n_m"],
        field_tesla=settings["field_tesla"],
        gauge=gauge,
        turns=n,
        current_a=current,
        ampere_turns=loop.ampere_turns,
        voltage_v=current * resistance,
        resistance_ohm=resistance,
        power_w=power,
        wire_diameter_m=outer_diameter(area, 0.0),
        wire_area_m2=area,
        wire_length_m=n * length,
        section_area_m2=section,
        winding_area_m2=winding_area(n, area, insulation),
        current_density_a_m2=current / area,
        wire_mass_kg=wire_kg,
        insulation_mass_kg=insulation_kg,
        core_mass_kg=loop.core_mass_kg,
        mass_kg=wire_kg + insulation_kg + loop.core_mass_kg,
        product_w_kg=power * wire_kg,
        cautions=tuple(told),
    )


def _moment(moment_a_m2: float | None, torque_n_m: float | None, field_tesla: float | None) -> float:
    """The moment given, or torque over field."""
    if moment_a_m2 is not None:
        if torque_n_m is not None or field_tesla is not None:
            raise InputError("give moment_a_m2, or torque_n_m and field_tesla, not both.")
        return moment_a_m2
    if torque_n_m is None or field_tesla is None:
        raise InputError("what must the coil do? Give moment_a_m2, or torque_n_m together with field_tesla.")
    if field_tesla > 1e-3:
        raise InputError(f"field_tesla = {field_tesla:g}; in orbit it is 1e-5 to 6e-5. Is it in nT? Multiply by 1e-9.")
    return torque_n_m / field_tesla


def _loop(moment: float, settings: dict) -> Loop:
    """The one shape that was given."""
    core, diameter, sides = settings["core"], settings["diameter_m"], settings["sides_m"]
    core_length, core_diameter = settings["core_length_m"], settings["core_diameter_m"]
    if core not in ("air", "rod"):
        raise InputError(f'core must be "air" or "rod"; got {core!r}. The alloy of a rod is core_alloy.')
    if settings["core_shape"] not in SHAPES:
        raise InputError(f'core_shape must be "ellipsoid" or "cylinder"; got {settings["core_shape"]!r}.')
    if core == "rod":
        if core_length is None or core_diameter is None or diameter is not None or sides is not None:
            raise InputError("a rod takes core_length_m and core_diameter_m, and neither diameter_m nor sides_m.")
        return rod(moment, core_length, core_diameter, alloy(settings["core_alloy"]), settings["core_shape"])
    if core_length is not None or core_diameter is not None:
        raise InputError('core_length_m and core_diameter_m belong to core="rod".')
    if (diameter is None) == (sides is None):
        raise InputError("a coil in air takes either diameter_m or sides_m.")
    return circle(moment, diameter) if diameter is not None else rectangle(moment, (float(sides[0]), float(sides[1])))


def _about(area: float) -> str | None:
    """The nearest gauge, said to be near."""
    number = nearest_gauge(area)
    return None if number is None else f"about {gauge_name(number)}"


def _positive(settings: dict) -> None:
    """InputError for what must be a positive, finite number and is not."""
    for name, value in settings.items():
        if value is None or name in ("core", "core_alloy", "core_shape", "wire", "material", "temperature_c"):
            continue
        values = value if name == "sides_m" else (value,)
        least = 0.0 if name == "insulation_m" else 1e-300
        try:
            fine = all(not isinstance(one, bool) and least <= float(one) < np.inf for one in values)
            fine = fine and (name != "sides_m" or len(values) == 2) and (name != "turns" or float(value).is_integer())
        except (TypeError, ValueError):
            fine = False
        if not fine:
            kind = {"sides_m": "two positive numbers", "turns": "a whole number, 1 or more"}.get(name, "a positive number")
            raise InputError(f"{name} must be {kind}; got {value!r}.")
