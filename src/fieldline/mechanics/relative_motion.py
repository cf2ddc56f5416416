"""Motion beside a target on a circular orbit: place (Clohessy and Wiltshire) and small angles of a rigid body.

Axes h are the target's (Hill's): x up, y along the velocity, z along the orbit's normal; they turn at n about z. The
body's axes b are principal, turned from h by the small angles p1, p2, p3 about x, y, z. Its inertia about them is A, B, C.

    x'' - 2 n y' - 3 n^2 x = fx,   y'' + 2 n x' = fy,   z'' + n^2 z = fz                            (1)
    A (p1'' - n p2') + (C - B)(n p2' + n^2 p1) = m1                                                 (2)
    B (p2'' + n p1') + (A - C)(n p1' - 4 n^2 p2 - 3 n^2 z / r0) = m2                                (3)
    C p3'' + 3 n^2 (B - A)(p3 - y / r0) = m3                                                        (4)

z/r0 and y/r0 are there because the angles are taken from the target's axes: the vertical at the body is another. Held still,

    force = M (-3 n^2 x, 0, n^2 z)                                                                  (5)
    moment = (n^2 (C-B) p1,  4 n^2 (C-A) p2 + 3 n^2 (C-A) z/r0,  3 n^2 (B-A)(p3 - y/r0))            (6)

Poles over n: 0, 0, +-j, +-j of (1); +-sqrt(3 (A - B)/C) of pitch (4); of roll and yaw the roots of

    A B s^2 + (-3 A^2 + 2 A B + 2 A C - B C + C^2) s + 4 (A - C)(B - C) = 0,   s = pole^2/n^2       (7)

Not unstable: B > A, and both roots of (7) real, negative and distinct. C > B > A is enough; some other orders serve too.

States, in this order everywhere: (x, x', y, y', z, z', p1, p1', p2, p2', p3, p3') [m, m/s, rad, rad/s].

Source: Clohessy and Wiltshire (1960), J. Aerospace Sciences 27:653 (1); Lawrence (1992), AFIT/GA/ENY/92D-05, chapter 2,
without the term 3 n x'/(2 r0) that its (2.27) adds to p3'': axes h turn at n wherever the body is, so there is none.
DeBra and Delp (1961), J. Astronautical Sciences 8:14, for the region of stability.
Valid where `linearisation_error` is small, and for angles under about 15 degrees (1 % of a sine).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError

STATES = ("x", "x_rate", "y", "y_rate", "z", "z_rate")
STATES += ("psi1", "psi1_rate", "psi2", "psi2_rate", "psi3", "psi3_rate")
UNITS = ("m", "m s-1") * 3 + ("rad", "rad s-1") * 3
OUTPUTS = STATES[::2]
APART = 1e-6  # of n: poles closer than this are not told apart in the closed form


class Attitude(NamedTuple):
    """What the gravity gradient does to small angles: poles [1/s] of pitch (2,) and of roll and yaw (4,)."""

    pitch: np.ndarray
    roll_yaw: np.ndarray
    ordered: bool  # C > B > A
    stable: bool  # no pole grows, none repeats
    growth_s: float  # time in which the fastest grows e-fold; inf if none does


def principal(inertia_kg_m2) -> tuple[float, float, float]:
    """(A, B, C) [kg m^2] of three principal moments; InputError for what no body can have."""
    moments = np.asarray(inertia_kg_m2, dtype=float)
    if moments.shape != (3,) or not np.isfinite(moments).all() or not (moments > 0.0).all():
        raise InputError(f"inertia_kg_m2 must be three positive principal moments A, B, C; got {inertia_kg_m2!r}.")
    a, b, c = (float(m) for m in moments)
    if max(a, b, c) > (a + b + c) * 0.5 * (1.0 + 1e-9):
        raise InputError(
            f"inertia_kg_m2: no body has moments {a:.6g}, {b:.6g}, {c:.6g}; each is at most the sum of the other two."
        )
    return a, b, c


def motion_matrix(mean_motion_rad_s: float, radius_m: float, inertia_kg_m2) -> np.ndarray:
    """(12, 12) matrix F of dx/dt = F x, equations (1) to (4); SI, the module's states and axes."""
    n, (a, b, c) = mean_motion_rad_s, principal(inertia_kg_m2)
    f = np.zeros((12, 12))
    f[range(0, 12, 2), range(1, 12, 2)] = 1.0
    f[1, 0], f[1, 3], f[3, 1], f[5, 4] = 3.0 * n * n, 2.0 * n, -2.0 * n, -n * n  # (1)
    f[7, 6], f[7, 9] = -n * n * (c - b) / a, n * (a + b - c) / a  # (2)
    f[9, 4], f[9, 7], f[9, 8] = 3.0 * n * n * (a - c) / (radius_m * b), -n * (a + b - c) / b, 4.0 * n * n * (a - c) / b  # (3)
    f[11, 2], f[11, 10] = 3.0 * n * n * (b - a) / (radius_m * c), -3.0 * n * n * (b - a) / c  # (4)
    return f


def input_matrix(mass_kg: float, inertia_kg_m2, load_map) -> np.ndarray:
    """(..., 12, m) matrix G of F x + G u from a map (..., 6, m) of u to force [N] and moment [N m], rows x, y, z each."""
    load_map = np.asarray(load_map, dtype=float)
    weights = np.concatenate([np.full(3, 1.0 / mass_kg), 1.0 / np.array(principal(inertia_kg_m2))])
    g = np.zeros((*load_map.shape[:-2], 12, load_map.shape[-1]))
    g[..., 1::2, :] = weights[:, None] * load_map
    return g


def output_matrix() -> np.ndarray:
    """(6, 12) matrix H that takes places and angles out of the state."""
    h = np.zeros((6, 12))
    h[range(6), range(0, 12, 2)] = 1.0
    return h


def attitude_poles(mean_motion_rad_s: float, inertia_kg_m2) -> Attitude:
    """The poles of (4) and (7) in closed form, with the verdict."""
    n, (a, b, c) = mean_motion_rad_s, principal(inertia_kg_m2)
    square = 3.0 * (a - b) / c
    linear, constant = -3.0 * a * a + 2.0 * a * b + 2.0 * a * c - b * c + c * c, 4.0 * (a - c) * (b - c)
    root = np.sqrt(complex(linear * linear - 4.0 * a * b * constant))
    far = -0.5 * (linear + (root if linear >= 0.0 else -root))  # no cancellation; the other follows from the product
    squares = np.array([far / (a * b), constant / far if far != 0.0 else 0.0])  # (7)
    pitch, roll_yaw = n * np.sqrt(complex(square)), n * np.sqrt(squares.astype(complex))
    poles = np.array([pitch, -pitch]), np.concatenate([roll_yaw, -roll_yaw])
    swings = root.imag == 0.0 and root.real > 0.0 and squares.real.max() < 0.0
    growth = max(float(np.abs(poles[0].real).max()), float(np.abs(poles[1].real).max()))
    growth = growth if growth > 1e-9 * n else 0.0
    return Attitude(*poles, bool(c > b > a), bool(square < 0.0 and swings), 1.0 / growth if growth else float("inf"))


def holding_force(mean_motion_rad_s: float, mass_kg: float, position_h) -> np.ndarray:
    """(..., 3) force [N], axes h, that keeps position_h (..., 3) [m] constant: equation (5)."""
    return mass_kg * mean_motion_rad_s**2 * np.array([-3.0, 0.0, 1.0]) * np.asarray(position_h, dtype=float)


def holding_moment(mean_motion_rad_s: float, radius_m: float, inertia_kg_m2, position_h, angles=(0.0, 0.0, 0.0)) -> np.ndarray:
    """(..., 3) moment [N m], axes b, that keeps the angles (..., 3) [rad] constant at position_h (..., 3) [m]: equation (6)."""
    a, b, c = principal(inertia_kg_m2)
    _, y, z = np.moveaxis(np.asarray(position_h, dtype=float) / radius_m, -1, 0)
    p1, p2, p3 = np.moveaxis(np.asarray(angles, dtype=float), -1, 0)
    about = (c - b) * p1, (c - a) * (4.0 * p2 + 3.0 * z), 3.0 * (b - a) * (p3 - y)
    return mean_motion_rad_s**2 * np.stack(np.broadcast_arrays(*about), axis=-1)


def equilibrium(radius_m: float, ahead_m: float) -> np.ndarray:
    """(12,) the one kind of place that needs neither force nor moment: y = ahead_m, pitched by y/r0 to the vertical there."""
    state = np.zeros(12)
    state[2], state[10] = ahead_m, ahead_m / radius_m
    return state


def free_translation(mean_motion_rad_s: float, seconds, state) -> np.ndarray:
    """(..., 6) of (x, x', y, y', z, z') after `seconds` (...) from `state` (6,): (1) without force, in closed form."""
    n, t = mean_motion_rad_s, np.asarray(seconds, dtype=float)
    x0, u0, y0, v0, z0, w0 = (float(s) for s in state)
    s, c = np.sin(n * t), np.cos(n * t)
    rate = 6.0 * n * x0 + 3.0 * v0  # of the drift, backwards
    a, b = -(3.0 * x0 + 2.0 * v0 / n), u0 / n
    x = a * c + b * s + 4.0 * x0 + 2.0 * v0 / n
    y = y0 - 2.0 * b - rate * t - 2.0 * a * s + 2.0 * b * c
    velocity = n * (b * c - a * s), -rate - 2.0 * n * (a * c + b * s)
    return np.stack([x, velocity[0], y, velocity[1], z0 * c + w0 / n * s, w0 * c - n * z0 * s], axis=-1)


def free_motion(mean_motion_rad_s: float, radius_m: float, inertia_kg_m2, seconds, state) -> np.ndarray:
    """(..., 12) states after `seconds` (...) from `state` (12,), no loads but gravity: (1) to (4) in closed form.

    Pitch and roll-yaw are their own modes about a motion that the place forces: a ramp and a wave at n. Where a mode is at
    n or two meet (to 1e-6 n) that form has no meaning and the matrix exponential stands in for it.
    """
    seconds, state = np.asarray(seconds, dtype=float), np.asarray(state, dtype=float)
    n, moments = mean_motion_rad_s, principal(inertia_kg_m2)
    f = motion_matrix(n, radius_m, moments)
    poles = attitude_poles(n, moments)
    squares = poles.roll_yaw[:2] ** 2
    gaps = [poles.pitch[0] ** 2 + n * n, poles.pitch[0] ** 2, squares[0] - squares[1], *(squares + n * n), *squares]
    if min(abs(gap) for gap in gaps) < APART * n * n:
        return _by_exponential(f, seconds, state)
    place = free_translation(n, seconds, state[:6])
    start, forced = _forced_attitude(n, f, 0.0, state[:6]), _forced_attitude(n, f, seconds, state[:6])
    own = np.concatenate(
        [
            _four_mode_exponential(f[6:10, 6:10], *squares, seconds) @ (state[6:10] - start[:4]),
            _two_mode_exponential(poles.pitch[0] ** 2, seconds) @ (state[10:] - start[4:]),
        ],
        axis=-1,
    )
    return np.concatenate([place, forced + own], axis=-1)


def linearisation_error(radius_m: float, position_h) -> np.ndarray:
    """(...) error of (1) at a place held still, position_h (..., 3) [m], as a part of its acceleration's greatest, 3 n^2 |r|.

    Exact gravity and centrifugal acceleration less 3 n^2 x, 0, -n^2 z; to first order 1.5 |r|/r0 at most.
    """
    p = np.asarray(position_h, dtype=float) / radius_m
    up = p + np.array([1.0, 0.0, 0.0])
    # 1 - |up|^-3 without cancellation: |up|^2 - 1 is small beside 1.
    fall = -np.expm1(-1.5 * np.log1p(2.0 * p[..., 0] + (p * p).sum(axis=-1)))
    exact = up * fall[..., None] - p * np.array([0.0, 0.0, 1.0])
    size = 3.0 * np.linalg.norm(p, axis=-1)
    missed = np.linalg.norm(exact - p * np.array([3.0, 0.0, -1.0]), axis=-1)
    return np.divide(missed, size, out=np.zeros_like(missed), where=size > 0.0)


def _forced_attitude(n: float, f: np.ndarray, seconds, state) -> np.ndarray:
    """(..., 6) of the angles and their rates as the place forces them: a ramp in pitch, waves at n in all three."""
    t = np.asarray(seconds, dtype=float)
    x0, u0, y0, v0, z0, w0 = state
    ramp = -(6.0 * n * x0 + 3.0 * v0)
    pull = f[11, 2] / f[11, 10]  # -1/r0: pitch follows y / r0 where it is slow
    wave = -f[11, 2] / (f[11, 10] + n * n)  # and at n as an oscillator does
    cosine, sine = 2.0 * u0 / n, 2.0 * (3.0 * x0 + 2.0 * v0 / n)
    s, c = np.sin(n * t), np.cos(n * t)
    pitch = -pull * (y0 - 2.0 * u0 / n + ramp * t) + wave * (cosine * c + sine * s)
    pitch_rate = -pull * ramp + wave * n * (sine * c - cosine * s)
    drive = np.zeros(4, complex)
    drive[3] = f[9, 4] * (z0 - 1j * w0 / n)
    phasor = np.linalg.solve(1j * n * np.eye(4) - f[6:10, 6:10], drive)
    waves = (np.exp(1j * n * t)[..., None] * phasor).real
    return np.concatenate([waves, np.stack([pitch, pitch_rate], axis=-1)], axis=-1)


def _wave(square: complex, seconds) -> tuple[np.ndarray, np.ndarray]:
    """cosh(k t) and sinh(k t)/k of k^2 = square, whichever root is taken."""
    k = np.sqrt(complex(square))
    return np.cosh(k * seconds), np.sinh(k * seconds) / k


def _two_mode_exponential(square: complex, seconds) -> np.ndarray:
    """(..., 2, 2) transition of p'' = square p."""
    c, s = (w.real for w in _wave(square, seconds))
    return np.stack([np.stack([c, s], axis=-1), np.stack([complex(square).real * s, c], axis=-1)], axis=-2)


def _four_mode_exponential(m: np.ndarray, one: complex, other: complex, seconds) -> np.ndarray:
    """(..., 4, 4) exp(m t) of a matrix whose squares of eigenvalues are `one` and `other`, twice each: Sylvester's formula."""
    square, identity = m @ m, np.eye(4)
    total = np.zeros((*np.shape(seconds), 4, 4), complex)
    for here, there in ((one, other), (other, one)):
        c, s = _wave(here, seconds)
        part = (square - there * identity) / (here - there)
        total += c[..., None, None] * part + s[..., None, None] * (part @ m)
    return total.real


def _by_exponential(f: np.ndarray, seconds: np.ndarray, state: np.ndarray) -> np.ndarray:
    """(..., 12) exp(F t) state."""
    from scipy.linalg import expm

    return expm(f * seconds[..., None, None]) @ state
