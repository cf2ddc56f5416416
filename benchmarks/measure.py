"""How long, and on which machine."""

from __future__ import annotations

import platform
import subprocess
import time
from pathlib import Path


def timed(call) -> float:
    """[s] of one call."""
    begun = time.perf_counter()
    call()
    return time.perf_counter() - begun


def best_of(call, times: int = 5) -> float:
    """[s] of the best of several calls, after one that compiles and warms."""
    call()
    return min(timed(call) for _ in range(times))


def best_of_each(calls: dict, rounds: int = 50) -> dict:
    """[s] of the best of many short calls of each, in turns, so that what else the machine does falls on all alike."""
    best = {name: best_of(call, 1) for name, call in calls.items()}
    for _ in range(rounds):
        for name, call in calls.items():
            best[name] = min(best[name], timed(call))
    return best


def wall(*command: str) -> float:
    """[s] that a command takes from a cold shell."""
    return timed(lambda: subprocess.run(command, check=True, capture_output=True))


def machine() -> str:
    """Processor, cores and versions, in one line."""
    import numba
    import numpy

    name = platform.processor() or platform.machine()
    listed = Path("/proc/cpuinfo")
    if listed.exists():
        lines = listed.read_text().splitlines()
        names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
        name = f"{names[0]}, {len(names)} cores" if names else name
    return f"{name}; Python {platform.python_version()}, NumPy {numpy.__version__}, Numba {numba.__version__}"
