"""Figures of a tether that is paid out and taken in, and of what hangs on one: `python docs/gallery/tether_reel.py`.

Writes tether_reel_*.png beside this file and prints what the page tells.
"""

from __future__ import annotations

import io
import time
from pathlib import Path

import numpy as np
from PIL import Image

import fieldline as fl
from fieldline.report.sao_1982_figures import decades
from fieldline.report.series import legend, line
from fieldline.report.theme import AXIS_COLOURS, INK, WARM, label_outer, panels, themed, write_png
from fieldline.simulate.scenario.templates import template

HERE = Path(__file__).parent
BLUE, RED, GREEN = AXIS_COLOURS


def save(figure, name):
    """A PNG of a palette, which is small."""
    drawn = io.BytesIO()
    write_png(figure, drawn)
    Image.open(drawn).convert("RGB").quantize(200).save(HERE / f"tether_reel_{name}.png", optimize=True)


def flown(name, **changes):
    """A template's flight; the second one is timed, without compilation."""
    scenario = fl.Scenario.from_toml(template(name, name)).replace(**changes)
    fl.simulate(scenario)
    begun = time.perf_counter()
    data = fl.simulate(scenario)
    print(f"{name}: {time.perf_counter() - begun:.2f} s, {data.attrs['outcome']}")
    return data


def in_orbital_axes(data, vectors, body):
    """(rows, 3) along the track, against the orbit normal, down, of vectors (rows, 3) in inertial axes."""
    r, v = data.position_i.values[:, body], data.velocity_i.values[:, body]
    down = -r / np.linalg.norm(r, axis=1, keepdims=True)
    side = np.cross(v, r)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    return np.stack([(vectors * axis).sum(axis=1) for axis in (np.cross(side, down), side, down)], axis=1)


def reel_tension(data):
    """Tension at the reel [N]: the last segment that is out."""
    tension = data.tension_tether.values
    return tension[np.arange(len(tension)), np.isfinite(tension).sum(axis=1) - 1]


def figure_deployment(data):
    """Length, rate, tension, swing over the hours; and the way of the probe below the ship."""
    hours = data.seconds.values / 3600.0
    way = in_orbital_axes(data, data.position_i.values[:, 0] - data.position_i.values[:, 1], 1)
    figure, axes = panels(4, 1, height_in=7.4, row_gap=0.26, right=0.94)
    length, rate, pull, angle = axes[:, 0]
    line(length, hours, 1e-3 * data.deployed_length_tether.values, BLUE, width=1.4)
    length.set(title="unstretched length out, nodes out", ylabel="[km]")
    twin = length.twinx()
    twin.step(hours, np.isfinite(data.tension_tether.values).sum(axis=1) - 1, color=WARM, linewidth=1.0, where="post")
    twin.set(ylim=(0, 12), yticks=(0, 5, 10), ylabel="nodes")
    twin.grid(False)
    line(rate, hours, data.feed_rate_tether.values, BLUE, width=1.2)
    rate.set(title="rate of the reel", ylabel="[m/s]")
    line(pull, hours, reel_tension(data), RED, "at the reel", width=1.2)
    line(pull, hours, data.tension_tether.values[:, 0], BLUE, "at the probe", width=1.2)
    pull.set(title="tension", ylabel="[N]", yscale="log")
    decades(pull.yaxis)
    legend(pull)
    line(angle, hours, np.degrees(np.arctan2(way[:, 0], way[:, 2])), BLUE, "in the plane, ahead", width=1.2)
    line(angle, hours, np.degrees(np.arctan2(way[:, 1], way[:, 2])), GREEN, "across it", width=1.2)
    angle.set(title="angle of the probe from the vertical", ylabel="[deg]")
    legend(angle)
    label_outer(axes, ("hours",))
    save(figure, "deployment")
    out = hours < 22000.0 / 3600.0
    print(f"largest length {data.deployed_length_tether.values.max():.0f} m, last {data.deployed_length_tether.values[-1]:.0f} m")
    print(f"in plane, after the first hour: {np.abs(np.degrees(np.arctan2(way[:, 0], way[:, 2])))[hours > 1.0].max():.1f} deg")
    figure, axes = panels(1, 1, height_in=4.6)
    line(axes[0, 0], 1e-3 * way[out, 0], -1e-3 * way[out, 2], BLUE, "out", width=1.3)
    line(axes[0, 0], 1e-3 * way[~out, 0], -1e-3 * way[~out, 2], RED, "in", width=1.3)
    axes[0, 0].set(xlabel="ahead of the ship [km]", ylabel="above it [km]", title="way of the probe in the orbit's plane")
    legend(axes[0, 0])
    save(figure, "way")


def figure_attitude(data, still):
    """Tilt from the line with and without the moving attachment; turn about the line; where the attachment is."""
    figure, axes = panels(3, 1, height_in=6.0, row_gap=0.28)
    for run, colour, words in ((still, WARM, "attachment fixed"), (data, BLUE, "attachment moves")):
        seconds = run.seconds.values
        chord = run.line_position_i_tether.values[:, 0] - run.line_position_i_tether.values[:, -1]
        line(axes[0, 0], seconds, np.degrees(tilt(run, chord)), colour, words, width=1.1)
    axes[0, 0].set(title="tilt of the satellite from the line", ylabel="[deg]")
    legend(axes[0, 0])
    line(axes[1, 0], seconds, np.degrees(heading(data)), INK, width=1.1)
    axes[1, 0].set(title="turn about the line", ylabel="[deg]")
    for k, colour in enumerate((BLUE, RED)):
        line(axes[2, 0], seconds, 100.0 * data.slider_place.values[:, k], colour, "along x" if k == 0 else "along y", width=1.0)
    axes[2, 0].set(title="place of the attachment", ylabel="[cm]")
    legend(axes[2, 0])
    label_outer(axes, ("seconds",))
    save(figure, "attitude")


def tilt(run, chord):
    """Angle [rad] between the satellite's z axis, reversed, and the line."""
    from scipy.spatial.transform import Rotation

    up = -Rotation.from_quat(run.q_bi.values[:, 1]).apply([0.0, 0.0, 1.0])
    cosine = (up * chord).sum(axis=1) / np.linalg.norm(chord, axis=1)
    return np.arccos(np.clip(cosine, -1.0, 1.0))


def heading(run):
    """Angle [rad] of the satellite's x axis from the track, about the vertical."""
    from scipy.spatial.transform import Rotation

    ahead = in_orbital_axes(run, Rotation.from_quat(run.q_bi.values[:, 1]).apply([1.0, 0.0, 0.0]), 1)
    return np.arctan2(ahead[:, 1], ahead[:, 0])


def main():
    """Everything."""
    with themed():
        figure_deployment(flown("deploy"))
        moving = fl.Scenario.from_toml(template("tethered", "tethered"))
        turn_alone = [task.model_dump(exclude_unset=True) for task in moving.software if task.name == "turn"]
        short = {"time.duration_s": 1500.0, "time.output_step_s": 1.0}
        figure_attitude(flown("tethered", **short), flown("tethered", software=turn_alone, **short))


if __name__ == "__main__":
    main()
