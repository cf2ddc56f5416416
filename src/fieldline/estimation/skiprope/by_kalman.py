"""The Kalman filter (`kalman_step`) over a record, and what its numbers are set to.

It answers at each row from what came before: what a crew would have had. Its first frequency is the spectrum's; its first
phasors are zero, give or take.

Settings, chosen on other flights than those that are scored (docs/skiprope-accuracy.md):

    slow angles     accelerations of 5e-6 rad/s^2 over the root of a hertz: 0.2 deg in 100 s, 5 deg in 1,000 s
    cone            3e-6 rad over the root of a second: 0.01 deg in an hour
    frequency       1e-7 rad/s over the root of a second: 0.1 mHz in an hour; more for a tether that is reeled

Where the mean normalised square innovation is above `LOST` the filter no longer follows: those rows are not trusted, and a
note says so. Covariances grow by that mean where it is above one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fieldline.estimation.skiprope.kalman_step import (
    ALL_MISSED,
    CONE,
    CONE_W,
    COUNT,
    PARAMETERS,
    SIZE,
    STATES,
    kalman_run,
    predicted,
)
from fieldline.estimation.skiprope.signals import SkipropeSignals, field_vector
from fieldline.estimation.skiprope.solution import circular
from fieldline.estimation.skiprope.track import Track

TURN = 2.0 * np.pi
LOST = 4.0  # mean NIS over two periods
SETTLED = 0.25  # deviation of the cone's phasors over the cone, from which it is trusted
SURE_SENSE = 2.0
SAMPLES_PER_PERIOD = 24
YAW_MEMORY_S = 2000.0  # over which the azimuth's offset is averaged


@dataclass(frozen=True, kw_only=True)
class KalmanSettings:
    """What the filter takes for usual; SI units, `_s12` and `_s32`: over the root of a second, and of its third power."""

    noise_tesla: float = 2e-8  # of a reading
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


def kalman_track(signals: SkipropeSignals, rows, settings, usual: KalmanSettings = KalmanSettings()) -> Track:
    """Phasors at times `rows` (m,) [s]; see `estimate.Settings`."""
    fastest = max((settings.frequency_hz, *settings.pendulous_hz))
    thin = signals.thinned(1.0 / (SAMPLES_PER_PERIOD * fastest))
    swing = settings.pendulous_hz[0] if settings.pendulous_hz else None
    params = usual.packed(settings.frequency_hz, swing)
    memory = np.zeros(SIZE)
    states, spreads = np.empty((len(rows), STATES)), np.empty((len(rows), STATES, STATES))
    nis = np.empty(len(rows))
    known = field_vector(thin.geometry)
    kalman_run(thin.seconds, thin.field_b, known, memory, params, rows, states, spreads, nis)
    at_rows = np.stack([np.interp(rows, thin.seconds, column) for column in known.T], axis=1)
    return track_of(states, spreads, nis, rows, memory, at_rows)


def azimuth_off(states, known, rows) -> np.ndarray:
    """(m,) azimuth of the known field (m, 3) less that of the field as the slow angles turn it, averaged over the past.

    A turn about the field, which nothing shows at an instant, drops out of it; the third slow angle alone would not do.
    """
    slow = np.zeros_like(states)
    slow[:, :3] = states[:, :3]
    turned = np.array([predicted(x, b) for x, b in zip(slow, known, strict=True)])[:, 0]
    off = np.arctan2(-known[:, 0], known[:, 1]) - np.arctan2(-turned[:, 0], turned[:, 1])
    off = (off + np.pi) % TURN - np.pi
    mean, weight, before = 0.0, 0.0, rows[0]
    answer = np.empty(len(rows))
    for k, (t, value) in enumerate(zip(rows, off, strict=True)):
        kept = np.exp(-(t - before) / YAW_MEMORY_S)
        if np.isfinite(value):
            mean, weight = kept * mean + value, kept * weight + 1.0
        answer[k], before = mean / max(weight, 1.0), t
    return answer


def track_of(states, spreads, nis, rows, memory, known) -> Track:
    """A track from states (m, 16) and their covariances, with the known field (m, 3) at the same times."""
    grown = np.maximum(nis, 1.0)[:, None, None] * spreads
    cone = states[:, CONE : CONE + 4]
    phasor = np.stack([cone[:, 0] + 1j * cone[:, 1], cone[:, 2] + 1j * cone[:, 3]], axis=1)
    covariance = grown[:, CONE : CONE + 4, CONE : CONE + 4]
    backward = states[:, CONE_W] < 0.0  # the same motion, written with a negative frequency
    phasor = np.where(backward[:, None], phasor.conj(), phasor)
    parts = np.abs(circular(phasor))
    spread = np.sqrt(np.trace(covariance, axis1=1, axis2=2) / 4.0)
    sense = np.where(np.abs(parts[:, 0] - parts[:, 1]) > SURE_SENSE * spread, np.sign(parts[:, 0] - parts[:, 1]), 0.0)
    good = (spread < SETTLED * parts.max(axis=1)) & (nis < LOST)
    late = np.flatnonzero(~good)
    settled = rows[min(late[-1] + 1, len(rows) - 1)] if len(late) else rows[0]
    settled = settled if good[-1] else np.inf
    notes = []
    if not good[-1]:
        notes.append(
            f"the Kalman filter does not follow at the end of the record (mean square innovation {nis[-1]:.3g}, 1 is "
            "consistent): none of its rows is trusted; use the harmonic method, or another first frequency."
        )
    if memory[ALL_MISSED] > 0.05 * memory[COUNT]:
        notes.append(f"{memory[ALL_MISSED]:.0f} samples were passed over as too far off.")
    return Track(
        phasor,
        covariance,
        np.abs(states[:, CONE_W]) / TURN,
        np.sqrt(grown[:, CONE_W, CONE_W]) / TURN,
        sense.astype(int),
        azimuth_off(states, known, rows),
        True,
        float(settled),
        tuple(notes),
    )
