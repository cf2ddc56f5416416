"""From signals to a skiprope, by one of several methods, or the word that there is none.

1. `detect` says whether there is a cone and at which frequency, unless a first frequency is given.
2. The method finds phasors over time: "harmonic" by least squares in windows (`harmonic`), "kalman" by a filter that
   hears each sample once (`by_kalman`), "bandpass" by the rules of TP-3123 (`reading`).
3. The yaw turns them to (U, V). A magnetometer sees yaw a3 and azimuth error d of the known field as one, s = a3 + d. Of a
   measured yaw only its own error remains: the phasors lie along the body's axes, and no azimuth of the field is needed. Else
   the share that is yaw follows from how large either is wont to be,

       a3 = s sy^2 / (sy^2 + sd^2),   left uncertain: sy sd / sqrt(sy^2 + sd^2)                                      (1)

   which is the floor of the plane angle: 1.9 deg for a yaw of 5 deg and an azimuth of 2. The bandpass rule of TP-3123 takes the
   field's azimuth for true: its floor is sd.

Errors: `InputError` for arguments; `NoEstimateError` where the record is too short or the known field is not the measured one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, NoEstimateError, nearest
from fieldline.estimation.skiprope.bandpass import positive
from fieldline.estimation.skiprope.by_bandpass import bandpass_track
from fieldline.estimation.skiprope.by_harmonic import harmonic_track
from fieldline.estimation.skiprope.by_kalman import kalman_track
from fieldline.estimation.skiprope.lines import NEAR, beside, crowded, line_given
from fieldline.estimation.skiprope.numbers import derived
from fieldline.estimation.skiprope.reading import FieldKnowledge
from fieldline.estimation.skiprope.rotary import BAND_HZ, Detection, detect
from fieldline.estimation.skiprope.signals import SkipropeSignals
from fieldline.estimation.skiprope.solution import SkipropeEstimate
from fieldline.estimation.skiprope.track import Track
from fieldline.estimation.skiprope.words import none_of, notes_of, verdict_of

METHODS = ("harmonic", "kalman", "bandpass")
RULES = ("paper", "corrected")
USUAL = FieldKnowledge(scale=0.03, elevation_rad=np.radians(2.0), azimuth_rad=np.radians(2.0))
YAW_STD_RAD = np.radians(5.0)  # of a body that keeps its yaw near zero
MEASURED_YAW_STD_RAD = np.radians(0.5)
WORST_FIELD_RAD = np.radians(40.0)
ROWS_PER_PERIOD = 20
BINS = 100  # in a period of the band's upper end: fine enough for motions five times as fast
REELED_S = 1500.0  # in which the first frequency of a tether on the reel is sought
SURE = 0.5  # largest standard deviation of a trusted amplitude, of the amplitude


class Settings(NamedTuple):
    """What a method is told besides the signals."""

    frequency_hz: float  # first
    resolution_hz: float  # to which it is known
    pendulous_hz: tuple[float, ...]  # of motions carried beside the cone, the strongest first
    crowded_hz: tuple[float, ...]  # of close ones that a filter which carries the strongest alone leaves out
    damping: float
    memory_s: float | None
    rule: str
    knowledge: FieldKnowledge
    yaw_measured: bool
    reeled: bool


def estimate_skiprope(
    signals: SkipropeSignals,
    *,
    tether_length_m: float,
    frequency_hz: float | None = None,
    method: str = "harmonic",
    yaw_rad=None,
    yaw_std_rad: float | None = None,
    knowledge: FieldKnowledge = USUAL,
    band_hz: tuple[float, float] = BAND_HZ,
    false_alarm: float = 0.01,
    damping: float = 0.1,
    rule: str = "paper",
    memory_s: float | None = None,
    step_s: float | None = None,
    reeled: bool = False,
) -> SkipropeEstimate:
    """The skiprope over the record's time.

    Parameters
    ----------
    signals : of `skiprope_signals`, (n,) samples.
    tether_length_m : length [m] of the tether between the two bodies.
    frequency_hz : a first frequency [Hz], good to a factor of two (`lines`); found from the spectrum by default, within
        `band_hz` (low, high) [Hz].
    method : "harmonic", "kalman" or "bandpass".
    yaw_rad : the body's yaw a3 as measured, one number or (n,) [rad], with its deviation `yaw_std_rad` (0.5 deg). Without it,
        yaw_std_rad is how far the yaw is wont to be from zero (5 deg).
    knowledge : standard deviations of the known field (3 %, 2 deg, 2 deg).
    false_alarm : probability with which noise alone is taken for a skiprope.
    damping, rule : of the bandpass; "paper" takes the field's azimuth now, "corrected" when the filter heard it, and uses
        a measured yaw.
    memory_s : [s] over which the ellipse is steady (ten periods).
    reeled : the tether is paid out or taken in, so that size and frequency run (Kalman filter alone): the first frequency is
        sought in the record's first 25 minutes, and the filter lets both run.
    step_s : [s] between the rows of the answer (a twentieth of a period).

    Returns
    -------
    SkipropeEstimate; `detected` False, with empty arrays and the threshold, where there is no skiprope.
    """
    if method not in METHODS:
        raise InputError(f"method: {nearest(str(method), METHODS)} Got {method!r}.")
    if rule not in RULES:
        raise InputError(f"rule must be one of {', '.join(RULES)}; got {rule!r}.")
    if reeled and method != "kalman":
        raise InputError(f'a tether on the reel needs method="kalman", which lets the frequency run; got {method!r}.')
    length = positive("tether_length_m", tether_length_m)
    measured = yaw_rad is not None
    yaw = _yaw(yaw_rad, signals)
    turned = signals.turned(yaw) if measured else signals
    fastest = max(band_hz[1], frequency_hz or 0.0, BAND_HZ[1])
    coarse = turned.thinned(1.0 / (BINS * fastest))
    off_rad = _disagreement(coarse)
    sought = coarse.between(coarse.seconds[0], coarse.seconds[0] + REELED_S) if reeled else coarse
    band = _band(frequency_hz, band_hz)
    found = detect(sought, band_hz=band, highest_hz=5.0 * max(band[1], BAND_HZ[1]), false_alarm=false_alarm)
    line = found.cone if frequency_hz is None else line_given(found, positive("frequency_hz", frequency_hz))
    found = found._replace(cone=line, others=tuple(other for other in found.lines if other is not line))
    if line is None:
        return _nothing(method, length, found, signals, frequency_hz)
    others = beside(found, line)
    left_out = crowded(found, line, others[0] if others else None)
    settings = Settings(
        line.frequency_hz, found.resolution_hz, others, left_out, damping, memory_s, rule, knowledge, measured, reeled
    )
    rows = _rows(signals, line.frequency_hz, step_s)
    track = TRACKS[method](turned if method == "bandpass" else coarse, rows, settings)
    deviation = (MEASURED_YAW_STD_RAD if measured else YAW_STD_RAD) if yaw_std_rad is None else float(yaw_std_rad)
    if measured:
        turn = np.interp(rows, signals.seconds, yaw)
        turn_std = np.full(len(rows), deviation if track.along_body else np.hypot(deviation, knowledge.azimuth_rad))
    else:
        turn, turn_std = _shared(track, deviation, knowledge.azimuth_rad)
    numbers = derived(track.phasor, track.covariance, track.sense, turn, turn_std, length)
    trusted = (rows >= track.trusted_from_s) & (numbers["amplitude_std_rad"] < SURE * numbers["amplitude_rad"])
    return SkipropeEstimate(
        method=method,
        tether_length_m=length,
        detected=True,
        detection=found,
        trusted_from_s=float(rows[trusted.argmax()]) if trusted.any() else np.nan,
        verdict=verdict_of(numbers, track, trusted),
        notes=(*notes_of(signals, found, line, off_rad, turn_std, frequency_hz), *track.notes),
        seconds=rows,
        trusted=trusted,
        phasor=track.phasor,
        covariance=track.covariance,
        frequency_hz=track.frequency_hz,
        frequency_std_hz=track.frequency_std_hz,
        sense=track.sense,
        yaw_rad=turn,
        yaw_std_rad=turn_std,
        azimuth_off_rad=track.azimuth_off_rad,
        **numbers,
    )


TRACKS = {"harmonic": harmonic_track, "kalman": kalman_track, "bandpass": bandpass_track}


def _shared(track: Track, yaw_std: float, azimuth_std: float) -> tuple[np.ndarray, np.ndarray]:
    """The yaw of (1) and what is left uncertain; nothing to be shared where the track is not along the body's axes."""
    if not track.along_body:
        return np.zeros(len(track.phasor)), np.full(len(track.phasor), azimuth_std)
    both = np.hypot(yaw_std, azimuth_std)
    share, floor = ((yaw_std / both) ** 2, yaw_std * azimuth_std / both) if both > 0.0 else (1.0, 0.0)
    return share * track.azimuth_off_rad, np.full(len(track.phasor), floor)  # (1)


def _nothing(method: str, length: float, found: Detection, signals: SkipropeSignals, given_hz: float | None) -> SkipropeEstimate:
    """The answer that there is no skiprope."""
    empty = np.empty(0)
    none = derived(np.empty((0, 2), dtype=complex), np.empty((0, 4, 4)), empty.astype(int), empty, empty, length)
    return SkipropeEstimate(
        method=method,
        tether_length_m=length,
        detected=False,
        detection=found,
        trusted_from_s=np.nan,
        verdict=none_of(found, given_hz),
        notes=notes_of(signals, found, None, 0.0, empty, given_hz),
        seconds=empty,
        trusted=empty.astype(bool),
        phasor=np.empty((0, 2), dtype=complex),
        covariance=np.empty((0, 4, 4)),
        frequency_hz=empty,
        frequency_std_hz=empty,
        sense=empty.astype(int),
        yaw_rad=empty,
        yaw_std_rad=empty,
        azimuth_off_rad=empty,
        **none,
    )


def _yaw(yaw_rad, signals: SkipropeSignals) -> np.ndarray:
    """(n,) the yaw as given, zeros without."""
    yaw = np.asarray(0.0 if yaw_rad is None else yaw_rad, dtype=float)
    if yaw.ndim > 1 or (yaw.ndim == 1 and len(yaw) != len(signals.seconds)) or not np.isfinite(yaw).all():
        raise InputError(f"yaw_rad must be one number or one for each of the {len(signals.seconds)} samples, all finite.")
    return np.broadcast_to(yaw, signals.seconds.shape)


def _disagreement(signals: SkipropeSignals) -> float:
    """[rad] median angle between measured and known field; a refusal where they are not the same field."""
    along = np.sum(signals.direction_b * signals.direction_c, axis=1)
    off = float(np.median(np.arccos(np.clip(along, -1.0, 1.0))))
    if off > WORST_FIELD_RAD:
        raise NoEstimateError(
            f"the measured field lies {np.degrees(off):.0f} deg off the known one (median): check the orbit, the times, the "
            "sensor's axes and signs, and the yaw; a cone is small against this."
        )
    return off


def _band(frequency_hz: float | None, band_hz) -> tuple[float, float]:
    """The band to search, with a given frequency in it."""
    if frequency_hz is None:
        return band_hz
    near = positive("frequency_hz", frequency_hz)
    return min(band_hz[0], (1.0 - NEAR) * near), max(band_hz[1], (1.0 + NEAR) * near)


def _rows(signals: SkipropeSignals, frequency_hz: float, step_s: float | None) -> np.ndarray:
    """(m,) times of the answer's rows, the last at the record's end or less than a step before it."""
    step = 1.0 / (ROWS_PER_PERIOD * frequency_hz) if step_s is None else positive("step_s", step_s)
    return signals.seconds[0] + step * np.arange(int(signals.span_s / step + 1e-9) + 1)
