"""Figures and numbers of wheels with and without unloading: `python docs/gallery/momentum_and_wheels.py`.

Writes momentum_and_wheels.png and momentum_and_wheels_dipole.png beside this file and prints one row a flight.
"""

from __future__ import annotations

import io
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from PIL import Image

import fieldline as fl
from fieldline.frames.attitude import quaternion_from_dcm, rotation_error_b
from fieldline.frames.orbital import dcm_oi
from fieldline.simulate.scenario.templates import template

HERE = Path(__file__).parent
BLUE, RED, GREEN = "#0072b2", "#d55e00", "#009e73"  # colours that the colour-blind tell apart
AXES = np.array([[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [-1.0, -1.0, 1.0], [1.0, -1.0, 1.0]]) / np.sqrt(3.0)
POINTING = {"target": "nadir", "natural_frequency_rad_s": 0.05}
THRESHOLDS = {"start_n_m_s": 0.03, "stop_n_m_s": 0.005}
LAW = "wheel-pointing-with-desaturation"
FLIGHTS = {
    "wheels alone": ("wheel-pointing", {}),
    "unloaded at all times": (LAW, {}),
    "unloaded between thresholds": (LAW, THRESHOLDS),
    "the same, dipole cancelled": (LAW, THRESHOLDS | {"cancel_residual": True}),
}
LARGEST = 0.12  # N m s of a wheel, in place of the template's 0.5: a day fills it
START = 0.02
SETTLED_H = 4.0


def flown(law: str, more: dict) -> dict:
    """A day of the template with smaller wheels: hours, momentum [N m s], pointing error [deg], magnetic torque [N m]."""
    text = template("wheels", "wheels").replace("momentum_max_n_m_s = 0.5", f"momentum_max_n_m_s = {LARGEST}")
    text = text.replace("momentum_n_m_s = 0.1 ", f"momentum_n_m_s = {START} ")
    scenario = fl.Scenario.from_toml(text)
    changes = {"time.duration_orbits": 15.2, "time.output_step_s": 30.0, "software.0.law": law}
    run = fl.simulate(scenario.replace(**changes, **{"software.0.parameters": POINTING | more}))
    n = run.sizes["time"]
    column = {name: np.asarray(run[name].values).reshape(n, 3) for name in ("position_i", "velocity_i")}
    turns = dcm_oi(column["position_i"], column["velocity_i"])
    q_oi = np.array([quaternion_from_dcm(turn) for turn in turns])
    wheels = np.asarray(run["wheel_momentum"].values).reshape(n, 4)
    error = rotation_error_b(q_oi, np.asarray(run["q_bi"].values).reshape(n, 4))
    names = [str(name) for name in run["load"].values]
    torque = run["torque_b"].transpose("time", "load", ...).values.reshape(n, len(names), 3)
    magnetic = sum(torque[:, names.index(name)] for name in ("torquers", "dipoles") if name in names)
    return {
        "hours": (run.time.values - run.time.values[0]) / np.timedelta64(1, "h"),
        "fullest": np.abs(wheels).max(axis=1),
        "momentum": np.linalg.norm(wheels @ AXES, axis=1),
        "error": np.degrees(np.linalg.norm(error, axis=1)),
        "magnetic": np.linalg.norm(magnetic, axis=1),
    }


def row(flight: dict) -> str:
    """After it has settled: fullest wheel, momentum, pointing RMS and largest, magnetic torque."""
    late = flight["hours"] > SETTLED_H
    error, torque = flight["error"][late], flight["magnetic"][late]
    return (
        f"{flight['fullest'][late].max():.4f} | {flight['momentum'][late].max():.4f} | {np.sqrt(np.mean(error**2)):.4f} | "
        f"{error.max():.4f} | {1e6 * np.sqrt(np.mean(torque**2)):.2f} | {1e6 * np.median(torque):.2f}"
    )


def panels(count: int, height: float):
    """Axes one over the other."""
    figure, axes = plt.subplots(count, 1, figsize=(7.6, height), sharex=True, constrained_layout=True, squeeze=False)
    for panel in axes[:, 0]:
        panel.grid(alpha=0.25, linewidth=0.6)
        panel.spines[["top", "right"]].set_visible(False)
    axes[-1, 0].set_xlabel("time [h]")
    axes[-1, 0].set_xlim(0.0, 24.0)
    return figure, axes[:, 0]


def finish(figure, name: str) -> None:
    """Save as a PNG of few colours, which is small."""
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=110)
    plt.close(figure)
    Image.open(drawn).convert("RGB").quantize(160).save(HERE / name, optimize=True)


def draw(flights: dict) -> None:
    """Wheels with and without unloading; the magnetic torque with and without the dipole cancelled."""
    colours = dict(zip(FLIGHTS, (RED, BLUE, GREEN, BLUE), strict=True))
    figure, (wheels, error) = panels(2, 4.8)
    for name in list(FLIGHTS)[:3]:
        wheels.plot(flights[name]["hours"], flights[name]["fullest"], color=colours[name], linewidth=1.0, label=name)
        error.semilogy(flights[name]["hours"], flights[name]["error"], color=colours[name], linewidth=0.8)
    wheels.axhline(LARGEST, color="#222222", linestyle=":", linewidth=0.9)
    wheels.set_ylabel("fullest wheel [N m s]")
    wheels.legend(frameon=False)
    error.set_ylabel("pointing error [deg]")
    finish(figure, "momentum_and_wheels.png")
    figure, (torque, momentum) = panels(2, 4.8)
    for name, colour in zip(list(FLIGHTS)[2:], (RED, BLUE), strict=True):
        torque.semilogy(flights[name]["hours"], flights[name]["magnetic"], color=colour, linewidth=0.8, label=name)
        momentum.plot(flights[name]["hours"], flights[name]["momentum"], color=colour, linewidth=1.0)
    torque.set_ylabel("dipole and torquers [N m]")
    torque.set_ylim(3e-8, 2e-3)
    torque.legend(frameon=False, ncol=2)
    momentum.set_ylabel("momentum in the wheels [N m s]")
    finish(figure, "momentum_and_wheels_dipole.png")


if __name__ == "__main__":
    print("flight | fullest wheel, momentum [N m s] | pointing RMS, max [deg] | magnetic torque RMS, median [uN m]")
    flights = {}
    for name, (law, more) in FLIGHTS.items():
        flights[name] = flown(law, more)
        print(name, "|", row(flights[name]), flush=True)
    draw(flights)
