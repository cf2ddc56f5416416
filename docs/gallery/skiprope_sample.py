"""Make the sample of `fieldline demo skiprope` and the figures of docs/skiprope.md: `python docs/gallery/skiprope_sample.py`.

Writes skiprope.tle and skiprope.csv beside the package's other data, and skiprope_*.png beside this file. One orbit at 300 km,
a reading every 2 s, of a satellite on 20 km of tether. The field is IGRF-14; skiprope of 0.75 by 0.5 deg at 4.8 mHz, from the
orbit's normal towards the front; pendulous motion of 1.5 deg at 31.25 mHz; biases of 1, 1 and 3 deg; 20 nT of noise, 16 bits;
a minute is missing. The elements are of no satellite.
"""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
from PIL import Image

import fieldline as fl
from fieldline.cases.tp3123 import record_along
from fieldline.orbit import read_orbit
from fieldline.report.skiprope_figures import SkipropeRecord
from fieldline.report.skiprope_report import skiprope_pictures
from fieldline.report.theme import write_png
from fieldline.telemetry.delimited import iso_text

DATA = Path(__file__).parents[2] / "src" / "fieldline" / "data"
START = np.datetime64("1992-08-04T12:00:00", "ns")
SAMPLES, STEP_S = 2750, 2
MISSING = slice(1700, 1730)
FLIGHT = {
    "skiprope_frequency_hz": -0.0048,
    "skiprope_deg": (0.75, 0.5),
    "skiprope_phase_deg": 40.0,
    "pendulous_deg": (1.5, 1.5),
    "bias_deg": (1.0, 1.0, 3.0),
    "noise_tesla": 20e-9,
    "seed": 31,
}
ELEMENTS = (
    "1 99001U 92049A   92217.50000000  .00000000  00000-0  00000-0 0  001",
    "2 99001  28.5000 100.0000 0005000  30.0000  20.0000 15.90500000    1",
)


def with_checksum(line: str) -> str:
    """An element line with its last digit."""
    return line + str(sum(int(c) if c.isdigit() else c == "-" for c in line) % 10)


def flight(orbit):
    """The sample's flight, truth and all."""
    times = START + np.arange(SAMPLES) * np.timedelta64(STEP_S, "s")
    return record_along(times, orbit, **FLIGHT)


def draw() -> None:
    """Figures of the report, in palettes, which are small."""
    telemetry, orbit = fl.read_telemetry(DATA / "skiprope.csv"), fl.read_orbit(DATA / "skiprope.tle")
    for method, names in (("harmonic", ("signals", "place", "spectrum")), ("kalman", ("settling",))):
        estimate = fl.estimate_skiprope(telemetry, orbit, tether_length_m=20e3, method=method)
        pictures = skiprope_pictures(SkipropeRecord(estimate))
        for name in names:
            drawn = io.BytesIO()
            write_png(pictures[name].figure, drawn)
            path = Path(__file__).parent / f"skiprope_{name}.png"
            Image.open(drawn).convert("RGB").quantize(128).save(path, optimize=True)


def main() -> None:
    """Write both files and the figures."""
    lines = ["SKIPROPE SAMPLE", *map(with_checksum, ELEMENTS)]
    (DATA / "skiprope.tle").write_text("\n".join(lines) + "\n", encoding="utf-8")
    telemetry = flight(read_orbit(DATA / "skiprope.tle")).telemetry
    kept = np.ones(SAMPLES, dtype=bool)
    kept[MISSING] = False
    stamps = np.char.replace(iso_text(telemetry.time_utc[kept]), ".000Z", "Z")
    nanotesla = np.rint(telemetry.field_s[kept] * 1e9).astype(int)
    rows = [f"{stamp},{x},{y},{z}" for stamp, (x, y, z) in zip(stamps, nanotesla, strict=True)]
    text = "\n".join(["time_utc,mag_x_nT,mag_y_nT,mag_z_nT", *rows]) + "\n"
    (DATA / "skiprope.csv").write_text(text, encoding="utf-8")
    draw()


if __name__ == "__main__":
    main()
