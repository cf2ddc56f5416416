"""Is there a cone at all, and at which frequency: the spectrum of the two turning parts, and what noise alone would show.

The measured direction is off the known one by m_k = M_k (a1, a2), M_k = -[e1 x B, e2 x B] (unit vectors). The record is cut
into K pieces of about an orbit. In each, whatever is slower than 1 mHz is fitted as a rotation of Legendre polynomials and
taken off, and with Hann's window w_k

    S = sum w_k M_k' M_k,    v(f) = sum w_k M_k' m_k exp(-2 pi i f t_k),    z(f) = 2 S^-1 v                          (1)

are the phasors of (a1, a2) at f, for a field that turns little in a period; half of z1 +- i z2 turns one way, half the
other. Against the spectrum near by,

    q(f) = Q(f) / Q_near * median of chi-squared of 4 K,    Q = sum over pieces of v* S^-1 v                        (2)

follows chi-squared of 4 K where there is nothing but noise that is smooth in frequency (Q_near is the greater of the
medians of Q over five of the line's widths below f and above). The highest of N independent cells, one over a piece's length
apart, passes the threshold x with

    P = 1 - F(x)^N,     F the distribution of chi-squared of 4 K                                                    (3)

What the known field does within a short record, and between 1.2 and 2 mHz in any, is not smooth in frequency: its errors make
lines of 0.02 to 0.05 deg there. A line with fewer than six periods, or below 2 mHz, must have 0.06 deg besides.

What turns is told from what swings by the share of the power in which the two parts differ; the pendulous motion of TP-3123
swings in a plane. Lines above the band asked for are never taken for the cone: they are listed as other motions.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fieldline.errors import InputError, NoEstimateError
from fieldline.estimation.skiprope.bandpass import positive
from fieldline.estimation.skiprope.signals import SkipropeSignals

BAND_HZ = (0.002, 0.02)
FEWEST_PERIODS = 2.5
BINS_PER_PERIOD = 8
FINENESS = 4  # frequencies per 1 / length
HALF_WIDTH = 2.5  # of a line, over a piece's length
PIECE_S = 6000.0
SLOW_HZ = 0.001
SLOW_BINS = 50  # over 1 / SLOW_HZ: enough to fit what is slow
LEAST_DEGREE = 3
LEAST_TURNING = 0.2  # of a line that turns
LEAST_SHARE = 0.1  # of the strongest turning line's amplitude: a weaker one is not taken for the cone
HIGHER_MODE = 0.25  # of a slower line that swings: a weaker one that turns above it is a mode of more half waves
LEAST_RAD = np.radians(0.06)  # of a line of few periods, or below the usual band: field errors reach 0.05
FEW_PERIODS = 6.0
SIDE = 6  # widths on either side of a line that the noise is taken from
FROM_FEW = 1.2  # times (3)'s threshold: the noise is known from some tens of values
CELL = 1.0  # over a piece's length: between independent values


class Line(NamedTuple):
    """A line of the spectrum."""

    frequency_hz: float
    amplitude_rad: float  # of the larger turning part
    turning: float  # -1 to 1: power of the part that turns from V towards -U, less the other's, over both
    strength: float  # q of (2)


class Rotary(NamedTuple):
    """The spectrum (1), and how large a round cone makes Q one."""

    frequency_hz: np.ndarray  # (k,)
    forward_rad: np.ndarray  # (k,) amplitude of the part that turns from V towards -U (sense 1)
    backward_rad: np.ndarray  # (k,) and of the other
    power: np.ndarray  # (k,) Q of (2)
    unit_rad: float
    pieces: int
    piece_s: float


class Detection(NamedTuple):
    """What the spectrum shows, and the threshold it was held against."""

    frequency_hz: np.ndarray  # (k,)
    forward_rad: np.ndarray  # (k,)
    backward_rad: np.ndarray  # (k,)
    strength: np.ndarray  # (k,) q of (2)
    threshold: float  # of q
    threshold_rad: np.ndarray  # (k,) amplitude of a round cone that reaches it
    false_alarm: float  # P of (3), as asked for
    lines: tuple[Line, ...]  # all above the threshold, by frequency
    cone: Line | None  # the one taken for the skiprope
    others: tuple[Line, ...]  # taken for the pendulous or other motions
    resolution_hz: float


def detect(signals: SkipropeSignals, *, band_hz=BAND_HZ, highest_hz: float | None = None, false_alarm: float = 0.01) -> Detection:
    """Equations (1) to (3): all lines up to `highest_hz`, and the one in `band_hz` that is the cone.

    That is the slowest line in the band that turns and has a tenth of the strongest's amplitude or more; where none turns,
    or a slower one swings with four times its amplitude, that one: a skiprope damped in one direction swings in a plane.
    highest_hz : five times the band's upper end by default, or half the sampling rate.

    Errors: NoEstimateError where the record holds less than two and a half periods of the band's upper end.
    """
    low, high = (positive("band_hz", edge) for edge in band_hz)
    if not low < high or not 0.0 < false_alarm < 1.0:
        raise InputError(f"band_hz must rise and false_alarm lie between 0 and 1; got {band_hz!r}, {false_alarm!r}.")
    top = min(5.0 * high if highest_hz is None else positive("highest_hz", highest_hz), 0.5 / signals.step_s)
    low, high = max(low, FEWEST_PERIODS / signals.span_s), min(high, top)
    if not low < high:
        raise NoEstimateError(
            f"the record holds {signals.span_s:.0f} s at a step of {signals.step_s:.3g} s; a skiprope of {band_hz[0]:.3g} to "
            f"{band_hz[1]:.3g} Hz needs at least {FEWEST_PERIODS} of its periods, and two samples in each: give a longer record."
        )
    found = rotary_spectrum(signals, top)
    width = HALF_WIDTH / found.piece_s
    median, threshold = chi2_levels(4 * found.pieces, false_alarm, max((high - low) * found.piece_s / CELL, 1.0))
    near = _near(found.power, found.frequency_hz, width)
    floor = median / threshold * (LEAST_RAD / found.unit_rad) ** 2
    doubtful = (found.frequency_hz * found.piece_s < FEW_PERIODS) | (found.frequency_hz < BAND_HZ[0])
    near = np.where(doubtful, np.maximum(near, floor), near)
    strength = found.power / near * median
    lines = _lines(found, strength, threshold, width, low)
    cone = cone_of([line for line in lines if line.frequency_hz <= high])
    return Detection(
        *found[:3],
        strength,
        threshold,
        found.unit_rad * np.sqrt(threshold / median * near),
        false_alarm,
        lines,
        cone,
        tuple(line for line in lines if line is not cone),
        width,
    )


def rotary_spectrum(signals: SkipropeSignals, highest_hz: float) -> Rotary:
    """Equation (1) from zero to `highest_hz`, of samples averaged in bins of an eighth of its period."""
    width = max(1.0 / (BINS_PER_PERIOD * highest_hz), signals.step_s)
    thin = signals.thinned(width)
    place = ((thin.seconds - thin.seconds[0]) / width + 0.5).astype(int)
    pieces = max(round(signals.span_s / PIECE_S), 1)
    bins = int(np.ceil((place[-1] + 1) / pieces))
    size = 1 << int(np.ceil(np.log2(FINENESS * bins)))
    frequency = np.arange(size // 2 + 1) / (size * width)
    turning, power, reach, used = np.zeros((2, len(frequency))), np.zeros(len(frequency)), 0.0, 0
    for piece in range(pieces):
        inside = place // bins == piece
        if inside.sum() < bins // 2:
            continue
        v, inverse = _piece(thin.direction_c[inside], thin.direction_b[inside], place[inside] - piece * bins, width, bins, size)
        z = 2.0 * v @ inverse
        power += np.real(np.einsum("ki,ij,kj->k", v.conj(), inverse, v))
        turning += 0.25 * np.abs(np.stack([z[:, 0] + 1j * z[:, 1], z[:, 0] - 1j * z[:, 1]])) ** 2
        reach += float(np.trace(np.linalg.inv(inverse)))
        used += 1
    if not used:
        raise NoEstimateError("no stretch of the record is at least half full of good samples; its gaps are too many.")
    kept = frequency <= highest_hz
    forward, backward = np.sqrt(turning[:, kept] / used)
    return Rotary(frequency[kept], forward, backward, power[kept], 2.0 / np.sqrt(reach), used, bins * width)


def _piece(known, measured, place, width: float, bins: int, size: int) -> tuple[np.ndarray, np.ndarray]:
    """V (k, 2) and the inverse of S of (1), of bins at places within a piece."""
    from numpy.polynomial.legendre import legvander

    taper = 0.5 - 0.5 * np.cos(2.0 * np.pi * (place + 0.5) / bins)
    off = measured - known
    degree = max(round(2.0 * SLOW_HZ * bins * width), LEAST_DEGREE)
    shapes = legvander(2.0 * (place + 0.5) / bins - 1.0, degree)
    group = max(int(1.0 / (SLOW_BINS * SLOW_HZ * width)), 1)
    turning = shapes @ _slow(known, off, taper, shapes, group)
    motion = np.stack([np.cross(known, np.eye(3)[axis]) for axis in (0, 1)], axis=-1)  # what a turn makes of B: -e x B
    across = np.einsum("nij,ni->nj", motion, taper[:, None] * (off - np.cross(known, turning)))
    inverse = np.linalg.inv(np.einsum("n,nij,nik->jk", taper, motion, motion))
    v = np.stack([np.fft.rfft(np.bincount(place, column, minlength=bins), size) for column in across.T], axis=1)
    return v, inverse


def chi2_levels(freedom: int, false_alarm: float, cells: float) -> tuple[float, float]:
    """The median of chi-squared, and the threshold x of (3) with its allowance."""
    from scipy.special import gammainccinv, gammaincinv

    tail = -np.expm1(np.log1p(-false_alarm) / cells)
    return 2.0 * float(gammaincinv(0.5 * freedom, 0.5)), FROM_FEW * 2.0 * float(gammainccinv(0.5 * freedom, tail))


def _slow(known, off, taper, shapes, group: int) -> np.ndarray:
    """(k, 3) weights of the shapes (n, k) in a rotation that fits what the known directions are off, over groups of bins."""
    edges = np.arange(0, len(known), group)
    known, off, shapes = (np.add.reduceat(x * taper[:, None], edges) for x in (known, off, shapes))
    weight = np.add.reduceat(taper, edges)[:, None]
    motion = np.stack([np.cross(known / weight, axis) for axis in np.eye(3)], axis=-1)
    matrix = (motion[:, :, None, :] * (shapes / weight)[:, None, :, None]).reshape(3 * len(edges), -1)
    weighed = matrix * np.repeat(weight, 3, axis=0)
    normal = np.linalg.pinv(weighed.T @ matrix, rcond=1e-12, hermitian=True)
    return (normal @ (matrix.T @ off.reshape(-1))).reshape(-1, 3)


def _near(power, frequency, width: float) -> np.ndarray:
    """(k,) the greater of the medians of the power on either side of each frequency, its own width left out."""
    own = int(np.ceil(width / (frequency[1] - frequency[0])))
    reach = (SIDE - 1) * own
    near = np.full(len(power), -np.inf)
    if len(power) >= reach + own:
        medians = np.median(np.lib.stride_tricks.sliding_window_view(power[own:], reach), axis=1)
        near[: max(len(medians) - 1, 0)] = medians[1:]  # above k: from k + own + 1
        below = medians[: max(len(power) - 2 * own - reach, 0)]  # below k: up to k - own
        near[2 * own + reach : 2 * own + reach + len(below)] = np.maximum(near[2 * own + reach :], below)
    for k in range(2 * own + 1 + own, min(2 * own + reach, len(power))):  # near zero, with fewer below
        near[k] = max(near[k], np.median(power[own : k - own]))
    return np.maximum(np.where(np.isfinite(near), near, np.inf), 1e-300)


def _lines(found: Rotary, strength, threshold: float, width: float, lowest_hz: float) -> tuple[Line, ...]:
    """Local maxima above the threshold, the strongest of each width, by frequency."""
    own = max(int(width / (found.frequency_hz[1] - found.frequency_hz[0])), 1)
    lines = []
    for k in np.flatnonzero((strength > threshold) & (found.frequency_hz >= lowest_hz)):
        around = found.power[max(k - own, 0) : k + own + 1]
        if found.power[k] < around.max():
            continue
        forward, backward = found.forward_rad[k], found.backward_rad[k]
        turning = (forward**2 - backward**2) / (forward**2 + backward**2)
        lines.append(Line(_peak(found, k), float(max(forward, backward)), float(turning), float(strength[k])))
    return tuple(lines)


def _peak(found: Rotary, k: int) -> float:
    """[Hz] of the parabola's top through the logarithms of three values."""
    step = found.frequency_hz[1] - found.frequency_hz[0]
    if not 0 < k < len(found.power) - 1:
        return float(found.frequency_hz[k])
    before, here, after = np.log(found.power[k - 1 : k + 2])
    return float(found.frequency_hz[k] + 0.5 * step * (before - after) / (before - 2.0 * here + after))


def cone_of(lines) -> Line | None:
    """The line that is the cone: see `detect`."""
    turning = [line for line in lines if abs(line.turning) >= LEAST_TURNING]
    if not turning:
        return max(lines, key=lambda line: line.amplitude_rad, default=None)
    largest = max(line.amplitude_rad for line in turning)
    cone = min((line for line in turning if line.amplitude_rad >= LEAST_SHARE * largest), key=lambda line: line.frequency_hz)
    slower = [line for line in lines if line.frequency_hz < cone.frequency_hz]
    below = max(slower, key=lambda line: line.amplitude_rad, default=cone)
    return below if cone.amplitude_rad < HIGHER_MODE * below.amplitude_rad else cone
