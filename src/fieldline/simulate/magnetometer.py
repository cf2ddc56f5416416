"""A three-axis magnetometer with the faults of a real one.

    raw = q round( (D^-1 field_b + bias + noise) / q )      D: the matrix that a calibration would apply     (1)

Noise is white; q is the quantum of the digits (zero: none). Beyond the range the reading stays at its end.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fieldline.errors import InputError


@dataclass(frozen=True, slots=True, kw_only=True)
class Magnetometer:
    """Bias (3,) [T], matrix D (3, 3), white noise [T, 1 sigma], quantum [T], range [T], time-stamp jitter [s, 1 sigma]."""

    bias_s: np.ndarray = field(default_factory=lambda: np.zeros(3))
    matrix: np.ndarray = field(default_factory=lambda: np.eye(3))
    noise_std_tesla: float = 0.0
    quantum_tesla: float = 0.0
    range_tesla: float = np.inf

    def __post_init__(self):
        if np.shape(self.bias_s) != (3,) or np.shape(self.matrix) != (3, 3):
            raise InputError("Magnetometer needs bias_s (3,) [T] and matrix (3, 3).")
        if min(self.noise_std_tesla, self.quantum_tesla) < 0 or self.range_tesla <= 0:
            raise InputError("Magnetometer noise and quantum must not be negative, and its range must be positive.")

    def reading(self, field_b: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """(n, 3) [T] raw readings of the true field (n, 3) [T]; equation (1)."""
        raw = field_b @ np.linalg.inv(self.matrix).T + np.asarray(self.bias_s)
        raw = raw + self.noise_std_tesla * rng.standard_normal(raw.shape)
        if self.quantum_tesla > 0:
            raw = self.quantum_tesla * np.round(raw / self.quantum_tesla)
        return np.clip(raw, -self.range_tesla, self.range_tesla)
