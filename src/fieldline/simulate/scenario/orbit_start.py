"""Where a body starts: a TLE, elements, a state, or a named orbit."""

from __future__ import annotations

from math import hypot, sqrt
from typing import Literal

from pydantic import Field, model_validator

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2
from fieldline.records import Record, RecordError
from fieldline.records.values import Vector

RADIUS_KM = 1e-3 * EARTH_EQUATORIAL_RADIUS_M
LOWEST_KM = 90.0  # below it the air ends every orbit within one turn
HIGHEST_KM = 1e6
SUN_SYNCHRONOUS_HIGHEST_KM = 5900.0  # above it no inclination turns the node with the Sun


def too_low(perigee_km: float) -> str | None:
    """Why a height over the equatorial radius [km] is no orbit, or None."""
    if perigee_km >= LOWEST_KM:
        return None
    where = "inside the Earth" if perigee_km < 0.0 else "in the air"
    return f"has its perigee at {perigee_km:.6g} km altitude, {where}; an orbit stays above {LOWEST_KM:g} km"


class Elements(Record):
    """Osculating Keplerian elements at the start, equator and equinox of the GCRS axes."""

    semi_major_axis_km: float | None = Field(
        default=None, gt=0.0, le=HIGHEST_KM, description="semi-major axis [km]; this or altitude_km"
    )
    altitude_km: float | None = Field(
        default=None, le=HIGHEST_KM, description="semi-major axis less the Earth's equatorial radius, 6378.1366 km [km]"
    )
    eccentricity: float = Field(default=0.0, ge=0.0, lt=1.0, description="eccentricity [-]")
    inclination_deg: float = Field(ge=0.0, le=180.0, description="inclination [deg]")
    raan_deg: float = Field(default=0.0, ge=-360.0, le=360.0, description="right ascension of the ascending node [deg]")
    argument_of_perigee_deg: float = Field(default=0.0, ge=-360.0, le=360.0, description="argument of perigee [deg]")
    true_anomaly_deg: float | None = Field(
        default=None, ge=-360.0, le=360.0, description="true anomaly [deg]; one of three, or 0"
    )
    mean_anomaly_deg: float | None = Field(default=None, ge=-360.0, le=360.0, description="mean anomaly [deg]")
    argument_of_latitude_deg: float | None = Field(
        default=None, ge=-360.0, le=360.0, description="angle from the ascending node to the body [deg]"
    )

    @model_validator(mode="after")
    def _an_orbit(self):
        """One size, one place along the orbit, and a perigee above the ground."""
        found = []
        if (self.semi_major_axis_km is None) == (self.altitude_km is None):
            found.append(("", "give exactly one of semi_major_axis_km and altitude_km"))
        places = ("true_anomaly_deg", "mean_anomaly_deg", "argument_of_latitude_deg")
        given = [key for key in places if getattr(self, key) is not None]
        if len(given) > 1:
            found.append(("", f"give only one of {' and '.join(given)}"))
        if not found and (low := too_low(self.axis_km * (1.0 - self.eccentricity) - RADIUS_KM)):
            key = "altitude_km" if self.semi_major_axis_km is None else "semi_major_axis_km"
            metres = " Is it in metres?" if self.axis_km > 1e5 else ""
            found.append((key, f"with eccentricity {self.eccentricity:g} {low}.{metres}"))
        if found:
            raise RecordError(found)
        return self

    @property
    def axis_km(self) -> float:
        """Semi-major axis [km]."""
        return self.semi_major_axis_km or RADIUS_KM + (self.altitude_km or 0.0)


class State(Record):
    """Position and velocity at the start."""

    position_km: Vector = Field(description="position from the Earth's centre [km]")
    velocity_km_s: Vector = Field(description="velocity [km/s]; for itrs relative to the turning Earth")
    axes: Literal["gcrs", "itrs"] = Field(default="gcrs", description="inertial (GCRS) or Earth-fixed (ITRS) axes")

    @model_validator(mode="after")
    def _above_ground(self):
        """A radius outside the Earth, a speed that stays bound, and, where the axes are inertial, a perigee above the ground."""
        radius, speed = hypot(*self.position_km), hypot(*self.velocity_km_s)
        escape = sqrt(2e-9 * EARTH_GM_M3_S2 / max(radius, 1.0))
        guess = " Is it in metres?" if radius > HIGHEST_KM else ""
        if not RADIUS_KM + LOWEST_KM <= radius <= HIGHEST_KM:
            text = (
                f"must lie {RADIUS_KM + LOWEST_KM:.6g} to {HIGHEST_KM:g} km from the Earth's centre; got {radius:.6g} km.{guess}"
            )
            raise RecordError([("position_km", text)])
        if speed >= 1.05 * escape or (self.axes == "gcrs" and speed >= escape):
            text = f"must be below the speed of escape, {escape:.6g} km/s at that radius; got {speed:.6g} km/s"
            raise RecordError([("velocity_km_s", text + (". Is it in metres per second?" if speed > 100.0 else ""))])
        if self.axes == "gcrs" and (low := too_low(self._perigee_km())):
            raise RecordError([("velocity_km_s", f"gives an orbit that {low}")])
        return self

    def _perigee_km(self) -> float:
        """Height of the perigee over the equatorial radius [km], from energy and angular momentum."""
        (x, y, z), (u, v, w) = self.position_km, self.velocity_km_s
        gm = 1e-9 * EARTH_GM_M3_S2
        axis = 1.0 / (2.0 / hypot(x, y, z) - (u * u + v * v + w * w) / gm)
        momentum = hypot(y * w - z * v, z * u - x * w, x * v - y * u)
        return axis * (1.0 - sqrt(max(0.0, 1.0 - momentum * momentum / (gm * axis)))) - RADIUS_KM


class SunSynchronous(Record):
    """A circular orbit whose node turns with the mean Sun: the inclination follows from the altitude."""

    altitude_km: float = Field(
        ge=LOWEST_KM, le=SUN_SYNCHRONOUS_HIGHEST_KM, description="semi-major axis less the equatorial radius, 6378.1366 km [km]"
    )
    local_time_h: float = Field(ge=0.0, le=24.0, description="mean local solar time of the ascending node [h]: 10.5 is 10:30")
    argument_of_latitude_deg: float = Field(
        default=0.0, ge=-360.0, le=360.0, description="angle from the ascending node to the body at the start [deg]"
    )


class OrbitStart(Record):
    """Where a body starts: exactly one of tle, elements, state and sun_synchronous."""

    tle: str | None = Field(
        default=None,
        min_length=1,
        description="file of a TLE, OMM or OEM, relative to the scenario file; or the two lines themselves",
    )
    norad_id: int | None = Field(default=None, ge=1, description="which satellite, where the file holds several")
    elements: Elements | None = Field(default=None, description="Keplerian elements")
    state: State | None = Field(default=None, description="position and velocity")
    sun_synchronous: SunSynchronous | None = Field(default=None, description="a sun-synchronous orbit by altitude and local time")

    @model_validator(mode="after")
    def _one_way(self):
        """Exactly one way of saying it."""
        ways = ("tle", "elements", "state", "sun_synchronous")
        given = [key for key in ways if getattr(self, key) is not None]
        if len(given) != 1:
            raise RecordError([("", f"give exactly one of {', '.join(ways)}; got {' and '.join(given) or 'none'}")])
        if self.norad_id is not None and self.tle is None:
            raise RecordError([("norad_id", "has no meaning without tle; leave it out")])
        return self
