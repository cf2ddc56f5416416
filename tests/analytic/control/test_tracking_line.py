"""The tracked line: errors, gains, limits, and the closed loop in a constant field."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.control import LAWS
from fieldline.control.tracking_line import ARCSECOND, line_gains, tracking_errors
from fieldline.errors import InputError
from law_tests import CONTEXT, FLIGHT, called, known_measurement
from tiny_flight import step

kernels = pytest.mark.kernels  # flights of hours stay out: they are slow without compilation
LINE = {"target_i": (1.0, 0.0, 0.0)}
J, FIELD = 1356.0, 2.5e-5  # kg m^2 and T, of a large observatory


def context(period_s=0.1):
    return replace(CONTEXT, inertia_kg_m2=J * np.eye(3), moment_max_a_m2=np.full(3, 50.0), period_s=period_s)


@kernels
def test_errors_are_the_turns_that_are_missing():
    turned = Rotation.from_rotvec([0.0, 2e-6, -3e-6]).as_quat()
    assert tracking_errors(tuple(turned), (1.0, 0.0, 0.0)) == pytest.approx((-2e-6, 3e-6), rel=1e-6)
    assert tracking_errors(tuple(Rotation.from_rotvec([0.3, 0.0, 0.0]).as_quat()), (1.0, 0.0, 0.0)) == (0.0, 0.0)


@kernels
def test_gains_place_the_poles():
    kp, kd, ki = line_gains(J, 0.1, 0.7, 0.02)
    assert np.allclose(np.poly([-0.02, *np.roots([1.0, 0.14, 0.01])]), [1.0, kd / J, kp / J, ki / J])
    assert line_gains(J, 0.1, 0.7) == pytest.approx((J * 0.01, J * 0.14, 0.0))


@kernels
@pytest.mark.parametrize("name", ["three-coil", "two-coil"])
def test_torque_is_the_gain_times_the_limited_error(name):
    params = LAWS[name].pack(LINE | {"sensor_limit_arcsec": 1.2}, context())
    field = np.array([0.5, 0.6, 0.3]) * FIELD
    small = Rotation.from_rotvec(np.array([0.0, 0.5, -0.8]) * ARCSECOND).as_quat()
    large = Rotation.from_rotvec(np.array([0.0, 5.0, -0.8]) * ARCSECOND).as_quat()
    for q, errors in ((small, (-0.5, 0.8)), (large, (-1.2, 0.8))):
        torque = np.cross(called(name, known_measurement(field, q_bi=q), params=params), field)
        assert np.allclose(torque[1:], J * 0.01 * ARCSECOND * np.array(errors), rtol=1e-6)


@kernels
def test_each_coil_saturates_by_itself():
    params = LAWS["three-coil"].pack(LINE | {"moment_max_a_m2": (10.0, 2.0, 3.0)}, context())
    turned = Rotation.from_rotvec(np.array([0.0, 1.0, -1.0]) * ARCSECOND).as_quat()
    command = called("three-coil", known_measurement((1e-9, 2e-5, 1e-5), q_bi=turned), params=params)
    assert abs(command[0]) < 10.0 and abs(command[1]) == 2.0 and abs(command[2]) == 3.0


def fly(name, table, error_arcsec, field_b, seconds, disturbance=(0.0, 0.0, 0.0), period_s=0.1):
    """(n, 3) [arcsec, arcsec, deg]: errors A_y, A_z and roll, in a field that is constant in space."""
    law, params = LAWS[name], LAWS[name].pack(LINE | table, context(period_s))
    q = tuple(Rotation.from_rotvec(-ARCSECOND * np.array([0.0, *error_arcsec])).as_quat())
    omega, zero, memory, rows = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), np.zeros(law.memory), []
    inertia, inverse = tuple((J * np.eye(3)).ravel()), tuple((np.eye(3) / J).ravel())
    nowhere = (FLIGHT.radius, 0.0, 0.0)
    for k in range(int(seconds / period_s)):
        body = Rotation.from_quat(q).inv()
        field = body.apply(field_b)
        command = law.kernel(k * period_s, known_measurement(field, omega, q, k * period_s), memory, params)
        torque = tuple(np.cross(command, field) + np.array(disturbance))
        rows.append(
            (*np.array(tracking_errors(q, (1.0, 0.0, 0.0))) / ARCSECOND, np.degrees(Rotation.from_quat(q).as_rotvec()[0]))
        )
        q, omega, _ = step(0.0, q, omega, zero, period_s, nowhere, inertia, inverse, zero, zero, torque, zero)
    return np.array(rows)


@pytest.mark.parametrize("name", ["three-coil", "two-coil"])
def test_the_line_is_brought_to_its_target(name):
    flown = fly(name, {}, (6.0, 0.0), np.array([0.5, 0.6, 0.62]) * FIELD, 120.0)
    late = np.abs(flown[1000:, :2])
    assert late.max() < 0.1  # arcsec, the observatory's demand
    roll = -(0.6 * 6.0 + 0.0) / 0.5 / 3600.0  # deg: from rest to rest the roll is -(B_y A_y0 + B_z A_z0)/B_x
    assert flown[-1, 2] == pytest.approx(roll, rel=0.02)


def test_a_steady_torque_leaves_an_error_that_the_integrator_takes_out():
    torque, field = (0.0, 1e-5, 0.0), np.array([0.5, 0.6, 0.62]) * FIELD
    without = fly("three-coil", {}, (0.0, 0.0), field, 200.0, torque)
    with_it = fly("three-coil", {"integrator_rad_s": 0.03}, (0.0, 0.0), field, 300.0, torque)
    assert without[-1, 0] == pytest.approx(-1e-5 / (J * 0.01) / ARCSECOND, rel=0.01)
    assert abs(with_it[-1, 0]) < 0.01 * abs(without[-1, 0])


@kernels
def test_a_lost_star_gives_no_moment_and_no_kick_afterwards():
    law, params = LAWS["three-coil"], LAWS["three-coil"].pack(LINE, context())
    memory, field = np.zeros(law.memory), np.array([0.5, 0.6, 0.62]) * FIELD
    q = Rotation.from_rotvec(np.array([0.0, 0.5, 0.0]) * ARCSECOND).as_quat()
    first = law.kernel(0.0, known_measurement(field, q_bi=q), memory, params)
    lost = known_measurement(field)
    lost.valid[3] = 0.0
    lost.q_bi[:] = np.nan
    assert not law.kernel(0.1, lost, memory, params).any()
    assert np.array_equal(law.kernel(0.2, known_measurement(field, q_bi=q), memory, params), first)


@kernels
def test_the_direction_must_be_one():
    with pytest.raises(InputError, match="three zeros"):
        LAWS["two-coil"].pack({"target_i": (0.0, 0.0, 0.0)}, CONTEXT)
    with pytest.raises(InputError, match="needs target_i"):
        LAWS["two-coil"].pack({}, CONTEXT)
