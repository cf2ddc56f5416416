"""Two masses on a vertical line in a circular orbit: the annex's starts and constants (III-1.1 to III-1.4).

    rbar^3 = (m1 r1 + m2 r2) / (m1 / r1^2 + m2 / r2^2),    n = sqrt(GM / rbar^3)                             (1)
    T = GM (r2 / r1^2 - r1 / r2^2) / (r1 / m2 + r2 / m1),    r2 > r1                                         (2)
    l0 = l / (1 + T / EA),    k = EA / l0                                                                   (3)
    b = 2 sqrt(k m1 m2 / (m1 + m2)),    b_ang = 2 sqrt(I T d)                                                (4)

(4) are the critical dampings of the line's stretch and of the small swing of a body of inertia I on a lever d.

A line with mass is a string of beads, m at equal distances; the pair turns at n with n^2 sum m r = GM sum m / r^2, and from
the lower end up each bead adds to the tension

    T_(j+1) = T_j + m (GM / r_j^2 - n^2 r_j),    T_1 = m1 (GM / r1^2 - n^2 r1)                               (5)
Source: Arnold (1978), Annex III of NASA-CR-170721.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.cases.erbs_like import number
from fieldline.errors import InputError

MOST_BEADS = 200


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


class Beads(NamedTuple):
    """A line with mass in the common circular motion, from the lower end up."""

    dumbbell: Dumbbell  # with the whole's rate, and the tension at the lower end
    mass_kg: float  # of each bead
    radius_m: np.ndarray  # (n,)
    tension_n: np.ndarray  # (n + 1,) of the stretches between

    @property
    def count(self) -> int:
        """Beads."""
        return len(self.radius_m)


def beads_on(two: Dumbbell, nodes: int, line_mass_kg: float, gm: float) -> Beads:
    """`nodes` beads (0: none) that share line_mass_kg, evenly between the two masses; equation (5)."""
    if isinstance(nodes, bool) or not isinstance(nodes, int) or not 0 <= nodes <= MOST_BEADS:
        raise InputError(f"nodes must be a whole number from 0 to {MOST_BEADS}; got {nodes!r}.")
    if nodes == 0 and line_mass_kg != 0.0:
        raise InputError("line_mass_kg needs nodes that carry it; give nodes = 1 or more.")
    each = number("line_mass_kg", line_mass_kg, 1e-6, 1e6) / nodes if nodes else 0.0
    radii = np.linspace(two.lower_radius_m, two.upper_radius_m, nodes + 2)
    masses = np.array([two.lower_mass_kg, *[each] * nodes, two.upper_mass_kg])
    rate = float(np.sqrt(gm * (masses / radii**2).sum() / (masses * radii).sum()))
    tension = np.cumsum(masses * (gm / radii**2 - rate**2 * radii))[:-1]  # (5)
    mean = float((gm / rate**2) ** (1.0 / 3.0))
    whole = two if nodes == 0 else two._replace(orbital_rate_rad_s=rate, mean_radius_m=mean, tension_n=float(tension[0]))
    return Beads(whole, each, radii[1:-1], tension if nodes else np.array([two.tension_n]))


def natural_length(length_m: float, tension_n: float, stiffness_n: float) -> float:
    """l0 [m] of a line that is `length_m` long under a tension; EA [N]; equation (3)."""
    return length_m / (1.0 + tension_n / number("stiffness_n", stiffness_n, 1e-6))


def critical_damping(pair: Dumbbell, natural_length_m: float, stiffness_n: float) -> float:
    """b [N s/m] of (4): force per rate of the line's length."""
    return 2.0 * float(np.sqrt(stiffness_n / natural_length_m * pair.reduced_mass_kg))


def critical_angular_damping(inertia_kg_m2: float, tension_n: float, lever_m: float) -> float:
    """b_ang [N m s] of (4): torque per rate of the angle between lever and line."""
    return 2.0 * float(np.sqrt(inertia_kg_m2 * tension_n * lever_m))
