"""From rows of a magnetometer and an orbit to the skiprope: one way for a file and for a stream.

rows -> (averaged over seconds) -> calibrated -> axes of the cone; orbit -> known field in the same axes -> estimator
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from fieldline.errors import InputError, NoEstimateError, nearest
from fieldline.estimation.calibrate import calibrate_against, columns_for
from fieldline.estimation.calibration import Calibration
from fieldline.estimation.reference import Reference, reference_along_orbit
from fieldline.estimation.skiprope.line_band import line_band
from fieldline.estimation.skiprope.reeled import estimate_reeled
from fieldline.estimation.skiprope.rotary import FEWEST_PERIODS, LEAST_TURNING, detect
from fieldline.estimation.skiprope.signals import ORBITAL_FROM_CONE, SkipropeSignals, skiprope_signals
from fieldline.estimation.skiprope.solution import SkipropeEstimate
from fieldline.estimation.skiprope_telemetry.mounting import Mounting
from fieldline.estimation.skiprope_telemetry.plane import Crossings, Plane, next_crossings, plane_of
from fieldline.estimation.skiprope_telemetry.tether import TetherLengths, swing_taken_off
from fieldline.orbit import Orbit, orbit_from_positions
from fieldline.telemetry import telemetry_of
from fieldline.telemetry.stream import Rows

METHODS = ("bandpass", "harmonic", "kalman")
LENGTH_M = (1.0, 1e6)
STEADY_S = (1.0, 1e6)
FREQUENCY_HZ = (1e-5, 10.0)
MASS_KG, LINEAR_KG_M = (1e-3, 1e7), (1e-8, 1e2)
FASTEST_AVERAGED_HZ = 0.06  # a quicker cone keeps all of its samples
FEWEST = 30
BELOW_HZ = (0.0009, 0.0022)
WORTH_A_HINT_RAD = np.radians(0.1)
SLOW_HZ = 0.003  # what a record should show: the skiprope of a tether of 20 km is above
LARGEST_MISFIT_DEG = 30.0  # between measured and known direction, in the median
LARGEST_SHARE = 0.3  # of the field's size


@dataclass(frozen=True, kw_only=True)
class SkipropeSettings:
    """What an estimate is told. frequency_hz None: found from the spectrum. calibration: "none", "auto", "bias", "full",
    or a Calibration. use_yaw: whether a measured yaw is used. steady_s: over which the ellipse is steady.
    reeled: the tether is paid out or taken in, and its frequency runs (kalman); lengths: it is, and the reel tells.
    end_mass_kg, tether_kg_m: of the lighter end and of a metre of tether, from which follows where its skiprope can be.
    swing: how the satellite swings on its tether, [Hz], or "found" in the spectrum; None leaves deflections as they are.
    """

    tether_length_m: float
    frequency_hz: float | None = None
    method: str = "harmonic"
    model: Any = "IGRF-14"
    mounting: Mounting = field(default_factory=Mounting)
    plane: Any = "field"
    calibration: Any = "none"
    use_yaw: bool = True
    steady_s: float | None = None
    reeled: bool = False
    lengths: TetherLengths | None = None
    end_mass_kg: float | None = None
    tether_kg_m: float | None = None
    swing: float | str | None = None

    def __post_init__(self):
        _check_number("tether_length_m", self.tether_length_m, LENGTH_M, "m")
        if self.frequency_hz is not None:
            _check_number("frequency_hz", self.frequency_hz, FREQUENCY_HZ, "Hz")
        if self.steady_s is not None:
            _check_number("steady_s", self.steady_s, STEADY_S, "s")
        if self.method not in METHODS:
            raise InputError(f'method "{self.method}" is not known; {nearest(str(self.method), METHODS)}')
        if not isinstance(self.calibration, Calibration) and self.calibration not in ("none", "auto", "bias", "full"):
            raise InputError(f"calibration must be none, auto, bias, full or a Calibration; got {self.calibration!r}.")
        if self.steady_s is not None and self.method != "harmonic":
            raise InputError(
                f'steady_s, the memory of the harmonic fit, needs method "harmonic"; got "{self.method}". Leave it out.'
            )
        if self.reeled and self.method != "kalman":
            raise InputError(f'reeled, a frequency that runs, needs method "kalman"; got "{self.method}".')
        if self.reeled and self.lengths is not None:
            raise InputError("reeled lets the frequency run where the length is not known; with lengths leave it out.")
        if (self.end_mass_kg is None) != (self.tether_kg_m is None):
            raise InputError("end_mass_kg and tether_kg_m are of use together: give both, or neither.")
        if self.end_mass_kg is not None:
            _check_number("end_mass_kg", self.end_mass_kg, MASS_KG, "kg")
            _check_number("tether_kg_m", self.tether_kg_m, LINEAR_KG_M, "kg/m")
        if self.swing is not None and self.swing != "found":
            _check_number("swing", self.swing, FREQUENCY_HZ, 'Hz, or "found"')
        plane_of(self.plane)

    @property
    def ratio_m(self) -> float | None:
        """[m] end mass over mass per length."""
        return None if self.end_mass_kg is None or self.tether_kg_m is None else self.end_mass_kg / self.tether_kg_m

    @property
    def averages(self) -> bool:
        """Whether rows that come fast are averaged over seconds."""
        return self.frequency_hz is None or self.frequency_hz < FASTEST_AVERAGED_HZ

    def described(self) -> dict:
        """For the record, plain types."""
        calibration = self.calibration.summary() if isinstance(self.calibration, Calibration) else self.calibration
        return {
            "tether_length_m": float(self.tether_length_m),
            "frequency_hz": None if self.frequency_hz is None else float(self.frequency_hz),
            "method": self.method,
            "model": self.model if isinstance(self.model, str) else self.model.name,
            "plane": plane_of(self.plane).word,
            "calibration": calibration,
            "use_yaw": self.use_yaw,
            "reeled": self.reeled,
            "steady_s": None if self.steady_s is None else float(self.steady_s),
            "lengths": None if self.lengths is None else self.lengths.described(),
            "end_mass_kg": None if self.end_mass_kg is None else float(self.end_mass_kg),
            "tether_kg_m": None if self.tether_kg_m is None else float(self.tether_kg_m),
            "swing": self.swing if self.swing is None or isinstance(self.swing, str) else float(self.swing),
            **self.mounting.described(),
        }


class HalfTurned(NamedTuple):
    """Azimuth [rad] (m,) and place [m] (m, 2) of the tether's middle, on the side on which the tether is."""

    plane_rad: np.ndarray
    position_m: np.ndarray


class Solved(NamedTuple):
    """An estimate with all that it was made of."""

    rows: Rows
    reference: Reference
    calibration: Calibration | None
    signals: SkipropeSignals
    estimate: SkipropeEstimate
    plane: Plane
    crossings: Crossings
    yaw_used: bool
    remarks: tuple[str, ...]
    half_turned: HalfTurned


def solve_rows(rows: Rows, orbit: Orbit | None, settings: SkipropeSettings, report=None) -> Solved:
    """The skiprope of rows in rising time; the orbit is that of their own positions where None is given.

    Errors: InputError for input that cannot be used; NoEstimateError where there is too little of it.
    """
    report = report or (lambda stage, done, total, words="": None)
    good = np.isfinite(rows.field_s).all(axis=1)
    if good.sum() < FEWEST:
        raise NoEstimateError(
            f"only {int(good.sum())} samples with a field, and {FEWEST} are needed at least. Give a longer record."
        )
    report("field", 0, 1, "")
    orbit = orbit or _own_orbit(rows)
    rows = rows.where(orbit.covers(rows.time_utc) if orbit.kind == "positions" else slice(None))
    reference = reference_along_orbit(rows.time_utc, orbit, settings.model)
    report("field", 1, 1, f"{reference.model} along {reference.orbit['kind']}")
    calibration, field_s = _calibrated(rows, reference, settings)
    yaw_used = settings.use_yaw and bool(np.isfinite(rows.yaw_rad).any())
    yaw = _whole(rows) if yaw_used else None
    measured, known = settings.mounting.field_c(field_s, yaw), _known(reference)
    remarks = (*_judge_size(measured, known), *_judge_direction(field_s, measured, known, yaw, settings))
    seconds = (rows.time_utc - rows.time_utc[0]).astype(np.int64) * 1e-9
    signals = skiprope_signals(seconds, measured, known)
    remarks += _judge_length(signals.span_s, settings.frequency_hz)
    if settings.lengths is not None:
        remarks += settings.lengths.beyond(rows.time_utc)
    report(settings.method, 0, 1, "")
    estimate, words = swing_taken_off(_estimated(signals, rows, reference, settings, yaw_used), settings.swing)
    remarks += words
    if settings.frequency_hz is None and not estimate.detected:
        remarks += _below_the_band(signals)
    plane = plane_of(settings.plane)
    crossings = next_crossings(estimate, signals, plane, settings.mounting.half_turn_rad)
    report(settings.method, 1, 1, f"{len(estimate.seconds)} rows" if estimate.detected else "nothing found")
    turned = _half_turned(estimate, settings.mounting)
    return Solved(rows, reference, calibration, signals, estimate, plane, crossings, yaw_used, remarks, turned)


def _estimated(signals: SkipropeSignals, rows: Rows, reference: Reference, settings: SkipropeSettings, yaw_used: bool):
    """The estimate of a tether of one length, or of lengths."""
    from fieldline.estimation.skiprope.estimate import estimate_skiprope

    motion = _mean_motion(reference)
    given = {
        "frequency_hz": settings.frequency_hz,
        "method": settings.method,
        "yaw_rad": 0.0 if yaw_used else None,  # the measured one is taken out already
        "memory_s": settings.steady_s,
    }
    if settings.lengths is not None:
        ns = (1e9 * signals.seconds).astype(np.int64).astype("timedelta64[ns]")
        length = settings.lengths.at(rows.time_utc[0] + ns)
        return estimate_reeled(signals, length, mean_motion_rad_s=motion, ratio_m=settings.ratio_m, **given)
    length_m = float(settings.tether_length_m)
    band = line_band(length_m, motion, settings.ratio_m)
    return estimate_skiprope(signals, tether_length_m=length_m, band_hz=band, reeled=settings.reeled, **given)


def _mean_motion(reference: Reference) -> float:
    """[rad/s] at which the satellite goes round, in the median."""
    r, v = reference.position_i, reference.velocity_i
    return float(np.nanmedian(np.linalg.norm(np.cross(r, v), axis=1) / np.sum(r * r, axis=1)))


def _half_turned(estimate: SkipropeEstimate, mounting: Mounting) -> HalfTurned:
    """The estimate takes the tether's middle half a turn from the lean; where the tether goes up it is on the lean's side."""
    if mounting.half_turn_rad:
        return HalfTurned(estimate.plane_rad, estimate.position_m)
    return HalfTurned(estimate.plane_rad - np.copysign(np.pi, estimate.plane_rad), -estimate.position_m)


def _own_orbit(rows: Rows) -> Orbit:
    """The orbit through the rows' own positions."""
    if not np.isfinite(rows.position_e).any():
        raise InputError("no orbit: the telemetry has no position columns either. Give a TLE, OMM or OEM file (--orbit).")
    return orbit_from_positions(rows.time_utc, rows.position_e)


def _known(reference: Reference) -> np.ndarray:
    """(n, 3) [T] the model's field in the axes of the cone."""
    from fieldline.frames.orbital import dcm_oi

    return np.einsum("nij,nj->ni", dcm_oi(reference.position_i, reference.velocity_i), reference.field_i) @ ORBITAL_FROM_CONE


def _calibrated(rows: Rows, reference: Reference, settings: SkipropeSettings) -> tuple[Calibration | None, np.ndarray]:
    """The calibration that was given or found, and the field (n, 3) [T] in sensor axes."""
    if isinstance(settings.calibration, str) and settings.calibration == "none":
        return None, rows.field_s
    telemetry = telemetry_of(rows.time_utc, rows.field_s)
    found = settings.calibration
    if not isinstance(found, Calibration):
        found = calibrate_against([telemetry], [reference], calibration=found, use=())[0]
    columns = columns_for(found, telemetry, reference)
    return found, found.apply(telemetry.seconds, telemetry.field_s, epoch_utc=telemetry.epoch_utc, **columns)


def _whole(rows: Rows) -> np.ndarray:
    """(n,) [rad] the measured yaw, carried over rows without one."""
    good = np.isfinite(rows.yaw_rad)
    ns = (rows.time_utc - rows.time_utc[0]).astype(np.int64)
    return np.interp(ns, ns[good], np.unwrap(rows.yaw_rad[good]))


def _judge_length(span_s: float, frequency_hz: float | None) -> tuple[str, ...]:
    """A remark on what a short record cannot show; NoEstimateError where the given frequency is among it."""
    if frequency_hz is not None and span_s * frequency_hz < FEWEST_PERIODS:
        raise NoEstimateError(
            f"the record holds {span_s:.0f} s, {span_s * frequency_hz:.1f} periods of {frequency_hz:.4g} Hz; {FEWEST_PERIODS} "
            "are needed at least. Give a longer record."
        )
    slowest_hz = FEWEST_PERIODS / span_s
    if slowest_hz <= SLOW_HZ:
        return ()
    return (f"The record holds {span_s:.0f} s: a skiprope slower than {1e3 * slowest_hz:.3g} mHz would not be seen in it.",)


def _below_the_band(signals: SkipropeSignals) -> tuple[str, ...]:
    """A hint at what turns slower than the band that is searched, where slow errors of the known field may look like it."""
    try:
        line = detect(signals, band_hz=BELOW_HZ).cone
    except NoEstimateError:
        return ()
    if line is None or line.amplitude_rad < WORTH_A_HINT_RAD or abs(line.turning) < LEAST_TURNING:
        return ()
    return (
        f"Something turns at {1e3 * line.frequency_hz:.3g} mHz with {np.degrees(line.amplitude_rad):.2g} deg, below the band "
        f"that is searched: a slow error of the field, or a long tether. If it skips there, say --frequency-hz "
        f"{line.frequency_hz:.2g}.",
    )


def _judge_size(measured: np.ndarray, known: np.ndarray) -> tuple[str, ...]:
    """Remarks on the size of the measured field; NoEstimateError where it cannot be the known one's."""
    b, known_b = np.linalg.norm(measured, axis=1), np.linalg.norm(known, axis=1)
    ratio = b / known_b
    share = float(np.nanmedian(np.abs(ratio - 1.0)))
    if share > LARGEST_SHARE:
        raise NoEstimateError(
            f"No estimate: the measured field is {np.nanmedian(ratio):.2f} times the model's in the median, off by "
            f"{100 * share:.0f} %. Check the unit, the time stamps (UTC), the orbit; a biased magnetometer is mended by "
            "--calibration bias, or a file of `fieldline calibrate`."
        )
    spread = float(np.nanstd(ratio))
    if spread > 0.03:
        return (
            f"The measured field's size scatters by {100 * spread:.0f} % about the model's: the magnetometer is not calibrated, "
            "or the orbit is not its own. Try --calibration bias.",
        )
    return ()


def _judge_direction(field_s, measured, known, yaw, settings: SkipropeSettings) -> tuple[str, ...]:
    """NoEstimateError where the measured direction is nowhere near the known one, with the axes that would fit."""
    off = _off_deg(measured, known)
    if off <= LARGEST_MISFIT_DEG:
        if off > 10.0:
            return (f"Measured and known direction of the field are {off:.0f} deg apart in the median: is --attitude-deg right?",)
        return ()
    best, words = off, ""
    for axes in _all_axes():
        turned = Mounting(sensor_axes=axes, attitude_deg=settings.mounting.attitude_deg).field_c(field_s, yaw)
        if (angle := _off_deg(turned, known)) < best:
            best, words = angle, axes
    hint = f' With --sensor-axes="{words}" it would be {best:.0f} deg.' if best < 0.5 * off and best <= LARGEST_MISFIT_DEG else ""
    raise NoEstimateError(
        f"No estimate: the measured field points {off:.0f} deg away from the known one in the median. Check that the satellite "
        f"points at the Earth as --attitude-deg says, the sensor's axes, the time stamps (UTC) and the orbit.{hint}"
    )


def _off_deg(measured: np.ndarray, known: np.ndarray) -> float:
    """[deg] median angle between rows."""
    turned = np.linalg.norm(np.cross(measured, known), axis=1)
    return float(np.degrees(np.nanmedian(np.arctan2(turned, np.sum(measured * known, axis=1)))))


def _all_axes():
    """The twenty-four ways in which axes can be swapped and turned."""
    for order in itertools.permutations("xyz"):
        for signs in itertools.product(("", "-"), repeat=3):
            words = ",".join(sign + axis for sign, axis in zip(signs, order, strict=True))
            even = "".join(order) in "xyzxy"
            if (signs.count("-") % 2 == 0) == even:
                yield words


def _check_number(name: str, value, within: tuple[float, float], unit: str) -> None:
    """Refuse what is no number within the range."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not within[0] <= value <= within[1]:
        raise InputError(f"{name} must be a number from {within[0]:g} to {within[1]:g} {unit}; got {value!r}.")
