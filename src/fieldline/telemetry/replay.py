"""Flown telemetry as the `Measurement` that flight software is given, so that laws and estimators run over a flown day.

    from fieldline.telemetry import measurements_of, read_telemetry

    for t, measurement in measurements_of(read_telemetry("flight.csv")):
        command = law(t, measurement, memory, params)

What the file does not hold stays unknown: NaN, and 0 in `valid`. A sample that `usable` refuses leaves the field as it
was read last, with its time and `valid[FIELD]` 0, as a law on board would find it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

import numpy as np

from fieldline.errors import InputError
from fieldline.sensing.measurement import ATTITUDE, FIELD, GYRO, ORBIT, RATE, SUN, Measurement, new_measurement
from fieldline.telemetry.record import Telemetry


class AlongOrbit(Protocol):
    """What is known on board of the orbit, (n, 3) each; `fieldline.estimation.reference_along_orbit` makes one."""

    @property
    def position_i(self) -> np.ndarray: ...  # noqa: D102
    @property
    def velocity_i(self) -> np.ndarray: ...  # noqa: D102
    @property
    def field_i(self) -> np.ndarray: ...  # noqa: D102


def measurements_of(
    telemetry: Telemetry,
    *,
    field_b: np.ndarray | None = None,
    q_bi: np.ndarray | None = None,
    omega_bi_b: np.ndarray | None = None,
    reference: AlongOrbit | None = None,
    sun_full_scale: float | None = None,
    wheel_inertia_kg_m2: float | None = None,
) -> Iterator[tuple[float, Measurement]]:
    """One (t, Measurement) a sample, t [s] since the first; the same record each time, overwritten in place.

    Parameters
    ----------
    field_b : (n, 3) [T], the calibrated field; the raw readings where it is not given.
    q_bi, omega_bi_b : (n, 4), (n, 3) [rad/s], attitude and rate as estimated; a gyro's rate where omega_bi_b is not given.
    reference : position, velocity and field of the model along the orbit, at the samples.
    sun_full_scale : the sun sensors' raw reading at normal incidence; without it they are not passed on.
    wheel_inertia_kg_m2 : a wheel's inertia about its axis; without it momenta are not passed on (no wheels).

    Errors: InputError where an array has not one row a sample, or a scale is not positive.
    """
    for name, values, width in (
        ("field_b", field_b, 3),
        ("q_bi", q_bi, 4),
        ("omega_bi_b", omega_bi_b, 3),
        *(
            ()
            if reference is None
            else tuple((key, getattr(reference, key), 3) for key in ("position_i", "velocity_i", "field_i"))
        ),
    ):
        if values is not None and np.shape(values) != (len(telemetry), width):
            raise InputError(f"{name} must be ({len(telemetry)}, {width}), one row a sample; got shape {np.shape(values)}.")
    for name, scale in (("sun_full_scale", sun_full_scale), ("wheel_inertia_kg_m2", wheel_inertia_kg_m2)):
        if scale is not None and not 0.0 < scale < np.inf:
            raise InputError(f"{name} must be a positive number; got {scale}.")
    field = np.where(telemetry.usable[:, None], telemetry.field_s if field_b is None else field_b, np.nan)
    faces = telemetry.sun_sensor.values() if sun_full_scale else ()
    wheels = telemetry.wheel_speed.values() if wheel_inertia_kg_m2 else ()
    columns = [
        ("field_b", FIELD, field),
        ("rate_b", GYRO, telemetry.rate_b),
        ("sun_sensor", SUN, _side_by_side(faces, 1.0 / (sun_full_scale or 1.0))),
        ("q_bi", ATTITUDE, q_bi),
        ("omega_bi_b", RATE, telemetry.rate_b if omega_bi_b is None else omega_bi_b),
        ("wheel_momentum", None, _side_by_side(wheels, wheel_inertia_kg_m2 or 1.0)),
        ("dipole_b", None, telemetry.dipole_command_b),
    ]
    if reference is not None:
        columns += [(key, ORBIT, getattr(reference, key)) for key in ("position_i", "velocity_i", "field_i")]
    given = [(name, flag, values) for name, flag, values in columns if values is not None]
    return _replay(telemetry.seconds, given, new_measurement(len(faces), len(wheels)))


def _side_by_side(columns, factor: float) -> np.ndarray | None:
    """(n, columns) array times a factor; None where there are none."""
    return factor * np.stack(list(columns), axis=1) if len(columns) else None


def _replay(seconds: np.ndarray, columns: list, measurement: Measurement) -> Iterator[tuple[float, Measurement]]:
    """Each sample's finite readings into the record; one that is not finite keeps the last and is not valid."""
    for row, t in enumerate(seconds):
        for name, flag, values in columns:
            known = bool(np.isfinite(values[row]).all())
            if known:
                getattr(measurement, name)[:] = values[row]
            if flag is not None:
                measurement.valid[flag] = float(known)
            if known and flag == FIELD:
                measurement.field_time_s[0] = t
        yield float(t), measurement
