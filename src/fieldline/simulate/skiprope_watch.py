"""The skiprope as flight software knows it: readings gathered as they come, estimated by harmonic least squares when asked.

Only what a `Measurement` holds is used: the satellite's magnetometer, orbit and on-board field of the body on which the
software runs, and the length of the line there. Where the magnetometer is on the other end (telemetry that is relayed), the
field is that of the own place: over 20 km it is off by 1 % and 0.2 deg, slowly, which the estimator takes up.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.control.skiprope_current import HalfWave, half_wave_of
from fieldline.control.skiprope_yaw import SkipropeNow
from fieldline.errors import NoEstimateError
from fieldline.estimation.skiprope.estimate import estimate_skiprope
from fieldline.estimation.skiprope.line_band import line_band
from fieldline.estimation.skiprope.signals import ORBITAL_FROM_CONE, skiprope_signals
from fieldline.frames.orbital import dcm_oi
from fieldline.sensing.measurement import FIELD, ORBIT, Measurement

MEMORY_S = 4000.0


class Heard(NamedTuple):
    """What an estimate says at its last row: for a yaw, and as a half wave."""

    now: SkipropeNow
    wave: HalfWave


class SkipropeWatch:
    """Rows of time [s], measured field (3) and known field (3) [T] in axes (U, V, W), at most MEMORY_S of them."""

    def __init__(self, *, tether: str, swing_hz: float):
        self.half_turned = tether == "up"  # the tether's middle stands half a turn from the lean of a satellite above it
        self.swing_hz = swing_hz
        self.rows: list[tuple] = []
        self.found_hz: float | None = None  # by the first trusted estimate: what is left of a skiprope is looked for there

    def clear(self) -> None:
        """Forget: what was heard is of another motion."""
        self.rows = []

    def hear(self, sensed: Measurement, own: Measurement) -> None:
        """Take in a new reading of the satellite's magnetometer, with the orbit and field of the own body."""
        at = float(sensed.field_time_s[0])
        fresh = not self.rows or at > self.rows[-1][0]
        if not (sensed.valid[FIELD] > 0.5 and own.valid[ORBIT] > 0.5 and np.isfinite(own.field_i).all() and fresh):
            return
        known = dcm_oi(own.position_i, own.velocity_i) @ own.field_i @ ORBITAL_FROM_CONE
        self.rows.append((at, *(sensed.field_b @ ORBITAL_FROM_CONE), *known))
        if at - self.rows[0][0] > MEMORY_S:
            del self.rows[0]

    def estimate(self, own: Measurement, length_m: float) -> Heard | None:
        """The skiprope now; None where none is found, or its last row may not be trusted."""
        if len(self.rows) < 60:
            return None
        table = np.array(self.rows)
        motion = np.linalg.norm(np.cross(own.position_i, own.velocity_i)) / float(own.position_i @ own.position_i)
        try:
            found = estimate_skiprope(
                skiprope_signals(table[:, 0], table[:, 1:4], table[:, 4:7]),
                tether_length_m=length_m,
                frequency_hz=self.found_hz,
                band_hz=line_band(length_m, float(motion)),
                memory_s=0.3 * MEMORY_S,
            )
        except NoEstimateError:
            return None
        if not found.detected or not found.trusted[-1]:
            return None
        hz = self.found_hz = float(found.frequency_hz[-1])
        less = 1.0 - (hz / self.swing_hz) ** 2 if self.swing_hz > 2.0 * hz else 1.0
        sign = -1.0 if self.half_turned else 1.0
        now = SkipropeNow(
            float(found.seconds[-1]), less * float(found.deflection_m[-1]), less * float(found.deflection_std_m[-1]),
            float(found.plane_rad[-1]) + (np.pi if self.half_turned else 0.0), float(found.plane_std_rad[-1]), hz,
            float(found.frequency_std_hz[-1]), int(found.sense[-1]),
        )  # fmt: skip
        return Heard(now, half_wave_of(found.seconds, sign * less * found.position_m, 2.0 * np.pi * hz))
