"""Whether the axis of a spinning subsatellite stays where it can stand.

About a stationary angle theta0 (psi = 90 deg) the small motion, (37) of the study with its second line times sin theta0, is

    A theta1'' - g psi1' + k1 theta1 = 0,    A S^2 psi1'' + g theta1' + F d S psi1 = 0                       (1)
    g = (2 A n c - C r0) S,    k1 = C r0 n c + F d S - A n^2 cos 2 theta0                                   (2)

with S, c the sine and cosine of theta0 and C r0 n S = A n^2 S c + F d c. Its characteristic equation in mu = lambda^2,

    mu^2 A^2 S + mu {A F d (1 + S^2) - 3 A C r0 n S c + A^2 n^2 S (3 c^2 + S^2) + C^2 r0^2 S} + F d k1 = 0   (39)

is that of a gyroscopic system: beside real roots it may have complex ones. The motion is stable where both roots are real
and negative, which asks for three signs alike and p1^2 > 4 p2 p0. Below 180 deg the angle is a minimum of the Jacobi
integral, k1 > 0 and F d S > 0: "minimum". Above, it is a maximum, and stable only by the gyroscopic terms: "gyroscopic",
until at a critical angle the two frequencies meet and the axis spirals out: "flutter". "divergence": a root is positive.

The coefficients over A^2 n^4 hold F d / (A n^2) = kappa and theta0 alone: neither C nor the spin by itself.
Source: NASA-CR-170721 (1982), s. 2.6, corrected: its (39) and (43) have slips, its roots "cannot be complex", and its second
branch is not unstable at large.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fieldline.analysis.spinning_subsatellite.configuration import (
    SpinningSubsatellite,
    four_angle_margin,
    spin_for_angle,
    stationary_angles,
)
from fieldline.errors import InputError

KINDS = ("minimum", "gyroscopic", "flutter", "divergence")
MOST_POINTS = 250_000
LEAST_KAPPA, MOST_KAPPA = 1e-3, 1e9  # between which the critical angle is looked for
CLOSE = 1e-12  # of p1^2: a double root


def characteristic_coefficients(kappa, theta_rad) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """p2, p1, p0 of (39) over A^2 n^4, for mu in units of n^2; kappa = F d / (A n^2) and theta0, of any shape together."""
    kappa, theta = np.broadcast_arrays(np.asarray(kappa, dtype=float), np.asarray(theta_rad, dtype=float))
    if not (np.isfinite(kappa) & (kappa > 0.0)).all() or not np.isfinite(theta).all() or np.any(np.abs(np.sin(theta)) < 1e-9):
        raise InputError("kappa must be positive and theta0 not a multiple of 180 deg: no finite spin stands there.")
    sine, cosine = np.sin(theta), np.cos(theta)
    momentum = cosine * (1.0 + kappa / sine)  # C r0 / (A n)
    middle = kappa * (1.0 + sine**2) - 3.0 * momentum * sine * cosine
    middle = middle + sine * (3.0 * cosine**2 + sine**2 + momentum**2)
    return sine, middle, kappa * _stiffness(kappa, theta)


def _stiffness(kappa, theta):
    """k1 of (2) over A n^2."""
    sine, cosine = np.sin(theta), np.cos(theta)
    return cosine**2 * (1.0 + kappa / sine) + kappa * sine - np.cos(2.0 * theta)


def squared_exponents(kappa, theta_rad) -> np.ndarray:
    """(..., 2) complex: the roots mu of (39) in units of n^2, the larger in size first."""
    p2, p1, p0 = characteristic_coefficients(kappa, theta_rad)
    root = np.sqrt((p1**2 - 4.0 * p2 * p0).astype(complex))
    # The sum of like signs, and the other by the product: no digits are lost where the roots lie far apart.
    far = -0.5 * (p1 + np.where((p1 * root.real) >= 0.0, root, -root))
    return np.stack([far / p2, p0 / far], axis=-1)


def growth_rate(body: SpinningSubsatellite, theta_rad):
    """Rate [1/s] at which the linear motion about theta0 grows; 0 where it is stable."""
    rate = body.orbital_rate_rad_s * _growth(body.kappa, theta_rad)
    return rate if rate.ndim else float(rate)


def _growth(kappa, theta):
    """Growth rate over n."""
    p2, p1, p0 = characteristic_coefficients(kappa, theta)
    stable = (p1 / p2 > 0.0) & (p0 / p2 >= 0.0) & (p1**2 - 4.0 * p2 * p0 >= -CLOSE * p1**2)
    fastest = np.sqrt(squared_exponents(kappa, theta)).real.max(axis=-1)
    return np.where(stable, 0.0, fastest)


def frequencies(body: SpinningSubsatellite, theta_rad) -> np.ndarray:
    """(..., 2) angular frequencies [rad/s] of a stable theta0, the fast one (nutation) first; NaN where it is not stable."""
    mu = squared_exponents(body.kappa, theta_rad)
    stable = _growth(body.kappa, theta_rad) == 0.0
    return np.where(stable[..., None], body.orbital_rate_rad_s * np.sqrt(np.abs(mu)), np.nan)


def kind_of(kappa, theta_rad) -> np.ndarray:
    """One of KINDS for each kappa and theta0."""
    p2, p1, p0 = characteristic_coefficients(kappa, theta_rad)
    grows = _growth(kappa, theta_rad) > 0.0
    lowest = (p2 > 0.0) & (_stiffness(np.asarray(kappa, dtype=float), np.asarray(theta_rad, dtype=float)) > 0.0)
    unstable = np.where(p1**2 < 4.0 * p2 * p0, "flutter", "divergence")
    return np.where(grows, unstable, np.where(lowest, "minimum", "gyroscopic"))


def critical_angle(kappa: float) -> float:
    """The first theta0 [rad] above 180 deg at which the upper branch is unstable; its mirror is 540 deg less it.

    From kappa about 0.6 on it stays unstable to 270 deg; below, stable stretches follow before the pull alone upsets it.
    For kappa from 1e-3 to 1e9. It nears the sleeping top's limit, C r0 = 2 sqrt(A F d), from below as kappa grows.
    """
    if not LEAST_KAPPA <= kappa <= MOST_KAPPA:
        raise InputError(f"kappa = F d / (A n^2) must lie in {LEAST_KAPPA:g} to {MOST_KAPPA:g}; got {kappa!r}.")
    near = np.geomspace(1e-6, 0.25 * np.pi, 1000)
    # Where the pull is weak, the first unstable angles are few and lie at sin theta0 = -kappa.
    weak = kappa * np.linspace(0.9, 1.1, 2001) if kappa < 0.1 else near
    grid = np.pi + np.unique(np.concatenate([near, weak, 0.5 * np.pi - near]))
    first = int(np.flatnonzero(_growth(kappa, grid) > 0.0)[0])
    low, high = grid[first - 1], grid[first]
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _growth(kappa, middle) > 0.0 else (middle, high)
    return float(0.5 * (low + high))


def critical_spin(body: SpinningSubsatellite) -> float:
    """The spin phi' [rad/s] above which the upper branch is stable, that of `critical_angle`."""
    return float(spin_for_angle(body, critical_angle(body.kappa)))


def stability_map(body: SpinningSubsatellite, spin_rad_s, offset_m):
    """Every stationary angle over a grid of spins and offsets, with its kind and growth, as an xarray Dataset.

    Parameters
    ----------
    body : mass properties, tension and orbital rate; its offset is replaced by each of `offset_m`.
    spin_rad_s, offset_m : (m,) of either sign, and (n,) positive.

    Returns
    -------
    Dataset over spin, offset and solution (up to 4, NaN and "" where there are fewer): theta [rad], growth [1/s], kind,
    hangs (theta below 180 deg); margin (spin, offset) of `four_angle_margin`; critical_spin (offset) [rad/s], NaN where
    kappa is beyond what `critical_angle` takes.
    """
    import xarray as xr

    spins, offsets = (np.atleast_1d(np.asarray(values, dtype=float)) for values in (spin_rad_s, offset_m))
    if spins.ndim > 1 or offsets.ndim > 1 or spins.size * offsets.size > MOST_POINTS:
        raise InputError(f"spin_rad_s and offset_m must be lists of at most {MOST_POINTS} pairs together.")
    theta = np.full((spins.size, offsets.size, 4), np.nan)
    growth, kinds = theta.copy(), np.full(theta.shape, "", dtype="U10")
    margin, limit = np.empty(theta.shape[:2]), np.empty(offsets.size)
    for j, offset in enumerate(offsets):
        here = replace(body, offset_m=float(offset))
        limit[j] = critical_spin(here) if LEAST_KAPPA <= here.kappa <= MOST_KAPPA else np.nan
        theta[:, j] = stationary_angles(here, spins)
        margin[:, j] = four_angle_margin(here, spins)
        there = np.isfinite(theta[:, j])
        growth[:, j][there] = growth_rate(here, theta[:, j][there])
        kinds[:, j][there] = kind_of(here.kappa, theta[:, j][there])
    grid = ("spin", "offset", "solution")
    return xr.Dataset(
        {
            "theta": (grid, theta, {"units": "rad", "long_name": "angle of the axis from the orbit normal"}),
            "growth": (grid, growth, {"units": "s-1", "long_name": "rate at which a small motion grows"}),
            "kind": (grid, kinds),
            "hangs": (grid, theta < np.pi, {"long_name": "centre of mass beyond the attachment, seen along the tether"}),
            "margin": (("spin", "offset"), margin, {"units": "1", "long_name": "positive where four angles exist"}),
            "critical_spin": ("offset", limit, {"units": "rad s-1", "long_name": "spin above which the upper branch is stable"}),
        },
        coords={"spin": ("spin", spins, {"units": "rad s-1"}), "offset": ("offset", offsets, {"units": "m"})},
    )
