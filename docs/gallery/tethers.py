"""Figures of tethers in flight, those of the run's own report: `python docs/gallery/tethers.py [NAME ...]`.

Flies the templates and writes tethers_*.png beside this file; prints the line of the terminal of each flight.
"""

from __future__ import annotations

import io
import sys
from pathlib import Path

from PIL import Image

import fieldline as fl
from fieldline.cli.simulate import summary
from fieldline.report.run_numbers import run_numbers
from fieldline.report.simulation_report import simulation_figures
from fieldline.report.theme import write_png
from fieldline.simulate.scenario.templates import template

HERE = Path(__file__).parent
SKIPROPE = {"skiprope_amplitude_m": 60.0, "skiprope_sense": "left-handed"}
QUIET = {"line.0.circuit": None, "line.0.heat": None, "line.0.start": SKIPROPE, "time.output_step_s": 5.0}
FLIGHTS: dict[str, tuple[str, dict, tuple[str, ...]]] = {
    "microsat-pair": ("microsat-pair", {}, ("libration", "ends")),
    "tss1r": ("tss1r", {}, ("shape", "current")),
    "skiprope": ("tss1r", QUIET, ("shape", "skiprope")),
    "deploy": ("deploy", {}, ("libration", "tension")),
}  # template, what is changed in it, figures that are kept


def save(picture, name: str) -> None:
    """A PNG of few colours, which is small."""
    drawn = io.BytesIO()
    write_png(picture.figure, drawn)
    image = Image.open(drawn).convert("RGB")
    image.resize((image.width * 3 // 4, image.height * 3 // 4), Image.Resampling.LANCZOS).quantize(160).save(
        HERE / name, optimize=True
    )


def fly(flight: str) -> None:
    """One flight, its figures and its line."""
    kind, changes, kept = FLIGHTS[flight]
    run = fl.simulate(fl.Scenario.from_toml(template(kind, flight)).replace(**changes))
    print("\n".join(summary(run_numbers(run))), flush=True)
    for picture in simulation_figures(run):
        what, _, line = picture.name.partition("_")
        if what in kept and line == "tether":
            save(picture, f"tethers_{flight}_{what}.png")


if __name__ == "__main__":
    for name in sys.argv[1:] or FLIGHTS:
        fly(name)
