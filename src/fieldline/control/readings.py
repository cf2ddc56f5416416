"""What a law may believe of a measurement: each reading is used only if it is valid and finite.

Vectors are lifted from the measurement's arrays as 3-tuples in body axes, SI units.
"""

from __future__ import annotations

from math import isfinite

from fieldline.compiled import kernel
from fieldline.frames.vectors import cross, dot
from fieldline.sensing.measurement import ATTITUDE, FIELD, GYRO, ORBIT, RATE


@kernel
def lifted(values):
    """The first three numbers of an array as a tuple."""
    return (values[0], values[1], values[2])


@kernel
def finite3(v):
    """Whether all three components are finite."""
    return isfinite(v[0]) and isfinite(v[1]) and isfinite(v[2])


@kernel
def field_known(measurement):
    """Whether there is a field reading [T] to steer by: valid, finite and not zero."""
    b = measurement.field_b
    some = b[0] != 0.0 or b[1] != 0.0 or b[2] != 0.0
    return measurement.valid[FIELD] > 0.5 and some and finite3(lifted(b)) and isfinite(measurement.field_time_s[0])


@kernel
def gyro_known(measurement):
    """Whether the gyro's reading [rad/s] may be used."""
    return measurement.valid[GYRO] > 0.5 and finite3(lifted(measurement.rate_b))


@kernel
def attitude_known(measurement):
    """Whether the attitude q_bi is known on board: valid, and a quaternion within a tenth of unit length."""
    q = measurement.q_bi
    if not (finite3(lifted(q)) and isfinite(q[3])):
        return False
    square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]
    return measurement.valid[ATTITUDE] > 0.5 and 0.81 < square < 1.21


@kernel
def rate_known(measurement):
    """Whether the rate omega_bi_b [rad/s] is known on board."""
    return measurement.valid[RATE] > 0.5 and finite3(lifted(measurement.omega_bi_b))


@kernel
def orbit_known(measurement):
    """Whether position and velocity are known on board: valid, finite, and not along one line."""
    r, v = lifted(measurement.position_i), lifted(measurement.velocity_i)
    if not (measurement.valid[ORBIT] > 0.5 and finite3(r) and finite3(v)):
        return False
    h = cross(r, v)
    return dot(h, h) > 1e-12 * dot(r, r) * dot(v, v)


@kernel
def wheel_momentum_b(measurement, params, first):
    """Momentum of all wheels [N m s], body axes; params from `first` on: number of wheels, then three floats of each axis.

    The table of axes and the readings may differ in length (a wheel that is not read): the shorter one counts.
    """
    count = min(int(params[first]), measurement.wheel_momentum.shape[0])
    x, y, z = 0.0, 0.0, 0.0
    for k in range(count):
        h = measurement.wheel_momentum[k]
        x += h * params[first + 1 + 3 * k]
        y += h * params[first + 2 + 3 * k]
        z += h * params[first + 3 + 3 * k]
    return (x, y, z)
