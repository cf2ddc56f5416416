"""One set of SGP4 mean elements, as TLE and OMM carry it."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite, pi

import numpy as np

from fieldline.errors import InputError

SGP4_DAY_ZERO = np.datetime64("1949-12-31", "ns")
MINUTES_PER_DAY = 1440.0
SGP4_XP = "4"  # ephemeris type, in TLE and OMM, of elements that SGP4 cannot carry
REVOLUTIONS_PER_DAY_MAX = 18.0  # an orbit at the ground has 17


@dataclass(frozen=True, kw_only=True)
class ElementSet:
    """Mean elements (Brouwer, TEME axes) of one satellite at one epoch, in the units that their files use."""

    name: str
    norad_id: int
    epoch_utc: np.datetime64
    inclination_deg: float
    node_deg: float
    eccentricity: float
    perigee_deg: float
    anomaly_deg: float
    motion_rev_day: float
    half_motion_rate_rev_day2: float = 0.0  # half the rate: "MEAN_MOTION_DOT" of both formats
    sixth_motion_curvature_rev_day3: float = 0.0  # a sixth of the second derivative
    drag_per_radius: float = 0.0  # B*

    def __post_init__(self):
        limits = {
            "inclination_deg": (0.0, 180.0, "deg"),
            "node_deg": (-360.0, 360.0, "deg"),
            "perigee_deg": (-360.0, 360.0, "deg"),
            "anomaly_deg": (-360.0, 360.0, "deg"),
            "eccentricity": (0.0, 0.999999, ""),
            "motion_rev_day": (0.01, REVOLUTIONS_PER_DAY_MAX, "revolutions a day"),
            "half_motion_rate_rev_day2": (-100.0, 100.0, "rev/day^2"),
            "sixth_motion_curvature_rev_day3": (-1e4, 1e4, "rev/day^3"),
            "drag_per_radius": (-1e3, 1e3, "per Earth radius"),
        }
        for key, (low, high, unit) in limits.items():
            value = getattr(self, key)
            if not (isfinite(value) and low <= value <= high):
                raise InputError(f"{key} of {self.label} is {value:g} {unit}; it must lie within {low:g} and {high:g}.")

    @property
    def label(self) -> str:
        """Name and number, for messages."""
        return f"{self.name} (NORAD {self.norad_id})" if self.name else f"NORAD {self.norad_id}"

    def satrec(self):
        """The `sgp4` package's record of these elements, WGS72, improved mode."""
        from sgp4.api import WGS72, Satrec

        degree, revolution = pi / 180.0, 2.0 * pi
        record = Satrec()
        record.sgp4init(
            WGS72,
            "i",
            0,  # the catalogue number plays no part, and large ones do not fit
            (np.datetime64(self.epoch_utc, "ns") - SGP4_DAY_ZERO).astype(np.int64) / 86_400_000_000_000,
            self.drag_per_radius,
            self.half_motion_rate_rev_day2 * revolution / MINUTES_PER_DAY**2,
            self.sixth_motion_curvature_rev_day3 * revolution / MINUTES_PER_DAY**3,
            self.eccentricity,
            self.perigee_deg * degree,
            self.inclination_deg * degree,
            self.anomaly_deg * degree,
            self.motion_rev_day * revolution / MINUTES_PER_DAY,
            self.node_deg * degree,
        )
        return record
