"""How a constant current shakes a line that hangs in an inclined orbit, and why that grows.

A rigid line on a circular orbit in the field of an untilted dipole; theta in the plane, positive forward, phi across it,
positive towards the orbit's normal, of the direction from the lower to the upper end; nu the argument of latitude, ' = d/dnu:

    theta'' = 2 (1 + theta') phi' tan phi - 3 sin theta cos theta
              - e [cos i + sin i tan phi (2 sin nu cos theta - cos nu sin theta)]                           (1)
    phi'' = -sin phi cos phi [(1 + theta')^2 + 3 cos^2 theta] + e sin i [cos nu cos theta + 2 sin nu sin theta]   (2)

e is epsilon of `balance`. Nothing rests: the field of an inclined orbit turns with nu. To first order in e the line follows

    theta = -e cos i / 3,     phi = (e sin i / 3) cos nu                                                   (3)

with the orbit's period; `periodic_libration` continues this to larger e. The current pumps energy into the swing about it:
of the four Floquet multipliers two are beyond the unit circle for every e > 0 and 0 < i < 90 deg, by 0.12 e^3 at 45 deg:
little for weak currents (a hundredth of a percent an orbit at e = 0.1), ruin within days at e = 1 (16 %). Currents must be
steered, the swing damped, or the line balanced (e = 0).

Source: Pelaez, Lorenzini, Lopez-Rebollal and Ruiz (2000), A new kind of dynamic instability in electrodynamic tethers,
J. Astronautical Sciences 48(4), 449 (their phi is -phi). Valid for constant current and a line that stays straight and taut.
"""

from __future__ import annotations

import numpy as np

from fieldline.analysis.floquet import multipliers_of
from fieldline.errors import InputError, NoEstimateError

STEPS = 240  # Runge-Kutta steps of fourth order an orbit: 1e-6 of the angles
COMPLEX_STEP = 1e-30
MOST_NEWTON = 12
CONTINUED = 0.3  # of epsilon, from one solution to the next


def libration_rates(nu, state, epsilon: float, inclination_rad: float) -> np.ndarray:
    """(4, ...) derivatives by nu of (theta, theta', phi, phi') [rad], equations (1) and (2); complex numbers welcome."""
    theta, swing, phi, roll = state
    si, ci = np.sin(inclination_rad), np.cos(inclination_rad)
    st, ct, sn, cn = np.sin(theta), np.cos(theta), np.sin(nu), np.cos(nu)
    tan = np.tan(phi)
    in_plane = 2.0 * (1.0 + swing) * roll * tan - 3.0 * st * ct
    in_plane = in_plane - epsilon * (ci + si * tan * (2.0 * sn * ct - cn * st))  # (1)
    across = -np.sin(phi) * np.cos(phi) * ((1.0 + swing) ** 2 + 3.0 * ct**2)
    across = across + epsilon * si * (cn * ct + 2.0 * sn * st)  # (2)
    return np.array([swing, in_plane, roll, across])


def after_an_orbit(start, epsilon: float, inclination_rad: float) -> np.ndarray:
    """State one orbit after nu = 0, by classical Runge-Kutta; of `start` (4,) or several side by side (4, n)."""
    state, h = np.array(start), 2.0 * np.pi / STEPS
    for k in range(STEPS):
        nu = k * h
        k1 = libration_rates(nu, state, epsilon, inclination_rad)
        k2 = libration_rates(nu + 0.5 * h, state + 0.5 * h * k1, epsilon, inclination_rad)
        k3 = libration_rates(nu + 0.5 * h, state + 0.5 * h * k2, epsilon, inclination_rad)
        k4 = libration_rates(nu + h, state + h * k3, epsilon, inclination_rad)
        state = state + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)
    return state


def _mapped(start, epsilon: float, inclination_rad: float) -> tuple[np.ndarray, np.ndarray]:
    """State after an orbit (4,) and its derivative by the start (4, 4), by complex steps."""
    several = np.asarray(start, dtype=complex)[:, None] + 1j * COMPLEX_STEP * np.eye(4)
    after = after_an_orbit(several, epsilon, inclination_rad)
    return after[:, 0].real, after.imag / COMPLEX_STEP


def periodic_libration(epsilon: float, inclination_rad: float) -> np.ndarray:
    """(4,) state (theta, theta', phi, phi') [rad, rad per rad] at nu = 0 of the libration with the orbit's period.

    Found by Newton's method from (3), epsilon raised in steps. NoEstimateError where it gets nowhere: beyond e = 1.5 in the
    equator's plane the torque is more than gravity holds, and earlier where the swing resonates with the orbit.
    """
    if not (np.isfinite(epsilon) and 0.0 <= inclination_rad <= np.pi):
        raise InputError(f"epsilon must be finite, the inclination 0 to pi; got {epsilon}, {inclination_rad}")
    state = np.zeros(4)
    parts = max(1, int(np.ceil(abs(epsilon) / CONTINUED)))
    for part in range(1, parts + 1):
        e = epsilon * part / parts
        if part == 1:
            state = e / 3.0 * np.array([-np.cos(inclination_rad), 0.0, np.sin(inclination_rad), 0.0])  # (3)
        state = _closed(state, e, inclination_rad)
    return state


def _closed(state, epsilon: float, inclination_rad: float) -> np.ndarray:
    """The state near this one that returns to itself after an orbit."""
    for _ in range(MOST_NEWTON):
        after, slope = _mapped(state, epsilon, inclination_rad)
        step = np.linalg.solve(slope - np.eye(4), state - after)
        state = state + step
        if not np.isfinite(state).all() or np.abs(state).max() > np.pi:
            break
        if np.abs(step).max() < 1e-11:
            return state
    raise NoEstimateError(
        f"no libration with the orbit's period was found for epsilon = {epsilon:.3g} at {np.degrees(inclination_rad):.1f} deg: "
        "the torque may be more than gravity holds. Lower the current, or bring its centroid nearer to the centre of mass."
    )


def libration_multipliers(epsilon: float, inclination_rad: float) -> np.ndarray:
    """(4,) complex Floquet multipliers of the periodic libration, the largest first; beyond 1 in size it grows so each orbit."""
    return multipliers_of(_mapped(periodic_libration(epsilon, inclination_rad), epsilon, inclination_rad)[1])
