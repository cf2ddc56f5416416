"""The rules by which filtered signals C1, C2, C3 are read: amplitude, frequency, sense, and the plane of the cone.

(1) The amplitude of C3 is the tilt a_M.
(2) The period of C3 is that of the cone; where C1 leads C2 the cone turns from V towards -U (w > 0), where it lags, back.
(3) Where C3 is highest, w t = AZ + pi: the body's axis lies in the plane of the cone's axis and the field, tilted towards
    the field; where it is lowest, in the same plane, tilted away.

Each is read cycle by cycle, from a sine through the cycle or from its highest and lowest points, and comes with one standard
deviation of a single cycle:

    amplitude   the scatter of the cycles, the ellipse, the known field's scale error, and tan(EL) times its elevation error
    frequency   the scatter of the phases (by eye: of the crossings of zero) about even ones and the ellipse, over the
                record's length, and what taking the azimuth a group delay earlier would change
    time        the scatter about its line of (azimuth at the maximum - w t_max), and the ellipse, over w
    plane       the same, and the azimuth error of the known field

The rules take the cone as circular. C1 and C2 show the ellipse that it is: with z their phasors, its two circular parts are

    c+-^2 = (|z1|^2 + |z2|^2 +- 2 Im(z1 z2*)) / 4,     e = c- / c+                                          (9)

and reading it as a circle errs by up to asin(e) in the plane and e in the amplitude, 1 / sqrt(2) of that RMS over all
directions of the field (11.5 deg and 20 % at 1.5 to 1).

The scatter is not divided by the number of cycles: where the cone is elliptical or the field turns, cycles differ for good
reasons, and a mean of them is no better known. Fewer than four cycles have no scatter to speak of; the misfit of the sine
stands for it. An error of the known field does not move the time of a maximum (it changes the offset that the filter takes
out), only the azimuth that is read there; and yaw is not seen in C3 at all.

C3 turns with w - AZ'; by sines the slope of the azimuth over the record is added back, which the source's rule leaves out.
The filter answers late by its group delay, 318 s at 0.005 Hz and a damping of 0.1. Rule (3)
takes the azimuth now; with `azimuth_delay_s` it takes the azimuth then, which the source does not do.

Source: Polites (1991), NASA TP-3123, section II, rules (1) to (3); the uncertainties are ours.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, NoEstimateError
from fieldline.estimation.skiprope.bandpass import as_series, group_delay_s, settling_time_s
from fieldline.estimation.skiprope.cycles import Crossings, Cycles, extremes, fit_cycles, zero_crossings
from fieldline.estimation.skiprope.signals import FieldGeometry
from fieldline.estimation.skiprope.spectrum import strongest_line

READ_BY = ("sine", "extremes")
FEWEST_FOR_SCATTER = 4
LEAST_AGREEMENT = 0.5  # of the cycles on the sense, weighted: below it none is given
LEAST_LEAD_SINE = 0.3
TOO_SHORT = (
    "only {} whole cycles of C3 (at {:.4g} Hz) are left to be read after settling, and two are needed; give a longer record, "
    "or a filter frequency nearer the cone's."
)


class FieldKnowledge(NamedTuple):
    """One standard deviation of the known field's errors: share of its magnitude, elevation and azimuth [rad]."""

    scale: float = 0.0
    elevation_rad: float = 0.0
    azimuth_rad: float = 0.0


@dataclass(frozen=True, kw_only=True)
class ConeReading:
    """What the rules say: a summary, and m cycles."""

    amplitude_rad: float
    amplitude_std_rad: float
    frequency_hz: float  # signed as the sense; positive where there is none
    frequency_std_hz: float
    sense: int  # 1: w > 0, C1 leads; -1: w < 0; 0: not to be told
    lead_rad: float  # of C1 before C2
    lead_std_rad: float
    agreement: float  # of the cycles on the sense, 0 to 1
    ellipse: float  # e of (9), 0 for a circle, 1 for a line
    maximum_s: np.ndarray  # (m,) [s] in the plane, tilted towards the field
    maximum_std_s: np.ndarray
    azimuth_rad: np.ndarray  # (m,) of the tilt then, from V towards -U
    azimuth_std_rad: np.ndarray
    cycle_amplitude_rad: np.ndarray  # (m,)
    cycle_amplitude_std_rad: np.ndarray

    @property
    def period_s(self) -> float:
        """Of the cone [s]."""
        return 1.0 / abs(self.frequency_hz)


def read_cone(
    seconds,
    filtered,
    geometry: FieldGeometry,
    filter_frequency_hz: float,
    *,
    damping: float = 0.1,
    settle_s: float | None = None,
    by: str = "sine",
    knowledge: FieldKnowledge = FieldKnowledge(),
    azimuth_delay_s: float = 0.0,
) -> ConeReading:
    """Read filtered signals by the rules.

    Parameters
    ----------
    seconds : (n,) [s]. filtered : (n, 3) [rad], C1, C2, C3 out of `bandpass`. geometry : the known field's, (n,) each.
    filter_frequency_hz, damping : of that filter. settle_s : left out at the start; by default what 92 % settling takes.
    by : "sine" through each cycle, or "extremes", the highest and lowest points as read off a plot.
    azimuth_delay_s : see the head of this file; 0 is the source's rule, `group_delay_s` the corrected one.

    Errors: InputError for arguments; NoEstimateError where less than two periods are left, or C3 never swings.
    """
    times, rows = as_series(seconds, filtered)
    if rows.shape[1] != 3:
        raise InputError(f"filtered must hold three signals (n, 3); got {rows.shape}.")
    if any(np.shape(column) != times.shape for column in geometry):
        raise InputError(f"geometry must have one value for each of the {len(times)} samples; got {np.shape(geometry[0])}.")
    if by not in READ_BY:
        raise InputError(f"by must be one of {', '.join(READ_BY)}; got {by!r}.")
    delay = float(group_delay_s(filter_frequency_hz, filter_frequency_hz, damping))
    settle = settling_time_s(filter_frequency_hz, damping) if settle_s is None else float(settle_s)
    kept = times >= times[0] + settle if len(times) else np.zeros(0, dtype=bool)
    if kept.sum() < 4:
        raise NoEstimateError(f"the record is shorter than the {settle:.0f} s that the filter settles in; give a longer one.")
    turning = Turning(times, np.unwrap(np.asarray(geometry.azimuth_rad, dtype=float)))
    marks = _marks(times[kept], rows[kept], filter_frequency_hz, by)
    sense, lead, lead_std, agreement = sense_of(marks.phasor)
    ellipse = ellipse_of(marks.phasor)
    signed_hz = (sense or 1) * marks.frequency_hz
    azimuth = turning.at(marks.maximum_s - azimuth_delay_s)
    scatter, drift = _plane_scatter(marks.maximum_s, azimuth, signed_hz, marks.misfit / np.mean(marks.size))
    plane_std = np.hypot(scatter, np.arcsin(ellipse) / np.sqrt(2.0))
    late = turning.rate_hz(marks.maximum_s) - turning.rate_hz(marks.maximum_s - delay)
    swung = np.arcsin(ellipse) / (2.0 * np.pi * (times[-1] - times[0] - settle))
    elevation = np.interp(marks.maximum_s, times, geometry.elevation_rad)
    share = np.sqrt(knowledge.scale**2 + (np.tan(elevation) * knowledge.elevation_rad) ** 2 + 0.5 * ellipse**2)
    cycle_std = np.hypot(_scatter(marks.size, marks.misfit), share * marks.amplitude)
    count = len(marks.maximum_s)
    return ConeReading(
        amplitude_rad=float(np.mean(marks.size)),
        amplitude_std_rad=float(np.sqrt(np.mean(cycle_std**2))),
        frequency_hz=float(signed_hz + (drift if sense and by == "sine" else 0.0)),
        frequency_std_hz=float(np.sqrt(marks.frequency_std_hz**2 + swung**2 + late**2)),
        sense=sense,
        lead_rad=lead,
        lead_std_rad=lead_std,
        agreement=agreement,
        ellipse=ellipse,
        maximum_s=marks.maximum_s,
        maximum_std_s=np.full(count, plane_std / (2.0 * np.pi * marks.frequency_hz)),
        azimuth_rad=azimuth,
        azimuth_std_rad=np.full(count, np.hypot(plane_std, knowledge.azimuth_rad)),
        cycle_amplitude_rad=marks.amplitude,
        cycle_amplitude_std_rad=cycle_std,
    )


class Turning(NamedTuple):
    """The known field's azimuth (n,) [rad], without jumps, at times (n,) [s]."""

    seconds: np.ndarray
    azimuth_rad: np.ndarray

    def at(self, seconds) -> np.ndarray:
        """The azimuth [rad] at times [s]."""
        return np.interp(seconds, self.seconds, self.azimuth_rad)

    def rate_hz(self, seconds) -> float:
        """[Hz] by which it turns in the mean over times (m,) [s]; zero for a single one."""
        if len(seconds) < 2:
            return 0.0
        return float(np.polyfit(seconds - seconds[0], self.at(seconds), 1)[0] / (2.0 * np.pi))


class Marks(NamedTuple):
    """What is marked on C3, by sines or by eye."""

    frequency_hz: float  # of C3
    frequency_std_hz: float
    phasor: np.ndarray  # (m, 3) of whole cycles
    maximum_s: np.ndarray  # (m,)
    amplitude: np.ndarray  # (m,) at the maxima
    size: np.ndarray  # amplitudes that the mean is of: by eye of minima too
    misfit: np.ndarray  # (m,) of the sines, or their median


def _marks(times, rows, near_hz: float, by: str) -> Marks:
    """The marks on settled signals (n, 3)."""
    frequency, frequency_std, _ = frequency_of(times, rows[:, 2], near_hz)
    if by == "extremes":
        crossings = zero_crossings(times, rows[:, 2])
        frequency, frequency_std = crossing_frequency(crossings)
    cycles = fit_cycles(times, rows, frequency)
    if not len(cycles.middle_s):
        raise NoEstimateError("no whole cycle of the cone without a gap is left to be read; give a longer record.")
    z, ripple = cycles.phasor[:, 2], cycles.ripple[:, 2]
    if by == "extremes":
        at, value = extremes(times, rows[:, 2], crossings)
        high = value > 0.0
        return Marks(frequency, frequency_std, cycles.phasor, at[high], value[high], np.abs(value), np.median(ripple))
    maximum = cycles.middle_s - np.angle(z) / (2.0 * np.pi * frequency)
    return Marks(frequency, frequency_std, cycles.phasor, maximum, np.abs(z), np.abs(z), ripple)


def frequency_of(seconds, signal, near_hz: float) -> tuple[float, float, Cycles]:
    """Rule (2) by sines: frequency [Hz], its standard deviation, and the cycles it was read from.

    The strongest line within a factor of four of `near_hz`, then the advance of the phases of the sines at it.
    """
    line = strongest_line(seconds, signal, 0.25 * near_hz, 4.0 * near_hz)
    cycles = fit_cycles(seconds, signal, line)
    if len(cycles.middle_s) < 2:
        raise NoEstimateError(TOO_SHORT.format(len(cycles.middle_s), line))
    phase = np.unwrap(np.angle(cycles.phasor[:, -1] * np.exp(-2j * np.pi * line * cycles.middle_s)))
    rate, start = np.polyfit(cycles.middle_s, phase, 1)
    left = phase - rate * cycles.middle_s - start
    few = len(phase) < FEWEST_FOR_SCATTER
    scatter = np.median(cycles.ripple[:, -1] / np.abs(cycles.phasor[:, -1])) if few else np.std(left, ddof=2)
    std = np.sqrt(2.0) * scatter / (2.0 * np.pi * (cycles.middle_s[-1] - cycles.middle_s[0]))
    return line + rate / (2.0 * np.pi), float(std), cycles


def crossing_frequency(crossings: Crossings) -> tuple[float, float]:
    """Rule (2) by eye: [Hz] by the mean distance of crossings of zero, and by their scatter its standard deviation."""
    z = crossings.seconds
    if len(z) < 4:
        raise NoEstimateError(TOO_SHORT.format(len(z) // 2, np.nan))
    spacing = (z[-1] - z[0]) / (len(z) - 1)
    k = np.arange(len(z))
    scatter = np.std(z - np.polyval(np.polyfit(k, z, 1), k), ddof=2)
    return 0.5 / spacing, float(0.5 / spacing * np.sqrt(2.0) * scatter / (z[-1] - z[0]))


def sense_of(phasor) -> tuple[int, float, float, float]:
    """Rule (2): sense, lead of C1 before C2 [rad], its scatter a cycle [rad], and how well cycles agree, 0 to 1.

    Cycles weigh as |z1 z2|, that is as sin^2 EL: those with the field across the cone's axis say nothing.
    """
    product = phasor[:, 0] * np.conj(phasor[:, 1])
    total, weight = product.sum(), np.abs(product)
    if not weight.sum() > 0.0:
        return 0, 0.0, np.pi, 0.0
    lead = float(np.angle(total))
    off = np.angle(product * np.exp(-1j * lead))
    agreement = float(abs(product.imag.sum()) / np.abs(product.imag).sum())
    told = agreement >= LEAST_AGREEMENT and abs(np.sin(lead)) >= LEAST_LEAD_SINE
    return int(np.sign(lead)) if told else 0, lead, float(np.sqrt(np.average(off**2, weights=weight))), agreement


def ellipse_of(phasor) -> float:
    """The ratio e of (9) of all cycles together: the known field's elevation drops out of it."""
    z1, z2 = phasor[:, 0], phasor[:, 1]
    whole, turning = (np.abs(z1) ** 2 + np.abs(z2) ** 2).sum(), 2.0 * abs((z1 * np.conj(z2)).imag.sum())
    if not whole > 0.0:
        return 1.0
    return float(np.sqrt(max(whole - turning, 0.0) / (whole + turning)))  # (9)


def _plane_scatter(maximum, azimuth, signed_hz: float, misfit_share) -> tuple[float, float]:
    """[rad] by which single cycles scatter about an even turn of the plane, and by how much it turns faster than C3 [Hz]."""
    if len(maximum) < FEWEST_FOR_SCATTER:
        return float(np.mean(misfit_share)), 0.0
    ahead = np.unwrap(azimuth - 2.0 * np.pi * signed_hz * (maximum - maximum[0]))
    slope, start = np.polyfit(maximum - maximum[0], ahead, 1)
    left = ahead - start - slope * (maximum - maximum[0])
    return float(np.std(left, ddof=2)), float(slope / (2.0 * np.pi))


def _scatter(values, misfit) -> float:
    """Standard deviation of single values, or of what the sines left where they are few."""
    return float(np.std(values, ddof=1) if len(values) >= FEWEST_FOR_SCATTER else np.sqrt(np.mean(np.square(misfit))))
