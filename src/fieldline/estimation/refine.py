"""From candidates to one motion: every start is filtered over the whole arc, and the innovations choose.

Screening costs one pass of the filter per candidate and rate noise; the likeliest few are fitted over longer windows,
smoothed, and tuned. Candidates of both kinds of rate model compete on one scale: the log-likelihood of the innovations.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fieldline.estimation.kalman import Noise
from fieldline.estimation.series import Series
from fieldline.estimation.smoothing import Smoothed, log_likelihood, smooth, state_at_first
from fieldline.estimation.starts import Candidate, lengthened
from fieldline.estimation.tuning import best_rate_noise, tune

KEPT = 4  # candidates of a kind that are smoothed
MOST_SCREENED = 20  # candidates, by the fit of their windows, that are filtered at all
LENGTHENED = 4  # candidates, by the fit of their windows
SCREEN_NOISES = (1e-6, 3e-5, 1e-3)  # [rad/s/sqrt(s)] rate noises of the screening


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Contender:
    """A candidate after the filter has run from it over the whole arc."""

    candidate: Candidate
    smoothed: Smoothed

    @property
    def log_likelihood(self) -> float:
        """Of its innovations."""
        return self.smoothed.log_likelihood


def screen(series: Series, candidates: list[Candidate], noise: Noise) -> list[tuple[float, float, Candidate]]:
    """Candidates with their best log-likelihood under SCREEN_NOISES and that rate noise, the likeliest first."""
    scored = []
    for candidate in candidates:
        best, quietest = -np.inf, SCREEN_NOISES[0]
        for rate_noise in SCREEN_NOISES:
            model = candidate.motion.model(rate_noise)
            start = state_at_first(series, candidate.row, candidate.state, noise, model)
            if np.isfinite(start).all():
                value = log_likelihood(series, start, noise, model)
                if np.isfinite(value) and value > best:
                    best, quietest = value, rate_noise
        if np.isfinite(best):
            scored.append((best, quietest, candidate))
    return sorted(scored, key=lambda row: -row[0])


def contend(series: Series, candidates: list[Candidate], noise: Noise, noise_tesla: float) -> list[Contender]:
    """The likeliest candidates after longer fits and two passes of the smoother, the likeliest first."""
    contenders = []
    # a rigid motion that explains its window is lengthened before the whole arc judges it: a shape known to a per cent
    # loses its phase within some dozen turns, and would lose to a worse one with a freer rate
    step = float(np.median(np.diff(series.seconds)))
    longer = [
        lengthened(series, c, noise_tesla) if c.motion.model().rigid and rank < _most(c, step) else c
        for rank, c in enumerate(candidates[:MOST_SCREENED])
    ]
    for _, rate_noise, candidate in screen(series, longer, noise)[:KEPT]:
        model = candidate.motion.model(rate_noise)
        start = state_at_first(series, candidate.row, candidate.state, noise, model)
        model = best_rate_noise(series, start, noise, model)
        start = state_at_first(series, candidate.row, candidate.state, noise, model)
        result = smooth(series, start, noise, model, passes=2)
        if np.isfinite(result.log_likelihood):
            contenders.append(Contender(candidate=candidate, smoothed=result))
    return sorted(contenders, key=lambda c: -c.log_likelihood)


def _most(candidate: Candidate, step_s: float) -> int:
    """How many candidates are lengthened: fewer where the body turns far between samples, which is dear to follow."""
    return LENGTHENED if np.linalg.norm(candidate.motion.omega_b) * step_s < 0.4 else LENGTHENED // 2


def settle(series: Series, contender: Contender, floor: float) -> Contender:
    """The contender with noise and rate noise tuned by likelihood, smoothed again from its own start."""
    before = contender.smoothed
    noise, model, _ = tune(series, before.start, before.noise, before.model, floor)
    after = smooth(series, before.start, noise, model, passes=2)
    # the second pass starts elsewhere than the tuning did; where that lost what the tuning won, the tuning is dropped
    return replace(contender, smoothed=after) if after.log_likelihood > before.log_likelihood else contender
