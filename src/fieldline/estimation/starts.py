"""First motions without a prior: rate from a short window, then windows that grow until the field's turn shows the rest.

1. The rotational periodogram of a few samples gives rates (magnitude, axis, sense).
2. A least-squares motion through a window that grows by half each time pins rate and, for a rigid body, inertia ratios:
   while the field hardly turns, the angle about the field does not matter and any one serves.
3. Once the field has turned by some degrees, the motion is restarted from several angles about the field, and each copy
   grows on. Copies that meet are one; all distinct ones are carried on as candidates.

A body without torque fits rigid; one that wheels or a boom hold fits a constant rate over shorter windows. Both are tried.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fieldline.estimation.batch import Motion, fit_window
from fieldline.estimation.periodogram import rate_peaks
from fieldline.estimation.series import Series, part

FIRST_ROWS = 9  # of the periodogram's window
MOST_ROWS = 160  # of a fit: longer windows are thinned while a step turns the body by less than THIN_TURN
THIN_TURN = 0.9  # [rad]
GROWTH = 1.5
BRANCH_TURN = np.radians(6.0)  # of the field, from where the angle about it begins to matter
FINAL_TURN = np.radians(50.0)
AZIMUTHS = 8
MODEL_ERROR = 0.01  # of the field: what a smooth motion may miss by its own simplicity
LONGEST_TURN = 1000.0  # [rad] of a fit without process noise; the filter's own polish goes on from there
SAME_ANGLE = np.radians(3.0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Candidate:
    """A motion at a row of the series, fitted to `rows` rows around it, and how it was found."""

    motion: Motion
    row: int
    rows: int
    words: str = ""

    @property
    def state(self) -> np.ndarray:
        """(7,) attitude and rate at `row`."""
        return np.concatenate([self.motion.q_bi, self.motion.omega_b])


def attitude_on_circle(measured_b: np.ndarray, reference_i: np.ndarray, angle: float) -> np.ndarray:
    """q_bi that lays the reference field on the measured one, turned about it by `angle` [rad]."""
    from scipy.spatial.transform import Rotation

    b = measured_b / np.linalg.norm(measured_b)
    shortest = Rotation.align_vectors([reference_i / np.linalg.norm(reference_i)], [b])[0]
    return (shortest * Rotation.from_rotvec(angle * b)).as_quat()


def turned_about(q_bi: np.ndarray, axis_b: np.ndarray, angle: float) -> np.ndarray:
    """The attitude turned by `angle` [rad] about a body axis."""
    from scipy.spatial.transform import Rotation

    return (Rotation.from_quat(q_bi) * Rotation.from_rotvec(angle * axis_b / np.linalg.norm(axis_b))).as_quat()


def window(series: Series, centre: int, rows: int, rate: float) -> tuple[Series, int]:
    """About `rows` rows around `centre`, thinned to MOST_ROWS where the body turns slowly; and the centre's new row."""
    first = max(0, centre - rows // 2)
    last = min(len(series.seconds), first + rows)
    first = max(0, last - rows)
    step = float(np.median(np.diff(series.seconds[first:last])))
    stride = max(1, min((last - first) // MOST_ROWS, int(THIN_TURN / max(rate * step, 1e-9))))
    index = np.arange(centre % stride + stride * -(-(first - centre % stride) // stride), last, stride)
    return part(series, index), int(np.searchsorted(index, centre))


def field_turn(series: Series, first: int, last: int) -> float:
    """[rad] between the reference field's directions at two rows."""
    a, b = series.field_i[first], series.field_i[last - 1]
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


def find_starts(series: Series, noise_tesla: float, *, inertia=None, rigid: bool = True, anchors: int = 2) -> list[Candidate]:
    """Candidates from `anchors` places of the arc, best fit first; see the module's account.

    rigid: fit a body without outer control (its `inertia` known or not) rather than a constant rate.
    """
    found: list[Candidate] = []
    for centre in _centres(series, anchors):
        stems = sorted(_stems(series, centre, noise_tesla, inertia, rigid), key=lambda stem: stem.motion.chi2)
        for stem in _distinct(stems)[:3]:
            found += _branches(series, centre, stem.rows, stem.motion, noise_tesla)
    return _distinct(sorted(found, key=lambda c: c.motion.chi2 / max(c.motion.samples, 1) ** 0.25))


def _centres(series: Series, anchors: int) -> list[int]:
    """Rows amid well-filled stretches, spread over the arc."""
    n = len(series.seconds)
    wanted = (np.arange(anchors) + 0.5) / anchors * n
    step = np.diff(series.seconds)
    usual = float(np.median(step))
    good = series.used.copy()
    good[1:] &= step < 1.5 * usual
    filled = np.convolve(good.astype(float), np.ones(2 * FIRST_ROWS), mode="same")
    rows = np.arange(n)
    reach = max(n / (2.0 * anchors), 2.0 * FIRST_ROWS)
    return sorted({int(np.argmax(filled - 0.5 * np.abs(rows - at) / reach)) for at in wanted})


def _noise(series: Series, noise_tesla: float) -> float:
    """[T] what a fit's residual may be: the magnetometer's noise and the motion model's own."""
    return float(np.hypot(noise_tesla, MODEL_ERROR * np.linalg.norm(series.field_i[0])))


def _stems(series: Series, centre: int, noise_tesla: float, inertia, rigid: bool) -> list[Candidate]:
    """Motions from each peak of the periodogram, grown while the angle about the field does not matter."""
    n = len(series.seconds)
    first = part(series, slice(max(0, centre - FIRST_ROWS // 2), centre - FIRST_ROWS // 2 + FIRST_ROWS))
    rows_used = first.used
    if rows_used.sum() < 5:
        return []
    peaks = [(np.zeros(3), 1.0)]
    if not series.gyro_b.any():
        peaks = rate_peaks(first.seconds[rows_used], first.field_b[rows_used], most=5)
    stems = []
    for rate, _ in peaks:
        anchor_field = series.field_b[centre] if series.used[centre] else first.field_b[rows_used][0]
        motion = Motion(
            q_bi=attitude_on_circle(anchor_field, series.field_i[centre], 0.0),
            omega_b=rate,
            anchor=0,
            shape=np.zeros(5) if rigid and inertia is None else None,
            inertia=inertia if rigid else None,
            dipole=None,
        )
        rows = FIRST_ROWS
        motion = _fit(series, centre, rows, motion, noise_tesla)
        while rows < n and field_turn(series, *_span(n, centre, rows)) < BRANCH_TURN:
            rows = min(n, int(np.ceil(GROWTH * rows)))
            motion = _fit(series, centre, rows, motion, noise_tesla)
        stems.append(Candidate(motion=motion, row=centre, rows=rows))
    return stems


def _span(n: int, centre: int, rows: int) -> tuple[int, int]:
    first = max(0, min(centre - rows // 2, n - rows))
    return first, min(n, first + rows)


def _fit(series: Series, centre: int, rows: int, motion: Motion, noise_tesla: float) -> Motion:
    """The motion fitted to a window; its state stays at `centre`."""
    rows_near, anchor = window(series, centre, rows, float(np.linalg.norm(motion.omega_b + series.gyro_b[centre])))
    return fit_window(rows_near, replace(motion, anchor=anchor), _noise(rows_near, noise_tesla), iterations=12)


def _branches(series: Series, centre: int, rows: int, stem: Motion, noise_tesla: float) -> list[Candidate]:
    """Copies of a stem at several angles about the field, each grown on until the field has turned far."""
    n = len(series.seconds)
    axis = series.field_b[centre] if series.used[centre] else stem.omega_b
    tips = []
    for k in range(AZIMUTHS):
        motion = replace(stem, q_bi=turned_about(stem.q_bi, axis, 2.0 * np.pi * k / AZIMUTHS))
        tips.append(_fit(series, centre, rows, motion, noise_tesla))
    tips = [c.motion for c in _distinct([Candidate(motion=m, row=centre, rows=rows) for m in tips])]
    free_dipole = stem.shape is not None or stem.inertia is not None
    return [_grown(series, centre, rows, tip, noise_tesla, free_dipole, n) for tip in tips]


def _grown(series, centre: int, rows: int, motion: Motion, noise_tesla: float, free_dipole: bool, n: int) -> Candidate:
    """One tip grown until the field has turned by FINAL_TURN or the motion no longer holds."""
    held = rows
    while rows < n and field_turn(series, *_span(n, centre, rows)) < FINAL_TURN:
        rows = min(n, int(np.ceil(GROWTH * rows)))
        if free_dipole and motion.dipole is None:
            motion = replace(motion, dipole=np.zeros(3))
        longer = _fit(series, centre, rows, motion, noise_tesla)
        if longer.chi2 > 25.0 and longer.chi2 > 4.0 * motion.chi2:
            break
        motion, held = longer, rows
    kind = "rigid body" if free_dipole else "constant rate"
    spin = np.degrees(np.linalg.norm(motion.omega_b))
    fit = f"misfit {np.sqrt(motion.chi2):.1f} over {motion.samples} samples"
    return Candidate(motion=motion, row=centre, rows=held, words=f"{kind}, {spin:.3g} deg/s, {fit}")


def lengthened(series: Series, candidate: Candidate, noise_tesla: float) -> Candidate:
    """The candidate's motion fitted over windows that grow to the whole arc or LONGEST_TURN, as long as it holds there."""
    n = len(series.seconds)
    rows, motion = candidate.rows, candidate.motion
    if (motion.shape is not None or motion.inertia is not None) and motion.dipole is None:
        motion = replace(motion, dipole=np.zeros(3))
    held = rows
    step = float(np.median(np.diff(series.seconds)))
    most = min(n, max(rows, int(LONGEST_TURN / max(np.linalg.norm(motion.omega_b) * step, 1e-9))))
    while GROWTH * rows < most or rows < most == n:
        rows = min(most, int(np.ceil(GROWTH * rows)))
        longer = _fit(series, candidate.row, rows, motion, noise_tesla)
        if longer.chi2 > max(2.0, 3.0 * motion.chi2):
            break
        motion, held = longer, rows
    return replace(candidate, motion=motion, rows=held)


def _distinct(candidates: list[Candidate]) -> list[Candidate]:
    """Candidates that differ in attitude or rate; of equals the first."""
    kept: list[Candidate] = []
    for candidate in candidates:
        if not any(_same(candidate, other) for other in kept):
            kept.append(candidate)
    return kept


def _same(a: Candidate, b: Candidate) -> bool:
    if a.row != b.row:
        return False
    turn = 2.0 * np.arccos(min(1.0, abs(float(a.motion.q_bi @ b.motion.q_bi))))
    rate = np.linalg.norm(a.motion.omega_b - b.motion.omega_b)
    return turn < SAME_ANGLE and rate < 0.02 * np.linalg.norm(a.motion.omega_b) + np.radians(0.01)
