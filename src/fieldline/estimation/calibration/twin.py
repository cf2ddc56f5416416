"""The mirrored solution: readings that lie near a plane fit a bias on either side of it.

Where the field never leaves a plane (a short arc, a body that hardly turns), the magnitudes are the same for the bias b and
for its image in that plane,

    b' = b - 2 ((b - <field_s>) . e) e,   e: direction of least variance of field_s                 (1)

and the curvature of the cost at b knows nothing of b'. The fit is therefore repeated from b'. The odds p of the image,

    p / (1 - p) = exp(-(cost(b') - cost(b)) / k),   k = n / n_eff + m (sigma_ref / s)^2               (2)

(k: how many samples are worth one, from the residuals' memory and from the slow error of the field model over m samples)
give the spread p (theta' - theta)(theta' - theta)^T that the covariance receives.
"""

from __future__ import annotations

import numpy as np

from fieldline.estimation.calibration.distance import distances
from fieldline.estimation.calibration.fit import NEARLY_SETTLED, Fit, cost_of, fit, prior_of
from fieldline.estimation.calibration.model import Samples

ENOUGH = 3000


def mirrored(one: Fit, samples: Samples) -> np.ndarray:
    """Parameters with the bias of (1)."""
    middle = samples.field_s.mean(axis=0)
    away = samples.field_s - middle
    least = np.linalg.eigh(away.T @ away)[1][:, 0]
    theta = one.theta.copy()
    place = one.terms.layout["bias"]
    theta[place] -= 2.0 * float((theta[place] - middle) @ least) * least
    return theta


def twin(one: Fit, samples: Samples, worth: float) -> tuple[np.ndarray, float]:
    """The other solution's parameters less this one's, and its odds p of (2)."""
    if not one.terms.bias or one.terms.slow:  # slow terms come only with readings all around
        return np.zeros_like(one.theta), 0.0
    few = samples.thinned(ENOUGH)
    prior = prior_of(one.terms, few)
    other = fit(one.terms, mirrored(one, few), few, prior, rounds=2, steps=30, settled=NEARLY_SETTLED)
    expected = few.lengthened(one.scale)
    costs = [cost_of(prior, theta, distances(one.terms, theta, expected), one.scale) for theta in (one.theta, other.theta)]
    more = (costs[1] - costs[0]) * len(samples) / len(few) / worth
    return other.theta - one.theta, float(1.0 / (1.0 + np.exp(np.clip(more, -50.0, 50.0))))
