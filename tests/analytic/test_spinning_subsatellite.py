"""The axis of a spinning subsatellite: its equations against the same in other words, and laws that must hold for all."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from fieldline.analysis.spinning_subsatellite import (
    SpinningSubsatellite,
    axis_motion,
    characteristic_coefficients,
    critical_angle,
    critical_spin,
    first_order_angles,
    four_angle_margin,
    growth_rate,
    jacobi_integral,
    kind_of,
    spin_for_angle,
    stability_map,
    stationary_angles,
)
from fieldline.analysis.spinning_subsatellite.motion import axis_rates
from fieldline.analysis.spinning_subsatellite.stability import frequencies, squared_exponents
from fieldline.errors import InputError

BODIES = st.builds(
    lambda c, a, f, d, n: SpinningSubsatellite(
        axial_inertia_kg_m2=c * a, transverse_inertia_kg_m2=a, tension_n=f, offset_m=d, orbital_rate_rad_s=n
    ),
    st.floats(0.02, 2.0),
    st.floats(1.0, 1e5),
    st.floats(1e-3, 1e3),
    st.floats(1e-3, 3.0),
    st.floats(1e-4, 1e-2),
)
TOP = SpinningSubsatellite(
    axial_inertia_kg_m2=2e5, transverse_inertia_kg_m2=1e5, tension_n=8.342, offset_m=0.5, orbital_rate_rad_s=1.178e-3
)


def balance(body, theta, spin):
    """Left side of (17), over the largest of its terms."""
    c, a, n = body.axial_inertia_kg_m2, body.transverse_inertia_kg_m2, body.orbital_rate_rad_s
    terms = (c - a) * n**2, c * spin * n, body.stiffness_n_m
    sine, cosine = np.sin(theta), np.cos(theta)
    return (terms[0] * sine * cosine + terms[1] * sine - terms[2] * cosine) / max(map(abs, terms))


@given(BODIES, st.floats(-3.0, 3.0), st.floats(-4.0, 1.0))
@settings(max_examples=60, deadline=None)
def test_all_angles_are_found_and_no_others(body, sign, power):
    spin = sign * 10.0**power
    found = stationary_angles(body, spin)
    assert np.abs(balance(body, found, spin)).max() < 1e-11
    if abs(four_angle_margin(body, spin)) > 1e-3:
        grid = np.linspace(0.0, 2.0 * np.pi, 20001)
        crossings = np.count_nonzero(np.diff(np.sign(balance(body, grid, spin))))
        assert len(found) == crossings == (4 if four_angle_margin(body, spin) > 0.0 else 2)


@given(BODIES, st.floats(0.02, 2.0 * np.pi - 0.02).filter(lambda x: abs(np.sin(x)) > 0.01))
@settings(max_examples=60, deadline=None)
def test_the_spin_of_an_angle_has_the_angle(body, theta):
    spin = spin_for_angle(body, theta)
    found = stationary_angles(body, spin)
    assert abs(balance(body, theta, spin)) < 1e-11
    if abs(four_angle_margin(body, spin)) > 1e-3:
        assert np.abs(found - theta).min() < 1e-7


def test_the_four_angles_meet_on_the_astroid():
    # At the cusp theta* where two of the four meet, (17) and its derivative vanish together.
    body = SpinningSubsatellite(
        axial_inertia_kg_m2=2.0, transverse_inertia_kg_m2=1.0, tension_n=0.2, offset_m=1.0, orbital_rate_rad_s=1.0
    )
    edge = (1.0 - 0.2 ** (2.0 / 3.0)) ** 1.5 / 2.0  # |C phi' n| on the astroid
    assert len(stationary_angles(body, 0.999 * edge)) == 4 and len(stationary_angles(body, 1.001 * edge)) == 2
    near = stationary_angles(body, 0.999999 * edge)
    assert np.diff(near).min() < 3e-3


@given(BODIES, st.floats(0.02, 2.0 * np.pi - 0.02).filter(lambda x: abs(np.sin(x)) > 0.05))
@settings(max_examples=60, deadline=None)
def test_exponents_are_those_of_the_equations_of_motion(body, theta):
    """(39) against the Jacobian of the vector equations (1) of `motion`, by differences."""
    n, a, c = body.orbital_rate_rad_s, body.transverse_inertia_kg_m2, body.axial_inertia_kg_m2
    axis = np.array([np.sin(theta), 0.0, np.cos(theta)])
    turn = np.array([0.0, 0.0, n]) + spin_for_angle(body, theta) * axis
    momentum = a * (turn - (turn @ axis) * axis) + c * (turn @ axis) * axis
    size = np.linalg.norm(momentum)

    def rates(y):
        k, m = axis_rates(tuple(y[:3]), tuple(size * y[3:]), a, body.stiffness_n_m, n)
        return np.concatenate([k, np.array(m) / size]) / n

    y0 = np.concatenate([axis, momentum / size])
    assert np.abs(rates(y0)).max() < 1e-12 * max(1.0, body.kappa)
    step = 1e-6  # the rates are quadratic in y: central differences have no error but rounding
    jacobian = np.stack([(rates(y0 + step * e) - rates(y0 - step * e)) / (2.0 * step) for e in np.eye(6)], axis=1)
    mu = squared_exponents(body.kappa, theta)
    found = np.poly(np.concatenate([np.sqrt(mu), -np.sqrt(mu), [0.0, 0.0]]))
    wanted = np.poly(jacobian)  # two of its roots are zero: |k| and C r0
    size = max(1.0, abs(mu).max())
    for power, (one, other) in enumerate(zip(found, wanted, strict=True)):
        assert abs(one - other) < 1e-5 * size ** (power / 2.0)


def test_below_half_a_turn_every_angle_is_stable_and_a_minimum():
    kappa = np.geomspace(0.1, 1e5, 40)[:, None]
    theta = np.radians(np.linspace(1.0, 179.0, 179))
    assert (kind_of(kappa, theta) == "minimum").all()


def test_above_it_stability_ends_at_the_critical_angle():
    for kappa in (1e-3, 1.0, 30.0, 1e3):
        edge = critical_angle(kappa)
        assert kind_of(kappa, edge - 1e-8) == "gyroscopic" and kind_of(kappa, edge + 1e-8) == "flutter"
        mirror = 3.0 * np.pi - edge
        assert kind_of(kappa, mirror + 1e-8) == "gyroscopic" and kind_of(kappa, mirror - 1e-8) == "flutter"


def test_a_strong_pull_makes_the_upper_branch_a_sleeping_top():
    # C r0 > 2 sqrt(A F d) is the condition of a top that stands on its point.
    kappa = 1e6
    edge = critical_angle(kappa)
    assert abs(np.cos(edge) * (1.0 + kappa / np.sin(edge))) == pytest.approx(2.0 * np.sqrt(kappa), rel=2e-5)


def test_conserved_while_the_axis_tumbles():
    theta = np.radians(260.0)
    run = axis_motion(TOP, theta + 0.05, spin_for_angle(TOP, theta), 12000.0)
    assert float(run["away"].max()) > 1.0
    for name in ("axial_momentum", "jacobi"):
        assert np.ptp(run[name].values) < 1e-8 * np.abs(run[name].values).max()


def test_energy_of_the_report_is_not_conserved():
    """(30), with A and d put back, against its rate n F d sin theta cos psi; the Jacobi integral in Euler's angles."""
    run = axis_motion(TOP, 1.0, 0.03, 4000.0, samples=40001)
    seconds, theta, psi = (run[name].values for name in ("seconds", "theta", "psi"))
    psi = np.unwrap(psi)
    theta_rate, psi_rate = np.gradient(theta, seconds), np.gradient(psi, seconds)
    n, a, fd = TOP.orbital_rate_rad_s, TOP.transverse_inertia_kg_m2, TOP.stiffness_n_m
    spin = float(run["axial_momentum"][0])
    energy = 0.5 * a * (theta_rate**2 + (psi_rate + n) ** 2 * np.sin(theta) ** 2) - fd * np.sin(theta) * np.sin(psi)
    power = n * fd * np.sin(theta) * np.cos(psi)
    middle = slice(5, -5)
    assert np.allclose(np.gradient(energy, seconds)[middle], power[middle], atol=2e-4 * np.abs(power).max())
    jacobi = 0.5 * a * (theta_rate**2 + psi_rate**2 * np.sin(theta) ** 2) - 0.5 * a * n**2 * np.sin(theta) ** 2
    jacobi = jacobi - spin * n * np.cos(theta) - fd * np.sin(theta) * np.sin(psi)
    constant = 0.5 * spin**2 / TOP.axial_inertia_kg_m2
    assert np.allclose((jacobi + constant)[middle], run["jacobi"].values[middle], atol=1e-6 * fd)
    assert np.ptp(energy) > 1e3 * np.ptp(run["jacobi"].values)


def test_motion_is_that_of_the_lagrangian_equations():
    """(8) of the study in Euler's angles by another integrator."""
    n, a, fd = TOP.orbital_rate_rad_s, TOP.transverse_inertia_kg_m2, TOP.stiffness_n_m
    theta0, psi0, spin = 1.1, 1.3, 0.05
    momentum = TOP.axial_inertia_kg_m2 * (spin + n * np.cos(theta0))

    def rates(t, y):
        theta, psi, theta_rate, psi_rate = y
        turn, sine, cosine = psi_rate + n, np.sin(theta), np.cos(theta)
        theta_acc = (a * turn**2 * sine * cosine - momentum * turn * sine + fd * cosine * np.sin(psi)) / a
        psi_acc = (fd * np.cos(psi) + momentum * theta_rate - 2.0 * a * theta_rate * turn * cosine) / (a * sine)
        return [theta_rate, psi_rate, theta_acc, psi_acc]

    wanted = solve_ivp(rates, (0.0, 2000.0), [theta0, psi0, 0.0, 0.0], method="DOP853", rtol=1e-12, atol=1e-13)
    run = axis_motion(TOP, theta0, spin, 2000.0, psi_rad=psi0)
    assert float(run["theta"][-1]) == pytest.approx(wanted.y[0, -1], abs=1e-7)
    assert float(run["psi"][-1]) == pytest.approx(wanted.y[1, -1], abs=1e-7)


def test_small_motion_has_the_linear_frequencies():
    theta = np.radians(225.0)
    slow, fast = np.sort(frequencies(TOP, theta))
    span = 6.0 * 2.0 * np.pi / slow
    run = axis_motion(TOP, theta + 1e-6, spin_for_angle(TOP, theta), span, samples=8193)
    signal = (run["direction"].values @ np.array([np.cos(theta), 0.0, -np.sin(theta)]))[:-1]
    lines = np.abs(np.fft.rfft((signal - signal.mean()) * np.hanning(signal.size)))
    omega = 2.0 * np.pi * np.fft.rfftfreq(signal.size, span / 8192)
    for wanted in (slow, fast):
        near = np.flatnonzero(np.abs(omega - wanted) < 3.0 * slow / 6.0)
        assert abs(omega[near[np.argmax(lines[near])]] - wanted) <= slow / 6.0
        assert lines[near].max() > 30.0 * np.median(lines)


def test_unstable_motion_grows_at_the_linear_rate():
    theta = np.radians(260.0)
    rate = growth_rate(TOP, theta)
    run = axis_motion(TOP, theta + 1e-9, spin_for_angle(TOP, theta), 14.0 / rate)
    away = run["away"].values
    seconds = run["seconds"].values
    late = (away > 1e-7) & (away < 1e-4)
    assert np.polyfit(seconds[late], np.log(away[late]), 1)[0] == pytest.approx(rate, rel=0.05)


def test_first_order_angles_are_right_to_second_order():
    for small in (0.05, 0.005):
        body = SpinningSubsatellite(
            axial_inertia_kg_m2=1.5, transverse_inertia_kg_m2=1.0, tension_n=1.0, offset_m=1.0, orbital_rate_rad_s=small**0.5
        )
        spin = 1.0 / small**0.5
        error = np.abs(stationary_angles(body, spin) - first_order_angles(body, spin)).max()
        assert error < 0.3 * small**2


def test_map_agrees_with_its_parts_and_with_the_critical_spin():
    grid = stability_map(TOP, [-0.05, 0.002, 0.05], [0.1, 0.5])
    for i in range(3):
        for j in range(2):
            body = SpinningSubsatellite(**{**vars(TOP), "offset_m": float(grid["offset"][j])})
            found = stationary_angles(body, float(grid["spin"][i]))
            here = grid.isel(spin=i, offset=j)
            assert np.array_equal(here["theta"].values[: len(found)], found)
            assert np.array_equal(here["kind"].values[: len(found)], kind_of(body.kappa, found))
            upper = here["kind"].values[: len(found)][found > np.pi]
            assert (upper == "gyroscopic").all() == (abs(float(grid["spin"][i])) > critical_spin(body))


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: SpinningSubsatellite(**{**vars(TOP), "offset_m": 0.0}), "offset_m must be a positive number"),
        (lambda: SpinningSubsatellite(**{**vars(TOP), "tension_n": float("nan")}), "tension_n"),
        (lambda: stationary_angles(TOP, float("inf")), "finite"),
        (lambda: spin_for_angle(TOP, np.pi), "multiple of 180"),
        (lambda: characteristic_coefficients(30.0, 0.0), "multiple of 180"),
        (lambda: critical_angle(-1.0), "kappa"),
        (lambda: axis_motion(TOP, 1.0, 0.1, -5.0), "duration_s"),
        (lambda: axis_motion(TOP, 1.0, 0.1, 1e12), "shorter"),
        (lambda: stability_map(TOP, np.zeros((2, 2)), [1.0]), "lists"),
    ],
)
def test_refusals(call, words):
    with pytest.raises(InputError, match=words):
        call()


@pytest.mark.kernels
def test_jacobi_of_given_vectors():
    run = axis_motion(TOP, 1.2, 0.03, 50.0, samples=3)
    assert jacobi_integral(TOP, run["direction"].values, run["momentum"].values) == pytest.approx(run["jacobi"].values)
