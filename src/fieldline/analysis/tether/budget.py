"""Energy and momentum of a line's points, and of bodies at its ends as points.

    kinetic = sum m v^2 / 2,    potential = -sum GM m / r,    elastic = sum EA (l - l0)^2 / (2 l0)  where l > l0     (1)
    momentum = sum m v,         angular momentum = sum m r x v,   about the Earth's centre                           (2)

With point gravity alone the sum of the energies and (2) are kept, but for what the line's damping takes. Bodies that turn have
more: their spin, and that of their attachments about their mass centre.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError

if TYPE_CHECKING:
    import xarray as xr


def line_budget(
    position_i_m, velocity_i_m_s, mass_kg, rest_length_m, stiffness_n, *, gm_m3_s2: float = EARTH_GM_M3_S2
) -> xr.Dataset:
    """Equations (1) and (2) of points (time, point, 3) [m, m/s]; NaN and mass 0 where a point is not out.

    mass_kg : (point,) or (time, point); rest_length_m, stiffness_n : (segment,) or (time, segment), one less than points.

    Returns
    -------
    Dataset over time: kinetic_energy, potential_energy, elastic_energy, energy [J]; momentum_i, angular_momentum_i (time,
    axis) [kg m/s, kg m^2/s]; tension_spring (time, segment) [N], the part of the tension that the stretch gives.
    """
    import xarray as xr

    position, velocity = np.asarray(position_i_m, dtype=float), np.asarray(velocity_i_m_s, dtype=float)
    if position.ndim != 3 or position.shape[2] != 3 or velocity.shape != position.shape:
        raise InputError(
            f"position_i_m and velocity_i_m_s must both have shape (time, point, 3); got {position.shape} and {velocity.shape}."
        )
    times, count = position.shape[:2]
    try:
        mass = np.broadcast_to(np.asarray(mass_kg, dtype=float), (times, count))
        rest, stiffness = (
            np.broadcast_to(np.asarray(one, dtype=float), (times, count - 1)) for one in (rest_length_m, stiffness_n)
        )
    except ValueError as error:
        raise InputError(
            f"mass_kg must have {count} values, rest_length_m and stiffness_n {count - 1}, one row or one a time ({times})."
        ) from error
    out = np.isfinite(position).all(axis=2)
    mass, position, velocity = (
        np.where(out, mass, 0.0),
        np.where(out[..., None], position, 1.0),
        np.where(out[..., None], velocity, 0.0),
    )
    long = np.linalg.norm(np.diff(position, axis=1), axis=2) - rest
    pull = np.where((long > 0.0) & out[:, 1:] & out[:, :-1], long * stiffness / rest, 0.0)
    kinetic = 0.5 * (mass * (velocity**2).sum(axis=2)).sum(axis=1)
    potential = -gm_m3_s2 * (mass / np.linalg.norm(position, axis=2)).sum(axis=1)
    elastic = 0.5 * (pull * np.maximum(long, 0.0)).sum(axis=1)
    data = xr.Dataset()
    for name, dims, values, units in (
        ("kinetic_energy", ("time",), kinetic, "J"),
        ("potential_energy", ("time",), potential, "J"),
        ("elastic_energy", ("time",), elastic, "J"),
        ("energy", ("time",), kinetic + potential + elastic, "J"),
        ("momentum_i", ("time", "axis"), np.einsum("tp,tpj->tj", mass, velocity), "kg m s-1"),
        ("angular_momentum_i", ("time", "axis"), np.einsum("tp,tpj->tj", mass, np.cross(position, velocity)), "kg m2 s-1"),
        ("tension_spring", ("time", "segment"), pull, "N"),
    ):
        data[name] = (dims, values, {"units": units})
    return data
