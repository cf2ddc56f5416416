"""The coil of the Orbiting Astronomical Observatory, the study's numerical example of (13) to (19).

The scan of the study reads "gage No. 25". 2.21 W at 0.1 A are 221 ohm on 820 m of wire, 82.1 ohm per 1,000 ft, and 0.473 kg
are 0.388 lb per 1,000 ft: both are AWG 29. No. 25 would take 0.87 W and weigh 1.18 kg.
"""

from __future__ import annotations

from fieldline.cases.ames_1961.dipole_field import SOURCE, settings_text
from fieldline.design import CoilDesign, design_coil

SCALARS = {
    "moment_a_m2": ("A m2", "magnetic moment"),
    "ampere_turns": ("A", "ampere-turns"),
    "turns": ("1", "turns"),
    "current_a": ("A", "current at the whole moment"),
    "voltage_v": ("V", "voltage at the whole moment"),
    "resistance_ohm": ("ohm", "resistance"),
    "power_w": ("W", "power at the whole moment"),
    "mass_kg": ("kg", "mass of the wire"),
    "wire_length_m": ("m", "length of the wire"),
    "wire_diameter_m": ("m", "diameter of the bare wire"),
    "product_w_kg": ("W kg", "power times mass, (18)"),
}


def coil(
    torque_n_m: float = 5e-4,
    field_tesla: float = 1e-5,
    diameter_m: float = 2.44,
    current_a: float = 0.1,
    wire: str = "AWG29",
    *,
    material: str = "copper",
    temperature_c: float = 20.0,
):
    """The coil of a torque across a field, as a Dataset of scalars, and the trade of power against mass beside it.

    Parameters
    ----------
    torque_n_m, field_tesla, diameter_m : what it must do, and its size. current_a : turns are rounded up to keep it.
    wire : gauge; material, temperature_c : of the wire.

    Returns
    -------
    Dataset: moment_a_m2, ampere_turns, turns, current_a, voltage_v, resistance_ohm, power_w, mass_kg and more as scalars;
    trade_power_w and trade_mass_kg over section_area_m2.
    """
    settings = dict(locals())
    return dataset_of(design_coil(**settings), settings)


def dataset_of(design: CoilDesign, settings: dict):
    """Scalars and trade curve of a design."""
    curve = design.trade_curve()
    dataset = curve[["power_w", "mass_kg"]].rename(power_w="trade_power_w", mass_kg="trade_mass_kg")
    for name, (units, words) in SCALARS.items():
        dataset[name] = ((), float(getattr(design, name)), {"units": units, "long_name": words})
    dataset.attrs = {
        "title": f"Coil of {design.moment_a_m2:.4g} A m², {design.loop.words}, {design.gauge}",
        "case": "ames_1961_coil",
        "source": f"{SOURCE}, equations (13) to (19)",
        "settings_json": settings_text(settings),
    }
    return dataset
