"""A three-axis rate gyro whose bias wanders.

    bias := bias + walk_std sqrt(dt) n1                                                             (1)
    raw = digits( G omega + bias + noise_std n2 ),   n1, n2 ~ N(0, I)                               (2)

`walk_std` is what the bias has wandered after one second, one sigma: the square root of the rate random walk's density
[rad/s/sqrt(s)]. `noise_std` is that of one reading: of an angle random walk N [rad/sqrt(s)] sampled every dt it is
N / sqrt(dt). The bias is state, one row a body, which the caller keeps and starts at a copy of `GyroParams.bias`.

Source: Farrenkopf (1978), J. Guidance and Control 1(4):282, sampled; valid for walk_std^2 dt / 3 well below noise_std^2,
where the walk within one reading is lost in its noise.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.frames.matrices import matvec
from fieldline.frames.vectors import add, axpy, put, vec
from fieldline.sensing.measurement import GYRO, RATE
from fieldline.sensing.reading import digits, nine, noise3


class GyroParams(NamedTuple):
    """One row a body; a body without a gyro has 0 in `present`."""

    present: np.ndarray  # (n,) 0 or 1
    serves: np.ndarray  # (n,) 0 or 1: the reading is also the rate as known on board; 0 where an estimator says it
    gain: np.ndarray  # (n, 9) G
    bias: np.ndarray  # (n, 3) [rad/s] at the start
    walk_std: np.ndarray  # (n, 3) [rad/s/sqrt(s)]
    noise_std: np.ndarray  # (n, 3) [rad/s] of one reading
    quantum: np.ndarray  # (n,) [rad/s], 0: none
    limit: np.ndarray  # (n,) [rad/s], inf: none


@njit(cache=True)
def read_gyro(omega_bi_b, dt, params, bias, k, rng, out):
    """Read the rate [rad/s] of body k, a 3-tuple, dt [s] after the reading before (0 at the first), into `out`.

    bias : (n, 3) [rad/s], state; row k is advanced over dt (1).
    """
    if params.present[k] == 0.0:
        return
    put(bias, k, axpy(sqrt(dt), noise3(params.walk_std, k, rng), vec(bias, k)))
    raw = add(add(matvec(nine(params.gain, k), omega_bi_b), vec(bias, k)), noise3(params.noise_std, k, rng))
    for axis in range(3):
        out.rate_b[axis] = digits(raw[axis], params.quantum[k], params.limit[k])
    out.valid[GYRO] = 1.0
    if params.serves[k] != 0.0:
        for j in range(3):
            out.omega_bi_b[j] = out.rate_b[j]
        out.valid[RATE] = 1.0
