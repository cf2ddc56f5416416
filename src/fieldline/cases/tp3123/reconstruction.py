"""The run of section IV of TP-3123: the corrected signals of a flight and what the bandpass filters make of them.

The text divides by the filter's gain where it is tuned, 2 z; the listing by its gain at the true skiprope frequency,

    GM = r / sqrt((1 - r^2)^2 + (2 z r)^2),   r = true frequency / filter's                                     (1)

(without the 2 z), which nobody on the ground can know. Both agree where the filter is tuned. For a negative frequency
(1) is negative, so that the listing turns all three signals over and its rule for the plane errs by half a turn;
`as_listed` follows it there too. The listing's yaw signal takes the second axis before its digits, and so does this one.

Source: Polites (1991), NASA TP-3123.
"""

from __future__ import annotations

import numpy as np

from fieldline.cases.ames_1961.dipole_field import settings_text
from fieldline.cases.erbs_like import number
from fieldline.cases.tp3123.flight import DEG, PI, Flight, field_along_orbit, fly, true_cone
from fieldline.environment.field_record import FieldModel
from fieldline.errors import InputError
from fieldline.estimation.skiprope.bandpass import METHODS, bandpass, bandpass_response, lowpass
from fieldline.estimation.skiprope.signals import FieldGeometry, corrected_signals, yaw_signal

RATE_HZ = 16.0
PI_RATIO = PI / np.pi  # a frequency in Hz times this gives the program's 2 pi f
YAW_FREQUENCY_HZ, YAW_DAMPING = 0.0001, 0.707
LONGEST_S = 864000.0


def run(
    *,
    skiprope_frequency_hz: float = 0.005,
    filter_frequency_hz: float = 0.005,
    damping: float = 0.1,
    field: str | FieldModel = "displaced-dipoles",
    quantise: bool = True,
    duration_s: float = 6000.0,
    as_listed: bool = False,
    assumed_field: str | FieldModel | None = None,
    field_scale_error: float = 0.10,
    elevation_error_deg: float = 5.0,
    azimuth_error_deg: float = 5.0,
    skiprope_deg=(0.75, 0.5),
    pendulous_frequency_hz: float = 0.03125,
    pendulous_deg=(2.0, 2.0),
    bias_deg=(1.0, 1.0, 5.0),
    noise_tesla: float = 0.0,
    seed: int = 0,
    altitude_km: float = 300.0,
    inclination_deg: float = 28.5,
    method: str = "exact",
):
    """The paper's simulation, every second, as an xarray Dataset over `seconds`.

    Parameters
    ----------
    skiprope_frequency_hz : negative for a cone that turns the other way. filter_frequency_hz, damping : of the bandpass.
    field : the true one: "displaced-dipoles", "constant", "IGRF-14", or a FieldModel. assumed_field : what the ground takes
        for it, the same by default, before its errors: scale (0.1: 10 % too large), elevation and azimuth.
    quantise : 16 bits over +-65.536 microtesla; noise_tesla : white noise before that, per axis, from `seed`.
    as_listed : the listing's gain (1) instead of the text's.
    skiprope_deg, pendulous_deg : amplitudes in (a1, a2). bias_deg : of (a1, a2, a3).
    method : of the filters, "exact" or "runge-kutta".

    Returns
    -------
    Dataset: field_tesla, elevation_rad, azimuth_rad (true), the same `_assumed`; measured_b and field_b [T], body axes;
    field_o [T]; corrected, filtered (n, 3) [rad]; yaw_estimate_rad; true angles, their parts, and the true cone.

    Errors: InputError for arguments out of range.
    """
    settings = {k: v.name if isinstance(v, FieldModel) else v for k, v in locals().items()}
    _check(settings)
    flight = fly(
        duration_s=number("duration_s", duration_s, 1.0, LONGEST_S),
        rate_hz=RATE_HZ,
        skiprope_frequency_hz=skiprope_frequency_hz,
        skiprope_deg=skiprope_deg,
        pendulous_frequency_hz=pendulous_frequency_hz,
        pendulous_deg=pendulous_deg,
        bias_deg=bias_deg,
        field=field,
        bits=16 if quantise else 0,
        noise_tesla=number("noise_tesla", noise_tesla, 0.0),
        seed=seed,
        altitude_km=number("altitude_km", altitude_km, 100.0, 1e5),
        inclination_deg=number("inclination_deg", inclination_deg, 0.0, 180.0),
    )
    known = flight.geometry
    if assumed_field is not None:
        known = field_along_orbit(flight.seconds, assumed_field, altitude_km=altitude_km, inclination_deg=inclination_deg)
    assumed = FieldGeometry(
        (1.0 + field_scale_error) * known.magnitude_tesla,
        known.elevation_rad + DEG * elevation_error_deg,
        known.azimuth_rad + DEG * azimuth_error_deg,
    )
    corrected = corrected_signals(flight.measured_b, assumed)
    yaw_input = np.column_stack([flight.measured_b[:, 0], flight.field_b[:, 1]])
    yaw_input = yaw_signal(np.column_stack([yaw_input, flight.measured_b[:, 2]]), assumed)
    tuned_hz = PI_RATIO * filter_frequency_hz
    filtered = bandpass(flight.seconds, corrected, tuned_hz, damping, method=method)
    if as_listed:
        filtered = filtered / _listed_over_text(skiprope_frequency_hz, filter_frequency_hz, damping)
    yaw = lowpass(flight.seconds, yaw_input, PI_RATIO * YAW_FREQUENCY_HZ, YAW_DAMPING, method=method)
    return _dataset(flight, assumed, corrected, filtered, yaw, yaw_input, settings)


def listed_gain(skiprope_frequency_hz: float, filter_frequency_hz: float, damping: float) -> tuple[float, float]:
    """GM of (1) and the phase [rad] that the listing prints beside it and never applies."""
    r = skiprope_frequency_hz / filter_frequency_hz
    real, imaginary = 1.0 - r * r, 2.0 * damping * r
    return r / np.hypot(real, imaginary), PI / 2.0 - np.arctan2(imaginary, real)


def _listed_over_text(skiprope_frequency_hz: float, filter_frequency_hz: float, damping: float) -> float:
    """2 z GM: the gain of the filter at the skiprope frequency, with the frequency's sign."""
    gain = abs(bandpass_response(skiprope_frequency_hz, filter_frequency_hz, damping))
    return float(np.copysign(gain, skiprope_frequency_hz))


def _dataset(flight: Flight, assumed: FieldGeometry, corrected, filtered, yaw, yaw_input, settings: dict):
    """Everything, once a second."""
    import xarray as xr

    tilt, azimuth = true_cone(flight)
    columns = {
        "field_tesla": (flight.geometry.magnitude_tesla, "T", "magnitude of the true field"),
        "elevation_rad": (flight.geometry.elevation_rad, "rad", "elevation of the true field above the local level"),
        "azimuth_rad": (flight.geometry.azimuth_rad, "rad", "azimuth of the true field, from V (orbit's normal) towards -U"),
        "field_assumed_tesla": (assumed.magnitude_tesla, "T", "magnitude of the field as the ground takes it"),
        "elevation_assumed_rad": (assumed.elevation_rad, "rad", "its elevation"),
        "azimuth_assumed_rad": (assumed.azimuth_rad, "rad", "its azimuth"),
        "field_o": (flight.field_o, "T", "true field, orbital axes (along the velocity, against the normal, down)"),
        "field_b": (flight.field_b, "T", "true field, body axes"),
        "measured_b": (flight.measured_b, "T", "the magnetometer's reading, body axes"),
        "corrected": (corrected, "rad", "corrected signals, equation (7)"),
        "filtered": (filtered, "rad", "bandpass filters' outputs"),
        "yaw_signal_rad": (yaw_input, "rad", "signal of the yaw angle, before its filter"),
        "yaw_estimate_rad": (yaw, "rad", "yaw angle by the low-pass filter"),
        "angles_rad": (flight.angles_rad, "rad", "true Euler angles a1, a2, a3"),
        "skiprope_rad": (flight.skiprope_rad, "rad", "parts of a1, a2 by the skiprope"),
        "pendulous_rad": (flight.pendulous_rad, "rad", "parts of a1, a2 by the pendulous motion"),
        "cone_rad": (tilt, "rad", "true tilt of the third body axis by the skiprope"),
        "cone_azimuth_rad": (azimuth, "rad", "true azimuth of that tilt, as the field's"),
    }
    each = round(RATE_HZ)
    variables = {}
    for name, (values, units, words) in columns.items():
        dims = ("seconds",) if values.ndim == 1 else ("seconds", "axis" if values.shape[1] == 3 else "angle")
        variables[name] = (dims, values[::each], {"units": units, "long_name": words})
    gain, phase = listed_gain(*(settings[k] for k in ("skiprope_frequency_hz", "filter_frequency_hz", "damping")))
    return xr.Dataset(
        variables,
        coords={"seconds": ("seconds", flight.seconds[::each], {"units": "s"}), "axis": [1, 2, 3], "angle": [1, 2]},
        attrs={
            "title": "Skiprope of a tethered satellite by bandpass filters (TP-3123)",
            "case": "tp3123",
            "source": "Polites (1991), NASA TP-3123",
            "settings_json": settings_text(settings),
            "listed_gain": gain,
            "listed_phase_rad": phase,
        },
    )


def _check(settings: dict) -> None:
    """Refusals that name the argument."""
    frequency = settings["skiprope_frequency_hz"]
    number("skiprope_frequency_hz", frequency, -RATE_HZ / 2.0, RATE_HZ / 2.0)
    if frequency == 0.0:
        raise InputError("skiprope_frequency_hz must not be zero; its sign is the sense of the cone.")
    for name in ("filter_frequency_hz", "pendulous_frequency_hz"):
        number(name, settings[name], 1e-6, RATE_HZ / 2.0)
    number("damping", settings["damping"], 1e-3, 0.999)
    number("field_scale_error", settings["field_scale_error"], -0.9, 10.0)
    for name in ("elevation_error_deg", "azimuth_error_deg"):
        number(name, settings[name], -90.0, 90.0)
    for name, count in (("skiprope_deg", 2), ("pendulous_deg", 2), ("bias_deg", 3)):
        _angles(name, settings[name], count)
    for name in ("quantise", "as_listed"):
        if not isinstance(settings[name], bool):
            raise InputError(f"{name} must be True or False; got {settings[name]!r}.")
    if isinstance(settings["seed"], bool) or not isinstance(settings["seed"], int) or settings["seed"] < 0:
        raise InputError(f"seed must be a whole number, 0 or more; got {settings['seed']!r}.")
    if settings["method"] not in METHODS:
        raise InputError(f"method must be one of {', '.join(METHODS)}; got {settings['method']!r}.")


def _angles(name: str, given, count: int) -> None:
    """Refuse what is not `count` finite numbers."""
    try:
        values = np.asarray(given, dtype=float)
    except (TypeError, ValueError):
        values = np.empty(0)
    if values.shape != (count,) or not np.isfinite(values).all():
        raise InputError(f"{name} must be {count} angles [deg]; got {given!r}.")
