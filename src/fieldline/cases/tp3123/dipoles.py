"""The Earth's field of the TP-3123 program: six dipoles at their own places inside the Earth.

The program's axes are X to 90 deg east, Y along the north pole, Z to Greenwich; ours (ITRS) are x = Z, y = X, z = Y:

          Y = z                   B = sum of (3 (m . u) u - m) / |r - p|^3,   r, p in km, m in T km^3
          |
          |________ X = y         1 T km^3 = 1e9 T m^3 = 1e16 A m^2
         /   90 E
        / Z = x, Greenwich

Its harmonics of degrees 1 to 4 are nearest the reference field of 1980, to 20 to 40 nT RMS a degree; the sum is some
330 nT RMS per component from it at 300 km (1,206 nT at most). Digits of the printed constants beyond the second or third
cannot be checked by that.

Source: the listing in the appendix of Polites (1991), NASA TP-3123, subroutine BFIELD: numbers alone.
"""

from __future__ import annotations

import numpy as np

from fieldline.environment.field_record import FieldModel
from fieldline.environment.field_registry import field_model

KM = 1e3
TESLA_KM3 = 1e16  # [A m^2]
TO_EARTH_AXES = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # v_e = TO_EARTH_AXES @ v_paper

POSITION_KM = np.array(  # (6, 3), the paper's axes
    [
        [500.805, 146.800, 718.994],
        [-292.9318, -818.6409, 583.55],
        [455.075, -902.802, 791.483],
        [414.636, 1540.2948, -65.878],
        [-1611.292, 1095.094, -282.390],
        [14.958, 1243.2935, -849.084],
    ]
)
MOMENT_TESLA_KM3 = 1e6 * np.array(  # (6, 3), the paper's axes
    [
        [1.423489, -18.247848, 2.104301],
        [4.558039, 3.575713, -3.079872],
        [-7.045997, 3.744393, -4.175109],
        [-0.555610, -0.696502, 6.801960],
        [0.154356, -0.593411, -0.856652],
        [2.920314, 4.470056, -1.303223],
    ]
)


def six_dipoles() -> FieldModel:
    """The model, in our axes and units, for `magnetic_field` and everything that takes a field model."""
    position_e = KM * POSITION_KM @ TO_EARTH_AXES.T
    moment_e = TESLA_KM3 * MOMENT_TESLA_KM3 @ TO_EARTH_AXES.T
    return field_model("displaced-dipoles", position_e=position_e, moment_e=moment_e)
