"""Floquet and Riccati against SciPy, python-control and closed forms."""

import time

import control
import numpy as np
import pytest
import scipy.linalg

from fieldline.analysis import characteristic_exponents, floquet_multipliers, monodromy, periodic_regulator
from fieldline.control.periodic_system import disturbance_costate, exponentials, held_problem, transitions
from fieldline.errors import InputError, NoEstimateError

PERIOD = 2.0 * np.pi
RNG = np.random.default_rng(42)
CONSTANT = (RNG.standard_normal((4, 4)), RNG.standard_normal((4, 2)), np.diag([1.0, 2.0, 0.5, 0.1]), np.diag([1.0, 3.0]))


def periodic_plant(count, order=3):
    """A smooth unstable periodic plant with an input that never reaches everything at once."""
    t = np.arange(count) / count * PERIOD
    rng = np.random.default_rng(5)
    base, swing = rng.standard_normal((2, order, order)) * 0.4
    a = base + swing * np.cos(t)[:, None, None]
    b = np.zeros((count, order, 1))
    b[:, 0, 0], b[:, 1, 0], b[:, 2, 0] = np.cos(t), np.sin(t), 0.5 + np.cos(2 * t)
    return a, b, np.eye(order), np.eye(1)


def test_exponentials_equal_scipy():
    matrices = np.random.default_rng(1).standard_normal((5, 6, 6)) * np.array([1e-6, 0.1, 1.0, 5.0, 20.0])[:, None, None]
    for ours, matrix in zip(exponentials(matrices), matrices, strict=True):
        theirs = scipy.linalg.expm(matrix)
        assert np.abs(ours - theirs).max() < 1e-12 * np.abs(theirs).max() * max(1.0, np.abs(matrix).max())


def test_mathieu_multipliers_against_an_integrator():
    def a(t):
        return np.array([[0.0, 1.0], [-(0.7 + 0.6 * np.cos(t)), -0.05]])

    exact = (
        scipy.integrate.solve_ivp(
            lambda t, x: (a(t) @ x.reshape(2, 2)).ravel(), (0.0, PERIOD), np.eye(2).ravel(), rtol=1e-12, atol=1e-13
        )
        .y[:, -1]
        .reshape(2, 2)
    )
    errors = [np.abs(monodromy(np.array([a(t) for t in np.arange(n) / n * PERIOD]), PERIOD) - exact).max() for n in (64, 128)]
    assert errors[1] < 1e-6
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.4)  # order of the Magnus step


def test_multipliers_of_constant_coefficients():
    a = np.array([[0.0, 1.0], [-4.0, -0.4]])
    multipliers = floquet_multipliers(a, 0.3)
    poles = characteristic_exponents(multipliers, 0.3)
    assert sorted(poles, key=lambda s: s.imag) == pytest.approx(sorted(np.linalg.eigvals(a), key=lambda s: s.imag))
    assert np.prod(multipliers) == pytest.approx(np.exp(np.trace(a) * 0.3))  # Liouville


def test_constant_continuous_limit_is_the_algebraic_riccati_equation():
    a, b, q, r = CONSTANT
    result = periodic_regulator(a, b, q, r, 0.2, control="continuous")
    P = scipy.linalg.solve_continuous_are(a, b, q, r)
    assert np.allclose(result.riccati[0], P, rtol=1e-10, atol=1e-10 * np.abs(P).max())
    K, _, poles = control.lqr(a, b, q, r)
    assert np.allclose(result.gain[0], K, rtol=1e-9, atol=1e-9)
    assert np.allclose(np.sort(result.pole.values.real), np.sort(poles.real), rtol=1e-8)


def test_constant_held_limit_is_the_discrete_riccati_equation():
    a, b, q, r = CONSTANT
    step = 0.2
    held = held_problem(*(m[None] for m in CONSTANT), step)
    P = scipy.linalg.solve_discrete_are(held.phi[0], held.gamma[0], held.q[0], held.r[0], s=held.s[0])
    for count in (1, 7):
        result = periodic_regulator(np.broadcast_to(a, (count, 4, 4)), b, q, r, step * count)
        assert np.allclose(result.riccati[-1], P, rtol=1e-10, atol=1e-10 * np.abs(P).max())
    exact = control.c2d(control.ss(a, b, np.eye(4), 0.0), step)
    assert np.allclose(held.phi[0], exact.A) and np.allclose(held.gamma[0], exact.B)


def test_integrals_of_the_held_cost_equal_quadrature():
    a, b, q, r = CONSTANT
    held = held_problem(*(m[None] for m in CONSTANT), 0.5)
    f = np.block([[a, b], [np.zeros((2, 6))]])
    weight = scipy.linalg.block_diag(q, r)
    x, w = np.polynomial.legendre.leggauss(20)
    total = sum(
        0.25 * wk * scipy.linalg.expm(f * s).T @ weight @ scipy.linalg.expm(f * s)
        for wk, s in zip(w, 0.25 * (x + 1), strict=True)
    )
    assert np.allclose(np.block([[held.q[0], held.s[0]], [held.s[0].T, held.r[0]]]), total, rtol=1e-12)


def test_periodic_held_solution_equals_the_lifted_constant_one():
    a, b, q, r = periodic_plant(12)
    held = held_problem(a, b, *(np.broadcast_to(m, (12, *m.shape)) for m in (q, r)), PERIOD)
    n, m, count = 3, 1, 12
    phi, reach = np.eye(n), np.zeros((n, 0))  # the state at step k from the period's start and all inputs before
    Q, S, R = np.zeros((n, n)), np.zeros((n, m * count)), np.zeros((m * count, m * count))
    for k in range(count):
        reach_now = np.hstack([reach, np.zeros((n, m * (count - k)))])
        pick = np.zeros((m, m * count))
        pick[:, m * k : m * k + m] = np.eye(m)
        Q += phi.T @ held.q[k] @ phi
        S += phi.T @ held.q[k] @ reach_now + phi.T @ held.s[k] @ pick
        R += reach_now.T @ held.q[k] @ reach_now + pick.T @ held.r[k] @ pick
        R += reach_now.T @ held.s[k] @ pick + pick.T @ held.s[k].T @ reach_now
        reach = np.hstack([held.phi[k] @ reach, held.gamma[k]])
        phi = held.phi[k] @ phi
    P = scipy.linalg.solve_discrete_are(phi, reach, Q, R, s=S)
    result = periodic_regulator(a, b, q, r, PERIOD)
    assert np.allclose(result.riccati[0], P, rtol=1e-8, atol=1e-8 * np.abs(P).max())
    closed = np.eye(n)
    for k in range(count):
        closed = (held.phi[k] - held.gamma[k] @ result.gain[k].values) @ closed
    assert np.allclose(np.sort(np.abs(np.linalg.eigvals(closed))), np.sort(np.abs(result.multiplier.values)), rtol=1e-6)


def test_continuous_periodic_solution_obeys_its_differential_equation():
    a, b, q, r = periodic_plant(400)
    result = periodic_regulator(a, b, q, r, PERIOD, control="continuous")
    P = result.riccati.values
    rate = (8.0 * (np.roll(P, -1, 0) - np.roll(P, 1, 0)) - np.roll(P, -2, 0) + np.roll(P, 2, 0)) / (12.0 * PERIOD / 400)
    right = -(np.swapaxes(a, 1, 2) @ P + P @ a - P @ b @ np.swapaxes(b, 1, 2) @ P + q)
    assert np.abs(rate - right).max() < 1e-5 * np.abs(right).max()
    assert result.attrs["residual"] < 1e-12
    closed = floquet_multipliers(a - b @ result.gain.values, PERIOD)
    assert np.abs(closed[0]) == pytest.approx(np.abs(result.multiplier.values[0]), rel=1e-6)
    assert np.abs(closed[0]) < 1.0 < np.abs(floquet_multipliers(a, PERIOD)[0])


def test_riccati_is_the_cost_to_come():
    a, b, q, r = periodic_plant(24)
    result = periodic_regulator(a, b, q, r, PERIOD)
    held = held_problem(a, b, *(np.broadcast_to(m, (24, *m.shape)) for m in (q, r)), PERIOD)
    x, cost = np.array([1.0, -2.0, 0.5]), 0.0
    expected = x @ result.riccati[0].values @ x
    for k in range(24 * 40):
        k %= 24
        u = -result.gain[k].values @ x
        cost += x @ held.q[k] @ x + 2.0 * x @ held.s[k] @ u + u @ held.r[k] @ u
        x = held.phi[k] @ x + held.gamma[k] @ u
    assert cost == pytest.approx(expected, rel=1e-9)


def test_costate_of_a_constant_disturbance():
    # Constant coefficients: dx/dt = a x + b u + d rests where the costate p = P x + s makes u = -r^-1 b' p balance it.
    a, b, q, r = CONSTANT
    result = periodic_regulator(a, b, q, r, 1e-3, control="continuous")
    P, K = result.riccati[0].values, result.gain[0].values
    d = np.array([[0.3], [-0.2], [0.5], [0.1]])
    closed = a - b @ K
    exact = -np.linalg.solve(closed.T, P @ d)
    ours = disturbance_costate(P[None], transitions(closed[None], 1e-3), 1e-3 * d[None])
    assert np.allclose(ours[0], exact, rtol=2e-3)


def test_twelve_states_over_a_day_in_seconds():
    count, n, m = 1436, 12, 9
    t = np.arange(count) / count * PERIOD
    rng = np.random.default_rng(0)
    a, b = np.zeros((count, n, n)), np.zeros((count, n, m))
    a[:, :6, 6:] = np.eye(6)
    a[:, 6:, :6] = -1e-6 * rng.standard_normal((6, 6))
    b[:, 6:] = 1e-4 * (rng.standard_normal((6, m)) + np.cos(15 * t + 0.3)[:, None, None] * rng.standard_normal((6, m)))
    start = time.perf_counter()
    result = periodic_regulator(a, b, np.diag([1.0] * 6 + [1e6] * 6), 1e2 * np.eye(m), 86164.0)
    assert time.perf_counter() - start < 5.0
    assert result.attrs["residual"] < 1e-10


def test_what_cannot_be_held_is_refused():
    with pytest.raises(NoEstimateError, match="no stabilising periodic regulator"):
        periodic_regulator(np.diag([0.5, -1.0]), np.array([[0.0], [1.0]]), np.eye(2), np.eye(1), 1.0)


def test_what_the_cost_does_not_see_is_refused():
    with pytest.raises(NoEstimateError):
        periodic_regulator(np.zeros((1, 1)), np.ones((1, 1)), np.zeros((1, 1)), np.eye(1), 1.0)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"a": np.zeros((3, 4))}, "a must have shape"),
        ({"b": np.zeros((5, 4))}, "b must have shape"),
        ({"q": np.zeros((6, 4, 4)), "r": np.ones((5, 2, 2))}, "must have shape"),
        ({"q": -np.eye(4)}, "negative eigenvalues"),
        ({"q": np.triu(np.ones((4, 4)))}, "q must be symmetric"),
        ({"r": np.zeros((2, 2))}, "positive definite"),
        ({"a": np.full((4, 4), np.nan)}, "not finite"),
        ({"period_s": 0.0}, "period_s must be a positive"),
        ({"control": "heald"}, 'did you mean "held"'),
    ],
)
def test_bad_input(change, words):
    given = dict(zip("abqr", CONSTANT, strict=True)) | {"period_s": 1.0} | change
    with pytest.raises(InputError, match=words):
        periodic_regulator(**given)
