"""The sensors of all bodies, as compiled code takes them: one table of numbers for each kind, made from the records.

Degrees, arc seconds and nanotesla of the records become SI here; a limit that a record gives as 0 (none) becomes
infinite. A body without a sensor of some kind has a row of zeros that its kernel does not read.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, pi, radians
from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError
from fieldline.sensing.gyro import GyroParams
from fieldline.sensing.magnetometer import MagnetometerParams
from fieldline.sensing.navigation import NavigationParams
from fieldline.sensing.star_tracker import StarTrackerParams
from fieldline.sensing.sun_sensor import SunSensorParams

TESLA_PER_NT = 1e-9
RAD_PER_ARCSEC = pi / 648000.0
RAD_PER_DEG = pi / 180.0


class Suite(NamedTuple):
    """Every sensor of every body."""

    magnetometers: MagnetometerParams
    gyros: GyroParams
    sun_sensors: SunSensorParams
    star_trackers: StarTrackerParams
    navigations: NavigationParams


def suite(
    count: int,
    *,
    magnetometers: Sequence | None = None,
    gyros: Sequence | None = None,
    sun_sensors: Sequence | None = None,
    star_trackers: Sequence | None = None,
    navigations: Sequence | None = None,
    rate_estimated: Sequence[bool] | None = None,
) -> Suite:
    """Tables of the sensors of `count` bodies.

    Parameters
    ----------
    magnetometers ... navigations : one a body, a record of `fieldline.sensing.sensors` or None; a kind left out is
        carried by no body.
    rate_estimated : one a body: True where an estimator says the rate known on board, so that the gyro's reading is not
        taken for it.

    Errors: InputError where a sequence has not one entry a body.
    """

    def each(name: str, given: Sequence | None, default) -> list:
        entries = [default] * count if given is None else list(given)
        if len(entries) != count:
            raise InputError(f"{name} needs one entry for each of the {count} bodies; got {len(entries)}.")
        return entries

    return Suite(
        magnetometers=_magnetometers(each("magnetometers", magnetometers, None)),
        gyros=_gyros(each("gyros", gyros, None), each("rate_estimated", rate_estimated, False)),
        sun_sensors=_sun_sensors(each("sun_sensors", sun_sensors, None)),
        star_trackers=_star_trackers(each("star_trackers", star_trackers, None)),
        navigations=_navigations(each("navigations", navigations, None)),
    )


def _table(records: list, width: int, of: Callable, factor: float = 1.0) -> np.ndarray:
    """(n, width) of `of(record)` times a factor; zeros where there is no record."""
    rows = np.zeros((len(records), width))
    for row, record in zip(rows, records, strict=True):
        if record is not None:
            row[:] = factor * np.ravel(of(record))
    return rows


def _column(records: list, of: Callable, factor: float = 1.0) -> np.ndarray:
    """(n,) of one number a record."""
    return np.ascontiguousarray(_table(records, 1, of, factor)[:, 0])


def _limit(records: list, of: Callable, factor: float) -> np.ndarray:
    """(n,) limits; 0 in a record is no limit."""
    values = _column(records, of, factor)
    return np.where(values > 0.0, values, np.inf)


def _present(records: list) -> np.ndarray:
    """(n,) 1 where there is a record."""
    return np.array([0.0 if record is None else 1.0 for record in records])


def _magnetometers(records: list) -> MagnetometerParams:
    """The table of magnetometers [T]."""
    return MagnetometerParams(
        present=_present(records),
        gain=_table(records, 9, lambda r: r.gain),
        coupling=_table(records, 9, lambda r: r.torquer_coupling_nt_a_m2, TESLA_PER_NT),
        bias=_table(records, 3, lambda r: r.bias_nt, TESLA_PER_NT),
        noise_std=_table(records, 3, lambda r: r.noise_std_nt, TESLA_PER_NT),
        quantum=_column(records, lambda r: r.quantum_nt, TESLA_PER_NT),
        limit=_limit(records, lambda r: r.range_nt, TESLA_PER_NT),
    )


def _gyros(records: list, estimated: list) -> GyroParams:
    """The table of gyros [rad/s]."""
    return GyroParams(
        present=_present(records),
        serves=np.array([0.0 if known else 1.0 for known in estimated]),
        gain=_table(records, 9, lambda r: r.gain),
        bias=_table(records, 3, lambda r: r.bias_deg_s, RAD_PER_DEG),
        walk_std=_table(records, 3, lambda r: r.bias_walk_deg_s_sqrt_s, RAD_PER_DEG),
        noise_std=_table(records, 3, lambda r: r.noise_std_deg_s, RAD_PER_DEG),
        quantum=_column(records, lambda r: r.quantum_deg_s, RAD_PER_DEG),
        limit=_limit(records, lambda r: r.range_deg_s, RAD_PER_DEG),
    )


def _sun_sensors(records: list) -> SunSensorParams:
    """The table of faces, body after body."""
    faces = [0 if record is None else len(record.normals_b) for record in records]
    owner = [record for record, number in zip(records, faces, strict=True) for _ in range(number)]
    normals = [normal for record in records if record is not None for normal in record.normals_b]
    return SunSensorParams(
        start=np.concatenate([[0], np.cumsum(faces)]).astype(np.int64),
        normal=np.array(normals, dtype=float).reshape(-1, 3),
        least_cosine=np.array([_cosine_deg(record.field_of_view_deg) for record in owner]),
        albedo=_column(owner, lambda r: r.albedo),
        noise_std=_column(owner, lambda r: r.noise_std),
    )


def _cosine_deg(angle_deg: float) -> float:
    """The cosine of 0 to 90 degrees; exactly 0 at 90, so that a hemisphere ends at its horizon."""
    return 0.0 if angle_deg == 90.0 else cos(radians(angle_deg))


def _star_trackers(records: list) -> StarTrackerParams:
    """The table of star trackers [rad]."""
    return StarTrackerParams(
        present=_present(records),
        boresight=_table(records, 3, lambda r: r.boresight_b),
        offset=_table(records, 3, lambda r: r.offset_arcsec, RAD_PER_ARCSEC),
        noise_std=_table(records, 3, lambda r: r.noise_std_arcsec, RAD_PER_ARCSEC),
        rate_max=_limit(records, lambda r: r.rate_max_deg_s, RAD_PER_DEG),
        sun_exclusion=_column(records, lambda r: r.sun_exclusion_deg, RAD_PER_DEG),
        earth_exclusion=_column(records, lambda r: r.earth_exclusion_deg, RAD_PER_DEG),
    )


def _navigations(records: list) -> NavigationParams:
    """The table of what is known of the orbit."""
    return NavigationParams(
        present=_present(records),
        position_offset_o=_table(records, 3, lambda r: r.position_offset_o_m),
        position_noise_std=_table(records, 3, lambda r: r.position_noise_std_m),
        velocity_noise_std=_table(records, 3, lambda r: r.velocity_noise_std_m_s),
        relative_position_noise_std=_table(records, 3, lambda r: r.relative_position_noise_std_m),
        relative_velocity_noise_std=_table(records, 3, lambda r: r.relative_velocity_noise_std_m_s),
    )
