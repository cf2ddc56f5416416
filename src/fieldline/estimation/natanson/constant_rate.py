"""Attitude and rate from a field and its two derivatives, for a body whose rate is constant: section 3.1.

The second derivative of the field closes the circle of section 2. With domega/dt = 0 and

    Delta_j^A = D_j . ddB_A,   Delta_j^R = U_j . ddB_R,   j = 2, 3                              (3-10)
    s3 = -2 kappa_R |dB_R| (1 - alpha^2) / f                                                    (3-8b)

the angle Phi on the circle solves P + Q cos Phi + R sin Phi = 0, where

    P = lambda_R Delta_3^R - lambda_A Delta_3^A - s3
    Q = lambda_A Delta_3^R - lambda_R Delta_3^A                                                 (3-9b)
    R = lambda_A Delta_2^R + lambda_R Delta_2^A
    Phi = atan2(R, Q) +- acos(-P / hypot(Q, R))                                                 (a)

    omega_1 = (delta_2(Phi) - s2(Phi)) / (|dB_R| c^2(Phi))                                      (3-13)
    s2 = +4 omega_3 lambda_A |dB_R| kappa_R                                                     (3-8a), sign mended
    delta_2 = lambda_R Delta_2^R - lambda_A Delta_2^A + (lambda_A Delta_2^R - lambda_R Delta_2^A) cos Phi
              - (lambda_A Delta_3^R + lambda_R Delta_3^A) sin Phi                               (3-9a)
    c^2 = (lambda_A + lambda_R cos Phi)^2 + lambda_R^2 sin^2 Phi                                (3-5)

The paper substitutes x = tan(Phi/2), with a0 = P + Q, a1 = R, a2 = P - Q in a0 + 2 a1 x + a2 x^2 = 0 (3-11), (3-12), and
that loses a root at Phi = pi; (a) loses none, and its discriminant Q^2 + R^2 - P^2 is the paper's a1^2 - a0 a2.
The paper prints (3-8a) with a minus sign; with it (3-7a) fails by a third of its size.

The discriminant touches zero along real orbits, and errors of the derivatives then push it below: there the data hold no
solution. `beyond` says what to give there: nothing (NaN, the default), the point where (a) is nearest to a solution
("nearest"), or both roots of the sample before, as the paper's program did ("previous"). `status` tells which samples.

Source: Natanson, McLaughlin and Nicklas (1990), NASA CP-3102, sections 3 and 3.1. Valid for |domega/dt| |B| well below
the second derivatives of the field; for a known inertia or torque use `general`.
"""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError
from fieldline.estimation.natanson.circle import Circle, attitude_at, rate_at, transverse_rate, uncertainty_circle
from fieldline.frames.attitude import quaternion_from_dcm


class Status(IntEnum):
    """What became of a sample."""

    SOLVED = 0
    NO_REAL_ROOT = 1
    NO_CIRCLE = 2
    NO_DATA = 3
    EVERY_ANGLE = 4


WORDS = {
    Status.SOLVED: "solved",
    Status.NO_REAL_ROOT: "the discriminant is negative: errors of the derivatives leave no solution there",
    Status.NO_CIRCLE: "the field's derivative is zero or along the field, in body or in inertial axes (digitised too coarsely?)",
    Status.EVERY_ANGLE: "the second derivatives vanish across the field: every attitude on the circle solves",
    Status.NO_DATA: "too near an end or a gap for the stencil of the derivatives",
}
TOLD = 1e-12  # of the terms of (3-9b): below it Q and R are rounding
BEYOND = ("nan", "nearest", "previous")


class Roots(NamedTuple):
    """All solutions at n samples, m of them each; where there are fewer the rest is NaN."""

    angle_rad: np.ndarray  # (n, m) Phi, 0 to 2 pi
    q_bi: np.ndarray  # (n, m, 4)
    omega_b: np.ndarray  # (n, m, 3) [rad/s]
    omega_rate_b: np.ndarray  # (n, m, 3) [rad/s^2], zero for a constant rate
    discriminant: np.ndarray  # (n,) of (3-11), scaled by Q^2 + R^2, -inf..1; NaN where it has no meaning
    status: np.ndarray  # (n,) Status
    circle: Circle

    def words(self) -> list[str]:
        """One sentence for each status that occurs, with the number of samples."""
        return [f"{count} of {self.status.size} samples: {WORDS[kind]}" for kind, count in self._tally()]

    def _tally(self):
        kinds, counts = np.unique(self.status, return_counts=True)
        return [(Status(kind), int(count)) for kind, count in zip(kinds, counts, strict=True)]


class Projections(NamedTuple):
    """Second derivatives on the axes of the circle (3-10), (n,) each [T/s^2], and s3 (3-8b)."""

    a2: np.ndarray
    a3: np.ndarray
    r2: np.ndarray
    r3: np.ndarray
    s3: np.ndarray


def projections(circle: Circle, second_b, second_i) -> Projections:
    """Delta_2^A, Delta_3^A, Delta_2^R, Delta_3^R and s3 of second derivatives (n, 3) [T/s^2]."""
    on_d = np.einsum("nij,ni->nj", circle.d_hat, second_b)
    on_u = np.einsum("nij,ni->nj", circle.u_hat, second_i)
    s3 = -2.0 * circle.kappa_r * circle.slope_i * (1.0 - circle.alpha**2) / circle.f_s
    return Projections(on_d[:, 1], on_d[:, 2], on_u[:, 1], on_u[:, 2], s3)


def coefficients(circle: Circle, second: Projections) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """P, Q and R (n,) [T/s^2] of delta_3(Phi) - s3 = P + Q cos Phi + R sin Phi: (3-9b)."""
    a, r = circle.lambda_a, circle.lambda_r
    return r * second.r3 - a * second.a3 - second.s3, a * second.r3 - r * second.a3, a * second.r2 + r * second.a2


def rate_along_field(circle: Circle, second: Projections, angle_rad) -> np.ndarray:
    """omega_1 (n, m) [rad/s] of a constant rate at angles (n, m): (3-13). NaN where c vanishes."""
    a, r, slope = circle.lambda_a[:, None], circle.lambda_r[:, None], circle.slope_i[:, None]
    cosine, sine = np.cos(angle_rad), np.sin(angle_rad)
    a2, a3, r2, r3, _ = (x[:, None] for x in second)
    delta_2 = r * r2 - a * a2 + (a * r2 - r * a2) * cosine - (a * r3 + r * a3) * sine  # (3-9a)
    s2 = 4.0 * transverse_rate(circle, angle_rad)[1] * a * slope * circle.kappa_r[:, None]  # (3-8a)
    square = (a + r * cosine) ** 2 + (r * sine) ** 2  # (3-5)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(square > 1e-12 * (a + r) ** 2, (delta_2 - s2) / (slope * square), np.nan)


def constant_rate_roots(derivatives_b, derivatives_i, *, beyond: str = "nan") -> Roots:
    """Both attitudes and rates at each sample, from the derivatives in body and in inertial axes.

    Parameters
    ----------
    derivatives_b, derivatives_i : `Derivatives`, (n, 3) [T], [T/s], [T/s^2], the same filter for both: its bias cancels.
    beyond : what to give where the discriminant is negative: "nan", "nearest" or "previous".

    Returns
    -------
    `Roots` with m = 2. Neither is the true one by any test on three samples alone: see `choice`.
    """
    if beyond not in BEYOND:
        raise InputError(f'beyond must be one of {", ".join(BEYOND)}; got "{beyond}".')
    circle = uncertainty_circle(derivatives_b, derivatives_i)
    second = projections(circle, derivatives_b.second, derivatives_i.second)
    p, q, r = coefficients(circle, second)
    # of the whole second derivatives: where they lie along the field, what they leave across it is rounding
    whole = np.linalg.norm(derivatives_b.second, axis=1) + np.linalg.norm(derivatives_i.second, axis=1)
    size = (circle.lambda_a + circle.lambda_r) * whole + np.abs(second.s3)
    with np.errstate(invalid="ignore", divide="ignore"):
        told = np.hypot(q, r) > TOLD * size
        ratio = np.where(told, -p / np.where(told, np.hypot(q, r), 1.0), np.nan)
    status = _status(derivatives_b, derivatives_i, ratio)
    status[(status == Status.NO_CIRCLE) & np.isfinite(size)] = Status.EVERY_ANGLE
    spread = np.arccos(np.clip(ratio, -1.0, 1.0))
    angle = np.arctan2(r, q)[:, None] + spread[:, None] * np.array([-1.0, 1.0])
    if beyond != "nearest":
        angle[status == Status.NO_REAL_ROOT] = np.nan
    angle = np.mod(angle, 2.0 * np.pi)
    omega = rate_at(circle, angle, rate_along_field(circle, second, angle))
    quaternion = quaternions_of(attitude_at(circle, angle))
    if beyond == "previous":
        _carry(status == Status.NO_REAL_ROOT, angle, quaternion, omega)
    return Roots(angle, quaternion, omega, np.where(np.isfinite(omega), 0.0, np.nan), 1.0 - ratio**2, status, circle)


def _status(derivatives_b, derivatives_i, ratio) -> np.ndarray:
    """(n,) Status from the inputs and from -P/hypot(Q, R)."""
    status = np.where(np.abs(ratio) > 1.0, Status.NO_REAL_ROOT, Status.SOLVED)
    status[~np.isfinite(ratio)] = Status.NO_CIRCLE
    present = [np.isfinite(x).all(axis=-1) for x in (*derivatives_b[:3], *derivatives_i[:3])]
    status[~np.logical_and.reduce(present)] = Status.NO_DATA
    return status


def _carry(gaps, *rows) -> None:
    """Fill the rows at `gaps` from the row before, in place and in order; a gap at the start stays NaN."""
    source = np.where(gaps, -1, np.arange(gaps.size))
    source = np.maximum.accumulate(source)
    known = source >= 0
    for values in rows:
        values[known] = values[source[known]]


def quaternions_of(matrices) -> np.ndarray:
    """(n, m, 4) of (n, m, 3, 3), NaN where a matrix is not finite."""
    finite = np.isfinite(matrices).all(axis=(-1, -2))
    quaternions = np.full((*matrices.shape[:-2], 4), np.nan)
    if finite.any():
        quaternions[finite] = quaternion_from_dcm(matrices[finite])
    return quaternions
