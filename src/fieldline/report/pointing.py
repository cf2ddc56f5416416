"""Where a body was to point, and how far it was from there: by the target that its law was given.

    theta    rotation vector from the goal to the body, body axes: q_bi = q_goal * exp(theta / 2)            (1)

For a law that tracks a line alone (target_i): the angles of the body's x axis from it, about body y and z.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fieldline.report.geometry import orbital_axes_i, to_body
from fieldline.report.run_record import RunRecord

ARCSEC_BELOW_DEG = 0.02


@dataclass(frozen=True)
class Pointing:
    """What was aimed at, in words, and the error over time."""

    words: str
    error_deg: np.ndarray  # (n, 3) about body x, y, z
    labels: tuple[str, ...]

    @property
    def size_deg(self) -> np.ndarray:
        """(n,) whole angle."""
        return np.linalg.norm(self.error_deg, axis=1)


def pointing_of(record: RunRecord, b: int) -> Pointing | None:
    """The error against the target of the first law of body b that has one."""
    for task in record.scenario.software:
        if record.scenario.index_of(task.body) == b and not task.is_users and task.role == "controller":
            found = _by_law(record, b, task.law, task.parameters)
            if found is not None:
                return found
    return None


def _by_law(record: RunRecord, b: int, law: str, given: dict) -> Pointing | None:
    """The target of a law of the library."""
    from fieldline.simulate.scenario.outside import known_laws

    known = known_laws()[law].parameters
    if "target_i" in known and "target_i" in given:
        return _line_error(record, b, np.asarray(given["target_i"], dtype=float))
    if "target" not in known:
        return None
    values = {key: given.get(key, known[key].default) for key in ("target", "attitude") if key in known}
    return _attitude_error(
        record, b, str(values["target"]), np.asarray(values.get("attitude", (0.0, 0.0, 0.0, 1.0)), dtype=float)
    )


def _attitude_error(record: RunRecord, b: int, target: str, attitude: np.ndarray) -> Pointing:
    """Equation (1)."""
    from scipy.spatial.transform import Rotation

    goal = Rotation.from_quat(attitude)
    if target == "nadir":
        dcm_io = np.swapaxes(orbital_axes_i(record.of("position_i", b), record.of("velocity_i", b)), -1, -2)
        goal = Rotation.from_matrix(dcm_io) * goal
    theta = (goal.inv() * Rotation.from_quat(record.of("q_bi", b))).as_rotvec()
    words = "the orbital axes" if target == "nadir" else "inertial axes"
    turned = "" if np.allclose(np.abs(attitude), (0, 0, 0, 1), atol=1e-9) else ", turned as the law was told"
    return Pointing(f"{words}{turned}", np.degrees(theta), ("about x", "about y", "about z"))


def _line_error(record: RunRecord, b: int, target_i: np.ndarray) -> Pointing:
    """Angles of body x from a line: about y, positive where the line lies at -z of it, and about z."""
    line_b = to_body(record.of("q_bi", b), np.broadcast_to(target_i / np.linalg.norm(target_i), (len(record.seconds), 3)))
    across = np.linalg.norm(line_b[:, 1:], axis=1)
    size = np.degrees(np.arctan2(across, line_b[:, 0]))
    unit = line_b[:, 1:] / np.maximum(across, 1e-300)[:, None]
    error = np.stack([np.zeros(len(size)), size * unit[:, 1], -size * unit[:, 0]], axis=1)
    return Pointing("the line that the law tracks (body x)", error, ("", "about y", "about z"))
