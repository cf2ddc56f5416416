"""Cost and memory against the number of samples: reading a file, calibrating, filtering and smoothing.

    python benchmarks/scaling.py SAMPLES

prints one line of JSON; each length runs in a process of its own, whose peak memory is that length's alone. The record is
a body that turns at 1 deg/s on a circular orbit in IGRF-14, one sample a second, with a bias and 100 nT of noise.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path

import numpy as np

import fieldline as fl
from fieldline.estimation.calibration import calibrate_magnitude
from fieldline.estimation.series import make_series, part
from fieldline.estimation.smoothing import smooth
from fieldline.simulate.free_flight import rotate_to_body
from filter import MODEL, SLOW
from measure import timed

EPOCH = np.datetime64("2023-08-24T00:00:00", "ns")
SPIN_B = np.radians([0.48, 0.6, 0.64])
BIAS = np.array([2e-5, -1e-5, 5e-6])


def record(samples: int):
    """Times, seconds, position and field in one set of axes (Earth-fixed, which will do here), attitude, raw reading."""
    seconds = np.arange(samples, dtype=float)
    time_utc = EPOCH + (seconds * 1e9).astype("timedelta64[ns]")
    angle, node = 2.0 * np.pi * seconds / 5700.0, 7.3e-5 * seconds
    x, y, z = np.cos(angle), 0.13 * np.sin(angle), 0.99 * np.sin(angle)
    position = 6.9e6 * np.column_stack([x * np.cos(node) + y * np.sin(node), y * np.cos(node) - x * np.sin(node), z])
    field = fl.magnetic_field(position, time_utc)
    size = np.linalg.norm(SPIN_B)
    half = 0.5 * size * seconds[:, None]
    q_bi = np.hstack([SPIN_B / size * np.sin(half), np.cos(half)])
    noise = 1e-7 * np.random.default_rng(5).standard_normal((samples, 3))
    return time_utc, seconds, position, field, q_bi, rotate_to_body(q_bi, field) + BIAS + noise


def write_csv(path: Path, seconds, raw) -> None:
    """The record as a user would have it."""
    start = int(EPOCH.astype(np.int64) // 10**9)
    table = np.column_stack([start + seconds, np.round(raw * 1e9, 1)])
    np.savetxt(path, table, delimiter=",", header="unix_s,mag_x_nT,mag_y_nT,mag_z_nT", comments="", fmt=["%.0f", *["%.1f"] * 3])


def peak_mb() -> float:
    """[MB] the most that this process has held; Linux's other count begins with what its parent held."""
    status = Path("/proc/self/status")
    if status.exists():
        (line,) = (line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return int(line.split()[1]) / 1e3
    import resource

    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / (1e6 if sys.platform == "darwin" else 1e3)


def stages(samples: int) -> dict:
    """Seconds of each stage, and the peak memory [MB]."""
    _, seconds, position, field, q_bi, raw = record(samples)
    magnitude = np.linalg.norm(field, axis=1)
    series = make_series(seconds, raw - BIAS, field, position, np.ones(samples, dtype=bool))
    start = np.concatenate([q_bi[0], SPIN_B])
    few = slice(0, 600)  # so that no stage compiles while it is timed
    smooth(part(series, few), start, SLOW, MODEL)
    calibrate_magnitude(seconds[few], raw[few], magnitude[few])
    taken = {}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "record.csv"
        write_csv(path, seconds, raw)
        taken["read"] = timed(lambda: fl.read_telemetry(path))
    taken["calibrate"] = timed(lambda: calibrate_magnitude(seconds, raw, magnitude))
    taken["filter and smooth"] = timed(lambda: smooth(series, start, SLOW, MODEL))
    return {"samples": samples, "seconds": taken, "peak_mb": peak_mb()}


if __name__ == "__main__":
    if len(sys.argv) != 2 or not sys.argv[1].isdigit():
        sys.exit(f"usage: python {Path(__file__).name} SAMPLES")
    print(json.dumps(stages(int(sys.argv[1]))))
