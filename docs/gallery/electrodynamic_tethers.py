"""Figures of electrodynamic tethers: `python docs/gallery/electrodynamic_tethers.py`.

Writes electrodynamic_tethers_*.png beside this file and prints what the page tells.
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
from fieldline.analysis.electrodynamic import current_centroid, libration_multipliers
from fieldline.constants import EARTH_GM_M3_S2
from fieldline.dynamics.lines.bare import bare_currents, bare_work, gathering
from fieldline.errors import NoEstimateError
from fieldline.simulate.scenario.templates import template

HERE = Path(__file__).parent
BLUE, RED, GREEN, GREY = "#0072b2", "#d55e00", "#009e73", "#777777"  # colours that the colour-blind tell apart
BALANCED_KG = 9.4  # of the template's module
FIELD, TAPE_WIDTH, TAPE_OHM = 0.15, 2.0 * 0.025 / np.pi, 2.82e-8 / (0.025 * 4e-5)  # [V/m], [m], [ohm/m]


def panels(count: int, height: float, **more):
    """Axes one over the other."""
    figure, axes = plt.subplots(count, 1, figsize=(7.6, height), constrained_layout=True, squeeze=False, **more)
    for panel in axes[:, 0]:
        panel.grid(alpha=0.25, linewidth=0.6)
        panel.spines[["top", "right"]].set_visible(False)
    return figure, axes[:, 0]


def finish(figure, name: str) -> None:
    """Save as a PNG of few colours, which is small."""
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=110)
    plt.close(figure)
    Image.open(drawn).convert("RGB").quantize(160).save(HERE / f"electrodynamic_tethers_{name}.png", optimize=True)


def profile(length: float, density: float, segments: int = 64):
    """Current [A] and potential [V] from the anode on, of a uniform bare tape without load."""
    work, out = bare_work(segments), np.empty(segments)
    gather = np.full(segments, gathering(TAPE_WIDTH, density) * length / segments)
    emf, ohm = np.full(segments, -FIELD * length / segments), np.full(segments, TAPE_OHM * length / segments)
    bare_currents(emf, ohm, gather, True, 0.0, 0.0, 0.1, 16.0, work, out)
    return work[0][1, : segments + 1].copy(), work[0][0, : segments + 1].copy()


def draw_profiles() -> None:
    """Along lines of several lengths."""
    figure, (current, potential) = panels(2, 4.8, sharex=True)
    for length, colour in ((500.0, BLUE), (2000.0, GREEN), (5000.0, RED), (20000.0, GREY)):
        amperes, volts = profile(length, 3e11)
        x = np.linspace(0.0, 1.0, amperes.size)
        current.plot(x, amperes, color=colour, label=f"{1e-3 * length:g} km")
        potential.plot(x, volts, color=colour)
        print(f"bare tape of {length:g} m: {amperes[-1]:.3f} A at the cathode, {volts[0]:.1f} V at the anode")
    current.axhline(FIELD / TAPE_OHM, color="#222222", linestyle=":", linewidth=0.9)
    current.set_ylabel("current [A]")
    current.legend(frameon=False, ncol=2)
    potential.set_ylabel("potential over the plasma [V]")
    potential.set_xlabel("part of the line, from the anode to the cathode")
    finish(figure, "bare")


def growth(epsilon: float, inclination_deg: float) -> float:
    """What the swing gains in an orbit, a part of itself."""
    try:
        return float(np.abs(libration_multipliers(epsilon, np.radians(inclination_deg)))[0]) - 1.0
    except NoEstimateError:
        return np.nan


def draw_growth() -> None:
    """Over epsilon and the inclination."""
    figure, (panel,) = panels(1, 3.4)
    epsilon = np.geomspace(0.08, 1.0, 12)
    for inclination, colour in ((15.0, GREY), (28.5, BLUE), (45.0, RED), (60.0, GREEN)):
        panel.loglog(epsilon, [growth(e, inclination) for e in epsilon], "o-", ms=3, color=colour, label=f"{inclination:g} deg")
    panel.loglog(epsilon, 0.12 * epsilon**3, color="#222222", linestyle=":", linewidth=0.9, label="0.12 ε³")
    panel.set_xlabel("ε, torque of the current over that of gravity")
    panel.set_ylabel("growth an orbit")
    panel.legend(frameon=False, ncol=2)
    finish(figure, "growth")


def flown(name: str, **changes):
    """A template flown, and its minutes."""
    run = fl.simulate(fl.Scenario.from_toml(template(name, name)).replace(**changes))
    assert run.attrs["complete"] == 1, run.attrs["outcome"]
    return run, run["seconds"].values / 60.0


def swing(run, name: str):
    """(n,) angles [deg] of the line from end to end in the plane of the orbit and across it."""
    position = run["position_i"].values[:, 0]
    velocity = run["velocity_i"].values[:, 0]
    points = run[f"line_position_i_{name}"].values
    chord = points[:, -1] - points[:, 0]
    up = position / np.linalg.norm(position, axis=1, keepdims=True)
    normal = np.cross(position, velocity)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along = np.cross(normal, up)
    inside = np.arctan2(np.sum(chord * along, axis=1), np.sum(chord * up, axis=1))
    across = np.arcsin(np.sum(chord * normal, axis=1) / np.linalg.norm(chord, axis=1))
    return np.degrees(inside), np.degrees(across)


def draw_tss1r() -> None:
    """An orbit on station."""
    run, minutes = flown("tss1r")
    figure, (emf, current, warmth, tension) = panels(4, 7.6, sharex=True)
    emf.plot(minutes, run["emf_tether"], color=BLUE)
    emf.set_ylabel("emf [V]")
    current.plot(minutes, run["current_tether"][:, 0], color=RED)
    current.set_ylabel("current [A]")
    temperature, pull = run["temperature_tether"].values, run["tension_tether"].values
    warmth.plot(minutes, temperature.mean(axis=1), color=GREEN)
    warmth.fill_between(
        minutes, 0.0, 1.0, where=run["sunlit"].values[:, 0] < 0.5, color="0.9", transform=warmth.get_xaxis_transform()
    )
    warmth.set_ylabel("temperature [K]")
    tension.plot(minutes, pull[:, 0], color=BLUE, label="at the orbiter")
    tension.plot(minutes, pull[:, -1], color=RED, label="at the satellite")
    tension.set_ylabel("tension [N]")
    tension.set_xlabel("time [min]")
    tension.legend(frameon=False, ncol=2)
    finish(figure, "tss1r")
    amperes, volts = run["current_tether"].values[:, 0], run["emf_tether"].values
    inside, across = swing(run, "tether")
    print(f"TSS-1R: emf {volts.min():.0f} to {volts.max():.0f} V, current {amperes.min():.2f} to {amperes.max():.2f} A")
    print(
        f"  tension {pull[:, 0].min():.1f} to {pull[:, 0].max():.1f} N, line {temperature.min():.0f} to {temperature.max():.0f} K"
    )
    sides = f"in the plane {inside.min():.2f} to {inside.max():.2f} deg, across it {across.min():.2f} to {across.max():.2f} deg"
    print(f"  swing {sides}")
    drag = np.linalg.norm(run["drag_force_i_tether"].values, axis=1).max()
    lorentz = np.linalg.norm(run["lorentz_force_i_tether"].values, axis=1).max()
    print(f"  field on the line {lorentz:.2f} N, air on it {drag:.3f} N at most")


def height(run, module_kg: float) -> np.ndarray:
    """(n,) [m] semi-major axis of the centre of the two bodies, less its start."""
    mass = np.array([14.0, module_kg])
    position = np.einsum("b,nbi->ni", mass, run["position_i"].values) / mass.sum()
    velocity = np.einsum("b,nbi->ni", mass, run["velocity_i"].values) / mass.sum()
    axis = 1.0 / (2.0 / np.linalg.norm(position, axis=1) - np.sum(velocity**2, axis=1) / EARTH_GM_M3_S2)
    return axis - axis[0]


def draw_tape() -> None:
    """The tape for some orbits, balanced and with an end mass that is too light."""
    figure, (current, fall, across) = panels(3, 6.4, sharex=True)
    for module, colour in ((BALANCED_KG, BLUE), (2.0, RED)):
        run, minutes = flown("deorbit-tape", **{"body.1.mass_kg": module, "time.duration_orbits": 6.0})
        if module == BALANCED_KG:
            current.plot(minutes, run["current_tape"].values.mean(axis=1), color=colour, linewidth=0.9)
            amperes = run["current_tape"].values
            print(f"tape: {amperes.mean():.3f} A in the mean, centroid {current_centroid(amperes.mean(axis=0)):.3f}")
            print(f"  {height(run, module)[-1]:.0f} m in six orbits")
        inside, aside = swing(run, "tape")
        fall.plot(minutes, inside, color=colour, linewidth=0.9, label=f"{module:g} kg above")
        across.plot(minutes, aside, color=colour, linewidth=0.9)
        print(
            f"  {module:g} kg above: in the plane to {np.abs(inside).max():.2f} deg, across it to {np.abs(aside).max():.2f} deg"
        )
    current.set_ylabel("mean current [A]")
    fall.set_ylabel("in the plane [deg]")
    fall.legend(frameon=False, ncol=2)
    across.set_ylabel("across it [deg]")
    across.set_xlabel("time [min]")
    finish(figure, "tape")


if __name__ == "__main__":
    draw_profiles()
    draw_growth()
    draw_tss1r()
    draw_tape()
