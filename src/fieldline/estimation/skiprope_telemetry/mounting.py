"""How the magnetometer and its satellite stand: from the sensor's axes to the axes (U, V, W) of the cone.

    v_c = M (R1(roll) R2(pitch) R3(yaw))^T S v_s                                                                (1)

S turns sensor axes into body axes; roll, pitch and yaw are the body's usual attitude against the orbital axes (x along the
velocity, y against the orbit's normal, z down), 3-2-1; M = diag(1, -1, -1) turns those into U along the velocity, V along the
normal, W up. What is left between (1) and (U, V, W) are the small angles that the estimators look for. A measured yaw takes
the place of the usual one, sample by sample.

    W up                     tether "down": it hangs from the satellite, whose axis W leans away from the tether's
    |                        middle, so the middle stands half a turn from the lean; "up": towards it.
    |____ V  normal
   /
  U  velocity
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fieldline.errors import InputError, shown
from fieldline.estimation.skiprope.signals import ORBITAL_FROM_CONE

TETHERS = ("down", "up")
STEEPEST_RAD = np.radians(80.0)


@dataclass(frozen=True, kw_only=True)
class Mounting:
    """Sensor axes in the body, the body's usual attitude, and the way the tether leaves it.

    sensor_axes : which sensor axes lie along body x, y, z, as "x,-y,-z" (the paper's), or a matrix (3, 3) with
        v_b = S v_s.      attitude_deg : roll, pitch, yaw against the orbital axes.      tether : "down" or "up".
    """

    sensor_axes: object = "x,y,z"
    attitude_deg: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tether: str = "down"

    def __post_init__(self):
        _matrix(self.sensor_axes)
        angles = np.asarray(self.attitude_deg, dtype=float)
        if angles.shape != (3,) or not np.isfinite(angles).all() or (np.abs(angles) > 360.0).any():
            raise InputError(f"attitude_deg must be roll, pitch, yaw [deg]; got {self.attitude_deg!r}.")
        if (np.abs(np.radians(angles[:2])) > STEEPEST_RAD).any():
            raise InputError(
                f"attitude_deg {self.attitude_deg!r}: roll and pitch beyond 80 deg are no satellite that hangs on a tether; "
                "turn the axes with sensor_axes instead."
            )
        if self.tether not in TETHERS:
            raise InputError(f'tether must be "down" or "up", the way it leaves the satellite; got {self.tether!r}.')

    def field_c(self, field_s: np.ndarray, yaw_rad: np.ndarray | None = None) -> np.ndarray:
        """(n, 3), axes (U, V, W): equation (1) of readings (n, 3), with the yaw (n,) [rad] where it is measured."""
        roll, pitch, yaw = np.radians(self.attitude_deg)
        field_b = np.asarray(field_s, dtype=float) @ _matrix(self.sensor_axes).T
        tilted = field_b @ (_about(0, roll) @ _about(1, pitch))  # v^T A is (A^T v)^T
        angle = np.broadcast_to(yaw if yaw_rad is None else np.asarray(yaw_rad, dtype=float), len(field_b))
        c, s = np.cos(angle), np.sin(angle)
        field_o = np.stack([c * tilted[:, 0] - s * tilted[:, 1], s * tilted[:, 0] + c * tilted[:, 1], tilted[:, 2]], axis=-1)
        return field_o @ ORBITAL_FROM_CONE

    @property
    def half_turn_rad(self) -> float:
        """From the azimuth of the axis's lean to that of the tether's middle."""
        return np.pi if self.tether == "down" else 0.0

    def described(self) -> dict:
        """For the record, plain types."""
        axes = self.sensor_axes if isinstance(self.sensor_axes, str) else np.asarray(self.sensor_axes, dtype=float).tolist()
        return {"sensor_axes": axes, "attitude_deg": [float(one) for one in self.attitude_deg], "tether": self.tether}


def _about(axis: int, angle: float) -> np.ndarray:
    """(3, 3): components in axes turned by an angle [rad] about one of their own."""
    c, s = np.cos(angle), np.sin(angle)
    j, k = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[j, j] = turn[k, k] = c
    turn[j, k], turn[k, j] = s, -s
    return turn


def _matrix(axes) -> np.ndarray:
    """(3, 3) with v_b = S v_s, of "x,-y,-z", of nine numbers, or of a matrix; a proper turn or an InputError."""
    if isinstance(axes, str):
        matrix = _from_words(axes)
    else:
        try:
            matrix = np.asarray(axes, dtype=float)
        except (TypeError, ValueError):
            matrix = np.empty(0)
    if matrix.shape != (3, 3) or not np.isfinite(matrix).all():
        raise InputError(f'sensor_axes must be "x,-y,-z" or the like, or a matrix (3, 3); got {shown(str(axes))}.')
    if np.abs(matrix @ matrix.T - np.eye(3)).max() > 1e-3:
        raise InputError(f"sensor_axes {shown(str(axes))}: its rows are not of length one and at right angles, so it is no turn.")
    if np.linalg.det(matrix) < 0.0:
        raise InputError(
            f"sensor_axes {shown(str(axes))} is left-handed: a mirror, no turn. Change the sign of one axis, or swap two."
        )
    return matrix


def _from_words(text: str) -> np.ndarray:
    """The matrix of signed letters or of nine numbers with commas between."""
    parts = [part.strip().lower() for part in text.split(",")]
    if len(parts) == 3 and all(part.lstrip("+-") in ("x", "y", "z") and len(part) <= 2 for part in parts):
        matrix = np.zeros((3, 3))
        for row, part in enumerate(parts):
            matrix[row, "xyz".index(part[-1])] = -1.0 if part[0] == "-" else 1.0
        return matrix
    try:
        return np.array([float(part) for part in parts]).reshape(3, 3)
    except ValueError as error:
        raise InputError(
            f'sensor_axes "{shown(text)}" must name the sensor axes along body x, y and z, as "x,-y,-z", or be the nine '
            "numbers of a matrix, row by row."
        ) from error
