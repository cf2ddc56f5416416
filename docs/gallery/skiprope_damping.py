"""The laws against a skiprope, over amplitudes, phases, senses and errors: `python docs/gallery/skiprope_damping.py`.

Each flight is closed: the law hears the satellite's magnetometer, estimates, acts and listens again. Prints the tables of
docs/gallery/skiprope_damping.md and draws its figures beside this file.
"""

from __future__ import annotations

import numpy as np
from skiprope_flight import SHORT, fly, save, scenario, seconds_of

from fieldline.report.series import legend, line
from fieldline.report.theme import AXIS_COLOURS, GREY, WARM, panels, themed

ORBITER = """mass_kg = 100000.0
inertia_kg_m2 = [1.2e6, 9.0e6, 9.6e6]
gravity_gradient = true
attitude = { euler_321_deg = [0.0, 0.0, 0.0], axes = "orbital" }
rate_deg_s = [0.0, 0.0, 0.0]
rate_axes = "orbital"
gyro = { rate_hz = 2.0, noise_std_deg_s = 0.001 }
wheel = [
  { axis_b = [1.0, 0.0, 0.0], torque_max_n_m = 12000.0, momentum_max_n_m_s = 1.0e6 },
  { axis_b = [0.0, 1.0, 0.0], torque_max_n_m = 12000.0, momentum_max_n_m_s = 1.0e6 },
  { axis_b = [0.0, 0.0, 1.0], torque_max_n_m = 12000.0, momentum_max_n_m_s = 1.0e6 },
]
[body.star_tracker]
rate_hz = 2.0
noise_std_arcsec = [10.0, 10.0, 10.0]
boresight_b = [0.0, 0.0, -1.0]
rate_max_deg_s = 5.0
sun_exclusion_deg = 0.0
"""
YAW = """
[[software]]
body = "orbiter"
law = "skiprope-yaw"
rate_hz = 2.0
parameters = {{ swing_hz = 0.0251, azimuth_off_deg = {azimuth}, deflection_off = {share} }}
"""
CURRENT = """circuit = {{ mode = "profile", commanded = true, current_max_a = 1.0 }}
[[software]]
body = "satellite"
law = "skiprope-current"
rate_hz = 1.0
[software.parameters]
swing_hz = 0.0251
mass_per_length_kg_m = 8.35e-3
listen_s = 1200.0
current_max_a = {most}
azimuth_off_deg = {azimuth}
deflection_off = {share}
"""
DURATION_S = {"yaw": 9000.0, "current": 12000.0}
SUCCESS = 0.1  # of what was there
DRAWN = 40  # flights by chance


def flown(way: str, *, azimuth: float = 0.0, share: float = 0.0, most: float = 0.2, **given):
    """Times [s] and radius of the middle [m], and the yaw's angle or the current."""
    size = given.get("amplitude_m", 6.0)
    lean = {"pitch_deg": 0.2417 * size, "roll_rate_deg_s": -0.00243 * size}  # the satellite leans as its tether does
    usual = SHORT | {"duration_s": DURATION_S[way], "nodes": 10} | lean | given
    if way == "yaw":
        text = scenario(**(usual | {"orbiter": ORBITER})) + YAW.format(azimuth=azimuth, share=share)
        text = text.replace('from_body = "orbiter"', 'from_body = "orbiter"\nfrom_point_b_m = [1.5, 0.0, 0.0]')
    else:
        text = scenario(**usual) + CURRENT.format(azimuth=azimuth, share=share, most=most)
    run, place = fly(text)
    return seconds_of(run), np.hypot(*place.T)


def over_a_period(at, size) -> np.ndarray:
    """RMS over 200 s, about a period, from each time on."""
    period = round(200.0 / (at[1] - at[0]))
    return np.sqrt(np.convolve(size**2, np.ones(period) / period, mode="valid"))


def result(at, size) -> dict:
    """Before, after [m], and the time [s] from when it first falls to when it stays below a tenth of what was there."""
    before = float(np.sqrt(np.mean(size[at < 1000.0] ** 2)))
    after = float(np.sqrt(np.mean(size[at > at[-1] - 600.0] ** 2)))
    smooth = over_a_period(at, size)
    late = np.flatnonzero(smooth > SUCCESS * before)
    first = np.flatnonzero(smooth < 0.95 * before)
    done = late[-1] + 1 if len(late) else 0
    takes = float(at[done] - at[first[0]]) if len(first) and done < len(smooth) else np.nan
    return {"before": before, "after": after, "takes": takes}


CASES = {
    "2 m": {"amplitude_m": 2.0},
    "3 m": {"amplitude_m": 3.0},
    "6 m": {},
    "9 m": {"amplitude_m": 9.0},
    "12 m": {"amplitude_m": 12.0},
    "6 m, phase 90 deg": {"phase_deg": 90.0},
    "6 m, phase 180 deg": {"phase_deg": 180.0},
    "6 m, phase 270 deg": {"phase_deg": 270.0},
    "6 m, the other sense": {"sense": "left-handed"},
    "6 m, in one plane": {"sense": "plane"},
    "6 m, azimuth 10 deg wrong": {"azimuth": 10.0},
    "6 m, azimuth 20 deg wrong": {"azimuth": 20.0},
    "6 m, azimuth 40 deg wrong": {"azimuth": 40.0},
    "6 m, azimuth 60 deg wrong": {"azimuth": 60.0},
    "6 m, deflection 20 % too large": {"share": 0.2},
    "6 m, deflection 20 % too small": {"share": -0.2},
    "6 m, deflection 50 % too large": {"share": 0.5},
}


def table() -> dict:
    """All cases by both laws; prints rows of Markdown."""
    kept = {}
    for name, given in CASES.items():
        cells = []
        for way in ("yaw", "current"):
            at, size = flown(way, **given)
            kept[name, way] = at, size
            found = result(at, size)
            cells += [f"{found['before']:.2f}", f"{found['after']:.2f}", f"{found['takes']:.0f}"]
        print("| " + " | ".join([name, *cells[:3], *cells[4:]]) + " |", flush=True)
    return kept


def by_chance() -> dict:
    """Amplitude 2 to 12 m, phase, sense, errors of the estimate (15 deg, 15 %) drawn; the share left by each law."""
    left = {"yaw": [], "current": []}
    for seed in range(DRAWN):
        rng = np.random.default_rng(7000 + seed)
        given = {
            "amplitude_m": rng.uniform(2.0, 12.0), "phase_deg": rng.uniform(0.0, 360.0), "seed": 7000 + seed,
            "sense": str(rng.choice(["right-handed", "left-handed"])), "azimuth": 15.0 * rng.normal(),
            "share": 0.15 * rng.normal(),
        }  # fmt: skip
        for way, rows in left.items():
            found = result(*flown(way, **given))
            rows.append((found["before"], found["after"], given["azimuth"], found["takes"]))
    for way, rows in left.items():
        share = 100.0 * np.array([row[1] / row[0] for row in rows])
        takes = np.array([row[3] for row in rows])
        print(
            f"{way}: left {np.median(share):.1f} / {np.percentile(share, 90):.1f} / {share.max():.1f} % (median, 90 %, worst); "
            f"below a tenth: {int((share < 10.0).sum())} of {len(share)}, after {np.nanmedian(takes):.0f} s in the median"
        )
    return left


def draw(kept: dict, left: dict) -> None:
    """Radius over time, and what is left against the error of the azimuth."""
    with themed():
        figure, axes = panels(1, 2, height_in=3.2, column_gap=0.16)
        for one, way in zip(axes[0], ("yaw", "current"), strict=True):
            shown = ("12 m", "6 m", "3 m", "6 m, azimuth 40 deg wrong")
            for name, colour in zip(shown, (AXIS_COLOURS[0], AXIS_COLOURS[2], GREY, WARM), strict=True):
                at, size = kept[name, way]
                smooth = over_a_period(at, size)
                line(one, 1e-3 * at[: len(smooth)], smooth, colour, name)
            one.set(
                xlabel="time [1000 s]", ylabel=f"by {way}: radius, RMS of a turn [m]", ylim=(0.0, 13.0), xlim=(0.0, 1e-3 * at[-1])
            )
        legend(axes[0, 1])
        save(figure, "skiprope_damping")
        figure, axes = panels(1, 1, height_in=2.8)
        for (way, rows), colour in zip(left.items(), (AXIS_COLOURS[0], WARM), strict=True):
            values = np.array(rows)
            axes[0, 0].plot(values[:, 2], 100.0 * values[:, 1] / values[:, 0], "o", color=colour, markersize=4, label=f"by {way}")
        axes[0, 0].axhline(100.0 * SUCCESS, color=GREY, linewidth=0.8)
        axes[0, 0].set(xlabel="azimuth wrong by [deg]", ylabel="left [%]", ylim=(0.0, None))
        legend(axes[0, 0])
        save(figure, "skiprope_damping_chance")


if __name__ == "__main__":
    draw(table(), by_chance())
