"""Flights of the paper's kind with everything drawn by chance, to score estimators on, and the scores.

Drawn for a seed: sense and frequency (4.2 to 5.8 mHz), both half axes (0.3 to 1.2 deg), pendulous amplitude (1 to 3 deg), yaw
(normal, 5 deg), and the errors of the known field (normal: 3 % of its magnitude, 2 deg of elevation, 2 deg of azimuth) on top
of what the two field models differ by. 20 nT of noise on each axis, 16 bits, biases of 1 deg in pitch and roll.

The plane is scored against the true azimuth of the third body axis by skiprope and yaw alone, half a turn on: the mean of its
error is yaw and azimuth error of the known field, which a magnetometer cannot tell apart.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.cases.tp3123.flight import DEG, Flight, field_along_orbit, fly, true_cone
from fieldline.environment.field_record import FieldModel
from fieldline.estimation.skiprope.signals import FieldGeometry, SkipropeSignals, field_vector, skiprope_signals
from fieldline.estimation.skiprope.solution import SkipropeEstimate

TETHER_M = 20e3
SETTLED_S = 800.0
FIELD_ERRORS = (0.03, 2.0, 2.0)  # share, deg, deg


class Scenario(NamedTuple):
    """One flight: the truth, and what an estimator gets."""

    flight: Flight
    signals: SkipropeSignals
    frequency_hz: float  # signed as the sense
    axes_deg: tuple[float, float]  # of (a1, a2)
    yaw_rad: float


class Score(NamedTuple):
    """Errors of an estimate from `SETTLED_S` on."""

    plane_mean_deg: float
    plane_sd_deg: float
    plane_rms_deg: float
    amplitude_percent: float  # of the mean radius
    radius_rms_percent: float
    frequency_percent: float
    sense_right: bool
    plane_over_stated: float  # RMS of the plane's errors over their stated deviations


def random_scenario(
    seed: int,
    *,
    skiprope: bool = True,
    duration_s: float = 6000.0,
    rate_hz: float = 1.0,
    field: str | FieldModel = "IGRF-14",
    assumed_field: str | FieldModel = "displaced-dipoles",
    field_errors=FIELD_ERRORS,
    noise_tesla: float = 2e-8,
    bits: int = 16,
    pendulous_frequency_hz: float = 0.03125,
) -> Scenario:
    """The flight of a seed; without its skiprope, to count false alarms, for skiprope=False."""
    rng = np.random.default_rng(seed)
    frequency = float(rng.choice([-1, 1]) * rng.uniform(0.0042, 0.0058))
    axes = tuple(float(x) for x in rng.uniform(0.3, 1.2, 2))
    scale, elevation, azimuth = rng.normal(size=3) * field_errors
    swing, yaw = float(rng.uniform(1.0, 3.0)), float(5.0 * rng.normal())
    flight = fly(
        duration_s=duration_s,
        rate_hz=rate_hz,
        skiprope_frequency_hz=frequency,
        skiprope_deg=axes if skiprope else (0.0, 0.0),
        pendulous_frequency_hz=pendulous_frequency_hz,
        pendulous_deg=(swing, swing),
        bias_deg=(1.0, 1.0, yaw),
        field=field,
        noise_tesla=noise_tesla,
        bits=bits,
        seed=seed,
    )
    known = field_along_orbit(flight.seconds, assumed_field)
    known = FieldGeometry(
        (1.0 + scale) * known.magnitude_tesla, known.elevation_rad + DEG * elevation, known.azimuth_rad + DEG * azimuth
    )
    signals = skiprope_signals(flight.seconds, flight.measured_b, field_vector(known))
    return Scenario(flight, signals, frequency, (axes[0], axes[1]), DEG * yaw)


def score(scenario: Scenario, estimate: SkipropeEstimate, *, from_s: float = SETTLED_S, to_s: float = np.inf) -> Score:
    """Errors of an estimate with `TETHER_M` of tether, over its rows between two times [s]."""
    rows = (estimate.seconds >= from_s) & (estimate.seconds <= to_s)
    times = estimate.seconds[rows]
    tilt, azimuth = true_cone(scenario.flight)
    true_plane = np.interp(times, scenario.flight.seconds, np.unwrap(azimuth)) + np.pi
    off = np.angle(np.exp(1j * (estimate.plane_rad[rows] - true_plane)))
    radius = np.hypot(*estimate.position_m[rows].T) * np.pi / estimate.tether_length_m
    true_radius = np.interp(times, scenario.flight.seconds, tilt)
    return Score(
        plane_mean_deg=float(np.degrees(off.mean())),
        plane_sd_deg=float(np.degrees(off.std())),
        plane_rms_deg=float(np.degrees(np.sqrt(np.mean(off**2)))),
        amplitude_percent=float(100.0 * (radius.mean() / true_radius.mean() - 1.0)),
        radius_rms_percent=float(100.0 * np.sqrt(np.mean((radius / true_radius - 1.0) ** 2))),
        frequency_percent=float(100.0 * (estimate.frequency_hz[rows][-1] / abs(scenario.frequency_hz) - 1.0)),
        sense_right=bool(np.sign(estimate.sense[rows].sum()) == np.sign(scenario.frequency_hz)),
        plane_over_stated=float(np.sqrt(np.mean((off / estimate.plane_std_rad[rows]) ** 2))),
    )
