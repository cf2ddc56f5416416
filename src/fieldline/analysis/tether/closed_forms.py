"""What small motions of a line come to where a formula tells it.

A line without mass between two points, straight, in the plane and across it, with a length that is nothing to the radius:

    w = sqrt(3) n pi / (2 K(sin a))   in the plane at an amplitude a,    w = 2 n   across it, small            (1)

K the complete elliptic integral of the first kind of a modulus. A uniform rod with bodies at its ends, along itself:

    tan z = (p + q) z / (p q z^2 - 1),    w = z c / L,    c = sqrt(EA / mu),   p, q = m / (mu L)              (2)

A string whose tension and mass vary slowly, fixed at both ends, k half waves (Wentzel, Kramers, Brillouin):

    w = k pi / integral ds / sqrt(T (1 + T/EA) / mu) ds      over the unstretched length                      (3)

Sources: Beletsky and Levin (1993), Dynamics of Space Tether Systems, chapter 1 (1); Rayleigh, Theory of Sound, art. 149 to
155 (2); Bender and Orszag (1978), chapter 10 (3). (3) is good to the order of 1/k, and needs ends that do not move.
"""

from __future__ import annotations

import numpy as np


def libration_ratio(amplitude_rad):
    """Frequency of a libration in the plane over the orbital rate, at amplitudes (...) [rad] below pi / 2; equation (1)."""
    from scipy.special import ellipk

    return np.sqrt(3.0) * np.pi / (2.0 * ellipk(np.sin(amplitude_rad) ** 2))


def rod_frequencies(
    length_m: float, linear_mass_kg_m: float, stiffness_n: float, lower_kg: float, upper_kg: float, count: int
) -> np.ndarray:
    """(count,) [rad/s] of a uniform rod with bodies at its ends; equation (2)."""
    from scipy.optimize import brentq

    p, q = lower_kg / (linear_mass_kg_m * length_m), upper_kg / (linear_mass_kg_m * length_m)

    def balance(z: float) -> float:
        """(2) without its poles."""
        return (p * q * z * z - 1.0) * np.sin(z) - (p + q) * z * np.cos(z)

    wave = np.pi * np.arange(1, count + 1)
    if p + q > 0.0:  # one root in each half wave; without bodies they are its ends
        wave = np.array([brentq(balance, max(end - np.pi, 1e-9), end, xtol=1e-15, rtol=1e-14) for end in wave])
    return wave / length_m * np.sqrt(stiffness_n / linear_mass_kg_m)


def string_frequency(rest_m, tension_n, linear_mass_kg_m, stiffness_n: float, half_waves: int) -> float:
    """[rad/s] of (3); tension and mass per length at places rest_m (q,) [m] of the unstretched line, by the trapezoid rule."""
    speed = np.sqrt(np.asarray(tension_n) / (1.0 + np.asarray(tension_n) / stiffness_n) / linear_mass_kg_m)
    return float(np.pi * half_waves / np.trapezoid(1.0 / speed, rest_m))
