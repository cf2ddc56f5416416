"""What the sky says along the orbit: the reference field, the Sun, and the place, at every sample.

    B_i = dcm_ei^T B_e(position_e, t)

The estimator sees the Earth only through this record, so every model error of field, orbit and clock enters here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fieldline.orbit import Orbit


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Reference:
    """(n,) times, (n, 3) [T] field_i and field_e, (n, 3) position_i [m], velocity_i [m/s], position_e [m]."""

    time_utc: np.ndarray
    field_i: np.ndarray
    field_e: np.ndarray
    position_i: np.ndarray
    velocity_i: np.ndarray
    position_e: np.ndarray
    model: str
    stamp: dict
    orbit: dict

    @property
    def magnitude(self) -> np.ndarray:
        """(n,) [T] |B|."""
        return np.linalg.norm(self.field_i, axis=1)

    def part(self, rows: slice) -> Reference:
        """The same record for some of the samples."""
        return Reference(
            time_utc=self.time_utc[rows],
            field_i=self.field_i[rows],
            field_e=self.field_e[rows],
            position_i=self.position_i[rows],
            velocity_i=self.velocity_i[rows],
            position_e=self.position_e[rows],
            model=self.model,
            stamp=self.stamp,
            orbit=self.orbit,
        )


def reference_along_orbit(time_utc, orbit: Orbit, model="IGRF-14", degree: int | None = None) -> Reference:
    """Reference field of `model` (a name or a field model) at (n,) UTC times along `orbit`.

    Errors: those of the orbit (times it does not cover) and of the model (years outside its range), as InputError.
    """
    from fieldline.environment import field_model, magnetic_field
    from fieldline.frames.earth_rotation import dcm_ei

    chosen = field_model(model) if degree is None else field_model(model, degree=degree)
    position_i, velocity_i = orbit.state_i(time_utc)
    position_e = orbit.position_e(time_utc)
    field_e = magnetic_field(position_e, time_utc, model=chosen)
    field_i = np.einsum("nji,nj->ni", dcm_ei(time_utc, orbit.eop), field_e)
    return Reference(
        time_utc=time_utc,
        field_i=np.ascontiguousarray(field_i),
        field_e=field_e,
        position_i=position_i,
        velocity_i=velocity_i,
        position_e=position_e,
        model=chosen.name,
        stamp=chosen.stamp(time_utc),
        orbit=orbit.describe(time_utc),
    )
