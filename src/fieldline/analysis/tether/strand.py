"""What a line is made of along its length: segments, where their mass sits, and how a length is cut into them.

Every line runs from one end (index 0: A, or the lower end of a hanging line) to the other. Segment j joins the points j and
j + 1; half of its mass sits at either of them,

    m_i = (mu l0)_(i-1) / 2 + (mu l0)_i / 2                                                                  (1)

A segment that spans several materials has their mean mass and, as springs in series, their mean compliance,

    mu = integral mu ds / l0,    1 / EA = integral ds / EA / l0                                              (2)
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError


class Strand(NamedTuple):
    """Segments of a line from end to end, one row each."""

    rest: np.ndarray  # (s,) [m], unstretched length
    stiffness: np.ndarray  # (s,) [N], E A: tension per strain
    linear_mass: np.ndarray  # (s,) [kg/m], per unstretched length


class Stretches(NamedTuple):
    """Materials of a line from end to end, one row each."""

    length: np.ndarray  # (k,) [m], unstretched
    linear_mass: np.ndarray  # (k,) [kg/m]
    stiffness: np.ndarray  # (k,) [N]


def positive(name: str, value, units: str, *, zero: bool = False) -> float:
    """A finite number above zero (or zero, where that may be), or `InputError` that names it."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = np.nan
    if isinstance(value, bool) or not np.isfinite(number) or number < 0.0 or (number == 0.0 and not zero):
        least = "zero or more" if zero else "above zero"
        raise InputError(f"{name} must be a finite number {least} [{units}]; got {value!r}.")
    return number


def stretches_of(length_m, mass_per_length_kg_m, axial_stiffness_n, *, massless: bool) -> Stretches:
    """Checked materials of a line: three numbers, or sequences of one size, from the lower end to the upper.

    `massless` : a mass per length of zero is let through.
    """
    given = {
        "length_m": (length_m, "m", False),
        "mass_per_length_kg_m": (mass_per_length_kg_m, "kg/m", massless),
        "axial_stiffness_n": (axial_stiffness_n, "N", False),
    }
    columns = {}
    for name, (values, units, zero) in given.items():
        listed = isinstance(values, Sequence | np.ndarray) and not isinstance(values, str) and np.ndim(values) > 0
        rows = list(values) if listed else [values]
        columns[name] = np.array([positive(name, one, units, zero=zero) for one in rows])
    sizes = {len(column) for column in columns.values()} - {1}
    if len(sizes) > 1 or 0 in sizes:
        told = ", ".join(f"{name} {len(column)}" for name, column in columns.items())
        raise InputError(
            f"length_m, mass_per_length_kg_m and axial_stiffness_n must have one value, or one a material; got {told}."
        )
    if len(columns["length_m"]) < max(sizes, default=1):
        raise InputError("length_m must have one length a material: several masses per length or stiffnesses were given.")
    length, linear_mass, stiffness = np.broadcast_arrays(*columns.values())
    return Stretches(length, linear_mass, stiffness)


def cut(stretches: Stretches, nodes: int) -> Strand:
    """nodes + 1 segments of equal unstretched length; equation (2) where materials meet inside one."""
    ends = np.concatenate([[0.0], np.cumsum(stretches.length)])
    cuts = np.linspace(0.0, ends[-1], nodes + 2)
    mass = np.concatenate([[0.0], np.cumsum(stretches.length * stretches.linear_mass)])
    compliance = np.concatenate([[0.0], np.cumsum(stretches.length / stretches.stiffness)])
    rest = np.diff(cuts)
    return Strand(rest, rest / np.diff(np.interp(cuts, ends, compliance)), np.diff(np.interp(cuts, ends, mass)) / rest)


def point_masses(strand: Strand, first_kg: float = 0.0, last_kg: float = 0.0) -> np.ndarray:
    """(s + 1,) [kg] masses of the points (1), with bodies of first_kg and last_kg at the ends."""
    half = 0.5 * strand.rest * strand.linear_mass
    mass = np.concatenate([half, [0.0]]) + np.concatenate([[0.0], half])
    mass[0] += first_kg
    mass[-1] += last_kg
    return mass
