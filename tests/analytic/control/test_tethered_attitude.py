"""A body that hangs on a line: its pendulum, w_p = sqrt(T d / I), damped by wheels, coils, jets and a moved attachment."""

from dataclasses import replace
from math import exp, pi, sqrt

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.control import LAWS
from fieldline.control.law import LineEnd
from fieldline.control.tethered_attitude import least_firings
from fieldline.errors import InputError
from fieldline.sensing.measurement import new_measurement
from fieldline.vehicle.thruster import Thruster
from tiny_flight import TinyFlight

CONTEXT = TinyFlight(inertia=(5.0, 6.0, 2.0), altitude_km=400.0, inclination_deg=70.0, period_s=1.0).context(orbits=1)

INERTIA = np.diag([6.0, 6.0, 4.0])
TENSION, ARM = 8.0, 0.5
PENDULUM = sqrt(TENSION * ARM / 6.0)
RADIUS, MOTION = 6_878_137.0, 1.1068e-3
JETS = [(p, d) for a in range(3) for s in (1.0, -1.0) for p, d in [(np.roll((1.0, 0, 0), a), np.roll((0, s, 0), a))]]
BODY = replace(
    CONTEXT,
    inertia_kg_m2=INERTIA,
    moment_max_a_m2=np.full(3, 100.0),
    thrusters=tuple(Thruster(position_b_m=tuple(p), direction_b=tuple(d), force_n=5.0) for p, d in JETS),
    lines=(LineEnd((0.0, 0.0, ARM), "", ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))),),
)
pytestmark = pytest.mark.kernels


class Hanging:
    """A rigid body under a line that pulls down with a constant force, at rest in orbital axes; field and jets as given."""

    def __init__(self, tilt, rate, field_o=(0.0, 0.0, 0.0)):
        self.turn, self.omega = Rotation.from_rotvec(tilt), np.array(rate, dtype=float)  # body to orbital axes
        self.field_o = np.array(field_o)
        self.measurement = new_measurement(0, 3, 1)
        self.measurement.valid[:] = 1.0
        self.measurement.field_time_s[0] = 0.0

    def look(self, tension=TENSION):
        """Measurement now; the orbital axes stand at x ahead = +y_i, down = -x_i."""
        m = self.measurement
        axes = np.column_stack([[0, 1, 0], [0, 0, -1], [-1, 0, 0]]).astype(float)
        m.position_i[:], m.velocity_i[:] = (RADIUS, 0, 0), (0, RADIUS * MOTION, 0)
        m.q_bi[:] = (Rotation.from_matrix(axes) * self.turn).as_quat()
        m.omega_bi_b[:] = self.omega + self.turn.inv().apply((0.0, -MOTION, 0.0))
        m.tension[0] = tension
        m.field_b[:] = self.turn.inv().apply(self.field_o)
        return m

    def move(self, dt, torque_b, shift_b=(0.0, 0.0, 0.0)):
        """A step of the pendulum, midpoint rule, the torque and the attachment held."""

        def change(turn, omega):
            pull = turn.inv().apply((0.0, 0.0, TENSION))
            total = torque_b + np.cross(np.array([0, 0, ARM]) + shift_b, pull)
            return np.linalg.solve(INERTIA, total - np.cross(omega, INERTIA @ omega))

        half = self.omega + 0.5 * dt * change(self.turn, self.omega)
        middle = self.turn * Rotation.from_rotvec(0.5 * dt * self.omega)
        self.omega = self.omega + dt * change(middle, half)
        self.turn = self.turn * Rotation.from_rotvec(dt * half)

    @property
    def tilt(self):
        """Angle between the lever and the line [rad]."""
        return float(np.arccos(np.clip(self.turn.apply((0, 0, 1))[2], -1.0, 1.0)))


def swung(name, table, body, seconds, dt=0.1, context=BODY):
    """(times, tilts, turn about the line) under a law that is called every step."""
    law = LAWS[name]
    params, memory = law.pack(table, context), np.zeros(law.memory)
    times, tilts, turns = np.arange(0.0, seconds, dt), [], []
    torques = np.array([np.cross(p, d) * 5.0 for p, d in JETS])
    for t in times:
        command = law.kernel(t, body.look(), memory, params)
        torque, shift = np.zeros(3), np.zeros(3)
        if name == "tether-wheels":
            torque = command
        elif name == "tether-torquers":
            torque = np.cross(command, body.measurement.field_b)
        elif name == "tether-thrusters":
            torque = command @ torques
        else:
            shift = np.array([*command, 0.0])
        tilts.append(body.tilt)
        turns.append(body.turn.as_rotvec()[2])
        body.move(dt, torque, shift)
    return times, np.array(tilts), np.array(turns)


def test_undamped_it_swings_at_the_pendulums_frequency():
    body = Hanging((0.05, 0, 0), (0, 0, 0))
    tilts = []
    for _ in range(600):
        tilts.append(body.turn.as_rotvec()[0])
        body.move(0.02, np.zeros(3))
    crossing = 0.02 * (np.flatnonzero(np.diff(np.sign(tilts))) + 0.5)
    assert np.diff(crossing).mean() == pytest.approx(pi / PENDULUM, rel=2e-3)


@pytest.mark.parametrize("name", ["tether-wheels", "tether-thrusters", "tether-attachment"])
def test_the_pendulum_has_the_damping_ratio_that_was_asked_for(name):
    """The tilt falls as exp(-z w_p t), in both directions across the line."""
    ratio = 0.15
    times, tilts, _ = swung(name, {"damping_ratio": ratio}, Hanging((0.04, 0.03, 0.0), (0, 0, 0)), 40.0, dt=0.05)
    peaks = [k for k in range(1, len(tilts) - 1) if tilts[k - 1] < tilts[k] > tilts[k + 1]]
    decay = -np.polyfit(times[peaks], np.log(tilts[peaks]), 1)[0]
    assert decay == pytest.approx(ratio * PENDULUM, rel=0.08)


def test_the_ratio_holds_whatever_the_tension():
    wheels = LAWS["tether-wheels"]
    params = wheels.pack({"damping_ratio": 0.2, "turn_frequency_rad_s": 0.0}, BODY)
    body = Hanging((0, 0, 0), (1e-3, 0, 0))
    for tension in (2.0, 8.0, 50.0):
        torque = wheels.kernel(0.0, body.look(tension), np.zeros(1), params)
        assert torque[0] == pytest.approx(-2.0 * 0.2 * sqrt(tension * ARM * 6.0) * 1e-3, rel=1e-9)


def test_the_field_damps_the_pendulum_and_holds_the_turn():
    body = Hanging((0.008, -0.006, 0.2), (0, 0, 0), field_o=(2.5e-5, 1.5e-5, -2e-5))
    table = {"damping_ratio": 0.1, "turn_frequency_rad_s": 0.02}
    _, tilts, turns = swung("tether-torquers", table, body, 500.0, dt=0.25)
    assert tilts[-80:].max() < 0.001 and np.abs(turns[-80:]).max() < 0.03


def test_wheels_hold_the_turn_about_the_line():
    body = Hanging((0.0, 0.0, 0.6), (0, 0, 0.01))
    _, tilts, turns = swung("tether-wheels", {"damping_ratio": 0.7, "turn_frequency_rad_s": 0.1}, body, 120.0)
    assert abs(turns[-1]) < 1e-3 and tilts[-1] < 1e-3


def test_a_slack_line_leaves_the_attachment_in_its_middle():
    law = LAWS["tether-attachment"]
    params, body = law.pack({}, BODY), Hanging((0, 0, 0), (0.1, 0, 0))
    assert np.all(law.kernel(0.0, body.look(0.0), np.zeros(1), params) == 0.0)
    assert np.any(law.kernel(0.0, body.look(1.0), np.zeros(1), params) != 0.0)


def test_thrusters_give_what_is_asked_for_and_no_more_than_they_can():
    shares = least_firings("tether-thrusters", BODY.thrusters)
    torques = np.array([np.cross(p, d) * 5.0 for p, d in JETS])
    np.testing.assert_allclose(shares @ torques, [s * np.eye(3)[a] for a in range(3) for s in (1, -1)], atol=1e-9)
    law, body = LAWS["tether-thrusters"], Hanging((0, 0, 0), (5.0, -3.0, 0.0))
    told = law.kernel(0.0, body.look(), np.zeros(1), law.pack({"damping_ratio": 2.0}, BODY))
    assert told.max() == pytest.approx(1.0) and told.min() >= 0.0
    assert np.cross(told @ torques, (-5.0, 3.0, 0.0)) == pytest.approx(np.zeros(3), abs=1e-3)


def test_what_cannot_swing_or_turn_is_refused():
    with pytest.raises(InputError, match="off the centre of mass"):
        LAWS["tether-wheels"].pack({}, replace(BODY, lines=(LineEnd((0.0, 0.0, 0.0)),)))
    with pytest.raises(InputError, match="1 to 1; got 2"):
        LAWS["tether-wheels"].pack({"line": 2}, BODY)
    useless = (Thruster(position_b_m=(1.0, 0, 0), direction_b=(1.0, 0, 0), force_n=1.0),)
    with pytest.raises(InputError, match="push through its centre of mass"):
        LAWS["tether-thrusters"].pack({}, replace(BODY, thrusters=useless))


def test_the_decay_of_the_closed_loop_is_that_of_its_equation():
    """One period of the damped pendulum leaves exp(-2 pi z / sqrt(1 - z^2))."""
    ratio, dt = 0.2, 0.02
    body = Hanging((0.03, 0, 0), (0, 0, 0))
    period = 2.0 * pi / (PENDULUM * sqrt(1.0 - ratio**2))
    swung("tether-wheels", {"damping_ratio": ratio}, body, period, dt=dt)
    left = body.turn.as_rotvec()[0] / 0.03
    assert left == pytest.approx(exp(-2.0 * pi * ratio / sqrt(1.0 - ratio**2)), rel=0.05)
