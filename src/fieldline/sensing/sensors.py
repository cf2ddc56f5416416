"""Sensors of a body as records: rates, errors and limits, in the units of data sheets, which the keys name.

A reading is gain @ truth + bias + noise, rounded to the quantum and cut at the range; zero switches an error off.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Field, WithJsonSchema, model_validator

from fieldline.records import Record, RecordError
from fieldline.records.values import IDENTITY, ROW, ZEROS, Direction, Gain, Spread, Tensor, Vector

NONE = (0.0, 0.0, 0.0)
SIX_FACES = ((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0))
MOST_FACES = 32


def _rate(what: str):
    """The key of a sampling rate."""
    return Field(gt=0.0, le=1e5, description=f"{what} per second [Hz]")


def _phase():
    """The key of a first sample's time."""
    return Field(default=0.0, ge=0.0, description="time of the first reading after the start [s]")


class Magnetometer(Record):
    """A three-axis magnetometer: reading = gain @ (field + coupling @ dipole) + bias + noise, rounded and cut."""

    rate_hz: float = _rate("readings")
    phase_s: float = _phase()
    bias_nt: Vector = Field(default=NONE, description="constant offset, body axes [nT]")
    gain: Gain = Field(default=IDENTITY, description="scale and misalignment [-]: a diagonal or (3, 3); 1 is perfect")
    noise_std_nt: Spread = Field(default=NONE, description="standard deviation of white noise on each reading [nT]")
    quantum_nt: float = Field(default=0.0, ge=0.0, description="step of the reading [nT]; 0: continuous")
    range_nt: float = Field(default=0.0, ge=0.0, description="largest reading of an axis [nT]; 0: no limit")
    torquer_coupling_nt_a_m2: Tensor = Field(
        default=ZEROS, description="field at the sensor per dipole of the torquers [nT/(A m^2)]: a diagonal or (3, 3)"
    )


class Gyro(Record):
    """A three-axis rate gyro: reading = gain @ rate + bias(t) + noise, rounded and cut."""

    rate_hz: float = _rate("readings")
    phase_s: float = _phase()
    bias_deg_s: Vector = Field(default=NONE, description="offset at the start, body axes [deg/s]")
    bias_walk_deg_s_sqrt_s: Spread = Field(
        default=NONE, description="random walk of the offset, standard deviation after 1 s [deg/s]"
    )
    gain: Gain = Field(default=IDENTITY, description="scale and misalignment [-]: a diagonal or (3, 3); 1 is perfect")
    noise_std_deg_s: Spread = Field(default=NONE, description="standard deviation of white noise on each reading [deg/s]")
    quantum_deg_s: float = Field(default=0.0, ge=0.0, description="step of the reading [deg/s]; 0: continuous")
    range_deg_s: float = Field(default=0.0, ge=0.0, description="largest reading of an axis [deg/s]; 0: no limit")


def _directions(value):
    """A list of faces, before each is looked at."""
    if not isinstance(value, list | tuple) or not 1 <= len(value) <= MOST_FACES:
        raise ValueError(f"must be a list of 1 to {MOST_FACES} directions [x, y, z]")
    return tuple(value)


class SunSensor(Record):
    """Sun sensors on faces: each reads the cosine of the Sun's angle to its normal, 1 at normal incidence, 0 in shadow."""

    rate_hz: float = _rate("readings")
    phase_s: float = _phase()
    normals_b: Annotated[
        tuple[Direction, ...],
        Field(strict=False),
        BeforeValidator(_directions),
        WithJsonSchema({"type": "array", "items": ROW, "minItems": 1, "maxItems": MOST_FACES}),
    ] = Field(default=SIX_FACES, description="outward normals of the faces, body axes; six faces of a box by default")
    field_of_view_deg: float = Field(
        default=90.0, gt=0.0, le=90.0, description="largest angle from the normal that is seen [deg]"
    )
    albedo: float = Field(
        default=0.0, ge=0.0, le=1.0, description="share of sunlight that the Earth throws back; 0.3 in the mean [-]"
    )
    noise_std: float = Field(
        default=0.0, ge=0.0, lt=1.0, description="standard deviation of white noise, 1 at normal incidence [-]"
    )


class StarTracker(Record):
    """A star tracker: attitude with small errors, none while the body turns too fast or the Sun is too near its boresight."""

    rate_hz: float = _rate("attitudes")
    phase_s: float = _phase()
    offset_arcsec: Vector = Field(default=NONE, description="constant error about each body axis [arcsec]")
    noise_std_arcsec: Spread = Field(default=NONE, description="standard deviation of the error about each body axis [arcsec]")
    boresight_b: Direction = Field(default=(0.0, 0.0, 1.0), description="where it looks, body axes")
    rate_max_deg_s: float = Field(default=0.0, ge=0.0, description="rate above which it gives nothing [deg/s]; 0: no limit")
    sun_exclusion_deg: float = Field(
        default=0.0, ge=0.0, lt=180.0, description="angle to the Sun below which it gives nothing [deg]"
    )
    earth_exclusion_deg: float = Field(
        default=0.0,
        ge=0.0,
        lt=180.0,
        description="angle to the Earth's limb below which it gives nothing [deg]; 0: the Earth itself",
    )


class Navigation(Record):
    """Position and velocity as known on board: the truth with an offset in orbital axes and noise."""

    rate_hz: float = Field(default=1.0, gt=0.0, le=1e5, description="updates per second [Hz]")
    phase_s: float = _phase()
    position_offset_o_m: Vector = Field(
        default=NONE, description="constant error: along the track, against the orbit normal, down [m]"
    )
    position_noise_std_m: Spread = Field(
        default=NONE, description="standard deviation of white noise on each position, GCRS axes [m]"
    )
    velocity_noise_std_m_s: Spread = Field(default=NONE, description="standard deviation of white noise on each velocity [m/s]")
    relative_position_noise_std_m: Spread = Field(
        default=NONE, description="standard deviation of white noise on the place from the first body, GCRS axes [m]"
    )
    relative_velocity_noise_std_m_s: Spread = Field(
        default=NONE, description="standard deviation of white noise on the velocity from the first body [m/s]"
    )


class Onboard(Record):
    """The field model that flies on board: what laws and estimators take for the truth."""

    field: str = Field(default="IGRF-14", min_length=1, description="name of the field model (`fieldline models` lists them)")
    field_degree: int | None = Field(default=None, ge=1, le=200, description="highest degree of its harmonics; all by default")


class DutyCycle(Record):
    """Torquers and magnetometer in turn: torquers may be on in the first part of each period and are off in the rest."""

    period_s: float = Field(gt=0.0, description="length of a period [s]")
    torque_on_s: float = Field(gt=0.0, description="time from the period's start in which torquers may be on [s]")

    @model_validator(mode="after")
    def _leaves_time(self):
        """Some of the period is left for the magnetometer."""
        if self.torque_on_s >= self.period_s:
            limit = f"must be less than period_s, {self.period_s:g}, or no time is left to read the field"
            raise RecordError([("torque_on_s", f"{limit}; got {self.torque_on_s:g}")])
        return self
