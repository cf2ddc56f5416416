"""What the kernels of estimation read: one arc of calibrated vectors with the reference beside them.

    pull_i = sqrt(3 GM / |r|^3) r / |r|          so that the gravity gradient's torque is pull_b x (J pull_b)      (1)

With (1) the torque over the inertia depends on ratios of inertia alone, and a body whose scale is unknown still feels it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.constants import EARTH_GM_M3_S2


class Series(NamedTuple):
    """seconds (n,), field_b (n, 3) [T] measured, field_i (n, 3) [T] reference, pull_i (n, 3) [1/s], used (n,) bool.

    gyro_b (n, 3) [rad/s]: a gyro's rate that the random walk rides on (then the walk is the gyro's error), else zeros.
    moment_b (n, 3) [A m2]: a commanded dipole whose torque a rigid body of known inertia [kg m2] feels, else zeros.
    """

    seconds: np.ndarray
    field_b: np.ndarray
    field_i: np.ndarray
    pull_i: np.ndarray
    used: np.ndarray
    gyro_b: np.ndarray
    moment_b: np.ndarray


def make_series(seconds, field_b, field_i, position_i, used, gyro_b=None, moment_b=None) -> Series:
    """The record with (1), contiguous; samples that are not finite are not used (and hold zeros, not NaN)."""
    field_b = np.asarray(field_b, dtype=float)
    finite = np.isfinite(field_b).all(axis=1)
    distance = np.linalg.norm(position_i, axis=1, keepdims=True)
    pull_i = np.sqrt(3.0 * EARTH_GM_M3_S2 / distance**5) * position_i
    return Series(
        np.ascontiguousarray(seconds, dtype=float),
        np.where(finite[:, None], field_b, 0.0),
        np.ascontiguousarray(field_i, dtype=float),
        np.ascontiguousarray(pull_i),
        np.ascontiguousarray(used & finite),
        _told(gyro_b, field_b),
        _told(moment_b, field_b),
    )


def _told(column, like: np.ndarray) -> np.ndarray:
    """A column of telemetry, contiguous, zeros where it is missing or holds no number."""
    return np.zeros_like(like) if column is None else np.ascontiguousarray(np.nan_to_num(column), dtype=float)


def part(series: Series, rows) -> Series:
    """The rows (a slice or an index array) of a series."""
    return Series(*(np.ascontiguousarray(column[rows]) for column in series))
