"""The Kalman filter of `estimation.kalman` fed one reading at a time, with an eye on itself.

    nis+ = nis + (min(NIS, 25) / 3 - nis) / MEMORY

follows the mean of the normalised innovations, 1 where the filter is as good as it says.
"""

from __future__ import annotations

import numpy as np

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.estimation.consistency import GATE
from fieldline.estimation.kalman import filter_forward
from fieldline.estimation.motion import propagate
from fieldline.estimation.onboard.search import Found
from fieldline.estimation.series import Series
from fieldline.estimation.smoothing import NO_PATH, NOTHING

MEMORY = 60.0  # readings
LARGEST_NIS = 4.0


class Tracker:
    """Attitude, rate, slow error of the readings and their covariance, from a first attitude on."""

    def __init__(self, found: Found, t: float):
        """`found` holds at t [s]."""
        self._state, self._covariance = found.state.copy(), found.covariance.copy()
        self._offset = np.zeros((1, 9))
        self.noise, self.model = found.noise, found.model
        self._white = np.zeros((1, 3))
        self.t = t
        self.nis = 1.0

    def step(self, t: float, field_b, field_i, position_i, moment_b) -> None:
        """Move on to t and take in a reading [T]; moment_b [A m^2] has been in force since the last one."""
        series = _row(t, field_b, field_i, position_i, moment_b)
        total = filter_forward(
            series, False, self.t, self._state, self._offset, self._covariance, self.noise, self.model, NO_PATH, *NOTHING[:3],
            self._white,
        )  # fmt: skip
        self.t = t
        square = float((self._white**2).sum()) if np.isfinite(total) else GATE
        self.nis += (min(square, GATE) / 3.0 - self.nis) / MEMORY

    def at(self, t: float, field_i, position_i, moment_b) -> np.ndarray:
        """(7,) attitude and rate at t, a moment after the last reading."""
        q, w = tuple(self._state[0, :4]), tuple(self._state[0, 4:7])
        if t > self.t:
            pull = tuple(_pull(position_i))
            q, w, _, _, _ = propagate(q, w, tuple(moment_b), tuple(field_i), pull, t - self.t, self.model)
        return np.array([*q, *w])

    @property
    def state(self) -> np.ndarray:
        """(7,) attitude and rate at the last reading."""
        return self._state[0, :7].copy()

    @property
    def attitude_std_rad(self) -> float:
        """Root of the sum of the three variances of the attitude [rad]."""
        return float(np.sqrt(max(self._covariance[0, [0, 4, 8]].sum(), 0.0)))

    @property
    def sound(self) -> bool:
        """Whether the filter still explains what it reads."""
        return bool(self.nis < LARGEST_NIS and np.isfinite(self._state).all() and np.isfinite(self._covariance).all())


def _pull(position_i) -> np.ndarray:
    """Equation (1) of `estimation.series` for one position [m]."""
    distance = np.linalg.norm(position_i)
    return np.sqrt(3.0 * EARTH_GM_M3_S2 / distance**5) * position_i


def _row(t: float, field_b, field_i, position_i, moment_b) -> Series:
    """One reading as a series."""
    rows = (np.array(column, dtype=float).reshape(1, 3) for column in (field_b, field_i, _pull(position_i), moment_b))
    field_b, field_i, pull_i, moment_b = rows
    return Series(np.array([t]), field_b, field_i, pull_i, np.ones(1, bool), np.zeros((1, 3)), moment_b)
