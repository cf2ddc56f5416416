"""A line with a constant current in an inclined orbit: the plant swings as the rigid line's equations say, and that grows."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import plant_flights as pf
from fieldline.analysis.electrodynamic import balanced_mass, libration_rates, torque_ratio

LENGTH, INCLINATION_DEG, MOMENT = 1000.0, 45.0, 7.8e22


def flown(mass_kg, current_a, orbits, lower_kg=1e5):
    """(angles of the latitude [rad], (n, 2) angles theta and phi of the line [rad]) of a run on a line that starts vertical."""
    period = 2.0 * np.pi / pf.MEAN_MOTION
    strain = 3.0 * pf.MEAN_MOTION**2 * LENGTH * mass_kg / 1000.0
    flight = pf.flown(
        pf.body("low", kind="point", mass_kg=lower_kg),
        pf.body("high", kind="point", mass_kg=mass_kg, offset_o_m=(0.0, 0.0, -LENGTH * (1.0 + strain))),
        line=[
            {
                "name": "wire", "from_body": "low", "to_body": "high", "rest_length_m": LENGTH, "stiffness_n": 1000.0,
                "damping_n_s": 300.0, "circuit": {"mode": "profile", "current_a": current_a},
            }
        ],
        environment={"gravity": "point", "field": "centred-dipole", "field_moment_e_a_m2": [(0.0, 0.0, -MOMENT)]},
        orbit={"elements": {"altitude_km": 500.0, "inclination_deg": INCLINATION_DEG}},
        integrator={"step_s": 1.0, "line_update_s": 10.0},
        seconds=orbits * period, output=period / 40.0,
    )  # fmt: skip
    seconds, states = pf.rows(flight)
    position, velocity = states[:, 0, :3], states[:, 0, 3:6]
    chord = states[:, 1, :3] - position
    up = position / np.linalg.norm(position, axis=1, keepdims=True)
    normal = np.cross(position, velocity)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.cross(normal, up)
    theta = np.arctan2(np.sum(chord * along, axis=1), np.sum(chord * up, axis=1))
    phi = np.arcsin(np.sum(chord * normal, axis=1) / np.linalg.norm(chord, axis=1))
    return pf.MEAN_MOTION * seconds, np.stack([theta, phi], axis=1)


def test_the_plant_swings_as_the_rigid_line_does():
    epsilon = torque_ratio(1.0, LENGTH, 1e5, 12.0, dipole_t_m3=1e-7 * MOMENT)
    assert epsilon == pytest.approx(0.815, abs=1e-3)
    nu, angles = flown(12.0, 1.0, 4.0)
    rigid = solve_ivp(
        libration_rates, (0.0, nu[-1]), np.zeros(4), args=(epsilon, np.radians(INCLINATION_DEG)), t_eval=nu, rtol=1e-9, atol=1e-9
    ).y[[0, 2]].T  # fmt: skip
    assert np.abs(rigid[:, 0]).max() > 0.3 and np.abs(rigid[:, 1]).max() > 0.3
    assert np.abs(angles - rigid).max() < 0.02


def test_a_balanced_line_is_left_alone():
    mass = balanced_mass(0.5, 20.0)
    assert mass == pytest.approx(20.0)
    _, angles = flown(mass, 1.0, 1.0, lower_kg=20.0)
    _, unbalanced = flown(12.0, 1.0, 1.0, lower_kg=20.0)
    assert np.abs(angles).max() < 0.02 < 0.1 < np.abs(unbalanced).max()
