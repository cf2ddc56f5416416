"""Lawrence (1992), AFIT/GA/ENY/92D-05: the vehicle, its linear model, what it can reach.

Printed numbers are of appendices D and E; the matrices are typed from the program of appendix F; the rest was found by an
independent re-derivation with its own program.
"""

import numpy as np
import pytest

from fieldline.analysis import controllability_now
from fieldline.analysis.controllability import orbital_scale
from fieldline.cases.afit_1992 import controllability, failures, linear_model, vehicle
from fieldline.cases.afit_1992.earth import circle
from fieldline.errors import InputError
from fieldline.mechanics.relative_motion import attitude_poles, motion_matrix

R_VEHICLE, V_VEHICLE = (50.0, 310.0), (310.0, 50.0)
ORBIT = circle()
N = ORBIT.mean_motion_rad_s
X, Y, CROSSES = "I1u+I1d+I1n+I1s", "I2e+I2w+I2n+I2s", "I1u+I1d+I2e+I2w"
SCALES = {"rate": N, "scale": orbital_scale(N)}


def test_orbit():
    assert ORBIT.radius_m == 6.778e6
    assert pytest.approx(1.1316188e-3, rel=5e-8) == N
    assert N**2 == pytest.approx(1.2805612e-6, rel=5e-8)
    assert ORBIT.strength_tesla == pytest.approx(2.6012394e-5, rel=5e-8)


@pytest.mark.parametrize(
    ("towers", "printed", "found"),
    [
        (R_VEHICLE, (1.5374e8, 1.0236e7, 1.5872e8), (1.53742e8, 1.02363e7, 1.58720e8)),
        (V_VEHICLE, (3.5521e6, 1.8873e8, 1.8702e8), (3.55208e6, 1.88729e8, 1.87022e8)),  # the print's 3.6521 is misread
    ],
)
def test_mass_and_inertia(towers, printed, found):
    tank = vehicle(*towers)
    assert float(tank["mass_kg"]) == 37870.0  # printed
    assert float(tank["tower_mass_kg"]) == pytest.approx(6570.0)  # printed: 6670, though 37870 - 31300 is this
    assert tank["inertia_kg_m2"].values == pytest.approx(printed, rel=5e-5)
    assert tank["inertia_kg_m2"].values == pytest.approx(found, rel=4e-6)


def test_both_examples_break_the_rule_and_grow():
    r, v = vehicle(*R_VEHICLE), vehicle(*V_VEHICLE)
    for tank, growth in ((r, 537.0), (v, 1281.0)):
        assert not tank["ordered"] and not tank["stable"]
        assert float(tank["growth_s"]) == pytest.approx(growth, abs=0.5)
    assert np.abs(r["pole_real"].values / N).max() == pytest.approx(1.64695, abs=2e-5)
    assert np.sort(r["pole_imag"].values / N)[[0, 1]] == pytest.approx([-1.40696, -0.97420], abs=5e-6)
    assert np.abs(v["pole_real"].values / N).max() == pytest.approx(0.68982, abs=5e-6)
    assert np.sort(v["pole_imag"].values / N)[[0, 1]] == pytest.approx([-1.98124, -1.72348], abs=5e-6)


def listing(towers, angle_deg, inertia, mass=37870.0):
    """F and G (times r0^3 undone) as the program of appendix F writes them."""
    m, r0, n = 8.1e15, 6.778e6, N
    (l1, l2), lt, lc, d, w = towers, 50.0, 20.0, np.radians(-78.5), np.radians(angle_deg)
    a, b, c = inertia
    sd, cd, sw, cw = np.sin(d), np.cos(d), np.sin(w), np.cos(w)
    f = np.zeros((12, 12))
    f[range(0, 12, 2), range(1, 12, 2)] = 1.0
    f[1, 0], f[1, 3], f[3, 1], f[5, 4] = 3 * n**2, 2 * n, -2 * n, -(n**2)
    f[7, 6], f[7, 9] = -(n**2) * (c - b) / a, -n * (-a - b + c) / a
    f[9, 4], f[9, 7], f[9, 8] = 3 * n**2 * (a - c) / (r0 * b), -n * (a + b - c) / b, 4 * n**2 * (a - c) / b
    f[11, 1], f[11, 2], f[11, 10] = 3 * n / (2 * r0), 3 * n**2 * (b - a) / (r0 * c), -3 * n**2 * (b - a) / c
    g = np.zeros((12, 9))
    g[1, [2, 3]], g[1, [6, 7]] = -m * l2 * sd / mass, -m * lc * sd / mass
    g[3, [0, 1]], g[3, [4, 5]] = m * l1 * sd / mass, m * lc * sd / mass
    g[5, [0, 1]], g[5, [2, 3]] = m * l1 * cd * sw / mass, -2 * m * l2 * cd * cw / mass
    g[5, [4, 5]], g[5, [6, 7]], g[5, 8] = m * lc * cd * sw / mass, -2 * m * lc * cd * cw / mass, r0**3 / mass
    g[7, 2:6] = np.array([-(l2**2) * cd * cw, l2**2 * cd * cw, -lt * lc * sd, lt * lc * sd]) * m / a
    g[9, [0, 1, 6, 7]] = np.array([-(l1**2) * cd * sw / 2, l1**2 * cd * sw / 2, -lt * lc * sd, lt * lc * sd]) * m / b
    g[11, 0:4] = np.array([l1**2, -(l1**2), l2**2, -(l2**2)]) * m * sd / (2 * c)
    return f, g / r0**3


@pytest.mark.parametrize("towers", [R_VEHICLE, V_VEHICLE])
@pytest.mark.parametrize("angle_deg", [0.0, 33.0, 90.0, 200.0])
def test_matrices_equal_the_programs(towers, angle_deg):
    model = linear_model(field_angle_deg=angle_deg, vertical_m=towers[0], horizontal_m=towers[1], printed=True)
    f, g = listing(towers, angle_deg, vehicle(*towers)["inertia_kg_m2"].values)
    assert model["F"].values == pytest.approx(f, rel=1e-12, abs=1e-30)
    assert model["G"].values == pytest.approx(g, rel=1e-12, abs=1e-15 * np.abs(g).max())
    mended = linear_model(field_angle_deg=angle_deg, vertical_m=towers[0], horizontal_m=towers[1])["F"].values
    wrong = np.argwhere(mended != model["F"].values)
    assert wrong.tolist() == [[11, 1]] and mended[11, 1] == 0.0
    apart = np.abs(np.linalg.eigvals(mended)[:, None] - np.linalg.eigvals(f))  # the term moves no pole
    assert max(apart.min(axis=0).max(), apart.min(axis=1).max()) < 1e-9


def test_the_rows_of_forces_depend_on_each_other():
    for inclination, angle in ((0.0, 33.0), (28.5, 70.0), (60.0, 250.0)):
        model = linear_model(thruster=False, inclination_deg=inclination, field_angle_deg=angle)
        g, field = model["G"].values, model["field_h"].values
        combined = field @ g[1:6:2]  # 2 alpha, -beta, -gamma times rows 2, 4, 6
        assert np.abs(combined).max() < 1e-15 * np.abs(g).max()
        values = controllability_now(model["F"].values, g, **SCALES).input_values
        assert values[5] < 1e-15 and values[4] > 1e-2


@pytest.mark.parametrize(
    ("towers", "without", "with_thruster"),
    [(R_VEHICLE, (9.9e-2, 8.5e-2, 2.6e-2), (0.57, 0.50, 0.44)), (V_VEHICLE, (0.15, 0.135, 0.052), (0.190, 0.188, 0.186))],
)
def test_margins_of_design_2(towers, without, with_thruster):
    for thruster, expected in ((False, without), (True, with_thruster)):
        found = [
            float(linear_model(2, thruster, field_angle_deg=angle, vertical_m=towers[0], horizontal_m=towers[1])["margin"])
            for angle in (0.0, 33.0, 90.0)
        ]
        assert found == pytest.approx(expected, rel=0.02)
    ring = controllability(0.0, vertical_m=towers[0], horizontal_m=towers[1], step_deg=15.0)
    assert set(ring["input_rank"].values) == {6}
    low, high = (0.20, 0.22) if towers == R_VEHICLE else (0.21, 0.265)
    least = ring["input_least"].values
    assert least.min() == pytest.approx(low, abs=0.006) and least.max() == pytest.approx(high, abs=0.006)


def test_design_1_is_lost_at_a_quarter_turn_only_where_b_equals_c():
    # The thesis: uncontrollable at odd quarter turns. True where the towers along y and z are as long as each other.
    def margin(l1, l2, l3):
        model = linear_model(1, False, field_angle_deg=90.0, vertical_m=l1, horizontal_m=l2, support_m=l3)
        return float(model["margin"])

    for equal in ((310.0, 50.0, 50.0), (50.0, 50.0, 50.0), (100.0, 100.0, 100.0), (50.0, 310.0, 310.0)):
        assert margin(*equal) < 1e-13
    assert margin(50.0, 310.0, 50.0) == pytest.approx(4.7e-3, rel=0.01)
    assert margin(310.0, 310.0, 50.0) == pytest.approx(2.0e-3, rel=0.02)
    for angle in (0.0, 90.0, 180.0, 270.0):
        model = linear_model(1, False, field_angle_deg=angle)
        values = controllability_now(model["F"].values, model["G"].values, **SCALES).input_values
        assert values[3] > 0.1 and values[4] < 1e-14  # rank 4


@pytest.mark.parametrize("towers", [R_VEHICLE, V_VEHICLE])
def test_any_three_conductors_may_fail(towers):
    given = {"thruster": False, "vertical_m": towers[0], "horizontal_m": towers[1], "step_deg": 15.0}
    three = controllability(0.0, lost=3, **given)
    assert three.sizes["subset"] == 56 and float(three["subset_margin"].min()) > 1e-3
    four = controllability(0.0, lost=4, **given)
    assert four.sizes["subset"] == 70
    margin = dict(zip(four["subset"].values, four["subset_margin"].values, strict=True))
    assert {name for name, value in margin.items() if value < 1e-12} == {"I1u+I1d+I1n+I1s", "I2e+I2w+I2n+I2s"}
    # The crosses alone give no moment about z: pitch then hangs on the vertical's turn along the orbit, and on that only.
    crosses = margin.pop("I1u+I1d+I2e+I2w")
    assert crosses == pytest.approx(6.8e-7 if towers == R_VEHICLE else 6.8e-6, rel=0.02)
    assert sorted(margin.values())[2] > 1e-3


@pytest.mark.parametrize(("thruster", "fatal"), [(True, {X, CROSSES}), (False, {X, Y, CROSSES})])
def test_the_same_sets_are_fatal_at_every_inclination(thruster, fatal):
    found = failures((0.0, 51.6), 4, thruster=thruster)
    assert found.sizes["subset"] == 8 + 28 + 56 + 70
    for inclination in found["inclination_deg"].values:
        here = found.sel(inclination_deg=inclination)
        assert {str(name) for name in here["subset"].values[here["fatal"].values > 0.0]} == fatal
        smaller = here["least_margin"].values[found["lost_count"].values < 4]
        assert smaller.min() > 1e-3 and (here["good_share"].values[found["lost_count"].values < 4] == 1.0).all()


def test_smallest_fatal_sets_hide_the_larger():
    found = failures((0.0,), 3, design=1, thruster=False, angle_step_deg=120.0, node_step_deg=360.0)
    fatal = found["fatal"].values[0] > 0.0
    names = [set(str(name).split("+")) for name in found["subset"].values[fatal]]
    assert names and not any(one < other for one in names for other in names)
    assert (found["least_margin"].values[0][fatal] < 1e-6).all()


def test_where_no_instant_is_enough():
    # At 11.5 deg the dipole is along the normal once a day; beyond 78.5 deg it is across the normal twice.
    without = linear_model(2, False, inclination_deg=11.5, node_deg=-90.0)
    assert float(without["margin"]) < 1e-14
    assert float(linear_model(2, True, inclination_deg=11.5, node_deg=-90.0)["margin"]) == pytest.approx(0.57, abs=0.02)
    node = np.degrees(np.arcsin(np.tan(np.radians(78.5)) / np.tan(np.radians(85.0))))
    for thruster in (False, True):
        model = linear_model(2, thruster, inclination_deg=85.0, node_deg=node)
        assert abs(model["field_h"].values[2]) < 1e-20 and float(model["margin"]) < 1e-13
        values = controllability_now(model["F"].values, model["G"].values, **SCALES).input_values
        assert (values[: 3 + thruster] > 1e-2).sum() in (2, 3, 4) and values[3 + thruster] < 1e-14


def test_conductors_alone_hold_nothing_and_the_thruster_restores_it():
    for inclination in (0.0, 28.5, 60.0, 78.0):
        for angle in (0.0, 33.0, 90.0, 217.0):
            given = {"inclination_deg": inclination, "field_angle_deg": angle, "node_deg": 20.0}
            assert float(linear_model(2, False, **given)["steady_margin"]) < 1e-15
            assert float(linear_model(2, True, **given)["steady_margin"]) > 1e-3


def test_the_order_of_moments_is_enough_but_not_needed():
    rng = np.random.default_rng(3)
    stable, unordered, samples = 0, 0, 0
    while samples < 2000:
        a, b, c = rng.uniform(0.05, 1.0, 3)
        if max(a, b, c) > 0.5 * (a + b + c):
            continue
        samples += 1
        found = attitude_poles(1.0, (a, b, c))
        numeric = np.linalg.eigvals(motion_matrix(1.0, 1.0, (a, b, c))[6:, 6:]).real.max()
        assert found.stable == (numeric < 1e-6)
        assert found.stable or not found.ordered
        stable, unordered = stable + (found.stable and not found.ordered), unordered + (not found.ordered)
    assert stable / unordered == pytest.approx(373 / 10849, abs=0.02)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"design": 3}, "design must be 1 .* or 2"),
        ({"arms": "hul"}, "arms must be"),
        ({"vertical_m": 0.0}, "vertical_m must be a positive number"),
        ({"inclination_deg": 200.0}, "inclination_deg must be a number, 0 to 180"),
    ],
)
def test_bad_input(arguments, words):
    with pytest.raises(InputError, match=words):
        linear_model(**arguments)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"most_lost": 8}, "most_lost must be a number, 1 to 7"),
        ({"inclinations_deg": (270.0,)}, "inclinations_deg must be numbers from 0 to 180"),
        ({"angle_step_deg": 1.0, "node_step_deg": 1.0}, "129,600 instants are too many"),
    ],
)
def test_bad_failures(arguments, words):
    with pytest.raises(InputError, match=words):
        failures(**arguments)


def test_the_number_of_lost_conductors():
    with pytest.raises(InputError, match="lost must be a number of conductors, 0 to 7"):
        controllability(lost=8)
