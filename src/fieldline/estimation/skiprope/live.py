"""The skiprope sample by sample, as a stream brings them: what a crew watches, and what flight software runs.

    live = LiveSkiprope(tether_length_m=20e3, method="kalman")
    for seconds, field_b, field_c in stream:
        now = live.update(seconds, field_b, field_c)         # LiveEstimate
    arrays = live.state()                                    # to a file
    live = LiveSkiprope.resumed(arrays)                      # goes on bit for bit as if it had never stopped

Two things go on side by side. The last 50 minutes, averaged in bins, are searched for a cone when enough of them are in and then
every `check_s` (`rotary`): that says whether there is one, and finds the frequency where none is given. The filter, `kalman_step`
or `bandpass_step`, starts when a frequency is known (the Kalman filter: when that of the pendulous motion is, too); after a
search it first hears the bins from their start. A Kalman filter that is lost by the time of a search is started anew.

A sample that is not finite, or not later than the one before, changes nothing and is counted. Everything that is remembered
lies in arrays of fixed size.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from math import cos, hypot, isfinite, nan, sin
from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, NoEstimateError, nearest
from fieldline.estimation.skiprope import bandpass_step, kalman_step
from fieldline.estimation.skiprope.bandpass import positive
from fieldline.estimation.skiprope.by_kalman import LOST, REELED, SETTLED, KalmanSettings
from fieldline.estimation.skiprope.estimate import MEASURED_YAW_STD_RAD, REELED_S, RULES, USUAL, YAW_STD_RAD
from fieldline.estimation.skiprope.lines import NEAR, beside, crowded, line_given
from fieldline.estimation.skiprope.numbers import NUMBERS, cone_numbers
from fieldline.estimation.skiprope.reading import FieldKnowledge
from fieldline.estimation.skiprope.rotary import BAND_HZ, Detection, detect
from fieldline.estimation.skiprope.signals import skiprope_signals
from fieldline.estimation.skiprope.solution import PlaneCrossings, plane_crossings

LIVE_METHODS = ("kalman", "bandpass")
BUFFER_S = 3000.0
BINS_PER_PERIOD = 20  # of the fastest motion looked for
FIRST_CHECK_S = 900.0
FIRST_CHECK_PERIODS = 4.0  # of a given frequency
CHECK_S = 300.0


class LiveEstimate(NamedTuple):
    """What is known at a sample's time; NaN before anything is. Angles as in `SkipropeEstimate`."""

    seconds: float
    used: bool  # the sample: False where it was not finite, not later than the last, or too far off
    detected: bool  # by the last search; with a given frequency also before the first one
    trusted: bool
    sense: int
    frequency_hz: float
    frequency_std_hz: float
    amplitude_rad: float
    amplitude_std_rad: float
    major_rad: float
    major_std_rad: float
    minor_rad: float
    minor_std_rad: float
    phase_rad: float
    phase_std_rad: float
    plane_rad: float
    plane_std_rad: float
    deflection_m: float
    deflection_std_m: float
    u_m: float
    v_m: float
    u_variance_m2: float
    uv_covariance_m2: float
    v_variance_m2: float


HEAD = (
    "last_s", "first_s", "next_check_s", "detected", "searched", "running", "bin_start_s", "bin_count", "bins",
    "repeated", "bad", "outliers", "samples", "restarts", "threshold_rad", "yaw_rad", "crowded",
)  # fmt: skip


class LiveSkiprope:
    """See the module. All numbers that change lie in three float arrays: `_head`, `_memory`, `_bins`."""

    def __init__(
        self, *, tether_length_m: float, method: str = "kalman", frequency_hz: float | None = None,
        pendulous_hz: float | None = None, yaw_std_rad: float | None = None, yaw_measured: bool = False,
        knowledge: FieldKnowledge = USUAL, band_hz: tuple[float, float] = BAND_HZ, false_alarm: float = 0.01,
        damping: float = 0.1, rule: str = "paper", check_s: float = CHECK_S, reeled: bool = False,
    ):  # fmt: skip
        """Nothing heard yet. Arguments as those of `estimate_skiprope`.

        frequency_hz, pendulous_hz : first frequencies [Hz]; searched for by default. yaw_measured : `update` will be given the
        yaw [rad]. check_s : between two searches. reeled : searches hear the last 25 minutes alone.
        """
        if method not in LIVE_METHODS:
            raise InputError(f"method: {nearest(str(method), LIVE_METHODS)} Got {method!r}.")
        if rule not in RULES:
            raise InputError(f"rule must be one of {', '.join(RULES)}; got {rule!r}.")
        self._settings = {
            "tether_length_m": positive("tether_length_m", tether_length_m),
            "method": method,
            "frequency_hz": None if frequency_hz is None else positive("frequency_hz", frequency_hz),
            "pendulous_hz": None if pendulous_hz is None else positive("pendulous_hz", pendulous_hz),
            "yaw_std_rad": yaw_std_rad,
            "yaw_measured": bool(yaw_measured),
            "knowledge": tuple(knowledge),
            "band_hz": tuple(band_hz),
            "false_alarm": false_alarm,
            "damping": damping,
            "rule": rule,
            "reeled": bool(reeled),
            "check_s": positive("check_s", check_s),
        }
        self._kalman = method == "kalman"
        self._bin_s = 1.0 / (BINS_PER_PERIOD * 2.5 * band_hz[1])
        self._head = dict.fromkeys(HEAD, 0.0) | {"last_s": nan, "threshold_rad": nan}
        self._memory = np.zeros(kalman_step.SIZE if self._kalman else bandpass_step.SIZE)
        self._bins = np.zeros((int(BUFFER_S / self._bin_s) + 1, 7))
        self._sums = np.zeros(7)
        self._params = np.zeros(len(kalman_step.PARAMETERS if self._kalman else bandpass_step.PARAMETERS))
        self._work = (np.empty(4), np.empty((4, 4)), np.empty(len(NUMBERS)), np.empty(3), np.empty(3))
        self.detection: Detection | None = None  # of the last search

    @property
    def counts(self) -> dict[str, int]:
        """Samples heard, repeated or going backwards, not finite, passed over as too far off; starts after a filter was lost."""
        return {name: int(self._head[name]) for name in ("samples", "repeated", "bad", "outliers", "restarts")}

    @property
    def threshold_rad(self) -> float:
        """[rad] a round cone that the last search would have found; NaN before it."""
        return self._head["threshold_rad"]

    def update(self, seconds: float, field_b, field_c, yaw_rad: float = 0.0) -> LiveEstimate:
        """Take in a sample: time [s], the measured field (3,) [T], body axes, the known one, axes (U, V, W), the measured yaw."""
        head = self._head
        b1, b2, b3 = field_b
        u, v, w = field_c
        if not isfinite(seconds + b1 + b2 + b3 + u + v + w + yaw_rad):
            head["bad"] += 1.0
            return self._answer(head["last_s"], False)
        if seconds <= head["last_s"]:
            head["repeated"] += 1.0
            return self._answer(head["last_s"], False)
        if self._settings["yaw_measured"]:
            c, s = cos(yaw_rad), sin(yaw_rad)
            u, v = c * u + s * v, c * v - s * u
            head["yaw_rad"] = yaw_rad
        if head["samples"] == 0.0:
            head["first_s"] = head["bin_start_s"] = seconds
            head["next_check_s"] = seconds + self._first_check_s()
            if self._settings["frequency_hz"] is not None and (not self._kalman or self._settings["pendulous_hz"] is not None):
                self._start(self._settings["frequency_hz"], self._settings["pendulous_hz"])
        head["samples"] += 1.0
        head["last_s"] = seconds
        measured, known = self._work[3], self._work[4]
        measured[0], measured[1], measured[2] = b1, b2, b3
        known[0], known[1], known[2] = u, v, w
        self._average(seconds, measured, known)
        used = True
        if head["running"]:
            used = bool(self._step(seconds, measured, known))
            head["outliers"] += 0.0 if used else 1.0
        if seconds >= head["next_check_s"]:
            self._check(seconds)
        return self._answer(seconds, used)

    def crossings(self, plane_rad: float, count: int = 3) -> PlaneCrossings | None:
        """Next crossings of a vertical plane after the last sample, as `SkipropeEstimate.crossings`; None before an estimate."""
        now = self._answer(self._head["last_s"], False)
        if not isfinite(now.amplitude_rad):
            return None
        part, covariance = self._work[0], self._work[1]
        phasor = np.array([[complex(part[0], part[1]), complex(part[2], part[3])]])
        yaw, yaw_std = self._yaw()
        frequency = (np.array([now.frequency_hz]), np.array([now.frequency_std_hz]))
        row = plane_crossings(
            np.array([now.seconds]), phasor, covariance[None], frequency, (np.array([yaw]), np.array([yaw_std])), plane_rad, count
        )
        return PlaneCrossings(seconds=row.seconds[0], std_s=row.std_s[0], towards=row.towards[0])

    def state(self) -> dict[str, np.ndarray]:
        """Everything remembered, as arrays that `numpy.savez` takes; see `resumed`."""
        return {
            "settings_json": np.array(json.dumps(self._settings)),
            "head": np.array([self._head[name] for name in HEAD]),
            "memory": self._memory.copy(),
            "params": self._params.copy(),
            "bins": self._bins.copy(),
            "sums": self._sums.copy(),
        }

    @classmethod
    def resumed(cls, arrays: Mapping[str, np.ndarray]) -> LiveSkiprope:
        """Go on from `state`; InputError for arrays that are not one."""
        try:
            settings = json.loads(str(arrays["settings_json"]))
            settings["knowledge"] = FieldKnowledge(*settings["knowledge"])
            settings["band_hz"] = tuple(settings["band_hz"])
            live = cls(**settings)
            for name in ("memory", "params", "bins", "sums"):
                own, given = getattr(live, f"_{name}"), np.asarray(arrays[name], dtype=float)
                if own.shape != given.shape:
                    raise ValueError(f"{name} {given.shape}")
                own[...] = given
            live._head = dict(zip(HEAD, np.asarray(arrays["head"], dtype=float).tolist(), strict=True))
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(f"this is no state of a live skiprope estimator ({error}); start without it.") from error
        return live

    def _first_check_s(self) -> float:
        """[s] from the start to the first search."""
        given = self._settings["frequency_hz"]
        return FIRST_CHECK_S if given is None else min(FIRST_CHECK_PERIODS / given, BUFFER_S)

    def _average(self, seconds: float, measured, known) -> None:
        """A sample into its bin, full bins into the ring."""
        head, sums = self._head, self._sums
        if head["bin_count"] and seconds >= head["bin_start_s"] + self._bin_s:
            self._bins[int(head["bins"]) % len(self._bins)] = sums / head["bin_count"]
            head["bins"] += 1.0
            head["bin_count"] = 0.0
            sums[:] = 0.0
            head["bin_start_s"] += self._bin_s * int((seconds - head["bin_start_s"]) / self._bin_s)
        sums[0] += seconds - head["first_s"]
        sums[1:4] += measured
        sums[4:7] += known
        head["bin_count"] += 1.0

    def _kept(self) -> np.ndarray:
        """(k, 7) the bins in the ring, oldest first: time since the first sample, measured and known field."""
        count, size = int(self._head["bins"]), len(self._bins)
        return np.roll(self._bins, -(count % size), axis=0) if count > size else self._bins[:count]

    def _check(self, seconds: float) -> None:
        """Search what is kept for a cone; start the filter by it where none runs."""
        head, given = self._head, self._settings["frequency_hz"]
        head["next_check_s"] = seconds + self._settings["check_s"]
        rows = self._kept()
        kept_s = REELED_S if self._settings["reeled"] else BUFFER_S
        rows = rows[rows[:, 0] >= seconds - head["first_s"] - kept_s]
        low, high = self._settings["band_hz"]
        band = (low, high) if given is None else (min(low, (1.0 - NEAR) * given), max(high, (1.0 + NEAR) * given))
        try:
            found = detect(
                skiprope_signals(rows[:, 0], rows[:, 1:4], rows[:, 4:7]), band_hz=band, false_alarm=self._settings["false_alarm"]
            )
        except NoEstimateError:
            return
        line = found.cone if given is None else line_given(found, given)
        self.detection = found._replace(cone=line, others=tuple(one for one in found.lines if one is not line))
        head["searched"], head["detected"] = 1.0, float(line is not None)
        inside = (found.frequency_hz >= band[0]) & (found.frequency_hz <= band[1])
        head["threshold_rad"] = float(np.median(found.threshold_rad[inside]))
        if line is None or (head["running"] and not self._lost()):
            return
        head["restarts"] += head["running"]
        swing = beside(self.detection, line)
        head["crowded"] = float(self._kalman and bool(crowded(self.detection, line, swing[0] if swing else None)))
        self._start(line.frequency_hz, swing[0] if swing else self._settings["pendulous_hz"])
        for row in rows:
            self._step(head["first_s"] + row[0], row[1:4].copy(), row[4:7].copy())

    def _lost(self) -> bool:
        """Whether the Kalman filter no longer follows what it hears."""
        return self._kalman and bool(self._memory[kalman_step.MEAN_NIS] > LOST)

    def _start(self, frequency_hz: float, pendulous_hz: float | None) -> None:
        """The filter's parameters, from the frequencies."""
        settings = self._settings
        if self._kalman:
            self._params[:] = (REELED if settings["reeled"] else KalmanSettings()).packed(frequency_hz, pendulous_hz)
        else:
            corrected = settings["rule"] == "corrected"
            self._params[:] = (frequency_hz, settings["damping"], corrected, corrected and settings["yaw_measured"])
        self._memory[:] = 0.0
        self._head["running"] = 1.0

    def _step(self, seconds: float, measured, known) -> bool:
        """One sample into the filter."""
        if self._kalman:
            return kalman_step.kalman_update(seconds, measured, known, self._memory, self._params)
        return bandpass_step.bandpass_update(seconds, measured, known, self._memory, self._params)

    def _yaw(self) -> tuple[float, float]:
        """The yaw to turn by, and its deviation: (1) of `estimate`."""
        settings = self._settings
        azimuth, given = settings["knowledge"][2], settings["yaw_std_rad"]
        body = self._kalman or (settings["rule"] == "corrected" and settings["yaw_measured"])
        if settings["yaw_measured"]:
            deviation = MEASURED_YAW_STD_RAD if given is None else given
            return self._head["yaw_rad"], deviation if body else hypot(deviation, azimuth)
        if not body:
            return 0.0, azimuth
        deviation = YAW_STD_RAD if given is None else given
        both = hypot(deviation, azimuth)
        off = kalman_step.azimuth_off(self._memory) if both > 0.0 else 0.0
        return (deviation / both) ** 2 * off, deviation * azimuth / both

    def _answer(self, seconds: float, used: bool) -> LiveEstimate:
        """What the filter's memory says at its last sample."""
        head, memory = self._head, self._memory
        part, covariance, numbers = self._work[:3]
        if self._kalman:
            sense, good = kalman_step.kalman_phasor(memory, part, covariance, SETTLED, LOST)
            frequency, deviation = kalman_step.kalman_frequency(memory)
        else:
            sense = bandpass_step.bandpass_phasor(seconds, memory, self._params, part, covariance)
            good = sense != 0
            frequency, deviation = memory[bandpass_step.FREQUENCY], memory[bandpass_step.FREQUENCY_STD]
        if not head["running"] or not isfinite(part[0]):
            found = bool(head["detected"])
            return LiveEstimate(seconds, used, found, False, 0, nan, nan, *([nan] * len(NUMBERS)))
        yaw, yaw_std = self._yaw()
        cone_numbers(part, covariance, sense, yaw, yaw_std, self._settings["tether_length_m"], numbers)
        detected = bool(head["detected"]) or not head["searched"]
        return LiveEstimate(
            seconds,
            used,
            detected,
            bool(good) and detected and not head["crowded"],
            int(sense),
            float(frequency),
            float(deviation),
            *numbers.tolist(),
        )
