"""A bank of second-order filters, stepped exactly from sample to sample.

    x1' = x2,   x2' = wn^2 (u - x1) - 2 z wn x2                                                                (1)
    low-pass  L(s) = wn^2 / (s^2 + 2 z wn s + wn^2)          is x1
    bandpass  G(s) = 2 z wn s / (s^2 + 2 z wn s + wn^2)      is 2 z x2 / wn                                    (2)

The input is held from sample to sample, so (1) is solved exactly: with wd = wn sqrt(1 - z^2), c = cos(wd dt),
s = sin(wd dt) / wd,

    x1 -> u + e (c + z wn s) (x1 - u) + e s x2
    x2 ->   - e wn^2 s (x1 - u) + e (c - z wn s) x2,          e = exp(-z wn dt)                                (3)

for any step, even or not. A held input is late by half a step, 0.06 deg at 16 Hz and 0.005 Hz, 0.9 deg at 1 Hz. "linear"
takes the input in straight pieces of slope m instead, which is not late; (3) then carries x1 - u + 2 z m / wn and x2 - m.
"runge-kutta" steps (1) by the classical rule of fourth order instead, as the program of TP-3123
does: at 16 Hz and 0.005 Hz one step differs from (3) by 7e-15, and the corrected signals of its run, filtered over 6,000 s,
by 1e-14. Tustin's rule differs by 1e-5 to 2e-5, for it is not late by half a step either.

The filter starts at rest on its first input, x1 = u, x2 = 0: a constant then makes no transient. A sample that is not
finite is passed over (the input before it is held on); after `longest_hold_s` without a good one the filter starts anew.
With held inputs the output at a sample is the state before that sample is taken in.

Source: Polites (1991), NASA TP-3123, section III, for the filter and its start.
"""

from __future__ import annotations

from math import cos, exp, inf, isfinite, nan, pi, sin, sqrt
from typing import NamedTuple

import numpy as np
from numba import njit

from fieldline.errors import InputError

METHODS = ("exact", "linear", "runge-kutta")


class FilterState(NamedTuple):
    """All that a bank remembers, overwritten as it goes on; what a live stream keeps through a restart."""

    clock: np.ndarray  # (3,) [s]: last sample, last good input, when the filter started; NaN: it has not
    columns: np.ndarray  # (k, 3): x1, x2 [1/s], held input u, of each signal


class Filtered(NamedTuple):
    """The bank's outputs over n samples of k signals."""

    low: np.ndarray  # (n, k) x1
    rate: np.ndarray  # (n, k) [1/s] x2
    age_s: np.ndarray  # (n,) [s] since the filter started; NaN before
    state: FilterState


@njit(cache=True)
def exact_step(dt, wn, damping):
    """The four factors of (3), row by row, of a step [s] at wn [rad/s]."""
    wd = wn * sqrt(1.0 - damping * damping)
    e = exp(-damping * wn * dt)
    c, s = e * cos(wd * dt), e * sin(wd * dt) / wd
    return (c + damping * wn * s, s, -wn * wn * s, c - damping * wn * s)


@njit(cache=True)
def runge_kutta_step(dt, wn, damping):
    """The same factors by the classical rule: the exponential's series to fourth order."""
    a, b = -wn * wn, -2.0 * damping * wn
    p11, p12, p21, p22 = 1.0, 0.0, 0.0, 1.0
    t11, t12, t21, t22 = 1.0, 0.0, 0.0, 1.0
    for order in range(1, 5):
        h = dt / order
        t11, t12, t21, t22 = h * a * t12, h * (t11 + b * t12), h * a * t22, h * (t21 + b * t22)
        p11, p12, p21, p22 = p11 + t11, p12 + t12, p21 + t21, p22 + t22
    return (p11, p12, p21, p22)


@njit(cache=True)
def bank_kernel(seconds, inputs, wn, damping, method, longest_hold, clock, columns, low, rate, age):
    """Fill (n, k) low and rate and (n,) age from times (n,) and inputs (n, k); method indexes METHODS, the state goes on."""
    factors, step = (1.0, 0.0, 0.0, 1.0), 0.0
    for j in range(seconds.shape[0]):
        t = seconds[j]
        good = True
        for k in range(inputs.shape[1]):
            good = good and isfinite(inputs[j, k])
        if not (t - clock[1] <= longest_hold):  # not started, or too long without a good input
            clock[2] = t if good else nan
            for k in range(inputs.shape[1]):
                columns[k, 0], columns[k, 1], columns[k, 2] = inputs[j, k] if good else nan, 0.0, inputs[j, k]
        elif t != clock[0]:
            if t - clock[0] != step:
                step = t - clock[0]
                factors = runge_kutta_step(step, wn, damping) if method == 2 else exact_step(step, wn, damping)
            for k in range(inputs.shape[1]):
                slope = (inputs[j, k] - columns[k, 2]) / step if method == 1 and good else 0.0
                behind = 2.0 * damping * slope / wn
                away, x2 = columns[k, 0] - columns[k, 2] + behind, columns[k, 1] - slope
                columns[k, 0] = columns[k, 2] + slope * step - behind + factors[0] * away + factors[1] * x2  # (3)
                columns[k, 1] = slope + factors[2] * away + factors[3] * x2
        for k in range(inputs.shape[1]):
            low[j, k], rate[j, k] = columns[k, 0], columns[k, 1] if isfinite(columns[k, 0]) else nan
            if good:
                columns[k, 2] = inputs[j, k]
        age[j] = t - clock[2]
        clock[0] = t
        if good:
            clock[1] = t


def filter_bank(
    seconds, signals, frequency_hz: float, damping: float, *, method="exact", longest_hold_s=inf, state: FilterState | None = None
) -> Filtered:
    """Both outputs of (1) for k signals at once.

    Parameters
    ----------
    seconds : (n,) [s], rising. signals : (n,) or (n, k), any unit.
    frequency_hz : wn / 2 pi. damping : z, between 0 and 1.
    method : "exact" (3) with held inputs, "linear", or "runge-kutta".
    longest_hold_s : longest stretch without a good sample that the filter lives through.
    state : of an earlier call, to go on from; it is overwritten.

    Errors: InputError for times that do not rise, other shapes, a frequency or damping out of range.
    """
    seconds, signals = as_series(seconds, signals)
    wn = 2.0 * pi * positive("frequency_hz", frequency_hz)
    if not 0.0 < positive("damping", damping) < 1.0:
        raise InputError(f"damping must lie between 0 and 1 (0.1 is TP-3123's); got {damping!r}.")
    if method not in METHODS:
        raise InputError(f"method must be one of {', '.join(METHODS)}; got {method!r}.")
    if state is None:
        state = FilterState(np.full(3, nan), np.full((signals.shape[1], 3), nan))
    if state.columns.shape[0] != signals.shape[1] or (len(seconds) and seconds[0] <= state.clock[0]):
        raise InputError("the samples do not follow on from the filter's state: other signals, or times that went back.")
    low, rate, age = np.empty(signals.shape), np.empty(signals.shape), np.empty(len(seconds))
    bank_kernel(seconds, signals, wn, float(damping), METHODS.index(method), float(longest_hold_s), *state, low, rate, age)
    return Filtered(low, rate, age, state)


def bandpass(seconds, signals, frequency_hz: float, damping: float = 0.1, *, method="exact", longest_hold_s=inf) -> np.ndarray:
    """The bandpass output of (2), of the signals' shape: unit gain and no phase at frequency_hz. See `filter_bank`."""
    found = filter_bank(seconds, signals, frequency_hz, damping, method=method, longest_hold_s=longest_hold_s)
    return (found.rate * (damping / (pi * frequency_hz))).reshape(np.shape(signals))  # 2 z / wn


def lowpass(seconds, signals, frequency_hz: float, damping: float = 0.707, *, method="exact", longest_hold_s=inf) -> np.ndarray:
    """The low-pass output of (2), of the signals' shape. See `filter_bank`."""
    found = filter_bank(seconds, signals, frequency_hz, damping, method=method, longest_hold_s=longest_hold_s)
    return found.low.reshape(np.shape(signals))


def bandpass_response(frequency_hz, filter_frequency_hz: float, damping: float = 0.1) -> np.ndarray:
    """Complex gain G(2 pi i f) of (2): abs is the gain, angle the lead [rad]; a negative f gives the conjugate.

    G = 2 z i r / (1 - r^2 + 2 z i r),    r = f / f_n
    """
    r = np.asarray(frequency_hz, dtype=float) / positive("filter_frequency_hz", filter_frequency_hz)
    return 2j * damping * r / (1.0 - r * r + 2j * damping * r)


def group_delay_s(frequency_hz, filter_frequency_hz: float, damping: float = 0.1) -> np.ndarray:
    """[s] by which (2) is late with a change of amplitude or phase at f: minus the slope of its phase over 2 pi f.

    2 z (1 + r^2) / (wn ((1 - r^2)^2 + (2 z r)^2)),    1 / (z wn) where tuned
    """
    wn = 2.0 * pi * positive("filter_frequency_hz", filter_frequency_hz)
    r = np.asarray(frequency_hz, dtype=float) / filter_frequency_hz
    return 2.0 * damping * (1.0 + r * r) / (wn * ((1.0 - r * r) ** 2 + (2.0 * damping * r) ** 2))


def settling_time_s(filter_frequency_hz: float, damping: float = 0.1, remainder: float = 0.08) -> float:
    """[s] after which `remainder` of the transient is left, exp(-z wn t); 0.08 makes TP-3123's 800 s."""
    return -np.log(remainder) / (damping * 2.0 * pi * positive("filter_frequency_hz", filter_frequency_hz))


def as_series(seconds, signals) -> tuple[np.ndarray, np.ndarray]:
    """(n,) rising times and (n, k) signals, contiguous floats, or a refusal."""
    times = np.ascontiguousarray(seconds, dtype=float)
    rows = np.asarray(signals, dtype=float)
    rows = np.ascontiguousarray(rows[:, None] if rows.ndim == 1 else rows)
    if times.ndim != 1 or rows.ndim != 2 or len(rows) != len(times):
        raise InputError(f"seconds (n,) and signals (n, k) must have one row for each sample; got {times.shape}, {rows.shape}.")
    if not np.isfinite(times).all() or (np.diff(times) <= 0.0).any():
        raise InputError("seconds must be finite and rise from sample to sample; sort them and drop repeats first.")
    return times, rows


def positive(name: str, value) -> float:
    """A positive finite number, or a refusal."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.number) or not 0.0 < value < inf:
        raise InputError(f"{name} must be a positive number; got {value!r}.")
    return float(value)
