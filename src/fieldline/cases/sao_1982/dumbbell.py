"""Two masses on a vertical line in a circular orbit: the annex's starts and constants (III-1.1 to III-1.4).

    rbar^3 = (m1 r1 + m2 r2) / (m1 / r1^2 + m2 / r2^2),    n = sqrt(GM / rbar^3)                             (1)
    T = GM (r2 / r1^2 - r1 / r2^2) / (r1 / m2 + r2 / m1),    r2 > r1                                         (2)
    l0 = l / (1 + T / EA),    k = EA / l0                                                                   (3)
    b = 2 sqrt(k m1 m2 / (m1 + m2)),    b_ang = 2 sqrt(I T d)                                                (4)

(4) are the critical dampings of the line's stretch and of the small swing of a body of inertia I on a lever d.

A line with mass has it in nodes at equal distances, and half of a segment's at either end; the whole turns at n with
n^2 sum m r = GM sum m / r^2, and from the lower end up each mass adds to the tension

    T_(j+1) = T_j + m_j (GM / r_j^2 - n^2 r_j),    T_1 = (m1 + m/2) (GM / r1^2 - n^2 r1)                     (5)

of which the lower mass itself feels m1's part.
Source: Arnold (1978), Annex III of NASA-CR-170721.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.cases.erbs_like import number
from fieldline.errors import InputError

MOST_NODES = 200


class Dumbbell(NamedTuple):
    """Two masses in a common circular motion."""

    lower_mass_kg: float  # m1
    upper_mass_kg: float  # m2
    lower_radius_m: float  # r1
    upper_radius_m: float  # r2
    orbital_rate_rad_s: float  # n
    mean_radius_m: float  # rbar
    tension_n: float  # T

    @property
    def reduced_mass_kg(self) -> float:
        """m1 m2 / (m1 + m2)."""
        return self.lower_mass_kg * self.upper_mass_kg / (self.lower_mass_kg + self.upper_mass_kg)


def dumbbell(lower_mass_kg: float, upper_mass_kg: float, lower_radius_m: float, upper_radius_m: float, gm: float) -> Dumbbell:
    """Two masses at two radii [m] about gm [m^3/s^2]; equations (1) and (2)."""
    m1, m2 = number("lower_mass_kg", lower_mass_kg, 1e-6, 1e12), number("upper_mass_kg", upper_mass_kg, 1e-6, 1e12)
    r1, r2 = number("lower_radius_m", lower_radius_m, 1.0), number("upper_radius_m", upper_radius_m, 1.0)
    if r2 <= r1:
        raise InputError(f"upper_radius_m must be above lower_radius_m; got {r2:g} and {r1:g}.")
    mean = ((m1 * r1 + m2 * r2) / (m1 / r1**2 + m2 / r2**2)) ** (1.0 / 3.0)
    tension = gm * (r2 / r1**2 - r1 / r2**2) / (r1 / m2 + r2 / m1)  # (2)
    return Dumbbell(m1, m2, r1, r2, float(np.sqrt(gm / mean**3)), float(mean), float(tension))


class Strung(NamedTuple):
    """Two masses and what is between them in the common circular motion."""

    dumbbell: Dumbbell  # with the whole's rate, and the pull on the lower mass alone
    nodes: int
    line_mass_kg: float
    tension_n: np.ndarray  # (nodes + 1,) of the segments, from the lower end up


def strung(two: Dumbbell, nodes: int, line_mass_kg: float, gm: float) -> Strung:
    """Two masses on a line of line_mass_kg with `nodes` (0: without mass) evenly between them; equation (5)."""
    if isinstance(nodes, bool) or not isinstance(nodes, int) or not 0 <= nodes <= MOST_NODES:
        raise InputError(f"nodes must be a whole number from 0 to {MOST_NODES}; got {nodes!r}.")
    if nodes == 0:
        if line_mass_kg != 0.0:
            raise InputError("line_mass_kg needs nodes that carry it; give nodes = 1 or more.")
        return Strung(two, 0, 0.0, np.array([two.tension_n]))
    each = number("line_mass_kg", line_mass_kg, 1e-6, 1e6) / (nodes + 1)
    radii = np.linspace(two.lower_radius_m, two.upper_radius_m, nodes + 2)
    masses = np.array([two.lower_mass_kg + 0.5 * each, *[each] * nodes, two.upper_mass_kg + 0.5 * each])
    rate = float(np.sqrt(gm * (masses / radii**2).sum() / (masses * radii).sum()))
    tension = np.cumsum(masses * (gm / radii**2 - rate**2 * radii))[:-1]  # (5)
    mean = float((gm / rate**2) ** (1.0 / 3.0))
    pull = float(tension[0]) * two.lower_mass_kg / float(masses[0])
    whole = two._replace(orbital_rate_rad_s=rate, mean_radius_m=mean, tension_n=pull)
    return Strung(whole, nodes, line_mass_kg, tension)


def natural_length(length_m: float, tension_n: float, stiffness_n: float) -> float:
    """l0 [m] of a line that is `length_m` long under a tension; EA [N]; equation (3)."""
    return length_m / (1.0 + tension_n / number("stiffness_n", stiffness_n, 1e-6))


def critical_damping(pair: Dumbbell, natural_length_m: float, stiffness_n: float) -> float:
    """b [N s/m] of (4): force per rate of the line's length."""
    return 2.0 * float(np.sqrt(stiffness_n / natural_length_m * pair.reduced_mass_kg))


def critical_angular_damping(inertia_kg_m2: float, tension_n: float, lever_m: float) -> float:
    """b_ang [N m s] of (4): torque per rate of the angle between lever and line."""
    return 2.0 * float(np.sqrt(inertia_kg_m2 * tension_n * lever_m))
