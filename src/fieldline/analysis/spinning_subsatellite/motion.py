"""The whole motion of a spinning subsatellite's axis under a tether that turns with the orbit.

With H the body's angular momentum, in axes a, b, c that turn at n about c,

    dk/dt = (H / A - n c) x k,     dH/dt = F d k x a - n c x H                                              (1)

has no singular place: it is (8) of the study without Euler's angles. Two quantities stay what they are,

    C r0 = H . k                                                                                            (29)
    J = H . H / (2 A) + (C r0)^2 / 2 (1/C - 1/A) - n c . H - F d a . k                                      (2)

(2) is the Jacobi integral, in the study's angles A (theta'^2 + psi'^2 sin^2 theta) / 2 - A n^2 sin^2 theta / 2
- C r0 n cos theta - F d sin theta sin psi and the constant C r0^2 / 2; (30) of the study is not conserved. (1) is integrated
by the classical Runge-Kutta rule of a fixed step, by which H turns at most 0.02 rad about the axis.
"""

from __future__ import annotations

from math import ceil

import numpy as np
from numba import njit

from fieldline.analysis.spinning_subsatellite.configuration import SpinningSubsatellite
from fieldline.errors import InputError
from fieldline.frames.vectors import add, axpy, cross, put, scale, unit, vec

TURN_PER_STEP_RAD = 0.02
MOST_STEPS = 50_000_000
TETHER, NORMAL = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


@njit(cache=True)
def axis_rates(axis, momentum, inertia, pull, rate):
    """dk/dt [1/s] and dH/dt [N m]; equation (1), tuples in axes a, b, c."""
    turn = axpy(-rate, NORMAL, scale(1.0 / inertia, momentum))
    torque = axpy(pull, cross(axis, TETHER), scale(-rate, cross(NORMAL, momentum)))
    return cross(turn, axis), torque


@njit(cache=True)
def axis_step(axis, momentum, h, inertia, pull, rate):
    """k and H after a step h [s]."""
    k1, m1 = axis_rates(axis, momentum, inertia, pull, rate)
    k2, m2 = axis_rates(axpy(0.5 * h, k1, axis), axpy(0.5 * h, m1, momentum), inertia, pull, rate)
    k3, m3 = axis_rates(axpy(0.5 * h, k2, axis), axpy(0.5 * h, m2, momentum), inertia, pull, rate)
    k4, m4 = axis_rates(axpy(h, k3, axis), axpy(h, m3, momentum), inertia, pull, rate)
    turned = axpy(h / 6.0, add(axpy(2.0, k2, k1), axpy(2.0, k3, k4)), axis)
    pushed = axpy(h / 6.0, add(axpy(2.0, m2, m1), axpy(2.0, m3, m4)), momentum)
    return unit(turned), pushed


@njit(cache=True)
def axis_kernel(axis, momentum, h, each, inertia, pull, rate, axes, momenta):
    """Fill (n, 3) axes and momenta, `each` steps of h apart, from the given ones on."""
    for row in range(axes.shape[0]):
        put(axes, row, axis)
        put(momenta, row, momentum)
        if row + 1 < axes.shape[0]:
            for _ in range(each):
                axis, momentum = axis_step(axis, momentum, h, inertia, pull, rate)


def axis_motion(
    body: SpinningSubsatellite,
    theta_rad: float,
    spin_rad_s: float,
    duration_s: float,
    *,
    psi_rad: float = 0.5 * np.pi,
    theta_rate_rad_s: float = 0.0,
    psi_rate_rad_s: float = 0.0,
    samples: int = 1001,
):
    """The motion (1) from Euler angles and their rates in the orbit's axes, as an xarray Dataset over `seconds`.

    spin_rad_s : phi' at the start. Returns axis and momentum [N m s] (seconds, axis) in axes a, b, c; theta and psi [rad];
    axial_momentum [N m s] (29) and jacobi [J] (2), both of which should not change; away [rad], the angle from the start.
    """
    import xarray as xr

    given = (theta_rad, spin_rad_s, duration_s, psi_rad, theta_rate_rad_s, psi_rate_rad_s)
    if not np.isfinite(given).all() or duration_s <= 0.0 or not isinstance(samples, int) or samples < 2:
        raise InputError("angles and rates must be finite, duration_s positive and samples 2 or more.")
    n, inertia = body.orbital_rate_rad_s, body.transverse_inertia_kg_m2
    axis, momentum = _start(body, theta_rad, spin_rad_s, psi_rad, theta_rate_rad_s, psi_rate_rad_s)
    fastest = np.linalg.norm(momentum) / inertia + np.sqrt(body.stiffness_n_m / inertia) + n
    each = max(1, ceil(duration_s / (samples - 1) * fastest / TURN_PER_STEP_RAD))
    if each * samples > MOST_STEPS:
        raise InputError(f"duration_s {duration_s:g} takes {each * samples:.2g} steps, over {MOST_STEPS:g}; take a shorter one.")
    axes, momenta = np.empty((samples, 3)), np.empty((samples, 3))
    step = duration_s / ((samples - 1) * each)
    start = vec(axis.reshape(1, 3), 0), vec(momentum.reshape(1, 3), 0)
    axis_kernel(*start, step, each, inertia, body.stiffness_n_m, n, axes, momenta)
    across = np.linalg.norm(np.cross(axes, axes[0]), axis=1)
    psi = np.arctan2(axes[:, 0], -axes[:, 1])
    words = {"units": "rad", "long_name": "angle of the axis from where it was"}
    vector = ("seconds", "axis")
    return xr.Dataset(
        {
            "direction": (vector, axes, {"units": "1", "long_name": "body's axis", "axes": "a, b, c"}),
            "momentum": (vector, momenta, {"units": "N m s", "long_name": "angular momentum", "axes": "a, b, c"}),
            "theta": ("seconds", np.arccos(np.clip(axes[:, 2], -1.0, 1.0)), {"units": "rad"}),
            "psi": ("seconds", psi, {"units": "rad"}),
            "away": ("seconds", np.arctan2(across, axes @ axes[0]), words),
            "axial_momentum": ("seconds", (axes * momenta).sum(axis=1), {"units": "N m s", "long_name": "C r0"}),
            "jacobi": ("seconds", jacobi_integral(body, axes, momenta), {"units": "J", "long_name": "Jacobi integral"}),
        },
        coords={"seconds": np.linspace(0.0, duration_s, samples), "axis": list("abc")},
    )


def jacobi_integral(body: SpinningSubsatellite, direction, momentum) -> np.ndarray:
    """J [J] of (2) from axes (..., 3) and angular momenta (..., 3) [N m s], both in axes a, b, c."""
    k, h = np.asarray(direction, dtype=float), np.asarray(momentum, dtype=float)
    inertia, axial = body.transverse_inertia_kg_m2, body.axial_inertia_kg_m2
    spin = (h * k).sum(axis=-1)
    turning = (h * h).sum(axis=-1) / (2.0 * inertia) + 0.5 * spin**2 * (1.0 / axial - 1.0 / inertia)
    return turning - body.orbital_rate_rad_s * h[..., 2] - body.stiffness_n_m * k[..., 0]


def _start(body, theta, spin, psi, theta_rate, psi_rate) -> tuple[np.ndarray, np.ndarray]:
    """k and H of Euler angles and rates; the body turns at psi' + n about c, theta' about the node and phi' about k."""
    axis = np.array([np.sin(theta) * np.sin(psi), -np.sin(theta) * np.cos(psi), np.cos(theta)])
    node = np.array([np.cos(psi), np.sin(psi), 0.0])
    turn = np.array([0.0, 0.0, psi_rate + body.orbital_rate_rad_s]) + theta_rate * node + spin * axis
    along = turn @ axis
    across = turn - along * axis
    return axis, body.transverse_inertia_kg_m2 * across + body.axial_inertia_kg_m2 * along * axis
