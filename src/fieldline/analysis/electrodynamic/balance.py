"""When the field does not turn a line with current: the masses at its ends and where its current flows.

A straight line along u carries I(s) at s from its end A; the field pushes each piece with I u x B. About the centre of mass
at s_G this gives

    N = M1 u x (u x B),     M1 = integral of I (s - s_G) ds = L I_mean (s_I - s_G)                          (1)
    s_I = integral of I s ds / integral of I ds                                                            (2)
    s_G = L (m_B + m_line / 2) / (m_A + m_B + m_line)                                                      (3)

so nothing turns the line where the current's centroid s_I is its centre of mass: the self-balanced line,

    m_B = (c m_A + (c - 1/2) m_line) / (1 - c),     c = s_I / L                                            (4)

Where it is not, the swing in the dipole field k (N - 3 (N . r) r) / r^3 of an untilted Earth is that of
`libration` with the one number

    epsilon = M1 k / (J GM),     J = m_A s_G^2 + m_B (L - s_G)^2 + m_line (L^2 / 12 + (s_G - L/2)^2)         (5)

A uniform current has c = 1/2: equal ends. A bare line whose resistance does not matter, cathode at A, has c = 5/14.

Source: Pelaez and Sanjurjo (2006), J. Spacecraft and Rockets 43(6), 1359 (self-balanced lines); Pelaez et al. (2000),
J. Astronautical Sciences 48(4), 449 (epsilon).
"""

from __future__ import annotations

import numpy as np

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError

DIPOLE_T_M3 = 7.8e15  # k of an untilted dipole for the Earth, some 2 % above IGRF's of 2025


def current_centroid(current_a, length_m=None) -> float:
    """c = s_I / L of equation (2), from A, for segments (n,) with mean currents [A]; length_m (n,) [m], equal if not given."""
    current = np.asarray(current_a, dtype=float)
    lengths = np.ones_like(current) if length_m is None else np.asarray(length_m, dtype=float)
    if current.ndim != 1 or current.shape != lengths.shape or not np.isfinite(current).all() or not np.all(lengths > 0.0):
        raise InputError(
            f"current_a must be (n,) finite numbers with a positive length each; got {current.shape}, {lengths.shape}"
        )
    total = float(current @ lengths)
    if abs(total) <= 1e-12 * float(np.abs(current) @ lengths):
        raise InputError("the currents cancel along the line: they have no centroid, but a torque whatever the masses.")
    middle = np.cumsum(lengths) - 0.5 * lengths
    return float((current * lengths) @ middle / (total * lengths.sum()))


def bare_centroid(cathode: str = "from") -> float:
    """c of a bare line whose resistance does not matter: 5/14 with the cathode at A ("from"), 9/14 at B ("to")."""
    if cathode not in ("from", "to"):
        raise InputError(f'cathode must be "from" or "to"; got "{cathode}"')
    return 5.0 / 14.0 if cathode == "from" else 9.0 / 14.0


def balanced_mass(centroid: float, other_mass_kg: float, line_mass_kg: float = 0.0) -> float:
    """m_B [kg] of equation (4) for m_A = other_mass_kg and a line [kg] whose current has its centroid at this part of it.

    Raises InputError where no mass at B does it: the line's own weighs too much on B's side.
    """
    if not 0.0 < centroid < 1.0:
        raise InputError(f"centroid must be a part of the line between 0 and 1; got {centroid}")
    mass = (centroid * other_mass_kg + (centroid - 0.5) * line_mass_kg) / (1.0 - centroid)
    if not mass >= 0.0:
        raise InputError(
            f"no mass at B balances a line of {line_mass_kg:g} kg with the current's centroid at {centroid:.3f} and "
            f"{other_mass_kg:g} kg at A; at A it takes {line_mass_kg * (0.5 - centroid) / centroid:.4g} kg at least."
        )
    return float(mass)


def torque_ratio(
    current_a: float,
    length_m: float,
    mass_a_kg: float,
    mass_b_kg: float,
    *,
    line_mass_kg: float = 0.0,
    centroid: float = 0.5,
    dipole_t_m3: float = DIPOLE_T_M3,
) -> float:
    """epsilon of equation (5); current_a: mean along the line [A], positive from A to B, B the upper end."""
    total = mass_a_kg + mass_b_kg + line_mass_kg
    if not (total > 0.0 and length_m > 0.0):
        raise InputError("a line needs a length and masses above zero.")
    middle = length_m * (mass_b_kg + 0.5 * line_mass_kg) / total
    inertia = mass_a_kg * middle**2 + mass_b_kg * (length_m - middle) ** 2
    inertia += line_mass_kg * (length_m**2 / 12.0 + (middle - 0.5 * length_m) ** 2)
    first = current_a * length_m * (centroid * length_m - middle)
    return float(first * dipole_t_m3 / (inertia * EARTH_GM_M3_S2))
