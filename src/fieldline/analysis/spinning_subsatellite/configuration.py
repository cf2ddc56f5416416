"""Where the axis of a spinning subsatellite can stand still against the orbit.

Axes a (from the Earth through Shuttle and attachment), b (along the orbit), c (orbit normal), turning at n about c. The
body's axis k stands at theta from c; its node is at psi from a,

    k = (sin theta sin psi, -sin theta cos psi, cos theta)                                                  (1)

The attachment is at -d k from the centre of mass and the tether pulls it by -F a, so that its torque is F d k x a. With
psi = 90 deg and theta from 0 to 360 deg, which is all there is, k stands still where (17) of the study holds,

    (C - A) n^2 sin theta cos theta + C phi' n sin theta - F d cos theta = 0                                (17)

C, A: moments of inertia about k and across it; phi': rate of the spin against the node. For theta below 180 deg the body
hangs on its tether; above, its centre of mass lies on the tether's side of the attachment. There are two solutions, or four
where the spin is slow and the offset small (an astroid):

    |C phi' n|^(2/3) + |F d|^(2/3) < |(C - A) n^2|^(2/3)                                                    (2)

With Q, beta from (20), sin beta = F d / Q and cos beta = C phi' n / Q, the two that always are lie at beta + 0 or 180 deg,

    theta = beta       - (C - A) n^2 sin 2 beta / (2 Q + 2 (C - A) n^2 cos 2 beta)                          (26a)
    theta = beta + pi  + (C - A) n^2 sin 2 beta / (2 Q - 2 (C - A) n^2 cos 2 beta)                          (26b)

to first order of (C - A) n^2 / Q. One more motion is left out by (17), as by the study: without spin (C r0 = 0) the axis in
the orbit's plane, theta = 90 deg, may swing as a pendulum, psi(t).

The tether is massless, straight and along a; F is constant; the gravity gradient on the body itself, (C - A) n^2 against
F d, is left out, as the study does.
Source: Smithsonian Astrophysical Observatory (1982), NASA-CR-170721, s. 2; printed slips in (12) to (16), (22), (23), (26)
and (27) are listed in `docs/theory/spinning_subsatellite.md`.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from fieldline.errors import InputError


@dataclass(frozen=True, kw_only=True)
class SpinningSubsatellite:
    """A symmetric body on a tether in a circular orbit; all numbers positive.

    No rigid body has C above 2 A; an example of the study does (C = 0.25 M m^2, A = 0.09 M m^2), and it is not refused.
    """

    axial_inertia_kg_m2: float  # C, about the axis through attachment and centre of mass
    transverse_inertia_kg_m2: float  # A
    tension_n: float  # F
    offset_m: float  # d, from the centre of mass to the attachment
    orbital_rate_rad_s: float  # n

    def __post_init__(self):
        """InputError names what cannot be."""
        for one in fields(self):
            value = getattr(self, one.name)
            if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not 0.0 < value < 1e300:
                raise InputError(f"{one.name} must be a positive number; got {value!r}.")

    @property
    def stiffness_n_m(self) -> float:
        """F d [N m], the tether's torque where it pulls across the axis."""
        return self.tension_n * self.offset_m

    @property
    def kappa(self) -> float:
        """F d / (A n^2), the one number beside the angle that stability depends on."""
        return self.stiffness_n_m / (self.transverse_inertia_kg_m2 * self.orbital_rate_rad_s**2)


def spin_for_angle(body: SpinningSubsatellite, theta_rad):
    """Spin phi' [rad/s] that lets the axis stand at theta (any shape, not a multiple of 180 deg): (17) solved for it.

    The rate about the axis in inertial space, r0 = phi' + n cos theta, is what (18) of the study calls r.
    """
    theta = np.asarray(theta_rad, dtype=float)
    sine, cosine = np.sin(theta), np.cos(theta)
    if not np.isfinite(theta).all() or np.any(np.abs(sine) < 1e-9):
        raise InputError("theta must be finite and not a multiple of 180 deg: only an endless spin would stand there.")
    n, difference = body.orbital_rate_rad_s, body.axial_inertia_kg_m2 - body.transverse_inertia_kg_m2
    spin = cosine * (body.stiffness_n_m / sine - difference * n**2) / (body.axial_inertia_kg_m2 * n)
    return spin if spin.ndim else float(spin)


def stationary_angles(body: SpinningSubsatellite, spin_rad_s) -> np.ndarray:
    """All theta [rad] in (0, 2 pi) at which (17) holds for a spin phi' [rad/s]: two or four, in rising order.

    For spins (m,) an array (m, 4), with NaN after the second where there are two.
    """
    spins = np.atleast_1d(np.asarray(spin_rad_s, dtype=float))
    ripple, spin, pull = _terms(body, spins)
    # With u = tan(theta / 2), (17) is a quartic: its highest and lowest coefficients do not vanish while F d does not.
    companion = np.zeros((spins.size, 4, 4))
    companion[:, 1:, :3] = np.eye(3)
    companion[:, 0] = np.stack([2.0 * (ripple - spin), np.zeros_like(spin), -2.0 * (spin + ripple), pull], -1) / pull[:, None]
    roots = np.linalg.eigvals(companion)
    order = np.argsort(np.abs(roots.imag) / (1.0 + np.abs(roots)), axis=1)
    theta = 2.0 * np.arctan(np.take_along_axis(roots, order, 1).real)
    there = np.arange(4) < np.where(four_angle_margin(body, spins) > 0.0, 4, 2)[:, None]
    found = np.sort(np.where(there, _polished(theta, ripple, spin, pull) % (2.0 * np.pi), np.nan), axis=1)
    return found if np.ndim(spin_rad_s) else found[0, np.isfinite(found[0])]


def _polished(theta, ripple, spin, pull) -> np.ndarray:
    """Angles (m, 4) after three steps of Newton's on (17); one where two angles meet stays as it is."""
    ripple, spin, pull = ripple[:, None], spin[:, None], pull[:, None]
    for _ in range(3):
        slope = ripple * np.cos(2.0 * theta) + spin * np.cos(theta) + pull * np.sin(theta)
        balance = 0.5 * ripple * np.sin(2.0 * theta) + spin * np.sin(theta) - pull * np.cos(theta)
        steep = np.abs(slope) > 1e-9
        theta = theta - np.where(steep, balance / np.where(steep, slope, 1.0), 0.0)
    return theta


def first_order_angles(body: SpinningSubsatellite, spin_rad_s: float) -> np.ndarray:
    """The two angles [rad] of (26a) and (26b), the first between 0 and 180 deg; good where Q is far above (C - A) n^2."""
    ripple, spin, pull = _terms(body, np.array([float(spin_rad_s)]))[:, 0]
    size, beta = np.hypot(spin, pull), np.arctan2(pull, spin)
    bend = ripple * np.sin(2.0 * beta)
    first = beta - bend / (2.0 * size + 2.0 * ripple * np.cos(2.0 * beta))  # (26a)
    second = beta + np.pi + bend / (2.0 * size - 2.0 * ripple * np.cos(2.0 * beta))  # (26b)
    return np.array([first, second])


def four_angle_margin(body: SpinningSubsatellite, spin_rad_s):
    """Right less left side of (2), over the largest of the terms: positive where four angles exist, negative where two."""
    ripple, spin, pull = (np.abs(term) ** (2.0 / 3.0) for term in _terms(body, np.atleast_1d(spin_rad_s)))
    margin = ripple - spin - pull
    return margin if np.ndim(spin_rad_s) else float(margin[0])


def _terms(body: SpinningSubsatellite, spins: np.ndarray) -> np.ndarray:
    """(3, m): (C - A) n^2, C phi' n and F d, over the largest of them."""
    if not np.isfinite(spins).all():
        raise InputError("spin_rad_s must be finite.")
    n = body.orbital_rate_rad_s
    ripple = (body.axial_inertia_kg_m2 - body.transverse_inertia_kg_m2) * n**2
    terms = np.stack(np.broadcast_arrays(ripple, body.axial_inertia_kg_m2 * n * spins, body.stiffness_n_m)).astype(float)
    return terms / np.abs(terms).max(axis=0)
