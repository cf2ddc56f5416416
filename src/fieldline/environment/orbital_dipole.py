"""A centred dipole's field in the axes of a circular orbit, and its change about a place on it.

Axes h: x up, y along the velocity, z along the orbit's normal. The dipole's direction in them, with u the argument of
latitude, i the inclination, and w = node - Greenwich's angle - longitude of the pole, latitude d of the pole:

    alpha = cos d (cos u cos w - cos i sin u sin w) + sin i sin d sin u
    beta  = cos d (-sin u cos w - cos i cos u sin w) + sin i sin d cos u                            (1)
    gamma = sin i cos d sin w + cos i sin d

    B = m/r^3 (2 alpha, -beta, -gamma)                                                              (2)
    dB_i/dx_j = 3 m/r^4 [[-2 alpha, beta, gamma], [beta, alpha, 0], [gamma, 0, alpha]]              (3)

over an equator (i = 0) alpha and beta turn with u + w and gamma = sin d. alpha^2 + beta^2 = 1 - gamma^2, so the field in
the orbit's plane vanishes where the dipole lies along the normal (gamma = 1 or -1), and the one across where gamma = 0.

Source: Lawrence (1992), AFIT/GA/ENY/92D-05, section 3.2 and (3.7). Dipole only: in low orbit the Earth's field differs from
it by a fifth (RMS), a half at worst.
"""

from __future__ import annotations

import numpy as np


def dipole_direction_h(inclination_rad, argument_rad, node_from_pole_rad, pole_latitude_rad) -> np.ndarray:
    """(..., 3) alpha, beta, gamma of equation (1), a unit vector; the angles broadcast."""
    u, w, i, d = (
        np.asarray(angle, dtype=float) for angle in (argument_rad, node_from_pole_rad, inclination_rad, pole_latitude_rad)
    )
    level, tilted = np.cos(d) * np.cos(w), np.sin(i) * np.sin(d) - np.cos(d) * np.cos(i) * np.sin(w)
    alpha = level * np.cos(u) + tilted * np.sin(u)
    beta = tilted * np.cos(u) - level * np.sin(u)
    gamma = np.sin(i) * np.cos(d) * np.sin(w) + np.cos(i) * np.sin(d) + 0.0 * u
    return np.stack([alpha, beta, gamma], axis=-1)  # (1)


def orbit_field_h(direction_h, strength_tesla: float) -> np.ndarray:
    """(..., 3) field [T] on the orbit from direction_h (..., 3) and strength m/r^3 [T]: equation (2)."""
    return strength_tesla * np.array([2.0, -1.0, -1.0]) * np.asarray(direction_h, dtype=float)


def orbit_gradient_h(direction_h, strength_tesla: float, radius_m: float) -> np.ndarray:
    """(..., 3, 3) gradient [T/m], [i, j] = dB_i/dx_j, on the orbit: equation (3)."""
    alpha, beta, gamma = np.moveaxis(np.asarray(direction_h, dtype=float), -1, 0)
    none = 0.0 * alpha
    rows = [[-2.0 * alpha, beta, gamma], [beta, alpha, none], [gamma, none, alpha]]
    return 3.0 * strength_tesla / radius_m * np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
