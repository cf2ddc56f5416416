"""A three-axis magnetometer, disturbed by the torquers.

    raw = digits( G (B + C m) + bias + noise )                                                      (1)

G is scale and misalignment (the inverse of the matrix that a calibration applies), m the dipole that the torquers have
at that instant and C the field that a unit of it makes at the sensor; noise is white, one draw per reading and axis.
A reading with the torquers off is free of C: a duty cycle of torquers and magnetometer is the caller's schedule.

Valid for sensors that settle within a sampling period; temperature and time-stamp jitter are not modelled.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.frames.matrices import matvec
from fieldline.frames.vectors import add, vec
from fieldline.sensing.measurement import FIELD
from fieldline.sensing.reading import digits, nine, noise3


class MagnetometerParams(NamedTuple):
    """One row a body; a body without a magnetometer has 0 in `present`."""

    present: np.ndarray  # (n,) 0 or 1
    gain: np.ndarray  # (n, 9) G
    coupling: np.ndarray  # (n, 9) C [T / (A m^2)]
    bias: np.ndarray  # (n, 3) [T]
    noise_std: np.ndarray  # (n, 3) [T]
    quantum: np.ndarray  # (n,) [T], 0: none
    limit: np.ndarray  # (n,) [T], inf: none


@njit(cache=True)
def read_magnetometer(t, field_b, dipole_b, params, k, rng, out):
    """Read the field [T] at body k and time t [s] under the torquers' dipole [A m^2], 3-tuples, into `out` (1)."""
    if params.present[k] == 0.0:
        return
    disturbed = add(field_b, matvec(nine(params.coupling, k), dipole_b))
    raw = add(add(matvec(nine(params.gain, k), disturbed), vec(params.bias, k)), noise3(params.noise_std, k, rng))
    for axis in range(3):
        out.field_b[axis] = digits(raw[axis], params.quantum[k], params.limit[k])
    out.field_time_s[0] = t
    out.valid[FIELD] = 1.0
