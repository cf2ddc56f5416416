"""White, Shigemoto and Bourquin (1961), NASA TN D-1068: momentum dumped, and the coil of its numerical example.

The study prints 10.7 ampere-turns, N = 107, I = 100 ma, 2.21 W and 0.473 kg with "gage No. 25"; the figures of dumping
are those of an independent simulation.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fieldline.cases.ames_1961 import coil, coils_against_jets, dump, field
from fieldline.constants import EARTH_GM_M3_S2, EARTH_MEAN_RADIUS_M
from fieldline.design import design_coil
from fieldline.design.wire import gauge_area, gauge_diameter, gauge_table
from fieldline.errors import InputError

POUND_KG, FOOT_M = 0.45359237, 0.3048
ALTITUDE_OF_6050_S = (EARTH_GM_M3_S2 * (6050.0 / (2.0 * np.pi)) ** 2) ** (1.0 / 3.0) - EARTH_MEAN_RADIUS_M


def test_the_coil_of_the_observatory():
    found = {name: float(value) for name, value in coil().items() if value.ndim == 0}
    assert found["moment_a_m2"] == pytest.approx(50.0, rel=1e-12)
    assert found["ampere_turns"] == pytest.approx(10.693, abs=5e-4)
    assert found["turns"] == 107
    assert found["current_a"] == pytest.approx(0.1, rel=1e-3) and found["current_a"] <= 0.1
    assert found["wire_length_m"] == pytest.approx(820.2, abs=0.05)
    assert found["resistance_ohm"] == pytest.approx(220.2, abs=0.05)
    assert found["power_w"] == pytest.approx(2.20, abs=5e-3)  # printed: 2.21
    assert found["mass_kg"] == pytest.approx(0.468, abs=5e-4)  # printed: 0.473
    assert found["product_w_kg"] == pytest.approx(1.0298, abs=5e-5)  # printed: 2.21 x 0.473 = 1.0453
    assert (found["power_w"], found["mass_kg"]) == pytest.approx((2.21, 0.473), rel=0.011)


def test_the_gauge_that_the_scan_lost():
    ohm, kg = 2.21 / 0.1**2, 0.473
    per_foot = 1000.0 * FOOT_M / 820.2
    assert ohm * per_foot == pytest.approx(82.13, abs=5e-3)
    assert kg * per_foot / POUND_KG == pytest.approx(0.3875, abs=5e-5)
    gauges = np.arange(20, 40)
    resistance = [row.resistance_ohm_per_m * 1000.0 * FOOT_M for row in gauge_table(first=20, last=39)]
    mass = [row.mass_kg_per_m * 1000.0 * FOOT_M / POUND_KG for row in gauge_table(first=20, last=39)]
    assert np.interp(np.log(82.13), np.log(resistance), gauges) == pytest.approx(29.02, abs=5e-3)
    assert np.interp(-np.log(0.3875), -np.log(mass), gauges) == pytest.approx(28.96, abs=1.5e-2)
    assert resistance[9] == pytest.approx(81.83, abs=5e-3)  # the printed tables' value for AWG 29
    wrong = coil(wire="AWG25")
    assert float(wrong["power_w"]) == pytest.approx(0.871, abs=3e-3)
    assert float(wrong["mass_kg"]) == pytest.approx(1.184, abs=5e-4)


def test_voltage_and_its_turns():
    # 22.1 V are 2.21 W at 0.1 A; (19) with the section of 107 turns of AWG 29.
    section = 107.0 * gauge_area(29)
    assert 22.1 * section * 2.44 / (4.0 * 50.0 * 1.7241e-8) == pytest.approx(107.5, abs=0.06)
    found = design_coil(moment_a_m2=50.0, diameter_m=2.44, voltage_v=22.1, power_w=2.21)
    assert found.turns == 107 and found.gauge == "about AWG29"
    assert gauge_diameter(36) == pytest.approx(0.127e-3) and gauge_diameter(-3) == pytest.approx(11.684e-3, rel=1e-12)


@pytest.mark.kernels
def test_momentum_left_after_each_orbit():
    run = dump(altitude_m=ALTITUDE_OF_6050_S)
    at = np.arange(7) * run.attrs["period_s"]
    left = np.interp(at, run["seconds"].values, run["fraction"].values)
    assert left == pytest.approx([1.0, 0.28806, 0.09102, 0.03002, 0.00997, 0.00327, 0.00104], abs=1e-5)


def test_the_part_along_the_field_is_left_and_goes_as_the_field_turns():
    run = dump()
    along = field(35.0, step_s=10.0, duration_s=600.0)
    b = along["field_i"].values / along["magnitude"].values[:, None]
    start = dump(momentum=tuple(b[0]), orbits=0.01)
    assert float(start["fraction"][1]) == pytest.approx(1.0, abs=1e-5)  # nothing across the field, nothing goes yet
    assert np.cross(run["moment"].values[5], run["momentum"].values[5]) @ run["moment"].values[5] == pytest.approx(0.0, abs=1e-6)
    assert (np.diff(run["fraction"].values) <= 0.0).all()
    assert dump(momentum=tuple(b[0]), orbits=3.0)["fraction"].values[-1] < 0.1
    decay = -np.log(run["fraction"].values[-1]) / run["seconds"].values[-1]
    assert run["eigenvalue"].values.min() * 3e-4 < decay < run["eigenvalue"].values.max() * 3e-4


@pytest.mark.kernels
def test_dumping_against_an_adaptive_solver():
    run = dump(orbits=2.0)
    day = field(35.0, duration_s=13000.0, step_s=5.0)
    b = day["field_i"].values / day["magnitude"].values[:, None]

    def rate(t, h):
        here = np.array([np.interp(t, day["seconds"].values, b[:, k]) for k in range(3)])
        return -3e-4 * (h - here * (here @ h))

    solved = solve_ivp(rate, (0.0, run["seconds"].values[-1]), [1.0, 1.0, 1.0], rtol=1e-9, atol=1e-12, max_step=60.0)
    assert run["momentum"].values[-1] == pytest.approx(solved.y[:, -1], abs=2e-6)


def test_saturated_coils_dump_slower_and_a_load_leaves_a_rest():
    free, weak = dump(orbits=1.0), dump(orbits=1.0, moment_limit_a_m2=5.0)
    assert float(weak["fraction"][-1]) > 1.5 * float(free["fraction"][-1])
    assert np.abs(weak["moment"].values).max() <= 5.0
    loaded = dump(load_n_m=(0.0, 1e-5, 0.0), momentum=(1e-3, 0.0, 0.0), orbits=10.0)
    size = np.linalg.norm(loaded["momentum"].values[-2000:], axis=1)
    assert 0.5 * 1e-5 / 3e-4 < size.mean() < 3.0 * 1e-5 / 3e-4  # load over K and the eigenvalues


def test_coils_against_jets():
    found = {name: float(value) for name, value in coils_against_jets(1.0, arm_m=1.2, specific_impulse_s=70.0).items()}
    assert found["propellant_per_dump_kg"] == pytest.approx(1.0 / (1.2 * 9.80665 * 70.0))
    assert found["propellant_kg"] == pytest.approx(found["propellant_per_dump_kg"] * 365.25 * 86400.0 / 6050.0)
    assert found["coil_kg"] == pytest.approx(3 * 0.473 + 3 * 2.21 * 0.2)
    even = coils_against_jets(1.0, arm_m=1.2, specific_impulse_s=70.0, years=found["even_after_days"] / 365.25)
    assert float(even["propellant_kg"]) == pytest.approx(found["coil_kg"])


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: dump(momentum=(0.0, 0.0, 0.0)), "momentum"),
        (lambda: dump(momentum=(1.0, 2.0)), "momentum"),
        (lambda: dump(gain_per_s=-1.0), "gain_per_s"),
        (lambda: dump(orbits=0.0), "orbits"),
        (lambda: coils_against_jets(-1.0), "momentum_n_m_s"),
        (lambda: coil(wire="AWG99"), "AWG99"),
        (lambda: coil(field_tesla=1e4), "field_tesla"),
    ],
)
def test_bad_input_is_named(call, words):
    with pytest.raises(InputError, match=words):
        call()
