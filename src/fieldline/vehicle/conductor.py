"""A straight rigid conductor whose circuit closes through the plasma: force = current x length x field."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pydantic import Field

from fieldline.errors import InputError
from fieldline.records import Record
from fieldline.records.values import Direction, Vector

PARALLEL = 1e-9  # sine of the largest angle between conductors that count as parallel


class Conductor(Record):
    """A straight conductor fixed to the body, with a plasma contactor at each end."""

    name: str = Field(default="", description="name in results; by default conductor_1, conductor_2, ...")
    position_b_m: Vector = Field(description="middle of the conductor from the centre of mass, body axes [m]")
    direction_b: Direction = Field(description="direction of positive current, body axes; made a unit vector")
    length_m: float = Field(gt=0.0, le=1e5, description="length [m]")
    current_max_a: float = Field(default=125.0, gt=0.0, description="largest current, either sign [A]")
    resistance_ohm: float = Field(default=0.0, ge=0.0, description="of the conductor itself [ohm]")


def names_of(conductors: Sequence[Conductor]) -> list[str]:
    """Their names, given or by number."""
    return [one.name or f"conductor_{k}" for k, one in enumerate(conductors, start=1)]


def wires_b(conductors: Sequence[Conductor]) -> tuple[np.ndarray, np.ndarray]:
    """(m, 3) [m] of each conductor from end to end, and (m, 3) [m] of its middle; body axes."""
    wire = np.array([one.length_m * np.array(one.direction_b) for one in conductors]).reshape(-1, 3)
    return wire, np.array([one.position_b_m for one in conductors]).reshape(-1, 3)


def refuse_parallel(conductors: Sequence[Conductor]) -> None:
    """InputError for no conductors, or for ones that all lie along one direction, which then cannot be pushed."""
    if not conductors:
        raise InputError("there are no conductors; give one record at least for each of two directions.")
    directions = np.array([one.direction_b for one in conductors])
    if np.linalg.norm(np.cross(directions, directions[0]), axis=1).max() <= PARALLEL:
        along = ", ".join(f"{part:.3g}" for part in directions[0])
        raise InputError(
            f"all conductors lie along ({along}) in body axes, and a current is pushed across itself only: no force along that "
            "direction at any time, whatever the field. Add conductors in another direction, or a thruster."
        )
