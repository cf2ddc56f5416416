"""Units of telemetry and their factors to SI: value_si = factor * number + offset.

A unit is recognised by its spelling with signs folded away: "deg/s", "deg_s", "°/s" and "dps" are one. Letter case
is forgiven, as no instrument speaks in megatesla: "NT" is nT and "MG" is mG.
"""

from __future__ import annotations

import math
import re
from typing import NamedTuple

from fieldline.errors import InputError, nearest

DEGREE = math.pi / 180.0


class Unit(NamedTuple):
    """A unit's usual spelling, its factor and its offset to SI."""

    name: str
    factor: float
    offset: float = 0.0


COUNTS = Unit("counts", math.nan)  # a number of the converter, which means nothing before it is scaled

_FIELD = {
    Unit("T", 1.0): "T tesla teslas",
    Unit("mT", 1e-3): "mT millitesla",
    Unit("uT", 1e-6): "uT microtesla microteslas utesla mcT",
    Unit("nT", 1e-9): "nT nanotesla nanoteslas ntesla gamma",
    Unit("G", 1e-4): "G gauss Gs",
    Unit("mG", 1e-7): "mG milligauss mGs mgauss",
    Unit("uG", 1e-10): "uG microgauss",
    COUNTS: "counts count lsb adc dn ticks",
}
_RATE = {
    Unit("rad/s", 1.0): "rad_s rads rad_sec radps rad_per_s rad_per_sec radians_per_second rad_s_1 rad_s1",
    Unit("mrad/s", 1e-3): "mrad_s mradps mrads",
    Unit(
        "deg/s", DEGREE
    ): "dps deg_s degs degps deg_sec deg_per_s deg_per_sec degrees_per_second degree_s degrees_s deg_s_1 deg_s1",
    Unit("mdeg/s", 1e-3 * DEGREE): "mdps mdeg_s mdegs",
    Unit("deg/h", DEGREE / 3600.0): "deg_h degh deg_hr deg_per_h deg_hour dph",
    Unit("rpm", 2.0 * math.pi / 60.0): "rpm rev_min rev_per_min revmin",
    Unit("Hz", 2.0 * math.pi): "hz rps rev_s rev_per_s",
    COUNTS: "counts count lsb adc",
}
_DIPOLE = {
    Unit("A m2", 1.0): "a_m2 am2 a_m_2 am_2 am_sq a_m_sq a_msq amsq",
    Unit("mA m2", 1e-3): "ma_m2 mam2 ma_m_2 mam_2 mamsq",
    Unit("uA m2", 1e-6): "ua_m2 uam2 ua_m_2",
}
_TEMPERATURE = {
    Unit("K", 1.0): "k kelvin degk",
    Unit("degC", 1.0, 273.15): "degc deg_c c celsius",
    Unit("degF", 5.0 / 9.0, 273.15 - 160.0 / 9.0): "degf deg_f f fahrenheit",
}
_CURRENT = {Unit("A", 1.0): "a amp amps ampere", Unit("mA", 1e-3): "ma milliamp milliampere", Unit("uA", 1e-6): "ua microampere"}
_LENGTH = {
    Unit("m", 1.0): "m metre metres meter meters",
    Unit("km", 1e3): "km kilometre kilometres kilometer kilometers",
    Unit("ft", 0.3048): "ft feet foot",
}
_ANGLE = {
    Unit("deg", DEGREE): "deg degree degrees degrees_north degrees_east degree_north degree_east",
    Unit("rad", 1.0): "rad radian radians",
}
_READING = {
    Unit("mA", 1.0): "ma",
    Unit("A", 1.0): "a",
    Unit("V", 1.0): "v",
    Unit("mV", 1.0): "mv",
    Unit("counts", 1.0): "counts lsb adc",
}

# Quantity: its units. A sun sensor's reading is kept as it is, whatever its unit.
UNITS_OF = {
    "magnetometer": _FIELD,
    "gyro": _RATE,
    "wheel_speed": _RATE,
    "dipole_command": _DIPOLE,
    "temperature": _TEMPERATURE,
    "solar_current": _CURRENT,
    "sun_sensor": _READING,
    "position": _LENGTH,
    "angle": _ANGLE,
    "yaw": _ANGLE,
}


def folded(text: str) -> str:
    """A unit's spelling with signs folded: "[A·m²]" is "a_m2" in its own case, "°/s" is "deg_s"."""
    text = text.replace("µ", "u").replace("μ", "u").replace("²", "2").replace("°", "deg").replace("⁻¹", "-1")
    text = re.sub(r"[\^{}\[\]()]", "", text.strip())
    return re.sub(r"[\s/·.*_\-]+", "_", text).strip("_")


def _spellings(quantity: str) -> dict[str, Unit]:
    return {spelling: unit for unit, spellings in UNITS_OF[quantity].items() for spelling in spellings.split()}


def find_unit(text: str, quantity: str) -> Unit | None:
    """The unit of `quantity` that `text` spells, or None."""
    spellings = _spellings(quantity)
    key = folded(text)
    if key in spellings:
        return spellings[key]
    lower = [unit for spelling, unit in spellings.items() if spelling.lower() == key.lower()]
    return lower[0] if lower else None


def parse_unit(text, quantity: str, where: str) -> Unit:
    """The unit that a user names: a known one, or a number of SI or of a unit per count ("15.36 nT", 1e-9)."""
    if isinstance(text, (int, float)) and not isinstance(text, bool):
        return _scaled(float(text), Unit("", 1.0), str(text), where)
    unit = find_unit(str(text), quantity)
    if unit is not None:
        return unit
    number = re.fullmatch(r"\s*([-+0-9.eE]+)\s*(.*?)\s*(?:per count|/ ?count|/ ?lsb)?\s*", str(text))
    base = find_unit(number.group(2), quantity) if number else None
    if number and base and base is not COUNTS:
        try:
            return _scaled(float(number.group(1)), base, str(text), where)
        except ValueError:
            pass
    known = sorted(unit.name for unit in UNITS_OF[quantity])
    raise InputError(
        f'{where}: "{text}" is no unit of the {quantity.replace("_", " ")}; {nearest(str(text), known)} '
        f'(units: {", ".join(known)}; or a scale such as "15.36 {known[-1]}").'
    )


def _scaled(number: float, base: Unit, text: str, where: str) -> Unit:
    if not math.isfinite(number) or number == 0.0:
        raise InputError(f"{where}: a scale must be a finite number other than zero; got {text}.")
    return Unit(f"{text} per count", number * base.factor, 0.0)
