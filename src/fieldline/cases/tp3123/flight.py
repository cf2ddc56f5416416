"""The flight that TP-3123 simulates: orbit, field, attitude of the tethered satellite, and its magnetometer at 16 Hz.

Circular orbit with its node carried by the Earth's oblateness as the program has it (Thomson, Introduction to Space
Dynamics, p. 99), the Earth turned by the solar day:

    n = sqrt(GM / a^3),   node' = -n J cos(i) (R / a)^2,   J = 1.637e-3,   Greenwich' = 360 deg / 86,400 s      (1)

node, argument of latitude and Greenwich start at zero; the argument of latitude is brought back at twice 3.1415926, as
printed, by which the satellite jumps 1e-7 rad once an orbit. Axes (U, V, W) along the velocity, the orbit's normal and up:

            W up                      U = x_o,  V = -y_o,  W = -z_o
            |                         body axes S = (U, V, W) turned by a3 about S3, then a2 about S2, a1 about S1,
            |______ V orbit's normal
           /                          a3 = yaw bias
          / U velocity                a2 = bias + A2 sin(w t) + P2 sin(wp t + pi/4)
                                      a1 = bias + A1 cos(w t) + P1 sin(wp t + pi/4)                            (2)

(A skiprope and P the pendulous motion), exactly, not to first order. The magnetometer rounds to the nearest of 2^16
levels over +-65.536 microtesla. All numbers of the listing are used as printed, pi = 3.1415926 and deg = 0.017453292 rad too.

Source: Polites (1991), NASA TP-3123, section IV and the listing in its appendix; its physics, written anew.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.cases.tp3123.dipoles import six_dipoles
from fieldline.environment import magnetic_field
from fieldline.environment.field_record import FieldModel
from fieldline.errors import InputError, nearest
from fieldline.estimation.skiprope.signals import ORBITAL_FROM_CONE, FieldGeometry, field_geometry, field_vector
from fieldline.frames.orbital import dcm_oi

PI = 3.1415926  # the program's
DEG = 0.017453292  # [rad], the program's
GAUSS = 1e-4  # [T]
GM_KM3_S2 = 398601.2
EARTH_RADIUS_KM = 6371.2
OBLATENESS = 1.637e-3  # 1.5 J2
EARTH_RATE_RAD_S = DEG * 360.0 / 86400.0
RANGE_TESLA = 0.65536 * GAUSS
START_UTC = np.datetime64("1992-07-31T00:00", "ns")  # the first flight's day; used where another field knows time
CONSTANT_FIELD = (0.3 * GAUSS, 30.0 * DEG, 30.0 * DEG)
FIELDS = ("displaced-dipoles", "constant", "IGRF-14")


class Flight(NamedTuple):
    """n samples of the truth and of the magnetometer."""

    seconds: np.ndarray  # (n,)
    geometry: FieldGeometry  # the true field's
    field_o: np.ndarray  # (n, 3) [T] the same, orbital axes
    angles_rad: np.ndarray  # (n, 3) a1, a2, a3
    skiprope_rad: np.ndarray  # (n, 2) their parts of the skiprope: a1, a2
    pendulous_rad: np.ndarray  # (n, 2) and of the pendulous motion
    field_b: np.ndarray  # (n, 3) [T] exact
    measured_b: np.ndarray  # (n, 3) [T] as read


def fly(
    *,
    duration_s: float,
    rate_hz: float = 16.0,
    skiprope_frequency_hz: float = 0.005,
    skiprope_deg=(0.75, 0.5),
    pendulous_frequency_hz: float = 0.03125,
    pendulous_deg=(2.0, 2.0),
    bias_deg=(1.0, 1.0, 5.0),
    field: str | FieldModel = "displaced-dipoles",
    bits: int = 16,
    noise_tesla: float = 0.0,
    seed: int = 0,
    altitude_km: float = 300.0,
    inclination_deg: float = 28.5,
) -> Flight:
    """The flight of the module's docstring from rest to `duration_s`, both ends included.

    skiprope_deg, pendulous_deg : amplitudes in (a1, a2). bias_deg : of (a1, a2, a3). bits : 0 for a reading without digits.
    """
    seconds = np.arange(int(duration_s * rate_hz) + 1) / rate_hz
    geometry = field_along_orbit(seconds, field, altitude_km=altitude_km, inclination_deg=inclination_deg)
    skiprope = DEG * np.asarray(skiprope_deg) * _in_quadrature(2.0 * PI * skiprope_frequency_hz * seconds)
    swing = np.sin(2.0 * PI * pendulous_frequency_hz * seconds + DEG * 45.0)
    pendulous = DEG * np.asarray(pendulous_deg) * swing[:, None]
    angles = np.tile(DEG * np.asarray(bias_deg, dtype=float), (len(seconds), 1))
    angles[:, :2] += skiprope + pendulous  # (2)
    field_c = field_vector(geometry)
    field_b = np.einsum("nij,nj->ni", dcm_321(angles), field_c)
    noise = noise_tesla * np.random.default_rng(seed).standard_normal(field_b.shape) if noise_tesla else 0.0
    measured = read_digits(field_b + noise, bits, RANGE_TESLA)
    return Flight(seconds, geometry, field_c @ ORBITAL_FROM_CONE, angles, skiprope, pendulous, field_b, measured)


def field_along_orbit(
    seconds, field: str | FieldModel = "displaced-dipoles", *, altitude_km: float = 300.0, inclination_deg: float = 28.5
) -> FieldGeometry:
    """The field along the orbit (1) at times (n,) [s]: the program's, its constant one, or any model of ours."""
    if isinstance(field, str) and field == "constant":
        field_c = field_vector(FieldGeometry(*(np.full(len(seconds), value) for value in CONSTANT_FIELD)))
        return field_geometry(field_c)  # through the components and back, as the program goes
    if isinstance(field, str) and field not in FIELDS:
        raise InputError(f'field must be one of {", ".join(FIELDS)}, or a FieldModel; got "{field}": {nearest(field, FIELDS)}')
    position_e, along_e = orbit(seconds, altitude_km, inclination_deg)
    model = six_dipoles() if field == "displaced-dipoles" else field
    field_e = magnetic_field(position_e, START_UTC, model)
    return field_geometry(np.einsum("nij,nj->ni", dcm_oi(position_e, along_e), field_e) @ ORBITAL_FROM_CONE)


def orbit_rates(altitude_km: float = 300.0, inclination_deg: float = 28.5) -> tuple[float, float]:
    """Mean motion and rate of the node [rad/s], equation (1)."""
    radius = EARTH_RADIUS_KM + altitude_km
    mean_motion = np.sqrt(GM_KM3_S2 / radius**3)
    return float(mean_motion), float(-mean_motion * OBLATENESS * np.cos(DEG * inclination_deg) * (EARTH_RADIUS_KM / radius) ** 2)


def orbit(seconds, altitude_km: float, inclination_deg: float) -> tuple[np.ndarray, np.ndarray]:
    """Position (n, 3) [m] and direction of flight (n, 3), the velocity's in inertial space, both in ITRS axes."""
    mean_motion, node_rate = orbit_rates(altitude_km, inclination_deg)
    argument = np.mod(mean_motion * np.asarray(seconds), 2.0 * PI)
    node = (node_rate - EARTH_RATE_RAD_S) * np.asarray(seconds)  # from Greenwich
    cu, su, cn, sn = np.cos(argument), np.sin(argument), np.cos(node), np.sin(node)
    ci, si = np.cos(DEG * inclination_deg), np.sin(DEG * inclination_deg)
    position = np.stack([cn * cu - sn * su * ci, sn * cu + cn * su * ci, su * si], axis=-1)
    along = np.stack([-cn * su - sn * cu * ci, -sn * su + cn * cu * ci, cu * si], axis=-1)
    return 1e3 * (EARTH_RADIUS_KM + altitude_km) * position, along


def dcm_321(angles_rad) -> np.ndarray:
    """(n, 3, 3) with v_b = dcm @ v_c, of angles (n, 3) a1, a2, a3: a3 about the third axis, then a2, then a1."""
    (c1, c2, c3), (s1, s2, s3) = np.cos(angles_rad).T, np.sin(angles_rad).T
    rows = (
        (c2 * c3, c2 * s3, -s2),
        (s1 * s2 * c3 - c1 * s3, s1 * s2 * s3 + c1 * c3, s1 * c2),
        (c1 * s2 * c3 + s1 * s3, c1 * s2 * s3 - s1 * c3, c1 * c2),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def read_digits(field, bits: int, range_tesla: float) -> np.ndarray:
    """The field [T] on 2^bits levels over +-range_tesla, halves up; 0 bits leave it as it is."""
    if bits == 0:
        return np.asarray(field)
    step = 2.0 * range_tesla / 2.0**bits
    held = np.clip(field, -range_tesla, range_tesla - step)
    return np.floor((held + range_tesla + 0.5 * step) / step) * step - range_tesla


def true_cone(flight: Flight) -> tuple[np.ndarray, np.ndarray]:
    """Tilt [rad] and azimuth [rad] (as the field's: from V towards -U) of S3 by the skiprope and yaw alone, each (n,)."""
    angles = np.column_stack([flight.skiprope_rad, flight.angles_rad[:, 2]])
    u, v, _ = dcm_321(angles)[:, 2].T
    return np.hypot(u, v), np.arctan2(-u, v)


def _in_quadrature(phase) -> np.ndarray:
    """(n, 2): the cosine that a1 follows and the sine that a2 does."""
    return np.stack([np.cos(phase), np.sin(phase)], axis=-1)
