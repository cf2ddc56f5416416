"""A hanging chain in MoorDyn (`moordyn` of PyPI): no water, no bending, RK4, stepped as finely as its stiffness asks."""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

STEP_S = 1e-3
TEXT = """--- MoorDyn Input File
no water
--- LINE TYPES
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
rope 1.0e-3 0.2 2e4 2e2 0 0 0 0 0
--- POINTS
Node Type X Y Z M V CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 0 0 -100 0 0 0 0
2 Free 60 0 -580 12 0 0 0
--- LINE LIST
Line LineType NodeA NodeB UnstrLen NumSegs Flags/Outputs
(-) (-) (-) (-) (m) (-) (-)
1 rope 1 2 500 {segments} -
--- SOLVER OPTIONS
0 writeLog
{step} dtM
RK4 tScheme
9.80665 g
0.0 WtrDnsty
1000 WtrDpth
0.0 kb
0.0 cb
0.0 TmaxIC
--- END
"""


def segments_per_second(nodes: int, seconds: float = 0.05, rounds: int = 60) -> float:
    """Evaluations of a segment a second, four a step, of the best of several stretches of flight."""
    import moordyn

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "line.txt"
        file.write_text(TEXT.format(segments=nodes + 1, step=STEP_S), encoding="utf-8")
        system = moordyn.Create(str(file))
        moordyn.Init(system, [], [])
        best = float("inf")
        for k in range(rounds):
            begun = time.perf_counter()
            moordyn.Step(system, [], [], k * seconds, seconds)
            best = min(best, time.perf_counter() - begun)
        moordyn.Close(system)
    return 4.0 * (nodes + 1) * seconds / STEP_S / best
