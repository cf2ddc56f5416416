"""Elements and states: singular orbits, Kepler's equation, drifts, axes, and the ways to start."""

from importlib.resources import files

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2
from fieldline.environment.gravity import gravity_kernel, gravity_model
from fieldline.environment.sun import sun_direction_i
from fieldline.errors import InputError
from fieldline.frames.earth_rotation import dcm_ei
from fieldline.frames.orbital import dcm_oi, orbital_axes
from fieldline.orbit import read_orbit
from fieldline.orbit.elements import (
    Elements,
    check_orbit,
    circular_orbit,
    elements_from_state,
    mean_anomaly,
    mean_motion,
    secular_rates,
    state_from_elements,
    true_anomaly,
)
from fieldline.orbit.start import StartState, SunSynchronous, initial_state_i, state_i_from_e
from fieldline.orbit.sun_synchronous import node_of_local_time, sun_synchronous_inclination, sun_synchronous_orbit

START = np.datetime64("2026-03-05T07:12", "ns")
TLE = str(files("fieldline") / "data" / "suchai3.tle")


@pytest.mark.parametrize(
    ("position", "velocity", "expected"),
    [
        ((7e6, 0, 0), (0, 1, 0), (0.0, 0.0, 0.0, 0.0)),  # circle in the equator: all counts from the x axis
        ((0, 7e6, 0), (-1, 0, 0), (0.0, 0.0, 0.0, 90.0)),
        ((0, 7e6, 0), (1, 0, 0), (180.0, 0.0, 0.0, 270.0)),  # backwards, so y is three quarters on
        ((7e6, 0, 0), (0, 0, 1), (90.0, 0.0, 0.0, 0.0)),
        ((0, 0, 7e6), (0, -1, 0), (90.0, 90.0, 0.0, 90.0)),
    ],
)
def test_circles_by_hand(position, velocity, expected):
    velocity = np.sqrt(EARTH_GM_M3_S2 / 7e6) * np.array(velocity, dtype=float)
    found = elements_from_state(position, velocity)
    assert found.semi_major_axis_m == pytest.approx(7e6)
    assert found.eccentricity < 1e-15
    assert np.degrees(found[2:]) == pytest.approx(expected, abs=1e-12)


def test_an_ellipse_in_the_equator_counts_its_perigee_from_the_x_axis():
    speed = 1.2 * np.sqrt(EARTH_GM_M3_S2 / 7e6)
    for sense, perigee in ((1.0, 0.5 * np.pi), (-1.0, 1.5 * np.pi)):
        found = elements_from_state([0.0, 7e6, 0.0], [-sense * speed, 0.0, 0.0])
        assert found.eccentricity == pytest.approx(0.44)
        assert found[3:] == pytest.approx((0.0, perigee, 0.0), abs=1e-12)


def test_perigee_apogee_and_energy():
    orbit = Elements(8e6, 0.1, 1.0, 2.0, 3.0, 0.0)
    low, fast = state_from_elements(orbit)
    high, slow = state_from_elements(orbit._replace(true_anomaly_rad=np.pi))
    assert np.linalg.norm(low) == pytest.approx(7.2e6) and np.linalg.norm(high) == pytest.approx(8.8e6)
    assert low @ fast == pytest.approx(0.0, abs=1.0) and np.linalg.norm(fast) / np.linalg.norm(slow) == pytest.approx(8.8 / 7.2)
    assert 0.5 * fast @ fast - EARTH_GM_M3_S2 / 7.2e6 == pytest.approx(-EARTH_GM_M3_S2 / 16e6)
    assert np.cross(low, fast)[2] / np.linalg.norm(np.cross(low, fast)) == pytest.approx(np.cos(1.0))


def test_a_hyperbola_there_and_back():
    orbit = Elements(-9e6, 1.8, 0.4, 0.3, 0.2, -1.0)
    position, velocity = state_from_elements(orbit)
    assert velocity @ velocity > 2.0 * EARTH_GM_M3_S2 / np.linalg.norm(position)
    back = elements_from_state(position, velocity)
    assert back[:5] == pytest.approx(orbit[:5]) and back.true_anomaly_rad == pytest.approx(2 * np.pi - 1.0)


def test_keplers_equation():
    e = np.array([0.0, 1e-9, 0.1, 0.7, 0.99, 0.999999])[:, None]
    mean = np.array([-20.0, -np.pi, -1.0, -1e-9, 0.0, 1e-6, 0.3, np.pi, 4.0, 100.0])
    assert np.abs(mean_anomaly(true_anomaly(mean, e), e) - mean).max() < 1e-10
    assert (true_anomaly(mean, 0.0) == pytest.approx(mean)) and true_anomaly(0.0, 0.5) == 0.0
    # Vallado (2013), example 2-1: M = 235.4 deg, e = 0.4 has E = 220.512074767522 deg.
    true = true_anomaly(np.radians(235.4), 0.4)
    eccentric = 2.0 * np.arctan2(np.sqrt(0.6) * np.sin(true / 2.0), np.sqrt(1.4) * np.cos(true / 2.0)) % (2.0 * np.pi)
    assert np.degrees(eccentric) == pytest.approx(220.512074767522, abs=1e-11)


def test_drifts_are_those_of_a_flight_over_an_oblate_earth():
    gravity, inclination = gravity_model("j2"), np.radians(50.0)
    start = Elements(7.6e6, 0.08, inclination, 1.0, 0.7, 0.0)
    period = 2.0 * np.pi / mean_motion(start.semi_major_axis_m)
    seconds = np.linspace(0.0, 40 * period, 40 * 48)
    flight = solve_ivp(
        lambda t, y: np.concatenate([y[3:], gravity_kernel(tuple(y[:3]), gravity)]),
        (0.0, seconds[-1]),
        np.concatenate(state_from_elements(start)),
        "DOP853",
        seconds,
        rtol=1e-9,
        atol=1e-3,
    ).y.T
    found = elements_from_state(flight[:, :3], flight[:, 3:])
    whole = slice(24, -24)
    mean = [float(np.mean(part[whole])) for part in found[:3]]  # the ripple of J2 averages out over whole turns
    rates = secular_rates(*mean)
    for angle, rate in ((found.raan_rad, rates.raan), (found.argument_of_perigee_rad, rates.argument_of_perigee)):
        slope = np.polyfit(seconds, np.unwrap(angle), 1)[0]
        assert slope == pytest.approx(rate, rel=0.01)
    latitude = np.unwrap(found.argument_of_perigee_rad + mean_anomaly(found.true_anomaly_rad, found.eccentricity))
    assert 2.0 * np.pi / np.polyfit(seconds, latitude, 1)[0] == pytest.approx(rates.nodal_period_s, rel=5e-4)


def test_a_sun_synchronous_node_turns_once_a_year_and_keeps_its_clock():
    orbit = sun_synchronous_orbit(600e3, 37800.0, START)
    rate = secular_rates(orbit.semi_major_axis_m, 0.0, orbit.inclination_rad).raan
    assert 2.0 * np.pi / rate / 86400.0 == pytest.approx(365.256, abs=0.01)
    for days in (0, 100, 250, 365):
        later = START + np.timedelta64(days, "D")
        drift = (node_of_local_time(later, 37800.0) - orbit.raan_rad - rate * days * 86400.0 + np.pi) % (2 * np.pi) - np.pi
        assert abs(drift) < 1e-6 * (days + 1)


@pytest.mark.parametrize("local_time_h", [0.0, 6.0, 10.5, 18.0])
def test_the_node_stands_where_the_clock_says(local_time_h):
    """At the node the true Sun is (LTAN - 12 h) of angle to the west, but for the equation of time."""
    node = node_of_local_time(START, 3600.0 * local_time_h)
    sun = sun_direction_i(START)
    west = (node - np.arctan2(sun[1], sun[0])) % (2.0 * np.pi)
    expected = np.pi / 12.0 * ((local_time_h - 12.0) % 24.0)
    off = (west - expected + np.pi) % (2.0 * np.pi) - np.pi
    equation_of_time_on_5_march = np.radians(-11.7 / 4.0)  # minutes of time, the Sun late
    precession_since_2000 = np.radians(0.34)
    assert off == pytest.approx(equation_of_time_on_5_march, abs=precession_since_2000)


@pytest.mark.kernels
def test_orbital_axes_point_ahead_left_out_and_down():
    r, v = state_from_elements(Elements(7e6, 0.02, 1.1, 0.4, 0.9, 2.2))
    matrix = dcm_oi(r, v)
    assert np.allclose(orbital_axes(tuple(r), tuple(v)), matrix.ravel(), atol=1e-15)
    assert np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-15) and np.linalg.det(matrix) > 0.0
    assert matrix @ r == pytest.approx([0.0, 0.0, -np.linalg.norm(r)], abs=1e-8)
    ahead, side, down = matrix @ v
    assert ahead > 7e3 and abs(side) < 1e-10 and 0.0 < -down < 0.02 * ahead  # it climbs
    many = dcm_oi(np.stack([r, 2 * r]), np.stack([v, v]))
    assert many.shape == (2, 3, 3) and np.allclose(many, matrix)
    with pytest.raises(InputError, match="span no orbital plane"):
        dcm_oi(r, 2.0 * r)


def test_a_state_from_earth_fixed_axes_moves_as_its_ground_says():
    """The velocity against differences of positions turned at neighbouring times."""
    r_e, v_e, half = np.array([4e6, -5e6, 2.5e6]), np.array([1000.0, 2000.0, 7000.0]), 0.5
    position, velocity = state_i_from_e(r_e, v_e, START)
    steps = [state_i_from_e(r_e + s * v_e, v_e, START + np.timedelta64(int(s * 1e9), "ns"))[0] for s in (-half, half)]
    assert (steps[1] - steps[0]) / (2 * half) == pytest.approx(velocity, abs=1e-4)
    assert dcm_ei(START) @ position == pytest.approx(r_e)


def test_ways_to_start():
    sample = read_orbit(TLE)
    when = np.datetime64("2023-08-24T15:00", "ns")
    position, velocity, warnings = initial_state_i(when, sample)
    assert (position == sample.state_i(when)[0]).all() and warnings == []
    elements = elements_from_state(position, velocity)
    for start in (elements, StartState(tuple(position), tuple(velocity))):
        again = initial_state_i(when, start)
        assert again[0] == pytest.approx(position, abs=1e-6) and again[1] == pytest.approx(velocity, abs=1e-9)
    position, velocity, _ = initial_state_i(when, SunSynchronous(500e3, 3600.0 * 22.5, 0.3))
    found = elements_from_state(position, velocity)
    assert found.inclination_rad == pytest.approx(sun_synchronous_inclination(500e3))
    assert np.linalg.norm(position) == pytest.approx(EARTH_EQUATORIAL_RADIUS_M + 500e3)
    assert np.arcsin(position[2] / np.linalg.norm(position)) == pytest.approx(np.arcsin(np.sin(0.3) * np.sin(found[2])))
    assert initial_state_i(when, StartState((7e6, 0, 0), (0, 7000.0, 0), "e"))[1][2] == pytest.approx(0.0, abs=20.0)


def test_a_low_perigee_is_a_warning_and_the_ground_an_error():
    assert check_orbit(circular_orbit(400e3, 1.0)) == []
    (warning,) = check_orbit(circular_orbit(110e3, 1.0))
    assert "110 km" in warning
    with pytest.raises(InputError, match=r"perigee lies 300 km below.*metres"):
        check_orbit(circular_orbit(-300e3, 1.0))
    with pytest.raises(InputError, match=r"no ellipse: its eccentricity is 1\.8.*m/s"):
        check_orbit(Elements(-9e6, 1.8, 0.0, 0.0, 0.0, 0.0))
    assert check_orbit(Elements(-9e6, 1.8, 0.0, 0.0, 0.0, 0.0), unbound=True) == []


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: state_from_elements(Elements(7e6, 0.0, 98.0, 0.0, 0.0, 0.0)), r"got 98\. Is it in degrees"),
        (lambda: state_from_elements(Elements(7e6, 1.2, 0.0, 0.0, 0.0, 0.0)), "positive semi_major_axis_m"),
        (lambda: state_from_elements(Elements(7e6, -0.1, 0.0, 0.0, 0.0, 0.0)), "eccentricity from 0"),
        (lambda: state_from_elements(Elements(7e6, 0.1, 0.0, np.nan, 0.0, 0.0)), "finite"),
        (lambda: state_from_elements(Elements(-7e6, 1.5, 0.0, 0.0, 0.0, 3.0)), "asymptote"),
        (lambda: elements_from_state([7e6, 0, 0], [7e3, 0, 0]), "parallel, zero or NaN"),
        (lambda: elements_from_state([7e6, 0, np.nan], [0, 7e3, 0]), "parallel, zero or NaN"),
        (lambda: true_anomaly(1.0, 1.0), "below 1"),
        (lambda: sun_synchronous_inclination(500.0e6), "too slowly"),
        (lambda: sun_synchronous_inclination(-1.0), "meets the ground"),
        (lambda: node_of_local_time(START, 90000.0), "seconds after midnight; got 90000"),
        (lambda: node_of_local_time([START], 0.0), "one time"),
        (lambda: initial_state_i([START], circular_orbit(5e5, 1.0)), "one time"),
        (lambda: initial_state_i(START, "sun-synchronous"), "got str"),
        (lambda: initial_state_i(START, StartState((7e6, 0, 0), (0, 7e3, 0), "b")), 'unknown axes "b"'),
        (lambda: initial_state_i(START, StartState((7e6, 0), (0, 7e3, 0))), "three finite numbers"),
        (lambda: initial_state_i(START, StartState((7e3, 0, 0), (0, 7.5, 0))), "metres"),
        (lambda: initial_state_i(START, read_orbit(TLE)), "limit is 30 days"),
    ],
)
def test_errors_say_what_is_wrong(call, words):
    with pytest.raises(InputError, match=words):
        call()
