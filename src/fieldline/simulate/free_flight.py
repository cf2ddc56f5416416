"""A satellite left to itself: rigid body in the field and the gravity gradient along a given orbit.

    I dw/dt = m x B_b + 3 GM / r^3 u x (I u) - w x (I w) + disturbance                                   (1)

m: residual dipole [A m2]; the disturbance is white in angular acceleration. With `pointing` "earth" the body is held at
one revolution per orbit instead (x along velocity, y against the orbit normal, z to nadir) with a libration about it, as
by a boom or wheels that the telemetry does not show. The torque is held over an inner step of at most 0.02 rad of turn.

Truth for the estimators' tests and for trying them out; vehicles with actuators have a plant of their own.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numba import njit

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError
from fieldline.frames.attitude import quaternion_from_dcm, to_body
from fieldline.frames.vectors import add, axpy, cross, norm, scale, vec
from fieldline.mechanics.rigid_body import as_inertia9, gravity_gradient_torque, torqued_step
from fieldline.simulate.magnetometer import Magnetometer
from fieldline.telemetry import Telemetry

LARGEST_TURN = 0.02  # [rad] of an inner step
LONGEST_STEP = 1.0  # [s]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FreeFlight:
    """Telemetry with the truth behind it: q_bi (n, 4), omega_bi_b (n, 3) [rad/s], field_b (n, 3) [T]."""

    telemetry: Telemetry
    q_bi: np.ndarray
    omega_bi_b: np.ndarray
    field_b: np.ndarray


@njit(cache=True)
def free_flight_kernel(seconds, field_i, position_i, kicks, q, omega, inertia, inertia_inv, dipole, gm, q_out, omega_out):
    """Fill (n, 4) and (n, 3) with the motion at `seconds`; field and position go linearly between samples."""
    for k in range(seconds.shape[0]):
        if k > 0:
            gap = seconds[k] - seconds[k - 1]
            parts = max(ceil(gap / LONGEST_STEP), ceil(gap * norm(omega) / LARGEST_TURN), 1)
            for j in range(parts):
                u = (j + 0.5) / parts
                b = add(scale(1.0 - u, vec(field_i, k - 1)), scale(u, vec(field_i, k)))
                r = add(scale(1.0 - u, vec(position_i, k - 1)), scale(u, vec(position_i, k)))
                torque = add(cross(dipole, to_body(q, b)), gravity_gradient_torque(to_body(q, r), inertia, gm))
                q, omega = torqued_step(q, omega, gap / parts, inertia, inertia_inv, torque)
            omega = axpy(gap**0.5, vec(kicks, k), omega)
        for j in range(4):
            q_out[k, j] = q[j]
        for j in range(3):
            omega_out[k, j] = omega[j]


def fly_free(
    reference,
    *,
    q0_bi=None,
    omega0_deg_s=None,
    inertia_kg_m2=(0.02, 0.03, 0.035),
    dipole_a_m2=(0.0, 0.0, 0.0),
    gravity_gradient: bool = True,
    disturbance_rad_s15: float = 0.0,
    pointing: str = "free",
    libration_deg: float = 0.0,
    magnetometer: Magnetometer | None = None,
    seed: int = 0,
) -> FreeFlight:
    """Fly along a `Reference` (fieldline.estimation.reference_along_orbit) and read the magnetometer.

    q0_bi, omega0_deg_s: start, random where not given (any attitude, up to 5 deg/s). disturbance_rad_s15: white angular
    acceleration [rad/s/sqrt(s)]. pointing "free" or "earth" (then libration_deg is its amplitude about each axis).
    Same arguments and seed, same bits.
    """
    rng = np.random.default_rng(seed)
    seconds = (reference.time_utc - reference.time_utc[0]).astype(np.int64) * 1e-9
    if pointing == "earth":
        q_bi, omega = earth_pointing(reference, seconds, np.radians(libration_deg))
    elif pointing == "free":
        q0, omega0 = _start(q0_bi, omega0_deg_s, rng)
        kicks = disturbance_rad_s15 * rng.standard_normal((seconds.size, 3))
        inertia, inverse = as_inertia9(inertia_kg_m2)
        q_bi, omega = np.empty((seconds.size, 4)), np.empty((seconds.size, 3))
        dipole = tuple(float(m) for m in dipole_a_m2)
        gm = EARTH_GM_M3_S2 if gravity_gradient else 0.0
        free_flight_kernel(
            seconds, reference.field_i, reference.position_i, kicks, q0, omega0, inertia, inverse, dipole, gm, q_bi, omega
        )
    else:
        raise InputError(f'pointing must be "free" or "earth"; got "{pointing}".')
    field_b = rotate_to_body(q_bi, reference.field_i)
    raw = (magnetometer or Magnetometer()).reading(field_b, rng)
    return FreeFlight(telemetry=as_telemetry(reference.time_utc, raw), q_bi=q_bi, omega_bi_b=omega, field_b=field_b)


def as_telemetry(time_utc: np.ndarray, field_s: np.ndarray, name: str = "simulated") -> Telemetry:
    """The record that a file with these samples would give."""
    from fieldline.telemetry import Quality

    count = len(time_utc)
    step = float(np.median(np.diff(time_utc).astype(np.int64))) * 1e-9 if count > 1 else 0.0
    return Telemetry(
        time_utc=time_utc,
        field_s=np.ascontiguousarray(field_s),
        usable=np.ones(count, dtype=bool),
        quality=Quality(samples=count, usable=count, step_s=step),
        name=name,
    )


def rotate_to_body(q_bi: np.ndarray, vectors_i: np.ndarray) -> np.ndarray:
    """(n, 3) vectors in body axes."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(q_bi).inv().apply(vectors_i)


def _start(q0_bi, omega0_deg_s, rng) -> tuple[tuple, tuple]:
    """Start state as tuples; what is not given is drawn: a uniform attitude, a rate of up to 5 deg/s any way."""
    if q0_bi is None:
        q0_bi = rng.standard_normal(4)
        q0_bi = q0_bi / np.linalg.norm(q0_bi)
    if omega0_deg_s is None:
        direction = rng.standard_normal(3)
        omega0_deg_s = 5.0 * rng.uniform() * direction / np.linalg.norm(direction)
    q0, omega0 = np.asarray(q0_bi, dtype=float), np.radians(np.asarray(omega0_deg_s, dtype=float))
    if q0.shape != (4,) or abs(np.linalg.norm(q0) - 1.0) > 1e-6 or omega0.shape != (3,):
        raise InputError("q0_bi must be a unit quaternion (4,), scalar last, and omega0_deg_s three rates [deg/s].")
    return tuple(float(v) for v in q0), tuple(float(v) for v in omega0)


def earth_pointing(reference, seconds: np.ndarray, amplitude_rad: float) -> tuple[np.ndarray, np.ndarray]:
    """q_bi (n, 4) and rate (n, 3) of a body held to the orbital axes with a slow libration about each."""
    from scipy.spatial.transform import Rotation

    z = -reference.position_i / np.linalg.norm(reference.position_i, axis=1, keepdims=True)
    y = -np.cross(reference.position_i, reference.velocity_i)
    y /= np.linalg.norm(y, axis=1, keepdims=True)
    dcm_oi = np.stack([np.cross(y, z), y, z], axis=1)
    phase = 2.0 * np.pi * seconds[:, None] / np.array([3100.0, 3700.0, 4300.0])
    libration = Rotation.from_rotvec(amplitude_rad * np.sin(phase))
    rotation = Rotation.from_quat(quaternion_from_dcm(dcm_oi)) * libration
    q_bi = rotation.as_quat()
    turn = (rotation[:-1].inv() * rotation[1:]).as_rotvec() / np.diff(seconds)[:, None]
    middle = 0.5 * (turn[1:] + turn[:-1])
    return q_bi, np.vstack([turn[:1], middle, turn[-1:]])
