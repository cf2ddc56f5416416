"""Attitude and rate on board from a magnetometer, an orbit and the commanded dipole: nothing is known at the start.

1. Bias from the magnitudes of all readings, while the satellite tumbles: `bias`.
2. Once the body turns slowly and a window of readings is full, the search without a prior: `search`. It fails, or finds
   two motions that are as likely: it is tried again when there is more to read.
3. From then on the Kalman filter, one step a reading: `tracker`. Its motion is the rigid body's, with the gravity
   gradient, the commanded dipole, the residual dipole that the search found, and a constant torque; its slow error takes up
   what is left of the bias. It says an attitude while its own spread is small, and starts again from nothing when the
   readings no longer fit.
4. Every orbit dipole, torque and rate noise are found anew from the readings since the last time: `revision`.

Valid for a rigid body of known inertia in low orbit whose magnetometer reads with the torquers off, or is cleared of them.
"""

from __future__ import annotations

import numpy as np

from fieldline.estimation.motion import RateModel
from fieldline.estimation.onboard.bias import MagnitudeBias
from fieldline.estimation.onboard.readings import Readings
from fieldline.estimation.onboard.revision import revise
from fieldline.estimation.onboard.search import Found, search
from fieldline.estimation.onboard.tracker import Tracker
from fieldline.sensing.measurement import FIELD, ORBIT

LONGEST = 1.2  # of the time between two revisions, that one of them reads
LONGEST_GAP_S = 600.0  # without readings, after which nothing is known any more


class OnboardEstimator:
    """Flight software: (t, measurement, memory, params) -> q_bi and omega_bi_b (7,), or None while it knows nothing.

    inertia_kg_m2 (3, 3); window_s of the search, step_s between its rows, retry_s until it is tried again; revise_s between two
    revisions of dipole and torque, about an orbit;
    rate_max_deg_s: no search while the field turns faster in body axes; std_max_deg: no attitude is told that is less
    certain; bias_std_tesla of the magnetometer; duty_cycle: share of the time in which a commanded dipole is in force;
    rate_noise_rad_s_sqrt_s: least random walk of the rate, for torques that the motion lacks.

    events: (t [s], words) of what it found and lost.
    """

    def __init__(
        self, inertia_kg_m2, *, window_s: float = 2400.0, step_s: float = 10.0, retry_s: float = 300.0, revise_s: float = 5400.0,
        rate_max_deg_s: float = 1.0, std_max_deg: float = 10.0, bias_std_tesla: float = 1e-6, duty_cycle: float = 1.0,
        rate_noise_rad_s_sqrt_s: float = 1e-6,
    ):  # fmt: skip
        """Nothing known."""
        self._inertia = np.asarray(inertia_kg_m2, dtype=float)
        self._window, self._retry, self._revise = window_s, retry_s, revise_s
        self._rate_max, self._std_max = np.radians(rate_max_deg_s), np.radians(std_max_deg)
        self._duty, self._rate_noise = duty_cycle, rate_noise_rad_s_sqrt_s
        self._bias = MagnitudeBias(bias_std_tesla)
        self._readings = Readings(max(window_s, LONGEST * revise_s), step_s)
        self._tracker: Tracker | None = None
        self._bias_b = np.zeros(3)
        self._torques: np.ndarray | None = None
        self._next = 0.0
        self._read = self._revised = -np.inf
        self.events: list[tuple[float, str]] = []

    def __call__(self, t: float, measurement, memory=None, params=None) -> np.ndarray | None:
        """One call; see the class. memory and params are a law's, and not needed."""
        if measurement.valid[FIELD] > 0.5 and measurement.valid[ORBIT] > 0.5 and measurement.field_time_s[0] > self._read:
            self._take(measurement)
        tracker = self._tracker
        if tracker is None or not self._certain(t, tracker):
            return None
        return tracker.at(t, measurement.field_i, measurement.position_i, self._duty * measurement.dipole_b)

    @property
    def attitude_std_rad(self) -> float:
        """The filter's own spread, infinite while nothing is known."""
        return np.inf if self._tracker is None else self._tracker.attitude_std_rad

    @property
    def bias_b(self) -> np.ndarray:
        """(3,) [T] the magnetometer's bias as it is taken off the readings now."""
        return self._bias_b.copy()

    def _take(self, measurement) -> None:
        """One reading into everything that wants it."""
        t = self._read = float(measurement.field_time_s[0])
        moment = self._duty * measurement.dipole_b
        row = (measurement.field_i, measurement.position_i, moment)
        self._bias.add(measurement.field_b, measurement.field_i)
        self._readings.add(t, measurement.field_b, *row)
        if self._tracker is None:
            self._search(t)
        elif t - self._tracker.t > LONGEST_GAP_S:
            self._lose(t, "no readings for too long")
        else:
            self._tracker.step(t, measurement.field_b - self._bias_b, *row)
            if not self._tracker.sound:
                self._lose(t, f"innovations are {np.sqrt(self._tracker.nis):.1f} sigma")
            elif t >= self._next and self._readings.kept_at == t:
                self._revision(t, self._tracker)

    def _search(self, t: float) -> None:
        """The first attitude, where there is enough to look at."""
        if t < self._next or self._readings.span_s < 0.95 * self._window or self._readings.change_rad_s() > self._rate_max:
            return
        self._next = t + self._retry
        self._bias_b, covariance = self._bias.estimate()
        series = self._readings.series(self._bias_b, self._window)
        found = search(series, self._inertia, float(np.sqrt(np.diag(covariance).max())))
        if not isinstance(found, Found):
            self.events.append((t, found))
            return
        self._tracker = Tracker(found._replace(model=self._model(found.model)), float(series.seconds[-1]))
        self.events.append((t, f"found: {found.words}"))

    def _revision(self, t: float, tracker: Tracker) -> None:
        """Dipole and noise from the last windows."""
        self._next = t + self._revise
        bias_b, _ = self._bias.estimate()
        series = self._readings.series(bias_b, t - self._revised)
        revision = revise(series, tracker, self._torques)
        if revision is not None:
            self._bias_b, self._torques, self._revised = bias_b, revision.covariance, t
            tracker.model = self._model(revision.model)
            self.events.append((t, f"revised: {revision.words}"))

    def _model(self, found: RateModel) -> RateModel:
        """With the least noise that the rate may have."""
        return found._replace(noise=max(found.noise, self._rate_noise))

    def _lose(self, t: float, why: str) -> None:
        """Back to knowing nothing; the readings are kept."""
        self._torques, self._revised = None, -np.inf
        self._tracker, self._next = None, t + self._retry
        self.events.append((t, f"lost: {why}"))

    def _certain(self, t: float, tracker: Tracker) -> bool:
        return tracker.attitude_std_rad < self._std_max and t - tracker.t < LONGEST_GAP_S
