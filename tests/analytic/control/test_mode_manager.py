"""Modes of the law from tumbling to pointing: when they change, when they do not, and what is commanded in each."""

import numpy as np
import pytest

from fieldline.control import LAWS
from fieldline.control.mode_manager import DETUMBLE, MODE, POINT
from fieldline.errors import InputError
from fieldline.sensing.measurement import ATTITUDE, RATE
from law_tests import CONTEXT, known_measurement

LAW = LAWS["magnetic-modes"]
FIELD = np.array([2e-5, -1e-5, 1.5e-5])
TABLE = {"pointing": "magnetic-pd", "point_below_deg_s": 0.5, "detumble_above_deg_s": 1.0, "rate_time_s": 20.0, "dwell_s": 30.0}


class Ride:
    """Calls of the law every second in a field that turns about z by a given rate."""

    def __init__(self, **more):
        self.memory, self.params = np.zeros(LAW.memory), LAW.pack(TABLE | more, CONTEXT)
        self.t, self.angle = 0.0, 0.0

    def on(self, seconds, rate_deg_s, known=True):
        """The last command after some seconds."""
        for _ in range(int(seconds)):
            self.t += 1.0
            self.angle += np.radians(rate_deg_s)
            c, s = np.cos(self.angle), np.sin(self.angle)
            field = (c * FIELD[0] - s * FIELD[1], s * FIELD[0] + c * FIELD[1], FIELD[2])
            measurement = known_measurement(field_b=field, q_bi=(0.1, 0.0, 0.0, 1.0), time_s=self.t)
            measurement.valid[[ATTITUDE, RATE]] = float(known)
            command = LAW.kernel(self.t, measurement, self.memory, self.params)
        return command

    @property
    def mode(self):
        return self.memory[MODE]


@pytest.mark.kernels
def test_modes_have_hysteresis():
    ride = Ride()
    ride.on(200, 3.0)
    assert ride.mode == DETUMBLE
    ride.on(200, 0.7)  # between the thresholds: nothing changes
    assert ride.mode == DETUMBLE
    ride.on(200, 0.2)
    assert ride.mode == POINT
    ride.on(200, 0.7)
    assert ride.mode == POINT
    ride.on(200, 3.0)
    assert ride.mode == DETUMBLE


@pytest.mark.kernels
def test_no_attitude_no_pointing():
    ride = Ride()
    ride.on(200, 0.1, known=False)
    assert ride.mode == DETUMBLE
    ride.on(20, 0.1)  # known, but not for dwell_s
    assert ride.mode == DETUMBLE
    ride.on(20, 0.1)
    assert ride.mode == POINT
    ride.on(30, 0.1, known=False)  # missing for less than patience_s
    assert ride.mode == POINT
    ride.on(40, 0.1, known=False)
    assert ride.mode == DETUMBLE


@pytest.mark.kernels
def test_each_mode_commands_its_law_and_a_duty_cycle_divides():
    slowing, whole, part = Ride(), Ride(), Ride(duty_cycle=0.5)
    plain = LAWS["b-dot"].kernel
    memory, params = np.zeros(LAWS["b-dot"].memory), LAWS["b-dot"].pack({}, CONTEXT)
    for t in (1.0, 2.0):
        measurement = known_measurement(field_b=FIELD * (1.0 + 0.1 * t), time_s=t)
        wanted = plain(t, measurement, memory, params)
        got = LAW.kernel(t, measurement, slowing.memory, slowing.params)
    assert np.linalg.norm(wanted) > 0.0 and np.array_equal(got, wanted)
    assert np.allclose(part.on(60, 0.0), 2.0 * whole.on(60, 0.0)) and whole.mode == part.mode == POINT


def test_parameters_of_another_pointing_law_are_refused():
    with pytest.raises(InputError, match='angle_deg of the law "magnetic-modes" has no meaning with pointing = "magnetic-pd"'):
        LAW.pack(TABLE | {"angle_deg": 3.0}, CONTEXT)
    with pytest.raises(InputError, match=r"detumble_above_deg_s .* must not be below point_below_deg_s; got 0.1"):
        LAW.pack(TABLE | {"detumble_above_deg_s": 0.1}, CONTEXT)
