"""Attitude and rate from a field and its two derivatives, for a known inertia and torque: section 3.2.

With omega on the axes of the circle, omega_2(Phi) and omega_3(Phi) from (2-17), and Euler's equation

    domega/dt = I^-1 (N - omega x I omega)                                                      (3-15)

the two projections of the field's second derivative,

    delta_2(Phi) - s2(Phi) = |B| c domega/dt . C3 + omega_1 |dB_R| c^2(Phi)                     (3-7a)
    delta_3(Phi) - s3 = -|B| c domega/dt . C2                                                   (3-7b)
    c C2 = (lambda_A + lambda_R cos Phi) D2 + lambda_R sin Phi D3                               (3-3)
    c C3 = (lambda_A + lambda_R cos Phi) D3 - lambda_R sin Phi D2                               (3-4)

are both quadratics in omega_1,  a_0 + a_1 omega_1 + a_2 omega_1^2 = 0  and  b_0 + b_1 omega_1 + b_2 omega_1^2 = 0, whose
coefficients a_k, b_k are trigonometric polynomials in Phi of degree 3 - k. They have a common root where their resultant

    (a_2 b_0 - a_0 b_2)^2 - (a_2 b_1 - a_1 b_2)(a_1 b_0 - a_0 b_1) = 0                          (a)

vanishes: a trigonometric polynomial of degree 8, hence a polynomial of degree 16 in exp(i Phi). Its roots on the unit
circle are all the solutions at once, so nothing need be scanned for (the paper scans; a scan misses pairs and returns
poles). Each is refined on (3-7a), (3-7b) by Newton's rule and kept if both hold.

The torque may depend on the attitude, against the paper's belief without any iteration: A(Phi) is explicit, and a torque
that is quadratic in A, such as the gravity gradient's, has degree 2 in Phi, which leaves the degrees above unchanged.

Source: Natanson, McLaughlin and Nicklas (1990), NASA CP-3102, section 3.2, equation (3-8a) with its sign mended.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError
from fieldline.estimation.natanson.circle import attitude_at, rate_at, uncertainty_circle
from fieldline.estimation.natanson.constant_rate import Roots, Status, projections, quaternions_of
from fieldline.estimation.natanson.trigonometric import common_roots
from fieldline.mechanics.rigid_body import as_inertia9, gravity_gradient

SAMPLES = 8  # angles at which torques are sampled: enough for degree 3
ANGLES = 2.0 * np.pi * np.arange(SAMPLES) / SAMPLES

TorqueOfAttitude = Callable[[np.ndarray], np.ndarray]


def b_dot_torque(gain_a_m2_s_per_t: float, derivatives_b) -> np.ndarray:
    """(n, 3) [N m], body axes: -K dB_A x B_A of the B-dot law m = -K dB_A with gain K [A m^2 s/T]."""
    return -gain_a_m2_s_per_t * np.cross(derivatives_b.first, derivatives_b.value)


def gravity_gradient_of_attitude(position_i_m, inertia_kg_m2, gm_m3_s2=EARTH_GM_M3_S2) -> TorqueOfAttitude:
    """The function dcm_bi (n, m, 3, 3) -> torque (n, m, 3) [N m] for positions (n, 3) [m]: give it as `external`."""
    position = np.asarray(position_i_m, dtype=float)

    def torque(dcm_bi):
        return gravity_gradient(np.einsum("nmij,nj->nmi", dcm_bi, position), inertia_kg_m2, gm_m3_s2)

    return torque


def rigid_body_roots(derivatives_b, derivatives_i, inertia_kg_m2, *, torque_b=None, external: TorqueOfAttitude | None = None):
    """All attitudes and rates at each sample that satisfy (3-7a), (3-7b) and (3-15).

    Parameters
    ----------
    derivatives_b, derivatives_i : `Derivatives`, (n, 3) [T], [T/s], [T/s^2].
    inertia_kg_m2 : (3, 3) or (3,); without torques only its ratios matter.
    torque_b : (n, 3) [N m], known in body axes (wheels, B-dot: `b_dot_torque`), or None.
    external : function of dcm_bi (n, m, 3, 3) that gives (n, m, 3) [N m], of degree two at most in dcm_bi, or None.

    Returns
    -------
    `Roots` with as many columns as the sample with most roots has; usually two to six. Its discriminant is NaN.
    """
    inertia = np.reshape(as_inertia9(inertia_kg_m2)[0], (3, 3))
    circle = uncertainty_circle(derivatives_b, derivatives_i)
    second = projections(circle, derivatives_b.second, derivatives_i.second)
    torque_d = _torque_on_circle(circle, torque_b, external)
    present = np.logical_and.reduce([np.isfinite(x).all(axis=-1) for x in (*derivatives_b[:3], *derivatives_i[:3])])
    solvable = present & np.isfinite(circle.d_hat).all(axis=(1, 2)) & np.isfinite(circle.u_hat).all(axis=(1, 2))
    angle, along = np.full((2, len(present), 1), np.nan)
    rows = np.flatnonzero(solvable)
    if rows.size:
        unit = np.maximum((circle.lambda_a + circle.lambda_r) / circle.f_s, 1e-12)[rows]
        quadratics = _quadratics(_rows(circle, rows), _rows(second, rows), inertia, torque_d[rows], unit)
        found, multiple = common_roots(*quadratics)
        angle, along = np.full((2, len(present), found.shape[1]), np.nan)
        angle[rows], along[rows] = found, multiple * unit[:, None]
    return _as_roots(circle, angle, along, inertia, torque_b, external, present, solvable)


def _rows(record, rows):
    """The same record at some of its samples."""
    return type(record)(*(x[rows] for x in record))


def _torque_on_circle(circle, torque_b, external) -> np.ndarray:
    """(n, SAMPLES, 3) [N m]: the torque on D1, D2, D3 at `ANGLES`."""
    count = len(circle.alpha)
    total = np.zeros((count, SAMPLES, 3))
    if torque_b is not None:
        torque = np.asarray(torque_b, dtype=float)
        if torque.shape != (count, 3):
            raise InputError(f"torque_b must be ({count}, 3) [N m], a row for each sample; got {torque.shape}.")
        total += torque[:, None]
    if external is not None:
        outside = external(attitude_at(circle, np.broadcast_to(ANGLES, (count, SAMPLES))))
        _refuse_high_degree(outside)
        total = total + outside
    return np.einsum("nij,nmi->nmj", circle.d_hat, total)


def _refuse_high_degree(torque) -> None:
    """A torque of degree three or more in the attitude would be aliased into a wrong one."""
    waves = np.abs(np.fft.rfft(np.nan_to_num(torque), axis=1))
    if waves[:, 3:].max(initial=0.0) > 1e-6 * waves.max(initial=0.0):
        raise InputError(
            "the external torque is not of degree two or less in the attitude matrix, as the gravity gradient is; "
            "give its value as torque_b at an approximate attitude instead."
        )


def _quadratics(circle, second, inertia, torque_d, unit):
    """Coefficients (n, 3, SAMPLES) of omega_1^0, ^1, ^2 (in units of `unit` [rad/s]) in (3-7a) and (3-7b) at `ANGLES`.

    Both are divided by |dB_R| unit (lambda_A + lambda_R)^2, which makes them of order one.
    """
    cosine, sine = np.cos(ANGLES), np.sin(ANGLES)
    a, r, f_s, slope, field = (
        x[:, None] for x in (circle.lambda_a, circle.lambda_r, circle.f_s, circle.slope_i, circle.magnitude_b)
    )
    a2, a3, r2, r3, s3 = (x[:, None] for x in second)
    two, three = (r * cosine - a) / f_s, r * sine / f_s  # (2-17)
    ahead, aside = a + r * cosine, r * sine  # c C2 on D2 and D3, c C3 on D3 and (negative) D2
    delta_2 = r * r2 - a * a2 + (a * r2 - r * a2) * cosine - (a * r3 + r * a3) * sine  # (3-9a)
    delta_3 = r * r3 - a * a3 + (a * r3 - r * a3) * cosine + (a * r2 + r * a2) * sine  # (3-9b)
    s2 = 4.0 * three * a * slope * circle.kappa_r[:, None]  # (3-8a)
    powers = _acceleration(circle.d_hat, inertia, torque_d, two, three)
    on_c2 = [ahead * p[..., 1] + aside * p[..., 2] for p in powers]
    on_c3 = [ahead * p[..., 2] - aside * p[..., 1] for p in powers]
    first = [delta_2 - s2 - field * on_c3[0], -field * on_c3[1] - slope * (ahead**2 + aside**2), -field * on_c3[2]]  # (3-7a)
    other = [delta_3 - s3 + field * on_c2[0], field * on_c2[1], field * on_c2[2]]  # (3-7b)
    scale = (slope * unit[:, None] * (a + r) ** 2)[:, None]
    units = unit[:, None, None] ** np.arange(3)[None, :, None]
    return np.stack(first, axis=1) * units / scale, np.stack(other, axis=1) * units / scale


def _acceleration(d_hat, inertia, torque_d, two, three):
    """Coefficients (n, SAMPLES, 3) of omega_1^0, ^1 and ^2 in domega/dt on D1, D2, D3: (3-15)."""
    turned = np.swapaxes(d_hat, -1, -2) @ inertia @ d_hat
    inverse = np.linalg.inv(turned)[:, None]
    turned = turned[:, None]
    across = np.stack([0.0 * two, two, three], axis=-1)
    along = np.zeros_like(across)
    along[..., 0] = 1.0

    def momentum(omega):
        return np.squeeze(turned @ omega[..., None], -1)

    torques = (
        torque_d - np.cross(across, momentum(across)),
        -np.cross(along, momentum(across)) - np.cross(across, momentum(along)),
        -np.cross(along, momentum(along)),
    )
    return [np.squeeze(inverse @ torque[..., None], -1) for torque in torques]


def _as_roots(circle, angle, along, inertia, torque_b, external, present, solvable) -> Roots:
    """`Roots` of angles and omega_1 (n, m)."""
    matrices, omega = attitude_at(circle, angle), rate_at(circle, angle, along)
    torque = np.zeros_like(omega) if torque_b is None else np.broadcast_to(np.asarray(torque_b)[:, None], omega.shape)
    if external is not None:
        torque = torque + external(matrices)
    omega_rate = np.einsum("ij,nmj->nmi", np.linalg.inv(inertia), torque - np.cross(omega, omega @ inertia))
    status = np.where(np.isfinite(along).any(axis=1), Status.SOLVED, Status.NO_REAL_ROOT)
    status[~solvable] = Status.NO_CIRCLE
    status[~present] = Status.NO_DATA
    nowhere = np.full(len(present), np.nan)
    return Roots(angle, quaternions_of(matrices), omega, omega_rate, nowhere, status, circle)
