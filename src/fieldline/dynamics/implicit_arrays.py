"""Arrays of the implicit step, made once for a plant; without rows where another method steps it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.dynamics.lines.stiff_system import StiffSystem, new_system
from fieldline.dynamics.lines.turning_axes import Axes, new_axes
from fieldline.dynamics.parameters import Lines, tangent_size
from fieldline.integrate.rosenbrock import ROS34PW2, Rosenbrock


class Implicit(NamedTuple):
    """What `fieldline.dynamics.implicit_step` writes."""

    method: Rosenbrock
    axes: Axes
    system: StiffSystem
    opening: np.ndarray  # (n,) the state at the step's start, in turning axes
    inside: np.ndarray  # (n,) at a stage
    rate: np.ndarray  # (n,) right-hand side of a stage


def new_implicit(plant, used: bool) -> Implicit:
    """Arrays for a plant."""
    n = tangent_size(plant) if used else 0
    bodies = len(plant.bodies.mass) if used else 0
    lines = plant.lines if used else no_lines(plant.lines)
    return Implicit(ROS34PW2, new_axes(bodies, lines), new_system(bodies, lines), np.zeros(n), np.zeros(n), np.zeros(n))


def no_lines(lines: Lines) -> Lines:
    """Lines of the same types without rows."""
    return Lines(*(array[: 1 if name in ("first", "warm") else 0] for name, array in zip(lines._fields, lines, strict=True)))
