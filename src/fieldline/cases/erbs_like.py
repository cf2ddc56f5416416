"""A synthetic arc like that of the Earth Radiation Budget Satellite in January 1989: truth, and what a magnetometer gives.

The paper used one hour of flown data that is not at hand. This stands in for it: a circular orbit at 600 km, 57 degrees
inclined, from 1989-01-15 00:00:25 UTC, a field model, and a body that turns at the paper's mean rate. Its attitude is not
given, so it is either Earth-pointing, with the rate along the orbit's normal (0.062 deg/s is one turn an orbit), or random.
The paper gives no amplitude for the oscillation of the rates: 0.01 deg/s as a vector at a period of 75 s was chosen so
that the errors at a step of 120 s are about the 5 degrees that it states.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.environment import magnetic_field
from fieldline.errors import InputError
from fieldline.frames.attitude import quat_exp, quat_mul, quat_unit
from fieldline.frames.earth_rotation import dcm_ei
from fieldline.frames.vectors import vec
from fieldline.mechanics.rigid_body import turn

RADIUS_M = 6_978_137.0
INCLINATION_DEG = 57.0
START_UTC = np.datetime64("1989-01-15T00:00:25", "ns")
LENGTH_S = 3552.0  # 890115.000025 to 890115.005937
OSCILLATION_PHASES = np.array([0.0, 2.0, 4.0])  # [rad] of the three axes
INNER_STEP_S = 0.5  # 1/150 of the oscillation's period
ATTITUDES = ("earth-pointing", "random")


class Arc(NamedTuple):
    """n samples of the truth and of the magnetometer."""

    time_utc: np.ndarray
    seconds: np.ndarray
    position_i: np.ndarray  # (n, 3) [m]
    field_i: np.ndarray  # (n, 3) [T]
    q_bi: np.ndarray  # (n, 4)
    omega_b: np.ndarray  # (n, 3) [rad/s]
    field_b: np.ndarray  # (n, 3) [T], exact
    measured_b: np.ndarray  # (n, 3) [T], digitised


@njit(cache=True)
def turned_kernel(q0, omega_b, dt, q_out):
    """Fill (n, 4) attitudes from rates (n, 3) at steps dt by the Magnus series, rates' slopes from their differences."""
    count = omega_b.shape[0]
    q = q0
    for k in range(count):
        for j in range(4):
            q_out[k, j] = q[j]
        if k + 1 < count:
            here, there = vec(omega_b, k), vec(omega_b, k + 1)
            q = quat_unit(quat_mul(q, quat_exp(turn(here, there, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), dt))))


def number(name: str, value, least: float, most: float = np.inf) -> float:
    """The value as a float within bounds, or a refusal that names it."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not least <= value <= most:
        bounds = f"{least:g} or more" if np.isinf(most) else f"{least:g} to {most:g}"
        raise InputError(f"{name} must be a number, {bounds}; got {value!r}.")
    return float(value)


def three_rates(rate_deg_s) -> np.ndarray:
    """(3,) [deg/s], or a refusal."""
    try:
        rate = np.asarray(rate_deg_s, dtype=float)
    except (TypeError, ValueError):
        rate = np.empty(0)
    if rate.shape != (3,) or not np.isfinite(rate).all():
        raise InputError(f"rate_deg_s must be three finite numbers, about body x, y and z; got {rate_deg_s!r}.")
    return rate


def circular_orbit(seconds, ascending_node_deg=0.0, argument_deg=0.0) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) [m] and the unit normal (3,), inertial axes."""
    angle = np.radians(argument_deg) + np.sqrt(EARTH_GM_M3_S2 / RADIUS_M**3) * np.asarray(seconds)
    node, tilt = np.radians(ascending_node_deg), np.radians(INCLINATION_DEG)
    ahead = np.array([np.cos(node), np.sin(node), 0.0])
    normal = np.array([np.sin(node) * np.sin(tilt), -np.cos(node) * np.sin(tilt), np.cos(tilt)])
    position = np.cos(angle)[:, None] * ahead + np.sin(angle)[:, None] * np.cross(normal, ahead)
    return RADIUS_M * position, normal


def rates(seconds, rate_deg_s, oscillation_deg_s, period_s) -> np.ndarray:
    """(n, 3) [rad/s]: the mean rate and an oscillation of that amplitude as a vector, shared equally by the axes."""
    waves = np.sin(np.multiply.outer(2.0 * np.pi * np.asarray(seconds) / period_s, np.ones(3)) + OSCILLATION_PHASES)
    return np.radians(np.asarray(rate_deg_s, dtype=float) + oscillation_deg_s / np.sqrt(3.0) * waves)


def attitudes(seconds, q0_bi, rate_deg_s, oscillation_deg_s, period_s) -> np.ndarray:
    """(n, 4) at equally spaced `seconds` from q0_bi, on an inner step of half a second at most."""
    interval = float(seconds[1] - seconds[0])
    parts = max(1, int(np.ceil(interval / INNER_STEP_S))) if oscillation_deg_s else 1
    fine = seconds[0] + interval / parts * np.arange(parts * (len(seconds) - 1) + 1)
    out = np.empty((len(fine), 4))
    turned_kernel(tuple(map(float, q0_bi)), rates(fine, rate_deg_s, oscillation_deg_s, period_s), interval / parts, out)
    return out[::parts]


def first_attitude(attitude: str, rate_deg_s, normal_i, seed: int) -> np.ndarray:
    """(4,): Earth-pointing has the rate along the orbit's normal; random is drawn from `seed`."""
    from scipy.spatial.transform import Rotation

    if attitude not in ATTITUDES:
        raise InputError(f'attitude must be "earth-pointing" or "random"; got "{attitude}".')
    if attitude == "random":
        return Rotation.random(rng=np.random.default_rng(int(seed))).as_quat()
    axis = np.asarray(rate_deg_s, dtype=float)
    if not np.linalg.norm(axis) > 0.0:
        raise InputError('an Earth-pointing attitude needs a rate to lay along the orbit\'s normal; use attitude="random".')
    return Rotation.align_vectors(normal_i[None], axis[None] / np.linalg.norm(axis))[0].as_quat()


def erbs_like_arc(
    *,
    rate_deg_s=(-0.018, 0.049, -0.034),
    oscillation_deg_s: float = 0.0,
    oscillation_period_s: float = 75.0,
    quantisation_tesla: float = 6.44e-7,
    noise_tesla: float = 0.0,
    attitude: str = "earth-pointing",
    ascending_node_deg: float = 0.0,
    argument_deg: float = 0.0,
    interval_s: float = 8.0,
    length_s: float = LENGTH_S,
    seed: int = 20,
    model: str = "IGRF-14",
) -> Arc:
    """The arc of the module's docstring, with digits of `quantisation_tesla` (0: none) and white noise on the field."""
    rate_deg_s = three_rates(rate_deg_s)
    length_s = number("length_s", length_s, 1.0)
    interval_s = number("interval_s", interval_s, 1e-3, length_s / 2.0)
    number("oscillation_deg_s", oscillation_deg_s, 0.0)
    number("oscillation_period_s", oscillation_period_s, 10.0 * INNER_STEP_S)
    number("quantisation_tesla", quantisation_tesla, 0.0)
    number("noise_tesla", noise_tesla, 0.0)
    for name, angle in (("ascending_node_deg", ascending_node_deg), ("argument_deg", argument_deg)):
        number(name, angle, -1e6, 1e6)
    number("seed", seed, 0)
    seconds = interval_s * np.arange(int(length_s / interval_s + 1e-9) + 1)
    time_utc = START_UTC + np.round(seconds * 1e9).astype("timedelta64[ns]")
    position_i, normal_i = circular_orbit(seconds, ascending_node_deg, argument_deg)
    dcm = dcm_ei(time_utc)
    field_e = magnetic_field(np.einsum("nij,nj->ni", dcm, position_i), time_utc, model=model)
    field_i = np.einsum("nji,nj->ni", dcm, field_e)
    q0 = first_attitude(attitude, rate_deg_s, normal_i, seed)
    q_bi = attitudes(seconds, q0, rate_deg_s, oscillation_deg_s, oscillation_period_s)
    field_b = _in_body(q_bi, field_i)
    measured = field_b + noise_tesla * np.random.default_rng(int(seed)).standard_normal(field_b.shape)
    if quantisation_tesla > 0.0:
        measured = np.round(measured / quantisation_tesla) * quantisation_tesla
    omega_b = rates(seconds, rate_deg_s, oscillation_deg_s, oscillation_period_s)
    return Arc(time_utc, seconds, position_i, field_i, q_bi, omega_b, field_b, measured)


def _in_body(q_bi, field_i) -> np.ndarray:
    """(n, 3) of inertial vectors in body axes."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(q_bi).inv().apply(field_i)
