"""Margins of regulators: closed forms of one state, what theory promises of many, python-control, and loops built with delay."""

import warnings

import numpy as np
import pytest
import scipy.linalg
from numpy.testing import assert_allclose

from fieldline.analysis import frozen_margins, guaranteed, periodic_margins, periodic_regulator
from fieldline.control.frozen_regulator import frozen_regulator
from fieldline.errors import NoEstimateError

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import control


def one(number):
    return np.array([[float(number)]])


def test_what_an_unstable_state_forgives_at_least_cost():
    # dx/dt = a x + u, the state unweighted: u = -2 a x. Pole at a (1 - 2 g); |L| = 1 at sqrt(3) a, 60 degrees from -1.
    a = 0.01
    found = frozen_margins(one(a), one(1.0), one(2.0 * a))
    assert found.gain.low == pytest.approx(0.5, rel=1e-4) and found.gain.high == np.inf
    assert found.lag_rad == pytest.approx(np.pi / 3.0, rel=1e-9)
    assert found.delay_s == pytest.approx(np.pi / 3.0 / (np.sqrt(3.0) * a), rel=1e-9)
    assert found.return_difference == pytest.approx(1.0, abs=1e-12)
    assert guaranteed(1.0) == pytest.approx((0.5, np.inf, np.pi / 3.0))


def test_an_integrator_forgives_a_right_angle():
    found = frozen_margins(one(0.0), one(2.0), one(0.3))
    assert found.gain == (0.0, np.inf)
    assert found.lag_rad == pytest.approx(np.pi / 2.0) and found.delay_s == pytest.approx(np.pi / 2.0 / 0.6)


def test_a_loop_that_is_not_of_least_cost_is_nearer_to_minus_one():
    # L = k/((s + 1)^3): unstable from k = 8 on, |1 + L| least by a fine scan
    k, w = 4.0, np.linspace(1e-3, 10.0, 400_001)
    F, G, K = np.array([[-3.0, -3.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.eye(3)[:, :1], np.array([[0.0, 0.0, k]])
    found = frozen_margins(F, G, K)
    assert found.gain.high == pytest.approx(2.0, rel=5e-5)
    nearest = np.abs(1.0 + k / (1j * w + 1.0) ** 3).min()
    assert found.return_difference == pytest.approx(nearest, rel=1e-5)
    low, high, lag = guaranteed(found.return_difference)
    assert found.gain.low <= low < 1.0 < high <= found.gain.high and lag <= found.lag_rad


def random_plant(seed):
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(2, 7)), int(rng.integers(1, 4))
    return rng.standard_normal((n, n)), rng.standard_normal((n, m)), rng.uniform(0.2, 5.0, n), rng.uniform(0.2, 5.0, m)


@pytest.mark.parametrize("seed", range(8))
def test_least_cost_keeps_its_promise(seed):
    F, G, q, r = random_plant(seed)
    found = frozen_margins(F, G, frozen_regulator(F, G, np.eye(len(F)), q, r).gain, r)
    assert found.return_difference == pytest.approx(1.0, abs=1e-6)
    for gain in (found.gain, *found.gain_of):
        assert gain.low <= 0.5001 and gain.high == np.inf
    assert min(found.lag_rad, *found.lag_of_rad) >= np.pi / 3.0 - 1e-6
    assert found.delay_s <= found.delay_of_s.min()


@pytest.mark.parametrize("seed", range(8))
def test_of_each_input_the_same_as_python_control(seed):
    F, G, q, r = random_plant(seed)
    K = frozen_regulator(F, G, np.eye(len(F)), q, r).gain
    found = frozen_margins(F, G, K, r)
    for j in range(G.shape[1]):
        others = F - np.delete(G, j, 1) @ np.delete(K, j, 0)
        loop = control.ss(others, G[:, [j]], K[[j]], 0.0)
        up, lag, _, _, _, _ = control.stability_margins(loop, returnall=True)
        below = max((float(g) for g in up if g < 1.0), default=0.0)
        assert found.gain_of[j].low == pytest.approx(below, rel=1e-3, abs=1e-3)
        assert np.degrees(found.lag_of_rad[j]) == pytest.approx(np.abs(lag).min() if len(lag) else 180.0, rel=1e-5)


@pytest.mark.parametrize("seed", range(4))
def test_the_return_difference_is_the_disk_of_python_control(seed):
    F, G, q, _ = random_plant(seed)
    G = G[:, :1]  # of many inputs it needs a library that is not asked for here
    K = 0.8 * frozen_regulator(F, G, np.eye(len(F)), q, np.ones(1)).gain  # no longer of least cost
    found = frozen_margins(F, G, K)
    disk, _, _ = control.disk_margins(control.ss(F, G, K, 0.0), np.logspace(-3, 3, 6000), skew=1.0)
    assert found.return_difference == pytest.approx(float(disk), rel=1e-4)


@pytest.mark.parametrize("seed", range(4))
def test_a_loop_with_the_delay_is_lost_just_beyond_it(seed):
    F, G, q, r = random_plant(seed)
    K = frozen_regulator(F, G, np.eye(len(F)), q, r).gain
    delay = frozen_margins(F, G, K, r).delay_s
    for factor, stable in ((0.97, True), (1.03, False)):
        step = factor * delay / 300  # the hold adds half a step, which is taken off the delay
        both = scipy.linalg.expm(step * np.block([[F, G], [np.zeros((G.shape[1], sum(G.shape)))]]))
        n = len(F)
        steps, reach = both[:n, :n], both[:n, n:]
        state, past = np.eye(n)[:, 0].copy(), [np.zeros(G.shape[1])] * 300
        sizes = []
        for _ in range(300 * 400):
            past.append(-K @ state)
            state = steps @ state + reach @ (0.5 * (past.pop(0) + past[0]))
            sizes.append(np.linalg.norm(state))
            if sizes[-1] > 1e6:
                break
        assert (max(sizes[-3000:]) < 1e-2 * max(sizes)) == stable


def test_a_loop_that_is_lost_has_none():
    with pytest.raises(NoEstimateError, match="not stable"):
        frozen_margins(one(1.0), one(1.0), one(0.5))


def test_held_gains_of_one_state_in_closed_form():
    # x1 = x0 + h g u, u = -k x: stable for 0 < g k h < 2; delayed by one step for g k h < 1.
    h, k = 2.0, 0.3
    ranges, delay = periodic_margins(np.ones((5, 1, 1)), np.full((5, 1, 1), h), np.full((5, 1, 1), k), h)
    assert ranges[0].low == 0.0 and ranges[0].high == pytest.approx(2.0 / (k * h), rel=5e-5)
    assert ranges[1] == ranges[0]
    # |L| of a delay of d steps: k h < 2 sin(pi/(2 (2 d + 1)))
    longest = max(d for d in range(20) if k * h < 2.0 * np.sin(np.pi / (2.0 * (2 * d + 1))))
    assert delay == pytest.approx(longest * h)


def test_a_constant_plant_has_the_margins_of_the_instant():
    F, G = np.array([[0.0, 1.0], [0.3, -0.1]]), np.array([[0.0], [1.0]])
    q, r = np.diag([1.0, 0.5]), np.eye(1)
    frozen = frozen_margins(F, G, frozen_regulator(F, G, np.eye(2), np.diag(q), np.ones(1)).gain)
    for kind in ("held", "continuous"):
        found = periodic_regulator(np.broadcast_to(F, (40, 2, 2)), G, q, r, 0.4, kind, margins=True)
        assert float(found["gain_margin_low"]) == pytest.approx(frozen.gain.low, rel=0.02)
        assert float(found["delay_margin_s"]) == pytest.approx(frozen.delay_s, abs=0.02)
    assert float(found["gain_margin_high"]) == np.inf  # of one that may change at any time
    assert float(found["gain_margin_high_of"][0]) == np.inf


def test_over_a_period_the_ends_are_where_a_multiplier_leaves_the_circle():
    t = np.arange(24) / 24 * 2.0 * np.pi
    a = np.zeros((24, 2, 2))
    a[:, 0, 1], a[:, 1, 0] = 1.0, 0.4 + 0.3 * np.cos(t)
    b = np.zeros((24, 2, 2))
    b[:, 1, 0], b[:, 0, 1] = np.cos(t), 0.5
    found = periodic_regulator(a, b, np.eye(2), np.eye(2), 2.0 * np.pi, margins=True)
    from fieldline.control.periodic_system import held_problem, product

    held = held_problem(a, b, *(np.broadcast_to(np.eye(2), (24, 2, 2)),) * 2, 2.0 * np.pi)
    for which, ends in (
        (np.ones(2), (found["gain_margin_low"], found["gain_margin_high"])),
        (np.array([0.0, 1.0]), (found["gain_margin_low_of"][1], found["gain_margin_high_of"][1])),
    ):
        for end, beyond in zip(map(float, ends), (0.999, 1.001), strict=True):
            if not 0.0 < end < np.inf:
                continue
            for share, stable in ((1.0, True), (beyond, False)):
                factors = 1.0 + (share * end - 1.0) * which
                closed = held.phi - (held.gamma * factors) @ found["gain"].values
                assert (np.abs(np.linalg.eigvals(product(closed))).max() < 1.0) == stable
    assert_allclose(float(found["delay_margin_s"]) % (2.0 * np.pi / 24), 0.0, atol=1e-12)
