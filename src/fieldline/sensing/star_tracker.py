"""A star tracker: the attitude with small errors, or none.

    q_read = q_bi * exp(e_b / 2),   e_b = offset + noise                                            (1)

It gives nothing while the body turns faster than its limit, while the Sun is in sight within its exclusion angle of the
boresight, or while the boresight points to the Earth or to within an exclusion angle of its limb (a dark Earth hides
the stars as well). Then the attitude is unknown: NaN.

Noise is white, with a standard deviation for each body axis: choose it largest about the boresight, where a tracker is
several times worse. The Earth is a sphere. Valid for errors well below a radian.
"""

from __future__ import annotations

from math import asin, atan2, pi
from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M
from fieldline.frames.attitude import quat_exp, quat_mul
from fieldline.frames.vectors import add, cross, dot, norm, scale, vec
from fieldline.sensing.measurement import ATTITUDE
from fieldline.sensing.reading import noise3


class StarTrackerParams(NamedTuple):
    """One row a body; a body without a tracker has 0 in `present`."""

    present: np.ndarray  # (n,) 0 or 1
    boresight: np.ndarray  # (n, 3) unit, body axes
    offset: np.ndarray  # (n, 3) [rad] constant error, body axes
    noise_std: np.ndarray  # (n, 3) [rad] about each body axis
    rate_max: np.ndarray  # (n,) [rad/s], inf: none
    sun_exclusion: np.ndarray  # (n,) [rad] from the boresight, 0: none
    earth_exclusion: np.ndarray  # (n,) [rad] from the limb; -pi: the Earth never hides the stars


@njit(cache=True)
def angle_between(a, b):
    """[rad] 0..pi, by atan2: acos loses half its digits near both ends."""
    return atan2(norm(cross(a, b)), dot(a, b))


@njit(cache=True)
def blinded(omega_bi_b, sun_b, sunlit, position_b, params, k):
    """Does the tracker of body k see no stars, by rate, Sun or Earth?"""
    boresight = vec(params.boresight, k)
    if norm(omega_bi_b) > params.rate_max[k]:
        return True
    if sunlit > 0.0 and angle_between(boresight, sun_b) < params.sun_exclusion[k]:
        return True
    limb = asin(min(1.0, EARTH_EQUATORIAL_RADIUS_M / norm(position_b)))
    return angle_between(boresight, scale(-1.0, position_b)) < min(pi, limb + params.earth_exclusion[k])


@njit(cache=True)
def read_star_tracker(q_bi, omega_bi_b, sun_b, sunlit, position_b, params, k, rng, out):
    """Read the attitude of body k, a 4-tuple, into `out` (1).

    omega_bi_b : [rad/s].      sun_b : direction to the Sun.      sunlit : fraction of its disc in sight.
    position_b : [m] from the Earth's centre.      3-tuples, body axes.
    """
    if params.present[k] == 0.0:
        return
    # Drawn also when blinded, so that an outage leaves the noise after it as it was.
    error = add(vec(params.offset, k), noise3(params.noise_std, k, rng))
    if blinded(omega_bi_b, sun_b, sunlit, position_b, params, k):
        out.q_bi[:] = np.nan
        out.valid[ATTITUDE] = 0.0
        return
    q = quat_mul(q_bi, quat_exp(error))
    for i in range(4):
        out.q_bi[i] = q[i]
    out.valid[ATTITUDE] = 1.0
