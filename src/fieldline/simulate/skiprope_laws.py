"""Laws against a skiprope that hear it in the loop: by the yaw of a body whose tether leaves it off its axis, by a current.

    skiprope-yaw        listens, plans (`control.skiprope_yaw`), yaws by its wheels, listens again
    skiprope-current    listens with no current, damps (`control.skiprope_current`), listens again

Both are plain Python: an estimate is made every few minutes, of the magnetometer of the own body, or of the body at the other
end of its first line where the own one has none.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fieldline.control import DesignContext, Parameter
from fieldline.control.law import complete
from fieldline.control.skiprope_current import HalfWave, damping_current, push_per_ampere
from fieldline.control.skiprope_yaw import YawPlan, plan_yaw, yaw_by
from fieldline.errors import InputError
from fieldline.frames.orbital import dcm_oi
from fieldline.sensing.measurement import ATTITUDE, ORBIT, RATE, Measurement
from fieldline.simulate.estimators import Estimator

_COMMON = {
    "listen_s": Parameter("s", "time over which it listens before it acts, and again after", 2000.0, "positive"),
    "retry_s": Parameter("s", "until it tries again where nothing could be trusted", 300.0, "positive"),
    "stop_below_m": Parameter("m", "deflection below which it leaves the skiprope alone", 0.5, "not negative"),
    "swing_hz": Parameter("Hz", "of the satellite's swing on its tether, taken off the deflection; 0: none", 0.0, "not negative"),
    "tether": Parameter("", "the way it leaves the satellite with the magnetometer", "down", "choice", choices=("down", "up")),
    "azimuth_off_deg": Parameter("deg", "turned into the estimate's azimuth, to see what errors do", 0.0),
    "deflection_off": Parameter("", "share added to the estimate's deflection, to see what errors do", 0.0),
}
YAW_PARAMETERS = {
    **_COMMON,
    "lead_s": Parameter("s", "from the decision to the earliest start", 60.0, "positive"),
    "ramp_s": Parameter("s", "in which the body reaches the skiprope's rate", 40.0, "positive"),
    "turns_max": Parameter("", "most turns of one yaw", 6.0, "positive"),
    "natural_frequency_rad_s": Parameter("rad/s", "of the attitude control of each axis", 0.1, "positive"),
    "damping_ratio": Parameter("", "of it", 0.7, "positive"),
}
CURRENT_PARAMETERS = {
    **_COMMON,
    "act_s": Parameter("s", "time over which the current flows before it listens again", 600.0, "positive"),
    "mass_per_length_kg_m": Parameter("kg/m", "mu of the tether", kind="positive"),
    "current_max_a": Parameter("A", "largest current", 0.2, "positive"),
    "gain_per_s": Parameter("1/s", "rate at which the swing along the push dies, below the largest current", 0.01, "positive"),
}


class _Hearing:
    """What both laws do: listen, and decide when it is time. `sensed` is set by the assembly, before the first call."""

    hears = True

    def __init__(self, values: dict):
        from fieldline.simulate.skiprope_watch import SkipropeWatch

        self.values = values
        self.watch = SkipropeWatch(tether=values["tether"], swing_hz=values["swing_hz"])
        self.sensed: Measurement | None = None
        self.decide_s = values["listen_s"]

    def heard(self, t: float, own: Measurement):
        """A trusted estimate when one is due and worth acting on."""
        if t < self.decide_s:
            return None
        self.decide_s = t + self.values["retry_s"]
        found = self.watch.estimate(own, float(own.line_length[0]))
        if found is None or found.now.deflection_m < self.values["stop_below_m"]:
            return None
        return found

    def listen_again(self, t: float) -> None:
        """Forget what was heard, and decide after the next stretch."""
        self.watch.clear()
        self.decide_s = t + self.values["listen_s"]


class SkipropeYaw(_Hearing):
    """Torque of the wheels [N m]: nadir pointing with a yaw that follows the plan."""

    def __init__(self, values: dict, context: DesignContext):
        super().__init__(values)
        point = np.array(context.lines[0].point_b_m if context.lines else (0.0, 0.0, 0.0), dtype=float)
        if not np.hypot(point[0], point[1]) > 0.0:
            raise InputError(
                'the law "skiprope-yaw" needs a line that leaves the body off its yaw axis z: give from_point_b_m or '
                "to_point_b_m an x or y."
            )
        self.point_b = point
        self.arm_m = float(np.hypot(point[0], point[1]))
        self.azimuth = float(np.arctan2(-point[0], -point[1]))  # from V = -y_o towards -U = -x_o
        self.inertia, self.wheels = np.asarray(context.inertia_kg_m2, dtype=float), context.wheel_axes_b
        self.plan: YawPlan | None = None
        self.turned = 0.0  # azimuth of all yaws that are over

    def __call__(self, t, own, memory, params):
        """One call; see the module."""
        azimuth, rate, acceleration = self.turned, 0.0, 0.0
        if self.plan is None:
            self.watch.hear(self.sensed, own)
            self._decide(t, own)
        else:
            by, rate, acceleration = yaw_by(self.plan, t, self.values["ramp_s"])
            azimuth = self.turned + by
            if t > self.plan.stop_s + self.values["ramp_s"]:
                self.turned, self.plan = azimuth, None
                self.listen_again(t)
        return self.torque(own, -azimuth, -rate, -acceleration)

    def _decide(self, t: float, own: Measurement) -> None:
        found = self.heard(t, own)
        if found is None or found.now.sense == 0:
            return
        off = np.radians(self.values["azimuth_off_deg"])
        size = (1.0 + self.values["deflection_off"]) * found.now.deflection_m
        now = found.now._replace(azimuth_rad=found.now.azimuth_rad + off, deflection_m=size)
        plan = plan_yaw(now, arm_m=self.arm_m, arm_azimuth_rad=self.azimuth + self.turned, not_before_s=t + self.values["lead_s"])
        longest = self.values["turns_max"] * 2.0 * np.pi / abs(plan.rate_rad_s)
        self.plan = plan._replace(stop_s=min(plan.stop_s, plan.start_s + longest))

    def torque(self, own: Measurement, yaw: float, rate: float, acceleration: float) -> np.ndarray:
        """Proportional and rate torque towards nadir axes yawed by an angle [rad] about z, with all that is known ahead."""
        if not (own.valid[ATTITUDE] > 0.5 and own.valid[RATE] > 0.5 and own.valid[ORBIT] > 0.5):
            return np.zeros(3)
        orbital = dcm_oi(own.position_i, own.velocity_i)
        c, s = np.cos(yaw), np.sin(yaw)
        goal = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) @ orbital
        error = _dcm_bi(own.q_bi) @ goal.T
        theta = 0.5 * np.array([error[1, 2] - error[2, 1], error[2, 0] - error[0, 2], error[0, 1] - error[1, 0]])
        turning = np.cross(own.position_i, own.velocity_i) / float(own.position_i @ own.position_i)
        wished = error @ (goal @ turning + np.array([0.0, 0.0, rate]))
        omega, w = own.omega_bi_b, self.values["natural_frequency_rad_s"]
        wish = -(w**2) * theta - 2.0 * self.values["damping_ratio"] * w * (omega - wished)
        wish = wish + error @ np.array([0.0, 0.0, acceleration])
        momentum = self.wheels.T @ own.wheel_momentum[: len(self.wheels)]
        pull = own.tension[0] * (error @ goal @ (own.position_i / np.linalg.norm(own.position_i)))
        if self.values["tether"] == "up":
            pull = -pull
        return self.inertia @ wish + np.cross(omega, self.inertia @ omega + momentum) - np.cross(self.point_b, pull)


class SkipropeCurrent(_Hearing):
    """Current up the tether [A]."""

    def __init__(self, values: dict, context: DesignContext):
        super().__init__(values)
        self.wave: HalfWave | None = None
        self.push = np.zeros(2)
        self.stop_s = 0.0

    def __call__(self, t, own, memory, params):
        """One call; see the module."""
        if self.wave is None:
            self.watch.hear(self.sensed, own)
            found = self.heard(t, own)
            if found is None:
                return np.zeros(1)
            self.wave, self.push, self.stop_s = self._mistaken(found.wave), np.zeros(2), t + self.values["act_s"]
        self.wave.carried(t, self.push)
        if t >= self.stop_s:
            self.wave = None
            self.listen_again(t)
            return np.zeros(1)
        push = push_per_ampere(own.position_i, own.velocity_i, own.field_i, self.values["mass_per_length_kg_m"])
        current = damping_current(self.wave, push, self.values["gain_per_s"], self.values["current_max_a"])
        self.push = current * push
        return np.array([current])

    def _mistaken(self, wave: HalfWave) -> HalfWave:
        """The wave with the errors that are asked for; azimuth runs from V towards -U."""
        angle, size = np.radians(self.values["azimuth_off_deg"]), 1.0 + self.values["deflection_off"]
        turn = size * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        return HalfWave(wave.seconds, wave.rate_rad_s, turn @ wave.place_m, turn @ wave.speed_m_s)


def _dcm_bi(q) -> np.ndarray:
    """(3, 3) from inertial to body axes, of a quaternion q_bi (scalar last) that turns body components to inertial ones."""
    x, y, z, w = np.asarray(q, dtype=float) / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)],
            [2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)],
            [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _yaw(table: Mapping, context: DesignContext) -> SkipropeYaw:
    return SkipropeYaw(complete("skiprope-yaw", YAW_PARAMETERS, table), context)


def _current(table: Mapping, context: DesignContext) -> SkipropeCurrent:
    return SkipropeCurrent(complete("skiprope-current", CURRENT_PARAMETERS, table), context)


HEARING_LAWS: dict[str, Estimator] = {
    one.name: one
    for one in (
        Estimator(
            "skiprope-yaw",
            YAW_PARAMETERS,
            "listens to a skiprope and yaws it out of the tether by the body's wheels",
            _yaw,
            ("wheel_torque",),
        ),
        Estimator(
            "skiprope-current",
            CURRENT_PARAMETERS,
            "listens to a skiprope and damps it by a current along the tether",
            _current,
            ("current",),
        ),
    )
}
