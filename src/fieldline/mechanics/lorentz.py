"""Force and moment of straight conductors in a field that is uniform over the body.

    force = I L x B,   moment = p x force                                                           (1)

L is the conductor from end to end in the direction of positive current, p its middle from the centre of mass: the force is
spread evenly, so it acts at the middle. The circuit is closed outside (through the plasma), else a loop would give no force.

    B . force = 0 whatever the currents                                                             (2)

so conductors push in two directions at an instant; that along B is what they cannot. If all are parallel to d the force is
across d as well.

Source: Griffiths, Introduction to Electrodynamics, 4th ed., eq. (5.17). The field's change over a body of 600 m is 3e-4 of it.
"""

from __future__ import annotations

import numpy as np


def conductor_map(wire_b, position_b, field_b) -> np.ndarray:
    """(..., 6, m) loads per ampere, rows force [N/A] and moment [N m/A], axes b: equation (1).

    wire_b (m, 3) [m] : L of each conductor.      position_b (m, 3) [m] : p.      field_b (..., 3) [T].
    """
    wire_b, position_b = np.asarray(wire_b, dtype=float), np.asarray(position_b, dtype=float)
    field_b = np.asarray(field_b, dtype=float)[..., None, :]
    force = np.cross(np.broadcast_to(wire_b, (*field_b.shape[:-2], *wire_b.shape)), field_b)
    both = np.concatenate([force, np.cross(position_b, force)], axis=-1)
    return np.swapaxes(both, -1, -2)


def conductor_loads(current_a, wire_b, position_b, field_h, angles=(0.0, 0.0, 0.0)) -> np.ndarray:
    """(6,) force [N] in axes h and moment [N m] in axes b of currents (m,) [A], for a body turned by angles p1, p2, p3.

    The turn is about x, then the new y, then the new z (the Cardan angles of Lawrence, 1992); nothing is linearised.
    """
    dcm_bh = turned(angles)
    loads = conductor_map(wire_b, position_b, dcm_bh @ np.asarray(field_h, dtype=float)) @ np.asarray(current_a, dtype=float)
    return np.concatenate([dcm_bh.T @ loads[:3], loads[3:]])


def turned(angles) -> np.ndarray:
    """(3, 3) matrix from h to b of Cardan angles (3,) [rad]: about x, then y, then z."""
    (s1, s2, s3), (c1, c2, c3) = np.sin(angles), np.cos(angles)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, c1, s1], [0.0, -s1, c1]])
    about_y = np.array([[c2, 0.0, -s2], [0.0, 1.0, 0.0], [s2, 0.0, c2]])
    about_z = np.array([[c3, s3, 0.0], [-s3, c3, 0.0], [0.0, 0.0, 1.0]])
    return about_z @ about_y @ about_x
