"""What a method hands on: phasors in time, not yet turned to (U, V)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Track(NamedTuple):
    """Phasors of (a1, a2) over m times and all that goes with them; see `solution`."""

    phasor: np.ndarray  # (m, 2) complex
    covariance: np.ndarray  # (m, 4, 4)
    frequency_hz: np.ndarray  # (m,)
    frequency_std_hz: np.ndarray
    sense: np.ndarray  # (m,)
    azimuth_off_rad: np.ndarray  # (m,) of the known field against the measured one
    along_body: bool  # phasors are along the body's axes; else they take the known azimuth for true
    trusted_from_s: float
    notes: tuple[str, ...]
