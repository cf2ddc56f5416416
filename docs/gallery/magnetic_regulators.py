"""Four ways of holding three axes by the field alone, in the plant: `python docs/gallery/magnetic_regulators.py`.

Writes magnetic_regulators.png beside this file and prints one row a law.
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
LAWS = {
    "magnetic-lqr-periodic": "#0072b2",
    "magnetic-lqr-asymptotic": "#d55e00",
    "magnetic-lqr-averaged": "#009e73",
    "magnetic-pd": "#9a9a9a",
}  # colours that the colour-blind tell apart
ORBITS = 15.0


def flown(law: str, cancel: bool) -> tuple[np.ndarray, np.ndarray]:
    """Orbits since the start and angle to the goal [deg] over a day of the template."""
    scenario = fl.Scenario.from_toml(template("regulator", "regulator"))
    parameters = {"target": "nadir", "cancel_residual": cancel}
    changes = {"time.duration_orbits": ORBITS, "software.0.law": law}
    run = fl.simulate(scenario.replace(**changes, **{"software.0.parameters": parameters}))
    n = run.sizes["time"]
    position, velocity, q_bi = (np.asarray(run[name].values).reshape(n, -1) for name in ("position_i", "velocity_i", "q_bi"))
    q_oi = np.array([quaternion_from_dcm(turn) for turn in dcm_oi(position, velocity)])
    return ORBITS * np.arange(n) / (n - 1), np.degrees(np.linalg.norm(rotation_error_b(q_oi, q_bi), axis=1))


def row(orbits, angle) -> str:
    """When it stays within a degree; RMS and largest angle of the last five orbits."""
    far = np.flatnonzero(angle > 1.0)
    within = f"{orbits[far[-1] + 1]:.1f}" if far[-1] + 1 < len(orbits) else "-"
    late = angle[orbits > ORBITS - 5.0]
    return f"{within} | {np.sqrt(np.mean(late**2)):.2f} | {late.max():.2f}"


def draw(curves: dict) -> None:
    """Angle to the goal by law, residual dipole cancelled."""
    figure, panel = plt.subplots(figsize=(7.6, 3.6), constrained_layout=True)
    for law, (orbits, angle) in curves.items():
        panel.semilogy(orbits, angle, color=LAWS[law], linewidth=1.0, label=law)
    panel.axhline(0.5, color="#222222", linestyle=":", linewidth=0.9)
    panel.set(xlabel="orbits", ylabel="angle to the goal [deg]", xlim=(0.0, ORBITS))
    panel.legend(frameon=False, fontsize=8)
    panel.grid(alpha=0.25, linewidth=0.6)
    panel.spines[["top", "right"]].set_visible(False)
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=110)
    plt.close(figure)
    Image.open(drawn).convert("RGB").quantize(160).save(HERE / "magnetic_regulators.png", optimize=True)


if __name__ == "__main__":
    print("law | dipole cancelled | within 1 deg from orbit | RMS | max of the last five orbits [deg]")
    curves = {}
    for law in LAWS:
        for cancel in (True, False):
            orbits, angle = flown(law, cancel)
            print(law, "|", "yes" if cancel else "no", "|", row(orbits, angle), flush=True)
            if cancel:
                curves[law] = (orbits, angle)
    draw(curves)
