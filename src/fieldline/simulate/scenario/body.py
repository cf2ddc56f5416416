"""A body of a scenario: a vehicle, with where it starts and what it senses."""

from __future__ import annotations

from typing import Literal

from pydantic import Field, model_validator

from fieldline.records import Record, RecordError
from fieldline.records.values import Quaternion, Vector
from fieldline.sensing.sensors import DutyCycle, Gyro, Magnetometer, Navigation, Onboard, StarTracker, SunSensor
from fieldline.simulate.scenario.hang import Hang
from fieldline.simulate.scenario.orbit_start import OrbitStart
from fieldline.vehicle.vehicle import Vehicle

NONE = (0.0, 0.0, 0.0)
SENSORS = ("magnetometer", "gyro", "sun_sensor", "star_tracker", "navigation")
TURNING = (
    "attitude",
    "rate_deg_s",
    "rate_axes",
    "random_rate_deg_s",
    "magnetometer",
    "gyro",
    "sun_sensor",
    "star_tracker",
    "navigation",
    "onboard",
    "duty_cycle",
)  # what a point mass cannot have


class AttitudeStart(Record):
    """How a body is turned at the start: exactly one of the keys quaternion_bi, quaternion_bo, euler_321_deg and random."""

    quaternion_bi: Quaternion | None = Field(default=None, description="body to GCRS, scalar last")
    quaternion_bo: Quaternion | None = Field(default=None, description="body to orbital axes, scalar last")
    euler_321_deg: Vector | None = Field(default=None, description="yaw, pitch, roll from the chosen axes to the body [deg]")
    axes: Literal["gcrs", "orbital"] = Field(default="orbital", description="axes that euler_321_deg starts from")
    random: bool = Field(default=False, description="an attitude drawn evenly from all rotations, by the scenario's seed")

    @model_validator(mode="after")
    def _one_way(self):
        """Exactly one way of saying it."""
        ways = ("quaternion_bi", "quaternion_bo", "euler_321_deg", "random")
        given = [key for key in ways if getattr(self, key) not in (None, False)]
        if len(given) != 1:
            raise RecordError([("", f"give exactly one of {', '.join(ways)}; got {' and '.join(given) or 'none'}")])
        if self.axes != "orbital" and self.euler_321_deg is None:
            raise RecordError([("axes", "has a meaning for euler_321_deg alone; leave it out")])
        return self


class Body(Vehicle):
    """A vehicle, its start, its sensors. The first body starts on [orbit]."""

    attitude: AttitudeStart | None = Field(default=None, description="attitude at the start; along the orbital axes by default")
    rate_deg_s: Vector | None = Field(default=None, description="angular rate at the start, body axes [deg/s]; zero by default")
    rate_axes: Literal["gcrs", "orbital"] = Field(default="gcrs", description="axes against which rate_deg_s is counted")
    random_rate_deg_s: float | None = Field(
        default=None, gt=0.0, description="size of the angular rate at the start, its direction drawn by the seed [deg/s]"
    )
    orbit: OrbitStart | None = Field(default=None, description="orbit of its own; the first body has [orbit] of the scenario")
    offset_o_m: Vector | None = Field(
        default=None,
        description="place from the first body, its orbital axes: along the track, against the orbit normal, down [m]",
    )
    offset_rate_o_m_s: Vector = Field(default=NONE, description="rate of offset_o_m as seen in the turning orbital axes [m/s]")
    hang: Hang | None = Field(default=None, description="place at the end of a taut line whose other end is on an earlier body")
    magnetometer: Magnetometer | None = Field(default=None, description="three-axis magnetometer")
    gyro: Gyro | None = Field(default=None, description="rate gyro")
    sun_sensor: SunSensor | None = Field(default=None, description="sun sensors")
    star_tracker: StarTracker | None = Field(default=None, description="star tracker")
    navigation: Navigation | None = Field(
        default=None, description="position and velocity on board; the truth every second by default"
    )
    onboard: Onboard | None = Field(default=None, description="field model on board; that of the environment by default")
    duty_cycle: DutyCycle | None = Field(default=None, description="torquers off while the magnetometer is read")

    @model_validator(mode="after")
    def _one_start(self):
        """One rate, one place, and for a point mass nothing that turns or senses."""
        found = []
        if self.rate_deg_s is not None and self.random_rate_deg_s is not None:
            found.append(("", "give only one of rate_deg_s and random_rate_deg_s"))
        if self.rate_axes != "gcrs" and self.rate_deg_s is None:
            found.append(("rate_axes", "has a meaning for rate_deg_s alone; leave it out"))
        if sum(one is not None for one in (self.orbit, self.offset_o_m, self.hang)) > 1:
            found.append(("", "give only one of orbit, offset_o_m and hang"))
        if self.offset_rate_o_m_s != NONE and self.offset_o_m is None:
            found.append(("offset_rate_o_m_s", "has a meaning beside offset_o_m alone; give that too"))
        if self.duty_cycle is not None and not self.magnetorquer:
            found.append(("duty_cycle", "has a meaning for a body with [[body.magnetorquer]] alone"))
        if self.kind == "point":
            given = [key for key in TURNING if getattr(self, key) != type(self).model_fields[key].default]
            found += [(key, 'has no meaning for kind = "point"; leave it out') for key in given]
        if found:
            raise RecordError(found)
        return self
