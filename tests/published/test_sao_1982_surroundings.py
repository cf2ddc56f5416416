"""The 1978 program's forces at one place, its angles and its angular damping (Annex III of NASA-CR-170721)."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.cases.sao_1982 import annex_run, spin
from fieldline.cases.sao_1982.dumbbell import critical_angular_damping, critical_damping, dumbbell, strung
from fieldline.cases.sao_1982.euler_angles import (
    body_rate,
    cosines_of,
    direction_cosines,
    euler_angles,
    quaternion_of,
    xyz_angles,
)
from fieldline.cases.sao_1982.flight import Pair, pair_at, scenario_of, turning_start
from fieldline.cases.sao_1982.surroundings import (
    GM_M3_S2,
    J2,
    load_parameters,
    surroundings_of_1978,
    surroundings_of_a_node,
)
from fieldline.dynamics.loads.joint import direction_rate, joint_torque
from fieldline.simulate.run import simulate

PLACE, VELOCITY = np.array([5e6, 3e6, 3e6]), np.array([-3e3, 6e3, 3.5e3])
CENTRAL = np.array([-7.0681544631, -4.2408926779, -4.2408926779])
MASS_KG = 100.0


def acceleration(**what):
    """Of the load alone [m/s^2], at the place and velocity of the check."""
    state = np.concatenate([PLACE, VELOCITY, [0.0, 0.0, 0.0, 1.0], np.zeros(3)])
    parameters = np.array(list(load_parameters(MASS_KG, **what).values()))
    found = surroundings_of_1978(0.0, state, parameters)
    assert (found[3:] == 0.0).all()
    return found[:3] / MASS_KG


@pytest.mark.kernels
def test_forces_at_a_point():
    """cm/s^2 of an independent code, to their last digits."""
    assert -GM_M3_S2 * PLACE / np.linalg.norm(PLACE) ** 3 == pytest.approx(CENTRAL, abs=6e-11)
    assert (acceleration() == 0.0).all()
    assert 100.0 * acceleration(j2=J2) == pytest.approx([0.05050559, 0.03030335, -1.27274091], abs=6e-9)
    anomaly = {"anomaly_mgal": 100.0, "anomaly_x_m": 6378e3, "anomaly_y_m": 0.0, "anomaly_z_m": 0.0}
    assert 100.0 * acceleration(anomaly=anomaly) == pytest.approx([3.06161e-6, -6.66534e-6, -6.66534e-6], abs=1e-11)
    air = {"drag_area_m2": 2.2, "density_kg_m3": 2e-10, "reference_height_m": 220e3, "scale_height_m": 50e3}
    assert 100.0 * acceleration(air=air) == pytest.approx([0.01123943, -0.02247885, -0.01311267], abs=6e-9)


def shift_of_the_shuttle(duration_s, **what):
    """How much farther [m] the Shuttle is than without, (3,): x up at the start, y along."""
    plain, moved = (spin(duration_s=duration_s, output_step_s=duration_s, **kind) for kind in ({}, what))
    return (moved["position_i"] - plain["position_i"]).values[-1, 0]


def test_perturbed_flights_move_as_the_forces_say():
    """Half the force over the mass times the square of a short time."""
    seconds, speed = 4.0, 6598e3 * 1.178021398e-3
    flat = shift_of_the_shuttle(seconds, oblate=True)
    assert flat[0] == pytest.approx(0.5 * seconds**2 * -1.5 * J2 * 3.986013e14 * 6378e3**2 / 6598e3**4, rel=1e-3)
    air = {"drag_area_m2": 1.0, "density_kg_m3": 2e-7, "reference_height_m": 220e3, "scale_height_m": 50e3}
    blown = shift_of_the_shuttle(seconds, air=air | {"upper_drag_area_m2": 500.0})
    assert blown[1] == pytest.approx(-0.5 * seconds**2 * 0.5 * 500.0 * 2e-7 * speed**2 / 86363.0, rel=1e-3)
    anomaly = {"anomaly_mgal": 1e4, "anomaly_x_m": 6378e3, "anomaly_y_m": 0.0, "anomaly_z_m": 0.0}
    drawn = shift_of_the_shuttle(seconds, anomaly=anomaly)
    pull = 0.1 * (6378e3 * np.pi / 180.0) ** 2 / (2.0 * np.pi * 220e3**2)
    assert drawn[0] == pytest.approx(-0.5 * seconds**2 * pull, rel=0.01)


@pytest.mark.parametrize("angles", [(0.35, 1.57, 0.0), (1.2, -2.0, 3.0), (3.0, 0.4, -1.0), (1.5707963, 1.5707963, 0.0)])
def test_angles_and_cosines(angles):
    theta, psi, phi = angles
    a = direction_cosines(theta, psi, phi)
    assert a == pytest.approx(Rotation.from_euler("ZXZ", [psi, theta, phi]).as_matrix().T, abs=1e-15)
    assert a[2] == pytest.approx([np.sin(theta) * np.sin(psi), -np.sin(theta) * np.cos(psi), np.cos(theta)], abs=1e-15)
    assert np.array(euler_angles(a)) == pytest.approx(angles, abs=1e-12)
    assert cosines_of(quaternion_of(*angles)) == pytest.approx(a, abs=1e-14)
    # The annex's printed cosines: its phi is the node, its psi the spin.
    alpha1 = np.cos(phi) * np.cos(psi) - np.cos(theta) * np.sin(psi) * np.sin(phi)
    beta1 = np.cos(phi) * np.sin(psi) + np.cos(theta) * np.cos(psi) * np.sin(phi)
    assert a[0] == pytest.approx([alpha1, beta1, np.sin(phi) * np.sin(theta)], abs=1e-15)
    turns = xyz_angles(a)
    assert Rotation.from_euler("XYZ", turns).as_matrix().T == pytest.approx(a, abs=1e-12)


def test_rates_are_those_of_the_cosines():
    angles, rates, h = np.array([0.8, -0.4, 2.0]), np.array([0.02, -0.03, 0.05]), 1e-5
    ahead, back = (direction_cosines(*(angles + s * h * rates)) for s in (1.0, -1.0))
    cross = -((ahead - back) / (2.0 * h)) @ direction_cosines(*angles).T  # [omega x]
    wanted = [cross[2, 1], cross[0, 2], cross[1, 0]]
    found = body_rate(angles[0], angles[2], rates[0], rates[1], rates[2])
    assert found == pytest.approx(wanted, abs=1e-9)


def test_upright_angles_keep_their_sum():
    theta, psi, phi = euler_angles(direction_cosines(0.0, 0.3, 0.5))
    assert (float(theta), float(psi)) == (0.0, 0.0) and float(phi) == pytest.approx(0.8)


def test_critical_values():
    two = dumbbell(100.0, 86363.0, 6578e3, 6598e3, 3.986013e14)
    assert critical_angular_damping(40.0, two.tension_n, 1.0) == pytest.approx(36.53, abs=5e-3)
    assert critical_damping(two, 20e3, 3.2e5) == pytest.approx(79.95, abs=5e-3)
    assert np.sqrt(two.tension_n / 40.0) == pytest.approx(0.4567, abs=5e-5)  # the swing of the annex's ball of 40 kg m^2
    assert np.sqrt(3.2e5 / 20e3 / 100.0) == pytest.approx(0.4, abs=1e-12)  # its stretch


def turned(lever, chord, omega, chord_rate, h):
    """Angle between lever and chord after h, the lever turned and the chord moved."""
    lever = Rotation.from_rotvec(h * np.array(omega)).apply(lever)
    chord = np.array(chord) + h * np.array(chord_rate)
    return np.arctan2(np.linalg.norm(np.cross(lever, chord)), lever @ chord)


@pytest.mark.kernels
@pytest.mark.parametrize("degrees", [0.01, 5.0, 44.9, 45.1, 89.9, 120.0, 179.0])
def test_both_forms_are_the_rate_of_the_angle(degrees):
    turn = Rotation.from_rotvec(np.radians(degrees) * np.array([0.6, 0.0, 0.8]))
    chord, lever = np.array([0.0, 20.0, 0.0]), turn.apply([0.0, 0.7, 0.0])
    omega, chord_rate, beta = (0.03, 0.02, -0.05), (0.4, -0.3, 0.2), 7.0
    h = 1e-6
    rate = (turned(lever, chord, omega, chord_rate, h) - turned(lever, chord, omega, chord_rate, -h)) / (2.0 * h)
    found = np.array(joint_torque(tuple(lever), omega, tuple(chord), chord_rate, beta))
    across = np.cross(lever, chord)
    assert found == pytest.approx(beta * rate * across / np.linalg.norm(across), abs=2e-7 * beta)


@pytest.mark.kernels
def test_aligned_and_conical_motion():
    up = (0.0, 0.0, 2.0)
    still = (0.0, 0.0, 0.0)
    found = joint_torque((0.0, 0.0, 1.0), (0.1, 0.0, 0.0), up, still, 3.0)
    assert found == pytest.approx((-0.3, 0.0, 0.0), abs=1e-15)  # straight against the turn
    lever = (0.3, 0.0, 0.9)
    assert joint_torque(lever, (0.0, 0.0, 5.0), up, still, 3.0) == pytest.approx(still, abs=1e-15)  # a cone keeps its angle
    along, rate = direction_rate((0.0, 3.0, 4.0), (1.0, 0.0, 0.0))
    assert along == pytest.approx((0.0, 0.6, 0.8)) and rate == pytest.approx((0.2, 0.0, 0.0))


def test_joint_damping_is_the_lines_and_rests_where_it_is_slack():
    """The plant's own: the annex's run loses the energy of its swing, and one on a slack line none."""
    swung = annex_run("in-plane", duration_s=20.0)
    free = annex_run("in-plane-linear", duration_s=20.0)
    assert float(swung["lever_angle"][-1]) < 0.01 < 0.2 < float(free["lever_angle"].values.max())


AIR = {"drag_area_m2": 0.0, "density_kg_m3": 2e-9, "reference_height_m": 220e3, "scale_height_m": 50e3}
ANOMALY = {"anomaly_mgal": 1e4, "anomaly_x_m": 6378e3, "anomaly_y_m": 0.0, "anomaly_z_m": 0.0}


@pytest.mark.parametrize(
    "what", [{"oblate": True}, {"anomaly": ANOMALY}, {"air": AIR | {"line_drag_area_m2": 60.0}}], ids=["flat", "anomaly", "air"]
)
def test_nodes_feel_what_the_masses_feel(what):
    """Section 3.2: half the force over the node's mass times the square of a short time, at the node's own place."""
    seconds, flown = 1.0, []
    pair = Pair(
        strung(pair_at(220e3, 100.0, 86363.0, 20e3), 2, 60.0, GM_M3_S2).dumbbell, (1e5, 1e5, 2e5), (0.0, 0.0, 0.5), 2.2e5, 0.0
    )
    pair = pair._replace(strung=strung(pair.dumbbell, 2, 60.0, GM_M3_S2))
    start = turning_start(1.0, 0.5 * np.pi, 0.0, 0.0, pair.dumbbell.orbital_rate_rad_s, 0.0)
    for kind in ({}, what):
        run = simulate(scenario_of("nodes", pair, start, duration_s=seconds, output_step_s=seconds, **kind))
        flown.append((run["line_position_i_tether"].values[:, 1:-1], run["line_velocity_i_tether"].values[0, 1:-1]))
    shift = (flown[1][0] - flown[0][0])[-1]
    j2 = J2 if "oblate" in what else 0.0
    air = AIR | {"drag_area_m2": 20.0} if "air" in what else None
    parameters = np.array(list(load_parameters(0.0, j2=j2, anomaly=what.get("anomaly"), air=air).values()))
    for k in range(2):
        state = np.concatenate([flown[0][0][0, k], flown[0][1][k], [0.0, 20.0, 0.0, 0.0, 0.0, 0.0, 0.0]])
        force = surroundings_of_a_node(0.0, state, parameters)[:3]
        shift_size = 0.5 * seconds**2 * np.abs(force).max() / 20.0  # it moves by 8 km meanwhile, 200 above the anomaly
        assert shift_size > 1e-4
        assert shift[k] == pytest.approx(0.5 * seconds**2 * force / 20.0, rel=0.02, abs=0.02 * shift_size)


def test_a_pull_that_is_even_turns_nothing():
    """Half a segment at the attachment is pulled with its body: without that the tilt would be off by some 2e-4 rad in 30 s."""
    shape = {"duration_s": 30.0, "damping": 0.0, "nodes": 1, "line_mass_kg": 60.0}
    plain, flat = (spin(oblate=one, **shape) for one in (False, True))
    assert np.abs(flat["theta"].values - plain["theta"].values).max() < 4e-5  # the line's pull grows by 0.02 N
