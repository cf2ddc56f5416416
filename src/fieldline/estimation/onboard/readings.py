"""The last readings as the estimation's kernels take them, thinned to even steps.

Between two rows that are kept the commanded dipole may have changed many times: a row holds the mean of what was in force
since the row before, moved one row ahead, because a `Series` holds each row's dipole until the next row.
"""

from __future__ import annotations

from collections import deque

import numpy as np

from fieldline.estimation.series import Series, make_series


class Readings:
    """A window of readings: time, field, reference, position, dipole in force since the reading before."""

    def __init__(self, window_s: float, step_s: float):
        """window_s: how far back readings are kept; step_s: between the rows that are kept."""
        self._window, self._step = window_s, step_s
        self._rows: deque[tuple] = deque()
        self._last = -np.inf
        self._moment, self._seconds = np.zeros(3), 0.0

    def add(self, t: float, field_b, field_i, position_i, moment_b) -> None:
        """One reading; moment_b [A m^2] was in force since the one before."""
        if self._rows and t - self._last > 5.0 * self._step:
            self.clear()  # across a gap nobody knows what the torquers did
        elapsed = 0.0 if not self._rows else t - self._last
        self._last = t
        self._moment += elapsed * np.asarray(moment_b)
        self._seconds += elapsed
        if self._rows and t - self._rows[-1][0] < self._step - 1e-6:
            return
        mean = self._moment / self._seconds if self._seconds > 0.0 else np.zeros(3)
        self._rows.append((t, np.array(field_b), np.array(field_i), np.array(position_i), mean))
        self._moment, self._seconds = np.zeros(3), 0.0
        while t - self._rows[0][0] > self._window:
            self._rows.popleft()

    def clear(self) -> None:
        """Forget all."""
        self._rows.clear()
        self._last = -np.inf
        self._moment, self._seconds = np.zeros(3), 0.0

    @property
    def kept_at(self) -> float:
        """Time [s] of the newest row."""
        return self._rows[-1][0] if self._rows else -np.inf

    @property
    def span_s(self) -> float:
        """Time from the first kept row to the last."""
        return self._rows[-1][0] - self._rows[0][0] if self._rows else 0.0

    def change_rad_s(self) -> float:
        """Largest turn of the field in body axes per second between the last rows; infinite with fewer than ten."""
        if len(self._rows) < 10:
            return np.inf
        last = [self._rows[k] for k in range(-10, 0)]
        seconds, field = np.array([row[0] for row in last]), np.array([row[1] for row in last])
        unit = field / np.linalg.norm(field, axis=1, keepdims=True)
        turn = 2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(np.diff(unit, axis=0), axis=1), 0.0, 1.0))
        return float((turn / np.diff(seconds)).max())

    def series(self, bias_b, span_s: float = np.inf) -> Series:
        """The rows of the last `span_s`, less a bias [T]."""
        rows = [row for row in self._rows if row[0] >= self._last - span_s]
        seconds, field_b, field_i, position_i, mean = (np.array(column) for column in zip(*rows, strict=True))
        ahead = np.vstack([mean[1:], mean[-1:]])
        return make_series(seconds, field_b - bias_b, field_i, position_i, np.ones(len(seconds), bool), moment_b=ahead)
