"""How well the skiprope is known: the tables of docs/skiprope-accuracy.md.

    python benchmarks/skiprope_accuracy.py scenarios|floor|silence|sweeps [--count N] [--first SEED]

Settings of all methods are the library's defaults, fixed on flights 9000 to 9019, silence on 9100 to 9199 (and the Kalman
filter's equations on two of the 5000s that it lost) before any of the flights from 12000 on, which are scored here, was
looked at. Each study prints a table of Markdown.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from fieldline.cases.tp3123 import random_scenario, score, true_cone
from fieldline.cases.tp3123.flight import RANGE_TESLA
from fieldline.cases.tp3123.scenarios import TETHER_M, Scenario
from fieldline.errors import NoEstimateError
from fieldline.estimation.skiprope import cramer_rao, detect, estimate_skiprope, field_vector, skiprope_signals
from fieldline.estimation.skiprope.line_band import LOWEST_HZ
from fieldline.estimation.skiprope.rotary import BAND_HZ

METHODS = {
    "bandpass, the paper's rule": {"method": "bandpass"},
    "bandpass, azimuth when heard": {"method": "bandpass", "rule": "corrected"},
    "Kalman filter": {"method": "kalman"},
    "harmonic least squares": {"method": "harmonic"},
}
FIELDS = {
    "IGRF-14 flown, six dipoles known": {"field": "IGRF-14", "assumed_field": "displaced-dipoles"},
    "six dipoles flown, IGRF-14 known": {"field": "displaced-dipoles", "assumed_field": "IGRF-14"},
}


def markdown(rows: Sequence[Sequence[str]]) -> str:
    """A table whose first row is its header."""
    lines = ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join([lines[0], "|" + "---|" * len(rows[0]), *lines[1:], ""])


def spread(values) -> str:
    """Median, 90th percentile and worst of the sizes."""
    sizes = np.abs(values)
    return f"{np.median(sizes):.3g} / {np.percentile(sizes, 90):.3g} / {sizes.max():.3g}"


def scenarios(count: int, first: int) -> None:
    """All methods on random flights, in both fields."""
    for name, fields in FIELDS.items():
        scores, unreported, refused = defaultdict(list), defaultdict(int), defaultdict(int)
        for seed in range(first, first + (count if name.startswith("IGRF") else count // 4)):
            flown = random_scenario(seed, **fields)
            for method, settings in METHODS.items():
                try:
                    found = estimate_skiprope(flown.signals, tether_length_m=TETHER_M, **settings)
                except NoEstimateError:
                    refused[method] += 1
                    continue
                result = score(flown, found)
                scores[method].append(result)
                unreported[method] += result.plane_over_stated > 4.0 and bool(found.trusted[-1])
        print(f"\n{name}; {len(scores['Kalman filter'])} flights; median / 90th percentile / worst\n")
        head = (
            "",
            "plane sd, deg",
            "plane RMS, deg",
            "amplitude, %",
            "radius RMS, %",
            "frequency, %",
            "sense right",
            "RMS over stated",
        )
        rows = [(*head, "refused", "over 4 times stated")]
        for method, results in scores.items():
            columns = np.array(results, dtype=float).T
            right = f"{int(columns[6].sum())} of {len(results)}"
            cells = [spread(columns[k]) for k in (1, 2, 3, 4, 5)]
            rows.append((method, *cells, right, spread(columns[7]), str(refused[method]), str(unreported[method])))
        print(markdown(rows), flush=True)


def floor(count: int, first: int) -> None:
    """The mean of the plane's error with and without a measured yaw."""
    rows = [("method", "yaw", "plane RMS, deg", "mean of the plane's error, RMS deg", "stated floor, deg")]
    rng = np.random.default_rng(1)
    flown = [random_scenario(seed) for seed in range(first, first + count)]
    noise = [np.radians(0.5) * rng.normal() for _ in flown]
    for method in ("kalman", "harmonic"):
        for words in ("not measured", "measured to 0.5 deg"):
            results, stated = [], []
            for one, off in zip(flown, noise, strict=True):
                yaw = one.yaw_rad + off if words.startswith("m") else None
                found = estimate_skiprope(one.signals, tether_length_m=TETHER_M, method=method, yaw_rad=yaw)
                results.append(score(one, found))
                stated.append(np.degrees(np.median(found.yaw_std_rad)))
            columns = np.array(results, dtype=float).T
            mean = f"{np.sqrt(np.mean(columns[0] ** 2)):.2f}"
            rows.append((method, words, spread(columns[2]), mean, f"{np.median(stated):.2f}"))
    print(markdown(rows))


def silence(count: int, first: int) -> None:
    """False alarms on flights without a skiprope, and what is found of small ones."""
    rows = [
        (
            "record, s",
            "searched from, mHz",
            "flights",
            "false alarms at 1 % asked",
            "round cone that is found, deg (median)",
            "of 30 flights with one, found",
        )
    ]
    bands = {"2": BAND_HZ, "1.2": (LOWEST_HZ, BAND_HZ[1])}
    for duration in (1000.0, 1500.0, 3000.0, 6000.0):
        silent = [random_scenario(seed, skiprope=False, duration_s=duration).signals for seed in range(first, first + count)]
        flown = [random_scenario(seed, duration_s=duration) for seed in range(first, first + 30)]
        for words, band in bands.items():
            alarms, reach, heard = 0, [], 0
            for signals in silent:
                found = detect(signals, band_hz=band)
                alarms += found.cone is not None
                inside = (found.frequency_hz > 0.004) & (found.frequency_hz < 0.006)
                reach.append(np.degrees(np.median(found.threshold_rad[inside])))
            for one in flown:
                cone = detect(one.signals, band_hz=band).cone
                heard += cone is not None and abs(cone.frequency_hz / abs(one.frequency_hz) - 1.0) < 0.2
            share = f"{100.0 * alarms / count:.1f} %"
            rows.append((f"{duration:.0f}", words, str(count), share, f"{np.median(reach):.3f}", str(heard)))
            print(rows[-1], flush=True)
    print(markdown(rows))


CASES = {
    "as flown: 20 nT, 16 bits, 3 % and 2 deg, 6,000 s": {},
    "noise 2 nT": {"noise_tesla": 2e-9},
    "noise 200 nT": {"noise_tesla": 2e-7},
    "noise 1,000 nT": {"noise_tesla": 1e-6},
    "12 bits (32 nT)": {"bits": 12},
    "10 bits (128 nT)": {"bits": 10},
    "8 bits (512 nT)": {"bits": 8},
    "field known exactly": {"field": "IGRF-14", "assumed_field": "IGRF-14", "field_errors": (0.0, 0.0, 0.0)},
    "field of six dipoles, no more errors": {"field_errors": (0.0, 0.0, 0.0)},
    "field errors 10 %, 5 deg, 5 deg": {"field_errors": (0.1, 5.0, 5.0)},
    "first frequency 20 % low": {"detuned": 0.8},
    "first frequency 20 % high": {"detuned": 1.2},
    "1,200 s": {"duration_s": 1200.0},
    "2,000 s": {"duration_s": 2000.0},
    "3,000 s": {"duration_s": 3000.0},
    "12,000 s": {"duration_s": 12000.0},
    "a gap of 600 s after 2,400 s": {"gap_s": 600.0},
    "pendulous motion at 15 mHz": {"pendulous_frequency_hz": 0.015},
    "pendulous motion at 10 mHz": {"pendulous_frequency_hz": 0.010},
    "pendulous motion at 7 mHz": {"pendulous_frequency_hz": 0.007},
    "pendulous motion at 3 mHz": {"pendulous_frequency_hz": 0.003},
}
GAP_FROM_S = 2400.0


def sweeps(count: int, first: int, only: str = "") -> None:
    """Median errors of amplitude, phase, plane and frequency over one thing at a time, and the bound."""
    names = ("bandpass, the paper's rule", "Kalman filter", "harmonic least squares")
    print("median over flights: amplitude %, phase deg, plane (its mean taken off) deg, frequency 1e-4\n")
    rows = [("", *names, "bound")]
    for words, changes in CASES.items():
        if only not in words:
            continue
        settings = dict(changes)
        detuned, gap_s = settings.pop("detuned", None), settings.pop("gap_s", 0.0)
        errors, bounds = defaultdict(list), []
        for seed in range(first, first + count):
            one = with_gap(random_scenario(seed, **settings), gap_s)
            guess = None if detuned is None else detuned * abs(one.frequency_hz)
            for name in names:
                try:
                    found = estimate_skiprope(one.signals, tether_length_m=TETHER_M, frequency_hz=guess, **METHODS[name])
                except NoEstimateError:
                    continue
                if found.detected and found.trusted.any():
                    errors[name].append(four_errors(one, found))
            bounds.append(bound(one, settings))
        cells = [cell(errors[name], count) for name in names]
        rows.append((words, *cells, cell(bounds, count)))
        print(rows[-1], flush=True)
    print(markdown(rows))


def with_gap(one: Scenario, gap_s: float) -> Scenario:
    """The flight without its samples in a gap, whose signals the estimators then lack."""
    signals = one.signals
    kept = (signals.seconds < GAP_FROM_S) | (signals.seconds >= GAP_FROM_S + gap_s)
    if kept.all():
        return one
    known = field_vector(signals.geometry)[kept]
    return one._replace(signals=skiprope_signals(signals.seconds[kept], signals.field_b[kept], known))


def four_errors(one: Scenario, found) -> tuple[float, float, float, float]:
    """Of an estimate where it is trusted: amplitude [%], phase and plane [deg] about their means, frequency [1e-4]."""
    rows = found.trusted
    times = found.seconds[rows]
    a1, a2 = np.radians(one.axes_deg)
    sense = np.sign(one.frequency_hz)
    phase = 2.0 * np.pi * one.frequency_hz * times
    off = np.angle(np.exp(1j * (found.phase_rad[rows] - phase)))
    off = np.angle(np.exp(1j * (off - np.angle(np.mean(np.exp(1j * off))))))
    _, azimuth = true_cone(one.flight)
    plane = np.angle(np.exp(1j * (found.plane_rad[rows] - np.interp(times, one.flight.seconds, np.unwrap(azimuth)))))
    plane = np.angle(np.exp(1j * (plane - np.angle(np.mean(np.exp(1j * plane))))))
    amplitude = np.median(np.abs(found.amplitude_rad[rows] / (0.5 * (a1 + a2)) - 1.0))
    frequency = abs(found.frequency_hz[rows][-1] / (sense * one.frequency_hz) - 1.0)
    return 100.0 * amplitude, float(np.degrees(off.std())), float(np.degrees(plane.std())), 1e4 * frequency


def bound(one: Scenario, settings: dict) -> tuple[float, float, float, float]:
    """The same four of the Cramer-Rao bound, medians of normal errors, with a slow part of 1 mHz."""
    seconds = one.signals.seconds
    rows = np.searchsorted(one.flight.seconds, seconds)
    middle = 0.5 * seconds[-1]
    turn = np.exp(2j * np.pi * abs(one.frequency_hz) * middle)
    a1, a2 = np.radians(one.axes_deg)
    phasor = (a1 * turn, -1j * np.sign(one.frequency_hz) * a2 * turn)
    exact = settings.get("assumed_field") == "IGRF-14"
    limit = cramer_rao(
        seconds,
        type(one.flight.geometry)(*(column[rows] for column in one.flight.geometry)),
        phasor,
        abs(one.frequency_hz),
        noise_tesla=settings.get("noise_tesla", 2e-8),
        digit_tesla=2.0 * RANGE_TESLA / 2 ** settings.get("bits", 16),
        slow_degree=0 if exact else max(round(0.002 * seconds[-1]), 3),
    )
    half = 0.6745
    amplitude = limit.amplitude_rad / (0.5 * (a1 + a2))
    frequency = limit.frequency_hz / abs(one.frequency_hz)
    return 100.0 * half * amplitude, *np.degrees([limit.phase_rad, limit.plane_rad]), 1e4 * half * frequency


def cell(errors, count: int) -> str:
    """Four medians, and how many flights they are of where not all."""
    if not errors:
        return "-"
    few = "" if len(errors) == count else f" ({len(errors)} of {count})"
    return ", ".join(f"{value:.2g}" for value in np.median(np.array(errors, dtype=float), axis=0)) + few


def main() -> None:
    """One study."""
    parser = argparse.ArgumentParser(description=__doc__)
    studies = {"scenarios": (scenarios, 200), "floor": (floor, 60), "silence": (silence, 200), "sweeps": (sweeps, 12)}
    parser.add_argument("study", choices=sorted(studies))
    parser.add_argument("--count", type=int)
    parser.add_argument("--first", type=int, default=12000)
    parser.add_argument("--only", default="", help="of the sweeps: lines whose name holds this")
    given = parser.parse_args()
    study, count = studies[given.study]
    if given.study == "sweeps":
        sweeps(given.count or count, given.first, given.only)
    else:
        study(given.count or count, given.first)


if __name__ == "__main__":
    main()
