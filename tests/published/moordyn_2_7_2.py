"""The script that wrote moordyn_2_7_2.csv: two lines without water by MoorDyn 2.7.2 (`pip install moordyn==2.7.2`).

    python moordyn_2_7_2.py          writes the CSV beside it: case, time [s], point, x, y, z [m], tension at either end [N]

pendulum: 100 m, ten segments, held at (0, 0, -100), 12 kg free at (60, 0, -180).
driven:   100 m, twenty segments, held at (0, 0, -100); the other end begins at (80, 0, -90) and moves by
          (2, 1.5, 0) (1 - cos(2 pi t / 5)) m, told anew every 0.1 ms.

Both: 0.2 kg/m, EA 20 kN, internal damping 200 N s, no bending, no water (density 0, no drag, no added mass), g = 9.80665,
RK4 at 0.1 ms, no relaxation of the initial shape, which is MoorDyn's own and the first time of the table.
"""

import csv
from pathlib import Path

import moordyn
import numpy as np

FILE = Path(__file__).with_suffix(".csv")
RATE = 2.0 * np.pi / 5.0
CASES = {
    "pendulum": (["Fixed 0 0 -100 0", "Free 60 0 -180 12"], 10, 1e-2, (1, 2, 5, 10)),
    "driven": (["Fixed 0 0 -100 0", "Coupled 80 0 -90 0"], 20, 1e-4, (1, 2, 5, 10)),
}
TEXT = """--- MoorDyn Input File
no water
--- LINE TYPES
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
rope 1.0e-3 0.2 2e4 2e2 0 0 0 0 0
--- POINTS
Node Type X Y Z M V CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 {0} 0 0 0
2 {1} 0 0 0
--- LINE LIST
Line LineType NodeA NodeB UnstrLen NumSegs Flags/Outputs
(-) (-) (-) (-) (m) (-) (-)
1 rope 1 2 100 {2} -
--- SOLVER OPTIONS
0 writeLog
1e-4 dtM
RK4 tScheme
9.80665 g
0.0 WtrDnsty
1000 WtrDpth
0.0 kb
0.0 cb
0.0 TmaxIC
--- END
"""


def coupled(case, t):
    """Place and velocity of the end that is moved."""
    if case == "pendulum":
        return [], []
    way = np.array([2.0, 1.5, 0.0])
    return np.array([80.0, 0.0, -90.0]) + way * (1.0 - np.cos(RATE * t)), way * RATE * np.sin(RATE * t)


def run(case):
    """Rows of a case."""
    points, segments, step, times = CASES[case]
    Path("line.txt").write_text(TEXT.format(*points, segments))
    system = moordyn.Create("line.txt")
    moordyn.Init(system, *coupled(case, 0.0))
    line = moordyn.GetLine(system, 1)
    wanted = {round(t / step): t for t in (0, *times)}
    for k in range(max(wanted) + 1):
        if k in wanted:
            tension = [np.linalg.norm(moordyn.GetLineNodeTen(line, j)) for j in (0, segments)]
            for j in range(segments + 1):
                place = moordyn.GetLineNodePos(line, j)
                yield [case, wanted[k], j, *(f"{v:.10f}" for v in place), *(f"{v:.7f}" for v in tension)]
        moordyn.Step(system, *coupled(case, k * step), k * step, step)
    moordyn.Close(system)


if __name__ == "__main__":
    with FILE.open("w", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(["case", "t_s", "point", "x_m", "y_m", "z_m", "tension_first_n", "tension_last_n"])
        for name in CASES:
            writer.writerows(run(name))
