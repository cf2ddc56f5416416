"""Judges that the estimator did not see: a gyro, sun sensors, and the two halves of the arc estimated apart.

Sun sensors: a face with outward normal n reads max(0, n . s) times a gain, plus light from the Earth. Predicted lit
(cosine above 0.3) must read above 20 % of full scale, predicted dark (below 0) below 30 %.                        (1)
Spin phase: the turn about the spin axis that lays the predicted readings on the measured ones, each face with its own
gain and offset.                                                                                               (2)
"""

from __future__ import annotations

import numpy as np

from fieldline.estimation.smoothing import Smoothed
from fieldline.frames.attitude import rotation_error_b

LIT_COSINE, LIT_SHARE, DARK_SHARE = 0.3, 0.2, 0.3
HIT_LIMIT = 0.9
SWEEP = 0.7  # of the cosine between a face and the Sun, from which a face is judged
SPIN_RATE = np.radians(5.0)  # [rad/s] slower bodies have no spin phase to speak of
SPREAD_LIMIT = 2.8  # sigma of three axes together at which halves still agree: 95 %


def judge_line(what, value, unit, limit, passed, words) -> dict:
    """One row of the judgement, plain types."""
    return {
        "what": what,
        "value": None if value is None else float(value),
        "unit": unit,
        "limit": None if limit is None else float(limit),
        "passed": None if passed is None else bool(passed),
        "words": words,
    }


def judge_gyro(omega_b: np.ndarray, gyro_b: np.ndarray) -> list[dict]:
    """Median difference per axis and of the magnitude [deg/s]; a raw gyro's own bias is not known, so nothing passes or fails."""
    rows = np.isfinite(gyro_b).all(axis=1)
    if not rows.any():
        return []
    difference = np.degrees(np.median(gyro_b[rows] - omega_b[rows], axis=0))
    scatter = np.degrees(1.4826 * np.median(np.abs(gyro_b[rows] - omega_b[rows] - np.radians(difference)), axis=0))
    size = np.degrees(np.median(np.linalg.norm(gyro_b[rows], axis=1)) - np.median(np.linalg.norm(omega_b[rows], axis=1)))
    lines = [
        judge_line(
            f"gyro less estimate, {axis}",
            difference[k],
            "deg/s",
            None,
            None,
            f"median; scatter {scatter[k]:.3f} deg/s. A constant is the gyro's own bias until something else shows it",
        )
        for k, axis in enumerate("xyz")
    ]
    return [*lines, judge_line("gyro less estimate, magnitude", size, "deg/s", None, None, "of the medians")]


def judge_sun(smoothed: Smoothed, sun_i: np.ndarray, sunlit: np.ndarray, sensors: dict[str, np.ndarray]) -> list[dict]:
    """Hits of (1) for each face, and the phase (2) over the sunlit arc for a spinner."""
    from scipy.spatial.transform import Rotation

    sun_b = Rotation.from_quat(smoothed.q_bi).inv().apply(sun_i)
    lit = sunlit > 0.99
    lines = []
    faces = {}
    for face, reading in sensors.items():
        rows = lit & np.isfinite(reading)
        if rows.sum() < 50:
            continue
        cosine = (1.0 if face[0] == "+" else -1.0) * sun_b[:, "xyz".index(face[1])]
        share = reading / max(float(np.nanquantile(reading, 0.999)), 1e-300)
        should, must_not = rows & (cosine > LIT_COSINE), rows & (cosine < 0.0)
        right = (share[should] > LIT_SHARE).sum() + (share[must_not] < DARK_SHARE).sum()
        hits = right / max(should.sum() + must_not.sum(), 1)
        # a face that the Sun does not sweep over has no full scale to be judged by
        strong = bool(np.ptp(np.quantile(cosine[rows], [0.05, 0.95])) > SWEEP)
        if strong:
            faces[face] = (reading, rows)
        words = "of sunlit samples: lit where it should be, dark where it should be"
        words += "" if strong else "; this face stays near the spin axis and is weak, so it is not judged"
        lines.append(
            judge_line(f"sun sensor {face}", 100 * hits, "%", 100 * HIT_LIMIT, hits >= HIT_LIMIT if strong else None, words)
        )
    spin = np.median(smoothed.omega_b, axis=0)
    if faces and np.linalg.norm(spin) > SPIN_RATE:
        lines += _phase_lines(sun_b, spin / np.linalg.norm(spin), faces)
    return lines


def _phase_lines(sun_b: np.ndarray, axis: np.ndarray, faces: dict) -> list[dict]:
    """The fitted phase over the whole sunlit arc and its scatter over eighths of it."""
    common = np.flatnonzero(np.logical_and.reduce([rows for _, rows in faces.values()]))
    if len(common) < 200:
        return []
    whole = spin_phase(sun_b, axis, faces, common)
    eighths = [spin_phase(sun_b, axis, faces, rows) for rows in np.array_split(common, 8)]
    rms = float(np.sqrt(np.mean(np.square(eighths))))
    each = ", ".join(f"{v:+.1f}" for v in eighths)
    return [
        judge_line("spin phase by the sun sensors", whole, "deg", 5.0, abs(whole) < 5.0, "fitted over the sunlit arc"),
        judge_line("spin phase over eighths", rms, "deg", None, None, f"RMS; each {each} (light from the Earth moves it too)"),
    ]


def spin_phase(sun_b: np.ndarray, axis: np.ndarray, faces: dict, rows: np.ndarray) -> float:
    """[deg] of (2): positive where the body is turned further about +axis than the estimate says."""
    from scipy.optimize import least_squares
    from scipy.spatial.transform import Rotation

    rows = rows[:: max(1, len(rows) // 4000)]

    def misfit(angle):
        turned = Rotation.from_rotvec(-axis * angle[0]).apply(sun_b[rows])
        left = []
        for face, (reading, _) in faces.items():
            sign = 1.0 if face[0] == "+" else -1.0
            shape = np.stack([np.maximum(0.0, sign * turned[:, "xyz".index(face[1])]), np.ones(len(rows))], axis=1)
            gains, *_ = np.linalg.lstsq(shape, reading[rows], rcond=None)
            left.append((reading[rows] - shape @ gains) / max(float(np.ptp(reading[rows])), 1e-300))
        return np.concatenate(left)

    starts = np.radians([-25.0, 0.0, 25.0])
    fits = [least_squares(misfit, [start], loss="soft_l1", f_scale=0.1) for start in starts]
    return float(np.degrees(min(fits, key=lambda fit: fit.cost).x[0]))


def meeting(first: Smoothed, second: Smoothed, gyro_b: np.ndarray, gap_s: float) -> tuple[np.ndarray, float]:
    """Rotation [rad, body axes] from the first half's end, carried over the gap, to the second's start; and its d^2.

    d^2 = e^T (P_1 + P_2)^-1 e has expectation 3 where both halves are as good as they say. gyro_b (3,) [rad/s]: the rate that
    the random walk rides on there.
    """
    from scipy.spatial.transform import Rotation

    rate = 0.5 * (first.omega_b[-1] + second.omega_b[0]) + gyro_b
    carried = (Rotation.from_quat(first.q_bi[-1]) * Rotation.from_rotvec(rate * gap_s)).as_quat()
    error = rotation_error_b(second.q_bi[0], carried)
    spread = first.attitude_covariance_b[-1] + second.attitude_covariance_b[0]
    return error, float(error @ np.linalg.solve(spread, error))
