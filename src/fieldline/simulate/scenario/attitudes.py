"""How the bodies of a scenario are turned at its start, and how fast they turn.

    q_bi = q_oi * q_bo,    omega_bi_b = omega_bo_b + C_bo omega_oi_o                                   (1)

A random attitude is even over all rotations: four normal numbers made a unit quaternion. Each body draws from a stream
of its own, so that adding a body leaves the others as they were.

Source: Shoemake (1992), Uniform random rotations, Graphics Gems III; Markley and Crassidis (2014), s. 2.6.
"""

from __future__ import annotations

import numpy as np

from fieldline.frames.attitude import dcm_from_quaternion, quat_mul, quaternion_from_dcm
from fieldline.simulate.scenario.states import orbital_axes

ATTITUDE_STREAM = 0x617474  # keeps these draws apart from the sensors'


def start_attitude(body, index: int, seed: int, position_i, velocity_i) -> tuple[np.ndarray, np.ndarray]:
    """q_bi (4,), scalar last, and omega_bi_b (3,) [rad/s] of body number `index` at the start."""
    draws = np.random.default_rng([seed, ATTITUDE_STREAM, index])
    dcm_io, rate_oi_o = orbital_axes(np.asarray(position_i), np.asarray(velocity_i))
    q_bi = _attitude(body.attitude, quaternion_from_dcm(dcm_io.T), draws)
    if body.random_rate_deg_s is not None:
        direction = draws.standard_normal(3)
        return q_bi, np.radians(body.random_rate_deg_s) * direction / np.linalg.norm(direction)
    omega = np.radians(body.rate_deg_s or (0.0, 0.0, 0.0))
    if body.rate_axes == "orbital":
        omega = omega + dcm_from_quaternion(q_bi) @ dcm_io @ rate_oi_o
    return q_bi, omega


def _attitude(start, q_oi: np.ndarray, draws: np.random.Generator) -> np.ndarray:
    """q_bi of a table [body.attitude]; along the orbital axes without one."""
    if start is None:
        return q_oi
    if start.random:
        given = draws.standard_normal(4)
        return given / np.linalg.norm(given)
    if start.quaternion_bi is not None:
        return np.array(start.quaternion_bi)
    relative = start.quaternion_bo or _of_euler_321(np.radians(start.euler_321_deg))
    if start.euler_321_deg is not None and start.axes == "gcrs":
        return np.array(relative)
    return np.array(quat_mul(tuple(q_oi), tuple(relative)))


def _of_euler_321(angles) -> tuple[float, float, float, float]:
    """Body to reference quaternion of yaw, pitch, roll [rad]: turns about z, the new y, the newest x."""
    yaw, pitch, roll = ((np.sin(0.5 * a), np.cos(0.5 * a)) for a in angles)
    about_z, about_y, about_x = (0.0, 0.0, *yaw), (0.0, pitch[0], 0.0, pitch[1]), (roll[0], 0.0, 0.0, roll[1])
    return quat_mul(quat_mul(about_z, about_y), about_x)
