"""Laws of a body that hangs on a line, in the plant: the pendulum's frequency, and its damping by four means."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import plant_flights as pf

pytestmark = [pytest.mark.kernels, pytest.mark.flight]
MASS, ARM, LENGTH = 100.0, 0.6, 2000.0
AXES = np.eye(3).tolist()
JETS = [
    {"position_b_m": place, "direction_b": push, "force_n": 0.2}
    for place, push in [
        ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        ((1.0, 0.0, 0.0), (0.0, 0.0, -1.0)),
        ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
        ((0.0, 1.0, 0.0), (0.0, 0.0, -1.0)),
    ]
]


def swinging(law=None, blind=False, seconds=240.0, **parameters):
    """(seconds, tilt from the line about the body's x and y axes [rad]) of a body that hangs tilted by 4 degrees."""
    satellite = pf.body(
        "satellite",
        mass_kg=MASS,
        inertia_kg_m2=(12.0, 12.0, 8.0),
        offset_o_m=(0.0, 0.0, LENGTH * 1.00004 + ARM),
        attitude={"euler_321_deg": (0.0, 2.8, -2.8), "axes": "orbital"},
        rate_deg_s=(0.0, 0.0, 0.0),
        rate_axes="orbital",
        wheel=[{"axis_b": axis, "momentum_max_n_m_s": 5.0, "torque_max_n_m": 0.5} for axis in AXES],
        magnetorquer=[{"axis_b": axis, "moment_max_a_m2": 2000.0} for axis in AXES],
        thruster=JETS,
        magnetometer={"rate_hz": 4.0},
        gyro={"rate_hz": 4.0},
        star_tracker=None if blind else {"rate_hz": 4.0, "rate_max_deg_s": 10.0, "boresight_b": (0.0, -1.0, -1.0)},
    )
    slider = [{"end": "to", "axis_b": axis, "travel_m": 0.3, "speed_m_s": 0.2} for axis in AXES[:2]]
    line = {"name": "line", "from_body": "ship", "to_body": "satellite", "to_point_b_m": (0.0, 0.0, -ARM), "slider": slider}
    line |= {"rest_length_m": LENGTH, "stiffness_n": 2e4, "damping_n_s": 2e4}
    task = [{"body": "satellite", "law": law, "rate_hz": 4.0, "parameters": parameters}] if law else []
    ship = pf.body("ship", kind="point", mass_kg=20000.0)
    scenario = pf.scenario(
        ship,
        satellite,
        line=[line],
        software=task,
        seconds=seconds,
        output=0.5,
        integrator={"method": "rk4", "step_s": 0.25},
    )
    flight = pf.Flight(scenario)
    flight.fly()
    assert flight.complete
    seconds, states = pf.rows(flight)
    q, chord = states[:, 1, 6:10], states[:, 0, :3] - states[:, 1, :3]
    up = Rotation.from_quat(q).inv().apply(chord / np.linalg.norm(chord, axis=1, keepdims=True))
    return seconds, np.column_stack([up[:, 1], -up[:, 0]])


def test_it_swings_at_the_pendulums_frequency():
    """w_p = sqrt(T d / I), with the mass of the body that swings about its own centre beside the line's end."""
    seconds, tilt = swinging()
    tension = 3.0 * pf.MEAN_MOTION**2 * MASS * LENGTH
    crossing = seconds[:-1][np.diff(np.sign(tilt[:, 0])) != 0]
    assert np.pi / np.diff(crossing).mean() == pytest.approx(np.sqrt(tension * ARM / 12.0), rel=0.02)
    assert np.abs(tilt[-80:]).max() > np.radians(2.0)


@pytest.mark.parametrize(
    ("law", "left_deg"),
    [("tether-wheels", 0.02), ("tether-thrusters", 0.02), ("tether-attachment", 0.02), ("tether-torquers", 0.5)],
)
def test_a_law_damps_it(law, left_deg):
    """A damping ratio of 0.3 leaves a hundredth after four periods of 31 s; the field gives torques about two axes alone."""
    _, tilt = swinging(law, damping_ratio=0.3, tension_min_n=0.05)
    assert np.abs(tilt[:20]).max() > np.radians(2.0)
    assert np.abs(tilt[250:]).max() < np.radians(left_deg), np.degrees(np.abs(tilt[250:]).max())


def test_without_an_attitude_it_leans():
    """The rate is then that against inertial axes, and the orbit's turn is taken for a swing: a lean of 2 z n / w_p."""
    _, tilt = swinging("tether-wheels", blind=True, damping_ratio=0.3, turn_frequency_rad_s=0.0)
    frequency = np.sqrt(3.0 * pf.MEAN_MOTION**2 * MASS * LENGTH * ARM / 12.0)
    assert np.linalg.norm(tilt[-40:].mean(axis=0)) == pytest.approx(
        2.0 * 0.3 * pf.MEAN_MOTION / frequency, rel=0.12
    )  # and wheels that fill
