"""Figures and numbers of the flight from tumbling to pointing: `python docs/gallery/tumbling_to_pointing.py [seeds]`.

Writes tumbling_to_pointing.png beside this file and prints one row a seed.
"""

from __future__ import annotations

import io
import sys
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
BLUE, RED, FAINT = "#0072b2", "#d55e00", "#9a9a9a"  # colours that the colour-blind tell apart
SLOW_DEG_S = 0.6
ORBIT_H = 1.577


def flown(seed: int) -> dict:
    """The template flown for a day: hours, rate [deg/s], errors of knowledge and pointing [deg], NaN where not known."""
    run = fl.simulate(fl.Scenario.from_toml(template("chain", "chain")), seed=seed)
    n = run.sizes["time"]
    column = {name: np.asarray(run[name].values).reshape(n, -1) for name in ("q_bi", "q_bi_known", "omega_bi_b")}
    column |= {name: np.asarray(run[name].values).reshape(n, 3) for name in ("position_i", "velocity_i", "torquer_moment")}
    known = np.isfinite(column["q_bi_known"]).all(axis=1)
    knowledge = np.full(n, np.nan)
    knowledge[known] = angle_deg(column["q_bi"][known], column["q_bi_known"][known])
    turns = dcm_oi(column["position_i"], column["velocity_i"])
    return {
        "hours": (run.time.values - run.time.values[0]) / np.timedelta64(1, "h"),
        "rate": np.degrees(np.linalg.norm(column["omega_bi_b"], axis=1)),
        "knowledge": knowledge,
        "pointing": angle_deg(column["q_bi"], np.array([quaternion_from_dcm(turn) for turn in turns])),
        "moment": np.abs(column["torquer_moment"]).max(axis=1),
    }


def angle_deg(a, b) -> np.ndarray:
    """(n,) between attitudes."""
    return np.degrees(np.linalg.norm(rotation_error_b(a, b), axis=1))


def numbers(flight: dict) -> str:
    """One row: when it had stopped, knew an attitude, pointed within 10 deg for an orbit; errors of the last six hours."""
    hours, pointing, knowledge = flight["hours"], flight["pointing"], flight["knowledge"]
    late = hours > hours[-1] - 6.0
    slow = hours[np.flatnonzero(flight["rate"] > SLOW_DEG_S)[-1] + 1]
    known = hours[np.flatnonzero(np.isfinite(knowledge))[0]]
    points = next((t for t in hours if pointing[(hours >= t) & (hours < t + ORBIT_H)].max() < 10.0), np.nan)
    parts = [slow, known, points, rms(knowledge[late]), np.nanmax(knowledge[late]), rms(pointing[late]), pointing[late].max()]
    return " | ".join(f"{value:.1f}" for value in parts) + f" | {100 * np.isnan(knowledge[hours > known]).mean():.0f} %"


def rms(values) -> float:
    """Over what is known."""
    return float(np.sqrt(np.nanmean(values**2)))


def draw(flight: dict) -> None:
    """Rate, knowledge and pointing over the day."""
    figure, panels = plt.subplots(3, 1, figsize=(7.6, 6.2), sharex=True, constrained_layout=True)
    rows = (
        ("rate", "rate [deg/s]", FAINT),
        ("knowledge", "error of knowledge [deg]", BLUE),
        ("pointing", "error of pointing [deg]", RED),
    )
    for panel, (name, label, colour) in zip(panels, rows, strict=True):
        panel.semilogy(flight["hours"], flight[name], color=colour, linewidth=0.9)
        panel.set_ylabel(label)
        panel.grid(alpha=0.25, linewidth=0.6)
        panel.spines[["top", "right"]].set_visible(False)
    panels[-1].set_xlabel("time [h]")
    panels[-1].set_xlim(0.0, flight["hours"][-1])
    panels[0].set_title("From 7 deg/s to the Earth by magnetometer and torquers alone", loc="left", fontsize=10)
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=110)
    plt.close(figure)
    Image.open(drawn).convert("RGB").quantize(64).save(HERE / "tumbling_to_pointing.png", optimize=True)


if __name__ == "__main__":
    print("seed | slow [h] | attitude [h] | within 10 deg [h] | knowledge RMS | max [deg] | pointing RMS | max [deg] | lost")
    for seed in [int(word) for word in sys.argv[1:]] or [1]:
        flight = flown(seed)
        print(seed, "|", numbers(flight), flush=True)
        if seed == 1:
            draw(flight)
