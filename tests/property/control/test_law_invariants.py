"""What holds for every law, whatever is measured."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import config
from scipy.spatial.transform import Rotation

from fieldline.control import LAWS
from fieldline.control.coils import dumping_moment
from law_tests import CONTEXT, PACKED, called, known_measurement, numbers_of

pytestmark = pytest.mark.kernels
component = st.floats(-1.0, 1.0).filter(lambda x: x == 0.0 or abs(x) > 1e-6)
vectors = st.tuples(component, component, component).filter(lambda v: np.linalg.norm(v) > 0.05)
# in plain Python a plan takes minutes; its kernels are called so by the tests of the horizon
NAMES = [name for name in sorted(LAWS) if not (config.DISABLE_JIT and name == "tracking-predictive")]
DIPOLE_LAWS = [name for name, law in LAWS.items() if "dipole" in law.commands]
quick = settings(max_examples=4 if config.DISABLE_JIT else 40, deadline=None)  # plain Python takes long over a regulator


def across(moment, field):
    """Part of the torque along the field, against what rounding may leave."""
    torque = np.cross(moment, field)
    return abs(torque @ field) <= 1e-12 * np.linalg.norm(moment) * np.linalg.norm(field) ** 2


@pytest.mark.parametrize("name", NAMES)
@given(field=vectors, omega=vectors, turn=vectors)
@quick
def test_commands_are_finite_and_of_their_length_and_torques_across_the_field(name, field, omega, turn):
    measurement = known_measurement(3e-5 * np.array(field), 0.05 * np.array(omega), Rotation.from_rotvec(turn).as_quat())
    measurement.wheel_momentum[:] = omega
    memory = np.zeros(LAWS[name].memory)
    for t in (0.0, 1.0):
        measurement.field_time_s[0] = t
        command = called(name, measurement, t, memory)
        assert command.shape == (numbers_of(name),) and np.isfinite(command).all()
        if name in DIPOLE_LAWS:
            assert across(command[:3], measurement.field_b)


@pytest.mark.parametrize("name", NAMES)
@given(data=st.data())
@quick
def test_no_reading_however_broken_makes_a_command_that_is_not_finite(name, data):
    broken = st.sampled_from([0.0, 1e-5, -3e-5, np.nan, np.inf, -np.inf])
    memory = np.zeros(LAWS[name].memory)
    for t in range(4):
        measurement = known_measurement(time_s=float(t))
        readings = (measurement.field_b, measurement.omega_bi_b, measurement.rate_b, measurement.q_bi, measurement.position_i)
        for values in (*readings, measurement.tension, measurement.line_length, measurement.line_rate):
            if data.draw(st.booleans()):
                values[data.draw(st.integers(0, values.size - 1))] = data.draw(broken)
        measurement.valid[data.draw(st.integers(0, 5))] = float(data.draw(st.booleans()))
        assert np.isfinite(called(name, measurement, float(t), memory)).all()
    assert np.isfinite(called(name, known_measurement(time_s=9.0), 9.0, memory)).all()
    assert np.isfinite(memory).all()


@pytest.mark.parametrize("name", ["b-dot", "b-dot-bang-bang"])
@given(field=vectors, omega=vectors)
@quick
def test_b_dot_never_gives_energy(name, field, omega):
    params = LAWS[name].pack({"derivative": "gyro"}, CONTEXT)
    field, omega = 3e-5 * np.array(field), 0.1 * np.array(omega)
    moment = called(name, known_measurement(field, omega), params=params)
    power = np.cross(moment, field) @ omega
    assert power <= 1e-12 * np.linalg.norm(moment) * np.linalg.norm(field) * np.linalg.norm(omega)


@given(field=vectors, momentum=vectors, gain=st.floats(1e-6, 1.0))
@quick
def test_dumping_never_adds_momentum(field, momentum, gain):
    field, momentum = 3e-5 * np.array(field), np.array(momentum)
    torque = np.cross(dumping_moment(tuple(field), tuple(momentum), gain), field)
    assert torque @ momentum <= 1e-12 * gain * (momentum @ momentum)
    assert abs(torque @ field) <= 1e-12 * gain * np.linalg.norm(momentum) * np.linalg.norm(field)


@pytest.mark.parametrize("name", NAMES)
def test_a_law_is_a_pure_function(name):
    measurement = known_measurement((2e-5, 1e-5, -1e-5), (0.01, -0.02, 0.03), (0.1, 0.2, -0.1, 0.9))
    before, params = [np.copy(m) for m in measurement], PACKED[name].copy()
    memories = [np.zeros(LAWS[name].memory) for _ in range(2)]
    first, second = (called(name, measurement, 5.0, memory) for memory in memories)
    assert np.array_equal(first, second) and np.array_equal(*memories)
    assert all(np.array_equal(a, b) for a, b in zip(before, measurement, strict=True)) and np.array_equal(params, PACKED[name])
