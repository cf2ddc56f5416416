"""The published picosatellite: 500 tumbles of 180 deg/s an axis, stopped by B-dot with 0.002 A m^2.

    python benchmarks/picosatellite.py [--runs 500] [--rates normal|even|full] [--figure docs/gallery/picosatellite.png]

Published: 14.8 orbits in the mean, 13.9 in the median, at 350 km. Source of the case: Fonod and Gill (2018), Magnetic
detumbling of fast-tumbling picosatellites, IAC-18-C1.3.11 (the satellite is Delfi-PQ).

What is assumed here, the paper not being at hand in full:
- rates even within 180 deg/s on each axis, or (`--rates full`) 180 deg/s of either sign, or (`--rates normal`, four times
  the work) normal with that standard deviation;
- the place in the orbit and the node even, the attitude as the scenario starts it;
- a box of 0.6 kg, 50 x 50 x 178 mm, its mass spread evenly;
- a near-polar orbit, as sun-synchronous ones are, 96.85 deg;
- B-dot at 5 Hz (10 Hz for normal rates) with the gain 2 n (1 + sin i) J_min, limited per axis, its torquers never off;
- stopped is a rate under 5 deg/s.

The field is IGRF-14 to degree 6, enough for its direction and size to a few parts in a hundred. Steps of 0.04 s
(0.02 s for normal rates): a fixed step of the fourth order itself takes w^6 h^5 / 144 a second from a wobble of w, 3e-7
at 180 deg/s and 0.04 s.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np

from fieldline.simulate.ensemble import Choice, Normal, Uniform, simulate_many
from fieldline.simulate.scenario.scenario import Scenario

PUBLISHED_MEAN, PUBLISHED_MEDIAN = 14.8, 13.9  # orbits
ORBIT_S = 5492.0  # of a circle at 350 km
TOML = """
name = "picosatellite"
time = { start_utc = 2018-10-01T00:00:00Z, duration_s = 300000.0, output_step_s = 30000.0 }
integrator = { method = "rk4", step_s = 0.04 }
environment = { field_degree = 6 }
orbit.elements = { altitude_km = 350.0, inclination_deg = 96.85, mean_anomaly_deg = 0.0 }

[[body]]
name = "picosatellite"
mass_kg = 0.6
inertia_kg_m2 = [1.709e-3, 1.709e-3, 2.5e-4]
rate_deg_s = [180.0, 180.0, 180.0]
magnetometer = { rate_hz = 5.0 }
magnetorquer = [
    { axis_b = [1, 0, 0], moment_max_a_m2 = 0.002 },
    { axis_b = [0, 1, 0], moment_max_a_m2 = 0.002 },
    { axis_b = [0, 0, 1], moment_max_a_m2 = 0.002 },
]

[[software]]
law = "b-dot"
rate_hz = 5.0

[[event]]
kind = "rate"
rate_deg_s = 5.0
direction = "falling"
stop = true
"""
PLACE = {"orbit.elements.mean_anomaly_deg": Uniform(0.0, 360.0), "orbit.elements.raan_deg": Uniform(0.0, 360.0)}
FULL = Choice(tuple([180.0 * x, 180.0 * y, 180.0 * z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)))
RATES = {"normal": Normal(0.0, [180.0] * 3), "even": Uniform([-180.0] * 3, [180.0] * 3), "full": FULL}
# Of 500 normal runs some begin at 500 deg/s an axis.
FINER = {"integrator.step_s": 0.02, "software.0.rate_hz": 10.0, "body.0.magnetometer.rate_hz": 10.0}


def orbits_to_stop(runs: int, rates: str = "even", workers: int | None = None, seed: int = 2018, **changes) -> np.ndarray:
    """(runs,) orbits until the rate is under 5 deg/s; NaN where it was not in time."""
    finer = FINER if rates == "normal" else {}
    scenario = Scenario.from_toml(TOML).replace(**{**finer, **changes})
    disperse = {**PLACE, "body.0.rate_deg_s": RATES[rates]}
    data = simulate_many(scenario, runs, disperse=disperse, seed=seed, workers=workers)
    stopped = (data.outcome == "stopped").to_numpy()
    return np.where(stopped, data.ended_s.to_numpy(), np.nan) / ORBIT_S


def table(orbits: np.ndarray) -> list[tuple[str, str, str]]:
    """(orbits to stop, here, published)."""
    here = orbits[np.isfinite(orbits)]
    error = here.std(ddof=1) / np.sqrt(len(here))
    low, high = np.percentile(here, [5, 95])
    return [
        ("orbits to stop", f"here, {len(orbits)} runs", "published, 500 runs"),
        ("mean", f"{here.mean():.1f} (standard error {error:.1f})", f"{PUBLISHED_MEAN}"),
        ("median", f"{np.median(here):.1f}", f"{PUBLISHED_MEDIAN}"),
        ("5 to 95 % of runs", f"{low:.1f} to {high:.1f}", ""),
        ("not stopped in time", f"{len(orbits) - len(here)}", ""),
    ]


def draw(orbits: np.ndarray, path: Path) -> None:
    """How many runs took how long."""
    from fieldline.report.theme import AXIS_COLOURS, INK, panels, themed, write_png

    with themed():
        figure, grid = panels(1, height_in=3.0)
        axes = np.ravel(grid)[0]
        axes.hist(orbits[np.isfinite(orbits)], bins=40, color=AXIS_COLOURS[0])
        axes.axvline(PUBLISHED_MEAN, color=INK, linewidth=1.0)
        axes.set_title(f"Orbits until a picosatellite turns slower than 5 deg/s, {len(orbits)} runs; line: published mean")
        axes.set_xlabel("orbits")
        axes.set_ylabel("runs")
        write_png(figure, path)


def main() -> None:
    """Fly, print the table, draw where asked."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--runs", type=int, default=500)
    options.add_argument("--rates", choices=RATES, default="even", help="180 deg/s an axis as standard deviation, bound or size")
    options.add_argument("--figure", type=Path)
    chosen = options.parse_args()
    begun = time.perf_counter()
    orbits = orbits_to_stop(chosen.runs, chosen.rates)
    for row in table(orbits):
        print("| " + " | ".join(row) + " |")
    print(f"{time.perf_counter() - begun:.0f} s")
    if chosen.figure:
        draw(orbits, chosen.figure)


if __name__ == "__main__":
    main()
