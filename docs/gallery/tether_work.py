"""Work against precision of a day on a line of 50 nodes: `python docs/gallery/tether_work.py`.

Writes tether_work.png beside this file and prints its numbers. The flights are those of `benchmarks/line.py`; on a machine that
does other work meanwhile the seconds grow, of all methods alike.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parents[1] / "benchmarks"))
import line  # noqa: E402

BLUE, RED, GREEN = "#0072b2", "#d55e00", "#009e73"
TOLERANCES_M = (1e-1, 1e-2, 1e-3, 1e-4)
NODES = 50


def error_of(flight, truth) -> float:
    """Largest error of any place on the line at the end [m]."""
    return float(np.abs(line.points(flight, flight.y)[:, :3] - line.points(truth, truth.y)[:, :3]).max())


def draw() -> None:
    """Seconds of one core against the error after a day."""
    figure, axes = plt.subplots(figsize=(6.4, 4.0), constrained_layout=True)
    for tau, colour, style in ((0.05, BLUE, "o-"), (0.5, GREEN, "D--")):
        truth, _ = line.flown(line.implicit(NODES, tau, 1e-5))
        flown = [line.flown(line.implicit(NODES, tau, one)) for one in TOLERANCES_M]
        errors, seconds = [error_of(flight, truth) for flight, _ in flown], [taken for _, taken in flown]
        axes.loglog(errors, seconds, style, color=colour, markersize=4, label=f"implicit, c/EA = {tau:g} s")
        print(f"implicit, {tau:g} s:", *(f"{e:.2g} m in {s:.2f} s," for e, s in zip(errors, seconds, strict=True)))
        flight, taken = line.flown(line.scenario(NODES, tau, method="rk4", step_s=line.held_step(NODES, tau)))
        error = error_of(flight, truth)
        axes.loglog(error, taken, style[0], color=RED, markersize=6, label=f"rk4 at its longest step, c/EA = {tau:g} s")
        print(f"rk4, {tau:g} s: {error:.2g} m in {taken:.1f} s")
    axes.axvline(1.0, color="0.6", linestyle=":", linewidth=0.9)
    axes.set(xlabel="largest error of any place on the line after a day [m]", ylabel="seconds of one core")
    axes.grid(alpha=0.25, linewidth=0.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, fontsize=9)
    figure.savefig(HERE / "tether_work.png", dpi=110)
    plt.close(figure)


if __name__ == "__main__":
    draw()
