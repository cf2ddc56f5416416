"""Where the skiprope of a line can be: from its length, better with its masses, and at which rate it goes round the Earth.

Gravity and the orbit stretch a line of length L and mass per length mu under an end mass m; half a wave of it goes at

    T = 3 n^2 L (m + mu L / 2),    f = sqrt(T / mu) / 2 L = (n / 2) sqrt(3 (m / (mu L) + 1 / 2))                    (1)

in the orbit's plane, with n^2 more in the square of the rate across it (5.1 mHz of 2.4 km, 1.9 mHz of 20 km of 8.35 g/m under
520 kg). The line's librations, at sqrt(3) n in the plane and 2 n across, and the orbit itself are below any (1) that is
searched: 0.2 to 0.4 mHz, where the slow part takes them up.

m is the lighter of the ends, or m1 m2 / (m1 + m2) of two that are alike. Valid while the line hangs still and little curved.
"""

from __future__ import annotations

import numpy as np

from fieldline.estimation.skiprope.rotary import BAND_HZ

SHORTEST_RATIO_M = 3e4  # m / mu of a light end on a heavy line
LOWEST_HZ = 0.0012  # slower lines are taken for the field's own errors
ROOM = (0.75, 1.4)  # about (1) of known masses: masses that are not quite known, a curved line, the difference of the planes


def line_frequency(length_m, mean_motion_rad_s: float, ratio_m: float | None) -> np.ndarray:
    """[Hz] (1) of lengths [m] (any shape) with ratio_m = m / mu [m]; None: sqrt(1 / L) alone, for changes of length."""
    length = np.asarray(length_m, dtype=float)
    if ratio_m is None:
        return 1.0 / np.sqrt(length)
    return 0.5 * mean_motion_rad_s * np.sqrt(3.0 * (ratio_m / length + 0.5))


def line_band(length_m: float, mean_motion_rad_s: float, ratio_m: float | None = None) -> tuple[float, float]:
    """[Hz] low and high, between which the skiprope of a line is searched.

    Without masses the usual band, begun as low as (1) of a light end on a heavy line may be; with them (1) and some room.
    """
    if ratio_m is None:
        lowest = float(line_frequency(length_m, mean_motion_rad_s, SHORTEST_RATIO_M))
        return min(max(ROOM[0] * lowest, LOWEST_HZ), BAND_HZ[0]), BAND_HZ[1]
    there = float(line_frequency(length_m, mean_motion_rad_s, ratio_m))
    low = max(ROOM[0] * there, LOWEST_HZ)
    return low, max(ROOM[1] * there, 1.5 * low)
