"""The right-hand side against the textbook's equations in NumPy, load by load and all together, at states at random."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit
from scipy.spatial.transform import Rotation

from fieldline.dynamics.load_log import LOADS as NAMES
from fieldline.dynamics.rates import turn_rate
from fieldline.frames.attitude import quat_exp, quat_mul
from plant_flights import random_state, rates
from plant_loads import LOADS, everything
from textbook_plant import Textbook

pytestmark = pytest.mark.kernels
ROUNDING = 1e-12  # relative to the largest term of a sum
FLIGHT = everything()
seeds = st.integers(0, 2**32 - 1)


@njit
def turning(sigma, omega):
    """The kernel has no way in from Python."""
    return turn_rate(sigma, omega)


def assert_alike(ours, theirs, scale, what):
    assert np.abs(np.subtract(ours, theirs)).max() <= ROUNDING * scale + 1e-300, what


@settings(max_examples=25, deadline=None)
@given(seed=seeds, t=st.floats(0.0, 100.0))
def test_every_load_is_the_textbooks(seed, t):
    y = random_state(FLIGHT, seed)
    told = Textbook(FLIGHT, t, y)
    _, log = rates(FLIGHT, t, y)
    for b in range(3):
        for k, name in enumerate(NAMES):
            force, torque = told.loads[b].get(name, (np.zeros(3), np.zeros(3)))
            # a line's tension is a small difference of places 7,000 km out, which rounding moves by a nanometre
            slack = 3e-8 if name == "lines" else 0.0
            assert_alike(log[k, b, :3], force, np.linalg.norm(force) + slack / ROUNDING, f"force of {name} on {b}")
            assert_alike(log[k, b, 3:], torque, max(np.linalg.norm(torque), 1e-9) + slack / ROUNDING, f"torque of {name} on {b}")


@settings(max_examples=25, deadline=None)
@given(seed=seeds, t=st.floats(0.0, 100.0))
def test_all_together_are_the_rates(seed, t):
    y = random_state(FLIGHT, seed)
    ours, _ = rates(FLIGHT, t, y)
    theirs = Textbook(FLIGHT, t, y).rates()
    for at, width, slack in [(12 * b + j, 3, 1e-8) for b in range(3) for j in (0, 3, 6, 9)] + [(36, len(ours) - 36, 0.0)]:
        part = slice(at, at + width)
        assert_alike(ours[part], theirs[part], np.linalg.norm(theirs[part]) + slack / ROUNDING, f"rates from {at}")


@pytest.mark.parametrize("load", LOADS, ids=lambda load: load.name)
def test_each_load_alone_is_the_textbooks(load):
    flight = load.flight()
    acts = False
    for seed in range(3):
        y = random_state(flight, seed) if "line" not in load.name else flight.start
        ours, log = rates(flight, 0.0, y)
        theirs = Textbook(flight, 0.0, y)
        for b in range(len(flight.scenario.body)):
            told = {name: pair for name, pair in theirs.loads[b].items() if np.any(pair)}
            assert {name for k, name in enumerate(NAMES) if np.any(log[k, b])} == set(told)
            acts = acts or len(told) > 1 or load.name in ("gravity", "oblateness", "free spin")
        expected = theirs.rates()
        assert np.allclose(ours, expected, rtol=ROUNDING, atol=1e-12 * np.abs(expected[3:6]).max())
    assert acts


@given(sigma=st.tuples(*[st.floats(-1.9, 1.9)] * 3), omega=st.tuples(*[st.floats(-2.0, 2.0)] * 3))
@settings(max_examples=50, deadline=None)
def test_the_rotation_vector_turns_as_the_quaternion_does(sigma, omega):
    """dq/dt = 1/2 q (omega, 0), with q = q0 exp(sigma / 2) differenced along dsigma/dt to fourth order."""
    q0 = tuple(Rotation.random(random_state=3).as_quat())
    rate = np.array(turning(sigma, omega))
    h = 1e-3

    def q(s):
        return np.array(quat_mul(q0, quat_exp(tuple(np.add(sigma, s * rate)))))

    slope = (8 * (q(h) - q(-h)) - (q(2 * h) - q(-2 * h))) / (12 * h)
    expected = 0.5 * np.array(quat_mul(tuple(q(0.0)), (*omega, 0.0)))
    assert np.abs(slope - expected).max() < 3e-11 * (1.0 + np.linalg.norm(omega)) ** 5


def test_the_series_near_zero_meets_the_closed_form():
    for size in (0.0099, 0.0101):
        sigma = size * np.array([0.48, 0.6, 0.64])
        bend = np.cross(sigma, (1.0, -2.0, 0.5))
        c = (1 - 0.5 * size / np.tan(0.5 * size)) / size**2
        expected = np.array((1.0, -2.0, 0.5)) + 0.5 * bend + c * np.cross(sigma, bend)
        assert np.allclose(turning(tuple(sigma), (1.0, -2.0, 0.5)), expected, rtol=1e-14)


@settings(max_examples=10, deadline=None)
@given(seed=seeds)
def test_the_sign_of_q_means_nothing(seed):
    y = random_state(FLIGHT, seed)
    other = y.copy()
    for b in range(3):
        other[13 * b + 6 : 13 * b + 10] *= -1.0
    (ours, log), (theirs, other_log) = rates(FLIGHT, 5.0, y), rates(FLIGHT, 5.0, other)
    kept = [k for k, name in enumerate(NAMES) if name != "user"]  # the user's function is given q as it stands
    assert np.array_equal(ours[:12], theirs[:12]) and np.array_equal(log[kept], other_log[kept])
