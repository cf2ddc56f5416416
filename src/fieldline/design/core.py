"""Cores of soft iron alloys: how much moment a rod adds to its winding, and where it saturates.

A winding of n I ampere-turns over the whole length l of a core of cross-section A magnetises it by its own field less
the field of the poles that appear at its ends,

    H = n I / l - N_d M,   M = chi H   =>   m = n I A (1 + chi / (1 + N_d chi)) = n I A gain,  chi = mu_r - 1     (1)
    N_d = (lam / s ln(lam + s) - 1) / s^2,   s^2 = lam^2 - 1,   lam = l / d        prolate ellipsoid, exact    (2)
    N_d = 1 - K(l / d)          the volume's mean in a uniformly magnetised cylinder, exact (K: Nagaoka)       (3)

(2) is what torque rods are usually designed with: it holds where chi >> lam^2, so that the poles alone decide and the
gain, near 1 / N_d, hardly depends on the alloy. (3) holds for chi << 1 and is too large for a permeable rod, twice (2) at
lam = 10, three times at 20: the gain that it gives is a safe one. The core's mean induction must stay below saturation,

    B = mu0 (H + M) < B_s                                                                                    (4)

and in the middle of a slender cylinder, where the flux is about a parabola of the length, B is up to half as much again.

Sources: (2) Osborn (1945), Phys. Rev. 67:351. (3) the mean axial field of a uniform current sheet is Nagaoka's
coefficient times that of a long one: Joseph (1966), J. Appl. Phys. 37:4639; Rosa and Grover (1916), Bull. Bur. Stand.
8:119. Alloys: Bozorth, Ferromagnetism (1951), tables of initial permeability, saturation and density; typical values of
annealed material at small fields, which cold work and temperature halve easily.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log, pi, sqrt

from fieldline.errors import InputError, nearest, shown

MU0 = 4e-7 * pi


@dataclass(frozen=True, slots=True, kw_only=True)
class CoreAlloy:
    """A soft magnetic alloy: relative permeability at small fields, saturation B_s [T], density [kg/m^3]."""

    name: str
    relative_permeability: float
    saturation_tesla: float
    density_kg_m3: float


BOZORTH = "Bozorth, Ferromagnetism (1951)"
ALLOYS = {
    name: CoreAlloy(name=name, relative_permeability=mu, saturation_tesla=saturation, density_kg_m3=density)
    for name, mu, saturation, density in (
        ("iron", 200.0, 2.15, 7880.0),
        ("45-permalloy", 2500.0, 1.60, 8170.0),
        ("4-79-permalloy", 20000.0, 0.87, 8720.0),
        ("mumetal", 20000.0, 0.65, 8580.0),
        ("supermalloy", 100000.0, 0.80, 8770.0),
        ("2V-permendur", 800.0, 2.40, 8200.0),
    )
}
SHAPES = ("ellipsoid", "cylinder")


def alloy(name: str | CoreAlloy) -> CoreAlloy:
    """An alloy by name."""
    if isinstance(name, CoreAlloy):
        return name
    plain = {known.lower(): known for known in ALLOYS}
    if str(name).strip().lower() not in plain:
        raise InputError(f'unknown core "{shown(str(name))}"; {nearest(str(name), ALLOYS)}')
    return ALLOYS[plain[str(name).strip().lower()]]


def ellipsoid_factor(slenderness: float) -> float:
    """N_d along the long axis of a prolate ellipsoid, l/d >= 1; equation (2), 1/3 for the sphere."""
    if slenderness < 1.0:
        raise InputError(f"the core must be longer than thick; got length over diameter {slenderness:g}.")
    square = slenderness * slenderness - 1.0
    if square < 1e-4:
        return 1.0 / 3.0 - 4.0 / 15.0 * (slenderness - 1.0)  # both terms of (2) cancel there
    s = sqrt(square)
    return (slenderness / s * log(slenderness + s) - 1.0) / square


def cylinder_factor(slenderness: float) -> float:
    """N_d of a uniformly magnetised cylinder, the mean over its volume; equation (3)."""
    from scipy.special import ellipe, ellipkm1

    if not slenderness > 0.0:
        raise InputError(f"length over diameter must be positive; got {slenderness:g}.")
    m = 1.0 / (1.0 + slenderness * slenderness)  # k^2 = d^2 / (d^2 + l^2)
    k, rest = sqrt(m), 1.0 - m
    nagaoka = 4.0 / (3.0 * pi * sqrt(rest)) * (rest / m * ellipkm1(rest) - (1.0 - 2.0 * m) / m * ellipe(m) - k)
    return float(1.0 - nagaoka)


def demagnetising_factor(slenderness: float, shape: str = "ellipsoid") -> float:
    """N_d by (2), "ellipsoid", or (3), "cylinder"."""
    if shape not in SHAPES:
        raise InputError(f'the core\'s shape must be "ellipsoid" or "cylinder"; got "{shown(str(shape))}".')
    return ellipsoid_factor(slenderness) if shape == "ellipsoid" else cylinder_factor(slenderness)


def core_gain(relative_permeability: float, factor: float) -> float:
    """Moment with the core over the moment without it, the winding over the whole core; equation (1)."""
    susceptibility = relative_permeability - 1.0
    return 1.0 + susceptibility / (1.0 + factor * susceptibility)


def core_induction(moment_a_m2: float, gain: float, factor: float, volume_m3: float) -> float:
    """B [T], the mean over a core of that volume, when the rod has that moment; (4) with M V = moment (gain - 1)/gain."""
    magnetisation = moment_a_m2 * (gain - 1.0) / gain / volume_m3
    applied = moment_a_m2 / gain / volume_m3  # n I / l = n I A / (A l)
    return MU0 * (applied + (1.0 - factor) * magnetisation)
