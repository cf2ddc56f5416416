"""The skiprope's estimators: a day at 16 Hz at once, and a live stream sample by sample.

A day of the paper's satellite, 1.4 million samples, with the field known as six dipoles. The first run of each compiles and is
not counted. The memory of a live estimator is that of its arrays, which never grow.
"""

from __future__ import annotations

import time
from importlib.resources import files

import numpy as np

from fieldline.cases.tp3123 import random_scenario, record_along
from fieldline.estimation.skiprope import METHODS, LiveSkiprope, bandpass, estimate_skiprope, field_vector, skiprope_signals
from fieldline.estimation.skiprope.live import LIVE_METHODS
from fieldline.estimation.skiprope_telemetry import SkipropeSettings, SkipropeStream
from fieldline.estimation.skiprope_telemetry.face import rows_of
from fieldline.orbit import read_orbit

DAY_S, RATE_HZ, TETHER_M = 86400.0, 16.0, 20e3
LIVE_S = 3000.0
HOPED_FOR = {"bandpass": "under 2 s", "live": "under 50"}


def chapter(markdown) -> list[str]:
    """Tables of Markdown, from a function that makes one of rows."""
    one = random_scenario(9001, duration_s=DAY_S, rate_hz=RATE_HZ)
    seconds, field_b, field_c = one.signals.seconds, one.signals.field_b, field_vector(one.signals.geometry)
    rows = [(f"a day at 16 Hz, {len(seconds):,} samples", "seconds", "hoped for")]
    for method in METHODS:
        rows.append(
            (method, f"{best(lambda method=method: day(seconds, field_b, field_c, method)):.2f}", HOPED_FOR.get(method, ""))
        )
    exact, stepped = (bandpass(seconds, one.signals.corrected, 0.005, method=method) for method in ("exact", "runge-kutta"))
    streams = [("live, a sample", "microseconds", "hoped for", "mean, searches included"), *map(live_row, LIVE_METHODS)]
    worst = np.abs(exact - stepped).max()
    return [
        "## Skiprope",
        "",
        "From signals in memory to the estimate, its frequency searched for.",
        "",
        *markdown(rows),
        f"Exact steps of the filter and steps of fourth order differ over the day by at most {worst:.1g} rad.",
        "",
        *markdown(streams),
        *markdown([("the tool's stream, a row at 16 Hz", "microseconds", "hoped for"), *map(stream_row, METHODS)]),
    ]


def day(seconds, field_b, field_c, method: str) -> None:
    """A whole day by one method."""
    estimate_skiprope(skiprope_signals(seconds, field_b, field_c), tether_length_m=TETHER_M, method=method)


def best(call, times: int = 3) -> float:
    """[s] of processor time, the least of several after one that is not counted."""
    call()
    taken = []
    for _ in range(times):
        start = time.process_time()
        call()
        taken.append(time.process_time() - start)
    return min(taken)


def live_row(method: str) -> tuple[str, str, str, str]:
    """Microseconds a sample of a live stream: median of single calls, and mean with the searches in it."""
    one = random_scenario(9001, duration_s=LIVE_S, rate_hz=RATE_HZ)
    known = field_vector(one.signals.geometry).tolist()
    rows = list(zip(one.signals.seconds.tolist(), one.signals.field_b.tolist(), known, strict=True))
    for _ in range(2):
        live = LiveSkiprope(tether_length_m=TETHER_M, method=method, frequency_hz=0.005, pendulous_hz=0.03125)
        taken = np.empty(len(rows))
        start = time.process_time()
        for k, row in enumerate(rows):
            before = time.perf_counter()
            live.update(*row)
            taken[k] = time.perf_counter() - before
        whole = time.process_time() - start
    size = sum(array.nbytes for array in live.state().values()) / 1024.0
    mean = f"{1e6 * whole / len(rows):.1f}; {size:.0f} KiB remembered"
    return method, f"{1e6 * np.median(taken):.1f}", HOPED_FOR["live"], mean


if __name__ == "__main__":
    from run import markdown as table

    print("\n".join(chapter(table)))


def stream_row(method: str) -> tuple[str, str, str]:
    """Microseconds a row of `fieldline skiprope --follow` from readings to lines, orbit, field and all estimates included."""
    data = files("fieldline") / "data"
    orbit = read_orbit(str(data / "skiprope.tle"))
    stamps = np.datetime64("1992-08-04T12:00:00", "ns") + (np.arange(round(2.0 * LIVE_S * RATE_HZ)) * 62_500_000).astype("m8[ns]")
    motion = {"skiprope_frequency_hz": 0.0049, "skiprope_deg": (0.7, 0.5), "pendulous_deg": (1.0, 1.0)}
    rows = rows_of(record_along(stamps, orbit, **motion).telemetry)
    taken = []
    for _ in range(2):
        stream = SkipropeStream(SkipropeSettings(tether_length_m=TETHER_M, method=method), orbit)
        start = time.process_time()
        for first in range(0, len(stamps), 512):
            stream.take(rows.where(slice(first, first + 512)))
        taken.append(time.process_time() - start)
    return method, f"{1e6 * min(taken) / len(stamps):.1f}", HOPED_FOR["live"]
