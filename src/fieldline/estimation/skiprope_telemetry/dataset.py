"""A skiprope estimate as an xarray Dataset: rows of the answer over `time`, samples that it was made of over `sample_time`."""

from __future__ import annotations

import json

import numpy as np

from fieldline.errors import NoEstimateError
from fieldline.estimation.skiprope.bandpass import bandpass
from fieldline.estimation.skiprope.reading import read_cone
from fieldline.estimation.skiprope_telemetry.plane import COUNT
from fieldline.estimation.skiprope_telemetry.solving import Solved

TIME, SAMPLE, LINE, MARK = ("time",), ("sample_time",), ("frequency",), ("mark",)
DAMPING = 0.1
NS = 1e9
AXES_WORDS = "along U, the velocity, and V, the orbit's normal"


def skiprope_dataset(solved: Solved, verdict: dict, provenance: dict):
    """The Dataset of `estimate_skiprope`."""
    import xarray as xr

    epoch = solved.rows.time_utc[0]
    sides = {"time": utc_after(epoch, solved.estimate.seconds), "sample_time": utc_after(epoch, solved.signals.seconds)}
    coordinates = {
        **sides,
        "crossing": np.arange(1, COUNT + 1),
        "axis": list("UVW"),
        "axis_2": list("UVW"),
        "plane_axis": list("UV"),
        "plane_axis_2": list("UV"),
        "signal": [1, 2, 3],
        "frequency": solved.estimate.detection.frequency_hz,
    }
    variables = {}
    for name, (dims, values, units, words) in {**answer_of(solved), **_samples(solved), **_spectrum(solved)}.items():
        attributes = {"long_name": words} | ({"units": units} if units else {})
        variables[name] = (dims, values, attributes)
    variables |= _marks(solved, epoch)
    attrs = {
        "title": f"Skiprope of {verdict['telemetry']['name']} from its magnetometer",
        "Conventions": "CF-1.11",
        "verdict": verdict["sentence"],
        "usable": int(verdict["usable"]),
        "verdict_json": json.dumps(verdict),
        "provenance_json": json.dumps(provenance),
    }
    dataset = xr.Dataset(variables, coordinates, attrs)
    dataset["frequency"].attrs = {"units": "Hz", "long_name": "frequency of the spectrum"}
    return dataset


def answer_of(solved: Solved) -> dict:
    """The answer, row by row: (dims, values, units, words) by name."""
    found, turned = solved.estimate, solved.half_turned
    numbers = {
        "amplitude": ("rad", "tilt of the satellite's axis, of the round part of the cone"),
        "major": ("rad", "larger half axis of the cone"),
        "minor": ("rad", "smaller half axis of the cone"),
        "phase": ("rad", "phase of the round part: a1 = a cos, a2 = a sin"),
    }
    columns = {}
    for name, (units, words) in numbers.items():
        columns[f"{name}_rad"] = (TIME, getattr(found, f"{name}_rad"), units, words)
        columns[f"{name}_std_rad"] = (TIME, getattr(found, f"{name}_std_rad"), units, f"1-sigma of {name}_rad")
    next_utc = utc_after(solved.rows.time_utc[0], solved.crossings.seconds)
    return columns | {
        "plane_rad": (TIME, turned.plane_rad, "rad", "azimuth of the tether's middle, from V (orbit's normal) towards -U"),
        "plane_std_rad": (TIME, found.plane_std_rad, "rad", "1-sigma of plane_rad"),
        "frequency_hz": (TIME, found.frequency_hz, "Hz", "frequency of the skiprope"),
        "frequency_std_hz": (TIME, found.frequency_std_hz, "Hz", "1-sigma of frequency_hz"),
        "sense": (TIME, found.sense, "1", "1: from V (orbit's normal) towards -U (rear), -1: back, 0: not to be told"),
        "deflection_m": (TIME, found.deflection_m, "m", "deflection of the tether's middle, amplitude times length over pi"),
        "deflection_std_m": (TIME, found.deflection_std_m, "m", "1-sigma of deflection_m"),
        "position_m": ((*TIME, "plane_axis"), turned.position_m, "m", f"the tether's middle, {AXES_WORDS}"),
        "position_covariance_m2": ((*TIME, "plane_axis", "plane_axis_2"), found.position_covariance_m2, "m2", "its covariance"),
        "yaw_rad": (
            TIME,
            found.yaw_rad,
            "rad",
            "yaw taken: the measured one's rest, or the share of what field and body disagree",
        ),
        "yaw_std_rad": (TIME, found.yaw_std_rad, "rad", "1-sigma of yaw_rad: the floor of the plane's deviation"),
        "trusted": (TIME, found.trusted, "1", "whether the row may be trusted"),
        "crossing_time": ((*TIME, "crossing"), next_utc, "", f"next crossings of the plane: {solved.plane.word}"),
        "crossing_std_s": ((*TIME, "crossing"), solved.crossings.std_s, "s", "1-sigma of crossing_time"),
        "crossing_towards": ((*TIME, "crossing"), solved.crossings.towards, "1", "tether then on the plane's azimuth's side"),
        "crossing_plane_rad": ((*TIME, "crossing"), solved.crossings.plane_rad, "rad", "azimuth of the plane then"),
    }


def _samples(solved: Solved) -> dict:
    """The signals, sample by sample."""
    signals, geometry = solved.signals, solved.signals.geometry
    columns = {
        "corrected_rad": ((*SAMPLE, "signal"), signals.corrected, "rad", "corrected signals C1, C2, C3, equation (7) of TP-3123"),
        "field_c": (
            (*SAMPLE, "axis"),
            signals.field_b,
            "T",
            "measured field, usual body attitude taken off: axes near (U, V, W)",
        ),
        "field_known_tesla": (SAMPLE, geometry.magnitude_tesla, "T", "known field, its size"),
        "field_elevation_rad": (SAMPLE, geometry.elevation_rad, "rad", "known field, its elevation above the U-V plane"),
        "field_azimuth_rad": (SAMPLE, geometry.azimuth_rad, "rad", "known field, its azimuth from V towards -U"),
    }
    if not solved.estimate.detected:
        return columns
    tuned = float(np.median(solved.estimate.frequency_hz))
    hold = 0.5 / tuned
    filtered = bandpass(signals.seconds, signals.corrected, tuned, DAMPING, method="linear", longest_hold_s=hold)
    words = f"C1, C2, C3 through the bandpass at {1e3 * tuned:.4g} mHz"
    return columns | {"filtered_rad": ((*SAMPLE, "signal"), filtered, "rad", words)}


def _spectrum(solved: Solved) -> dict:
    """The two turning parts over frequency, and what would have been detected."""
    found = solved.estimate.detection
    return {
        "spectrum_forward_rad": (LINE, found.forward_rad, "rad", "amplitude of the part that turns from V towards -U"),
        "spectrum_backward_rad": (LINE, found.backward_rad, "rad", "amplitude of the part that turns back"),
        "spectrum_threshold_rad": (LINE, found.threshold_rad, "rad", "amplitude of a round cone at the threshold"),
    }


def _marks(solved: Solved, epoch) -> dict:
    """Reading marks by the rules of TP-3123: where C3 is highest, the tether lies in the field's plane, opposite to the field."""
    if not solved.estimate.detected:
        return {}
    signals = solved.signals
    tuned = float(np.median(solved.estimate.frequency_hz))
    filtered = bandpass(signals.seconds, signals.corrected, tuned, DAMPING, method="linear", longest_hold_s=0.5 / tuned)
    try:
        reading = read_cone(signals.seconds, filtered, signals.geometry, tuned, damping=DAMPING)
    except NoEstimateError:
        return {}
    return {
        "mark_time": (MARK, utc_after(epoch, reading.maximum_s), {"long_name": "maxima of C3, by a sine through each cycle"}),
        "mark_amplitude_rad": (MARK, reading.cycle_amplitude_rad, {"units": "rad", "long_name": "amplitude read there"}),
    }


def utc_after(epoch: np.datetime64, seconds) -> np.ndarray:
    """Seconds after the first row as UTC, NaT where there is none."""
    values = np.asarray(seconds, dtype=float)
    whole = np.rint(np.where(np.isfinite(values), values, 0.0) * NS).astype(np.int64)
    return np.where(np.isfinite(values), epoch + whole.astype("timedelta64[ns]"), np.datetime64("NaT", "ns"))
