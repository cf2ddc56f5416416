"""Wire: conductors with their data, gauges, and what a length of wire resists and weighs.

    d = 0.127 mm * 92^((36 - n) / 39)               diameter of AWG n; 0, 2/0, 3/0, 4/0 are n = 0, -1, -2, -3    (1)
    rho(T) = rho_20 (1 + alpha (T - 20 C))          linear, good to 1 % between -100 and 200 C                    (2)

Sources: (1) ASTM B258-18. Copper: IEC 60028 (1925), 100 % IACS, with the 8,890 kg/m^3 that it states. Aluminium: IEC
60889 (1987), 61 % IACS, hard drawn. Silver: CRC Handbook of Chemistry and Physics, 97th ed., s. 12, elements at 20 C.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from math import pi, sqrt

from fieldline.errors import InputError, nearest, shown

COARSEST, FINEST = -3, 50  # AWG 4/0 to 50
LEAST_TEMPERATURE_C, MOST_TEMPERATURE_C = -150.0, 250.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Conductor:
    """A metal of a wire: resistivity at 20 C [ohm m], its rise per kelvin of (2) [1/K], density [kg/m^3]."""

    name: str
    resistivity_ohm_m: float
    temperature_coefficient_per_k: float
    density_kg_m3: float
    source: str

    def resistivity_at(self, temperature_c: float) -> float:
        """Resistivity [ohm m] at a temperature; equation (2)."""
        if not LEAST_TEMPERATURE_C <= temperature_c <= MOST_TEMPERATURE_C:
            raise InputError(
                f"temperature_c must lie between {LEAST_TEMPERATURE_C:g} and {MOST_TEMPERATURE_C:g}, where resistivity is nearly "
                f"linear; got {temperature_c:g}. Is it in kelvin? Subtract 273.15."
            )
        return self.resistivity_ohm_m * (1.0 + self.temperature_coefficient_per_k * (temperature_c - 20.0))


CONDUCTORS = {
    one.name: one
    for one in (
        Conductor(
            name="copper",
            resistivity_ohm_m=1.7241e-8,
            temperature_coefficient_per_k=3.93e-3,
            density_kg_m3=8890.0,
            source="IEC 60028 (1925)",
        ),
        Conductor(
            name="aluminium",
            resistivity_ohm_m=2.8264e-8,
            temperature_coefficient_per_k=4.03e-3,
            density_kg_m3=2703.0,
            source="IEC 60889 (1987)",
        ),
        Conductor(
            name="silver",
            resistivity_ohm_m=1.587e-8,
            temperature_coefficient_per_k=3.8e-3,
            density_kg_m3=10490.0,
            source="CRC Handbook, 97th ed., s. 12",
        ),
    )
}


def conductor(name: str | Conductor) -> Conductor:
    """A conductor by name; "aluminum" is aluminium."""
    if isinstance(name, Conductor):
        return name
    plain = str(name).strip().lower().replace("aluminum", "aluminium")
    if plain not in CONDUCTORS:
        raise InputError(f'unknown material "{shown(str(name))}"; {nearest(plain, CONDUCTORS)}')
    return CONDUCTORS[plain]


def gauge_number(wire: str) -> int:
    """n of (1) from "AWG29", "awg 29", "29", "AWG2/0" or "AWG00"."""
    match = re.fullmatch(r"(?:awg)?[\s-]*(?:(\d)/0|(0{1,4})|(\d{1,2}))", str(wire).strip(), re.IGNORECASE)
    if match is None:
        raise InputError(f'the wire "{shown(str(wire))}" is no gauge; write AWG29, or AWG2/0 for the thick ones.')
    aught, zeros, digits = match.groups()
    number = int(digits) if digits else 1 - (int(aught) if aught else len(zeros))
    if not COARSEST <= number <= FINEST or (aught is not None and number > 0):
        raise InputError(f'the wire "{shown(str(wire))}" is out of the tables: AWG4/0 to AWG{FINEST}.')
    return number


def gauge_name(number: int) -> str:
    """For example AWG29, AWG0, AWG2/0."""
    return f"AWG{number}" if number >= 0 else f"AWG{1 - number}/0"


def gauge_diameter(number: int) -> float:
    """Diameter [m] of the bare wire; equation (1)."""
    return 0.127e-3 * 92.0 ** ((36 - number) / 39.0)


def gauge_area(number: int) -> float:
    """Cross-section [m^2] of the bare wire."""
    return 0.25 * pi * gauge_diameter(number) ** 2


def nearest_gauge(area_m2: float) -> int | None:
    """The gauge whose cross-section is nearest by ratio; None beyond the tables by more than half a gauge."""
    from math import log

    exact = 36.0 - 39.0 * log(sqrt(4.0 * area_m2 / pi) / 0.127e-3) / log(92.0)
    return round(exact) if COARSEST - 0.5 <= exact <= FINEST + 0.5 else None


@dataclass(frozen=True, slots=True)
class GaugeRow:
    """A row of the gauge table: bare diameter [m], cross-section [m^2], resistance [ohm/m], mass [kg/m]."""

    name: str
    diameter_m: float
    area_m2: float
    resistance_ohm_per_m: float
    mass_kg_per_m: float


def gauge_table(
    material: str | Conductor = "copper", temperature_c: float = 20.0, first: int = 0, last: int = 40
) -> list[GaugeRow]:
    """The rows of the gauges first to last, of a material at a temperature."""
    if not COARSEST <= first <= last <= FINEST:
        raise InputError(f"first and last must rise and lie between {COARSEST} (AWG4/0) and {FINEST}; got {first} and {last}.")
    metal = conductor(material)
    resistivity = metal.resistivity_at(temperature_c)
    rows = []
    for number in range(first, last + 1):
        area = gauge_area(number)
        rows.append(GaugeRow(gauge_name(number), gauge_diameter(number), area, resistivity / area, metal.density_kg_m3 * area))
    return rows
