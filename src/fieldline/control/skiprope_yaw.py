"""How a body at the other end of a tether yaws to take a skiprope out of it: rate, direction, start and length.

The tether leaves the body at an arm r from its yaw axis. While the body yaws, that end moves on a circle, and the first
half wave of a uniform, tight line, complex amplitude A in axes that turn with the skiprope, obeys

    dA/dt = -(r w / pi) exp(i e)                                                                                  (1)

where w is the skiprope's rate, the body yaws with that rate and sense, and e is the angle by which the arm is off its best
place, a quarter turn behind the tether's middle. The end then moves towards where the middle is, and the tether's pull works
on the body instead of the other way round. From a deflection d,

    |A| = |d - (r w / pi) t exp(i e)|,    least after t = pi d cos(e) / (r w), and then d |sin(e)|                (2)

2 r are taken off in a turn. A rate that is off by dw lets e run from -dw t / 2 to dw t / 2 about its mean, which leaves about
d |dw| t / 4 across, and takes d (dw t)^2 / 24 off what is taken away.

Bodies that yaw: the orbiter of TP-3123, whose crew this serves. The pull on the arm turns the body too: a torque of up to
T pi d r / L about its yaw axis, which its own control must hold.

Source: (1) is the forced string, q'' + w^2 q = (2 / pi) w^2 r exp(i w t) with its end on the circle, at resonance, averaged.
Valid while r is small against the tether's length and one mode moves; gravity and the orbit's rotation are left out.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError

TURN = 2.0 * np.pi


class SkipropeNow(NamedTuple):
    """The skiprope at a time, as an estimate has it: deflection [m], azimuth of the tether's middle [rad], both with one
    standard deviation; its frequency [Hz], and the sense in which that azimuth grows (1) or falls (-1).
    """  # fmt: skip

    seconds: float
    deflection_m: float
    deflection_std_m: float
    azimuth_rad: float
    azimuth_std_rad: float
    frequency_hz: float
    frequency_std_hz: float
    sense: int


class YawPlan(NamedTuple):
    """What to do, and what to expect. Azimuths and rates count as the skiprope's."""

    start_s: float  # when the yaw begins
    stop_s: float
    rate_rad_s: float  # signed
    turned_rad: float  # angle of the whole manoeuvre
    arm_azimuth_rad: float  # of the arm at the start: no turn is needed before
    expected_m: float  # deflection left, by (2), one standard deviation of azimuth and frequency off
    taken_m: float  # off the deflection


def plan_yaw(now: SkipropeNow, *, arm_m: float, arm_azimuth_rad: float, not_before_s: float) -> YawPlan:
    """The yaw that takes the skiprope out, begun at the first time at which the arm stands right.

    Parameters
    ----------
    now : of an estimate. arm_m : of the attachment from the yaw axis [m]. arm_azimuth_rad : where it points before.
    not_before_s : the earliest start [s], on the clock of `now`.

    Errors: InputError for an arm or frequency that is not positive, or a sense that is not known.
    """
    if now.sense not in (1, -1):
        raise InputError("the sense of the skiprope is not known, so no yaw can be planned against it.")
    if not (arm_m > 0.0 and now.frequency_hz > 0.0 and np.isfinite([now.deflection_m, now.azimuth_rad]).all()):
        raise InputError(f"arm_m and frequency must be positive, the estimate finite; got {arm_m!r}, {now!r}.")
    rate = TURN * now.frequency_hz
    best = arm_azimuth_rad + 0.5 * np.pi * now.sense  # the middle's azimuth when the arm stands a quarter turn behind it
    there = now.azimuth_rad + now.sense * rate * (not_before_s - now.seconds)
    wait = ((best - there) * now.sense % TURN) / rate
    duration = np.pi * now.deflection_m / (arm_m * rate)
    start = not_before_s + wait
    off = np.hypot(now.azimuth_std_rad, TURN * now.frequency_std_hz * (start - now.seconds))
    drift = TURN * now.frequency_std_hz * duration
    across = now.deflection_m * np.hypot(np.sin(min(off, 0.5 * np.pi)), 0.25 * drift)
    along = np.hypot(now.deflection_std_m, now.deflection_m * drift**2 / 24.0)
    return YawPlan(
        start_s=float(start),
        stop_s=float(start + duration),
        rate_rad_s=float(now.sense * rate),
        turned_rad=float(rate * duration),
        arm_azimuth_rad=float(arm_azimuth_rad),
        expected_m=float(np.hypot(across, along)),
        taken_m=float(now.deflection_m),
    )


def arm_azimuth(plan: YawPlan, seconds) -> np.ndarray:
    """[rad] where the arm points at times [s]: at rest, turning, at rest again."""
    times = np.asarray(seconds, dtype=float)
    return plan.arm_azimuth_rad + plan.rate_rad_s * (np.clip(times, plan.start_s, plan.stop_s) - plan.start_s)


def yaw_by(plan: YawPlan, seconds: float, ramp_s: float) -> tuple[float, float, float]:
    """Azimuth turned [rad], its rate and acceleration at a time [s], for a body that takes ramp_s [s] to reach its rate.

    The ramps lie about start and stop, so that between them the arm stands where the plan has it.
    """
    half = 0.5 * ramp_s
    angle = rate = acceleration = 0.0
    for sign, since in ((1.0, seconds - plan.start_s), (-1.0, seconds - plan.stop_s)):
        if since >= half:
            angle, rate = angle + sign * since, rate + sign
        elif since > -half:
            angle, rate = angle + sign * (since + half) ** 2 / (2.0 * ramp_s), rate + sign * (since + half) / ramp_s
            acceleration += sign / ramp_s
    return plan.rate_rad_s * angle, plan.rate_rad_s * rate, plan.rate_rad_s * acceleration


def left_after(deflection_m: float, arm_m: float, rate_rad_s: float, duration_s: float, off_rad: float = 0.0) -> float:
    """[m] |A| of (2) after a yaw of `duration_s` [s] with the arm off by `off_rad` [rad]."""
    return float(abs(deflection_m - arm_m * abs(rate_rad_s) / np.pi * duration_s * np.exp(1j * off_rad)))
