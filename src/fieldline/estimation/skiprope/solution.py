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
        if count < 1:
            raise InputError(f"count must be 1 or more; got {count!r}.")
        if not self.detected:
            empty = np.empty((0, count))
            return PlaneCrossings(seconds=empty, std_s=empty, towards=empty.astype(bool))
        rows = slice(-1, None) if row is None else slice(row, row + 1 or None) if isinstance(row, int) else row
        angle = plane_rad - self.yaw_rad[rows]
        s, c = np.sin(angle), np.cos(angle)
        z, w = self.phasor[rows], TURN * self.frequency_hz[rows, None]
        across, along = z[:, 0] * s - z[:, 1] * c, z[:, 0] * c + z[:, 1] * s
        ahead = (0.5 * np.pi - np.angle(across)) % np.pi
        phase = ahead[:, None] + np.pi * np.arange(count)
        wait = phase / w
        weight = np.stack([np.cos(phase) * s[:, None], -np.sin(phase) * s[:, None]], axis=-1)
        weight = np.concatenate([weight, np.stack([-np.cos(phase) * c[:, None], np.sin(phase) * c[:, None]], axis=-1)], axis=-1)
        variance = np.einsum("mki,mij,mkj->mk", weight, self.covariance[rows], weight)
        there = np.real(along[:, None] * np.exp(1j * phase))
        variance += (there * self.yaw_std_rad[rows, None]) ** 2
        speed = np.abs(across)[:, None] * w
        std = np.hypot(np.sqrt(variance) / speed, wait * (self.frequency_std_hz / self.frequency_hz)[rows, None])
        found = (self.seconds[rows, None] + wait, std, there > 0.0)
        if row is None or isinstance(row, int):
            found = tuple(x[0] for x in found)
        return PlaneCrossings(seconds=found[0], std_s=found[1], towards=found[2])


def circular(phasor) -> np.ndarray:
    """(m, 2) complex: c+ and c- of (1)."""
    z1, z2 = phasor[:, 0], phasor[:, 1]
    return np.stack([0.5 * (z1 + 1j * z2), 0.5 * (z1 - 1j * z2)], axis=1)


def derived(phasor, covariance, sense, yaw_rad, yaw_std_rad, tether_length_m: float) -> dict[str, np.ndarray]:
    """All that follows from phasors (m, 2) and their covariance by (1) and (2): the fields of `SkipropeEstimate`, by name."""
    parts = circular(phasor)
    size = np.abs(parts)
    main = np.where(sense == 0, size.argmax(axis=1), (sense < 0).astype(int))
    k = np.arange(len(phasor))
    amplitude, sign = size[k, main], np.where(main == 0, 1.0, -1.0)
    # rows of the Jacobian of Re c+, Im c+, Re c-, Im c- by Re z1, Im z1, Re z2, Im z2
    by_parts = 0.5 * np.array([[1, 0, 0, -1], [0, 1, 1, 0], [1, 0, 0, 1], [0, 1, -1, 0]], dtype=float)
    unit = np.exp(1j * np.angle(parts))
    radial = np.zeros((len(phasor), 2, 4))
    for j in range(2):
        radial[:, j] = unit[:, j, None].real * by_parts[2 * j] + unit[:, j, None].imag * by_parts[2 * j + 1]
    tangential = np.where(main[:, None] == 0, unit[:, :1].real, unit[:, 1:].real) * by_parts[1 + 2 * main]
    tangential -= np.where(main[:, None] == 0, unit[:, :1].imag, unit[:, 1:].imag) * by_parts[2 * main]
    other = 1 - main
    length = tether_length_m / np.pi
    a1, a2 = phasor[:, 0].real, phasor[:, 1].real
    radius = np.maximum(np.hypot(a1, a2), 1e-300)
    tilt = covariance[:, ::2, ::2]
    across = np.stack([-a2, a1], axis=1) / radius[:, None] ** 2
    plane_variance = np.einsum("mi,mij,mj->m", across, tilt, across) + yaw_std_rad**2
    s, c = np.sin(yaw_rad), np.cos(yaw_rad)
    by_tilt = np.stack([np.stack([-s, -c], axis=-1), np.stack([c, -s], axis=-1)], axis=-2)  # of (2) turned by the yaw
    middle = np.einsum("mij,mj->mi", by_tilt, np.stack([a1, a2], axis=1))
    turned = np.stack([-middle[:, 1], middle[:, 0]], axis=1)
    position_covariance = by_tilt @ tilt @ by_tilt.transpose(0, 2, 1)
    position_covariance += (yaw_std_rad**2)[:, None, None] * turned[:, :, None] * turned[:, None, :]

    def deviation(row):
        return np.sqrt(np.einsum("mi,mij,mj->m", row, covariance, row))

    amplitude_std = deviation(radial[k, main])
    return {
        "amplitude_rad": amplitude,
        "amplitude_std_rad": amplitude_std,
        "major_rad": size.sum(axis=1),
        "major_std_rad": deviation(radial.sum(axis=1)),
        "minor_rad": np.abs(size[:, 0] - size[:, 1]),
        "minor_std_rad": deviation(radial[k, main] - radial[k, other]),
        "phase_rad": sign * np.angle(parts[k, main]),
        "phase_std_rad": deviation(tangential) / np.maximum(amplitude, 1e-300),
        "plane_rad": wrapped(np.arctan2(a2, a1) + yaw_rad),
        "plane_std_rad": np.sqrt(plane_variance),
        "deflection_m": length * amplitude,
        "deflection_std_m": length * amplitude_std,
        "position_m": length * middle,
        "position_covariance_m2": length**2 * position_covariance,
    }


def wrapped(angle) -> np.ndarray:
    """[rad] within +-pi."""
    return (np.asarray(angle) + np.pi) % TURN - np.pi
