"""States to begin a run with: at rest, librating, in skiprope; integrated by SciPy as a chain of its own."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fieldline.analysis.line_shape import shape_of_line, skiprope_of
from fieldline.analysis.tether import (
    Ends,
    LineState,
    Strand,
    hanging,
    hanging_line,
    lateral_mode,
    librating,
    libration_ratio,
    line_budget,
    modal_amplitudes,
    point_masses,
    pulse,
    rod_tension,
    skiprope,
    straight,
    tether_modes,
)
from fieldline.analysis.tether.starts import libration_rates
from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2
from fieldline.errors import InputError

GM = EARTH_GM_M3_S2
TOP = np.array([6598e3, 0.0, 0.0])
AHEAD = np.array([0.0, 4000.0, 6600.0])
BODIES = (86363.0, 500.0)  # A above, B below


def strand(nodes: int, stiffness: float = 3.2e5, linear_mass: float = 8.35e-3) -> Strand:
    return Strand(*(np.full(nodes + 1, value) for value in (20e3 / (nodes + 1), stiffness, linear_mass)))


def ends_of(state: LineState) -> Ends:
    return Ends(state.position_i[0], state.velocity_i[0], state.position_i[-1], state.velocity_i[-1])


def flown(state: LineState, line: Strand, seconds, damping_s: float = 0.0, bodies=BODIES):
    """(t, p, 3) places and velocities of masses and springs about a point Earth; damping as a time of each spring."""
    masses = point_masses(line, *bodies)[:, None]
    count = len(masses)

    def rates(_, y):
        r, v = y[: 3 * count].reshape(-1, 3), y[3 * count :].reshape(-1, 3)
        chord = np.diff(r, axis=0)
        length = np.linalg.norm(chord, axis=1)
        rate = (chord * np.diff(v, axis=0)).sum(axis=1) / length
        pull = np.maximum(line.stiffness * ((length - line.rest) + damping_s * rate) / line.rest, 0.0) * (length > line.rest)
        force = (pull / length)[:, None] * chord
        a = -GM * r / np.linalg.norm(r, axis=1, keepdims=True) ** 3
        a[:-1] += force / masses[:-1]
        a[1:] -= force / masses[1:]
        return np.concatenate([v.ravel(), a.ravel()])

    found = solve_ivp(
        rates,
        (0.0, seconds[-1]),
        np.concatenate([state.position_i.ravel(), state.velocity_i.ravel()]),
        t_eval=seconds,
        method="DOP853",
        rtol=3e-13,
        atol=1e-8,
    ).y.T
    return found[:, : 3 * count].reshape(-1, count, 3), found[:, 3 * count :].reshape(-1, count, 3)


def seen(places, speeds, masses):
    share = masses / masses.sum()
    return shape_of_line(places, speeds, np.einsum("p,tpj->tj", share, places), np.einsum("p,tpj->tj", share, speeds))


@pytest.mark.parametrize("upward", [True, False])
def test_with_no_angle_it_is_the_state_of_rest(upward):
    line = strand(9)
    bodies = BODIES[::-1] if upward else BODIES
    state = librating(TOP, AHEAD, line, *bodies, upward=upward)
    anchor = "lower" if upward else "upper"
    rest = hanging_line(20e3, 8.35e-3, 3.2e5, 500.0, 86363.0, 6598e3, 9, anchor=anchor)
    radii = np.linalg.norm(state.position_i, axis=1)
    assert np.allclose(np.sort(radii), rest.radius, rtol=0.0, atol=3e-9)
    tension = rod_tension(state, point_masses(line, *bodies))
    assert np.allclose(tension if upward else tension[::-1], rest.tension, rtol=0.0, atol=1e-8)
    assert np.allclose(np.linalg.norm(state.velocity_i, axis=1), rest.rate * radii, rtol=1e-14)
    normal = np.cross(TOP, AHEAD) / np.linalg.norm(np.cross(TOP, AHEAD))
    assert np.abs(state.velocity_i @ normal).max() < 1e-11


def test_it_stays_at_rest():
    line = strand(3)
    state = librating(TOP, AHEAD, line, *BODIES)
    places, speeds = flown(state, line, np.linspace(0.0, 1500.0, 6))
    assert np.allclose(np.linalg.norm(places, axis=2), np.linalg.norm(places[0], axis=1), rtol=0.0, atol=2e-5)
    shape = seen(places, speeds, point_masses(line, *BODIES))
    assert np.abs(shape.in_plane_rad).max() < 1e-9 and np.abs(shape.across_rad).max() < 1e-9


def test_angles_and_rates_are_those_that_are_seen():
    line = strand(5)
    angles = {"in_plane_rad": 0.3, "across_rad": -0.2, "in_plane_rate_rad_s": 4e-4, "across_rate_rad_s": -3e-4}
    state = librating(TOP, AHEAD, line, *BODIES, **angles)
    masses = point_masses(line, *BODIES)
    step = 0.01
    places = np.stack([state.position_i + k * step * state.velocity_i for k in (-1, 0, 1)])
    shape = seen(places, np.stack([state.velocity_i] * 3), masses)
    # seen from the mass centre, whose vertical is 0.006 of a degree from that of A
    assert np.isclose(shape.in_plane_rad[1], 0.3, atol=2e-5) and np.isclose(shape.across_rad[1], -0.2, atol=2e-5)
    assert np.isclose(np.ptp(shape.in_plane_rad) / (2.0 * step), 4e-4, rtol=1e-3)
    assert np.isclose((shape.across_rad[2] - shape.across_rad[0]) / (2.0 * step), -3e-4, rtol=1e-3)
    assert np.allclose(shape.deflection_m, 0.0, atol=1e-8) and np.allclose(shape.deflection_rate_m_s, 0.0, atol=1e-8)


def test_a_libration_of_both_angles_obeys_its_equations():
    """(2) of `starts` integrated beside a short massless pair, swinging widely in and across the plane."""
    line = Strand(np.array([500.0]), np.array([2e4]), np.zeros(1))
    begun = np.array([0.5, -0.3, 3e-4, 4e-4])
    told = dict(zip(("in_plane_rad", "across_rad", "in_plane_rate_rad_s", "across_rate_rad_s"), begun, strict=True))
    state = librating(TOP, AHEAD, line, *BODIES, **told)
    seconds = np.linspace(0.0, 3000.0, 16)
    shape = seen(*flown(state, line, seconds, damping_s=1.0), point_masses(line, *BODIES))
    n = np.linalg.norm(state.velocity_i[0]) / np.linalg.norm(state.position_i[0])
    law = solve_ivp(lambda _, y: libration_rates(y, n), (0.0, 3000.0), begun, t_eval=seconds, rtol=1e-10, atol=1e-12).y
    assert np.ptp(law[0]) > 0.6 and np.ptp(law[1]) > 0.5
    assert np.abs(shape.in_plane_rad - law[0]).max() < 1e-3  # 500 m over the radius, and the stretch
    assert np.abs(shape.across_rad - law[1]).max() < 1e-3


def test_a_swing_in_the_plane_has_the_elliptic_period_and_does_not_ring():
    line = strand(0)
    state = librating(TOP, AHEAD, line, *BODIES, in_plane_rad=np.radians(30.0))
    seconds = np.linspace(0.0, 4000.0, 401)
    places, speeds = flown(state, line, seconds)
    angle = seen(places, speeds, point_masses(line, *BODIES)).in_plane_rad
    turns = np.flatnonzero(np.diff(np.sign(angle)))
    crossings = seconds[turns] - 10.0 * angle[turns] / np.diff(angle)[turns]
    rate = np.pi / np.diff(crossings)[0]
    n = hanging_line(20e3, 8.35e-3, 3.2e5, 500.0, 86363.0, 6598e3, 0).rate
    assert np.isclose(rate / n, libration_ratio(np.radians(30.0)), rtol=4e-3)  # the length's share is 0.28 %
    stretch = np.linalg.norm(places[:, 1] - places[:, 0], axis=1)
    slow = np.polynomial.Polynomial.fit(seconds[:100], stretch[:100], 6)(seconds[:100])
    assert np.abs(stretch[:100] - slow).max() < 2e-3  # of 3 m; 0.17 rad/s would show


@pytest.mark.parametrize("sense, turn", [("right-handed", 1.0), ("left-handed", -1.0), ("plane", 0.0)])
def test_skiprope_goes_round_as_told(sense, turn):
    line = strand(5)
    masses = point_masses(line, *BODIES)
    state = librating(TOP, AHEAD, line, *BODIES)
    swung = skiprope(state, line, *BODIES, amplitude_m=20.0, phase_rad=0.7, sense=sense)
    seconds = np.linspace(0.0, 1100.0, 111)
    places, speeds = flown(swung, line, seconds, damping_s=0.05)
    shape = seen(places, speeds, masses)
    first = shape.bow_m[0]
    assert np.isclose(np.arctan2(first[1], first[0]), 0.7, atol=1e-6)
    assert np.isclose(shape.largest_m[0], 20.0, rtol=1e-9)
    found = skiprope_of(shape, seconds)
    # the planes' frequencies differ by half a per cent, so circles grow a little oval
    assert np.isclose(found.sense[0], turn, atol=0.1)
    modes = tether_modes(20e3, 8.35e-3, 3.2e5, 500.0, 86363.0, 6598e3 - EARTH_EQUATORIAL_RADIUS_M, 5)
    between = sorted((modes.in_plane_frequency.values[1], modes.out_of_plane_frequency.values[1]))
    assert between[0] * 0.95 < found.rate_rad_s[0] < between[1] * 1.05  # a window that is no whole period
    again = LineState(places[-1], speeds[-1])
    assert np.isclose(np.linalg.norm(again.position_i[0]), 6598e3, atol=5.0)


def test_a_mode_is_that_of_tether_modes():
    line = strand(12)
    state = librating(TOP, AHEAD, line, *BODIES)
    modes = tether_modes(20e3, 8.35e-3, 3.2e5, 500.0, 86363.0, 6598e3 - EARTH_EQUATORIAL_RADIUS_M, 12)
    for mode in (1, 2, 12):
        lateral = lateral_mode(state, line, point_masses(line, *BODIES), mode)
        assert np.isclose(lateral.out_of_plane, modes.out_of_plane_frequency.values[mode], rtol=1e-9)
        assert np.isclose(lateral.in_plane, modes.in_plane_frequency.values[mode], rtol=3e-5)
        shape = modes.out_of_plane_shape.values[mode][::-1]  # from A, the upper end
        flat = shape - np.interp(np.arange(14), [0, 13], shape[[0, -1]])
        assert np.allclose(lateral.shape, flat / flat[np.abs(flat).argmax()], atol=2e-4)


def test_modes_laid_on_are_modes_found():
    line = strand(8)
    masses = point_masses(line, *BODIES)
    state = librating(TOP, AHEAD, line, *BODIES, in_plane_rad=0.1, across_rad=0.05)
    for mode in (1, 2, 3):
        state = skiprope(state, line, *BODIES, amplitude_m=3.0 * mode, phase_rad=0.4 * mode, mode=mode) if mode == 1 else state
    shape = seen(state.position_i[None], state.velocity_i[None], masses)
    given = np.stack([lateral_mode(librating(TOP, AHEAD, line, *BODIES), line, masses, k).shape for k in (1, 2, 3)])
    place, rate = modal_amplitudes(shape, masses, shapes=given)
    assert np.allclose(place[0, 0], 3.0 * np.array([np.cos(0.4), np.sin(0.4)]), rtol=2e-3)
    assert np.abs(place[0, 1:]).max() < 5e-3
    lateral = lateral_mode(state, line, masses, 1)
    assert np.allclose(
        rate[0, 0], 3.0 * np.array([-lateral.in_plane * np.sin(0.4), lateral.out_of_plane * np.cos(0.4)]), rtol=1e-2
    )
    sines, _ = modal_amplitudes(shape, masses, modes=2)
    assert np.allclose(sines[0, 0], place[0, 0], rtol=0.03)


def test_straight_lines_share_one_tension_and_slack_ones_are_laid_straight():
    line = Strand(np.array([10.0, 20.0, 30.0]), np.array([100.0, 400.0, 100.0]), np.ones(3))
    ends = Ends(np.array([7e6, 0.0, 0.0]), np.array([0.0, 7e3, 0.0]), np.array([7e6, 66.0, 0.0]), np.array([1.0, 7e3, 0.0]))
    taut = straight(ends, line)
    strain = np.linalg.norm(np.diff(taut.position_i, axis=0), axis=1) / line.rest - 1.0
    assert np.allclose(strain * line.stiffness, 6.0 / (10.0 / 100.0 + 20.0 / 400.0 + 30.0 / 100.0), rtol=1e-7)
    part = (taut.position_i[:, 1] - 0.0) / 66.0
    assert np.allclose(taut.velocity_i[:, 0], part, rtol=1e-12)
    slack = straight(ends._replace(place_b=np.array([7e6, 30.0, 0.0])), line)
    assert np.allclose(slack.position_i[:, 1], [0.0, 5.0, 15.0, 30.0])


def test_between_the_ends_of_a_quiet_line_nodes_are_quiet():
    line = strand(9)
    state = librating(TOP, AHEAD, line, *BODIES, in_plane_rad=0.4, across_rate_rad_s=3e-4)
    filled = hanging(ends_of(state), line, *BODIES)
    assert np.allclose(filled.position_i, state.position_i, rtol=0.0, atol=3e-9)
    assert np.allclose(filled.velocity_i, state.velocity_i, rtol=0.0, atol=1e-4)  # the stretch is a little uneven
    longer = ends_of(state)._replace(place_b=state.position_i[-1] + 1e-4 * (state.position_i[-1] - state.position_i[0]))
    lengths = np.linalg.norm(np.diff(hanging(longer, line, *BODIES).position_i, axis=0), axis=1)
    more = 3.2e5 * (lengths / line.rest - 1.0) - rod_tension(state, point_masses(line, *BODIES))
    assert np.allclose(more, 3.2e5 * 1e-4 * 1.00015, rtol=3e-4)


def test_a_line_too_short_at_one_end_is_slack_there_and_taut_elsewhere():
    """Hung between bodies that hold it higher than it hangs: the lower segments carry nothing."""
    line = strand(9, linear_mass=1.0)
    state = librating(TOP, AHEAD, line, *BODIES)
    top = state.position_i[0]
    nearer = ends_of(state)._replace(
        place_b=top + 20008.0 / np.linalg.norm(state.position_i[-1] - top) * (state.position_i[-1] - top)
    )
    lengths = np.linalg.norm(np.diff(hanging(nearer, line, *BODIES).position_i, axis=0), axis=1)
    strain = lengths / line.rest - 1.0
    assert np.all(strain > -1e-9) and np.isclose(lengths.sum(), np.linalg.norm(nearer.place_b - top), rtol=1e-12)
    assert strain[-1] < 1e-9 < strain[0]


def test_a_pulse_runs_at_the_speed_of_sound():
    line = strand(79, linear_mass=0.05)
    state = librating(TOP, AHEAD, line, *BODIES)
    sent = pulse(state, line, amplitude_m=0.1, middle=0.3, width_m=1200.0, towards="b")
    seconds = np.array([0.0, 3.0])
    places, _ = flown(sent, line, seconds)
    quiet, _ = flown(state, line, seconds)
    moved = np.linalg.norm(places[-1] - places[-1, 0], axis=1) - np.linalg.norm(quiet[-1] - quiet[-1, 0], axis=1)
    rest = np.linspace(0.0, 20e3, 81)
    there = 0.3 * 20e3 + 3.0 * np.sqrt(3.2e5 / 0.05)
    assert np.allclose(moved, 0.1 * np.exp(-(((rest - there) / 1200.0) ** 2)), atol=6e-3)


def test_energy_and_angular_momentum_are_kept():
    line = strand(4)
    masses = point_masses(line, *BODIES)
    quiet = librating(TOP, AHEAD, line, *BODIES, in_plane_rad=0.2)
    state = skiprope(quiet, line, *BODIES, amplitude_m=30.0)
    places, speeds = flown(state, line, np.linspace(0.0, 600.0, 4))
    budget = line_budget(places, speeds, masses, line.rest, line.stiffness)
    energy, angular = budget.energy.values, budget.angular_momentum_i.values
    swing = 0.5 * 8.35e-3 * 20e3 * 30.0**2 * 0.012**2 / 2.0  # of the skiprope, J
    assert np.abs(energy - energy[0]).max() < 0.02 * swing + 2e-13 * abs(energy[0])
    assert np.abs(angular - angular[0]).max() < 1e-11 * np.linalg.norm(angular[0])
    still = line_budget(*(np.array([part]) for part in quiet), masses, line.rest, line.stiffness)
    assert np.allclose(still.tension_spring.values[0], rod_tension(quiet, masses), rtol=1e-6)
    missing = places.copy()
    missing[:, 2] = np.nan
    assert np.isfinite(
        line_budget(missing, np.where(np.isnan(missing), np.nan, speeds), masses, line.rest, line.stiffness).energy
    ).all()


def test_what_cannot_be_started_is_refused_in_words():
    line = strand(4)
    state = librating(TOP, AHEAD, line, *BODIES)
    refused = {
        "right-handed": lambda: skiprope(state, line, *BODIES, amplitude_m=1.0, sense="right"),
        "from 1 to 4": lambda: skiprope(state, line, *BODIES, amplitude_m=1.0, mode=5),
        "amplitude_m": lambda: skiprope(state, line, *BODIES, amplitude_m=-1.0),
        "no tension": lambda: skiprope(
            straight(ends_of(state)._replace(place_b=TOP + np.array([0.0, 0.0, 2e4]), speed_b=state.velocity_i[0]), line),
            line,
            *BODIES,
            amplitude_m=1.0,
        ),
        "would fold": lambda: pulse(state, line, amplitude_m=5.0, width_m=4.0),
        '"b"|both': lambda: pulse(state, line, amplitude_m=1.0, width_m=400.0, towards="c"),
        "with mass": lambda: pulse(state, strand(4, linear_mass=0.0), amplitude_m=1.0, width_m=400.0),
        "in newtons": lambda: librating(TOP, AHEAD, strand(4, stiffness=10.0), *BODIES),
        "pushed": lambda: librating(TOP, AHEAD, line, *BODIES, across_rad=1.5, in_plane_rate_rad_s=-1.2e-3),
        "shape": lambda: modal_amplitudes(seen(*(part[None] for part in state), point_masses(line)), np.ones(3)),
        "modes": lambda: modal_amplitudes(seen(*(part[None] for part in state), point_masses(line)), np.ones(6), modes=0),
        "position_i_m": lambda: line_budget(state.position_i, state.velocity_i, np.ones(6), line.rest, line.stiffness),
        "mass_kg": lambda: line_budget(state.position_i[None], state.velocity_i[None], np.ones(5), line.rest, line.stiffness),
    }
    for words, call in refused.items():
        with pytest.raises(InputError, match=words):
            call()
