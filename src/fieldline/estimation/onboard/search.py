"""The first attitude from a window of readings, no prior needed; or why there is none yet.

Starts of a rigid body of known inertia with a residual dipole to be found, filtered over the window: the same search as
`estimate_attitude`. It is believed if its innovations are as large as they say, and no motion that ends elsewhere is about
as likely.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.estimation.consistency import consistency
from fieldline.estimation.kalman import Noise, filter_forward
from fieldline.estimation.motion import RateModel
from fieldline.estimation.refine import Contender, contend
from fieldline.estimation.series import Series
from fieldline.estimation.smoothing import NOTHING, Smoothed, first_prior
from fieldline.estimation.starts import find_starts
from fieldline.estimation.tuning import magnitude_noise
from fieldline.estimation.verdict import angle_between
from fieldline.frames.attitude import rotation_error_b

RIVAL_ANGLE = np.radians(10.0)
RIVAL_LIKELIHOOD = 12.0  # a rival must be e^12 times less likely: innovations of a window remember each other
LARGEST_NIS = 2.0  # per degree of freedom
LEAST_TURN = np.radians(60.0)  # of the reference field, before which the angle about it is not shown
COLOURED_TIME = 1500.0  # s: bias left over and field model, as the satellite moves on


class Found(NamedTuple):
    """A first attitude at the window's last row: state (1, 10) and covariance (1, 54) as the filter takes them."""

    state: np.ndarray
    covariance: np.ndarray
    noise: Noise
    model: RateModel
    words: str


def search(series: Series, inertia_kg_m2: np.ndarray, bias_std_tesla: float) -> Found | str:
    """The motion over a window, or in words why there is none to believe."""
    turned = float(angle_between(series.field_i, series.field_i[:1]).max())
    if turned < LEAST_TURN:
        return f"the field has turned by {np.degrees(turned):.0f} deg; {np.degrees(LEAST_TURN):.0f} are needed"
    floor = magnitude_noise(series)
    noise = Noise(white=floor, coloured=max(0.5 * floor, bias_std_tesla), coloured_time=COLOURED_TIME)
    starts = find_starts(series, floor, inertia=inertia_kg_m2, rigid=True)
    contenders = contend(series, starts, noise, floor)
    if not contenders:
        return "no motion was found that the filter could follow"
    best = contenders[0]
    judged = consistency(best.smoothed.white)["nis_mean"]
    if judged is None or judged > LARGEST_NIS:
        return f"the likeliest motion misses the readings: {judged or np.inf:.1f} times the expected square"
    rival = _rival(contenders)
    if rival is not None:
        return f"two motions are about as likely and end {rival:.0f} deg apart"
    state, covariance = at_end(series, best.smoothed)
    words = f"{best.candidate.words}; residuals {np.sqrt(judged):.1f} sigma of {1e9 * floor:.0f} nT"
    return Found(state, covariance, best.smoothed.noise, best.smoothed.model, words)


def _rival(contenders: list[Contender]) -> float | None:
    """How far away [deg] the likeliest motion ends that is about as likely as the best."""
    best = contenders[0]
    for other in contenders[1:]:
        away = float(np.linalg.norm(rotation_error_b(best.smoothed.q_bi[-1], other.smoothed.q_bi[-1])))
        if away > RIVAL_ANGLE and best.log_likelihood - other.log_likelihood < RIVAL_LIKELIHOOD:
            return float(np.degrees(away))
    return None


def at_end(series: Series, smoothed: Smoothed) -> tuple[np.ndarray, np.ndarray]:
    """Filtered state and covariance at the last row, linearised about the smoothed path, so as the data know it."""
    state, offset, prior = smoothed.path[:1].copy(), np.zeros((1, 9)), first_prior(smoothed.start, smoothed.noise, True)
    filter_forward(series, True, 0.0, state, offset, prior, smoothed.noise, smoothed.model, smoothed.path, *NOTHING)
    # at the last row filter and smoother agree
    state[0] = smoothed.path[-1]
    return state, prior
