"""First motions without a prior: periodogram, window fits, starts, against known motions."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.estimation.batch import Motion, fit_window
from fieldline.estimation.inertia import inertia_of, shape_of
from fieldline.estimation.periodogram import coherence, half_sphere, nyquist_rate, rate_peaks
from fieldline.estimation.series import make_series
from fieldline.estimation.starts import find_starts, window
from fieldline.frames.attitude import rotation_error_b
from fieldline.mechanics.rigid_body import free_motion

SIZE = 3e-5


def rotating(rate_deg_s, seconds, direction=(0.5, -0.3, 0.8), noise=0.0, seed=0):
    """Field vectors in a body that turns at a constant rate under a field at rest."""
    attitude = Rotation.from_rotvec(np.outer(seconds, np.radians(rate_deg_s)))
    b = SIZE * np.array(direction) / np.linalg.norm(direction)
    return attitude.inv().apply(b) + noise * np.random.default_rng(seed).standard_normal((len(seconds), 3))


def orbiting_field(seconds):
    """A reference field that turns as in a low polar orbit: once around while its size doubles twice."""
    u = 2.0 * np.pi * seconds / 5600.0
    return SIZE * np.stack([1.2 * np.sin(u), 0.25 + 0.1 * np.sin(2 * u), -0.6 - 0.7 * np.cos(u)], axis=1)


def tumbler(n, step, omega_deg_s, inertia, noise, seed=0):
    """A free rigid body in that field, far from the Earth's centre so that gravity turns it by nothing."""
    seconds = step * np.arange(n)
    q0 = Rotation.random(random_state=seed).as_quat()
    q, omega = free_motion(seconds, q0, np.radians(omega_deg_s), inertia)
    field_i = orbiting_field(seconds)
    field_b = Rotation.from_quat(q).inv().apply(field_i)
    field_b += noise * np.random.default_rng(seed).standard_normal(field_b.shape)
    far = np.full((n, 3), 1e9)
    return make_series(seconds, field_b, field_i, far, np.ones(n, bool)), q, omega


@pytest.mark.kernels
def test_coherence_is_one_at_the_true_rate_only():
    seconds = np.arange(12.0)
    field_b = rotating((3.0, -40.0, 9.0), seconds)
    assert np.isclose(coherence(seconds, field_b, tuple(np.radians((3.0, -40.0, 9.0)))), 1.0, atol=1e-12)
    assert coherence(seconds, field_b, tuple(np.radians((3.0, 40.0, 9.0)))) < 0.9


@pytest.mark.parametrize("rate", [(-6.0, -45.7, -0.8), (0.0, 0.0, 100.0), (20.0, -15.0, 8.0), (0.5, 1.0, -0.7)])
def test_the_highest_peak_is_the_rate_with_its_sense(rate):
    """Sampled once a second: 46 deg between samples and more, where differences of samples say nothing."""
    seconds = np.arange(12.0)
    best, value = rate_peaks(seconds, rotating(rate, seconds, noise=1e-7))[0]
    assert value > 0.99
    # the noise of 1e-7 on 3e-5 over a 12 s arc leaves about 0.1 deg/s; slow rates along the field are not seen
    across = np.cross(best - np.radians(rate), rotating(rate, seconds)[6] / SIZE)
    assert np.degrees(np.linalg.norm(across)) < 0.4


def test_rates_beyond_half_a_turn_a_sample_are_aliases():
    seconds = np.arange(12.0)
    assert np.isclose(np.degrees(nyquist_rate(seconds)), 180.0)
    best, _ = rate_peaks(seconds, rotating((0.0, 0.0, 200.0), seconds))[0]
    assert np.allclose(np.degrees(best), (0.0, 0.0, -160.0), atol=0.5)


def test_half_sphere_leaves_no_hole():
    axes = half_sphere(0.3)
    rng = np.random.default_rng(1)
    probes = rng.standard_normal((500, 3))
    probes /= np.linalg.norm(probes, axis=1, keepdims=True)
    assert np.arccos(np.abs(probes @ axes.T).max(axis=1)).max() < 0.35


def test_window_fit_finds_rate_shape_and_attitude():
    inertia = np.diag([1.0, 1.25, 1.4])
    series, q, omega = tumbler(300, 3.0, (2.0, -1.5, 1.0), inertia, 5e-8)
    at = 150
    start = Motion(
        q_bi=(Rotation.from_quat(q[at]) * Rotation.from_rotvec([0.1, -0.1, 0.1])).as_quat(),
        omega_b=omega[at] + 2e-5,
        anchor=at,
        shape=shape_of(np.diag([1.0, 1.2, 1.35])),
    )
    found = fit_window(series, start, 5e-8, iterations=60)
    assert abs(found.chi2 - 1.0) < 0.15
    assert np.degrees(np.linalg.norm(rotation_error_b(q[at], found.q_bi))) < 0.1
    assert np.allclose(inertia_of(found.shape), 3 * inertia / np.trace(inertia), atol=2e-3)
    error = rotation_error_b(q[at], found.q_bi)
    assert error @ np.linalg.solve(found.covariance[:3, :3], error) < 16.3  # 99.9 % of chi-square, 3 degrees


def test_a_spike_does_not_steer_the_fit():
    series, q, omega = tumbler(200, 2.0, (0.3, -0.2, 0.4), np.eye(3), 1e-7)
    start = Motion(q_bi=q[100], omega_b=omega[100], anchor=100)
    clean = fit_window(series, start, 1e-7)
    series.field_b[60] = (3e-4, -3e-4, 3e-4)
    spoiled = fit_window(series, start, 1e-7)
    shift = rotation_error_b(clean.q_bi, spoiled.q_bi)
    assert shift @ np.linalg.solve(clean.covariance[:3, :3], shift) < 1.0


def test_window_stays_inside_the_arc_and_keeps_its_centre():
    series, *_ = tumbler(500, 1.0, (0.1, 0.1, 0.1), np.eye(3), 0.0)
    for centre in (0, 3, 250, 499):
        for rows in (9, 100, 500):
            part, anchor = window(series, centre, rows, 0.002)
            assert np.isclose(part.seconds[anchor], series.seconds[centre])
            assert len(part.seconds) <= 320


@pytest.mark.parametrize("seed", range(6))
def test_starts_hold_the_truth_without_a_prior(seed):
    """Random attitudes, rates of up to 5 deg/s, sampled at 4 s: the truth is among the candidates within 10 deg."""
    rng = np.random.default_rng(seed)
    omega = rng.standard_normal(3)
    omega *= 5.0 * rng.uniform(0.2, 1.0) / np.linalg.norm(omega)
    series, q, _ = tumbler(600, 4.0, omega, np.diag([1.0, 1.3, 1.5]), 1e-7, seed)
    errors = [
        np.degrees(np.linalg.norm(rotation_error_b(q[start.row], start.motion.q_bi)))
        for start in find_starts(series, 1e-7, rigid=True)
    ]
    assert min(errors) < 10.0
