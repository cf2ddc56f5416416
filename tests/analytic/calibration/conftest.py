"""Synthetic flights: a tilted dipole's field along a circular polar orbit, seen by a body that turns in a stated way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

ORBIT_S = 5640.0
EQUATOR_TESLA = 2.5e-5
BIAS = np.array([100e-6, -30e-6, -28.5e-6])
MATRIX = np.array([[1.09, 0.012, 0.021], [0.012, 1.03, 0.036], [0.021, 0.036, 0.97]])


@dataclass(frozen=True)
class Synthetic:
    seconds: np.ndarray
    field_b: np.ndarray
    field_s: np.ndarray
    magnitude: np.ndarray
    bias: np.ndarray
    matrix: np.ndarray
    gain: np.ndarray


def dipole_along_orbit(seconds):
    """(n, 3) T, inertial: dipole tilted by 11 deg and turning with the Earth, orbit of 97 deg inclination."""
    anomaly = 2.0 * np.pi * seconds / ORBIT_S
    r = Rotation.from_euler("x", 97.0, degrees=True).apply(np.stack([np.cos(anomaly), np.sin(anomaly), 0.0 * anomaly], axis=1))
    longitude = 1.0 + 7.292e-5 * seconds
    m = -np.stack([np.sin(0.19) * np.cos(longitude), np.sin(0.19) * np.sin(longitude), np.cos(0.19) + 0.0 * seconds], axis=1)
    return EQUATOR_TESLA * (3.0 * np.sum(m * r, axis=1, keepdims=True) * r - m)


def attitude(kind, seconds, rng):
    """Rotations body to inertial."""
    if kind == "still":
        return Rotation.from_quat(np.tile(Rotation.random(random_state=rng).as_quat(), (len(seconds), 1)))
    start = Rotation.random(random_state=rng)
    if kind == "spinning":  # 46 deg/s about y, coning by 8 deg
        cone = Rotation.from_rotvec(np.outer(seconds * 0.05, [0.2, 0.9, 0.4])) * Rotation.from_euler("x", 8.0, degrees=True)
        return start * cone * Rotation.from_rotvec(np.outer(seconds * 0.8, [0.0, 1.0, 0.0]))
    if kind == "tumbling":
        return (
            start
            * Rotation.from_rotvec(np.outer(seconds * 0.02, [0.3, -0.8, 0.5]))
            * Rotation.from_rotvec(np.outer(seconds * 0.013, [0.7, 0.1, 0.6]))
        )
    # Earth-pointing: once per orbit about the normal, librating by some degrees.
    orbital = Rotation.from_euler("x", 97.0, degrees=True) * Rotation.from_rotvec(
        np.outer(2.0 * np.pi * seconds / ORBIT_S, [0.0, 0.0, 1.0])
    )
    swing = np.stack([np.sin(seconds / 500.0 + k) * a for k, a in enumerate((0.08, 0.06, 0.1))], axis=1)
    return orbital * Rotation.from_rotvec(swing)


def synthetic(
    kind="tumbling", seed=0, *, span_s=ORBIT_S, step_s=1.0, bias=BIAS, matrix=MATRIX, noise=3e-7, quantum=0.0, outliers=0.0,
    gain=0.0, gain_on="reading", start_s=0.0, extra=None,
):  # fmt: skip
    """A flight whose readings follow the calibration's own model; `extra(seconds)` (n, 3) T is added to the bias."""
    rng = np.random.default_rng(seed)
    seconds = start_s + np.arange(0.0, span_s, step_s)
    field_b = attitude(kind, seconds, rng).inv().apply(dipole_along_orbit(seconds))
    course = 1.0 + gain * np.sin(2.0 * np.pi * (seconds - start_s) / ORBIT_S + 0.7)
    course /= course.mean()
    offset = bias + (0.0 if extra is None else extra(seconds))
    if gain_on == "reading":
        field_s = (field_b @ np.linalg.inv(matrix) + offset) / course[:, None]
    else:
        field_s = field_b @ np.linalg.inv(matrix) / course[:, None] + offset
    field_s = field_s + noise * rng.standard_normal(field_s.shape)
    wild = rng.random(len(seconds)) < outliers
    field_s[wild] += rng.uniform(-1e-4, 1e-4, (int(wild.sum()), 3))
    if quantum:
        field_s = np.round(field_s / quantum) * quantum
    return Synthetic(seconds, field_b, field_s, np.linalg.norm(field_b, axis=1), bias, matrix, course)


@pytest.fixture
def flight():
    return synthetic
