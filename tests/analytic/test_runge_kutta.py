"""The methods' numbers, their measured orders, their errors and interpolants, against SciPy where it has the same."""

from math import log2, sqrt

import numpy as np
import pytest
from scipy.integrate import DOP853 as PEER

from fieldline.integrate.dense import dense_coefficients, dense_value, hermite_coefficients
from fieldline.integrate.steps import combine, error_norm, error_scale, next_step, starting_step
from fieldline.integrate.tableau import DOP853, RK4

pytestmark = pytest.mark.kernels
METHODS = pytest.mark.parametrize("method", [RK4, DOP853], ids=["RK4", "DOP853"])

ARENSTORF_START = np.array([0.994, 0.0, 0.0, -2.00158510637908252240537862224])
ARENSTORF_PERIOD = 17.0652165601579625588917206249  # Hairer, Norsett and Wanner (1993), s. II.0
MOON = 0.012277471


def arenstorf(t, z):
    x, y, u, v = z
    earth = ((x + MOON) ** 2 + y * y) ** 1.5
    moon = ((x - 1.0 + MOON) ** 2 + y * y) ** 1.5
    ax = x + 2.0 * v - (1.0 - MOON) * (x + MOON) / earth - MOON * (x - 1.0 + MOON) / moon
    ay = y - 2.0 * u - (1.0 - MOON) * y / earth - MOON * y / moon
    return np.array([u, v, ax, ay])


def kepler(t, z):
    return np.concatenate([z[2:], -z[:2] / np.hypot(z[0], z[1]) ** 3])


def kepler_truth(t, eccentricity):
    """State at t of the orbit that starts at its pericentre, semi-major axis and rate 1."""
    anomaly = t
    for _ in range(50):
        anomaly -= (anomaly - eccentricity * np.sin(anomaly) - t) / (1.0 - eccentricity * np.cos(anomaly))
    c, s, b = np.cos(anomaly), np.sin(anomaly), sqrt(1.0 - eccentricity**2)
    return np.array([c - eccentricity, b * s, -s / (1.0 - eccentricity * c), b * c / (1.0 - eccentricity * c)])


def evaluate(f, t, z, h, k, method):
    """One step from z with k[0] known; returns the state at its end, and fills k."""
    stage, s = np.empty_like(z), method.b.size
    for i in range(1, s):
        combine(z, h, k, method.a[i], i, stage)
        k[i] = f(t + method.c[i] * h, stage)
    end = np.empty_like(z)
    combine(z, h, k, method.b, s, end)
    k[s] = f(t + h, end)
    return end


def coefficients_of(f, t, z, end, h, k, method):
    out = np.full((7, z.size), np.nan)
    first = method.b.size + 1
    if method.c_extra.size == 0:
        hermite_coefficients(z, end, k[0], k[first - 1], h, out)
        return out
    stage = np.empty_like(z)
    for x in range(method.c_extra.size):
        combine(z, h, k, method.a_extra[x], first + x, stage)
        k[first + x] = f(t + method.c_extra[x] * h, stage)
    dense_coefficients(z, end, h, k, method.d, out)
    return out


def fixed(f, z, span, steps, method):
    h, k = span / steps, np.zeros((method.evaluations, z.size))
    k[0] = f(0.0, z)
    for i in range(steps):
        z = evaluate(f, i * h, z, h, k, method)
        k[0] = k[method.b.size]
    return z


def adaptive(f, z, span, tolerance):
    """End state, accepted and refused steps of DOP853."""
    k, scale, absolute = np.zeros((16, z.size)), np.empty_like(z), np.full(z.size, tolerance)
    k[0] = f(0.0, z)
    error_scale(z, z, absolute, tolerance, scale)
    t, h, refused, accepted, rejected = 0.0, starting_step(z, k[0], scale), 0, 0, False
    while t < span:
        h = min(h, span - t)
        end = evaluate(f, t, z, h, k, DOP853)
        error_scale(z, end, absolute, tolerance, scale)
        error = error_norm(h, k, DOP853.e3, DOP853.e5, scale)
        if error <= 1.0:
            t, z, k[0], accepted = t + h, end, k[12], accepted + 1
            h, rejected = next_step(h, error, DOP853.order, rejected), False
        else:
            h, rejected, refused = next_step(h, error, DOP853.order, True), True, refused + 1
    return z, accepted, refused


@METHODS
def test_weights_meet_the_quadrature_conditions_and_rows_sum_to_nodes(method):
    for power in range(method.order):
        assert method.b @ method.c**power == pytest.approx(1.0 / (power + 1), abs=2e-15)
    assert np.abs(method.a.sum(axis=1) - method.c).max() < 2e-15
    assert np.all(np.triu(method.a) == 0.0)


def test_weights_meet_the_conditions_of_the_third_and_fourth_orders_trees():
    for method in (RK4, DOP853):
        a, b, c = method.a, method.b, method.c
        assert b @ a @ c == pytest.approx(1 / 6, abs=1e-15)
        assert b @ (c * (a @ c)) == pytest.approx(1 / 8, abs=1e-15)
        assert b @ a @ c**2 == pytest.approx(1 / 12, abs=1e-15)
        assert b @ a @ a @ c == pytest.approx(1 / 24, abs=1e-15)


def test_error_weights_of_dop853_vanish_on_polynomials_of_their_order():
    nodes = np.append(DOP853.c, 1.0)
    for power in range(5):
        assert abs(DOP853.e5 @ nodes**power) < 1e-14
    assert abs(DOP853.e5 @ nodes**5) > 1e-4
    for power in range(3):
        assert abs(DOP853.e3 @ nodes**power) < 1e-14
    assert abs(DOP853.e3 @ nodes**3) > 1e-4
    assert np.all(RK4.e3 == 0.0) and np.all(RK4.e5 == 0.0)


@pytest.mark.parametrize(("method", "steps"), [(RK4, 100), (DOP853, 20)], ids=["RK4", "DOP853"])
def test_the_measured_order_is_the_order(method, steps):
    start, span, eccentricity = kepler_truth(0.0, 0.1), 3.0, 0.1
    errors = [
        np.linalg.norm(fixed(kepler, start, span, n, method) - kepler_truth(span, eccentricity)) for n in (steps, 2 * steps)
    ]
    assert log2(errors[0] / errors[1]) == pytest.approx(method.order, abs=0.35)


@pytest.mark.parametrize(("method", "order"), [(RK4, 4), (DOP853, 8)], ids=["hermite", "order 7"])
def test_the_interpolant_has_its_local_order(method, order):
    """Local error h^(order of the interpolant + 1), on the exact solution's first step."""
    errors = []
    for h in (0.4, 0.2):
        z, k, value = kepler_truth(0.0, 0.2), np.zeros((method.evaluations, 4)), np.empty(4)
        k[0] = kepler(0.0, z)
        end = evaluate(kepler, 0.0, z, h, k, method)
        coefficients = coefficients_of(kepler, 0.0, z, end, h, k, method)
        worst = 0.0
        for theta in np.linspace(0.1, 0.9, 9):
            dense_value(theta, coefficients, z, value)
            worst = max(worst, np.abs(value - kepler_truth(theta * h, 0.2)).max())
        errors.append(worst)
    assert log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.5)


@METHODS
def test_the_interpolant_meets_both_ends_and_their_rates(method):
    z, h, k = kepler_truth(0.0, 0.3), 0.3, np.zeros((method.evaluations, 4))
    k[0] = kepler(0.0, z)
    end = evaluate(kepler, 0.0, z, h, k, method)
    coefficients = coefficients_of(kepler, 0.0, z, end, h, k, method)
    values = {theta: np.empty(4) for theta in (0.0, 1e-6, 1.0 - 1e-6, 1.0)}
    for theta, value in values.items():
        dense_value(theta, coefficients, z, value)
    assert np.array_equal(values[0.0], z)
    assert values[1.0] == pytest.approx(end, abs=1e-15)
    assert (values[1e-6] - values[0.0]) / (1e-6 * h) == pytest.approx(k[0], abs=1e-5)
    assert (values[1.0] - values[1.0 - 1e-6]) / (1e-6 * h) == pytest.approx(k[method.b.size], abs=1e-5)


def test_the_cubic_fits_in_three_rows_as_in_seven():
    rng = np.random.default_rng(1)
    z0, z1, k0, k1 = rng.standard_normal((4, 5))
    three, seven, a, b = np.empty((3, 5)), np.full((7, 5), np.nan), np.empty(5), np.empty(5)
    hermite_coefficients(z0, z1, k0, k1, 0.7, three)
    hermite_coefficients(z0, z1, k0, k1, 0.7, seven)
    dense_value(0.3, three, z0, a)
    dense_value(0.3, seven, z0, b)
    assert np.array_equal(a, b)


def test_a_step_of_dop853_its_error_and_its_interpolant_are_scipys():
    h, tolerance = 0.01, 1e-9
    peer = PEER(arenstorf, 0.0, ARENSTORF_START, 20.0, first_step=h, rtol=1e-3, atol=1e-3)
    peer.step()
    assert peer.t == h
    k, scale = np.zeros((16, 4)), np.empty(4)
    k[0] = arenstorf(0.0, ARENSTORF_START)
    end = evaluate(arenstorf, 0.0, ARENSTORF_START, h, k, DOP853)
    assert end == pytest.approx(peer.y, rel=1e-13, abs=1e-15)
    error_scale(ARENSTORF_START, end, np.full(4, tolerance), tolerance, scale)
    theirs = peer._estimate_error_norm(peer.K, h, tolerance * (1.0 + np.maximum(np.abs(ARENSTORF_START), np.abs(end))))
    assert error_norm(h, k, DOP853.e3, DOP853.e5, scale) == pytest.approx(theirs, rel=1e-6)
    coefficients, value = coefficients_of(arenstorf, 0.0, ARENSTORF_START, end, h, k, DOP853), np.empty(4)
    dense = peer.dense_output()
    for theta in (0.1, 0.5, 0.77):
        dense_value(theta, coefficients, ARENSTORF_START, value)
        assert value == pytest.approx(dense(theta * h), rel=1e-12, abs=1e-14)


def test_the_arenstorf_orbit_closes_in_as_few_steps_as_scipys():
    end, accepted, refused = adaptive(arenstorf, ARENSTORF_START, ARENSTORF_PERIOD, 1e-11)
    assert np.abs(end - ARENSTORF_START)[:2].max() < 1e-5  # the orbit multiplies an early error about a millionfold
    peer = PEER(arenstorf, 0.0, ARENSTORF_START, ARENSTORF_PERIOD, rtol=1e-11, atol=1e-11)
    steps = 0
    while peer.status == "running":
        peer.step()
        steps += 1
    assert np.abs(end - peer.y)[:2].max() < 1e-5
    assert 0.8 * steps < accepted + refused < 1.3 * steps


def test_an_eccentric_orbit_keeps_its_tolerance():
    end, _, _ = adaptive(kepler, kepler_truth(0.0, 0.7), 2.0 * np.pi, 1e-10)
    assert np.abs(end - kepler_truth(0.0, 0.7)).max() < 5e-8


def test_the_controllers_limits():
    assert next_step(1.0, 0.0, 8, False) == 6.0
    assert next_step(1.0, 0.0, 8, True) == 1.0
    assert next_step(2.0, 1.0, 8, False) == pytest.approx(1.8)
    assert next_step(1.0, 1e9, 8, True) == pytest.approx(1.0 / 3.0)
    assert next_step(1.0, float("nan"), 8, True) == pytest.approx(1.0 / 3.0)
    assert next_step(1.0, 1e-3, 4, False) == pytest.approx(0.9 * 1e-3**-0.25)
    assert next_step(-1.0, 0.0, 8, False) == -6.0


def test_no_error_is_no_error_and_zero_weights_are_skipped():
    k = np.zeros((13, 2))
    assert error_norm(1.0, k, DOP853.e3, DOP853.e5, np.ones(2)) == 0.0
    k[1] = np.nan  # DOP853 does not use its second stage in the step
    out = np.empty(2)
    combine(np.ones(2), 1.0, k, DOP853.b, 12, out)
    assert np.array_equal(out, np.ones(2))


def test_the_first_step_is_a_hundredth_of_the_states_own_time():
    scale = np.array([1e-3, 1e-6])
    assert starting_step(np.array([7e6, 0.0]), np.array([7e3, 0.0]), scale) == pytest.approx(10.0)
    assert starting_step(np.zeros(2), np.ones(2), scale) == 1e-6
