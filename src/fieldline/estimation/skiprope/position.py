"""Where the tether is: deflection at its middle, and its plane at any time.

A line that skipropes as half a sine, y = d sin(pi s / L), leaves its end at an angle y'(0) = pi d / L, which is the tilt of
the satellite that hangs on it:

    d = a L / pi                                                                                                    (1)

From the last maximum before a time t (the nearest, inside the record), at t_k with azimuth AZ_k, the tilt has turned on:

    azimuth(t) = AZ_k + w (t - t_k),    tether's = azimuth(t) + pi                                                   (2)

with a standard deviation that grows by that of w over t - t_k. Azimuths are counted from V towards -U, as the field's.

Source: Polites (1991), NASA TP-3123, equation (1), rule (3) and figure 4. (1) is exact for a uniform, massless-ended line in
its first mode; gravity along a heavy line makes the slope at the ends differ from it by the ratio of the line's tensions.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, NoEstimateError
from fieldline.estimation.skiprope.bandpass import positive
from fieldline.estimation.skiprope.reading import ConeReading

TURN = 2.0 * np.pi


class Angles(NamedTuple):
    """Azimuths [rad], (n,), and their standard deviations."""

    azimuth_rad: np.ndarray
    std_rad: np.ndarray


class InPlane(NamedTuple):
    """Times [s] in a plane, (m,), their standard deviations, and whether the axis is tilted towards (or away), (m,)."""

    seconds: np.ndarray
    std_s: np.ndarray
    towards: np.ndarray


def midpoint_deflection(amplitude_rad, tether_length_m: float):
    """D [m] of (1) from a tilt [rad]; with the tilt's standard deviation, that of d."""
    return np.asarray(amplitude_rad) * positive("tether_length_m", tether_length_m) / np.pi


def tilt_azimuth(reading: ConeReading, seconds) -> Angles:
    """The tilt's azimuth at times (n,) [s] by (2), within +-pi; NoEstimateError where the sense is not known."""
    if reading.sense == 0:
        raise NoEstimateError("which way the cone turns is not known, so its plane cannot be carried to another time.")
    times = np.asarray(seconds, dtype=float)
    nearest = np.abs(times[..., None] - reading.maximum_s).argmin(axis=-1)
    since = times - reading.maximum_s[nearest]
    azimuth = reading.azimuth_rad[nearest] + TURN * reading.frequency_hz * since  # (2)
    std = np.hypot(reading.azimuth_std_rad[nearest], TURN * reading.frequency_std_hz * since)
    return Angles((azimuth + np.pi) % TURN - np.pi, std)


def tether_azimuth(reading: ConeReading, seconds) -> Angles:
    """The tether's azimuth at times (n,) [s], half a turn from the tilt's, within +-pi."""
    tilt = tilt_azimuth(reading, seconds)
    return Angles(tilt.azimuth_rad % TURN - np.pi, tilt.std_rad)


def midpoint_position(reading: ConeReading, seconds, tether_length_m: float) -> np.ndarray:
    """(n, 2) [m]: the tether's middle along (U, V) at times (n,) [s]."""
    azimuth = tether_azimuth(reading, seconds).azimuth_rad
    out = midpoint_deflection(reading.amplitude_rad, tether_length_m)
    return out * np.stack([-np.sin(azimuth), np.cos(azimuth)], axis=-1)


def in_field_plane(reading: ConeReading) -> InPlane:
    """Rule (3) in the record: tilted towards the field at the maxima, away from it half a period later."""
    times = np.concatenate([reading.maximum_s, reading.maximum_s + 0.5 * reading.period_s])
    towards = np.repeat([True, False], len(reading.maximum_s))
    order = np.argsort(times)
    return InPlane(times[order], np.tile(reading.maximum_std_s, 2)[order], towards[order])


def next_in_plane(reading: ConeReading, plane_azimuth_rad: float, after_s: float, count: int = 3) -> InPlane:
    """The next `count` times after `after_s` [s] at which the tilt lies in the vertical plane of an azimuth, either way."""
    if count < 1:
        raise InputError(f"count must be 1 or more; got {count!r}.")
    now = tilt_azimuth(reading, np.array([after_s]))
    rate = TURN * reading.frequency_hz
    ahead = (plane_azimuth_rad - now.azimuth_rad[0]) * np.sign(rate) % np.pi
    times = after_s + (ahead + np.pi * np.arange(count)) / abs(rate)
    then = tilt_azimuth(reading, times)
    last = reading.maximum_s[np.abs(after_s - reading.maximum_s).argmin()]
    std = np.hypot(reading.azimuth_std_rad[-1], TURN * reading.frequency_std_hz * (times - last)) / abs(rate)
    return InPlane(times, std, np.cos(then.azimuth_rad - plane_azimuth_rad) > 0.0)
