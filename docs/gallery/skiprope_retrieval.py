"""A tether taken in from 20 km to 2.4 km while it skips, followed throughout: `python docs/gallery/skiprope_retrieval.py`.

The reel reports the length that is out; the tool takes it as `--tether-lengths` and follows (`estimation.skiprope.reeled`).
"""

from __future__ import annotations

import numpy as np
from skiprope_flight import fly, save, seconds_of, telemetry

import fieldline as fl
from fieldline.estimation.skiprope_telemetry import TetherLengths
from fieldline.report.series import legend, line
from fieldline.report.theme import AXIS_COLOURS, GREY, INK, WARM, label_outer, panels, themed

MASS_KG, LINEAR_KG_M = 520.0, 8.35e-3
LEAST_HZ = 1e-3
SCENARIO = """
name = "retrieval"
time = { start_utc = 2026-03-01T00:00:00Z, duration_s = 21000.0, output_step_s = 5.0 }
integrator = { method = "rosenbrock" }
environment = { field = "IGRF-14", gravity = "point" }
[orbit.elements]
altitude_km = 320.0
inclination_deg = 28.5
raan_deg = 40.0
[[body]]
name = "satellite"
mass_kg = 520.0
inertia_kg_m2 = [200.0, 200.0, 180.0]
gravity_gradient = true
attitude = { euler_321_deg = [0.0, 0.5, 0.0], axes = "orbital" }
rate_deg_s = [0.0, 0.0, 0.0]
rate_axes = "orbital"
[body.magnetometer]
rate_hz = 1.0
noise_std_nt = 20.0
quantum_nt = 2.0
[[body]]
name = "orbiter"
kind = "point"
mass_kg = 100000.0
hang = { upward = false }
[[line]]
name = "tether"
from_body = "satellite"
from_point_b_m = [0.0, 0.0, 1.0]
to_body = "orbiter"
rest_length_m = 20000.0
stiffness_n = 1.0e5
damping_n_s = 3.0e4
from_joint_damping_n_m_s = 4.0
nodes = 96
mass_per_length_kg_m = 8.35e-3
start = { skiprope_amplitude_m = 20.0 }
reel = { total_length_m = 20000.0, shortest_length_m = 1000.0, rate_max_m_s = 8.0, lag_s = 100.0 }
[[software]]
body = "orbiter"
law = "reel-exponential"
rate_hz = 0.5
[software.parameters]
target_length_m = 2400.0
rate_in_per_s = 1.0e-4
in_plane_damping = 0.7
"""


def follow(sent, lengths: TetherLengths, method: str) -> np.ndarray:
    """Rows of time [s], the middle's U and V [m], frequency [Hz], whether trusted; "reeled" is told nothing of the reel."""
    if method == "reeled":
        found = fl.estimate_skiprope(sent, tether_length_m=1.0, method="kalman", reeled=True)
    else:
        found = fl.estimate_skiprope(sent, lengths=lengths, end_mass_kg=MASS_KG, tether_kg_m=LINEAR_KG_M, method=method)
    at = (found.time.values - sent.time_utc[0]).astype(np.int64) * 1e-9
    scale = lengths.at(found.time.values)[:, None] if method == "reeled" else 1.0
    return np.column_stack([at, scale * found.position_m.values, found.frequency_hz.values, found.trusted.values])


def about_its_mean(place, seconds, frequency_hz) -> np.ndarray:
    """Places (n, 2) less their mean over the turn about each: taking in bows the line ahead, and that is no skiprope."""
    width = np.maximum(np.interp(seconds, *frequency_hz), LEAST_HZ) ** -1.0
    first, last = (np.searchsorted(seconds, seconds + sign * 0.5 * width) for sign in (-1.0, 1.0))
    total = np.concatenate([np.zeros((1, 2)), np.cumsum(place, axis=0)])
    return place - (total[last] - total[first]) / np.maximum(last - first, 1)[:, None]


def main() -> None:
    """Fly, follow, print, draw."""
    run, place = fly(SCENARIO)
    seconds, length = seconds_of(run), run.deployed_length_tether.values
    sent = telemetry(run)
    drawn = {}
    for method in ("harmonic", "kalman", "reeled"):
        rows = follow(sent, TetherLengths(run.time.values, length), method)
        swing = about_its_mean(place, seconds, (rows[:, 0], rows[:, 3]))
        found = rows[:, 1:3]
        true = np.stack([np.interp(rows[:, 0], seconds, column) for column in swing.T], axis=-1)
        drawn[method] = (rows, found)
        for start in range(0, 21000, 3000):
            part = (rows[:, 0] >= start) & (rows[:, 0] < start + 3000)
            if not part.any():
                continue
            p, q = found[part], true[part]
            off = np.arctan2(-p[:, 0], p[:, 1]) - np.arctan2(-q[:, 0], q[:, 1])
            off = np.degrees((off + np.pi) % (2 * np.pi) - np.pi)
            size = np.sqrt(np.mean(np.sum(q**2, axis=1)))
            radius = np.sqrt(np.mean(np.sum((p - q) ** 2, axis=1)))
            sure = rows[part, 4] > 0.0
            trusted = f"{100.0 * sure.mean():.0f} %"
            if sure.any():
                trusted += f", {np.sqrt(np.mean(np.sum((p - q)[sure] ** 2, axis=1))):.1f} m, sd {off[sure].std():.1f} deg"
            share = 100.0 * (np.sqrt(np.mean(np.sum(p**2, axis=1))) / size - 1.0)
            print(
                f"{method} {start} s: {np.interp(start, seconds, length):.0f} m, {1e3 * rows[part, 3].mean():.2f} mHz, "
                f"true {size:.1f} m, radius off {radius:.1f} m, plane {off.mean():.1f} sd {off.std():.1f} deg, "
                f"deflection {share:.0f} %; trusted {trusted}"
            )
    draw(seconds, length, swing, drawn["harmonic"])


def draw(seconds, length, swing, followed) -> None:
    """Length, frequency and radius over time."""
    rows, found = followed
    with themed():
        figure, axes = panels(3, 1, height_in=4.8, row_gap=0.16)
        line(axes[0, 0], seconds, 1e-3 * length, GREY)
        axes[0, 0].set(ylabel="out [km]", ylim=(0.0, 21.0))
        line(axes[1, 0], rows[:, 0], 1e3 * rows[:, 3], AXIS_COLOURS[0])
        axes[1, 0].set(ylabel="frequency [mHz]", ylim=(0.0, 6.0))
        line(axes[2, 0], seconds, np.hypot(*swing.T), INK, "flown")
        axes[2, 0].plot(rows[:, 0], np.hypot(*found.T), ".", color=WARM, markersize=4, label="found")
        axes[2, 0].set(ylabel="radius [m]", ylim=(0.0, None))
        legend(axes[2, 0])
        for one in axes[:, 0]:
            one.set_xlim(0.0, seconds[-1])
        label_outer(axes, ("time [s]",))
        save(figure, "skiprope_retrieval")


if __name__ == "__main__":
    main()
