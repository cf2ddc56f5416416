"""`fl.estimate_skiprope`: magnetometer telemetry and an orbit in; the skiprope of the satellite's tether out."""

from __future__ import annotations

import platform
from collections.abc import Callable

import numpy as np

from fieldline.errors import InputError
from fieldline.estimation.skiprope_telemetry.dataset import skiprope_dataset
from fieldline.estimation.skiprope_telemetry.mounting import Mounting
from fieldline.estimation.skiprope_telemetry.solving import SkipropeSettings, Solved, solve_rows
from fieldline.estimation.skiprope_telemetry.tether import TetherLengths
from fieldline.orbit import Orbit
from fieldline.telemetry import Telemetry
from fieldline.telemetry.averaging import averaged, comes_fast
from fieldline.telemetry.stream import Rows

PACKAGES = ("fieldline", "numpy", "scipy", "numba", "pyerfa", "sgp4", "xarray")


def estimate_skiprope(
    telemetry: Telemetry,
    orbit: Orbit | None = None,
    *,
    tether_length_m: float | None = None,
    frequency_hz: float | None = None,
    method: str = "harmonic",
    model="IGRF-14",
    sensor_axes="x,y,z",
    attitude_deg=(0.0, 0.0, 0.0),
    tether: str = "down",
    plane="field",
    calibration="none",
    use_yaw: bool = True,
    steady_s: float | None = None,
    reeled: bool = False,
    lengths: TetherLengths | None = None,
    end_mass_kg: float | None = None,
    tether_kg_m: float | None = None,
    swing: float | str | None = None,
    progress: Callable[[str, float, float, str], None] | None = None,
):
    """Skiprope of a tethered satellite from its magnetometer: amplitude, frequency, sense, plane, each with an uncertainty.

    Parameters
    ----------
    telemetry : as `read_telemetry` gives it; the satellite points at the Earth and hangs on the tether.
    orbit : as `read_orbit` gives it; None takes the telemetry's own positions.
    tether_length_m : [m] between the two bodies; not needed with lengths.
    frequency_hz : a first frequency [Hz]; found by default, where a tether of that length may skip.
    end_mass_kg, tether_kg_m : of the lighter end, and of a metre of tether: both narrow the search down.
    lengths : of a tether that is paid out or taken in, as `read_tether_lengths` gives them: followed throughout.
    swing : frequency [Hz] of the satellite's swing on its tether, or "found"; taken off the deflection.
    method : "harmonic", "kalman" or "bandpass" (TP-3123's filters and rules).      model : of the field, by name or a FieldModel.
    sensor_axes : the magnetometer's axes along body x, y, z, as "x,-y,-z", or a matrix (3, 3), v_b = S v_s.
    attitude_deg : roll, pitch, yaw [deg] of the body against the orbital axes (x along the velocity, y against the normal,
        z down), 3-2-1.      tether : "down" or "up", the way it leaves the satellite.
    plane : "field", "orbit", "normal" or an azimuth [deg] from the orbit's normal towards the rear, whose crossings are asked.
    calibration : "none", "auto", "bias", "full", or a Calibration.      use_yaw : use the telemetry's yaw where it has one.
    steady_s : over which the cone keeps its ellipse [s], for "harmonic"; ten periods by default. Shorter for a tether of 20 km.
    reeled : the tether is paid out or taken in, so that its frequency runs; for "kalman". Deflections are of the given length.
    progress : called with (stage, done, total, words).

    Returns
    -------
    xarray.Dataset: over `time` amplitude_rad, frequency_hz, sense, phase_rad, plane_rad, deflection_m, position_m (U, V), their
    deviations and the next three crossings; over `sample_time` the corrected and filtered signals; the spectrum; the
    verdict in its attributes. Attribute `usable` is 0 where no skiprope was found.

    Errors: InputError for input that cannot be used; NoEstimateError for a record too short, or a field too badly known.
    Source: docs/theory/skiprope.md. Valid for tilts of a few degrees.
    """
    settings = SkipropeSettings(
        tether_length_m=length_of(tether_length_m, lengths), frequency_hz=frequency_hz, method=method, model=model,
        mounting=Mounting(sensor_axes=sensor_axes, attitude_deg=attitude_deg, tether=tether), plane=plane,
        calibration=calibration, use_yaw=use_yaw, steady_s=steady_s, reeled=reeled, lengths=lengths, end_mass_kg=end_mass_kg,
        tether_kg_m=tether_kg_m, swing=swing,
    )  # fmt: skip
    rows = rows_of(telemetry)
    if lengths is not None:
        lengths.of_record(rows.time_utc)
    if settings.averages and comes_fast(rows.time_utc):
        rows = averaged(rows)
    solved = solve_rows(rows, orbit, settings, progress)
    told = {"name": telemetry.name, "sha256": telemetry.sha256, "lines": telemetry.describe()}
    return dataset_of(solved, settings, told)


def length_of(tether_length_m: float | None, lengths: TetherLengths | None) -> float:
    """[m] as given, or the last of the lengths; InputError for neither."""
    if tether_length_m is not None:
        return tether_length_m
    if lengths is None:
        raise InputError("the length of the tether is needed: --tether-length-m, or --tether-lengths of one that changes.")
    return float(lengths.length_m[-1])


def rows_of(telemetry: Telemetry) -> Rows:
    """A file's samples as rows; those that are not to be used without a field."""
    nothing = np.full((len(telemetry), 3), np.nan)
    return Rows(
        telemetry.time_utc,
        np.where(telemetry.usable[:, None], telemetry.field_s, np.nan),
        nothing[:, 0] if telemetry.yaw_rad is None else telemetry.yaw_rad,
        nothing if telemetry.position_e is None else telemetry.position_e,
    )


def dataset_of(solved: Solved, settings: SkipropeSettings, telemetry: dict):
    """The Dataset, its verdict and its provenance; telemetry: name, sha256 and lines of what was read."""
    return skiprope_dataset(solved, verdict_of(solved, settings, telemetry), _provenance(solved, settings, telemetry))


def verdict_of(solved: Solved, settings: SkipropeSettings, telemetry: dict) -> dict:
    """The machine-readable verdict."""
    found, reference = solved.estimate, solved.reference
    numbers = _numbers(solved) if found.detected else {}
    return {
        "usable": bool(found.detected and found.trusted.any()),
        "detected": bool(found.detected),
        "sentence": found.verdict[:1].upper() + found.verdict[1:],
        "exit_code": 0 if found.detected and found.trusted.any() else 1,
        "method": found.method,
        **numbers,
        "trusted_after_s": None if not np.isfinite(found.trusted_from_s) else float(found.trusted_from_s),
        "false_alarm": float(found.detection.false_alarm),
        "threshold_deg": _threshold_deg(solved),
        "floor_deg": float(np.degrees(np.median(found.yaw_std_rad))) if found.detected else None,
        "yaw_measured": solved.yaw_used,
        "notes": list(found.notes),
        "warnings": [*solved.remarks, *reference.orbit.get("warnings", [])],
        "calibration": solved.calibration.summary() if solved.calibration is not None else {"model": "none"},
        "telemetry": telemetry,
        "orbit": reference.orbit,
        "field_model": reference.stamp,
        "settings": settings.described(),
    }


def _numbers(solved: Solved) -> dict:
    """The last row that may be trusted, or the last one, in degrees."""
    found = solved.estimate
    row = int(np.flatnonzero(found.trusted)[-1]) if found.trusted.any() else len(found.seconds) - 1
    degrees = {
        name: float(np.degrees(getattr(found, f"{name}_rad")[row]))
        for name in ("amplitude", "amplitude_std", "major", "minor", "plane_std", "phase", "phase_std")
    }
    return {
        "row_utc": str(
            np.datetime_as_string(solved.rows.time_utc[0] + np.timedelta64(round(found.seconds[row] * 1e9), "ns"), "s")
        )
        + "Z",
        **{f"{name}_deg": value for name, value in degrees.items()},
        "plane_deg": float(np.degrees(solved.half_turned.plane_rad[row])),
        "frequency_hz": float(found.frequency_hz[row]),
        "frequency_std_hz": float(found.frequency_std_hz[row]),
        "sense": int(found.sense[row]),
        "deflection_m": float(found.deflection_m[row]),
        "deflection_std_m": float(found.deflection_std_m[row]),
    }


def _threshold_deg(solved: Solved) -> float | None:
    """[deg] the round cone that would have been detected, in the median over the spectrum near the cone's."""
    found = solved.estimate.detection
    level = found.threshold_rad[np.isfinite(found.threshold_rad)]
    if not len(level):
        return None
    if found.cone is not None:
        return float(np.degrees(np.interp(found.cone.frequency_hz, found.frequency_hz, found.threshold_rad)))
    return float(np.degrees(np.median(level)))


def _provenance(solved: Solved, settings: SkipropeSettings, telemetry: dict) -> dict:
    """Versions, inputs, models and settings: what it takes to make the same bits again."""
    from importlib import metadata

    return {
        "versions": {name: metadata.version(name) for name in PACKAGES} | {"python": platform.python_version()},
        "inputs": {"telemetry": {k: telemetry.get(k) for k in ("name", "sha256")}, "orbit": solved.reference.orbit},
        "field_model": solved.reference.stamp,
        "settings": settings.described(),
    }
