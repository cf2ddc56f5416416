"""The angular rate uncertainty circle (ARUC): what two successive magnetometer samples tell.

With A = dcm_bi, field B and its time derivatives in body (A) and inertial (R) axes,

    A B_R = B_A,     A dB_R = dB_A + omega x B_A                                       (2-1a), (2-1b)

the rate across the field lies on a circle, and the attitude on a one-parameter family, of one and the same angle Phi:

    f omega_2 + lambda_A = lambda_R cos Phi,    f omega_3 = lambda_R sin Phi           (2-17)
    A = D T1(Phi) U^T                                                                  (2-9), (2-12)

    D = [D1 D2 D3],  D1 = B_A/|B_A|,  D2 = D1 x dB_A / (|dB_A| sin psi_A),  D3 = D1 x D2        (2-3)
    U = [U1 U2 U3],  the same of B_R and dB_R                                                   (2-7)
    f = |B_R|/|dB_R|,  alpha = |dB_A|/|dB_R|,  lambda_A = alpha sin psi_A,  lambda_R = sin psi_R (2-5), (2-6)
    kappa_R = cos psi_R = alpha cos psi_A     (used in (2-13) to (3-8), defined nowhere in the paper)

psi_K is the angle between B_K and dB_K; omega_1, omega_2, omega_3 are the components of omega on D1, D2, D3.

The scan of the paper lost most dots over B: (2-1b), (2-2), (2-5) to (2-7) and (2-13) to (2-16) hold derivatives where
it prints fields. The sines are taken from cross products, which keep their digits near 0 and pi.

Source: Natanson, McLaughlin and Nicklas (1990), Flight Mechanics/Estimation Theory Symposium, NASA CP-3102, section 2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Circle(NamedTuple):
    """The circle at each of n samples; every field has a first axis of length n."""

    alpha: np.ndarray  # ratio of the derivatives' magnitudes
    f_s: np.ndarray  # |B_R|/|dB_R| [s]
    lambda_a: np.ndarray  # distance of the centre from the origin, times f
    lambda_r: np.ndarray  # radius, times f
    kappa_r: np.ndarray  # cosine of the angle between B_R and dB_R
    d_hat: np.ndarray  # (n, 3, 3), columns D1, D2, D3 in body axes
    u_hat: np.ndarray  # (n, 3, 3), columns U1, U2, U3 in inertial axes
    slope_i: np.ndarray  # |dB_R| [T/s]
    magnitude_b: np.ndarray  # |B_A| [T]


def triad(value, first):
    """Columns (2-3) of B and dB, |B|, |dB| and sin, cos of the angle between; NaN columns where they are parallel."""
    magnitude, slope = np.linalg.norm(value, axis=-1), np.linalg.norm(first, axis=-1)
    normal = np.cross(value, first)
    area = np.linalg.norm(normal, axis=-1)
    with np.errstate(invalid="ignore", divide="ignore"):
        one = value / magnitude[..., None]
        two = normal / area[..., None]
        sine, cosine = area / (magnitude * slope), np.sum(value * first, axis=-1) / (magnitude * slope)
    return np.stack([one, two, np.cross(one, two)], axis=-1), magnitude, slope, sine, cosine


def uncertainty_circle(derivatives_b, derivatives_i) -> Circle:
    """The circle of (2-4) from the field and its first derivative in body and in inertial axes, (n, 3) each [T, T/s]."""
    d_hat, magnitude_b, slope_b, sine_a, _ = triad(derivatives_b.value, derivatives_b.first)
    u_hat, magnitude_i, slope_i, sine_r, kappa_r = triad(derivatives_i.value, derivatives_i.first)
    with np.errstate(invalid="ignore", divide="ignore"):
        alpha, f_s = slope_b / slope_i, magnitude_i / slope_i
    return Circle(alpha, f_s, alpha * sine_a, sine_r, kappa_r, d_hat, u_hat, slope_i, magnitude_b)


def attitude_at(circle: Circle, angle_rad) -> np.ndarray:
    """(n, m, 3, 3) matrices dcm_bi at angles Phi (n, m) [rad] on the circle: (2-12)."""
    cosine, sine = np.cos(angle_rad)[..., None, None], np.sin(angle_rad)[..., None, None]
    d, u = circle.d_hat[:, None], circle.u_hat[:, None]
    d1, d2, d3 = d[..., 0:1], d[..., 1:2], d[..., 2:3]
    turned = np.concatenate([d1 + 0.0 * cosine, cosine * d2 + sine * d3, cosine * d3 - sine * d2], axis=-1)  # (2-8)
    return turned @ np.swapaxes(u, -1, -2)


def transverse_rate(circle: Circle, angle_rad) -> tuple[np.ndarray, np.ndarray]:
    """Components omega_2 and omega_3 (n, m) [rad/s] at angles Phi (n, m): (2-17)."""
    lambda_a, lambda_r, f_s = circle.lambda_a[:, None], circle.lambda_r[:, None], circle.f_s[:, None]
    return (lambda_r * np.cos(angle_rad) - lambda_a) / f_s, lambda_r * np.sin(angle_rad) / f_s


def rate_at(circle: Circle, angle_rad, along_rad_s) -> np.ndarray:
    """(n, m, 3) [rad/s], body axes: the rate of angle Phi and component omega_1 along the field."""
    two, three = transverse_rate(circle, angle_rad)
    return np.einsum("nij,nmj->nmi", circle.d_hat, np.stack([along_rad_s, two, three], axis=-1))
