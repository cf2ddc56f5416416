"""Where bodies start: every way of saying an orbit against closed forms, clocks and the orbit readers."""

from importlib.resources import files

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2, EARTH_J2
from fieldline.errors import InputError
from fieldline.frames.attitude import dcm_from_quaternion
from fieldline.frames.earth_rotation import dcm_ei
from fieldline.orbit import read_orbit
from fieldline.simulate.scenario import Body, Elements, OrbitStart, Scenario, State, SunSynchronous
from fieldline.simulate.scenario.attitudes import start_attitude
from fieldline.simulate.scenario.states import orbital_axes, period_s, start_states, state_of
from fieldline.simulate.scenario.templates import template

START = np.datetime64("2026-03-01T00:00:00", "ns")
TLE = files("fieldline").joinpath("data", "suchai3.tle")
RIGID = {"name": "a", "mass_kg": 1.0, "inertia_kg_m2": [1.0, 1.0, 1.0]}


def state(**elements):
    return state_of(OrbitStart(elements=Elements(**elements)), START)


def test_elements_give_the_vectors_that_define_them():
    e, inclination, node, perigee, nu = 0.3, 50.0, 20.0, 70.0, 110.0
    r, v = state(
        semi_major_axis_km=12000.0,
        eccentricity=e,
        inclination_deg=inclination,
        raan_deg=node,
        argument_of_perigee_deg=perigee,
        true_anomaly_deg=nu,
    )
    h = np.cross(r, v)
    eccentricity = np.cross(v, h) / EARTH_GM_M3_S2 - r / np.linalg.norm(r)
    ascending = np.cross([0.0, 0.0, 1.0], h)
    assert np.linalg.norm(eccentricity) == pytest.approx(e, rel=1e-12)
    assert np.degrees(np.arccos(h[2] / np.linalg.norm(h))) == pytest.approx(inclination)
    assert np.degrees(np.arctan2(ascending[1], ascending[0])) == pytest.approx(node)
    assert np.degrees(angle(ascending, eccentricity)) == pytest.approx(perigee)
    assert np.degrees(angle(eccentricity, r)) == pytest.approx(nu)
    assert r @ v > 0.0  # before apogee the body rises
    assert period_s(r, v) == pytest.approx(2.0 * np.pi * np.sqrt(1.2e7**3 / EARTH_GM_M3_S2), rel=1e-12)


def angle(a, b):
    return np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)


@pytest.mark.parametrize("mean_deg", [-350.0, 1e-3, 90.0, 179.0, 181.0, 300.0])
@pytest.mark.parametrize("e", [0.0, 0.1, 0.73])
def test_a_mean_anomaly_is_the_area_swept(mean_deg, e):
    r, v = state(semi_major_axis_km=26600.0, eccentricity=e, inclination_deg=0.0, mean_anomaly_deg=mean_deg)
    axis = 2.66e7
    eccentric = np.arctan2(r @ v / np.sqrt(EARTH_GM_M3_S2 * axis), 1.0 - np.linalg.norm(r) / axis)  # e sin E, e cos E
    if e > 0.0:
        kepler = eccentric - e * np.sin(eccentric)
        assert np.exp(1j * kepler) == pytest.approx(np.exp(1j * np.radians(mean_deg)), abs=1e-9)
    else:
        assert np.arctan2(r[1], r[0]) == pytest.approx(np.angle(np.exp(1j * np.radians(mean_deg))), abs=1e-12)


def test_an_argument_of_latitude_is_counted_from_the_node():
    r, _ = state(altitude_km=500.0, inclination_deg=60.0, argument_of_latitude_deg=90.0)
    expected = [0.0, np.cos(np.pi / 3.0), np.sin(np.pi / 3.0)]
    np.testing.assert_allclose(r / np.linalg.norm(r), expected, atol=1e-15)


@pytest.mark.parametrize("hour", [0.0, 10.5, 18.0])
@pytest.mark.parametrize("day", ["2001-06-21T03:00", "2026-03-01T00:00", "2035-11-11T11:11"])
def test_the_sun_synchronous_node_stands_at_its_local_time(hour, day):
    when = np.datetime64(day, "ns")
    r, v = state_of(OrbitStart(sun_synchronous=SunSynchronous(altitude_km=500.0, local_time_h=hour)), when)
    r_e = dcm_ei(np.array([when]))[0] @ r
    utc_h = (when - when.astype("datetime64[D]")).astype(np.int64) / 3.6e12
    local_h = utc_h + np.degrees(np.arctan2(r_e[1], r_e[0])) / 15.0
    half_a_minute = 0.5 / 60.0  # 0.01 deg of the mean Sun is 2.4 s; UT1 = UTC another second
    assert abs((local_h - hour + 12.0) % 24.0 - 12.0) < half_a_minute
    assert abs(r_e[2]) < 3e4 and v[2] > 0.0  # the pole has moved since J2000 by 0.2 deg at most


@pytest.mark.parametrize(("altitude_km", "inclination_deg"), [(500.0, 97.4), (800.0, 98.6), (1500.0, 102.0)])
def test_the_sun_synchronous_node_turns_once_a_year(altitude_km, inclination_deg):
    r, v = state_of(OrbitStart(sun_synchronous=SunSynchronous(altitude_km=altitude_km, local_time_h=6.0)), START)
    momentum = np.cross(r, v)
    cosine = momentum[2] / np.linalg.norm(momentum)
    axis = EARTH_EQUATORIAL_RADIUS_M + 1e3 * altitude_km
    motion = np.sqrt(EARTH_GM_M3_S2 / axis**3)
    ratio = (EARTH_EQUATORIAL_RADIUS_M / axis) ** 2
    rate = -1.5 * motion * EARTH_J2 * ratio * cosine
    assert np.degrees(rate) * 86400.0 == pytest.approx(360.0 / 365.2422 - 3.51e-5, rel=1e-6)  # the equinox moves, GCRS does not
    assert np.degrees(np.arccos(cosine)) == pytest.approx(inclination_deg, abs=0.05)


def test_an_earth_fixed_state_moves_as_the_earth_does():
    r, v = state(altitude_km=700.0, inclination_deg=51.0, raan_deg=33.0, argument_of_latitude_deg=77.0)
    dt_ns = 100_000_000
    times = START + np.array([-dt_ns, 0, dt_ns]).astype("timedelta64[ns]")
    turns = dcm_ei(times)
    acceleration = -EARTH_GM_M3_S2 * r / np.linalg.norm(r) ** 3
    ends = [turns[k] @ (r + sign * 0.1 * v + 0.005 * acceleration) for k, sign in ((0, -1.0), (2, 1.0))]
    fixed = State(position_km=1e-3 * (turns[1] @ r), velocity_km_s=1e-3 * (ends[1] - ends[0]) / 0.2, axes="itrs")
    back_r, back_v = state_of(OrbitStart(state=fixed), START)
    np.testing.assert_allclose(back_r, r, atol=1e-6)
    np.testing.assert_allclose(back_v, v, atol=1e-3)  # the difference over 0.1 s, and precession


def test_a_tle_serves_as_file_and_as_text(tmp_path):
    (tmp_path / "sat.tle").write_text(TLE.read_text())
    when = np.datetime64("2023-08-24T14:00", "ns")
    expected = np.concatenate(read_orbit(tmp_path / "sat.tle").state_i(when))
    for start in (OrbitStart(tle="sat.tle"), OrbitStart(tle=TLE.read_text())):
        np.testing.assert_allclose(np.concatenate(state_of(start, when, tmp_path)), expected, rtol=1e-12)


def two_bodies(**second):
    return Scenario.from_dict(
        {
            "time": {"start_utc": "2026-03-01", "duration_s": 100.0},
            "orbit": {"elements": {"altitude_km": 500.0, "inclination_deg": 51.0, "raan_deg": 10.0}},
            "body": [RIGID, {"name": "b", "kind": "point", "mass_kg": 1.0, **second}],
        }
    )


def test_a_body_beside_another_moves_with_the_turning_axes():
    offset, drift = np.array([10.0, 20.0, 300.0]), np.array([0.1, -0.2, 0.3])
    first, second = start_states(two_bodies(offset_o_m=offset, offset_rate_o_m_s=drift))
    motion = 2.0 * np.pi / period_s(*first)

    def place(t):  # the circular orbit in closed form, with the offset that drifts in its axes
        r = first[0] * np.cos(motion * t) + first[1] * np.sin(motion * t) / motion
        v = first[1] * np.cos(motion * t) - first[0] * np.sin(motion * t) * motion
        return r + orbital_axes(r, v)[0] @ (offset + drift * t)

    np.testing.assert_allclose(second[0], place(0.0), rtol=1e-15)
    np.testing.assert_allclose(second[1], (place(0.1) - place(-0.1)) / 0.2, atol=1e-5)


def test_a_body_with_an_orbit_of_its_own_starts_there():
    own = {"elements": {"altitude_km": 600.0, "inclination_deg": 10.0}}
    _, second = start_states(two_bodies(orbit=own))
    np.testing.assert_array_equal(second, state(altitude_km=600.0, inclination_deg=10.0))


def turned(index=0, seed=0, **keys):
    r, v = state(altitude_km=500.0, inclination_deg=51.0, raan_deg=200.0, argument_of_latitude_deg=40.0)
    return *start_attitude(Body(**RIGID, **keys), index, seed, r, v), orbital_axes(r, v)


@pytest.mark.kernels
def test_the_attitude_is_along_the_orbital_axes_unless_said():
    q, omega, (dcm_io, _) = turned()
    np.testing.assert_allclose(dcm_from_quaternion(q), dcm_io.T, atol=1e-14)
    assert not omega.any()


@pytest.mark.kernels
def test_euler_angles_turn_by_yaw_pitch_and_roll():
    yaw_pitch_roll = [30.0, -20.0, 75.0]
    rotation = Rotation.from_euler("ZYX", yaw_pitch_roll, degrees=True)
    q, _, (dcm_io, _) = turned(attitude={"euler_321_deg": yaw_pitch_roll})
    np.testing.assert_allclose(dcm_from_quaternion(q).T, dcm_io @ rotation.as_matrix(), atol=1e-14)
    q, _, _ = turned(attitude={"euler_321_deg": yaw_pitch_roll, "axes": "gcrs"})
    np.testing.assert_allclose(dcm_from_quaternion(q).T, rotation.as_matrix(), atol=1e-14)


@pytest.mark.kernels
def test_quaternions_are_taken_as_given():
    given = np.array([0.1, -0.2, 0.3, 0.9])
    given /= np.linalg.norm(given)
    q, _, (dcm_io, _) = turned(attitude={"quaternion_bi": given})
    np.testing.assert_allclose(q, given, rtol=1e-15)
    q, _, _ = turned(attitude={"quaternion_bo": given})
    np.testing.assert_allclose(dcm_from_quaternion(q).T, dcm_io @ Rotation.from_quat(given).as_matrix(), atol=1e-14)


@pytest.mark.kernels
def test_a_rate_against_the_orbital_axes_includes_their_own():
    q, omega, (dcm_io, rate_o) = turned(rate_deg_s=[0.0, 0.0, 0.0], rate_axes="orbital", attitude={"random": True})
    np.testing.assert_allclose(dcm_from_quaternion(q).T @ omega, dcm_io @ rate_o, rtol=1e-9)
    assert rate_o[1] == pytest.approx(-2.0 * np.pi / 5677.0, rel=1e-4)  # forward, about the orbit normal, which is -y
    _, spun, _ = turned(rate_deg_s=[0.0, 0.0, 180.0])
    np.testing.assert_allclose(spun, [0.0, 0.0, np.pi])


@pytest.mark.kernels
def test_random_starts_are_even_repeatable_and_separate():
    draws = [turned(seed=k, attitude={"random": True}, random_rate_deg_s=2.0) for k in range(400)]
    matrices = np.array([dcm_from_quaternion(q) for q, _, _ in draws])
    rates = np.degrees([omega for _, omega, _ in draws])
    five_sigma = 5.0 / np.sqrt(3.0 * 400)
    assert np.abs(matrices.mean(axis=0)).max() < five_sigma
    assert np.abs(rates.mean(axis=0)).max() < 2.0 * five_sigma
    np.testing.assert_allclose(np.linalg.norm(rates, axis=1), 2.0)
    again = turned(seed=7, attitude={"random": True})[0]
    np.testing.assert_array_equal(again, draws[7][0])
    assert np.abs(turned(index=1, seed=7, attitude={"random": True})[0] - again).max() > 1e-3


@pytest.mark.parametrize("along_m_s", [3156.0, 4000.0, -9000.0])
def test_a_body_beside_another_that_falls_or_leaves_is_refused(along_m_s):
    pair = Scenario.from_toml(template("pair", "pair"))
    with pytest.raises(InputError, match="offset_rate_o_m_s"):
        pair.replace(**{"body.1.offset_rate_o_m_s": [along_m_s, 0.0, 0.0]}).check()
