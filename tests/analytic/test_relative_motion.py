"""Relative motion in closed form against matrix exponentials, Kepler's orbits and the rigid body's own equation."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from fieldline.errors import InputError
from fieldline.mechanics.lorentz import turned
from fieldline.mechanics.relative_motion import (
    attitude_poles,
    equilibrium,
    free_motion,
    free_translation,
    holding_force,
    holding_moment,
    input_matrix,
    linearisation_error,
    motion_matrix,
    output_matrix,
)

N, R0 = 1.1316188e-3, 6.778e6
GM = N * N * R0**3
STATE = np.array([10.0, 0.1, -5.0, 0.02, 3.0, 0.01, 0.01, 1e-5, -0.02, 2e-5, 0.03, -1e-5])


@pytest.mark.parametrize(
    "inertia",
    [
        (50.0, 70.0, 100.0),
        (1.53742e8, 1.02363e7, 1.58720e8),
        (3.55208e6, 1.88729e8, 1.87022e8),
        (3.0, 3.0, 4.0),  # pitch without a spring
        (60.0, 90.0, 90.0),  # pitch at n itself: B - A = C / 3
    ],
)
def test_closed_form_is_the_exponential(inertia):
    seconds = np.array([0.0, 100.0, 3000.0, 9000.0])
    F = motion_matrix(N, R0, inertia)
    found = free_motion(N, R0, inertia, seconds, STATE)
    expected = np.array([expm(F * t) @ STATE for t in seconds])
    assert np.abs(found - expected).max(axis=0) == pytest.approx(np.zeros(12), abs=1e-9 * np.abs(expected).max())
    assert np.abs((found - expected) / np.abs(expected).max(axis=0)).max() < 1e-11
    assert free_motion(N, R0, inertia, 3000.0, STATE) == pytest.approx(found[2], rel=1e-13)


def test_translation_is_the_exponential():
    F = motion_matrix(N, R0, (50.0, 70.0, 100.0))[:6, :6]
    for t in (1.0, 700.0, 20_000.0):
        assert free_translation(N, t, STATE[:6]) == pytest.approx(expm(F * t) @ STATE[:6], rel=1e-11, abs=1e-11)


def test_poles_are_eigenvalues():
    rng = np.random.default_rng(1)
    for _ in range(200):
        a, b = rng.uniform(1.0, 2.0, 2)
        inertia = (a, b, rng.uniform(abs(a - b), a + b))
        found = attitude_poles(N, inertia)
        own = np.linalg.eigvals(motion_matrix(N, R0, inertia)[6:, 6:] / N)
        for pole in np.concatenate([found.pitch, found.roll_yaw]) / N:
            assert np.abs(own - pole).min() < 1e-6


def exact_place(seconds, place_h, rate_h):
    """The place in axes h after `seconds` on a Kepler orbit."""
    start = np.concatenate([np.array([R0, 0.0, 0.0]) + place_h, rate_h + np.cross([0.0, 0.0, N], place_h) + [0.0, N * R0, 0.0]])
    flown = solve_ivp(
        lambda _, s: np.concatenate([s[3:], -GM * s[:3] / np.linalg.norm(s[:3]) ** 3]),
        (0.0, seconds),
        start,
        method="DOP853",
        rtol=1e-13,
        atol=1e-7,
    ).y[:, -1]
    c, s = np.cos(N * seconds), np.sin(N * seconds)
    return np.array([c * flown[0] + s * flown[1] - R0, c * flown[1] - s * flown[0], flown[2]])


def test_kepler_orbits_are_approached_with_the_square_of_the_distance():
    place, rate = np.array([0.1, -0.2, 0.15]), N * np.array([0.1, -0.15, 0.1])
    missed = []
    for size in (1e3, 1e4):
        state = np.empty(6)
        state[::2], state[1::2] = size * place, size * rate
        exact = exact_place(5000.0, size * place, size * rate)
        missed.append(np.linalg.norm(free_translation(N, 5000.0, state)[::2] - exact))
    assert missed[1] / missed[0] == pytest.approx(100.0, rel=0.02)
    assert missed[0] < 1e-3 * 1e3 * np.linalg.norm(place)


@pytest.mark.parametrize("place", [(100.0, 0.0, 0.0), (0.0, 5e4, 0.0), (-3e4, 2e4, 1e4), (0.0, 0.0, 1e5)])
def test_linearisation_error_is_the_acceleration_missed(place):
    at = np.array([R0, 0.0, 0.0]) + place
    gravity = -GM * at / np.linalg.norm(at) ** 3
    turn = N * N * at * [1.0, 1.0, 0.0]
    exact = gravity + turn
    linear = N * N * np.array([3.0, 0.0, -1.0]) * place
    expected = np.linalg.norm(exact - linear) / (3.0 * N * N * np.linalg.norm(place))
    assert float(linearisation_error(R0, place)) == pytest.approx(expected, rel=1e-5, abs=1e-11)
    assert float(linearisation_error(R0, place)) <= 1.51 * np.linalg.norm(place) / R0
    assert float(linearisation_error(R0, (0.0, 0.0, 0.0))) == 0.0


def nonlinear_angle_rates(inertia, place_h, angles, rates):
    """Second derivatives of the Cardan angles by Euler's equation under the gravity gradient, without any linearisation."""
    moments = np.array(inertia)

    def omega(angles, rates):
        (p2, p3), (_, c2, c3) = angles[1:], np.cos(angles)
        s2, s3 = np.sin(p2), np.sin(p3)
        own = np.array(
            [rates[0] * c2 * c3 + rates[1] * s3, rates[1] * c3 - rates[0] * c2 * s3, rates[0] * s2 + rates[2]]
        )  # of the angles about x, new y, new z
        return own + turned(angles) @ [0.0, 0.0, N]

    up_b = turned(angles) @ (np.array([R0, 0.0, 0.0]) + place_h)
    distance = np.linalg.norm(up_b)
    w = omega(angles, rates)
    gradient = 3.0 * GM / distance**5 * np.cross(up_b, moments * up_b)
    acceleration = (gradient - np.cross(w, moments * w)) / moments
    # d omega / d rates and the rest by differences, then solved for the second derivatives.
    step = 1e-6
    by_rate = np.column_stack(
        [(omega(angles, rates + step * e) - omega(angles, rates - step * e)) / (2 * step) for e in np.eye(3)]
    )
    along = (omega(angles + step * rates, rates) - omega(angles - step * rates, rates)) / (2 * step)
    return np.linalg.solve(by_rate, acceleration - along)


def test_the_rotation_is_the_jacobian_of_the_rigid_body():
    inertia = (50.0, 70.0, 100.0)
    F = motion_matrix(N, R0, inertia)

    def second(state):
        return nonlinear_angle_rates(inertia, state[0:6:2], state[6::2], state[7::2])

    for k, step in enumerate([10.0, 0.01, 10.0, 0.01, 10.0, 0.01] + [1e-4, 1e-7] * 3):
        e = np.zeros(12)
        e[k] = step
        column = (second(e) - second(-e)) / (2.0 * step)
        size = N * N if k % 2 == 0 else N
        assert column == pytest.approx(F[7::2, k], abs=2e-6 * size / (R0 if k < 6 else 1.0) * (1e2 if k < 6 else 1.0))
    assert np.abs(F[11, 1]) == 0.0  # and no term from x' to pitch


def test_what_holds_a_place():
    inertia, mass = (50.0, 70.0, 100.0), 40.0
    F, place, angles = motion_matrix(N, R0, inertia), np.array([30.0, -40.0, 50.0]), np.array([0.01, -0.02, 0.03])
    state = np.zeros(12)
    state[0:6:2], state[6::2] = place, angles
    force = holding_force(N, mass, place)
    moment = holding_moment(N, R0, inertia, place, angles)
    G = input_matrix(mass, inertia, np.eye(6))
    assert F @ state + G @ np.concatenate([force, moment]) == pytest.approx(np.zeros(12), abs=1e-18)
    ahead = equilibrium(R0, 250.0)
    assert F @ ahead == pytest.approx(np.zeros(12), abs=1e-20)
    assert np.linalg.matrix_rank(F / np.where(np.abs(F).max(axis=1) > 0, np.abs(F).max(axis=1), 1.0)[:, None]) == 11
    assert output_matrix() @ ahead == pytest.approx([0.0, 250.0, 0.0, 0.0, 0.0, 250.0 / R0])


@pytest.mark.parametrize("inertia", [(1.0, 1.0), (1.0, 1.0, 3.0), (1.0, -1.0, 1.0), (1.0, np.nan, 1.0)])
def test_bad_inertia(inertia):
    with pytest.raises(InputError, match="inertia_kg_m2"):
        motion_matrix(N, R0, inertia)
