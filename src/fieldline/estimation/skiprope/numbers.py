"""The numbers that follow from phasors and their covariance, (1) and (2) of `solution`, row by row, compiled.

Kept apart from the record so that an answer for every sample of a live stream costs a microsecond.
"""

from __future__ import annotations

from math import atan2, cos, hypot, pi, sin, sqrt

import numpy as np
from numba import njit

NUMBERS = (
    "amplitude_rad",
    "amplitude_std_rad",
    "major_rad",
    "major_std_rad",
    "minor_rad",
    "minor_std_rad",
    "phase_rad",
    "phase_std_rad",
    "plane_rad",
    "plane_std_rad",
    "deflection_m",
    "deflection_std_m",
    "u_m",
    "v_m",
    "u_variance_m2",
    "uv_covariance_m2",
    "v_variance_m2",
)


@njit(cache=True)
def _spread(covariance, row):
    """Standard deviation of a linear combination (4-tuple) of the phasors' parts."""
    total = 0.0
    for i in range(4):
        for j in range(4):
            total += row[i] * covariance[i, j] * row[j]
    return sqrt(max(total, 0.0))


@njit(cache=True)
def cone_numbers(phasor, covariance, sense, yaw, yaw_std, length, out):
    """Fill out (17,), in the order of `NUMBERS`, from Re z1, Im z1, Re z2, Im z2 (4,) and their covariance (4, 4)."""
    re1, im1, re2, im2 = phasor[0], phasor[1], phasor[2], phasor[3]
    plus = (0.5 * (re1 - im2), 0.5 * (im1 + re2))
    minus = (0.5 * (re1 + im2), 0.5 * (im1 - re2))
    angle_plus, angle_minus = atan2(plus[1], plus[0]), atan2(minus[1], minus[0])
    size_plus, size_minus = hypot(plus[0], plus[1]), hypot(minus[0], minus[1])
    c, s = 0.5 * cos(angle_plus), 0.5 * sin(angle_plus)
    by_plus, across_plus = (c, s, s, -c), (-s, c, c, s)
    c, s = 0.5 * cos(angle_minus), 0.5 * sin(angle_minus)
    by_minus, across_minus = (c, s, -s, c), (-s, c, -c, -s)
    forward = size_plus >= size_minus if sense == 0 else sense > 0
    amplitude, by, across = (size_plus, by_plus, across_plus) if forward else (size_minus, by_minus, across_minus)
    out[0], out[1] = amplitude, _spread(covariance, by)
    out[2] = size_plus + size_minus
    out[3] = _spread(covariance, _sum(by_plus, by_minus, 1.0))
    out[4] = abs(size_plus - size_minus)
    out[5] = _spread(covariance, _sum(by_plus, by_minus, -1.0))
    out[6] = angle_plus if forward else -angle_minus
    out[7] = _spread(covariance, across) / max(amplitude, 1e-150)
    radius = max(hypot(re1, re2), 1e-150)
    out[8] = (atan2(re2, re1) + yaw + pi) % (2.0 * pi) - pi
    out[9] = hypot(_spread(covariance, (-re2 / radius**2, 0.0, re1 / radius**2, 0.0)), yaw_std)
    scale = length / pi
    out[10], out[11] = scale * out[0], scale * out[1]
    c, s = cos(yaw), sin(yaw)
    u, v = scale * (-s * re1 - c * re2), scale * (c * re1 - s * re2)
    var1, var2, both = covariance[0, 0], covariance[2, 2], covariance[0, 2]
    out[12], out[13] = u, v
    out[14] = scale * scale * (s * s * var1 + c * c * var2 + 2.0 * s * c * both) + (yaw_std * v) ** 2
    out[15] = scale * scale * (s * c * (var2 - var1) + (s * s - c * c) * both) - yaw_std * yaw_std * u * v
    out[16] = scale * scale * (c * c * var1 + s * s * var2 - 2.0 * s * c * both) + (yaw_std * u) ** 2


@njit(cache=True)
def _sum(a, b, sign):
    """A + sign b, of 4-tuples."""
    return (a[0] + sign * b[0], a[1] + sign * b[1], a[2] + sign * b[2], a[3] + sign * b[3])


@njit(cache=True)
def cone_rows(phasors, covariances, senses, yaws, yaw_stds, length, out):
    """`cone_numbers` of m rows: phasors (m, 4), covariances (m, 4, 4), the rest (m,), out (m, 17)."""
    for k in range(len(phasors)):
        cone_numbers(phasors[k], covariances[k], senses[k], yaws[k], yaw_stds[k], length, out[k])


def derived(phasor, covariance, sense, yaw_rad, yaw_std_rad, tether_length_m: float) -> dict[str, np.ndarray]:
    """All that follows from phasors (m, 2) and their covariance: the fields of `SkipropeEstimate`, by name."""
    parts = np.ascontiguousarray(np.stack([phasor[:, 0].real, phasor[:, 0].imag, phasor[:, 1].real, phasor[:, 1].imag], axis=1))
    out = np.empty((len(parts), len(NUMBERS)))
    spreads = np.ascontiguousarray(covariance, dtype=float)
    yaws, yaw_stds = (np.ascontiguousarray(x, dtype=float) for x in (yaw_rad, yaw_std_rad))
    cone_rows(parts, spreads, np.ascontiguousarray(sense, dtype=np.int64), yaws, yaw_stds, float(tether_length_m), out)
    columns: dict[str, np.ndarray] = dict(zip(NUMBERS, out.T.copy(), strict=True))
    columns["position_m"] = np.stack([columns.pop("u_m"), columns.pop("v_m")], axis=1)
    uu, uv, vv = (columns.pop(name) for name in ("u_variance_m2", "uv_covariance_m2", "v_variance_m2"))
    columns["position_covariance_m2"] = np.stack([np.stack([uu, uv], axis=1), np.stack([uv, vv], axis=1)], axis=1)
    return columns
