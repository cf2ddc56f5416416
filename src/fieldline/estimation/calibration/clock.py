"""Would the magnitudes fit better if the time stamps were shifted?

The chosen candidate is fitted again with the model's magnitude at `time + offset` for each offset of a scan. The best
offset is the vertex of the parabola through the lowest mean loss and its neighbours. Its significance against no offset is
that of the block means of the loss (300 s, as for the choice of candidates): the paired difference of each block over the
scatter of those differences, so that a slow misfit which one offset happens to please counts as few blocks, not as
thousands of samples. Nothing is shifted unless asked for.

A positive offset says that the satellite was where the field model puts it `offset` later: the stamps are early.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fieldline.errors import InputError
from fieldline.estimation.calibration.fit import Fit, fit, log_loss, prior_of
from fieldline.estimation.calibration.model import Samples
from fieldline.estimation.calibration.selection import block_numbers

OFFSETS_S = np.arange(-120.0, 121.0, 15.0)
CLEAR_SIGMAS = 3.0
THINNED = 3000


@dataclass(frozen=True, slots=True, eq=False)
class ClockScan:
    """The scan's table and its verdict."""

    offsets_s: tuple[float, ...]
    rms_tesla: tuple[float, ...]
    best_s: float
    std_s: float
    sigmas: float
    applied: bool

    def sentence(self) -> str:
        """The verdict in words."""
        edge = abs(self.best_s) >= max(abs(np.array(self.offsets_s))) - 1e-9
        if edge:
            return f"Clock scan: no best offset within {max(self.offsets_s):.0f} s; the misfit is not one of time."
        clear = "significant" if self.sigmas >= CLEAR_SIGMAS else "not significant"
        done = "applied" if self.applied else "not applied"
        return f"Clock scan: best offset {self.best_s:+.0f} ± {self.std_s:.0f} s, {clear} ({self.sigmas:.1f} sigma), {done}."


def scan_clock(
    one: Fit, samples_at: Callable[[float], Samples], unit_tesla: float, offsets_s: np.ndarray = OFFSETS_S
) -> ClockScan:
    """Fit `one`'s candidate at every offset; `samples_at(offset_s)` are the samples with the magnitudes there."""
    offsets_s = np.asarray(offsets_s, dtype=float)
    if len(offsets_s) < 3 or np.any(np.diff(offsets_s) <= 0.0) or not np.any(offsets_s == 0.0):
        raise InputError(f"a clock scan needs at least three increasing offsets with 0 among them; got {offsets_s}.")
    blocks, losses, rms, theta = None, [], [], one.theta
    for offset in offsets_s:
        samples = samples_at(float(offset)).thinned(THINNED)
        blocks = block_numbers(samples) if blocks is None else blocks
        again = fit(one.terms, theta, samples, prior_of(one.terms, samples), rounds=2, steps=15, scale=one.scale)
        losses.append(np.bincount(blocks, log_loss(again.residual, again.scale)) / np.bincount(blocks))
        near = np.abs(again.residual) < 6.0 * again.scale
        rms.append(float(np.sqrt(np.mean(again.residual[near] ** 2))) * unit_tesla)
    losses = np.array(losses)
    zero, weight = int(np.flatnonzero(offsets_s == 0.0)[0]), np.bincount(blocks) / len(blocks)
    best, std = _vertex(offsets_s, losses, weight)
    near = int(np.argmin(np.abs(offsets_s - best)))
    return ClockScan(tuple(offsets_s), tuple(rms), best, std, _sigmas(losses[zero] - losses[near], weight), False)


def _vertex(offsets_s: np.ndarray, losses: np.ndarray, weight: np.ndarray) -> tuple[float, float]:
    """Offset of least loss, and its 1 sigma from the slope's scatter over the blocks and the curvature."""
    mean = losses @ weight
    k = int(np.argmin(mean))
    if k in (0, len(mean) - 1):
        return float(offsets_s[k]), float("inf")
    about = slice(k - 1, k + 2)
    curvature, slope, _ = np.polyfit(offsets_s[about] - offsets_s[k], mean[about], 2)
    slopes = (losses[k + 1] - losses[k - 1]) / (offsets_s[k + 1] - offsets_s[k - 1])
    scatter = float(np.sqrt(np.sum(weight**2 * (slopes - slopes @ weight) ** 2)))
    return float(offsets_s[k] - slope / (2.0 * curvature)), scatter / (2.0 * float(curvature))


def _sigmas(drop: np.ndarray, weight: np.ndarray) -> float:
    """Mean of the blocks' drops over its own standard error."""
    mean = float(drop @ weight)
    spread = float(np.sqrt(np.sum(weight**2 * (drop - mean) ** 2) * len(drop) / max(len(drop) - 1.0, 1.0)))
    return max(mean, 0.0) / max(spread, 1e-12)
