"""The magnetometer's bias from the magnitude alone, reading by reading, while nothing is known of the attitude.

    |m|^2 - |B|^2 = 2 m . b - |b|^2 + noise                                                     (1)

is linear in b and in s = |b|^2 taken as a number of its own. Ten sums hold all readings, so a tumble of hours costs no
memory. A prior on b keeps it near zero along directions that the body has not yet shown to the field.

Source: Alonso and Shuster (2002), Complete linear attitude-independent magnetometer calibration, J. Astronaut. Sci. 50:477.
"""

from __future__ import annotations

import numpy as np

SCALE = 3e-5  # T, of the field in low orbit: keeps the sums near one
FEWEST = 30


class MagnitudeBias:
    """Sums over (1); `estimate` gives the bias [T], body axes, and its covariance [T^2]."""

    def __init__(self, prior_std_tesla: float):
        """prior_std_tesla: how large a bias may be, 1 sigma per axis."""
        self._prior = np.diag([(SCALE / prior_std_tesla) ** 2] * 3 + [1e-6])
        self._normal = np.zeros((4, 4))
        self._right = np.zeros(4)
        self._square = 0.0
        self._count = 0

    def add(self, field_b: np.ndarray, field_i: np.ndarray) -> None:
        """One reading [T] and the reference field [T]."""
        m, reference = field_b / SCALE, field_i / SCALE
        row = np.array([2.0 * m[0], 2.0 * m[1], 2.0 * m[2], -1.0])
        y = float(m @ m - reference @ reference)
        self._normal += np.outer(row, row)
        self._right += y * row
        self._square += y * y
        self._count += 1

    def estimate(self) -> tuple[np.ndarray, np.ndarray]:
        """(3,) bias and (3, 3) covariance; zero and the prior before FEWEST readings."""
        if self._count < FEWEST:
            return np.zeros(3), np.linalg.inv(self._prior[:3, :3]) * SCALE**2
        x = np.linalg.solve(self._normal + 1e-9 * self._prior, self._right)
        left = self._square - 2.0 * x @ self._right + x @ self._normal @ x
        variance = max(left / self._count, 1e-12)
        precision = self._normal / variance + self._prior
        x = np.linalg.solve(precision, self._right / variance)
        return x[:3] * SCALE, np.linalg.inv(precision)[:3, :3] * SCALE**2
