"""The motion of TP-3123 along any orbit, under any field, as the telemetry that it would have sent down, truth beside it.

Body axes are Fieldline's: x along the velocity, y against the orbit's normal, z down, so x = S1, y = -S2, z = -S3 of the
paper; the angles are the paper's (a1, a2, a3 of `flight`). The ellipse of the skiprope may stand any way:

    a1 = Re(z1 e^{i w t}),   a2 = Re(z2 e^{i w t}),   z1 = A1 e^{i p},   z2 = -i A2 e^{i p}                       (1)

with w > 0 from V towards -U, as the cosine and sine of the paper where the phase p is zero.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fieldline.cases.tp3123.flight import DEG, RANGE_TESLA, dcm_321, read_digits
from fieldline.estimation.skiprope.signals import ORBITAL_FROM_CONE

if TYPE_CHECKING:
    from fieldline.orbit import Orbit
    from fieldline.telemetry import Telemetry


class FlightRecord(NamedTuple):
    """What was sent down, and what was true at each of its n samples."""

    telemetry: Telemetry
    angles_rad: np.ndarray  # (n, 3) a1, a2, a3
    skiprope_rad: np.ndarray  # (n, 2) their parts of the skiprope: a1, a2
    tilt_rad: np.ndarray  # (n,) of the body's axis by skiprope and yaw
    azimuth_rad: np.ndarray  # (n,) of that tilt, from V towards -U


def record_along(
    time_utc,
    orbit: Orbit,
    *,
    skiprope_frequency_hz: float = 0.005,
    skiprope_deg=(0.75, 0.5),
    skiprope_phase_deg: float = 0.0,
    growth_per_s: float = 0.0,
    pendulous_frequency_hz: float = 0.03125,
    pendulous_deg=(2.0, 2.0),
    bias_deg=(1.0, 1.0, 5.0),
    model="IGRF-14",
    bits: int = 16,
    noise_tesla: float = 20e-9,
    seed: int = 0,
    name: str = "skiprope",
) -> FlightRecord:
    """The flight at (n,) UTC times along an orbit.

    Parameters
    ----------
    skiprope_frequency_hz : its sign is the sense; 0 for none. skiprope_deg, pendulous_deg : amplitudes in (a1, a2).
    skiprope_phase_deg : p of (1) at the first sample. growth_per_s : both amplitudes grow as exp(growth t).
    bias_deg : of (a1, a2, a3). model : the true field, by name or as a FieldModel. bits : 0 for a reading without digits.
    noise_tesla : white, an axis, one standard deviation, before the digits; `seed` draws it.
    """
    from fieldline.estimation.reference import reference_along_orbit
    from fieldline.frames.orbital import dcm_oi
    from fieldline.telemetry import telemetry_of

    reference = reference_along_orbit(time_utc, orbit, model)
    seconds = (reference.time_utc - reference.time_utc[0]).astype(np.int64) * 1e-9
    phase = 2.0 * np.pi * skiprope_frequency_hz * seconds + DEG * skiprope_phase_deg
    size = np.exp(growth_per_s * seconds) * (skiprope_frequency_hz != 0.0)
    skiprope = size[:, None] * DEG * np.asarray(skiprope_deg) * np.stack([np.cos(phase), np.sin(phase)], axis=-1)  # (1)
    swing = np.sin(2.0 * np.pi * pendulous_frequency_hz * seconds + DEG * 45.0)
    angles = np.tile(DEG * np.asarray(bias_deg, dtype=float), (len(seconds), 1))
    angles[:, :2] += skiprope + DEG * np.asarray(pendulous_deg) * swing[:, None]
    field_o = np.einsum("nij,nj->ni", dcm_oi(reference.position_i, reference.velocity_i), reference.field_i)
    field_b = np.einsum("nij,nj->ni", dcm_321(angles), field_o @ ORBITAL_FROM_CONE)
    field_b += noise_tesla * np.random.default_rng(seed).standard_normal(field_b.shape)
    measured = read_digits(field_b, bits, RANGE_TESLA) @ ORBITAL_FROM_CONE
    u, v, _ = dcm_321(np.column_stack([skiprope, angles[:, 2]]))[:, 2].T
    telemetry = telemetry_of(reference.time_utc, measured, name=name)
    return FlightRecord(telemetry, angles, skiprope, np.hypot(u, v), np.arctan2(-u, v))
