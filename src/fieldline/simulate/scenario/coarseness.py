"""Whether a fixed step follows the rotation: the angle that a body, or its nutation, turns in one step.

    rate = max(|omega|, |h| / J_min)                                              (1)
    angle = rate step,    step that would do = FINE_RAD / rate                    (2)

h is the momentum stored in wheels. The error of rk4 in a step is about angle^5 / 120: at FINE_RAD it is 1e-7 rad, which
a day of such steps gathers to some hundredths of a radian; at COARSE_RAD the motion is lost within hours.
"""

from __future__ import annotations

from math import hypot, radians

import numpy as np

from fieldline.simulate.scenario.body import SENSORS

FINE_RAD = 0.1
COARSE_RAD = 0.5
ORBIT_COARSE_RAD = 0.2  # of the orbit in a step: beyond it rk4 loses kilometres within an orbit


def fastest_rate(body) -> float:
    """Equation (1) [rad/s] at the start of a body; 0 for a point mass."""
    if body.kind == "point" or body.inertia_kg_m2 is None:
        return 0.0
    spin = radians(body.random_rate_deg_s or hypot(*(body.rate_deg_s or (0.0, 0.0, 0.0))))
    stored = sum((one.momentum_n_m_s * np.array(one.axis_b) for one in body.wheel), np.zeros(3))
    return max(spin, float(np.linalg.norm(stored)) / float(np.linalg.eigvalsh(body.inertia_kg_m2)[0]))


def longest_step_s(scenario) -> float:
    """The step [s] of rk4: that of the integrator, or the shorter time between readings or calls, where steps end too."""
    rates = [task.rate_hz for task in scenario.software]
    rates += [one.rate_hz for body in scenario.body for key in SENSORS if (one := getattr(body, key))]
    return min([scenario.integrator.step_s, *(1.0 / rate for rate in rates)])


def too_coarse(scenario, body) -> str | None:
    """Why the step cannot follow a body's rotation, with the step that would do; None where it can."""
    rate = fastest_rate(body)
    if scenario.integrator.method != "rk4" or rate * scenario.integrator.step_s <= COARSE_RAD:
        return None  # before all bodies' sensors are looked at: there may be thousands
    step = longest_step_s(scenario)
    if rate * step <= COARSE_RAD:
        return None
    return f"is too coarse: {_angle(step, rate)}; a step of {fine_step(rate):.2g} s would do"


def orbit_too_coarse(scenario, period_s: float) -> str | None:
    """Why the step cannot follow the orbit, with the step that would do; None where it can."""
    step = min(longest_step_s(scenario), scenario.time.output_step_s)
    most = ORBIT_COARSE_RAD / (2.0 * np.pi) * period_s
    if scenario.integrator.method != "rk4" or step <= most:
        return None
    return f"is too coarse for an orbit of {period_s:.5g} s; a step of {0.25 * most:.2g} s would do"


def rather_coarse(scenario, body) -> str | None:
    """A warning where the step follows a body's rotation poorly, with the step that would do."""
    rate = fastest_rate(body)
    if scenario.integrator.method != "rk4" or rate * scenario.integrator.step_s <= FINE_RAD:
        return None
    step = longest_step_s(scenario)
    if not FINE_RAD < rate * step <= COARSE_RAD:
        return None
    return f"step_s is coarse for the rotation: {_angle(step, rate)}; a step of {fine_step(rate):.2g} s keeps a day's error small"


def fine_step(rate_rad_s: float) -> float:
    """The step [s] of equation (2)."""
    return FINE_RAD / rate_rad_s


def _angle(step_s: float, rate_rad_s: float) -> str:
    """What a step means at a rate."""
    return f"at {np.degrees(rate_rad_s):.4g} deg/s a step of {step_s:g} s turns by {np.degrees(rate_rad_s * step_s):.3g} deg"
