"""Laws of a vehicle that flies by current: what they reckon with, what they refuse and in which words, what they do once."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from fieldline.control import LAWS
from fieldline.control.tracking import onboard_vehicle as own
from fieldline.control.tracking.approach_path import path
from fieldline.control.tracking.designs import periodic_gains, scheduled_gains
from fieldline.control.tracking.relative_state import relative_state
from fieldline.control.tracking.settings import COMMON, WEIGHTS, known_of, state_weights
from fieldline.design import tank_with_towers
from fieldline.errors import FieldlineError, InputError
from fieldline.frames.orbital import dcm_oi
from fieldline.mechanics.relative_motion import attitude_poles, holding_force
from fieldline.sensing.measurement import new_measurement
from fieldline.vehicle import Conductor, Thruster
from law_tests import CARRIER

pytestmark = pytest.mark.kernels
TANK = tank_with_towers(vertical_m=330.0, horizontal_m=310.0)
PAIR = (
    Thruster(name="south", position_b_m=(0.0, 0.0, -50.0), direction_b=(0.0, 0.0, 1.0), force_n=10.0),
    Thruster(name="north", position_b_m=(0.0, 0.0, 50.0), direction_b=(0.0, 0.0, -1.0), force_n=10.0),
)
TARGET = np.array([6.778e6, 0.0, 0.0]), np.array([0.0, 7668.6, 0.0])
N = 7668.6 / 6.778e6
H_TO_O = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]])


def field_over_the_equator():
    """A field of 1e-5 T in the plane, 2.5e-5 T across, turning once an orbit."""
    seconds = np.arange(120) * 2.0 * np.pi / N / 120
    h = np.column_stack([1e-5 * np.cos(N * seconds), 5e-6 * np.sin(N * seconds), np.full(120, 2.5e-5)])
    return seconds, h @ H_TO_O.T, h


CONTEXT = replace(
    CARRIER,
    inertia_kg_m2=np.diag(TANK.inertia_kg_m2),
    mean_motion_rad_s=N,
    mass_kg=TANK.mass_kg,
    radius_m=6.778e6,
    period_s=10.0,
    conductors=TANK.conductors,
    thrusters=PAIR,
    field_along_orbit=field_over_the_equator,
)


def beside(place_h, *, rate_h=(0.0, 0.0, 0.0), turn=(0.0, 0.0, 0.0), field_h=(1e-5, 0.0, 2.5e-5)):
    """A measurement of a vehicle beside the target, at a place and a rate in the turning axes, which are GCRS here."""
    m = new_measurement()
    place = np.array(place_h, dtype=float)
    velocity = np.array(rate_h) + np.cross([0.0, 0.0, N], place)
    m.position_i[:], m.velocity_i[:] = TARGET[0] + place, TARGET[1] + velocity
    m.relative_position_i[:], m.relative_velocity_i[:] = place, velocity
    m.q_bi[:] = Rotation.from_rotvec(turn).as_quat()
    m.omega_bi_b[:] = Rotation.from_rotvec(turn).inv().apply([0.0, 0.0, N])
    m.field_i[:] = field_h
    m.valid[:] = 1.0
    return m


def test_the_state_is_that_of_the_turning_axes():
    state = np.empty(12)
    relative_state(beside((10.0, -20.0, 30.0), rate_h=(0.1, 0.2, -0.3), turn=(0.01, -0.02, 0.03)), 1.0, state)
    assert_allclose(state[:6], [10.0, 0.1, -20.0, 0.2, 30.0, -0.3], atol=1e-9)
    assert_allclose(state[6::2], [0.01, -0.02, 0.03], rtol=1e-3)
    assert_allclose(state[7::2], 0.0, atol=1e-9)


def test_the_path_starts_still_and_ends_with_its_rate():
    params = np.array([0.0, 30.0, 0.0, 0.0, 5.0, 0.0, 100.0, 1000.0, 1.6])
    place, rate, push, before = (np.zeros(3) for _ in range(4))
    for t, where, speed in ((0.0, 30.0, 0.0), (100.0, 30.0, 0.0), (1100.0 - 1e-9, 5.0, -1.6 * 25.0 / 1000.0), (2000.0, 5.0, 0.0)):
        path(t, params, 0, place, rate, push)
        assert_allclose((place[1], rate[1], push[1]), (where, speed, 0.0), atol=1e-7)
    path(599.0, params, 0, before, rate, push)
    path(601.0, params, 0, place, rate, push)
    path(600.0, params, 0, np.zeros(3), rate, push)
    assert_allclose((place - before) / 2.0, rate, rtol=1e-5)


@pytest.mark.parametrize("name", ["tracking-allocated", "tracking-scheduled", "tracking-periodic", "tracking-predictive"])
def test_at_its_place_the_law_gives_what_the_place_asks(name):
    place = np.array([5.0, 100.0, 10.0])
    params = LAWS[name].pack({"place_h_m": place.tolist()}, CONTEXT)
    command = LAWS[name].kernel(0.0, beside(place), np.zeros(LAWS[name].memory), params)
    thrust, current = command[:2], command[2:]
    force = sum(one.length_m * np.array(one.direction_b) * i for one, i in zip(TANK.conductors, current, strict=True))
    force = np.cross(force, [1e-5, 0.0, 2.5e-5]) + (thrust[0] - thrust[1]) * np.array([0.0, 0.0, 10.0])
    assert_allclose(force, holding_force(N, TANK.mass_kg, place), atol=2e-3)
    assert (np.abs(current) <= 125.0).all() and (thrust >= 0.0).all() and (thrust <= 1.0).all()


def test_an_error_within_limits_is_pushed_back_and_a_failed_conductor_stays_silent():
    table = {"failed": ["I2e", "north"], "unreachable": "fly"}
    params = LAWS["tracking-allocated"].pack(table, CONTEXT)
    command = LAWS["tracking-allocated"].kernel(0.0, beside((2.0, 0.0, 0.0)), np.zeros(LAWS["tracking-allocated"].memory), params)
    names = [one.name for one in TANK.conductors]
    assert command[1] == 0.0 and command[2 + names.index("I2e")] == 0.0
    assert command[2 + names.index("I2w")] < -1.0  # L x B of the conductor along y is upwards


def test_a_limit_on_power_holds_in_the_law():
    resistant = tuple(one.model_copy(update={"resistance_ohm": 1.0}) for one in TANK.conductors)
    context = replace(CONTEXT, conductors=resistant)
    params = LAWS["tracking-allocated"].pack({"power_max_w": 500.0, "unreachable": "fly"}, context)
    command = LAWS["tracking-allocated"].kernel(0.0, beside((5.0, 0.0, 0.0)), np.zeros(LAWS["tracking-allocated"].memory), params)
    assert 450.0 < float((command[2:] ** 2).sum()) <= 500.0 * (1.0 + 1e-9)


def test_nothing_known_nothing_done():
    params = LAWS["tracking-allocated"].pack({}, CONTEXT)
    blind = beside((1.0, 0.0, 0.0))
    blind.relative_position_i[0] = np.nan
    memory = np.zeros(LAWS["tracking-allocated"].memory)
    assert (LAWS["tracking-allocated"].kernel(0.0, blind, memory, params) == 0.0).all()


def test_opposite_thrusters_are_one_control():
    table, names = own.controls_of(TANK.conductors, PAIR)
    assert len(table) == 9 and names[-1] == "south/north"
    assert (table[-1, own.LOWER], table[-1, own.UPPER]) == (-10.0, 10.0)
    single, _ = own.controls_of(TANK.conductors, PAIR[:1])
    assert (single[-1, own.LOWER], single[-1, own.UPPER]) == (0.0, 10.0)


def test_the_mended_vehicles_keep_upright_by_themselves():
    for towers in ({"vertical_m": 330.0, "horizontal_m": 310.0}, {"vertical_m": 310.0, "horizontal_m": 250.0}):
        found = attitude_poles(N, tank_with_towers(**towers).inertia_kg_m2)
        assert found.ordered and found.stable and found.growth_s == np.inf


TOO_FAST = {"place_h_m": (0.0, 5.0, 0.0), "from_h_m": (0.0, 9.0, 0.0), "move_s": 100.0, "closing_rate_m_s": 1.0}


@pytest.mark.parametrize(
    ("law", "table", "words"),
    [
        ("tracking-allocated", {"place_h_m": (100.0, 0.0, 0.0)}, r"cannot be held within .* nearest .* is \(\d+\.?\d*, 0, 0\) m"),
        ("tracking-allocated", {"position_m": 0.0}, "position_m of the law .* must be more than zero"),
        ("tracking-frozen", {"state_weight": -1.0}, "state_weight of the law .* must be more than zero"),
        ("tracking-scheduled", {"effort": 0.0}, "effort of the law .* must be more than zero"),
        ("tracking-periodic", {"effort": 0.0}, "effort of the law .* must be more than zero"),
        ("tracking-allocated", {"failed": ["I2x"]}, 'neither a conductor nor a thruster: "I2x"; did you mean "I2'),
        ("tracking-allocated", {"failed": "I2e"}, "is a list of names"),
        ("tracking-allocated", {"closing_rate_m_s": 0.1}, "for a way with from_h_m and move_s alone"),
        ("tracking-allocated", TOO_FAST, "run-up backwards; at most 0.1 m/s"),
        ("tracking-predictive", {"stages": 61}, "stages of the law .* whole number from 1 to 60"),
        ("tracking-allocated", {"failed": [one.name for one in TANK.conductors] + ["south", "north"]}, "no control left"),
    ],
)  # fmt: skip
def test_bad_input(law, table, words):
    with pytest.raises(InputError, match=words):
        LAWS[law].pack(table, CONTEXT)


def test_a_place_along_the_orbit_asks_for_nothing_that_limits_refuse():
    ahead = {"place_h_m": (0.0, 300.0, 0.0)}
    context = replace(CONTEXT, field_along_orbit=no_field_across)  # half of the time nothing gives it the moment of y/r0
    params = LAWS["tracking-allocated"].pack(ahead, context)
    assert params[own.PATH + 4] == 300.0
    with pytest.raises(InputError, match="nine tenths of the day"):
        LAWS["tracking-allocated"].pack({"place_h_m": (5.0, 300.0, 0.0)}, context)


def test_the_nearest_place_is_taken_where_that_is_asked():
    params = LAWS["tracking-allocated"].pack({"place_h_m": (100.0, 0.0, 0.0), "unreachable": "nearest"}, CONTEXT)
    held = params[own.PATH + 3]
    assert 5.0 < held < 20.0
    LAWS["tracking-allocated"].pack({"place_h_m": (0.999 * held, 0.0, 0.0)}, CONTEXT)


def test_a_body_without_conductors_is_refused():
    with pytest.raises(InputError, match="neither conductors nor thrusters"):
        LAWS["tracking-allocated"].pack({}, replace(CONTEXT, conductors=(), thrusters=()))


def test_products_of_inertia_are_refused():
    crooked = np.diag(TANK.inertia_kg_m2).copy()
    crooked[0, 1] = crooked[1, 0] = 1e6
    with pytest.raises(InputError, match="principal body axes"):
        LAWS["tracking-allocated"].pack({}, replace(CONTEXT, inertia_kg_m2=crooked))


def no_field_across():
    """A field that stays in the orbit's plane for half an orbit, and then does not."""
    seconds, _, h = field_over_the_equator()
    h = h.copy()
    h[:60, 2] = 0.0
    return seconds, h @ H_TO_O.T, h


def test_an_instant_out_of_reach_is_named_with_when_it_returns():
    context = replace(CONTEXT, thrusters=(), field_along_orbit=no_field_across)
    with pytest.raises(
        InputError, match=r"the motion in .* cannot be reached .* because no control pushes along .* back to 0.001 after \d+ s"
    ):
        LAWS["tracking-frozen"].pack({"unreachable": "fly"}, context)  # fmt: skip


def test_gains_of_each_instant_need_every_instant():
    context = replace(CONTEXT, thrusters=(), field_along_orbit=no_field_across)
    with pytest.raises(InputError, match=r"cannot be reached .* back to 0.001 after \d+ s"):
        LAWS["tracking-scheduled"].pack({"unreachable": "fly"}, context)


def test_each_instants_gain_is_the_regulator_of_that_instant_and_the_periodic_one_is_not():
    from scipy.linalg import expm, solve_discrete_are

    known = known_of("tracking-scheduled", {**COMMON, **WEIGHTS}, {}, CONTEXT)
    gains, at = scheduled_gains(known), 37
    both = np.zeros((21, 21))
    both[:12, :12], both[:12, 12:] = known.motion, known.inputs[at] * known.limits
    # the cost over a step by Simpson's rule on the exact motion, the input held
    steps = [expm(both * known.step_s * share) for share in np.linspace(0.0, 1.0, 9)]
    weight = np.zeros((21, 21))
    weight[:12, :12], weight[12:, 12:] = np.diag(state_weights(known)), known.values["effort"] * np.eye(9)
    simpson = known.step_s / 24.0 * np.array([1.0, 4.0, 2.0, 4.0, 2.0, 4.0, 2.0, 4.0, 1.0])
    cost = sum(s * one.T @ weight @ one for s, one in zip(simpson, steps, strict=True))
    A, B = steps[-1][:12, :12], steps[-1][:12, 12:]
    P = solve_discrete_are(A, B, cost[:12, :12], cost[12:, 12:], s=cost[:12, 12:])
    K = np.linalg.solve(cost[12:, 12:] + B.T @ P @ B, B.T @ P @ A + cost[:12, 12:].T) * known.limits[:, None]
    assert_allclose(gains[at], K, atol=1e-5 * np.abs(K).max())
    assert np.abs(periodic_gains(known)[at] - K).max() > 1e-2 * np.abs(K).max()


@pytest.mark.parametrize("name", [name for name in LAWS if name.startswith("tracking-")])
def test_conductors_of_one_direction_say_which_cannot_be_pushed(name):
    failed = [one.name for one in TANK.conductors if one.direction_b[1] == 0.0] + ["south", "north"]
    with pytest.raises(InputError, match=r"all conductors lie along \(0, 1, 0\) .* no force along that direction"):
        LAWS[name].pack({"failed": failed}, CONTEXT)


def test_a_place_beyond_the_linear_motion_is_flagged_with_its_error():
    with pytest.raises(InputError, match=r"is 80 km from the target, where the linear motion .* by 1.2 % .* 1 % is at 6\d.* km"):
        LAWS["tracking-allocated"].pack({"place_h_m": (80e3, 0.0, 0.0)}, CONTEXT)
    LAWS["tracking-allocated"].pack({"place_h_m": (80e3, 0.0, 0.0), "unreachable": "fly"}, CONTEXT)


def test_what_no_gains_reach_is_said_with_the_motion():
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    along = tuple(
        Conductor(position_b_m=tuple(side * 30.0 * part for part in axis), direction_b=axis, length_m=50.0)
        for axis in axes
        for side in (-1.0, 1.0)
    )
    seconds, _, h = field_over_the_equator()
    flat = np.column_stack([0.0 * seconds, 0.0 * seconds, h[:, 2]])  # across alone: pushes in the plane, turns about the normal
    context = replace(CONTEXT, conductors=along, thrusters=(), field_along_orbit=lambda: (seconds, flat @ H_TO_O.T, flat))
    with pytest.raises(FieldlineError, match="no periodic regulator keeps this vehicle"):
        LAWS["tracking-periodic"].pack({"unreachable": "fly"}, context)


def test_orbital_axes_of_the_laws_and_the_plant_agree():
    assert_allclose(dcm_oi(TARGET[0][None], TARGET[1][None])[0], H_TO_O, atol=1e-12)
