"""Force and moment to currents and thrusts: against SciPy's bounded least squares, and by what must hold."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fieldline.control.electrodynamic import electrodynamic_map
from fieldline.control.tracking.allocation import COST, allocate, allocate_kernel, power_costs
from fieldline.design import tank_with_towers
from fieldline.errors import InputError

pytestmark = pytest.mark.kernels
VEHICLE = tank_with_towers()
NAMES = [one.name for one in VEHICLE.conductors] + ["T"]
UPPER = np.array([125.0] * 8 + [10.0])
WEIGHTS = np.array([1.0, 1.0, 1.0, 0.01, 0.01, 0.01])
FIELD = np.array([9e-6, 3e-6, 2.5e-5])
EFFECT = electrodynamic_map(VEHICLE, FIELD)


def by_scipy(effect, wanted, lower, upper):
    """The same problem as a stacked least-squares one."""
    from scipy.optimize import lsq_linear

    size = np.maximum(-lower, upper)
    rows = WEIGHTS[:, None] * effect * size
    small = np.sqrt((COST + 1e-14) * (rows**2).sum(axis=0).max())
    stacked, right = np.vstack([rows, small * np.eye(len(size))]), np.concatenate([WEIGHTS * wanted, np.zeros(len(size))])
    found = lsq_linear(stacked, right, (lower / size, upper / size), method="bvls", tol=1e-15, max_iter=1000).x
    return found * size, lambda u: float(((stacked @ (u / size) - right) ** 2).sum())


@given(seed=st.integers(0, 10_000), size=st.floats(-2.0, 2.0), one_sided=st.booleans())
@settings(max_examples=60, deadline=None)
def test_the_same_as_scipy_within_and_at_the_limits(seed, size, one_sided):
    rng = np.random.default_rng(seed)
    effect = np.ascontiguousarray(electrodynamic_map(VEHICLE, 2e-5 * rng.normal(size=3)))
    wanted = 10.0**size * rng.normal(size=6) / WEIGHTS
    lower = -UPPER.copy()
    lower[8] = 0.0 if one_sided else -10.0
    u, held = np.zeros(9), np.zeros(9, dtype=np.int64)
    tried = allocate_kernel(effect, wanted, WEIGHTS, np.ones(9), lower, UPPER, COST, u, held)
    best, cost = by_scipy(effect, wanted, lower, UPPER)
    assert 0 < tried < 60 and (u >= lower).all() and (u <= UPPER).all()
    assert cost(u) <= cost(best) * (1.0 + 1e-9) + 1e-20
    again = allocate_kernel(effect, wanted, WEIGHTS, np.ones(9), lower, UPPER, COST, u.copy(), held)
    assert again == 1  # its own solution is where it stays


def test_loads_within_reach_are_met_by_the_least_power():
    wanted = EFFECT @ np.array([5.0, -3.0, 8.0, 2.0, 1.0, -1.0, 2.0, 4.0, 0.5])
    resistance = np.array([1.0, 1.0, 6.0, 6.0, 0.4, 0.4, 0.4, 0.4, 0.0])
    found = allocate(EFFECT, wanted, -UPPER, UPPER, resistance_ohm=resistance, names=NAMES)
    assert found.reached and found.at_limit == ()
    assert_allclose(found.loads * WEIGHTS, wanted * WEIGHTS, atol=1e-3 * np.linalg.norm(wanted * WEIGHTS))
    # the exact constrained least: u = D E' (E D E')^-1 f with D one over the costs
    weight = (UPPER**2 / power_costs(resistance, -UPPER, UPPER))[:, None]
    exact = (weight * EFFECT.T) @ np.linalg.solve(EFFECT @ (weight * EFFECT.T), wanted)
    assert_allclose(found.controls[:8], exact[:8], rtol=0.02, atol=0.02)


def test_failed_conductors_do_nothing_and_others_take_over():
    wanted = np.array([0.05, -0.02, 0.03, 1.0, -2.0, 3.0])
    whole = allocate(EFFECT, wanted, -UPPER, UPPER, names=NAMES)
    broken = allocate(EFFECT, wanted, -UPPER, UPPER, names=NAMES, failed=("I1u", "I2e", 6))
    assert whole.reached and broken.reached
    assert (broken.controls[[0, 2, 6]] == 0.0).all() and np.abs(whole.controls[[0, 2, 6]]).min() > 1e-3


def test_beyond_the_limits_what_is_missed_is_said():
    found = allocate(EFFECT, np.array([-50.0, 0.0, 0.0, 0.0, 0.0, 0.0]), -UPPER, UPPER, names=NAMES)
    assert not found.reached and {"I2e", "I2w"} <= set(found.at_limit)
    assert found.missed[0] == pytest.approx(-50.0 - found.loads[0]) and abs(found.loads[0]) < 3.0


def test_a_limit_on_the_whole_power_holds():
    wanted = np.array([-1.0, 0.0, 0.3, 0.0, 0.0, 5.0])
    free = allocate(EFFECT, wanted, -UPPER, UPPER, resistance_ohm=1.0)
    power = float((free.controls[:8] ** 2).sum())
    bound = allocate(EFFECT, wanted, -UPPER, UPPER, resistance_ohm=1.0, power_max_w=0.25 * power)
    assert float((bound.controls**2).sum()) <= 0.25 * power * (1.0 + 1e-9)
    assert float((bound.controls**2).sum()) > 0.24 * power and 0.4 < bound.loads[0] / free.loads[0] < 0.6


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"effect": np.zeros((5, 3))}, r"shape \(6, m\)"),
        ({"wanted": [1.0, 2.0]}, "six finite numbers"),
        ({"lower": np.full(9, 1.0)}, "doing nothing is always allowed"),
        ({"weights": (1.0, 1.0, 1.0, 0.0, 1.0, 1.0)}, "weights must be positive"),
        ({"failed": ("I2x",), "names": NAMES}, 'no control: "I2x"; did you mean "I2'),
        ({"power_max_w": 0.0}, "power_max_w more than zero"),
    ],
)
def test_bad_input(changes, words):
    given = {"effect": EFFECT, "wanted": np.ones(6), "lower": -UPPER, "upper": UPPER} | changes
    with pytest.raises(InputError, match=words):
        allocate(**given)
