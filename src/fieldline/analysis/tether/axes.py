"""Axes of a line about the way down it, and directions at angles of libration; as `fieldline.analysis.line_shape` has them.

With d the direction from the upper end to the lower, orbital axes o of a centre, x along the track and y against the normal,

    e_1 = unit(y_o x d),   e_2 = d x e_1                                                                     (1)
    d = cos b (cos a z_o + sin a x_o) + sin b y_o                                                            (2)

a: libration in the plane, positive with the lower end ahead; b: across it. For a vertical line e_1 is x_o and e_2 is y_o.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Frame(NamedTuple):
    """Axes of a line and their rates, inertial components."""

    axes: np.ndarray  # (3, 3), rows e_1, e_2, d
    rate: np.ndarray  # (3, 3) [1/s], their time derivatives


def unit_and_rate(vector: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Direction of a vector (3,) and how fast it turns [1/s]."""
    length = np.linalg.norm(vector)
    direction = vector / length
    return direction, (rate - direction * (direction @ rate)) / length


def line_axes(down_i: np.ndarray, down_rate_i: np.ndarray, y_o_i: np.ndarray) -> Frame:
    """Axes (1) of a chord (3,) [m] from the upper end to the lower, and its rate [m/s]; y_o is taken to stand still."""
    d, d_rate = unit_and_rate(down_i, down_rate_i)
    e1, e1_rate = unit_and_rate(np.cross(y_o_i, d), np.cross(y_o_i, d_rate))
    return Frame(np.stack([e1, np.cross(d, e1), d]), np.stack([e1_rate, np.cross(d_rate, e1) + np.cross(d, e1_rate), d_rate]))


def direction_o(in_plane_rad: float, across_rad: float) -> np.ndarray:
    """(3,) equation (2): d in orbital axes."""
    a, b = in_plane_rad, across_rad
    return np.array([np.cos(b) * np.sin(a), np.sin(b), np.cos(b) * np.cos(a)])


def direction_rate_o(in_plane_rad: float, across_rad: float, in_plane_rate: float, across_rate: float) -> np.ndarray:
    """(3,) [1/s] d' of (2) as seen in the turning axes, of rates [rad/s] of both angles."""
    a, b, da, db = in_plane_rad, across_rad, in_plane_rate, across_rate
    return np.array(
        [
            da * np.cos(b) * np.cos(a) - db * np.sin(b) * np.sin(a),
            db * np.cos(b),
            -da * np.cos(b) * np.sin(a) - db * np.sin(b) * np.cos(a),
        ]
    )
