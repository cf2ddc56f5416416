"""The residual dipole and the rate's noise found anew from the last hours of readings, with the attitude.

The filter's state is carried back to the first reading of a long window; from there the arc is smoothed, the dipole climbs
the likelihood of its innovations (`polish`), the rate's noise follows, and the filter goes on from the new end.
"""

from __future__ import annotations

import numpy as np

from fieldline.estimation.consistency import consistency
from fieldline.estimation.onboard.search import LARGEST_NIS, Found, at_end
from fieldline.estimation.onboard.tracker import Tracker
from fieldline.estimation.polish import gather_constants, polish
from fieldline.estimation.series import Series
from fieldline.estimation.smoothing import smooth, state_at_first
from fieldline.estimation.tuning import best_rate_noise

ROUNDS = 3


def revise(series: Series, tracker: Tracker, inertia_kg_m2: np.ndarray) -> Found | None:
    """What the filter is to go on with at the last row of a series, or None where the window does not improve on it."""
    noise, model = tracker.noise, tracker.model
    last = len(series.seconds) - 1
    start = state_at_first(series, last, tracker.state, noise, model)
    if not np.isfinite(start).all():
        return None
    before = smooth(series, start, noise, model, passes=2)
    if not np.isfinite(before.log_likelihood):
        return None
    constants = gather_constants(None, None, None, model.dipole, inertia_kg_m2)
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
    state, covariance = at_end(series, smoothed)
    dipole = ", ".join(f"{1e3 * m:.2f}" for m in model.dipole)
    return Found(state, covariance, noise, model, f"residual dipole {dipole} mA m^2, residuals {np.sqrt(judged):.1f} sigma")
