"""Figures and numbers of docs/tether-validation.md: `python docs/gallery/tether_validation.py`.

Writes tether_rest.png, tether_swings.png and tether_orders.png beside this file and prints the numbers of the page. The
manufactured solution is that of the tests.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

HERE = Path(__file__).parent
TESTS = HERE.parents[1] / "tests"
sys.path[:0] = [str(TESTS / "support"), str(TESTS / "analytic" / "tether")]

import test_manufactured as manufactured  # noqa: E402

import tether_flights as tf  # noqa: E402
from fieldline.analysis.line_shape import skiprope_of  # noqa: E402
from fieldline.analysis.tether import eigenmotions, hanging_line, libration_ratio  # noqa: E402

BLUE, RED, GREEN, GREY = "#0072b2", "#d55e00", "#009e73", "#848c94"  # colours that the colour-blind tell apart
LINE = (tf.LENGTH_M, tf.KG_PER_M, tf.STIFFNESS_N, tf.PROBE_KG, tf.SHIP_KG, tf.TOP_M)
SEGMENTS = (4, 8, 16, 32, 64, 128)
NODES = 10
DAMPED = 0.05 * tf.STIFFNESS_N


def panels(count: int, width: float = 10.5, height: float = 3.5):
    """Axes side by side."""
    figure, axes = plt.subplots(1, count, figsize=(width, height), constrained_layout=True)
    for panel in axes:
        panel.grid(alpha=0.25, linewidth=0.6)
        panel.spines[["top", "right"]].set_visible(False)
    return figure, axes


def saved(figure, name: str) -> None:
    """The figure as PNG."""
    figure.savefig(HERE / name, dpi=130, metadata={"Software": None})
    plt.close(figure)


def slope(panel, x, y, order: int) -> None:
    """A line of an order through the last point."""
    panel.loglog(x, y[-1] * (np.asarray(x) / x[-1]) ** order, ":", color=GREY, linewidth=1.2, label=f"order {abs(order)}")


def rest() -> None:
    """Tension, convergence of the state of rest and of modes, and shapes."""
    continuum = hanging_line(*LINE, None)
    modes = eigenmotions(continuum)
    fit = np.polynomial.Polynomial.fit(continuum.grid.place, continuum.tension, 14)
    errors = []
    for segments in SEGMENTS:
        hanging = hanging_line(*LINE, segments - 1)
        found = eigenmotions(hanging)
        errors.append(
            (
                np.abs(hanging.tension - fit(hanging.grid.station)).max() / continuum.tension.max(),
                abs(found.out_of_plane.rate[1] / modes.out_of_plane.rate[1] - 1.0),
                abs(found.along_line.rate[0] / modes.along_line.rate[0] - 1.0),
                abs(found.in_plane.rate[0] / modes.in_plane.rate[0] - 1.0),
            )
        )
    figure, (left, middle, right) = panels(3)
    chain = hanging_line(*LINE, NODES)
    left.plot(continuum.tension, continuum.height / 1e3, color=BLUE, label="continuum")
    left.plot(chain.tension, chain.grid.station / 1e3, "o", color=RED, markersize=4, label="11 segments")
    left.set(xlabel="tension [N]", ylabel="height above the probe [km]", title="At rest")
    left.legend(frameon=False)
    names = ("tension", "lateral, 1st", "along, 1st", "libration")
    for k, (name, colour) in enumerate(zip(names, (BLUE, RED, GREEN, "#cc79a7"), strict=True)):
        middle.loglog(SEGMENTS, [one[k] for one in errors], "o-", color=colour, markersize=3.5, label=name)
    slope(middle, SEGMENTS, [one[0] for one in errors], -2)
    middle.set(xlabel="segments", ylabel="relative error", title="Nodes against the continuum")
    middle.legend(frameon=False, fontsize=8)
    for k, colour in enumerate((GREY, BLUE, RED, GREEN)):
        words = f"{modes.out_of_plane.rate[k] / continuum.rate:.4f} n"
        right.plot(modes.out_of_plane.shape[k], continuum.height / 1e3, color=colour, label=words)
    right.set(xlabel="deflection", title="Modes across the plane")
    right.legend(frameon=False, fontsize=8, loc="lower left")
    saved(figure, "tether_rest.png")
    for name, values in zip(names, np.array(errors).T, strict=True):
        print(f"{name}: " + ", ".join(f"{n} {e:.2e}" for n, e in zip(SEGMENTS, values, strict=True)))


def libration(degrees: float) -> float:
    """Frequency over the orbital rate of a flown libration."""
    hang = {"in_plane_deg": degrees}
    one = tf.points(tf.flown(tf.hung(NODES, seconds=9000, output=20, step=0.2, hang=hang, damping_n_s=DAMPED)))
    angle = tf.shape(one).in_plane_rad
    k = np.flatnonzero(np.diff(np.sign(angle)))
    return np.pi / np.diff(one.seconds[k] - 20.0 * angle[k] / np.diff(angle)[k]).mean() / tf.at_rest(NODES).rate


def swings() -> None:
    """Libration against its amplitude, and a skiprope over its beat."""
    figure, (left, right) = panels(2)
    degrees = np.array([1.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0])
    flown = np.array([libration(one) for one in degrees])
    fine = np.linspace(0.0, 65.0, 100)
    length = eigenmotions(tf.at_rest(NODES)).in_plane.rate[0] / tf.at_rest(NODES).rate
    left.plot(
        fine, length / np.sqrt(3.0) * libration_ratio(np.radians(fine)), color=BLUE, label="√3 π / 2K, with the length's part"
    )
    left.plot(degrees, flown, "o", color=RED, label="flown")
    left.set(xlabel="amplitude [deg]", ylabel="frequency over the orbital rate", title="Libration in the plane")
    left.legend(frameon=False)
    for one, rate in zip(degrees, flown, strict=True):
        print(f"libration {one:4.0f} deg: {rate:.5f}, law {length / np.sqrt(3.0) * libration_ratio(np.radians(one)):.5f}")
    scenario = tf.hung(NODES, seconds=115_000, output=60, step=0.2, start={"skiprope_amplitude_m": 20.0}, damping_n_s=DAMPED)
    one = tf.points(tf.flown(scenario))
    found = skiprope_of(tf.shape(one), one.seconds)
    orbits = one.seconds * tf.at_rest(NODES).rate / (2.0 * np.pi)
    right.plot(orbits, found.semi_major_m, color=BLUE, label="larger half axis")
    right.plot(orbits, found.semi_minor_m * np.sign(found.sense), color=RED, label="smaller, negative when left-handed")
    right.axhline(0.0, color=GREY, linewidth=0.7)
    right.set(xlabel="orbits", ylabel="[m]", title="A skiprope of 20 m, begun round", ylim=(-24.0, 42.0))
    right.legend(frameon=False, fontsize=8, loc="upper right", ncols=2)
    saved(figure, "tether_swings.png")
    turns = np.flatnonzero(np.diff(np.sign(found.sense)))
    print("a plane at orbits", orbits[turns])


def orders() -> None:
    """The manufactured solution: nodes and steps."""
    figure, (left, right) = panels(2, width=9.5)
    segments = (5, 10, 20, 40)
    nodes = np.array([manufactured.flown(n - 1, "of_continuum", 2e-3) for n in segments])
    for k, (name, colour) in enumerate((("place [m]", BLUE), ("velocity [m/s]", RED), ("tension / EA", GREEN))):
        left.loglog(segments, nodes[:, k], "o-", color=colour, markersize=4, label=name)
    slope(left, segments, nodes[:, 0], -2)
    left.set(xlabel="segments", ylabel="largest error after 3 s", title="Nodes, force of the continuum")
    left.set_xticks(segments, [str(n) for n in segments])
    left.minorticks_off()
    left.legend(frameon=False, fontsize=8)
    steps = (0.08, 0.04, 0.02, 0.01)
    errors = np.array([manufactured.flown(11, "of_chain", step) for step in steps])
    right.loglog(steps, errors[:, 0], "o-", color=BLUE, markersize=4, label="rk4: place [m] against step [s]")
    slope(right, steps[:3], errors[:3, 0], 4)
    tolerances = (1e-2, 1e-3, 1e-4, 1e-5)
    for method, colour in (("rosenbrock", RED), ("dop853", GREEN)):
        more = [{"position_tolerance_m": one, "velocity_tolerance_m_s": 1e-3 * one} for one in tolerances]
        places = [manufactured.flown(11, "of_chain", 0.01, method, **one)[0] for one in more]
        right.loglog(tolerances, places, "s-", color=colour, markersize=4, label=f"{method}: place [m] against tolerance [m]")
        print(method, ", ".join(f"{one:.0e} {place:.1e}" for one, place in zip(tolerances, places, strict=True)))
    right.set(xlabel="step [s], or tolerance [m]", title="Steps, force of the chain", ylim=(1e-9, 10.0))
    right.legend(frameon=False, fontsize=7.5, loc="upper left")
    saved(figure, "tether_orders.png")
    print("orders of nodes", np.log2(nodes[:-1] / nodes[1:]).round(3).tolist())
    print("orders of rk4", np.log2(errors[:-1, 0] / errors[1:, 0]).round(3).tolist())


if __name__ == "__main__":
    rest()
    swings()
    orders()
