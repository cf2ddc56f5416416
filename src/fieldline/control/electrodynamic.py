"""What currents do: the map from a vehicle's currents and thrust to force and moment, and the linear plant it makes.

    (force, moment) = E(B) u,   u = (currents [A], thrust [N])                                      (1)
    dx/dt = F x + G u,   y = H x                                                                    (2)

with F of `mechanics.relative_motion`, G from E at the target's field and no turn: the loads' first-order change with place
and angle multiplies a current and is of second order. A thruster is a column per newton; a pair that fires either way is one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np

from fieldline.errors import InputError
from fieldline.mechanics.lorentz import conductor_map
from fieldline.mechanics.relative_motion import input_matrix, motion_matrix, output_matrix
from fieldline.vehicle.conductor import Conductor, names_of, refuse_parallel, wires_b
from fieldline.vehicle.thruster import Thruster

MOST_FIELD_TESLA = 1e-2  # Jupiter's is 4e-4 T; more is a unit mistaken


class Plant(NamedTuple):
    """Matrices of (2), G with any leading axes, and the names of the controls."""

    F: np.ndarray  # (12, 12)
    G: np.ndarray  # (..., 12, m)
    H: np.ndarray  # (6, 12)
    controls: tuple[str, ...]


class Carrier(Protocol):
    """What carries conductors and thrusters, such as `design.TrackingVehicle`."""

    @property
    def conductors(self) -> Sequence[Conductor]:
        """Conductor records."""
        ...

    @property
    def thrusters(self) -> Sequence[Thruster]:
        """Thruster records."""
        ...


def electrodynamic_map(vehicle: Carrier | Sequence[Conductor | Thruster], field_b) -> np.ndarray:
    """Force [N] and moment [N m] in body axes of each ampere and each newton: E of equation (1).

    Parameters
    ----------
    vehicle : what has `conductors` and `thrusters`, or a list of such records; of a thruster, place and direction count.
    field_b : (..., 3) [T], body axes, uniform over the body.

    Returns
    -------
    (..., 6, m): rows force x, y, z [N/A, 1] and moment x, y, z [N m/A, m]; columns conductors, then thrusters.

    Raises
    ------
    InputError : no conductors and no thrusters, a field of another shape, not finite, or not in tesla.
    """
    conductors, thrusters = carried(vehicle)
    field_b = _field(field_b)
    currents = conductor_map(*wires_b(conductors), field_b)
    if not thrusters:
        return currents
    direction = np.array([one.direction_b for one in thrusters])
    moment = np.cross(np.array([one.position_b_m for one in thrusters]), direction)
    columns = np.concatenate([direction, moment], axis=1).T
    return np.concatenate([currents, np.broadcast_to(columns, (*field_b.shape[:-1], *columns.shape))], axis=-1)


def electrodynamic_plant(
    vehicle: Carrier | Sequence[Conductor | Thruster],
    field_h,
    *,
    mean_motion_rad_s: float,
    radius_m: float,
    mass_kg: float,
    inertia_kg_m2,
) -> Plant:
    """The linear plant (2) of a vehicle beside a target, in the target's field field_h (..., 3) [T], axes h.

    Raises
    ------
    InputError : as `electrodynamic_map`; conductors that are all parallel, with no thruster, and the direction they cannot push.
    """
    conductors, thrusters = carried(vehicle)
    if not thrusters:
        refuse_parallel(conductors)
    names = names_of(conductors) + [one.name or f"thruster_{k}" for k, one in enumerate(thrusters, start=1)]
    G = input_matrix(mass_kg, inertia_kg_m2, electrodynamic_map(vehicle, field_h))
    return Plant(motion_matrix(mean_motion_rad_s, radius_m, inertia_kg_m2), G, output_matrix(), tuple(names))


def carried(vehicle: Carrier | Sequence[Conductor | Thruster]) -> tuple[list[Conductor], list[Thruster]]:
    """Conductors and thrusters of a vehicle or of a list; InputError where there are none, or where one is neither."""
    if isinstance(vehicle, Sequence):
        strange = [type(one).__name__ for one in vehicle if not isinstance(one, Conductor | Thruster)]
        if strange:
            raise InputError(f"a vehicle's list holds Conductor and Thruster records; got {strange[0]}.")
        conductors = [one for one in vehicle if isinstance(one, Conductor)]
        thrusters = [one for one in vehicle if isinstance(one, Thruster)]
    elif hasattr(vehicle, "conductors") and hasattr(vehicle, "thrusters"):
        conductors, thrusters = list(vehicle.conductors), list(vehicle.thrusters)
    else:
        kind = type(vehicle).__name__
        raise InputError(f"a vehicle has conductors and thrusters, or is a list of such records; got {kind}.")
    if not conductors and not thrusters:
        raise InputError("a vehicle that is to be pushed needs a conductor or a thruster; got neither.")
    return conductors, thrusters


def _field(field_b) -> np.ndarray:
    """(..., 3) [T], or a refusal."""
    field = np.asarray(field_b, dtype=float)
    if field.ndim == 0 or field.shape[-1] != 3 or not np.isfinite(field).all():
        raise InputError(f"field_b must be finite and end in an axis of length 3, (..., 3) [T]; got shape {field.shape}.")
    if np.abs(field).max(initial=0.0) > MOST_FIELD_TESLA:
        raise InputError(
            f"field_b reaches {np.abs(field).max():.3g} T; in low orbit it is 1e-5 to 6e-5 T. Is it in nT? Multiply by 1e-9."
        )
    return field
