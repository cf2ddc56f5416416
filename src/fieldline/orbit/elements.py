"""Keplerian elements and states, either way, at every inclination and eccentricity.

    h = r x v,   n = z x h,   e = v x h / GM - r / |r|,   1/a = 2/|r| - v^2/GM                              (1)
    r = p / (1 + e cos nu) (cos u N + sin u M),   p = a (1 - e^2),   u = omega + nu                        (2)
    v = sqrt(GM / p) (-(sin u + e sin omega) N + (cos u + e cos omega) M)                                  (3)
    M_mean = E - e sin E,   tan nu/2 = sqrt((1 + e) / (1 - e)) tan E/2                                     (4)

N is the direction of the ascending node and M that a quarter of a turn further along the orbit. Where the orbit lies in
the equator it has no node: N is the x axis, raan = 0. Where it is a circle it has no perigee: omega = 0, and the true
anomaly counts from N. Both conventions make the elements of any state definite and bring the state back.

With the oblateness the elements drift, to the first order in J2 (mean elements a, e, i; n = sqrt(GM/a^3)),

    raan' = -3/2 n J2 (R/p)^2 cos i,      omega' = 3/4 n J2 (R/p)^2 (4 - 5 sin^2 i)                         (5)
    M' = n (1 + 3/2 J2 (R/p)^2 sqrt(1 - e^2) (1 - 3/2 sin^2 i))                                            (6)

Angles in radians. Source: Vallado (2013), Fundamentals of Astrodynamics and Applications, 4th ed., s. 2.4, 2.5 and 9.6.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2, EARTH_J2
from fieldline.errors import InputError

NO_PLACE = 1e-11  # eccentricity or sine of the inclination below which perigee or node is only rounding
KEPLER_ACCURACY = 1e-14
MOST_ITERATIONS = 50
ENTRY_HEIGHT_M = 120e3  # air ends an orbit below it within about a day
TURN = 2.0 * np.pi


class Elements(NamedTuple):
    """Osculating elements, numbers or arrays of one shape."""

    semi_major_axis_m: float  # negative for a hyperbola
    eccentricity: float
    inclination_rad: float
    raan_rad: float  # right ascension of the ascending node
    argument_of_perigee_rad: float
    true_anomaly_rad: float

    @property
    def perigee_height_m(self) -> float:
        """Height [m] of the perigee over the Earth's equatorial radius."""
        return self.semi_major_axis_m * (1.0 - self.eccentricity) - EARTH_EQUATORIAL_RADIUS_M

    @property
    def semi_latus_rectum_m(self) -> float:
        """P of (2) [m]."""
        return self.semi_major_axis_m * (1.0 - self.eccentricity**2)


class SecularRates(NamedTuple):
    """Drift of the elements by J2 [rad/s], equations (5) and (6)."""

    raan: float
    argument_of_perigee: float
    mean_anomaly: float

    @property
    def nodal_period_s(self) -> float:
        """From one ascending node to the next [s]."""
        return TURN / (self.argument_of_perigee + self.mean_anomaly)


def state_from_elements(elements: Elements, gm_m3_s2: float = EARTH_GM_M3_S2) -> tuple[np.ndarray, np.ndarray]:
    """Position (..., 3) [m] and velocity (..., 3) [m/s], the elements' axes; equations (2) and (3).

    InputError for elements of no conic, NaN, an inclination outside 0 to pi, or an anomaly beyond a hyperbola's asymptote.
    """
    a, e, inclination, raan, perigee, anomaly = np.broadcast_arrays(*(np.asarray(part, dtype=float) for part in elements))
    _refuse_bad_elements(a, e, inclination, raan + perigee + anomaly)
    outward = 1.0 + e * np.cos(anomaly)
    if (outward <= 0.0).any():
        raise InputError(f"true_anomaly_rad lies beyond the asymptote of a hyperbola of eccentricity {np.max(e):g}.")
    along_node, ahead = _plane(inclination, raan)
    p, u = a * (1.0 - e * e), perigee + anomaly
    position = (p / outward)[..., None] * (np.cos(u)[..., None] * along_node + np.sin(u)[..., None] * ahead)
    across, onward = np.sin(u) + e * np.sin(perigee), np.cos(u) + e * np.cos(perigee)
    velocity = np.sqrt(gm_m3_s2 / p)[..., None] * (onward[..., None] * ahead - across[..., None] * along_node)
    return position, velocity


def elements_from_state(position_m, velocity_m_s, gm_m3_s2: float = EARTH_GM_M3_S2) -> Elements:
    """Elements of positions (..., 3) [m] and velocities (..., 3) [m/s] in axes whose z is the pole; equation (1).

    The angles lie in 0 to 2 pi (inclination 0 to pi). Hyperbolas have a negative axis.
    InputError for motion along a straight line through the centre, zero or NaN, and at exactly the speed of escape.
    """
    r, v = np.asarray(position_m, dtype=float), np.asarray(velocity_m_s, dtype=float)
    distance, speed = np.linalg.norm(r, axis=-1), np.linalg.norm(v, axis=-1)
    h = np.cross(r, v)
    momentum = np.linalg.norm(h, axis=-1)
    if not (momentum > 1e-12 * distance * speed).all():
        raise InputError("position_m and velocity_m_s must not be parallel, zero or NaN: such a motion is no orbit.")
    inverse_axis = 2.0 / distance - speed**2 / gm_m3_s2
    if (inverse_axis == 0.0).any():
        raise InputError("velocity_m_s is exactly the speed of escape: a parabola has no semi-major axis.")
    inclination = np.arctan2(np.hypot(h[..., 0], h[..., 1]), h[..., 2])
    level = np.hypot(h[..., 0], h[..., 1]) < NO_PLACE * momentum
    raan = np.where(level, 0.0, np.arctan2(h[..., 0], -h[..., 1]))
    along_node = np.stack([np.cos(raan), np.sin(raan), np.zeros_like(raan)], axis=-1)
    ahead = np.cross(h / momentum[..., None], along_node)
    e = np.cross(v, h) / gm_m3_s2 - r / distance[..., None]
    eccentricity = np.linalg.norm(e, axis=-1)
    latitude = np.arctan2(_dot(r, ahead), _dot(r, along_node))
    perigee = np.where(eccentricity < NO_PLACE, 0.0, np.arctan2(_dot(e, ahead), _dot(e, along_node)))
    parts = (
        1.0 / inverse_axis,
        eccentricity,
        inclination,
        _once_round(raan),
        _once_round(perigee),
        _once_round(latitude - perigee),
    )
    return Elements(*(float(part) if np.ndim(part) == 0 else part for part in parts))


def true_anomaly(mean_anomaly_rad, eccentricity):
    """True anomaly [rad] of a mean one on an ellipse, in the same turn; Kepler's equation (4), by Newton's method.

    Started at pi it falls monotonically to the root for every eccentricity below 1. InputError for any other.
    """
    mean, e = np.broadcast_arrays(np.asarray(mean_anomaly_rad, dtype=float), np.asarray(eccentricity, dtype=float))
    if not ((e >= 0.0) & (e < 1.0)).all() or not np.isfinite(mean).all():
        raise InputError("Kepler's equation needs finite anomalies and eccentricities from 0 to below 1.")
    turns = np.round(mean / TURN)
    within = mean - TURN * turns
    half = np.abs(within)
    anomaly = np.full(mean.shape, np.pi)
    for _ in range(MOST_ITERATIONS):
        change = (anomaly - e * np.sin(anomaly) - half) / (1.0 - e * np.cos(anomaly))
        anomaly = anomaly - change
        if np.abs(change).max(initial=0.0) < KEPLER_ACCURACY:
            break
    true = 2.0 * np.arctan2(np.sqrt(1.0 + e) * np.sin(0.5 * anomaly), np.sqrt(1.0 - e) * np.cos(0.5 * anomaly))
    return np.copysign(true, within) + TURN * turns


def mean_anomaly(true_anomaly_rad, eccentricity):
    """Mean anomaly [rad] of a true one on an ellipse, in the same turn; equation (4)."""
    true, e = np.asarray(true_anomaly_rad, dtype=float), np.asarray(eccentricity, dtype=float)
    turns = np.round(true / TURN)
    half = 0.5 * (true - TURN * turns)
    anomaly = 2.0 * np.arctan2(np.sqrt(1.0 - e) * np.sin(half), np.sqrt(1.0 + e) * np.cos(half))
    return anomaly - e * np.sin(anomaly) + TURN * turns


def mean_motion(semi_major_axis_m, gm_m3_s2: float = EARTH_GM_M3_S2):
    """N = sqrt(GM / a^3) [rad/s] of an ellipse about a point."""
    return np.sqrt(gm_m3_s2 / np.asarray(semi_major_axis_m, dtype=float) ** 3)[()]


def secular_rates(semi_major_axis_m: float, eccentricity: float, inclination_rad: float) -> SecularRates:
    """Drift of node, perigee and mean anomaly [rad/s] by J2; equations (5) and (6), good to 1e-3 of the drift itself."""
    n = float(mean_motion(semi_major_axis_m))
    p = semi_major_axis_m * (1.0 - eccentricity**2)
    k = EARTH_J2 * (EARTH_EQUATORIAL_RADIUS_M / p) ** 2
    square = np.sin(inclination_rad) ** 2
    return SecularRates(
        raan=float(-1.5 * n * k * np.cos(inclination_rad)),
        argument_of_perigee=float(0.75 * n * k * (4.0 - 5.0 * square)),
        mean_anomaly=float(n * (1.0 + 1.5 * k * np.sqrt(1.0 - eccentricity**2) * (1.0 - 1.5 * square))),
    )


def circular_orbit(altitude_m: float, inclination_rad: float, raan_rad: float = 0.0, argument_of_latitude_rad=0.0) -> Elements:
    """Elements of a circle [m, rad]; the altitude counts from the Earth's equatorial radius, 6378136.6 m."""
    axis = EARTH_EQUATORIAL_RADIUS_M + altitude_m
    return Elements(axis, 0.0, inclination_rad, raan_rad, 0.0, argument_of_latitude_rad)


def check_orbit(elements: Elements, *, unbound: bool = False) -> list[str]:
    """Warnings about one orbit of the Earth; InputError when it meets the ground or, unless `unbound`, does not return."""
    height_km, e = 1e-3 * elements.perigee_height_m, elements.eccentricity
    if e >= 1.0 and not unbound:
        raise InputError(
            f"the orbit is no ellipse: its eccentricity is {e:.4g}. Is the velocity in m/s and relative to inertial axes?"
        )
    if height_km <= 0.0:
        raise InputError(
            f"the orbit meets the ground: its perigee lies {-height_km:.4g} km below the Earth's equatorial radius "
            f"(semi-major axis {elements.semi_major_axis_m:.6g} m, eccentricity {e:.4g}). Are lengths in metres?"
        )
    if height_km < 1e-3 * ENTRY_HEIGHT_M:
        return [f"the perigee is at {height_km:.4g} km: with drag the satellite stays less than about a day."]
    return []


def _plane(inclination, raan) -> tuple[np.ndarray, np.ndarray]:
    """N and M of (2), (..., 3) each."""
    c, s, zero = np.cos(raan), np.sin(raan), np.zeros_like(raan)
    along_node = np.stack([c, s, zero], axis=-1)
    ahead = np.stack([-s * np.cos(inclination), c * np.cos(inclination), np.sin(inclination)], axis=-1)
    return along_node, ahead


def _refuse_bad_elements(a, e, inclination, angles) -> None:
    """InputError for what is no conic."""
    if not (e >= 0.0).all() or not (a * (1.0 - e) > 0.0).all() or not np.isfinite(a).all():
        raise InputError(
            "elements must have a positive semi_major_axis_m with an eccentricity from 0 to below 1 (or both a hyperbola's: "
            f"negative and above 1); got {np.min(a):.6g} m and {np.max(e):.6g}."
        )
    if not ((inclination >= 0.0) & (inclination <= np.pi)).all():
        raise InputError(
            f"inclination_rad must lie within 0 and pi; got {np.max(inclination):.6g}. Is it in degrees? Use np.radians."
        )
    if not np.isfinite(angles).all():
        raise InputError("raan_rad, argument_of_perigee_rad and true_anomaly_rad must be finite numbers.")


def _once_round(angle) -> np.ndarray:
    """The angle within 0 and 2 pi, the latter left out: a remainder of -1e-17 is rounded to 2 pi."""
    within = angle % TURN
    return np.where(within < TURN, within, 0.0)


def _dot(a, b) -> np.ndarray:
    """Scalar products of rows."""
    return np.sum(a * b, axis=-1)
