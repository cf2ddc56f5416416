"""Residual dipole, constant torque and the rate's noise found anew from the readings since the last time.

The filter's state is carried back to the first of those readings; from there the arc is smoothed, dipole and torque
climb the likelihood of its innovations (`polish`), and the rate's noise follows. The torque, constant in body axes, is what
drag does to a body that flies the same side ahead; a tumbler has none to show. The filter goes on with both from where it is: its
own state is the one thing that no window may move, so that a revision gone astray cannot lose the attitude.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fieldline.estimation.consistency import consistency
from fieldline.estimation.motion import RateModel
from fieldline.estimation.onboard.search import LARGEST_NIS
from fieldline.estimation.onboard.tracker import Tracker
from fieldline.estimation.polish import Constants, polish
from fieldline.estimation.series import Series
from fieldline.estimation.smoothing import smooth, state_at_first
from fieldline.estimation.tuning import best_rate_noise

ROUNDS = 3
FIRST_STD = np.array([1e-2] * 3 + [3e-8] * 3)  # dipole [A m^2], torque [N m]
DRIFT_STD = np.array([5e-6] * 3 + [2e-9] * 3)  # of them between two revisions
NOISE_STEP = 2.0
LARGEST_LEAP = 5.0  # sigma of what was known before


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Torques(Constants):
    """Six constants: residual dipole [A m^2] and torque [N m]; the inertia is known."""

    def model(self, like: RateModel) -> RateModel:
        """The rate model with them."""
        dipole, torque = (tuple(float(v) for v in part) for part in (self.values[:3], self.values[3:]))
        return like._replace(dipole=dipole, torque=torque)


class Revision(NamedTuple):
    """What the filter goes on with, and the covariance (6, 6) of dipole and torque."""

    model: RateModel
    covariance: np.ndarray
    words: str


def revise(series: Series, tracker: Tracker, known: np.ndarray | None) -> Revision | None:
    """What the filter is to go on with at the last row of a series, or None where the window does not fit.

    known (6, 6) is the covariance of dipole and torque from the last revision, None for the first: the readings before
    the series still count through it.
    """
    noise, model = tracker.noise, tracker.model
    last = len(series.seconds) - 1
    start = state_at_first(series, last, tracker.state, noise, model)
    if not np.isfinite(start).all():
        return None
    before = smooth(series, start, noise, model, passes=2)
    if not np.isfinite(before.log_likelihood):
        return None
    mean = np.array([*model.dipole, *model.torque])
    prior = np.diag(FIRST_STD**2) if known is None else known + np.diag(DRIFT_STD**2)
    constants = Torques(
        values=mean, prior_mean=mean, prior_covariance=prior, covariance=prior, calibrated=0, shape=False, dipole=True
    )
    smoothed = before
    for _ in range(ROUNDS):
        constants, gained = polish(constants, lambda _: series, lambda _: 0.0, smoothed.start, noise, smoothed.model)
        model = best_rate_noise(series, smoothed.start, noise, constants.model(smoothed.model))
        smoothed = smooth(series, smoothed.start, noise, model, passes=2)
        if gained < 1.0:
            break
    judged = consistency(smoothed.white)["nis_mean"]
    if judged is None or judged > LARGEST_NIS or not smoothed.log_likelihood > before.log_likelihood - 1.0:
        return None
    leap = constants.values - mean
    if known is not None and leap @ np.linalg.solve(prior, leap) > LARGEST_LEAP**2:
        return None
    # one window's likelihood of the noise is broad: it moves by steps
    calm = min(max(model.noise, before.model.noise / NOISE_STEP), NOISE_STEP * before.model.noise)
    dipole = ", ".join(f"{1e3 * m:.2f}" for m in model.dipole)
    torque = ", ".join(f"{1e9 * c:.1f}" for c in model.torque)
    words = f"residual dipole {dipole} mA m^2, torque {torque} nN m, residuals {np.sqrt(judged):.1f} sigma"
    return Revision(model._replace(noise=calm), constants.covariance, words)
