"""Which candidate the data support: by what it predicts in stretches of the arc that it was not fitted to.

The arc, less its gaps, is cut into blocks of 300 s (a third of a knot of the gain; a sixteenth of a shorter arc). Every
fifth block is held out, five times over, and the loss of its samples, - log Student density, is averaged block by block.
A richer candidate replaces a simpler one when the block means drop by more than half a per cent of the residuals and a
signed-rank test over the blocks gives chance less than 1 %: residuals that hang together over minutes thus count as the
few blocks they are. Besides, whatever predicts, a candidate is refused when

- its matrix or gain leaves physical bounds (eigenvalues 0.5 to 2, gain within 20 %),
- the field that it gives would be uncertain by more than 15 % of itself (directions that the readings never took) and by more
  than with the simpler one, or
- it changes slowly (gain, drift, temperature) on a satellite that turns too slowly to tell it from a bias (`turning`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fieldline.estimation.calibration.covariance import covariance_of
from fieldline.estimation.calibration.distance import distances
from fieldline.estimation.calibration.fit import NEARLY_SETTLED, Fit, fit, log_loss, prior_of
from fieldline.estimation.calibration.ladder import BASIC, best_fit, extensions
from fieldline.estimation.calibration.model import Samples, Terms, field_std, gain_of
from fieldline.estimation.calibration.signed_rank import chance_of_lead
from fieldline.estimation.calibration.spline import KNOT_SPACING_S, UniformSpline
from fieldline.estimation.calibration.turning import FAST_SHARE, fast_share

BLOCK_S = KNOT_SPACING_S / 3.0
BLOCKS_AT_LEAST = 16
FOLDS = 5
CLEAR_LEVEL = 0.01
LEAST_GAIN = 0.005  # nats a sample: half a per cent of the residuals
LARGEST_ERROR = 0.15
EIGENVALUES = (0.5, 2.0)
GAIN_REACH = 0.2
MOST_TERMS = 4
MANY = 64  # parameters, beyond which the uncertainty is only bounded while candidates are compared


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


@dataclass(frozen=True)
class Trial:
    """A fitted candidate with the losses of its held-out blocks."""

    fit: Fit
    block_loss: np.ndarray
    block_size: np.ndarray
    held_out_rms: float
    refusal: str
    samples: Samples
    field_model_std: float

    @cached_property
    def error(self) -> float:
        """RMS uncertainty of the field that the parameters cause, as a fraction of the field."""
        many = self.fit.terms.size > MANY
        covariance = covariance_of(self.fit, self.samples, self.field_model_std, bounded=many)
        return _rms(field_std(*covariance, _few(self.samples))) / float(np.median(self.samples.magnitude))

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
        t = without_gaps(samples.seconds[inside])
        length = min(BLOCK_S, max(t[-1] * (1.0 + 1e-9), 1e-9) / BLOCKS_AT_LEAST)
        own = (t / length).astype(np.intp)
        numbers[inside] = start + own
        start += int(own[-1]) + 1
    return np.unique(numbers, return_inverse=True)[1]


def without_gaps(seconds: np.ndarray) -> np.ndarray:
    """(n,) [s] from the first sample, gaps longer than a block taken as one step: two passes a day apart are two passes long."""
    steps = np.diff(seconds)
    if not steps.size:
        return np.zeros(len(seconds))
    usual = float(np.median(steps))
    longest = max(10.0 * usual, min(BLOCK_S, float(steps.sum()) / BLOCKS_AT_LEAST))
    return np.concatenate([[0.0], np.cumsum(np.where(steps > longest, usual, steps))])


def held_out(one: Fit, samples: Samples, blocks: np.ndarray) -> tuple[np.ndarray, float]:
    """Mean loss of each block when it is held out, and the robust RMS of all held-out residuals."""
    loss, residual = np.empty(len(samples)), np.empty(len(samples))
    near = {"settled": NEARLY_SETTLED, "scale": one.scale}
    for fold in range(FOLDS):
        out = blocks % FOLDS == fold
        inside = samples.take(~out)
        again = fit(one.terms, one.theta.copy(), inside, prior_of(one.terms, inside), rounds=1, steps=8, **near)
        residual[out] = distances(one.terms, again.theta, samples.take(out).lengthened(again.scale))
        loss[out] = log_loss(residual[out], again.scale)
    sizes = np.bincount(blocks)
    near = np.abs(residual) < 10.0 * one.scale
    return np.bincount(blocks, loss) / sizes, float(np.sqrt(np.mean(residual[near] ** 2))) if near.any() else np.inf


def improvement(simpler: Trial, richer: Trial) -> tuple[float, float]:
    """Mean drop of the held-out loss per sample, and the chance that blocks of no true difference show as much.

    The chance is that of Wilcoxon's signed ranks: one block in which a model fails wildly neither makes nor breaks it.
    """
    drop = simpler.block_loss - richer.block_loss
    mean = float(np.average(drop, weights=simpler.block_size))
    return mean, chance_of_lead(drop)


def refusal_of(one: Fit, samples: Samples) -> str:
    """Why the candidate cannot be trusted whatever it predicts; empty where it can."""
    values = np.linalg.eigvalsh(one.terms.matrix_of(one.theta))
    if values.min() < EIGENVALUES[0] or values.max() > EIGENVALUES[1]:
        return f"the matrix would stretch an axis by {values.min():.2f} to {values.max():.2f}"
    reach = max(float(np.abs(gain_of(one.terms, one.theta, part) - 1.0).max()) for _, part in samples.chunks())
    if reach > GAIN_REACH:
        return f"the gain would change by {reach:.0%}"
    if one.terms.slow:
        share = fast_share(one, samples)
        if share < FAST_SHARE:
            return f"the satellite turns too slowly to tell a slow term from a bias ({share:.0%} of its turning within a knot)"
    return ""


def trial(terms: Terms, samples: Samples, blocks: np.ndarray, field_model_std: float, simpler: Fit | None = None) -> Trial:
    """Fit a candidate, hold out its blocks, judge its conditioning."""
    one = best_fit(terms, samples, simpler)
    losses, rms = held_out(one, samples, blocks)
    return Trial(
        one,
        losses,
        np.bincount(blocks).astype(float),
        rms,
        refusal_of(one, samples),
        samples,
        field_model_std,
    )


def choose(
    samples: Samples, splines: tuple[UniformSpline, ...], flights: int, unit_tesla: float, field_model_std: float
) -> tuple[Fit, list[Candidate]]:
    """Climb from no term at all to as many as the data support."""
    blocks = block_numbers(samples)
    attempt = lambda terms, simpler: trial(terms, samples, blocks, field_model_std, simpler)
    kept = full = attempt(BASIC["none"], None)
    tried = [(kept, "the simplest")]
    for name in ("bias", "bias+scale", "full"):
        full = attempt(BASIC[name], full.fit)
        kept = _judge(full, kept, tried)
    for _ in range(MOST_TERMS):
        base = kept if kept.fit.terms.matrix == "full" else full
        rivals = [attempt(terms, base.fit) for terms in extensions(base.fit.terms, samples, splines, flights)]
        before = kept
        for rival in sorted(rivals, key=lambda one: one.criterion):
            kept = _judge(rival, kept, tried)
        if kept is before:
            break
    return kept.fit, [_candidate(one, why, one is kept, unit_tesla) for one, why in tried]


def _judge(rival: Trial, kept: Trial, tried: list[tuple[Trial, str]]) -> Trial:
    """The winner of the two; the verdict is put on the record."""
    name = kept.fit.terms.name
    drop, chance = improvement(kept, rival)
    why = f'predicts held-out stretches better than "{name}" by {drop:.3f} (chance {chance:.1g})'
    won = drop > LEAST_GAIN and chance < CLEAR_LEVEL
    if rival.refusal:
        won, why = False, rival.refusal
    elif not won:
        why = f'does not clearly predict held-out stretches better than "{name}" ({drop:+.3f}, chance {chance:.1g})'
    elif rival.error > LARGEST_ERROR and rival.error >= kept.error:
        won, why = False, f"the readings leave directions unseen: the field would be uncertain by {rival.error:.0%}"
    tried.append((rival, why))
    return rival if won else kept


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
