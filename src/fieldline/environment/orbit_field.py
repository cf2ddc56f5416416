"""A model's field on a circular orbit, in the axes of the orbit.

Axes h: x up, y along the velocity, z along the orbit's normal. The Earth stands still: an orbit is a longitude of its node,
which the Earth's turning moves through a circle in a day, and an argument of latitude.
"""

from __future__ import annotations

import numpy as np

from fieldline.environment.field import magnetic_field


def orbital_axes_eh(inclination_rad, argument_rad, node_longitude_rad) -> np.ndarray:
    """(..., 3, 3) matrices v_e = dcm_eh @ v_h, the columns axes h in Earth-fixed axes; the angles broadcast."""
    u, w, i = np.broadcast_arrays(
        np.asarray(argument_rad, dtype=float),
        np.asarray(node_longitude_rad, dtype=float),
        np.asarray(inclination_rad, dtype=float),
    )
    ahead = np.stack([np.cos(w), np.sin(w), 0.0 * w], axis=-1)
    beside = np.stack([-np.cos(i) * np.sin(w), np.cos(i) * np.cos(w), np.sin(i)], axis=-1)
    up = np.cos(u)[..., None] * ahead + np.sin(u)[..., None] * beside
    along = np.cos(u)[..., None] * beside - np.sin(u)[..., None] * ahead
    return np.stack([up, along, np.cross(up, along)], axis=-1)


def field_on_orbit_h(radius_m: float, inclination_rad, argument_rad, node_longitude_rad, time_utc, model="IGRF-14") -> np.ndarray:
    """(..., 3) [T], axes h, at one time; `model` as in `magnetic_field`."""
    dcm_eh = orbital_axes_eh(inclination_rad, argument_rad, node_longitude_rad)
    field_e = magnetic_field(radius_m * dcm_eh[..., 0], time_utc, model=model)
    return np.einsum("...ij,...i->...j", dcm_eh, field_e)
