"""Momentum drawn out by the field, and pointing by wheels with and without it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.control import LAWS
from fieldline.errors import InputError
from law_tests import CONTEXT, FLIGHT, called, known_measurement
from tiny_flight import TinyFlight

kernels = pytest.mark.kernels  # flights of hours stay out: they are slow without compilation
DUMP, POINT, BOTH = LAWS["momentum-dump"], LAWS["wheel-pointing"], LAWS["wheel-pointing-with-desaturation"]


def with_wheels(momentum):
    measurement = known_measurement()
    measurement.wheel_momentum[:] = momentum
    return measurement


@kernels
def test_gain_is_the_rate_at_which_the_field_turns():
    params = DUMP.pack({}, CONTEXT)
    assert params[0] == pytest.approx(2.0 * FLIGHT.mean_motion * (1.0 + np.sin(FLIGHT.inclination)))


@kernels
def test_moment_is_equation_11_with_the_wheels_own_axes():
    axes = np.array([[1.0, 0.0, 0.0], [0.0, 0.6, 0.8], [0.0, 0.0, -1.0]])
    params = DUMP.pack({"gain_per_s": 3e-4}, replace(CONTEXT, wheel_axes_b=axes))
    measurement = with_wheels((0.2, -0.3, 0.1))
    momentum, field = axes.T @ (0.2, -0.3, 0.1), measurement.field_b
    moment = called("momentum-dump", measurement, params=params)
    assert np.allclose(moment, -3e-4 * np.cross(field, momentum) / (field @ field), rtol=1e-13)  # (11)


@kernels
def test_wanted_momentum_is_left_alone():
    params = DUMP.pack({"wanted_momentum_n_m_s": (0.0, -0.1, 0.0)}, CONTEXT)
    assert not called("momentum-dump", with_wheels((0.0, -0.1, 0.0)), params=params).any()
    assert called("momentum-dump", with_wheels((0.0, 0.1, 0.0)), params=params).any()


@kernels
def test_dumping_begins_and_ends_at_its_thresholds():
    params, memory = DUMP.pack({"start_n_m_s": 0.3, "stop_n_m_s": 0.1}, CONTEXT), np.zeros(DUMP.memory)
    sizes = (0.2, 0.31, 0.2, 0.11, 0.09, 0.2, 0.35)
    works = [called("momentum-dump", with_wheels((h, 0.0, 0.0)), memory=memory, params=params).any() for h in sizes]
    assert works == [False, True, True, True, False, False, True]


@kernels
def test_thresholds_in_the_wrong_order_are_refused():
    with pytest.raises(InputError, match="must not be above start"):
        DUMP.pack({"start_n_m_s": 0.1, "stop_n_m_s": 0.2}, CONTEXT)


@pytest.mark.parametrize("target", ["inertial", "nadir"])
def test_wheels_point_as_the_linear_law_says(target):
    flight = TinyFlight(
        inertia=[[5, 0.3, 0], [0.3, 6, 0.2], [0, 0.2, 2]], inclination_deg=70.0, period_s=0.5, gravity_gradient=False
    )
    params = POINT.pack({"target": target, "natural_frequency_rad_s": 0.05, "damping_ratio": 0.7}, flight.context(1))
    turned = np.array([0.02, -0.03, 0.01])
    goal = Rotation.from_quat(flight.nadir_quaternion(0.0)) if target == "nadir" else Rotation.identity()
    rate = Rotation.from_rotvec(turned).inv().apply([0.0, -flight.mean_motion, 0.0]) if target == "nadir" else np.zeros(3)
    flown = flight.fly(POINT, params, 0.06, (goal * Rotation.from_rotvec(turned)).as_quat(), rate, h=(0.5, -1.0, 0.8))
    if target == "nadir":
        error = np.radians(flight.nadir_error_deg(flown))
    else:
        error = Rotation.from_quat(flown["q"]).magnitude()
    t, w, z = flown["t"], 0.05, 0.7
    damped = w * np.sqrt(1.0 - z * z)
    wanted = np.linalg.norm(turned) * np.abs(np.exp(-z * w * t) * (np.cos(damped * t) + z * w / damped * np.sin(damped * t)))
    assert np.abs(error - wanted).max() < 0.02 * np.linalg.norm(turned)  # held for half a second at a time


@kernels
def test_wheels_rest_without_an_attitude():
    measurement = with_wheels((1.0, 0.0, 0.0))
    measurement.valid[3] = 0.0
    assert not called("wheel-pointing", measurement).any()


def test_desaturation_keeps_the_pointing():
    flight = TinyFlight(
        inertia=(5.0, 6.0, 4.0),
        inclination_deg=70.0,
        period_s=2.0,
        moment_max=20.0,
        residual_dipole=(0.5, -0.3, 0.4),
        fixed_torque=(2e-6, 0.0, 0.0),
    )
    flown = {}
    for cancel in (False, True):
        table = {"target": "nadir", "cancel_residual": cancel, "residual_std_a_m2": 0.5, "torque_noise_n_m": 1e-7}
        params = BOTH.pack(table, flight.context(1))
        start = (flight.nadir_quaternion(), (0.0, -flight.mean_motion, 0.0))
        flown[cancel] = flight.fly(BOTH, params, 3.0, *start, h=(0.4, -0.5, 0.3))
    for run in flown.values():
        size = np.linalg.norm(run["h"], axis=1)
        assert size[-1] < 0.05 * size[0]
    late = {cancel: flight.nadir_error_deg(run)[-3000:].max() for cancel, run in flown.items()}
    assert late[False] < 0.2 and late[True] < 0.05 * late[False]
