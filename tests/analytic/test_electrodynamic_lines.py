"""Lines with current: balance, libration and its growth, descent."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fieldline.analysis.electrodynamic import (
    balanced_mass,
    bare_centroid,
    bare_decay,
    current_centroid,
    descent_time,
    libration_multipliers,
    libration_rates,
    periodic_libration,
    torque_ratio,
)
from fieldline.analysis.electrodynamic.balance import DIPOLE_T_M3
from fieldline.analysis.electrodynamic.libration import after_an_orbit
from fieldline.constants import EARTH_GM_M3_S2
from fieldline.dynamics.lines.bare import bare_currents, bare_work, gathering
from fieldline.environment.plasma import plasma_model
from fieldline.errors import InputError, NoEstimateError

TAPE = {"length_m": 500.0, "diameter_m": 2.0 * 0.025 / np.pi, "resistance_ohm_per_m": 0.0282, "mass_kg": 24.0}


def torque(current, length, mass_a, mass_b, line_mass, points=4000):
    """M1 [A m^2] by summing pieces: current at s less the centre of mass."""
    s = (np.arange(points) + 0.5) * length / points
    middle = (mass_b * length + line_mass * 0.5 * length) / (mass_a + mass_b + line_mass)
    return float(np.sum(current(s) * (s - middle)) * length / points)


@pytest.mark.parametrize("line_mass", [0.0, 5.0])
def test_nothing_turns_a_balanced_line(line_mass):
    for shape, centroid in ((lambda s: np.ones_like(s), 0.5), (lambda s: 1.0 - (s / 800.0) ** 1.5, bare_centroid("from"))):
        pieces = (np.arange(400) + 0.5) * 2.0
        assert current_centroid(shape(pieces)) == pytest.approx(centroid, abs=2e-5)
        mass = balanced_mass(centroid, 30.0, line_mass)
        assert torque(shape, 800.0, 30.0, mass, line_mass) == pytest.approx(0.0, abs=1e-2)
        mean = float(shape(pieces).mean())
        assert torque_ratio(mean, 800.0, 30.0, mass, line_mass_kg=line_mass, centroid=centroid) == pytest.approx(0.0, abs=1e-15)


def test_a_bare_line_has_the_centroid_of_the_closed_form():
    out, n, length = np.empty(40), 40, 50.0
    gather = np.full(n, gathering(0.01, 1e11) * length / n)
    bare_currents(np.full(n, 0.15 * length / n), np.full(n, 1e-6), gather, False, 0.0, 0.0, 1e-4, 16.0, bare_work(n), out)
    assert current_centroid(out) == pytest.approx(5.0 / 14.0, abs=1e-3)
    assert bare_centroid("to") == pytest.approx(1.0 - 5.0 / 14.0)


def test_the_ratio_of_torques():
    """Massless line, equal currents: epsilon = I (1/2 - s_G/L) k / (m_reduced GM)."""
    reduced = 100.0 * 300.0 / 400.0
    found = torque_ratio(2.0, 5000.0, 100.0, 300.0)
    assert found == pytest.approx(2.0 * (0.5 - 0.75) * DIPOLE_T_M3 / (reduced * EARTH_GM_M3_S2), rel=1e-12)


def vector_rates(nu, state, epsilon, inclination):
    """The same motion from the torque itself: u'' of a rod in axes that turn with the orbit, (along, normal, up)."""
    u, rate = state[:3], state[3:]
    normal, up = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
    north = np.array([np.sin(inclination) * np.cos(nu), np.cos(inclination), np.sin(inclination) * np.sin(nu)])
    field = north - 3.0 * north[2] * up
    turn = rate + np.cross(normal, u)  # as seen from the stars
    pull = 3.0 * u[2] * np.cross(u, up) + epsilon * np.cross(u, np.cross(u, field))  # torque over inertia
    spin = np.cross(u, turn)
    # d(spin)/dt = pull, in turning axes; u' = spin x u - normal x u
    spin_rate = pull - np.cross(normal, spin)
    acceleration = np.cross(spin_rate, u) + np.cross(spin, rate) - np.cross(normal, rate)
    return np.concatenate([rate, acceleration])


def test_equations_are_those_of_a_rod_under_the_torque():
    epsilon, inclination, start = 0.7, 0.9, np.array([0.3, -0.2, 0.25, 0.4])
    theta, swing, phi, roll = start
    u = np.array([np.cos(phi) * np.sin(theta), np.sin(phi), np.cos(phi) * np.cos(theta)])
    rate = swing * np.array([np.cos(phi) * np.cos(theta), 0.0, -np.cos(phi) * np.sin(theta)])
    rate += roll * np.array([-np.sin(phi) * np.sin(theta), np.cos(phi), -np.sin(phi) * np.cos(theta)])
    exact = {"rtol": 1e-11, "atol": 1e-12}
    ours = solve_ivp(libration_rates, (0.0, 4.0), start, args=(epsilon, inclination), **exact).y[:, -1]
    theirs = solve_ivp(vector_rates, (0.0, 4.0), np.r_[u, rate], args=(epsilon, inclination), **exact).y[:, -1]
    assert np.linalg.norm(theirs[:3]) == pytest.approx(1.0, abs=1e-8)
    assert np.arctan2(theirs[0], theirs[2]) == pytest.approx(ours[0], abs=1e-7)
    assert np.arcsin(theirs[1]) == pytest.approx(ours[2], abs=1e-7)


def test_small_currents_bend_the_line_as_the_linear_solution_says():
    for inclination in (0.3, 0.9):
        state = periodic_libration(1e-3, inclination)
        linear = 1e-3 / 3.0 * np.array([-np.cos(inclination), 0.0, np.sin(inclination), 0.0])
        assert state == pytest.approx(linear, abs=1e-6)


def test_in_the_equators_plane_the_line_leans_and_stays():
    for epsilon in (0.9,):
        state = periodic_libration(epsilon, 0.0)
        assert np.sin(2.0 * state[0]) == pytest.approx(-2.0 * epsilon / 3.0, abs=1e-9)
        assert state[1:] == pytest.approx(np.zeros(3), abs=1e-9)
        assert np.abs(libration_multipliers(epsilon, 0.0)) == pytest.approx(np.ones(4), abs=1e-6)
    with pytest.raises(NoEstimateError, match="gravity holds"):
        periodic_libration(1.7, 0.0)


def test_every_inclined_orbit_is_unstable_and_the_growth_goes_with_the_cube():
    growth = {e: np.abs(libration_multipliers(e, np.pi / 4.0)) - 1.0 for e in (0.15, 0.3)}
    for some in growth.values():
        assert some[0] > 1e-4 and some[1] == pytest.approx(some[0], rel=1e-3)  # a pair
        assert np.prod(1.0 + some) == pytest.approx(1.0, abs=1e-6)  # no friction: volume stays
    assert np.log2(growth[0.3][0] / growth[0.15][0]) == pytest.approx(3.0, abs=0.05)
    assert growth[0.3][0] == pytest.approx(0.12 * 0.3**3, rel=0.1)


def test_the_growth_is_that_of_the_motion_itself():
    epsilon, inclination = 1.0, np.radians(45.0)
    start = periodic_libration(epsilon, inclination)
    largest = np.abs(libration_multipliers(epsilon, inclination))[0]
    both, size = np.array([start, start + np.array([1e-7, 0.0, 1e-7, 0.0])]).T, []
    for _ in range(18):
        both = after_an_orbit(both, epsilon, inclination)
        size.append(np.linalg.norm(both[:, 1] - both[:, 0]))
    rate = np.polyfit(np.arange(8, 18), np.log(size[8:]), 1)[0]
    assert np.exp(rate) == pytest.approx(largest, rel=0.03)


def test_descent_of_a_short_tape():
    plasma = plasma_model("constant", density_m3=2e11)
    found = bare_decay(500e3, np.radians(40.0), plasma, **TAPE)
    radius = 6378136.6 + 500e3
    speed = np.sqrt(EARTH_GM_M3_S2 / radius)
    assert float(found["altitude_rate"]) == pytest.approx(
        -2.0 * radius**2 * speed * found["drag"].values.mean() / (EARTH_GM_M3_S2 * 24.0), rel=1e-12
    )
    lost = 2.0 * radius**2 / (EARTH_GM_M3_S2 * 24.0) * float(found["power"])
    assert float(found["altitude_rate"]) == pytest.approx(-lost, rel=1e-12)
    assert 40.0 < found["emf"].values.mean() < 90.0 and 0.05 < found["current"].values.mean() < 1.0
    free = {"cathode_drop_v": 0.0, "resistance_ohm_per_m": 1e-6}
    long, short = (
        float(bare_decay(500e3, 0.7, plasma, **TAPE | free | {"length_m": x})["altitude_rate"]) for x in (500.0, 250.0)
    )
    assert long / short == pytest.approx(2.0**2.5, rel=1e-3)  # emf^0.5 length^2 without resistance
    time = descent_time(500e3, 480e3, np.radians(40.0), plasma, steps=2, **TAPE)
    assert time == pytest.approx(-20e3 / float(found["altitude_rate"]), rel=0.05)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: current_centroid([1.0, -1.0]), "cancel"),
        (lambda: current_centroid([[1.0]]), "finite numbers"),
        (lambda: bare_centroid("up"), '"from" or "to"'),
        (lambda: balanced_mass(0.3, 0.1, 10.0), "no mass at B"),
        (lambda: balanced_mass(1.0, 0.1), "between 0 and 1"),
        (lambda: torque_ratio(1.0, 0.0, 1.0, 1.0), "a length"),
        (lambda: periodic_libration(np.nan, 0.1), "finite"),
        (lambda: bare_decay(500e3, 0.5, plasma_model("none"), **TAPE | {"mass_kg": 0.0}), "mass_kg"),
        (lambda: descent_time(400e3, 500e3, 0.5, plasma_model("none"), **TAPE), "must fall"),
        (lambda: descent_time(500e3, 400e3, 0.5, plasma_model("none"), steps=1, **TAPE), "does not pull down"),
    ],
)
def test_refusals(call, words):
    with pytest.raises(InputError, match=words):
        call()
