"""What a coning body's magnetometer says once the known field is taken out of it: three harmonics.

        W, axis of the cone
        |
        |      B          elevation EL: of B above the U-V plane
        |    / :          azimuth AZ: of B's shadow on that plane, counted from V towards -U
        |  /   :
        |/_____:___ V     B = |B| (-cos EL sin AZ, cos EL cos AZ, sin EL)     in axes (U, V, W)               (4)
       /
      U

U along the velocity, V along the orbit's normal, W up; in Fieldline's orbital axes U = x_o, V = -y_o, W = -z_o. For any
other cone, W is its axis and U any direction across it (`coning.axes_about`). The body's axes S lie near (U, V, W), turned
by a small constant yaw a3 and by the coning angles

    a2 = a_M sin(w t),   a1 = a_M cos(w t),   i_S3 = a2 i_U - a1 i_V + i_W                                     (2), (3)

With the field's geometry known, the field measured along S leaves, to first order and but for a3,

    C1 = (B_S1 + B cos EL sin AZ) / B            = a_M sin EL cos(w t + pi/2)
    C2 = (B_S2 - B cos EL cos AZ) / B            = a_M sin EL cos(w t)                                              (7)
    C3 = (B_S3 - B sin EL) / (B cos EL)          = a_M cos(w t - AZ - pi)

C3 is singular where the field lies along the cone's axis, C1 and C2 vanish where it is across it.

Source: Polites (1991), NASA TP-3123, section II; its equation numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, NoEstimateError

ORBITAL_FROM_CONE = np.diag([1.0, -1.0, -1.0])  # v_o = ORBITAL_FROM_CONE @ v_c, and back with the same matrix


class FieldGeometry(NamedTuple):
    """The known field in the axes of the cone: |B| [T], elevation and azimuth [rad], each (n,)."""

    magnitude_tesla: np.ndarray
    elevation_rad: np.ndarray
    azimuth_rad: np.ndarray


@dataclass(frozen=True)
class SkipropeSignals:
    """What every estimator of the skiprope takes: n good samples in rising time. Made by `skiprope_signals`.

    seconds (n,) [s]; field_b (n, 3) [T] as measured, body axes near (U, V, W); geometry: the known field's, (n,) each.
    """

    seconds: np.ndarray
    field_b: np.ndarray
    geometry: FieldGeometry

    @cached_property
    def corrected(self) -> np.ndarray:
        """(n, 3) [rad] C1, C2, C3 of (7)."""
        return corrected_signals(self.field_b, self.geometry)

    @cached_property
    def direction_c(self) -> np.ndarray:
        """(n, 3) unit vectors of the known field, axes (U, V, W)."""
        return field_vector(self.geometry._replace(magnitude_tesla=np.ones_like(self.geometry.magnitude_tesla)))

    @cached_property
    def direction_b(self) -> np.ndarray:
        """(n, 3) unit vectors of the measured field, body axes."""
        return self.field_b / np.linalg.norm(self.field_b, axis=1, keepdims=True)

    @cached_property
    def step_s(self) -> float:
        """[s] between samples, the median."""
        return float(np.median(np.diff(self.seconds))) if len(self.seconds) > 1 else np.inf

    @property
    def span_s(self) -> float:
        """[s] from the first sample to the last."""
        return float(self.seconds[-1] - self.seconds[0])

    @cached_property
    def longest_gap_s(self) -> float:
        """[s] between two neighbouring samples, at most."""
        return float(np.diff(self.seconds).max()) if len(self.seconds) > 1 else 0.0

    def turned(self, yaw_rad) -> SkipropeSignals:
        """The same with the known field in axes turned by yaw [rad] about W, one number or (n,): those of a body so yawed."""
        size, elevation, azimuth = self.geometry
        return SkipropeSignals(self.seconds, self.field_b, FieldGeometry(size, elevation, azimuth - yaw_rad))

    def between(self, first_s: float, last_s: float) -> SkipropeSignals:
        """The samples from first_s to last_s [s], both included."""
        kept = (self.seconds >= first_s) & (self.seconds <= last_s)
        return SkipropeSignals(self.seconds[kept], self.field_b[kept], FieldGeometry(*(x[kept] for x in self.geometry)))

    def thinned(self, width_s: float) -> SkipropeSignals:
        """Means of both fields over bins of as many whole steps as `width_s` [s] holds; the same where it holds one."""
        many = int(width_s / self.step_s + 1e-6)
        if many < 2:
            return self
        width_s = many * self.step_s
        place = ((self.seconds - self.seconds[0]) / width_s + 1e-6).astype(int)
        count = np.bincount(place)
        kept = count > 0

        def mean(x):
            return np.bincount(place, x)[kept] / count[kept]

        measured, known = (np.stack([mean(x) for x in rows.T], axis=1) for rows in (self.field_b, field_vector(self.geometry)))
        start = self.seconds[0]
        return SkipropeSignals(start + mean(self.seconds - start), measured, field_geometry(known))


def skiprope_signals(seconds, field_b, field_c) -> SkipropeSignals:
    """Signals from times (n,) [s], the measured field (n, 3) [T], body axes, and the known one (n, 3) [T], axes (U, V, W).

    Samples that are not finite, or without any field, are left out. For orbital axes field_c = field_o @ ORBITAL_FROM_CONE.

    Errors: InputError for shapes that do not fit or times that do not rise; NoEstimateError where fewer than 8 are left.
    """
    measured, known = _rows("field_b", field_b), _rows("field_c", field_c)
    times = np.asarray(seconds, dtype=float)
    if times.ndim != 1 or not len(times) == len(measured) == len(known):
        raise InputError(
            "seconds (n,), field_b and field_c (n, 3) must have one row for each sample; "
            f"got {times.shape}, {measured.shape}, {known.shape}."
        )
    with np.errstate(invalid="ignore"):
        sizes = (np.linalg.norm(measured, axis=1), np.linalg.norm(known, axis=1))
    good = np.isfinite(times) & np.isfinite(sizes[0]) & np.isfinite(sizes[1]) & (sizes[0] > 0.0) & (sizes[1] > 0.0)
    if good.sum() < 8:
        raise NoEstimateError(f"only {int(good.sum())} of {len(times)} samples hold both a measured and a known field.")
    times = times[good]
    if not (np.diff(times) > 0.0).all():
        raise InputError("seconds must rise from sample to sample; sort the rows and drop repeats first.")
    return SkipropeSignals(times, np.ascontiguousarray(measured[good]), field_geometry(known[good]))


def field_geometry(field_c) -> FieldGeometry:
    """Magnitude, elevation and azimuth (4) of field vectors (n, 3) [T] in the axes (U, V, W) of the cone."""
    u, v, w = np.moveaxis(_rows("field_c", field_c), -1, 0)
    level = np.hypot(u, v)
    return FieldGeometry(np.hypot(level, w), np.arctan2(w, level), np.arctan2(-u, v))


def field_vector(geometry: FieldGeometry) -> np.ndarray:
    """(n, 3) [T], axes (U, V, W): equation (4), `field_geometry` undone."""
    b, level, along = geometry.magnitude_tesla, np.cos(geometry.elevation_rad), np.sin(geometry.elevation_rad)
    azimuth = geometry.azimuth_rad
    return np.stack([-b * level * np.sin(azimuth), b * level * np.cos(azimuth), b * along], axis=-1)


def corrected_signals(field_b, geometry: FieldGeometry) -> np.ndarray:
    """(n, 3) [rad]: C1, C2, C3 of (7) from the measured field (n, 3) [T], body axes, and what is known of the field.

    Errors: field_b of another shape is an InputError; where the field lies along the axis of the cone C3 is infinite.
    """
    measured = _rows("field_b", field_b)
    known = field_vector(geometry)
    if known.shape != measured.shape:
        raise InputError(f"field_b {measured.shape} and the known field {known.shape} must have one row for each sample.")
    over = np.stack([geometry.magnitude_tesla] * 2 + [geometry.magnitude_tesla * np.cos(geometry.elevation_rad)], axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        return (measured - known) / over  # (7)


def yaw_signal(field_b, geometry: FieldGeometry) -> np.ndarray:
    """(n,) [rad]: the yaw a3 from the part of the field across the cone's axis; low-pass it before use.

        (B_S1 cos AZ + B_S2 sin AZ) / (B cos EL) = a3 + tan EL (a1 sin AZ - a2 cos AZ)                    (8)

    An azimuth that is taken too large by d shows as a yaw of d: a magnetometer cannot tell the two apart.

    Source: the program in the appendix of TP-3123; its text has no such signal. First order in the angles.
    """
    measured = _rows("field_b", field_b)
    azimuth = geometry.azimuth_rad
    across = measured[:, 0] * np.cos(azimuth) + measured[:, 1] * np.sin(azimuth)
    with np.errstate(divide="ignore", invalid="ignore"):
        return across / (geometry.magnitude_tesla * np.cos(geometry.elevation_rad))


def _rows(name: str, vectors) -> np.ndarray:
    """(n, 3) floats, or a refusal."""
    rows = np.asarray(vectors, dtype=float)
    if rows.ndim != 2 or rows.shape[1] != 3:
        hint = " Did you pass (3, n)? Use .T." if rows.ndim == 2 and rows.shape[0] == 3 else ""
        raise InputError(f"{name} must be vectors (n, 3) [T]; got shape {rows.shape}.{hint}")
    return rows
