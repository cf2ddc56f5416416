"""A skiprope taken out by a current along its tether: a model of the first half wave, and the current against its motion.

    q'' + w^2 q = (4 / pi) (I / mu) p,   p = up x B along (U, V)                                         (1)
    I = -k (p . q') / |p|^2,   within +-I_max                                                           (2)

q: the middle along (U, V) [m], mu: mass per length [kg/m], I: current up the tether [A]. (2) takes energy out at every instant.
The field pushes along p alone: of the two swings that make a skiprope the one along p goes, the other waits until the
field has turned. The model is stepped exactly under a current that is held.

Valid for a uniform, tight line much heavier ends than itself; one half wave, no gravity across.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np


@dataclass
class HalfWave:
    """The modelled half wave: time [s], rate w [rad/s], place [m] and speed [m/s] of the middle along (U, V)."""

    seconds: float
    rate_rad_s: float
    place_m: np.ndarray
    speed_m_s: np.ndarray

    def carried(self, seconds: float, push) -> None:
        """On to a time [s] under a constant push [m/s^2] (2,): equation (1)."""
        w, step = self.rate_rad_s, seconds - self.seconds
        c, s, rest = cos(w * step), sin(w * step), np.asarray(push) / w**2
        away = self.place_m - rest
        self.place_m, self.speed_m_s = rest + c * away + s / w * self.speed_m_s, -w * s * away + c * self.speed_m_s
        self.seconds = seconds

    @property
    def amplitude_m(self) -> float:
        """[m] RMS of the two swings' amplitudes: the radius of a round skiprope."""
        return float(np.sqrt(0.5 * (self.place_m @ self.place_m + self.speed_m_s @ self.speed_m_s / self.rate_rad_s**2)))


def push_per_ampere(position_i, velocity_i, field_i, mass_per_length_kg_m: float) -> np.ndarray:
    """[m/s^2/A] (2,) along (U, V): (4 / pi mu) up x B, of position [m], velocity [m/s] and field [T], axes i."""
    up = position_i / np.linalg.norm(position_i)
    normal = np.cross(position_i, velocity_i)
    normal = normal / np.linalg.norm(normal)
    ahead = np.cross(normal, up)
    return 4.0 / np.pi / mass_per_length_kg_m * np.array([-(field_i @ normal), field_i @ ahead])


def damping_current(wave: HalfWave, push, gain_s: float, most_a: float) -> float:
    """[A] equation (2): gain_s [1/s] is the rate at which the swing along the push would die without a limit."""
    along = float(push @ wave.speed_m_s)
    square = float(push @ push)
    return 0.0 if square == 0.0 else float(np.clip(-2.0 * gain_s * along / square, -most_a, most_a))


def half_wave_of(seconds, place_m, rate_rad_s: float) -> HalfWave:
    """At the last of times (n,) [s], by a sine through places (n, 2) [m] of the middle over its last turn."""
    times, places = np.asarray(seconds, dtype=float), np.asarray(place_m, dtype=float)
    last = times > times[-1] - 2.0 * np.pi / rate_rad_s
    phase = rate_rad_s * (times[last] - times[-1])
    place, quarter = np.linalg.lstsq(np.stack([np.cos(phase), np.sin(phase)], axis=-1), places[last], rcond=None)[0]
    return HalfWave(float(times[-1]), rate_rad_s, place, rate_rad_s * quarter)
