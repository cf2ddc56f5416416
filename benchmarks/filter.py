"""The Kalman filter against the same filter in plain C (`filter.c`), and with its smoother, on a spin of 1 deg/s at 1 Hz.

Both filters run the same arithmetic on the same samples and must agree to 1e-9. Without a C compiler there is no ratio.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from fieldline.estimation.kalman import Noise, filter_forward, prior_blocks
from fieldline.estimation.motion import random_walk
from fieldline.estimation.series import Series, make_series
from fieldline.estimation.smoothing import NO_PATH, NOTHING, smooth
from fieldline.simulate.free_flight import rotate_to_body
from measure import best_of, best_of_each

SOURCE = Path(__file__).with_name("filter.c")
FLAGS = ("-O3", "-march=native", "-shared", "-fPIC")
NOISE = Noise(white=2e-7, jitter=0.01)
SLOW = NOISE._replace(coloured=2e-7)
MODEL = random_walk(3e-5)
SPIN_RAD_S = np.radians(1.0)
AGREE = 1e-9  # of unit quaternions and rad/s: the same arithmetic but for rounding
SAMPLES = 20_000


def spinning(samples: int) -> tuple[Series, np.ndarray]:
    """A body that spins about a tilted axis in a field that turns twice an orbit, with noise, and its first state (7,)."""
    rng = np.random.default_rng(7)
    seconds = np.arange(samples, dtype=float)
    angle = 2.0 * np.pi * seconds / 5700.0
    field_i = 3e-5 * np.column_stack([np.cos(2 * angle), 0.7 * np.sin(2 * angle), 0.5 + 0.5 * np.sin(angle)])
    position_i = 6.9e6 * np.column_stack([np.cos(angle), np.zeros(samples), np.sin(angle)])
    axis = np.array([0.48, 0.6, 0.64])
    half = 0.5 * SPIN_RAD_S * seconds[:, None]
    q_bi = np.hstack([axis * np.sin(half), np.cos(half)])
    field_b = rotate_to_body(q_bi, field_i) + NOISE.white * rng.standard_normal((samples, 3))
    series = make_series(seconds, field_b, field_i, position_i, np.ones(samples, dtype=bool))
    return series, np.concatenate([q_bi[0], SPIN_RAD_S * axis])


def numba_filter(series: Series, start: np.ndarray, noise: Noise = NOISE) -> np.ndarray:
    """(7,) last state, by the library."""
    row, prior = np.concatenate([start, np.zeros(3)])[None], prior_blocks(0.1, 0.01, noise.coloured)
    filter_forward(series, True, 0.0, row, np.zeros((1, 9)), prior, noise, MODEL, NO_PATH, *NOTHING)
    return row[0, :7]


def c_filter(folder: Path):
    """The C filter, compiled in a folder, as a function like `numba_filter`; None where there is no compiler."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        return None
    library = folder / "filter.so"
    subprocess.run([compiler, *FLAGS, "-o", library, SOURCE, "-lm"], check=True)
    forward = ctypes.CDLL(str(library)).filter_forward
    forward.restype = ctypes.c_double

    def run(series: Series, start: np.ndarray) -> np.ndarray:
        state, prior = start.copy(), prior_blocks(0.1, 0.01)[0, :27].copy()
        scalars = (ctypes.c_double(v) for v in (NOISE.white, NOISE.jitter, NOISE.gate, MODEL.noise))
        arrays = (a.ctypes.data_as(ctypes.c_void_p) for a in (series.seconds, series.field_b, series.field_i, series.used))
        forward(len(series.seconds), *arrays, *scalars, *(a.ctypes.data_as(ctypes.c_void_p) for a in (state, prior)), None)
        return state

    return run


def table() -> list[tuple[str, str, str]]:
    """(what, million samples a second, remark)."""
    series, start = spinning(SAMPLES)
    calls = {"filter": lambda: numba_filter(series, start)}
    with tempfile.TemporaryDirectory() as folder:
        plain_c = c_filter(Path(folder))
        if plain_c is not None:
            calls["C"] = lambda: plain_c(series, start)
            apart = np.abs(plain_c(series, start) - numba_filter(series, start)).max()
            if not apart < AGREE:
                raise SystemExit(f"the filter and its C twin end {apart:.1e} apart; {AGREE:g} was expected.")
        rate = {name: SAMPLES / seconds / 1e6 for name, seconds in best_of_each(calls).items()}
    if plain_c is None:
        rows = [("filter, six states", f"{rate['filter']:.2f}", "no C compiler here: no ratio")]
    else:
        remark = f"{rate['filter'] / rate['C']:.2f} of C; last states agree to {apart:.0e}"
        rows = [
            ("filter, six states", f"{rate['filter']:.2f}", remark),
            ("the same in C", f"{rate['C']:.2f}", " ".join(FLAGS[:2])),
        ]
    slow = SAMPLES / best_of(lambda: numba_filter(series, start, SLOW)) / 1e6
    rows.append(("filter, nine states (with the slow error)", f"{slow:.2f}", ""))
    for what, noise in (("six", NOISE), ("nine", SLOW)):
        both = SAMPLES / best_of(lambda noise=noise: smooth(series, start, noise, MODEL)) / 1e6
        rows.append((f"filter and smoother, {what} states", f"{both:.2f}", "runs the filter twice, in chunks, and keeps all"))
    return rows
