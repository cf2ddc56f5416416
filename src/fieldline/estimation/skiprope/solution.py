"""What any estimator of the skiprope answers: the cone as an ellipse in time, and where that puts the tether.

Phasors z1, z2 of (a1, a2), along body axes that are turned by the yaw a3 against (U, V), hold a cone at a frequency f > 0:

    a1 = Re z1,   a2 = Re z2 now,   both turning on with exp(2 pi i f dt)
    c+ = (z1 + i z2) / 2,   c- = (z1 - i z2) / 2                                                                (1)

The larger of |c+| and |c-| tells the sense (c+: from V towards -U), is the tilt's amplitude as of a round cone, and its angle
the phase: a1 = a cos(phase), a2 = a sin(phase) for the round part. The ellipse has half axes ||c+| +- |c-||. The tether
stands half a turn from the tilt,

    middle = L / pi (-a2, a1) along the body's first two axes,   plane = atan2(a2, a1) + a3                     (2)

with the plane's azimuth counted from V towards -U as the field's. The covariance (4, 4) of (Re z1, Im z1, Re z2, Im z2) is
carried into each number to first order; the plane's deviation has the yaw's in it. Crossings of a vertical plane of azimuth P
are where the part of (2) across that plane, a1 sin(P - a3) - a2 cos(P - a3), is zero: a harmonic again, twice a period.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fieldline.errors import InputError
from fieldline.estimation.skiprope.rotary import Detection

TURN = 2.0 * np.pi


@dataclass(frozen=True, kw_only=True)
class PlaneCrossings:
    """Times [s] at which the tether lies in a vertical plane, (..., count), their standard deviations, and which side.

    towards: True where the tether's middle then is on the side of the plane's azimuth, False on the other.
    """

    seconds: np.ndarray
    std_s: np.ndarray
    towards: np.ndarray


@dataclass(frozen=True, kw_only=True)
class SkipropeEstimate:
    """The cone and the tether over m times; all arrays are empty where nothing was detected.

    Angles in rad, counted from V (the orbit's normal) towards -U (against the flight); `_std_` is one standard deviation.
    """

    method: str
    tether_length_m: float
    detected: bool
    detection: Detection
    trusted_from_s: float  # NaN: never
    verdict: str
    notes: tuple[str, ...]
    seconds: np.ndarray  # (m,)
    trusted: np.ndarray  # (m,) bool
    phasor: np.ndarray  # (m, 2) complex, of (a1, a2)
    covariance: np.ndarray  # (m, 4, 4) [rad^2]
    frequency_hz: np.ndarray  # (m,) positive
    frequency_std_hz: np.ndarray
    sense: np.ndarray  # (m,) 1: from V towards -U (C1 leads C2), -1: back, 0: not to be told
    yaw_rad: np.ndarray  # (m,) a3, by which (2) is turned
    yaw_std_rad: np.ndarray
    azimuth_off_rad: np.ndarray  # (m,) yaw plus azimuth error, which a magnetometer sees as one
    amplitude_rad: np.ndarray  # (m,) tilt of the round part
    amplitude_std_rad: np.ndarray
    major_rad: np.ndarray  # (m,)
    major_std_rad: np.ndarray
    minor_rad: np.ndarray  # (m,)
    minor_std_rad: np.ndarray
    phase_rad: np.ndarray  # (m,)
    phase_std_rad: np.ndarray
    plane_rad: np.ndarray  # (m,) azimuth of the tether
    plane_std_rad: np.ndarray
    deflection_m: np.ndarray  # (m,) of the round part, a L / pi
    deflection_std_m: np.ndarray
    position_m: np.ndarray  # (m, 2) the tether's middle along (U, V), seen along the radius
    position_covariance_m2: np.ndarray  # (m, 2, 2)

    def crossings(self, plane_rad: float, count: int = 3, *, row: int | slice | None = None) -> PlaneCrossings:
        """The next `count` times at which the tether lies in the vertical plane of an azimuth, after a row's time.

        row : index into `seconds`, the last by default; a slice gives (rows, count).
        """
        rows = slice(-1, None) if row is None else slice(row, row + 1 or None) if isinstance(row, int) else row
        found = plane_crossings(
            self.seconds[rows],
            self.phasor[rows],
            self.covariance[rows],
            (self.frequency_hz[rows], self.frequency_std_hz[rows]),
            (self.yaw_rad[rows], self.yaw_std_rad[rows]),
            plane_rad,
            count,
        )
        if isinstance(rows, slice) and not isinstance(row, slice) and len(found.seconds):
            return PlaneCrossings(seconds=found.seconds[0], std_s=found.std_s[0], towards=found.towards[0])
        return found


def plane_crossings(seconds, phasor, covariance, frequency, yaw, plane_rad: float, count: int) -> PlaneCrossings:
    """The next `count` crossings of a vertical plane after each of m times: (m, count).

    seconds (m,); phasor (m, 2); covariance (m, 4, 4); frequency [Hz] and yaw [rad]: each with its deviation, (m,) and (m,).
    """
    if count < 1:
        raise InputError(f"count must be 1 or more; got {count!r}.")
    angle = plane_rad - yaw[0]
    s, c = np.sin(angle), np.cos(angle)
    z1, z2 = phasor.T
    across, along = z1 * s - z2 * c, z1 * c + z2 * s
    phase = ((0.5 * np.pi - np.angle(across)) % np.pi)[:, None] + np.pi * np.arange(count)
    wait = phase / (TURN * frequency[0])[:, None]
    turn = np.stack([np.cos(phase), -np.sin(phase)], axis=-1)
    weight = np.concatenate([turn * s[:, None, None], -turn * c[:, None, None]], axis=-1)
    variance = np.einsum("mki,mij,mkj->mk", weight, covariance, weight)
    there = np.real(along[:, None] * np.exp(1j * phase))
    variance = variance + (there * yaw[1][:, None]) ** 2
    speed = np.maximum(np.abs(across), 1e-300)[:, None] * TURN * frequency[0][:, None]
    std = np.hypot(np.sqrt(variance) / speed, wait * (frequency[1] / frequency[0])[:, None])
    return PlaneCrossings(seconds=seconds[:, None] + wait, std_s=std, towards=there > 0.0)


def circular(phasor) -> np.ndarray:
    """(m, 2) complex: c+ and c- of (1)."""
    z1, z2 = phasor[:, 0], phasor[:, 1]
    return np.stack([0.5 * (z1 + 1j * z2), 0.5 * (z1 - 1j * z2)], axis=1)
