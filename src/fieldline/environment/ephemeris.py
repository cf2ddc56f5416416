"""The Earth's rotation and the Sun over a span of time, tabulated for compiled loops.

    v_e = R3(theta(t)) N(t) v_i,     theta = theta_0 + theta' t                                             (1)
    N(t_k) = R3(-theta(t_k)) dcm_ei(t_k),     t_k = (k - 1) h                                               (2)
    f(t) = Lagrange cubic through the four nodes about t                                                    (3)

theta is the Earth rotation angle with the rate of UT1 = UTC, taken out of the nodes because it alone is fast; N is what
is left of `frames.earth_rotation`: precession and nutation (and, with measured orientation, the drift of UT1 and the
pole, which seen from i turns once a day). N and the Sun's place are interpolated by (3) with h = 30 minutes.

Against `dcm_ei` and `sun_position_i` at the same times: 2e-12 without and 5e-11 with measured orientation in any element
(0.3 mm in low orbit), 1e-12 of the Sun's distance. `t` is UTC seconds since the start; before the first and past the
last node (3) holds the end's value and theta runs on.
"""

from __future__ import annotations

from math import cos, sin
from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.constants import EARTH_ROTATION_ANGLE_TURNS_PER_DAY, SECONDS_PER_DAY
from fieldline.environment.cubic import cubic_place
from fieldline.environment.sun import sun_position_i
from fieldline.errors import InputError
from fieldline.frames.earth_orientation import EarthOrientation
from fieldline.frames.earth_rotation import dcm_ei, earth_rotation_angle
from fieldline.frames.time import as_utc

NODE_STEP_S = 1800.0
ERA_RATE_RAD_S = 2.0 * np.pi * EARTH_ROTATION_ANGLE_TURNS_PER_DAY / SECONDS_PER_DAY
DURATION_MAX_S = 3.2e9  # a century: the Sun's ephemeris ends there anyway


class Ephemeris(NamedTuple):
    """The Earth's rotation (1) and the Sun over a span; node k is at (k - 1) node_step_s."""

    era_start: float  # [rad]
    era_rate: float  # [rad/s]
    node_step_s: float
    intermediate: np.ndarray  # (n, 9) N of (2), row by row
    sun_i: np.ndarray  # (n, 3) [m]


@njit(cache=True)
def dcm_ei_kernel(t, ephemeris):
    """dcm_ei as nine floats, row by row, at t [s]: v_e = matvec(dcm, v_i); equations (1) and (3)."""
    n = ephemeris.intermediate
    k, (w0, w1, w2, w3) = cubic_place(t / ephemeris.node_step_s + 1.0, n.shape[0])
    angle = ephemeris.era_start + ephemeris.era_rate * t
    c, s = cos(angle), sin(angle)
    xx = w0 * n[k, 0] + w1 * n[k + 1, 0] + w2 * n[k + 2, 0] + w3 * n[k + 3, 0]
    xy = w0 * n[k, 1] + w1 * n[k + 1, 1] + w2 * n[k + 2, 1] + w3 * n[k + 3, 1]
    xz = w0 * n[k, 2] + w1 * n[k + 1, 2] + w2 * n[k + 2, 2] + w3 * n[k + 3, 2]
    yx = w0 * n[k, 3] + w1 * n[k + 1, 3] + w2 * n[k + 2, 3] + w3 * n[k + 3, 3]
    yy = w0 * n[k, 4] + w1 * n[k + 1, 4] + w2 * n[k + 2, 4] + w3 * n[k + 3, 4]
    yz = w0 * n[k, 5] + w1 * n[k + 1, 5] + w2 * n[k + 2, 5] + w3 * n[k + 3, 5]
    zx = w0 * n[k, 6] + w1 * n[k + 1, 6] + w2 * n[k + 2, 6] + w3 * n[k + 3, 6]
    zy = w0 * n[k, 7] + w1 * n[k + 1, 7] + w2 * n[k + 2, 7] + w3 * n[k + 3, 7]
    zz = w0 * n[k, 8] + w1 * n[k + 1, 8] + w2 * n[k + 2, 8] + w3 * n[k + 3, 8]
    return (
        c * xx + s * yx,
        c * xy + s * yy,
        c * xz + s * yz,
        c * yx - s * xx,
        c * yy - s * xy,
        c * yz - s * xz,
        zx,
        zy,
        zz,
    )


@njit(cache=True)
def sun_kernel(t, ephemeris):
    """The Sun's centre from the Earth's [m] (tuple), GCRS axes, at t [s]; equation (3)."""
    n = ephemeris.sun_i
    k, (w0, w1, w2, w3) = cubic_place(t / ephemeris.node_step_s + 1.0, n.shape[0])
    return (
        w0 * n[k, 0] + w1 * n[k + 1, 0] + w2 * n[k + 2, 0] + w3 * n[k + 3, 0],
        w0 * n[k, 1] + w1 * n[k + 1, 1] + w2 * n[k + 2, 1] + w3 * n[k + 3, 1],
        w0 * n[k, 2] + w1 * n[k + 1, 2] + w2 * n[k + 2, 2] + w3 * n[k + 3, 2],
    )


def ephemeris_table(start_utc, duration_s: float, eop: EarthOrientation | None = None) -> Ephemeris:
    """The Earth's rotation and the Sun from `start_utc` for `duration_s`, for `dcm_ei_kernel` and `sun_kernel`.

    Parameters
    ----------
    start_utc : one datetime64 or ISO 8601 text, UTC.
    duration_s : [s], zero or more; the table reaches half an hour further.
    eop : measured UT1-UTC and pole (`read_eop`), which must cover half an hour before to an hour after the span;
        without it UT1 = UTC and no polar motion.

    Raises
    ------
    InputError : a duration that is negative or no number, times outside 1900 to 2100 or outside the orientation file.
    """
    start = as_utc(start_utc, "start_utc")
    if start.ndim:
        raise InputError(f"start_utc must be one time; got shape {start.shape}.")
    if not 0.0 <= duration_s <= DURATION_MAX_S:
        raise InputError(f"duration_s must be seconds from 0 to {DURATION_MAX_S:g}; got {duration_s!r}.")
    seconds = NODE_STEP_S * np.arange(-1, int(np.ceil(duration_s / NODE_STEP_S)) + 3)
    times = start + np.round(seconds * 1e9).astype("timedelta64[ns]")
    era_start = float(earth_rotation_angle(start, eop) % (2.0 * np.pi))
    turn = _turn_back(era_start + ERA_RATE_RAD_S * seconds)
    intermediate = np.ascontiguousarray((turn @ dcm_ei(times, eop)).reshape(-1, 9))
    return Ephemeris(era_start, ERA_RATE_RAD_S, NODE_STEP_S, intermediate, sun_position_i(times))


def _turn_back(angle: np.ndarray) -> np.ndarray:
    """R3(-angle), (n, 3, 3)."""
    turn = np.zeros((angle.size, 3, 3))
    turn[:, 0, 0] = turn[:, 1, 1] = np.cos(angle)
    turn[:, 1, 0] = np.sin(angle)
    turn[:, 0, 1] = -turn[:, 1, 0]
    turn[:, 2, 2] = 1.0
    return turn
