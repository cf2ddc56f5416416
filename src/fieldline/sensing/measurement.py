"""What flight software is given: the newest reading of each sensor, and what is known on board.

Sensors, estimators and telemetry all write this one record, so that a law cannot tell a flown day from a simulated one.
The arrays are overwritten in place; a law that needs the past keeps it in its memory. `valid` says, one number for
each of FIELD, GYRO, SUN, ATTITUDE, RATE, ORBIT, whether there is such a reading (1.0) or not (0.0); what has never been
read is NaN. A reading at the end of its range is valid: the sensor cannot tell, a law may compare.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

FIELD, GYRO, SUN, ATTITUDE, RATE, ORBIT = range(6)


class Measurement(NamedTuple):
    """One body's readings; float64 arrays, axes b the body's, i GCRS."""

    field_b: np.ndarray  # (3) magnetometer reading [T]
    field_time_s: np.ndarray  # (1) when it was read
    rate_b: np.ndarray  # (3) gyro [rad/s]
    sun_sensor: np.ndarray  # (n faces) readings, 1 at normal incidence
    q_bi: np.ndarray  # (4) attitude as known on board (star tracker or an estimator); NaN while unknown
    omega_bi_b: np.ndarray  # (3) rate as known on board (gyro or an estimator) [rad/s]; NaN while unknown
    position_i: np.ndarray  # (3) as known on board [m]
    velocity_i: np.ndarray  # (3) [m/s]
    field_i: np.ndarray  # (3) reference field of the on-board model at the on-board position [T]
    wheel_momentum: np.ndarray  # (n wheels) [N m s] about each wheel's axis
    dipole_b: np.ndarray  # (3) dipole now commanded by the torquers [A m^2]
    valid: np.ndarray  # (6) 1.0 or 0.0
    tension: np.ndarray  # (n lines) [N] at this body, of each line that is attached
    line_length: np.ndarray  # (n lines) [m] unstretched length that is out
    line_rate: np.ndarray  # (n lines) [m/s] at which a reel feeds it
    relative_position_i: np.ndarray  # (3) from the first body to this one, as known on board [m]; NaN on the first body
    relative_velocity_i: np.ndarray  # (3) [m/s]


def new_measurement(n_faces: int = 0, n_wheels: int = 0, n_lines: int = 0) -> Measurement:
    """Nothing read yet: NaN, no momentum, no dipole, nothing valid."""
    return Measurement(
        field_b=np.full(3, np.nan),
        field_time_s=np.full(1, np.nan),
        rate_b=np.full(3, np.nan),
        sun_sensor=np.full(n_faces, np.nan),
        q_bi=np.full(4, np.nan),
        omega_bi_b=np.full(3, np.nan),
        position_i=np.full(3, np.nan),
        velocity_i=np.full(3, np.nan),
        field_i=np.full(3, np.nan),
        wheel_momentum=np.zeros(n_wheels),
        dipole_b=np.zeros(3),
        valid=np.zeros(6),
        tension=np.zeros(n_lines),
        line_length=np.zeros(n_lines),
        line_rate=np.zeros(n_lines),
        relative_position_i=np.full(3, np.nan),
        relative_velocity_i=np.full(3, np.nan),
    )
