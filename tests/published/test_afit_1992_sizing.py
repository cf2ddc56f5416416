"""Lawrence (1992), AFIT/GA/ENY/92D-05, chapter 5 and appendix C: the climb, its conductor and supply, the R-BAR's length."""

import numpy as np
import pytest

from fieldline.cases.afit_1992 import transfer
from fieldline.cases.afit_1992.earth import GM_M3_S2
from fieldline.constants import SECONDS_PER_DAY
from fieldline.design.conductor import (
    design_conductor,
    farthest_hold,
    holding_length,
    induced_voltage,
    transfer_time,
    wire_field,
)
from fieldline.errors import InputError

N2 = 1.28e-6
HOLD = {"current_a": 125.0, "field_tesla": 2.6e-5, "mean_motion_rad_s": N2**0.5, "kg_per_m": 7.3}
CLIMB = {"mass_kg": 5e4, "low_altitude_m": 3e5, "high_altitude_m": 4.6e5, "transfer_s": 30 * 86400.0, "current_a": 125.0}


def test_transfer():
    found = transfer()
    assert float(found["thrust_n"]) == pytest.approx(1.7542, abs=5e-5)  # printed: 1.75
    assert float(found["length_m"]) == pytest.approx(620.96, abs=0.02)  # printed: 620 (in the scan, 6S0)
    assert 1.75 / (125.0 * 2.26e-5) == pytest.approx(619.5, abs=0.05)  # with the rounded thrust
    assert induced_voltage(6.678e6, 620.0, 2.26e-5, GM_M3_S2, 7.292115e-5) == pytest.approx(101.45, abs=5e-3)
    assert float(found["induced_voltage_v"]) == pytest.approx(101.45 * 620.96 / 620.0, abs=0.02)  # printed: 101
    assert found["power_w"].values == pytest.approx([29.0e3, 325.9e3], rel=3e-3)  # printed: 44, 325 kW
    # 44 kW is not of 1 ohm but of 2.05.
    assert 125.0 * 101.45 + 125.0**2 * 1.05 == pytest.approx(29.09e3, abs=10.0)
    assert 125.0 * 101.45 + 125.0**2 * 2.05 == pytest.approx(44.7e3, abs=50.0)
    assert float(found["wire_field_tesla"]) == pytest.approx(5.0e-6, rel=1e-12)
    assert float(found["wire_field_share"]) == pytest.approx(0.22, abs=2e-3)  # "approximately one-fourth"
    assert "space the conductors" in found.attrs["cautions"]
    altitude = found["altitude_m"].values
    assert altitude[[0, -1]] == pytest.approx([300e3, 460e3], abs=1e-3) and (np.diff(altitude) > 0.0).all()


def test_the_climb_is_the_integral_of_its_thrust():
    from scipy.integrate import solve_ivp

    # The averaged circle: dr/dt = 2 a sqrt(r^3/GM); and the true spiral flown with the same thrust.
    found = design_conductor(**CLIMB, field_tesla=2.26e-5, gm_m3_s2=GM_M3_S2, earth_radius_m=6.378e6)
    push = found.thrust_n / 5e4
    r0 = 6.678e6

    def rate(_, s):
        r = np.hypot(s[0], s[1])
        v = np.hypot(s[2], s[3])
        return [s[2], s[3], *(-GM_M3_S2 * s[:2] / r**3 + push * s[2:] / v)]

    half_day = 43200.0
    flown = solve_ivp(rate, (0.0, half_day), [r0, 0.0, 0.0, np.sqrt(GM_M3_S2 / r0)], method="DOP853", rtol=1e-11, atol=1e-4)
    x, y, u, v = flown.y[:, -1]
    axis = 1.0 / (2.0 / np.hypot(x, y) - (u * u + v * v) / GM_M3_S2)
    speed = np.sqrt(GM_M3_S2 / r0) - push * half_day
    assert axis - r0 == pytest.approx(GM_M3_S2 / speed**2 - r0, rel=1e-3)
    assert transfer_time(5e4, r0, 6.838e6, found.thrust_n, GM_M3_S2) == pytest.approx(30 * SECONDS_PER_DAY)


def test_efficiency_is_the_back_voltage_over_the_whole():
    found = design_conductor(**CLIMB, field_tesla=2.26e-5)
    for volts, share in zip(found.voltage_v, found.efficiency, strict=True):
        # Work on the orbit is F v; what the current gives against v B L alone, the Earth's turn aside.
        spin = 7.292115e-5 * (6378136.6 + 3e5)
        speed = np.sqrt(3.986004418e14 / (6378136.6 + 3e5))
        assert share == pytest.approx(found.induced_voltage_v / volts * speed / (speed - spin), rel=1e-12)


def test_r_bar_length():
    towers = {"body_mass_kg": 31300.0, "other_towers_m": 140.0}
    assert holding_length(100.0, **HOLD, **towers) == pytest.approx(14329.0, abs=1.0)  # printed: 14,000
    assert holding_length(50.0, **HOLD, **towers) == pytest.approx(1731.8, abs=0.1)  # printed: 1,700
    assert farthest_hold(**HOLD) == pytest.approx(115.9, abs=0.05)
    length = holding_length(80.0, **HOLD, **towers)
    assert 2.0 * length * 125.0 * 2.6e-5 == pytest.approx(3.0 * N2 * 80.0 * (31300.0 + 14.6 * (length + 140.0)), rel=1e-12)
    with pytest.raises(InputError, match=r"no length of conductor holds 116 m.* under 115\.9 m"):
        holding_length(116.0, **HOLD, **towers)


def test_wire_field():
    assert wire_field(125.0, 5.0) == pytest.approx(4e-7 * np.pi * 125.0 / (2.0 * np.pi * 5.0), rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"mass_kg": 0.0}, "mass_kg must be a positive number"),
        ({"high_altitude_m": 2e5}, "high_altitude_m must be above low_altitude_m"),
        ({"field_tesla": 22600.0}, "Is it in nT"),
        ({"plasma_ohm": (20.0, 1.0)}, "plasma_ohm must be the least and the most"),
        ({"current_a": float("nan")}, "current_a must be a positive number"),
    ],
)
def test_bad_input(arguments, words):
    with pytest.raises(InputError, match=words):
        design_conductor(**{**CLIMB, "field_tesla": 2.26e-5, **arguments})
