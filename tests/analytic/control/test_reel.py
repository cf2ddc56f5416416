"""Laws of a reel on two masses and a massless line in a circular orbit: deployment, hold, retrieval, swing."""

from dataclasses import replace
from math import asin, cos, exp, pi, sin, sqrt, tan

import numpy as np
import pytest

from fieldline.control import LAWS
from fieldline.control.law import LineEnd
from fieldline.control.line_length import swing
from fieldline.errors import InputError
from fieldline.sensing.measurement import ORBIT, new_measurement
from tiny_flight import TinyFlight

CONTEXT = TinyFlight(inertia=(5.0, 6.0, 2.0), altitude_km=400.0, inclination_deg=70.0, period_s=1.0).context(orbits=1)

RADIUS, MASS = 6_778_000.0, 200.0
N = sqrt(3.986004418e14 / RADIUS**3)
PLAIN = replace(CONTEXT, mean_motion_rad_s=N, lines=())
pytestmark = pytest.mark.kernels


def accelerations(state, u, tension):
    """th, th', ph, ph', L, L' of a far mass below the reel; its rate follows u where given, else the tension acts."""
    th, dth, ph, dph, length, rate = state
    turn = dth - N
    growth = rate / length
    ddth = -2.0 * turn * (growth - dph * tan(ph)) - 3.0 * N * N * sin(th) * cos(th)
    ddph = -2.0 * growth * dph - (turn**2 + 3.0 * N * N * cos(th) ** 2) * sin(ph) * cos(ph)
    swung = dph**2 + (turn * cos(ph)) ** 2 + N * N * (3.0 * (cos(th) * cos(ph)) ** 2 - 1.0)
    ddl = (u - rate) / 1.0 if u is not None else length * swung - tension / MASS
    return np.array([dth, ddth, dph, ddph, rate, ddl])


def measured(measurement, state, tension):
    """What the reel's body knows: it is second, the far mass is first; the orbit is in the plane z = 0, at x."""
    th, dth, ph, dph, length, rate = state
    measurement.position_i[:], measurement.velocity_i[:] = (RADIUS, 0.0, 0.0), (0.0, RADIUS * N, 0.0)
    measurement.valid[ORBIT] = 1.0
    # orbital axes: ahead = +y, aside = against the normal = -z, down = -x
    u = np.array([-cos(th) * cos(ph), sin(th) * cos(ph), -sin(ph)])
    du = np.array(
        [
            sin(th) * cos(ph) * dth + cos(th) * sin(ph) * dph,
            cos(th) * cos(ph) * dth - sin(th) * sin(ph) * dph,
            -cos(ph) * dph,
        ]
    )
    du = du + np.cross([0.0, 0.0, N], u)
    measurement.relative_position_i[:] = -length * u
    measurement.relative_velocity_i[:] = -length * du - rate * u
    measurement.tension[:], measurement.line_length[:], measurement.line_rate[:] = tension, length, rate


def flown(name, table, state, seconds, step=4.0, context=PLAIN):
    """(seconds, states, commands) of a law that is called every step."""
    law = LAWS[name]
    params, memory = law.pack(table, context), np.zeros(law.memory)
    measurement, state = new_measurement(0, 0, 1), np.array(state, dtype=float)
    times = np.arange(0.0, seconds, step)
    kept, told = [], []
    command = 0.0
    for t in times:
        measured(measurement, state, command)
        command = float(law.kernel(t, measurement, memory, params)[0])
        kept.append(state.copy())
        told.append(command)
        u, tension = (command, 0.0) if name != "reel-tension" else (None, command)
        h = step / 4.0
        for _ in range(4):
            k1 = accelerations(state, u, tension)
            k2 = accelerations(state + h / 2 * k1, u, tension)
            k3 = accelerations(state + h / 2 * k2, u, tension)
            k4 = accelerations(state + h * k3, u, tension)
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return times, np.array(kept), np.array(told)


def test_swing_is_read_from_the_places_of_both_bodies():
    measurement = new_measurement(0, 0, 1)
    state = (0.3, 2e-4, -0.2, 5e-4, 800.0, -1.5)
    measured(measurement, state, 0.0)
    known, *read = swing(measurement)
    assert known
    np.testing.assert_allclose(read, state[:4], rtol=1e-9)
    measurement.relative_position_i[:] *= -1.0  # the same line with its far end above
    measurement.relative_velocity_i[:] *= -1.0
    np.testing.assert_allclose(swing(measurement)[1:], state[:4], rtol=1e-9)


@pytest.mark.parametrize("lean_deg", [8.0, 20.0, 30.0])
def test_paid_out_in_proportion_to_its_length_it_leans_at_a_constant_angle(lean_deg):
    """sin 2 th = 4 c / (3 n): started there, it stays."""
    lean = np.radians(lean_deg)
    c = 0.75 * N * sin(2.0 * lean)
    table = {"target_length_m": 1e6, "rate_out_per_s": c}
    times, states, _ = flown("reel-exponential", table, (lean, 0, 0, 0, 100.0, c * 100.0), 2.0 * pi / N)
    assert states[-1, 4] == pytest.approx(100.0 * exp(c * times[-1]), rel=0.02)
    assert np.abs(states[:, 0] - lean).max() < 0.02 * lean


def test_a_hundred_metres_to_twenty_kilometres_by_the_derived_rates():
    start = (0.349, 0, 0, 0, 100.0, 0.05)
    _, states, _ = flown("reel-exponential", {"target_length_m": 20e3}, start, 5.0 * 2.0 * pi / N)
    assert states[-1, 4] == pytest.approx(20e3, rel=1e-4)
    assert np.abs(states[:, 0]).max() < np.radians(45.0)
    assert np.all(np.diff(states[:, 4]) > -0.01)


def test_retrieval_swings_wider_unless_its_rate_damps_the_swing():
    start, orbits = (-0.05, 0, 0, 0, 20e3, 0.0), 3.0 * 2.0 * pi / N
    table = {"target_length_m": 500.0}
    free = flown("reel-exponential", table, start, orbits)[1]
    damped = flown("reel-exponential", table | {"in_plane_damping": 0.5}, start, orbits)[1]
    lean = 0.5 * asin(4.0 * 0.2 / 3.0)
    swung = [np.abs(one[(one[:, 4] > 1000.0) & (one[:, 4] < 5000.0), 0] + lean).max() for one in (free, damped)]
    assert swung[1] < np.radians(3.0) < np.radians(12.0) < swung[0]
    assert damped[-1, 4] < 1.2 * free[-1, 4] < 2000.0


def test_out_of_plane_swing_of_a_retrieval_is_held_by_paying_out_through_the_vertical():
    start, orbits = (0, 0, 0.1, 0, 20e3, 0.0), 4.0 * pi / N
    table = {"target_length_m": 200.0, "in_plane_damping": 0.5, "rate_in_per_s": 0.15 * N}
    free = flown("reel-exponential", table, start, orbits)[1]
    held = flown("reel-exponential", table | {"out_of_plane_damping": 10.0}, start, orbits)[1]
    late = slice(-1200, None)
    bound = sqrt(2.0 * 0.15 / 10.0)  # of small swings
    assert np.abs(free[late, 2]).max() > 3.0 * bound
    assert np.abs(held[late, 2]).max() < 1.5 * bound


def test_rupps_tension_kills_stretch_and_swing_at_the_rate_n():
    """Four roots at -n (1 +- i sqrt 2): t^1 exp(-n t) at most, equation (55)."""
    matrix = np.array([[0, 1, 0, 0], [-3, -4, 0, 2], [0, 0, 0, 1], [0, -2, -3, 0]], dtype=float)
    np.testing.assert_allclose(np.linalg.eigvals(matrix).real, -1.0, atol=1e-6)
    table = {"target_length_m": 10e3, "far_mass_kg": MASS}
    times, states, _ = flown("reel-tension", table, (0.02, 0, 0, 0, 10.1e3, 0.0), 1.5 * 2.0 * pi / N, step=2.0)
    size = np.hypot(states[:, 0], states[:, 4] / 10e3 - 1.0)
    expected = 0.06 * (1.0 + 2.0 * N * times) * np.exp(-N * times)
    assert np.all(size < expected + 1e-5)
    assert size[len(times) // 8] > 0.05 * expected[len(times) // 8]


def test_tension_pays_out_to_twenty_kilometres_and_takes_in_again():
    out = {"target_length_m": 20e3, "far_mass_kg": MASS, "tension_min_n": 0.005}
    _, states, told = flown("reel-tension", out, (0.3, 0, 0.01, 0, 100.0, 0.1), 4.0 * 2.0 * pi / N)
    assert states[-1, 4] == pytest.approx(20e3, rel=2e-3) and np.abs(states[-1, 0]) < 0.02
    assert told[-1] == pytest.approx(3.0 * N * N * MASS * 20e3, rel=0.02) and told.min() >= 0.005
    back = {"target_length_m": 500.0, "far_mass_kg": MASS}
    _, states, _ = flown("reel-tension", back, states[-1], 4.5 * 2.0 * pi / N)
    assert states[-1, 4] < 560.0 and np.abs(states[:, 0]).max() < 0.3


def test_the_profile_is_a_trapezoid_that_ends_at_its_target():
    table = {"target_length_m": 5000.0, "rate_m_s": 4.0, "acceleration_m_s2": 0.02}
    times, states, told = flown("reel-profile", table, (0.1, 0, 0, 0, 1000.0, 0.0), 2200.0, step=1.0)
    assert told.max() == pytest.approx(4.0) and states[:, 4].max() < 5000.5
    assert states[-1, 4] == pytest.approx(5000.0, abs=0.5)
    assert np.abs(np.diff(told)).max() < 1.2 * 0.02
    assert 0.95 * (1000.0 + 200.0) < times[states[:, 4] > 4999.0][0] < 1.1 * (1000.0 + 200.0)


@pytest.mark.parametrize(
    ("name", "table", "lines", "words"),
    [
        ("reel-exponential", {"rate_out_per_s": 1e-3}, (), "three quarters of the mean motion"),
        ("reel-exponential", {}, (LineEnd((0, 0, 1), "tension"),), 'has mode = "tension"; give it mode = "rate"'),
        ("reel-tension", {"far_mass_kg": 1.0}, (LineEnd((0, 0, 1)), LineEnd((0, 0, 1), "rate")), 'give it mode = "tension"'),
        ("reel-profile", {"rate_m_s": 1.0}, (LineEnd((0, 0, 1), "rate"),) * 2, "the body has 2"),
        ("reel-exponential", {"second_from_s": 5.0}, (), "needs second_from_s and second_target_length_m together"),
    ],
)
def test_what_a_reel_cannot_do_is_refused(name, table, lines, words):
    with pytest.raises(InputError, match=words):
        LAWS[name].pack({"target_length_m": 1e3} | table, replace(PLAIN, lines=lines))


def test_a_second_target_from_its_time_on():
    table = {"target_length_m": 2000.0, "rate_m_s": 4.0, "acceleration_m_s2": 0.05}
    table |= {"second_from_s": 900.0, "second_target_length_m": 800.0}
    times, states, _ = flown("reel-profile", table, (0.0, 0, 0, 0, 1000.0, 0.0), 1800.0, step=1.0)
    assert states[times < 900.0, 4][-1] == pytest.approx(2000.0, abs=0.1)
    assert states[-1, 4] == pytest.approx(800.0, abs=0.1)


def test_the_line_of_the_reel_is_the_one_that_is_read():
    context = replace(PLAIN, lines=(LineEnd((0, 0, 1)), LineEnd((0, 0, -1), "rate")))
    law, measurement = LAWS["reel-exponential"], new_measurement(0, 0, 2)
    measurement.line_length[:] = (9000.0, 100.0)
    params = law.pack({"target_length_m": 200.0, "rate_out_per_s": 1e-4, "approach_per_s": 1.0}, context)
    assert law.kernel(0.0, measurement, np.zeros(1), params)[0] == pytest.approx(1e-2)


def reeled(mode, shortest, longest, lag=1.0):
    """A context whose one line has a reel of these ends."""
    return replace(PLAIN, lines=(LineEnd((0.0, 0.0, 1.0), mode, (), shortest, longest, lag),))


@pytest.mark.parametrize("name", ["reel-exponential", "reel-profile", "reel-tension"])
@pytest.mark.parametrize("key", ["target_length_m", "second_target_length_m"])
@pytest.mark.parametrize("target", [15.0, 20.1e3])
def test_a_target_that_the_reel_has_not_is_refused(name, key, target):
    table = {"target_length_m": 1e3, "second_from_s": 9.0, "second_target_length_m": 1e3} | {key: target}
    table |= {"reel-profile": {"rate_m_s": 1.0}, "reel-tension": {"far_mass_kg": 1.0}}.get(name, {})
    context = reeled("tension" if name == "reel-tension" else "rate", 20.0, 20e3)
    with pytest.raises(InputError, match=rf"{key} of the law .* from shortest_length_m = 20 m to total_length_m = 20000 m; got"):
        LAWS[name].pack(table, context)


@pytest.mark.parametrize(("start", "rate", "ends"), [(9.9e3, 3.0, (50.0, 10e3)), (150.0, -3.0, (100.0, 10e3))])
def test_a_rate_dies_away_before_the_end_of_the_reel(start, rate, ends):
    """Whatever the gains and the swing ask for, with the reel's lag it does not run over; without the ends it does."""
    table = {
        "target_length_m": ends[1] if rate > 0.0 else ends[0],
        "approach_per_s": 5.0,
        "rate_max_m_s": 3.0,
        "rate_in_per_s": 9.0,
    }
    table["out_of_plane_damping"] = 60.0 if rate > 0.0 else 0.0
    state = (0.0, 0.0, 0.0, 6e-4, start, rate)
    lined = replace(reeled("rate", *ends), period_s=1.0)
    length = flown("reel-exponential", table, state, 200.0, 1.0, lined)[1][:, 4]
    assert ends[0] <= length.min() and length.max() <= ends[1]
    assert min(length.min() - ends[0], ends[1] - length.max()) < 1.0
    free = flown("reel-exponential", table, state, 200.0, 1.0)[1][:, 4]
    assert free.min() < ends[0] - 1.0 or free.max() > ends[1] + 1.0


def test_tension_keeps_near_its_rate_and_stops_before_the_end():
    """The swing carries it some hundred metres past the target; a reel that ends there is not run over."""
    table = {"target_length_m": 20e3, "far_mass_kg": MASS, "tension_min_n": 0.005, "rate_max_m_s": 4.0}
    start, orbits = (0.3, 0, 0.01, 0, 100.0, 0.1), 4.0 * 2.0 * pi / N
    free = flown("reel-tension", table, start, orbits)[1]
    assert free[:, 4].max() > 20.3e3 and free[:, 5].max() < 4.0 * 7.0 / 6.0
    held = flown("reel-tension", table, start, orbits, 4.0, reeled("tension", 50.0, 20.05e3))[1]
    assert held[:, 4].max() < 20.05e3 and held[-1, 4] == pytest.approx(20e3, rel=2e-3)
    back = table | {"target_length_m": 500.0, "rate_max_m_s": 2.0}
    free = flown("reel-tension", back, (0.0, 0, 0.01, 0, 20e3, 0.0), orbits)[1]
    assert free[:, 4].min() < 480.0 and free[:, 5].min() > -2.0 * 7.0 / 6.0
    held = flown("reel-tension", back, (0.0, 0, 0.01, 0, 20e3, 0.0), orbits, 4.0, reeled("tension", 490.0, 20.05e3))[1]
    assert held[:, 4].min() > 490.0 and held[-1, 4] == pytest.approx(500.0, abs=15.0)
