"""The plant's line with nodes in orbit: rest, librations, lateral and longitudinal modes, skiprope, and a slack line."""

import numpy as np
import pytest

import plant_flights as pf
import tether_flights as tf
from fieldline.analysis.line_shape import skiprope_of
from fieldline.analysis.tether import eigenmotions, libration_ratio, modal_amplitudes
from fieldline.constants import EARTH_GM_M3_S2
from fieldline.dynamics.layout import starts_in_state
from fieldline.simulate.flight import Flight

NODES = 10
REST = tf.at_rest(NODES)
MODES = eigenmotions(REST)
DAMPED = 0.05 * tf.STIFFNESS_N  # [N s]: takes the stretch's ringing, and a millionth of a swing


def crossings(seconds, values):
    """Times at which samples go through zero."""
    k = np.flatnonzero(np.diff(np.sign(values)))
    return seconds[k] - np.diff(seconds)[k] * values[k] / np.diff(values)[k]


@pytest.mark.parametrize("nodes", [1, NODES, 30])
def test_a_line_at_rest_stays_at_rest(nodes):
    """An orbit (a fifth of one with many nodes): tension, radii and rate are those of the statics, and nothing swings."""
    rest = tf.at_rest(nodes)
    seconds = 5400.0 if nodes < 30 else 1000.0
    flight = tf.flown(tf.hung(nodes, seconds=seconds, output=seconds / 50.0, step=0.1))
    one = tf.points(flight)
    assert np.abs(one.tension - rest.tension[::-1]).max() < 1e-4  # of 42 to 48 N; radii hold 1e-9 m, a segment 3e-7 N
    assert np.abs(np.linalg.norm(one.position, axis=2) - rest.radius[::-1]).max() < 2e-6
    shape = tf.shape(one)
    assert np.abs(shape.in_plane_rad).max() < 1e-10 and np.abs(shape.across_rad).max() < 1e-10
    assert shape.largest_m.max() < 1e-6
    angle = np.unwrap(np.arctan2(*np.linalg.qr(one.position[:2, 0].T)[0].T[::-1] @ one.position[:, 0].T))
    assert np.isclose(abs(np.ptp(angle)) / seconds, rest.rate, rtol=1e-9)


@pytest.mark.kernels
def test_rates_at_rest_are_those_of_a_turning_frame():
    """a = -n^2 r at every point, from one call of the right-hand side."""
    flight = Flight(tf.hung(NODES, seconds=10.0, output=10.0))
    rates, _ = pf.rates(flight)
    first, _, _ = starts_in_state(flight.plant)
    nodes = flight.y[first : first + 6 * NODES].reshape(NODES, 6)[:, :3]
    inner = rates[first - 2 : first - 2 + 6 * NODES].reshape(NODES, 6)[:, 3:]
    place = np.concatenate([flight.y[None, 0:3], nodes, flight.y[None, 13:16]])
    acceleration = np.concatenate([rates[None, 3:6], inner, rates[None, 15:18]])
    assert np.abs(acceleration + REST.rate**2 * place).max() < 3e-7  # a node's 15 kg, and 1e-9 m of 177 N/m


@pytest.mark.parametrize("degrees, told", [(1.0, 1.73682), (10.0, 1.72364), (30.0, 1.61772), (60.0, 1.26272)])
def test_libration_in_the_plane(degrees, told):
    """The frequency of an independent code at every amplitude; the ellipse's law with the correction for the length."""
    flight = tf.flown(tf.hung(NODES, seconds=9000, output=20, step=0.2, hang={"in_plane_deg": degrees}, damping_n_s=DAMPED))
    one = tf.points(flight)
    rate = np.pi / np.diff(crossings(one.seconds, tf.shape(one).in_plane_rad)).mean() / REST.rate
    assert np.isclose(rate, told, atol=8e-5)
    length = MODES.in_plane.rate[0] / REST.rate / np.sqrt(3.0)
    assert np.isclose(rate, length * libration_ratio(np.radians(degrees)), rtol=3e-6 + 2e-3 * np.radians(degrees) ** 2)


def test_libration_across_the_plane():
    flight = tf.flown(tf.hung(NODES, seconds=9000, output=20, step=0.2, hang={"out_of_plane_deg": 1.0}, damping_n_s=DAMPED))
    one = tf.points(flight)
    across = tf.shape(one).across_rad
    rate = tf.frequency(one.seconds, across, 2.0 * REST.rate) / REST.rate
    assert np.isclose(rate, 2.00429, atol=2e-5)  # an independent code's, at this amplitude
    assert np.isclose(rate, MODES.out_of_plane.rate[0] / REST.rate, rtol=8e-5)


@pytest.mark.parametrize("mode, phase", [(1, 0.0), (1, 90.0), (2, 0.0), (3, 90.0)])
def test_lateral_modes(mode, phase):
    start = {"skiprope_amplitude_m": 1.0, "skiprope_phase_deg": phase, "skiprope_sense": "plane", "skiprope_mode": mode}
    flight = tf.flown(tf.hung(NODES, seconds=6000, output=10, step=0.1, start=start, damping_n_s=DAMPED))
    one = tf.points(flight)
    amplitudes, _ = modal_amplitudes(tf.shape(one), one.mass, modes=4)
    family, direction = (MODES.in_plane, 0) if phase == 0.0 else (MODES.out_of_plane, 1)
    rate = tf.frequency(one.seconds, amplitudes[:, mode - 1, direction], family.rate[mode])
    assert np.isclose(rate, family.rate[mode], rtol=3e-6 * mode**2)


@pytest.mark.parametrize("phase, told", [(0.0, 10.12792), (90.0, 10.17724)])
def test_a_wide_lateral_swing_is_slower(phase, told):
    """Of ten segments, 20 m: the frequency over n of an independent code, below that of the linear mode, as the square."""
    rest, away = tf.at_rest(9), []
    family, direction = (eigenmotions(rest).in_plane, 0) if phase == 0.0 else (eigenmotions(rest).out_of_plane, 1)
    for amplitude in (20.0, 40.0):
        start = {"skiprope_amplitude_m": amplitude, "skiprope_phase_deg": phase, "skiprope_sense": "plane"}
        one = tf.points(tf.flown(tf.hung(9, seconds=6000, output=10, step=0.1, start=start, damping_n_s=DAMPED)))
        amplitudes, _ = modal_amplitudes(tf.shape(one), one.mass, modes=1)
        rate = tf.frequency(one.seconds, amplitudes[:, 0, direction], family.rate[1]) / rest.rate
        away.append(rate - family.rate[1] / rest.rate)
    assert np.isclose(family.rate[1] / rest.rate + away[0], told, atol=1e-4)
    assert away[0] < -3e-4 and np.isclose(away[1] / away[0], 4.0, rtol=0.02)


def test_longitudinal_modes():
    """A pulse holds all of them; each is seen by its own shape."""
    start = {"pulse_amplitude_m": 0.2, "pulse_width_m": 5000.0, "pulse_middle": 0.4}
    flight = tf.flown(tf.hung(NODES, seconds=600, output=0.5, step=0.05, start=start))
    one = tf.points(flight)
    share = one.mass / one.mass.sum()
    centre = np.einsum("p,tpj->tj", share, one.position)
    up = centre / np.linalg.norm(centre, axis=1, keepdims=True)
    height = np.einsum("tpj,tj->tp", one.position - centre[:, None], up)[:, ::-1]
    for rate, shape in zip(MODES.along_line.rate[:4], MODES.along_line.shape, strict=False):
        part = height @ (REST.grid.mass * shape)
        assert np.isclose(tf.frequency(one.seconds, part, rate), rate, rtol=2e-5)


def test_a_skiprope_becomes_a_swing_in_a_plane_after_a_quarter_of_its_beat():
    """Frequency between those of the two planes, and 20.3 orbits of beat."""
    start = {"skiprope_amplitude_m": 20.0}
    flight = tf.flown(tf.hung(NODES, seconds=40000, output=40, step=0.2, start=start, damping_n_s=DAMPED))
    one = tf.points(flight)
    found = skiprope_of(tf.shape(one), one.seconds)
    planes = MODES.in_plane.rate[1], MODES.out_of_plane.rate[1]
    quarter = 0.5 * np.pi / (planes[1] - planes[0])
    assert np.isclose(4.0 * quarter * REST.rate / (2.0 * np.pi), 20.3, rtol=2e-3)
    turn = crossings(one.seconds, found.sense)
    assert len(turn) == 1 and np.isclose(turn[0], quarter, rtol=0.01)
    assert found.sense[0] > 0.95 and found.sense[-1] < -0.5
    middle = slice(100, -100)
    assert planes[0] * 0.99 < found.rate_rad_s[middle].mean() < planes[1] * 1.01
    assert np.isclose(found.semi_major_m[0], 20.0, rtol=0.05)


def stumpff(z, first):
    """1/first! - z/(first + 2)! + ... of numbers up to a few."""
    total, term = np.zeros_like(z), np.ones_like(z) / np.prod(np.arange(1.0, first + 1.0))
    for k in range(20):
        total = total + term
        term = -term * z / ((first + 2 * k + 1) * (first + 2 * k + 2))
    return total


def kepler(position, velocity, seconds):
    """(t, 3) place of a free mass by Lagrange's coefficients with universal variables."""
    gm, r0 = EARTH_GM_M3_S2, np.linalg.norm(position)
    alpha = 2.0 / r0 - velocity @ velocity / gm
    sigma = position @ velocity / np.sqrt(gm)
    chi = np.sqrt(gm) * alpha * seconds
    for _ in range(60):
        z = alpha * chi**2
        c, s = stumpff(z, 2), stumpff(z, 3)
        left = sigma * chi**2 * c + (1.0 - alpha * r0) * chi**3 * s + r0 * chi - np.sqrt(gm) * seconds
        chi = chi - left / (sigma * chi * (1.0 - z * s) + (1.0 - alpha * r0) * chi**2 * c + r0)
    z = alpha * chi**2
    f, g = 1.0 - chi**2 * stumpff(z, 2) / r0, seconds - chi**3 * stumpff(z, 3) / np.sqrt(gm)
    return f[:, None] * position + g[:, None] * velocity


def test_everything_on_a_slack_line_falls_freely():
    """20 km of line between bodies 200 m apart: each keeps the orbit that it began on, and the mass centre is Kepler's."""
    flight = Flight(tf.hung(4, seconds=1500, output=50, step=0.5))
    nodes, _, _ = starts_in_state(flight.plant)
    inner = flight.y[nodes : nodes + 24].reshape(4, 6)
    top, low = flight.y[:6], flight.y[13:19]
    chord = 0.01 * (low - top)
    for place, row in zip((0.2, 0.4, 0.6, 0.8), inner, strict=True):
        row[:] = top + place * chord
    low[:] = top + chord
    flight.start[:] = flight.y
    flight.fly()
    one = tf.points(flight)
    assert np.all(one.tension == 0.0)
    for k in range(6):
        free = kepler(one.position[0, k], one.velocity[0, k], one.seconds)
        assert np.abs(one.position[:, k] - free).max() < 1e-4
    share = one.mass / one.mass.sum()
    free = kepler(share @ one.position[0], share @ one.velocity[0], one.seconds)
    assert np.abs(np.einsum("p,tpj->tj", share, one.position) - free).max() < 1e-3  # its parts fall a little apart
    assert np.linalg.norm(one.position[-1, -1] - one.position[-1, 0]) > 300.0
