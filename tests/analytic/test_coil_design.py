"""Coils, rods and wire: equations (13) to (19) of the 1961 study, gauges, demagnetising factors and their limits."""

from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import dblquad

from fieldline.design import CONDUCTORS, design_coil, gauge_table
from fieldline.design.core import ALLOYS, MU0, core_gain, core_induction, cylinder_factor, ellipsoid_factor
from fieldline.design.wire import conductor, gauge_area, gauge_diameter, gauge_name, gauge_number, nearest_gauge
from fieldline.errors import InputError

CIRCLE = {"moment_a_m2": 50.0, "diameter_m": 2.44}
ROD = {"moment_a_m2": 10.0, "core": "rod", "core_length_m": 0.5, "core_diameter_m": 0.012}
PAIRS = [
    {"current_a": 0.1, "wire": "AWG29"},
    {"turns": 200, "wire_area_m2": 5e-8},
    {"turns": 50, "voltage_v": 12.0},
    {"current_a": 0.2, "power_w": 3.0},
    {"turns": 80, "mass_kg": 0.6},
    {"current_a": 0.1, "mass_per_watt_kg": 0.2},
    {"wire": "AWG26", "power_w": 1.5},
    {"voltage_v": 28.0, "power_w": 2.0},
    {"voltage_v": 28.0, "mass_kg": 0.5},
    {"wire": "AWG30", "mass_per_watt_kg": 0.2},
]


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: "+".join(pair))
@pytest.mark.parametrize("shape", [CIRCLE, {"moment_a_m2": 0.5, "sides_m": (0.3, 0.2)}, ROD], ids=["circle", "rectangle", "rod"])
def test_every_pair_of_freedoms_obeys_the_equations(shape, pair):
    pair = pair | ({"mass_kg": pair["mass_kg"] + 0.5} if "mass_kg" in pair and shape is ROD else {})
    found = design_coil(**shape, **pair, insulation_m=1e-5)
    length = found.wire_length_m / found.turns
    assert found.turns * found.current_a * found.loop.area_m2 * found.loop.gain == pytest.approx(found.moment_a_m2)  # (13)
    assert found.resistance_ohm == pytest.approx(found.turns**2 * length * 1.7241e-8 / found.section_area_m2)  # (14)
    assert found.power_w == pytest.approx(found.current_a**2 * found.resistance_ohm)  # (15)
    assert found.wire_mass_kg == pytest.approx(found.section_area_m2 * length * 8890.0)  # (17)
    assert found.product_w_kg == pytest.approx(found.ampere_turns**2 * length**2 * 1.7241e-8 * 8890.0)  # (18)
    turns = found.voltage_v * found.section_area_m2 / (found.ampere_turns * length * 1.7241e-8)  # (19)
    assert found.turns == pytest.approx(turns)
    assert found.mass_kg == pytest.approx(found.wire_mass_kg + found.insulation_mass_kg + found.core_mass_kg)


@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: "+".join(pair))
def test_what_was_given_comes_back(pair):
    found = design_coil(**CIRCLE, **pair)
    whole = 1.0 / found.turns  # turns are whole
    for name, value in pair.items():
        if name == "wire":
            assert found.gauge == value and found.wire_area_m2 == gauge_area(int(value[3:]))
        elif name == "current_a":
            assert value * (1.0 - whole) <= found.current_a <= value * (1.0 + 1e-6)
        elif name == "power_w":
            assert value * (1.0 - whole) <= found.power_w <= value * (1.0 + 1e-6)
        elif name == "mass_kg":
            assert value * (1.0 - whole) <= found.mass_kg <= value * (1.0 + 1e-6)
        elif name != "mass_per_watt_kg":
            assert getattr(found, name) == pytest.approx(value)


def test_circle_has_its_closed_forms():
    found = design_coil(**CIRCLE, current_a=0.1, wire="AWG29")
    rho, sigma, d, b = 1.7241e-8, 8890.0, 2.44, found.section_area_m2
    assert found.power_w == pytest.approx(16.0 * 50.0**2 * rho / (pi * b * d**3))  # (16)
    assert found.mass_kg == pytest.approx(pi * d * b * sigma)  # (17)
    assert found.product_w_kg == pytest.approx(16.0 * 50.0**2 * rho * sigma / d**2)  # (18)


@settings(max_examples=60, deadline=None)
@given(st.floats(0.01, 500.0), st.floats(0.05, 5.0), st.floats(0.05, 20.0), st.sampled_from(sorted(CONDUCTORS)))
def test_product_is_the_same_whatever_the_section(moment, diameter, power, metal):
    one = design_coil(moment_a_m2=moment, diameter_m=diameter, power_w=power, turns=100, material=metal)
    other = design_coil(moment_a_m2=moment, diameter_m=diameter, power_w=7.0 * power, turns=30, material=metal)
    assert one.product_w_kg == pytest.approx(other.product_w_kg, rel=1e-9)
    double = design_coil(moment_a_m2=2.0 * moment, diameter_m=2.0 * diameter, power_w=power, turns=100, material=metal)
    assert double.product_w_kg == pytest.approx(one.product_w_kg, rel=1e-9)


@settings(max_examples=40, deadline=None)
@given(st.floats(0.01, 5.0), st.floats(0.2, 3.0))
def test_the_weight_of_a_watt_takes_the_least_whole(mass_per_watt, diameter):
    def whole(design):
        return design.mass_kg + mass_per_watt * design.power_w

    best = design_coil(moment_a_m2=20.0, diameter_m=diameter, turns=100, mass_per_watt_kg=mass_per_watt)
    for factor in (0.8, 1.25):
        other = design_coil(moment_a_m2=20.0, diameter_m=diameter, turns=100, power_w=best.power_w * factor)
        assert whole(other) > whole(best)
    assert best.mass_kg == pytest.approx(mass_per_watt * best.power_w)


def test_trade_curve_passes_through_the_coil_and_keeps_the_product():
    for shape in (CIRCLE, ROD):
        found = design_coil(**shape, wire="AWG29", turns=300, insulation_m=2e-5)
        curve = found.trade_curve()
        middle = len(curve["section_area_m2"]) // 2
        assert float(curve["power_w"][middle]) == pytest.approx(found.power_w)
        assert float(curve["mass_kg"][middle]) == pytest.approx(found.mass_kg)
        assert (np.diff(curve["power_w"]) < 0.0).all() and (np.diff(curve["mass_kg"]) > 0.0).all()
    air = design_coil(**CIRCLE, wire="AWG29", current_a=0.1).trade_curve()
    assert np.ptp(air["product_w_kg"].values) < 1e-12


def test_temperature_and_metal():
    cold, hot = (design_coil(**CIRCLE, wire="AWG29", current_a=0.1, temperature_c=t) for t in (20.0, 60.0))
    assert hot.power_w / cold.power_w == pytest.approx(1.0 + 40.0 * 3.93e-3)
    assert hot.mass_kg == cold.mass_kg
    light = design_coil(**CIRCLE, wire="AWG27", current_a=0.1, material="aluminum")
    assert light.product_w_kg / cold.product_w_kg == pytest.approx(2.8264e-8 * 2703.0 / (1.7241e-8 * 8890.0))


def test_gauges_of_the_standard():
    # ASTM B258: 0000 is 0.46 inch, 36 is 0.005 inch, by definition; 10 is 0.1019 inch, 40 is 0.0031 inch.
    inch = 0.0254
    for number, mil in ((-3, 460.0), (36, 5.0), (10, 101.9), (40, 3.1)):
        assert gauge_diameter(number) == pytest.approx(mil * 1e-3 * inch, abs=0.05e-3 * inch)
    assert gauge_number("awg 29") == gauge_number("29") == 29
    assert gauge_number("AWG4/0") == gauge_number("0000") == -3 and gauge_number("AWG0") == gauge_number("1/0") == 0
    assert [gauge_number(gauge_name(n)) for n in range(-3, 51)] == list(range(-3, 51))
    assert [nearest_gauge(1.05 * gauge_area(n)) for n in range(-3, 51)] == list(range(-3, 51))
    assert nearest_gauge(1e-3) is None and nearest_gauge(1e-12) is None
    rows = gauge_table("copper", first=29, last=30)
    assert rows[0].resistance_ohm_per_m * rows[0].area_m2 == pytest.approx(1.7241e-8)
    assert conductor("Aluminum") is CONDUCTORS["aluminium"]


def test_demagnetising_factors():
    assert ellipsoid_factor(1.0) == pytest.approx(1.0 / 3.0)
    assert ellipsoid_factor(1.0 + 4.9e-5) == pytest.approx(ellipsoid_factor(1.0 + 5.1e-5), abs=1e-6)
    assert ellipsoid_factor(10.0) == pytest.approx(0.0203, abs=5e-5)  # Osborn (1945), table I: N/4pi at m = 10
    assert ellipsoid_factor(1000.0) == pytest.approx((np.log(2000.0) - 1.0) / 1e6, rel=1e-4)
    assert cylinder_factor(1e-4) == pytest.approx(1.0, abs=1e-3)
    assert cylinder_factor(1.0) == pytest.approx(0.3116, abs=5e-5)  # 1 - 0.6884, Nagaoka's coefficient at l = d
    assert cylinder_factor(20.0) > 3.0 * ellipsoid_factor(20.0)
    assert cylinder_factor(10.0) == pytest.approx(2.0 * ellipsoid_factor(10.0), rel=0.05)


def test_cylinder_factor_is_the_energy_of_its_pole_discs():
    # Two discs of poles +-1: N V = 2 (S_near - S_far), S the mean potential of one disc over the other, 4 pi left out.
    slender, radius = 2.0, 0.5

    def between(gap):
        def along(k, _):
            return 0.0 if k == 0.0 else np.exp(-k * gap) * bessel(k * radius) ** 2 / k**2

        return 2.0 * pi * radius**2 * dblquad(along, 0.0, 1.0, 1e-9, 400.0, epsabs=1e-7)[0]

    from scipy.special import j1 as bessel

    near = 2.0 * pi * radius**2 * 4.0 * radius / (3.0 * pi)  # the integral of J1^2/k^2 in closed form
    energy = near - between(slender)
    assert energy / (pi * radius**2 * slender) == pytest.approx(cylinder_factor(slender), rel=2e-4)


def test_cores():
    assert core_gain(1.0, 0.02) == 1.0
    assert core_gain(1e9, 0.02) == pytest.approx(51.0, rel=1e-6)
    assert core_gain(20.0, 0.0) == pytest.approx(20.0)
    # Long and slender: B = mu0 mu_r H; moment with its own field.
    gain, volume = core_gain(100.0, 0.0), 1e-5
    assert core_induction(2.0, gain, 0.0, volume) == pytest.approx(MU0 * 100.0 * 2.0 / gain / volume)
    found = design_coil(**ROD, wire="AWG30", power_w=0.5)
    assert found.loop.gain == pytest.approx(core_gain(20000.0, ellipsoid_factor(0.5 / 0.012)))
    bare = design_coil(moment_a_m2=10.0 / found.loop.gain, diameter_m=0.012, wire="AWG30", turns=found.turns)
    assert bare.current_a == pytest.approx(found.current_a)
    careful = design_coil(**ROD, wire="AWG30", power_w=0.5, core_shape="cylinder")
    assert careful.ampere_turns > 3.0 * found.ampere_turns
    assert 0.0 < found.loop.core_tesla < ALLOYS["4-79-permalloy"].saturation_tesla
    thick = found.wire_length_m / found.turns
    assert thick == pytest.approx(pi * 0.012 + pi * found.winding_area_m2 / 0.5)


def test_a_core_that_saturates_is_refused_with_what_would_do():
    with pytest.raises(InputError, match=r"saturates at 0\.87 T: it takes 722 cm³") as told:
        design_coil(moment_a_m2=500.0, core="rod", core_length_m=0.3, core_diameter_m=0.01, wire="AWG29", power_w=1.0)
    least = float(str(told.value).split("above ")[1].split(" mm")[0]) * 1e-3
    fine = design_coil(
        moment_a_m2=500.0, core="rod", core_length_m=0.3, core_diameter_m=1.2 * least, core_alloy="iron", wire="AWG29", turns=100
    )
    assert fine.loop.core_tesla < 2.15
    near = design_coil(**(ROD | {"core_diameter_m": 0.0065}), wire="AWG29", turns=1000)
    assert any("middle of the core" in one for one in near.cautions)


def test_summary_and_record_tell_the_same():
    import json

    found = design_coil(torque_n_m=5e-4, field_tesla=1e-5, diameter_m=2.44, current_a=0.1, wire="AWG29", insulation_m=2e-5)
    text, record = found.summary(), json.loads(json.dumps(found.record()))
    assert "107" in text and "AWG29" in text and "10,000 nT" in text
    assert record["turns"] == 107 and record["moment_a_m2"] == pytest.approx(50.0)
    assert sqrt(record["wire_area_m2"] * 4 / pi) == pytest.approx(record["wire_diameter_m"])
    hot = design_coil(moment_a_m2=0.2, diameter_m=0.08, wire="AWG44", turns=30)
    assert len(hot.cautions) == 2 and "note: " in hot.summary()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({}, "what must the coil do"),
        ({"torque_n_m": 1e-3}, "field_tesla"),
        ({"moment_a_m2": 5.0, "field_tesla": 1e-5}, "not both"),
        ({"torque_n_m": 1e-3, "field_tesla": 25000.0}, "nT"),
        ({"moment_a_m2": -5.0}, "moment_a_m2 must be a positive number; got -5"),
        ({"moment_a_m2": float("nan")}, "moment_a_m2"),
        ({"moment_a_m2": 5.0}, "diameter_m or sides_m"),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "sides_m": (1.0, 1.0)}, "diameter_m or sides_m"),
        ({"moment_a_m2": 5.0, "sides_m": (1.0,)}, "sides_m must be two"),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0}, "leave the coil open"),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "wire": "AWG29"}, "wire alone leaves"),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "wire": "AWG29", "voltage_v": 5.0}, "wire and voltage_v fix the same"),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "turns": 5, "current_a": 5.0}, "turns and current_a"),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "wire": "AWG29", "turns": 5, "power_w": 1.0}, "one too many"),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "wire": "AWG29", "wire_area_m2": 1e-7, "turns": 5}, "two names"),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "wire": "29 mm", "turns": 5}, "no gauge"),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "wire": "AWG77", "turns": 5}, "out of the tables"),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "wire": "AWG29", "turns": 5.5}, "whole number"),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "wire": "AWG29", "turns": 5, "material": "coper"}, 'did you mean "copper"'),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "wire": "AWG29", "turns": 5, "temperature_c": 293.0}, "kelvin"),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "wire": "AWG29", "turns": 5, "core": "iron"}, 'core must be "air" or "rod"'),
        ({"moment_a_m2": 5.0, "diameter_m": 1.0, "core_length_m": 1.0}, "belong to core"),
        ({"moment_a_m2": 5.0, "core": "rod", "diameter_m": 1.0}, "core_length_m"),
        (ROD | {"core_alloy": "mu-metal"}, "mumetal"),
        (ROD | {"core_length_m": 0.001}, "above core_diameter_m"),
        (ROD | {"core_shape": "box"}, "core_shape"),
        (ROD | {"wire": "AWG29", "mass_kg": 0.1}, "leaves nothing for the wire"),
    ],
)
def test_bad_input_is_named(arguments, words):
    with pytest.raises(InputError, match=words):
        design_coil(**arguments)
