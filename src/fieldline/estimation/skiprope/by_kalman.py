"""The Kalman filter (`kalman_step`) over a record, and what its numbers are set to.

It answers at each row from what came before: what a crew would have had. Its first frequency is the spectrum's; its first
phasors are zero, give or take.

Settings, chosen on other flights than those that are scored (docs/skiprope-accuracy.md):

    slow angles     accelerations of 5e-6 rad/s^2 over the root of a hertz: 0.2 deg in 100 s, 5 deg in 1,000 s
    cone            3e-6 rad over the root of a second: 0.01 deg in an hour
    frequency       1e-7 rad/s over the root of a second: 0.1 mHz in an hour; more for a tether that is reeled

A second motion is carried along, the strongest; where one close to the cone is left out, no row is trusted.

Where the mean normalised square innovation is above `LOST` the filter no longer follows: those rows are not trusted, and a
note says so. Covariances grow by that mean where it is above one. Where samples are so far apart that their differences tell of
the motion instead of the noise, the record is heard twice: the first time shows how large the noise is.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fieldline.estimation.skiprope.kalman_step import (
    ALL_MISSED,
    COUNT,
    MEAN_NIS,
    PARAMETERS,
    SIZE,
    kalman_rows,
    kalman_run,
)
from fieldline.estimation.skiprope.signals import SkipropeSignals, field_vector
from fieldline.estimation.skiprope.track import Track

TURN = 2.0 * np.pi
LOST = 4.0  # mean NIS over two periods
SETTLED = 0.25  # deviation of the cone's phasors over the cone, from which it is trusted
SAMPLES_PER_PERIOD = 24
KEPT = 0.99  # of the differences
DENSE_RAD = 0.5  # of the fastest motion, a sample: beyond it fourth differences hold the motion
TOO_QUIET, LEAST_NIS = 0.5, 1e-3  # mean NIS that shows so, and the least it is believed
MANY = 0.05  # of the samples, passed over: worth a note


@dataclass(frozen=True, kw_only=True)
class KalmanSettings:
    """What the filter takes for usual; SI units, `_s12` and `_s32`: over the root of a second, and of its third power."""

    noise_tesla: float = 1e-7  # of a reading, until its samples tell
    direction_rad: float = 2e-4  # white, of the known field
    slow_rad_s32: float = 5e-6
    slow_rate_rad_s: float = 1e-3
    cone_rad_s12: float = 3e-6
    frequency_rad_s32: float = 1e-7
    swing_rad_s12: float = 3e-5
    swing_frequency_rad_s32: float = 1e-6
    tilt_std_rad: float = 0.05
    yaw_std_rad: float = 0.1
    rate_std_rad_s: float = 1e-4
    cone_std_rad: float = 0.03
    frequency_share: float = 0.02  # of the first frequency, one deviation
    swing_std_rad: float = 0.05
    swing_frequency_share: float = 0.01

    def packed(self, frequency_hz: float, swing_hz: float | None) -> np.ndarray:
        """The kernel's parameters; without a second motion its states stay zero."""
        w, swing = TURN * frequency_hz, TURN * (swing_hz or 0.0)
        values = {name: getattr(self, name) for name in PARAMETERS if hasattr(self, name)}
        values |= {"frequency_std_rad_s": self.frequency_share * w, "frequency_rad_s": w, "swing_frequency_rad_s": swing}
        values["swing_frequency_std_rad_s"] = self.swing_frequency_share * swing
        if not swing_hz:
            values |= {"swing_rad_s12": 0.0, "swing_frequency_rad_s32": 0.0, "swing_std_rad": 0.0}
        return np.array([values[name] for name in PARAMETERS])


REELED = KalmanSettings(frequency_rad_s32=3e-5, cone_rad_s12=3e-5)  # a tether on the reel: 0.15 mHz and 0.05 deg in 1,000 s


def reading_noise(signals: SkipropeSignals, otherwise: float) -> float:
    """[T] white noise of a reading by fourth differences of even samples, the largest left out; `otherwise` of few samples."""
    steps = np.diff(signals.seconds)
    even = np.abs(steps - signals.step_s) < 0.05 * signals.step_s
    even = even[3:] & even[2:-1] & even[1:-2] & even[:-3]
    if even.sum() < 50:
        return otherwise
    size = np.sort(np.abs(np.diff(signals.field_b, n=4, axis=0)[even]).reshape(-1))
    return max(float(np.sqrt(np.mean(size[: int(KEPT * len(size))] ** 2) / 70.0)), 1e-10)


def _heard(thin: SkipropeSignals, params: np.ndarray, rows) -> tuple[np.ndarray, np.ndarray]:
    """The filter's memory after all samples, and (m, SIZE) at the rows."""
    memory, memories = np.zeros(SIZE), np.zeros((len(rows), SIZE))
    at = np.maximum(rows, thin.seconds[0])  # a row before the first mean of samples is of the guess that they are met with
    kalman_run(thin.seconds, thin.field_b, field_vector(thin.geometry), memory, params, at, memories)
    return memory, memories


def kalman_track(signals: SkipropeSignals, rows, settings) -> Track:
    """Phasors at times `rows` (m,) [s]; see `estimate.Settings`."""
    fastest = max((settings.frequency_hz, *settings.pendulous_hz))
    thin = signals.thinned(1.0 / (SAMPLES_PER_PERIOD * fastest))
    swing = settings.pendulous_hz[0] if settings.pendulous_hz else None
    usual = REELED if settings.reeled else KalmanSettings()
    noise = reading_noise(thin, usual.noise_tesla)
    memory, memories = _heard(thin, replace(usual, noise_tesla=noise).packed(settings.frequency_hz, swing), rows)
    if TURN * fastest * thin.step_s > DENSE_RAD and memory[MEAN_NIS] < TOO_QUIET:  # taken for noise: the motions themselves
        noise *= np.sqrt(max(memory[MEAN_NIS], LEAST_NIS))
        memory, memories = _heard(thin, replace(usual, noise_tesla=noise).packed(settings.frequency_hz, swing), rows)
    parts, covariance, numbers = np.empty((len(rows), 4)), np.empty((len(rows), 4, 4)), np.empty((len(rows), 6))
    kalman_rows(memories, SETTLED, LOST, parts, covariance, numbers)
    sense, good, frequency, deviation, off, nis = numbers.T
    late = np.flatnonzero(good == 0.0)
    settled = rows[late[-1] + 1] if len(late) and late[-1] + 1 < len(rows) else rows[0] if not len(late) else np.inf
    notes = []
    if settings.crowded_hz:
        settled = np.inf
        close = ", ".join(f"{1e3 * hz:.4g}" for hz in settings.crowded_hz)
        notes.append(
            f"the Kalman filter carries one motion besides the skiprope and leaves out what moves at {close} mHz, close to it: "
            "none of its rows is trusted; use the harmonic method."
        )
    if not good[-1] and nis[-1] < LOST:
        notes.append(
            "the Kalman filter has not settled by the end of the record: none of its rows is trusted; give it a longer record, "
            "or use the harmonic method."
        )
    elif not good[-1]:
        notes.append(
            f"the Kalman filter does not follow at the end of the record (mean square innovation {nis[-1]:.3g}, 1 is "
            "consistent): none of its rows is trusted; use the harmonic method, or another first frequency."
        )
    if memory[ALL_MISSED] > MANY * memory[COUNT]:
        notes.append(f"{memory[ALL_MISSED]:.0f} samples were passed over as too far off.")
    phasor = np.stack([parts[:, 0] + 1j * parts[:, 1], parts[:, 2] + 1j * parts[:, 3]], axis=1)
    return Track(phasor, covariance, frequency, deviation, sense.astype(int), off, True, float(settled), tuple(notes))
