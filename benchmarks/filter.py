"""The Kalman filter against the same filter in plain C (`filter.c`), and with its smoother, on a spin of 1 deg/s at 1 Hz.

    python benchmarks/filter.py [SAMPLES]

Both filters run the same arithmetic on the same samples and must agree to 1e-9. Without a C compiler there is no ratio.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from fieldline.estimation.kalman import Noise, filter_forward, prior_blocks
from fieldline.estimation.motion import random_walk
from fieldline.estimation.series import Series, make_series
from fieldline.estimation.smoothing import EMPTY_BLOCKS, EMPTY_STATES, EMPTY_WHITE, smooth
from fieldline.simulate.free_flight import rotate_to_body

SOURCE = Path(__file__).with_name("filter.c")
FLAGS = ("-O3", "-march=native", "-shared", "-fPIC")
NOISE = Noise(white=2e-7, jitter=0.01)
MODEL = random_walk(3e-5)
SPIN_RAD_S = np.radians(1.0)
AGREE = 1e-9  # of unit quaternions and rad/s: the same arithmetic but for rounding


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


def numba_filter(series: Series, start: np.ndarray) -> np.ndarray:
    """(7,) last state, by the library."""
    row, prior = np.concatenate([start, np.zeros(3)])[None], prior_blocks(0.1, 0.01)
    filter_forward(series, True, 0.0, row, prior, NOISE, MODEL, EMPTY_STATES, EMPTY_BLOCKS, EMPTY_WHITE)
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


def rows(samples: int, best_of) -> list[tuple[str, float, str]]:
    """(what, samples a second, remark) of the filters; best_of(call) gives the seconds of the best of several runs."""
    series, start = spinning(samples)
    ours = samples / best_of(lambda: numba_filter(series, start))
    both = samples / best_of(lambda: smooth(series, start, NOISE, MODEL))
    slow = samples / best_of(lambda: smooth(series, start, NOISE._replace(coloured=2e-7), MODEL))
    with tempfile.TemporaryDirectory() as folder:
        plain_c = c_filter(Path(folder))
        if plain_c is None:
            first = [("filter", ours, "no C compiler here: no ratio")]
        else:
            apart = np.abs(plain_c(series, start) - numba_filter(series, start)).max()
            if not apart < AGREE:
                raise SystemExit(f"the filter and its C twin end {apart:.1e} apart; {AGREE:g} was expected.")
            theirs = samples / best_of(lambda: plain_c(series, start))
            first = [
                ("filter, six states", ours, f"{ours / theirs:.2f} of C (states agree to {apart:.0e})"),
                ("the same in C", theirs, " ".join(("gcc", *FLAGS[:2]))),
            ]
    return [*first, ("filter and smoother, six states", both, ""), ("filter and smoother with the slow error, nine", slow, "")]


if __name__ == "__main__":
    from measure import best_of

    for what, rate, remark in rows(int(sys.argv[1]) if len(sys.argv) == 2 else 100_000, best_of):
        print(f"{what:46}{rate / 1e6:8.3f} million samples/s  {remark}")
