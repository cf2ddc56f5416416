"""Which candidate the data support: by what it predicts in stretches of the arc that it was not fitted to.

The arc is cut into blocks of 450 s (half a knot of the gain; a tenth of a shorter arc). Every fifth block is held out,
five times over, and the loss of its samples, - log Student density, is averaged block by block. A richer candidate replaces
a simpler one when the paired difference of these block means is positive by two of its own standard errors: residuals that
hang together over minutes thus count as the few blocks they are. Besides, whatever predicts, a candidate is refused when

- its matrix or gain leaves physical bounds (eigenvalues 0.5 to 2, gain within 20 %),
- the field that it gives would be uncertain by more than 15 % of itself (directions that the readings never took), or
- it is a gain that cannot be told from a bias because the satellite turns too slowly: with the gain in the model the
  geometry alone makes the field more than three times as uncertain.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fieldline.estimation.calibration.covariance import covariance_of
from fieldline.estimation.calibration.fit import Fit, fit, log_loss, normal_equations, prior_of, with_prior
from fieldline.estimation.calibration.ladder import BASIC, best_fit, extensions
from fieldline.estimation.calibration.model import Samples, Terms, field_std, gain_of, residuals
from fieldline.estimation.calibration.spline import KNOT_SPACING_S, UniformSpline

BLOCK_S = 0.5 * KNOT_SPACING_S
BLOCKS_AT_LEAST = 10
FOLDS = 5
CLEAR_SIGMAS = 2.0
LARGEST_ERROR = 0.15
LARGEST_INFLATION = 3.0
EIGENVALUES = (0.5, 2.0)
GAIN_REACH = 0.2
MOST_TERMS = 4


@dataclass(frozen=True, slots=True)
class Candidate:
    """One line of the table: what was tried, how well it did, and why it was or was not kept."""

    model: str
    parameters: int
    rms_tesla: float
    held_out_rms_tesla: float
    criterion: float
    chosen: bool
    why: str


@dataclass(frozen=True, slots=True)
class Trial:
    """A fitted candidate with the losses of its held-out blocks."""

    fit: Fit
    block_loss: np.ndarray
    block_size: np.ndarray
    held_out_rms: float
    refusal: str

    @property
    def criterion(self) -> float:
        """Mean held-out loss of a sample; less is better."""
        return float(np.average(self.block_loss, weights=self.block_size))


def block_numbers(samples: Samples) -> np.ndarray:
    """(n,) number of the block each sample lies in, counted over all flights."""
    numbers = np.zeros(len(samples), dtype=np.intp)
    start = 0
    for flight in range(int(samples.flight.max()) + 1):
        inside = samples.flight == flight
        t = samples.seconds[inside] - samples.seconds[inside][0]
        length = min(BLOCK_S, max(t[-1] * (1.0 + 1e-9), 1e-9) / BLOCKS_AT_LEAST)
        own = (t / length).astype(np.intp)
        numbers[inside] = start + own
        start += int(own[-1]) + 1
    return np.unique(numbers, return_inverse=True)[1]


def held_out(one: Fit, samples: Samples, blocks: np.ndarray) -> tuple[np.ndarray, float]:
    """Mean loss of each block when it is held out, and the robust RMS of all held-out residuals."""
    loss, residual = np.empty(len(samples)), np.empty(len(samples))
    for fold in range(FOLDS):
        out = blocks % FOLDS == fold
        inside = samples.take(~out)
        again = fit(one.terms, one.theta.copy(), inside, prior_of(one.terms, inside), rounds=2, steps=8)
        residual[out] = residuals(one.terms, again.theta, samples.take(out))
        loss[out] = log_loss(residual[out], again.scale)
    sizes = np.bincount(blocks)
    near = np.abs(residual) < 10.0 * one.scale
    return np.bincount(blocks, loss) / sizes, float(np.sqrt(np.mean(residual[near] ** 2))) if near.any() else np.inf


def clearness(simpler: Trial, richer: Trial) -> float:
    """By how many standard errors the richer candidate predicts better."""
    gain = simpler.block_loss - richer.block_loss
    weight = simpler.block_size / simpler.block_size.sum()
    mean = float(weight @ gain)
    spread = float(np.sqrt(np.sum(weight**2 * (gain - mean) ** 2) * len(gain) / (len(gain) - 1.0)))
    return mean / max(spread, 1e-9)


def geometric_error(one: Fit, samples: Samples) -> float:
    """RMS error of the field from the geometry alone: independent residuals of one and the same size."""
    information, _ = normal_equations(one.terms, one.theta, samples, 1.0)
    covariance = np.linalg.inv(with_prior(information, prior_of(one.terms, samples)))
    return _rms(field_std(_without_gain(one.terms), *_core(one, covariance), _few(samples)))


def refusal_of(one: Fit, samples: Samples, without_gain: Fit | None) -> str:
    """Why the candidate cannot be trusted whatever it predicts; empty where it can."""
    values = np.linalg.eigvalsh(one.terms.matrix_of(one.theta))
    if values.min() < EIGENVALUES[0] or values.max() > EIGENVALUES[1]:
        return f"the matrix would stretch an axis by {values.min():.2f} to {values.max():.2f}"
    reach = max(float(np.abs(gain_of(one.terms, one.theta, part) - 1.0).max()) for _, part in samples.chunks())
    if reach > GAIN_REACH:
        return f"the gain would change by {reach:.0%}"
    if one.terms.size:
        terms, theta, covariance = covariance_of(one, samples)
        error = _rms(field_std(terms, theta, covariance, _few(samples))) / float(np.median(samples.magnitude))
        if error > LARGEST_ERROR:
            return f"the readings leave directions unseen: the field would be uncertain by {error:.0%}"
    if without_gain is not None and one.terms.gain != "none":
        inflation = geometric_error(one, samples) / max(geometric_error(without_gain, samples), 1e-30)
        if inflation > LARGEST_INFLATION:
            return f"the satellite turns too slowly to tell the gain from a bias (error {inflation:.1f} times larger)"
    return ""


def trial(terms: Terms, samples: Samples, blocks: np.ndarray, simpler: Fit | None = None) -> Trial:
    """Fit a candidate, hold out its blocks, judge its conditioning."""
    one = best_fit(terms, samples, simpler)
    losses, rms = held_out(one, samples, blocks)
    return Trial(one, losses, np.bincount(blocks).astype(float), rms, refusal_of(one, samples, simpler))


def choose(samples: Samples, splines: tuple[UniformSpline, ...], flights: int, unit_tesla: float) -> tuple[Fit, list[Candidate]]:
    """Climb from no term at all to as many as the data support."""
    blocks = block_numbers(samples)
    kept: Trial | None = None
    full: Trial | None = None
    tried: list[tuple[Trial, str]] = []
    for terms in BASIC.values():
        full = trial(terms, samples, blocks, full.fit if full else None)
        kept = _judge(full, kept, tried)
    for _ in range(MOST_TERMS):
        base = kept if kept.fit.terms.matrix == "full" else full
        rivals = [trial(terms, samples, blocks, base.fit) for terms in extensions(base.fit.terms, samples, splines, flights)]
        before = kept
        for rival in sorted(rivals, key=lambda one: one.criterion):
            kept = _judge(rival, kept, tried)
        if kept is before:
            break
    return kept.fit, [_candidate(one, why, one is kept, unit_tesla) for one, why in tried]


def _judge(rival: Trial, kept: Trial | None, tried: list[tuple[Trial, str]]) -> Trial:
    """The winner of the two; the verdict is put on the record."""
    if kept is None:
        tried.append((rival, "the simplest"))
        return rival
    sigmas, name = clearness(kept, rival), kept.fit.terms.name
    if rival.refusal:
        tried.append((rival, rival.refusal))
        return kept
    if sigmas <= CLEAR_SIGMAS:
        tried.append((rival, f'does not clearly predict better than "{name}" ({sigmas:+.1f} sigma)'))
        return kept
    tried.append((rival, f'predicts held-out stretches better than "{name}" by {sigmas:.1f} sigma'))
    return rival


def _candidate(one: Trial, why: str, chosen: bool, unit_tesla: float) -> Candidate:
    """The table's line."""
    near = np.abs(one.fit.residual) < 6.0 * one.fit.scale
    rms = float(np.sqrt(np.mean(one.fit.residual[near] ** 2)))
    return Candidate(
        one.fit.terms.name, one.fit.terms.size, rms * unit_tesla, one.held_out_rms * unit_tesla, one.criterion, chosen, why
    )


def _few(samples: Samples) -> Samples:
    """Some hundred samples, evenly taken."""
    return samples.take(slice(None, None, max(1, len(samples) // 400)))


def _rms(values: np.ndarray) -> float:
    """Root of the mean square."""
    return float(np.sqrt(np.mean(values**2)))


def _without_gain(terms: Terms) -> Terms:
    """The same terms without the spline."""
    return replace(terms, gain="none", splines=())


def _core(one: Fit, covariance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Parameters and covariance of everything but the spline."""
    size = _without_gain(one.terms).size
    return one.theta[:size], covariance[:size, :size]
