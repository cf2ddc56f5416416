"""`calibrate`: the calibration of a magnetometer from telemetry and an orbit, without attitude.

    | gain(t) D (field_s - bias ...) | = | B(position_e(t), t) |

The magnitude of the field is the same in all axes, so position and time are all that is needed of the flight.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fieldline.errors import InputError, nearest
from fieldline.estimation.calibration import Calibration, Flight, calibrate_flights
from fieldline.estimation.calibration.face import scan_of
from fieldline.estimation.reference import Reference, reference_along_orbit
from fieldline.orbit import Orbit
from fieldline.telemetry import Telemetry

COLUMNS = {"temperature": "temperature_k", "dipole": "dipole_command_b", "current": "solar_current"}


def calibrate(
    telemetry: Telemetry | Sequence[Telemetry],
    orbit: Orbit | Sequence[Orbit],
    *,
    model: str = "IGRF-14",
    calibration: str = "auto",
    clock_scan: bool = False,
    use: Sequence[str] = (),
) -> Calibration | tuple[Calibration, ...]:
    """Bias, matrix and, where the data support them, gain, drift, step in sunlight and couplings of a magnetometer.

    Parameters
    ----------
    telemetry : one file's Telemetry, or several of one satellite, which then share matrix and bias.
    orbit : the satellite's orbit; one for all files, or one for each.
    model : the field model.      calibration : the sensor's model, as of `calibrate_magnitude`; "auto" lets the data decide.
    clock_scan : also tell whether the magnitudes would fit better at shifted times, and how surely; nothing is shifted.
    use : columns that terms may be fitted to, of "temperature", "dipole", "current".

    Returns
    -------
    Calibration for one Telemetry; a tuple of them, in order, for several. Its `apply` turns raw readings (n, 3) [T] into
    the field (n, 3) [T] in body axes.

    Errors: InputError for what cannot be read as asked; NoEstimateError where the data do not support a calibration.
    """
    several = not isinstance(telemetry, Telemetry)
    flown = list(telemetry) if several else [telemetry]
    orbits = list(orbit) if isinstance(orbit, list | tuple) else [orbit] * len(flown)
    if len(orbits) != len(flown):
        raise InputError(f"one orbit, or one for each of the {len(flown)} telemetries, is needed; got {len(orbits)}.")
    references = [reference_along_orbit(t.time_utc, o, model) for t, o in zip(flown, orbits, strict=True)]
    found = calibrate_against(flown, references, calibration=calibration, use=use)
    if clock_scan:
        found = tuple(with_clock_scan(*one, model) for one in zip(found, flown, orbits, references, strict=True))
    return found if several else found[0]


def with_clock_scan(
    calibration: Calibration, telemetry: Telemetry, orbit: Orbit, reference: Reference, model: str
) -> Calibration:
    """The calibration with the scan of its flight's clock, at offsets over two minutes to each side."""

    def magnitude_at(offset_s: float) -> np.ndarray:
        later = telemetry.time_utc + np.timedelta64(round(1e9 * offset_s), "ns")
        return reference_along_orbit(later, orbit, model).magnitude

    columns = [name for name in COLUMNS if getattr(telemetry, COLUMNS[name]) is not None]
    flight = _shifted(_flight(telemetry, reference, columns), np.datetime64(calibration.epoch_utc, "ns"))
    scan = scan_of(calibration, flight, magnitude_at)
    return replace(calibration, clock=scan, sentences=(*calibration.sentences, scan.sentence()))


def calibrate_against(
    flown: Sequence[Telemetry], references: Sequence[Reference], *, calibration: str = "auto", use: Sequence[str] = ()
) -> tuple[Calibration, ...]:
    """`calibrate` where the reference along each orbit is already there."""
    unknown = [name for name in use if name not in COLUMNS]
    if unknown:
        raise InputError(f'use: there is no column "{unknown[0]}"; {nearest(unknown[0], COLUMNS)}')
    flights = [_flight(t, r, use) for t, r in zip(flown, references, strict=True)]
    return calibrate_flights(_on_one_clock(flights), model=calibration)


def sunlit_along(reference: Reference) -> np.ndarray:
    """(n,) share of the Sun's disc that is seen, 0 to 1: what stands in for the current of the solar panels."""
    from fieldline.environment import eclipse

    return eclipse(reference.position_i, reference.time_utc)


def columns_for(calibration: Calibration, telemetry: Telemetry, reference: Reference) -> dict[str, np.ndarray | None]:
    """The columns that this calibration's `apply`, `gain_at` and `propagated_std` need, by their arguments' names."""
    given = {COLUMNS[name]: getattr(telemetry, COLUMNS[name]) for name in COLUMNS if getattr(calibration.terms, name)}
    return given | ({"sunlit": sunlit_along(reference)} if calibration.terms.sunlit else {})


def _flight(telemetry: Telemetry, reference: Reference, use: Sequence[str]) -> Flight:
    """What the calibration sees of a telemetry."""
    given = {COLUMNS[name]: getattr(telemetry, COLUMNS[name]) for name in use}
    missing = [name for name in use if given[COLUMNS[name]] is None]
    if missing:
        raise InputError(f'use "{missing[0]}": "{telemetry.name}" has no column that was recognised as that.')
    return Flight(
        seconds=telemetry.seconds,
        field_s=telemetry.field_s,
        magnitude_tesla=reference.magnitude,
        usable=telemetry.usable,
        epoch_utc=telemetry.epoch_utc,
        name=telemetry.name,
        sunlit=sunlit_along(reference),
        **given,
    )


def _on_one_clock(flights: list[Flight]) -> list[Flight]:
    """The flights with seconds since the first one's epoch, since they share one reference time."""
    return [_shifted(flight, np.datetime64(flights[0].epoch_utc, "ns")) for flight in flights]


def _shifted(flight: Flight, epoch_utc: np.datetime64) -> Flight:
    """The flight with seconds since another epoch."""
    later_s = (np.datetime64(flight.epoch_utc, "ns") - epoch_utc) / np.timedelta64(1, "s")
    return replace(flight, seconds=flight.seconds + later_s, epoch_utc=epoch_utc)
