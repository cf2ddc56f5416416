"""A libration of 10 degrees with a rigid body on the line, against a flight by an independent program."""

import numpy as np
from scipy.spatial.transform import Rotation

import plant_flights as pf
import tether_flights as tf
from fieldline.analysis.tether import hanging_line
from fieldline.dynamics.layout import starts_in_state
from fieldline.simulate.flight import Flight

TOP_M = 6598e3
NODES = 9
LEVER_M = 0.5
# time [s], angle in the plane [rad], distance from ship to the probe's mass centre [m], tension below and above [N]
TOLD = np.array(
    [
        (0.0, -0.17453293, 20003.38182, 42.17907, 48.36524),
        (300.0, -0.14326000, 20003.07711, 37.71208, 43.24596),
        (600.0, -0.06038800, 20002.91392, 35.32394, 40.50403),
        (900.0, 0.04442420, 20002.87243, 34.72036, 39.80955),
        (1200.0, 0.13308212, 20002.95811, 35.97845, 41.25250),
        (1500.0, 0.17373793, 20003.21595, 39.75492, 45.58385),
        (1800.0, 0.15212103, 20003.61216, 45.55370, 52.23604),
        (2100.0, 0.07579166, 20003.96513, 50.71858, 58.15876),
        (2400.0, -0.02803341, 20004.04954, 51.95109, 59.57330),
    ]
)


def flight():
    """20 km from a point to a rigid ball of 1000 kg m^2 whose attachment is 0.5 m from its centre, all turning as a rod."""
    altitude = (TOP_M - tf.EARTH_EQUATORIAL_RADIUS_M) / 1e3
    orbit = {"elements": {"altitude_km": altitude, "inclination_deg": 28.5}}
    ship = pf.body("ship", kind="point", mass_kg=tf.SHIP_KG)
    ball = np.diag([1000.0, 1000.0, 1000.0]).tolist()
    probe = pf.body("probe", mass_kg=tf.PROBE_KG, inertia_kg_m2=ball, offset_o_m=(0.0, 0.0, 2e4), gravity_gradient=False)
    line = tf.line(NODES, damping_n_s=0.05 * tf.STIFFNESS_N, to_point_b_m=(0.0, 0.0, LEVER_M))
    made = Flight(pf.scenario(ship, probe, seconds=2400.0, output=300.0, orbit=orbit, integrator={"step_s": 0.05}, line=[line]))
    rest = hanging_line(tf.LENGTH_M, tf.KG_PER_M, tf.STIFFNESS_N, tf.PROBE_KG, tf.SHIP_KG, TOP_M, NODES)
    y = made.y
    up = y[:3] / np.linalg.norm(y[:3])
    normal = np.cross(up, y[3:6]) / np.linalg.norm(np.cross(up, y[3:6]))
    along = np.cos(np.radians(10.0)) * up + np.sin(np.radians(10.0)) * np.cross(normal, up)
    place = TOP_M * up + (rest.radius[::-1] - TOP_M)[:, None] * along
    centre = place[-1] - LEVER_M * along
    speed = rest.rate * np.cross(normal, np.vstack([place, centre]))
    first, _, _ = starts_in_state(made.plant)
    y[:6] = np.append(place[0], speed[0])
    y[first : first + 6 * NODES] = np.hstack([place[1:-1], speed[1:-2]]).ravel()
    turn = Rotation.from_matrix(np.stack([np.cross(normal, along), normal, along], axis=1))
    y[13:19] = np.append(centre, speed[-1])
    y[19:23], y[23:26] = turn.as_quat(), turn.inv().apply(rest.rate * normal)
    made.start[:] = y
    return made


def test_the_same_libration():
    """The Earth's constant differs by 2e-6, so the phase by 5e-6 rad at the end."""
    made = flight()
    made.fly()
    one = tf.points(made)
    shape = tf.shape(one)  # from ship to mass centre: the lever is in the chord, as it is in what is told
    found = np.stack([one.seconds, shape.in_plane_rad, shape.chord_m, one.tension[:, -1], one.tension[:, 0]], axis=1)
    assert (
        np.abs(found[:, 1] - TOLD[:, 1]).max() < 5e-6
    )  # theirs is from the vertical at the ship, and this from that at the mass centre
    assert np.abs(found[:, 2] - TOLD[:, 2]).max() < 1e-4
    assert np.abs(found[:, 3:] / TOLD[:, 3:] - 1.0).max() < 4e-5
