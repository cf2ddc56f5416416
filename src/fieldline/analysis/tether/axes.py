"""Axes c of a line: e3 from its lower end to its upper, e1 along the track, e2 to the side of the orbit's normal h.

    e1 = unit(h x e3),   e2 = e3 x e1                                                                       (1)
    e3 = cos b (cos a up + sin a forward) + sin b h                                                          (2)

a: libration in the plane, positive when the upper end is ahead; b: across it, positive when the upper end is on the side of
h = unit(r x v) of the mass centre; up = unit(r), forward = h x up. In the plane a is what is left of the angle between the
line and the vertical; for a line that points along h, e1 is not defined.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Frame(NamedTuple):
    """Axes and their rates; leading axes of any shape."""

    axes: np.ndarray  # (..., 3, 3), rows e1, e2, e3
    rate: np.ndarray  # (..., 3, 3), their time derivatives [1/s]


def unit_rows(vectors: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) over their lengths."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def unit_and_rate(vectors: np.ndarray, rates: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Directions of vectors (..., 3) and how fast they turn [1/s]."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    direction = vectors / length
    return direction, (rates - direction * (direction * rates).sum(axis=-1, keepdims=True)) / length


def line_axes(chord_i: np.ndarray, chord_rate_i: np.ndarray, normal_i: np.ndarray) -> Frame:
    """Axes (1) of chords (..., 3) [m] from the lower end to the upper, their rates [m/s], and the orbit's normal (..., 3).

    The normal is taken to stand still: it moves by arcseconds while a line swings once.
    """
    e3, d3 = unit_and_rate(chord_i, chord_rate_i)
    e1, d1 = unit_and_rate(np.cross(normal_i, e3), np.cross(normal_i, d3))
    e2, d2 = np.cross(e3, e1), np.cross(d3, e1) + np.cross(e3, d1)
    return Frame(np.stack([e1, e2, e3], axis=-2), np.stack([d1, d2, d3], axis=-2))


def orbit_axes(position_i: np.ndarray, velocity_i: np.ndarray) -> np.ndarray:
    """(..., 3, 3) rows up, forward, normal of a mass centre's position [m] and velocity [m/s]."""
    up = unit_rows(position_i)
    normal = unit_rows(np.cross(position_i, velocity_i))
    return np.stack([up, np.cross(normal, up), normal], axis=-2)


def direction_of(in_plane_rad, out_of_plane_rad, orbit: np.ndarray) -> np.ndarray:
    """(..., 3) equation (2): the direction e3 of two angles in the axes of an orbit (..., 3, 3)."""
    a, b = np.asarray(in_plane_rad, dtype=float), np.asarray(out_of_plane_rad, dtype=float)
    parts = np.stack(np.broadcast_arrays(np.cos(b) * np.cos(a), np.cos(b) * np.sin(a), np.sin(b)), axis=-1)
    return np.einsum("...k,...kj->...j", parts, orbit)
