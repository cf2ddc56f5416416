"""Angles that a figure shows: body axes against the orbital axes, and the edge of night on the map.

Orbital axes o: z to nadir, y against the orbit normal, x = y x z, along the velocity of a circular orbit.
"""

from __future__ import annotations

import numpy as np


def orbital_axes_i(position_i: np.ndarray, velocity_i: np.ndarray) -> np.ndarray:
    """(n, 3, 3) dcm_oi: its rows are the orbital axes in inertial axes."""
    z = -_unit(position_i)
    y = -_unit(np.cross(position_i, velocity_i))
    return np.stack([np.cross(y, z), y, z], axis=1)


def roll_pitch_yaw_deg(q_bi: np.ndarray, position_i: np.ndarray, velocity_i: np.ndarray) -> np.ndarray:
    """(n, 3) [deg] roll, pitch, yaw of the body against the orbital axes.

        dcm_bo = R1(roll) R2(pitch) R3(yaw)                                                        (1)

    Pitch lies within 90 deg; at 90 deg roll and yaw cannot be told apart.
    """
    dcm_bo = _dcm_bi(q_bi) @ np.swapaxes(orbital_axes_i(position_i, velocity_i), -1, -2)
    pitch = -np.arcsin(np.clip(dcm_bo[:, 0, 2], -1.0, 1.0))
    roll = np.arctan2(dcm_bo[:, 1, 2], dcm_bo[:, 2, 2])
    yaw = np.arctan2(dcm_bo[:, 0, 1], dcm_bo[:, 0, 0])
    return np.degrees(np.stack([roll, pitch, yaw], axis=-1))


def body_axes_from_nadir_deg(q_bi: np.ndarray, position_i: np.ndarray) -> np.ndarray:
    """(n, 3) [deg] angle of body x, y and z from the direction to the Earth's centre."""
    nadir_b = np.einsum("nij,nj->ni", _dcm_bi(q_bi), -_unit(position_i))
    return np.degrees(np.arccos(np.clip(nadir_b, -1.0, 1.0)))


def to_body(q_bi: np.ndarray, vectors_i: np.ndarray) -> np.ndarray:
    """(n, 3) vectors in body axes."""
    return np.einsum("nij,nj->ni", _dcm_bi(q_bi), vectors_i)


def terminator_latitude_deg(longitude_deg: np.ndarray, sun_longitude_deg: float, sun_latitude_deg: float) -> np.ndarray:
    """Latitude of the edge of night at each longitude: tan(latitude) = -cos(longitude - sun's) / tan(sun's latitude)."""
    slope = np.tan(np.radians(sun_latitude_deg if abs(sun_latitude_deg) > 1e-3 else 1e-3))
    return np.degrees(np.arctan(-np.cos(np.radians(longitude_deg - sun_longitude_deg)) / slope))


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors over their lengths."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _dcm_bi(q_bi: np.ndarray) -> np.ndarray:
    """(n, 3, 3) matrices of the quaternions."""
    from fieldline.frames.attitude import dcm_from_quaternion

    return dcm_from_quaternion(q_bi)
