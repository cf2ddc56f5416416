"""The report's Euler angles and direction cosines, section 2's letters: psi the node, theta the tilt, phi the spin.

    x_b = A x,    A = R3(phi) R1(theta) R3(psi),    columns of A: alpha, beta, gamma                         (1)
    gamma_3 = cos theta,   k = (sin theta sin psi, -sin theta cos psi, cos theta) is the last row of A        (2)
    omega_b = (psi' sin theta sin phi + theta' cos phi, psi' sin theta cos phi - theta' sin phi, psi' cos theta + phi')  (3)
    tan psi = alpha_3 / -beta_3,   tan phi = gamma_1 / gamma_2,   tan theta = |(gamma_1, gamma_2)| / gamma_3  (4)

The annex of 1978 exchanges the names of phi and psi. Where sin theta vanishes only psi + phi is known, and all of it is
given to phi. The orbital axes are a, from the Earth to the Shuttle, b along its track and c = a x b: in them psi of the
stationary motion is constant.
"""

from __future__ import annotations

import numpy as np

from fieldline.frames.attitude import dcm_from_quaternion, quaternion_from_dcm

SINGULAR = 1e-12  # sin theta below which the node is nowhere


def direction_cosines(theta, psi, phi) -> np.ndarray:
    """A (..., 3, 3) of (1), angles [rad] of any shape together."""
    theta, psi, phi = np.broadcast_arrays(*(np.asarray(angle, dtype=float) for angle in (theta, psi, phi)))
    return _about_z(phi) @ _about_x(theta) @ _about_z(psi)


def quaternion_of(theta: float, psi: float, phi: float) -> np.ndarray:
    """q_bi (4,), scalar last, of three angles [rad]."""
    return quaternion_from_dcm(direction_cosines(theta, psi, phi))


def body_rate(theta, phi, theta_rate, psi_rate, phi_rate) -> np.ndarray:
    """omega_b (3,) [rad/s] of (3)."""
    sine, cosine = np.sin(theta), np.cos(theta)
    return np.array(
        [
            psi_rate * sine * np.sin(phi) + theta_rate * np.cos(phi),
            psi_rate * sine * np.cos(phi) - theta_rate * np.sin(phi),
            psi_rate * cosine + phi_rate,
        ]
    )


def euler_angles(cosines) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """theta in 0 to pi, psi and phi in -pi to pi [rad], of direction cosines (..., 3, 3); equation (4)."""
    a = np.asarray(cosines, dtype=float)
    sine = np.hypot(a[..., 0, 2], a[..., 1, 2])
    theta = np.arctan2(sine, a[..., 2, 2])
    told = sine > SINGULAR
    psi = np.where(told, np.arctan2(a[..., 2, 0], -a[..., 2, 1]), 0.0)
    phi = np.where(told, np.arctan2(a[..., 0, 2], a[..., 1, 2]), np.arctan2(a[..., 0, 1], a[..., 0, 0]))
    return theta, psi, phi


def cosines_of(q_bi) -> np.ndarray:
    """A (..., 3, 3) of quaternions (..., 4), scalar last."""
    return dcm_from_quaternion(q_bi)


def xyz_angles(cosines) -> np.ndarray:
    """(..., 3) [rad]: turns about x, y and z in this order that lead from the axes to the body's, as the annex prints too."""
    a = np.asarray(cosines, dtype=float)
    about_y = np.arctan2(a[..., 2, 0], np.hypot(a[..., 0, 0], a[..., 1, 0]))
    about_x = np.arctan2(-a[..., 2, 1], a[..., 2, 2])
    return np.stack([about_x, about_y, np.arctan2(-a[..., 1, 0], a[..., 0, 0])], axis=-1)


def _about_z(angle) -> np.ndarray:
    """R3, (..., 3, 3)."""
    c, s, zero, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    return np.stack([np.stack(row, -1) for row in ((c, s, zero), (-s, c, zero), (zero, zero, one))], -2)


def _about_x(angle) -> np.ndarray:
    """R1, (..., 3, 3)."""
    c, s, zero, one = np.cos(angle), np.sin(angle), np.zeros_like(angle), np.ones_like(angle)
    return np.stack([np.stack(row, -1) for row in ((one, zero, zero), (zero, c, s), (zero, -s, c))], -2)
