"""How long, how much memory, on which machine."""

from __future__ import annotations

import platform
import subprocess
import sys
import time
from pathlib import Path


def best_of(call, times: int = 3) -> float:
    """[s] of the best of several runs, after one that compiles and warms."""
    call()
    taken = []
    for _ in range(times):
        begun = time.perf_counter()
        call()
        taken.append(time.perf_counter() - begun)
    return min(taken)


def wall(*command: str) -> float:
    """[s] that a command takes from a cold shell."""
    begun = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    return time.perf_counter() - begun


def peak_memory_mb() -> float:
    """[MB] the most that this process has held."""
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / (1e6 if sys.platform == "darwin" else 1e3)


def machine() -> str:
    """Processor, cores and versions, in one line."""
    import numba
    import numpy

    name = platform.processor() or platform.machine()
    listed = Path("/proc/cpuinfo")
    if listed.exists():
        text = listed.read_text()
        names = [line.split(":", 1)[1].strip() for line in text.splitlines() if line.startswith("model name")]
        name = f"{names[0]}, {len(names)} cores" if names else name
    return f"{name}; Python {platform.python_version()}, NumPy {numpy.__version__}, Numba {numba.__version__}"
