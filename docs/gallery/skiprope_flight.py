"""Flexible lines that skip, a satellite that feels them, and what is found of it: `python docs/gallery/skiprope_flight.py`.

Flies the scenarios of docs/gallery/skiprope_flight.md, estimates from their telemetry, plans a yaw and flies it; prints the
tables of that page and draws its figures beside this file.
"""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np
from PIL import Image

import fieldline as fl
from fieldline.control.skiprope_yaw import SkipropeNow, YawPlan, plan_yaw
from fieldline.report.series import legend, line
from fieldline.report.theme import AXIS_COLOURS, FAINT, GREY, INK, WARM, panels, themed, write_png
from fieldline.simulate.as_telemetry import telemetry_of_run
from fieldline.simulate.line_shape import line_shape
from fieldline.telemetry import telemetry_of

HERE = Path(__file__).parent
SCENARIO = """
name = "skiprope"
seed = {seed}
time = {{ start_utc = 2026-03-01T00:00:00Z, duration_s = {duration_s}, output_step_s = 5.0 }}
integrator = {{ method = "rosenbrock" }}
environment = {{ field = "IGRF-14", gravity = "point" }}
[orbit.elements]
altitude_km = 300.0
inclination_deg = 28.5
raan_deg = 40.0
[[body]]
name = "orbiter"
{orbiter}
[[body]]
name = "satellite"
mass_kg = 520.0
inertia_kg_m2 = [200.0, 200.0, 180.0]
gravity_gradient = true
hang = {{ upward = true }}
attitude = {{ euler_321_deg = [0.0, {pitch_deg}, {roll_deg}], axes = "orbital" }}
rate_deg_s = [{roll_rate_deg_s}, 0.0, {yaw_rate_deg_s}]
rate_axes = "orbital"
[body.magnetometer]
rate_hz = 1.0
noise_std_nt = 20.0
quantum_nt = 2.0
[[line]]
name = "tether"
from_body = "orbiter"
to_body = "satellite"
to_point_b_m = [0.0, 0.0, 1.0]
rest_length_m = {length_m}
stiffness_n = 1.0e5
damping_n_s = 3.0e4
nodes = {nodes}
mass_per_length_kg_m = 8.35e-3
start = {{ skiprope_amplitude_m = {amplitude_m}, skiprope_phase_deg = {phase_deg}, skiprope_sense = "{sense}" }}
"""
POINT = 'kind = "point"\nmass_kg = 100000.0'
HELD = """mass_kg = 100000.0
inertia_kg_m2 = [1.0e9, 1.0e9, 1.0e9]    # turns with the orbital axes, as if its control held it there
rate_deg_s = [0.0, 0.0, 0.0]
rate_axes = "orbital"
"""
ARM = """slider = [
  {{ end = "from", axis_b = [1.0, 0.0, 0.0], travel_m = 20.0, speed_m_s = 0.06, start_m = {u} }},
  {{ end = "from", axis_b = [0.0, 1.0, 0.0], travel_m = 20.0, speed_m_s = 0.06, start_m = {v} }},
]
[[software]]
body = "orbiter"
law = "{law}:arm"
rate_hz = 2.0
commands = ["attachment"]
compiled = false
parameters = {{ start_s = {start}, stop_s = {stop}, rate_rad_s = {rate}, arm_m = {arm}, azimuth_rad = {azimuth} }}
"""
WIRE = """circuit = {{ mode = "profile", commanded = true, current_max_a = 1.0 }}
[[software]]
body = "satellite"
law = "{law}:current"
rate_hz = 0.5
commands = ["current"]
memory = 6
compiled = false
[software.parameters]
mass_kg_m = 8.35e-3
most_a = {most}
gain = {gain}
rounds = {rounds}
"""
LAWS = HERE / "skiprope_arm.py"
SHORT = {"length_m": 2400.0, "nodes": 16, "amplitude_m": 6.0, "duration_s": 5600.0, "pitch_deg": 1.45, "roll_rate_deg_s": -0.0146}
LONG = {"length_m": 20000.0, "nodes": 24, "amplitude_m": 60.0, "duration_s": 9000.0, "pitch_deg": 1.0, "roll_deg": 0.5}
ROTATING = SHORT | {"yaw_rate_deg_s": 0.5}
YAW_NOISE_DEG = 0.5
METHODS = ("harmonic", "kalman", "bandpass")
ROUNDS = ((0.0, 2500.0, 3100.0), (3200.0, 4400.0, 5000.0), (5100.0, 6300.0, 6900.0))  # heard from, decided, ended [s]
GAIN = 4e-5  # [A s/m T]: at 0.1 m/s across a field of 20 microtesla the largest current
ARM_M, ARM_AZIMUTH = 1.5, 0.0


def scenario(*, arm: YawPlan | None = None, seed=1, **given) -> str:
    """A scenario; with an arm the tether leaves the orbiter where a yaw by this plan has it."""
    usual = {"pitch_deg": 0.0, "roll_deg": 0.0, "roll_rate_deg_s": 0.0, "yaw_rate_deg_s": 0.0, "phase_deg": 0.0}
    usual |= {"sense": "right-handed", "orbiter": POINT, "seed": seed} | given
    if arm is None:
        return SCENARIO.format(**usual)
    usual["orbiter"] = HELD
    place = {"u": -ARM_M * np.sin(arm.arm_azimuth_rad), "v": -ARM_M * np.cos(arm.arm_azimuth_rad)}
    numbers = {"start": arm.start_s, "stop": arm.stop_s, "rate": arm.rate_rad_s, "arm": ARM_M, "azimuth": arm.arm_azimuth_rad}
    return SCENARIO.format(**usual) + ARM.format(law=LAWS, **place, **numbers)


def fly(text: str):
    """The run, and the first half wave of its tether over time along (U, V) [m]."""
    run = fl.simulate(fl.Scenario.from_toml(text))
    bow = line_shape(run, "tether").bow.values
    return run, np.stack([bow[:, 0], -bow[:, 1]], axis=-1)  # U = x_o, V = -y_o


def seconds_of(run, times=None):
    """[s] since the run's start."""
    return ((run.time.values if times is None else times) - run.time.values[0]).astype(np.int64) * 1e-9


def telemetry(run, yaw: bool = False):
    """What came down; with a yaw measured besides, as a star tracker's, to half a degree."""
    sent = telemetry_of_run(run)
    if not yaw:
        return sent
    from fieldline.report.geometry import roll_pitch_yaw_deg

    b = list(run.body.values).index("satellite")
    true = roll_pitch_yaw_deg(run.q_bi.values[:, b], run.position_i.values[:, b], run.velocity_i.values[:, b])[:, 2]
    at = np.interp(sent.seconds, seconds_of(run), np.unwrap(np.radians(true)))
    at += np.radians(YAW_NOISE_DEG) * np.random.default_rng(3).standard_normal(len(at))
    return telemetry_of(sent.time_utc, sent.field_s, position_e=sent.position_e, yaw_rad=at)


def errors(estimate, run, place, gain: float = 1.0) -> dict:
    """Of the rows that may be trusted: radius RMS [m], plane mean and sd [deg], deflection [%], against the half wave."""
    at = seconds_of(run, estimate.time.values)
    true = np.stack([np.interp(at, seconds_of(run), column) for column in place.T], axis=-1)
    rows = estimate.trusted.values.astype(bool)
    found = estimate.position_m.values / gain
    plane = np.arctan2(-found[:, 0], found[:, 1]) - np.arctan2(-true[:, 0], true[:, 1])
    plane = np.degrees((plane + np.pi) % (2 * np.pi) - np.pi)[rows]
    size = np.sqrt(np.mean(np.sum(true[rows] ** 2, axis=1)))
    return {
        "true_m": size,
        "radius_m": float(np.sqrt(np.mean(np.sum((found - true)[rows] ** 2, axis=1)))),
        "plane_mean_deg": float(plane.mean()),
        "plane_sd_deg": float(plane.std()),
        "deflection_percent": float(100.0 * (np.sqrt(np.mean(np.sum(found[rows] ** 2, axis=1))) / size - 1.0)),
        "frequency_mhz": float(1e3 * estimate.frequency_hz.values[-1]),
        "sense": int(estimate.sense.values[-1]),
        "trusted_after_s": float(at[rows][0]) if rows.any() else np.nan,
    }


def swing_gain(estimate, swing_hz: float) -> float:
    """By how much a satellite that swings at swing_hz leans further than its tether: 1 / (1 - (f / swing)^2)."""
    return 1.0 / (1.0 - (float(estimate.frequency_hz.values[-1]) / swing_hz) ** 2)


def swing_hz(run) -> float:
    """Of the satellite on its tether: sqrt((T d + ...) / I) without the small terms of gravity."""
    return float(np.sqrt(np.median(run.tension_tether.values[:, -1]) * 1.0 / 200.0) / (2.0 * np.pi))


def tracking() -> dict:
    """Estimates of three flights by three methods."""
    table = {}
    for name, given in {"2.4 km": SHORT, "20 km": LONG, "2.4 km, satellite rotating": ROTATING}.items():
        run, place = fly(scenario(**given))
        sent = telemetry(run, yaw=given is ROTATING)
        for method in METHODS:
            steady = 1200.0 if given is LONG else None  # its circle becomes an ellipse within an orbit
            length = given["length_m"]
            estimate = fl.estimate_skiprope(sent, tether_length_m=length, method=method, steady_s=steady)
            table[f"{name}, {method}"] = errors(estimate, run, place) | {
                "swing_mhz": 1e3 * swing_hz(run),
                "with_swing": errors(estimate, run, place, swing_gain(estimate, swing_hz(run))),
            }
            if method == "harmonic":
                draw_tracking(name, estimate, run, place)
    return table


def now_of(estimate, epoch, gain: float) -> SkipropeNow:
    """The last row as the planner takes it."""
    last = {name: float(estimate[name].values[-1]) for name in ("deflection_m", "deflection_std_m", "plane_rad", "plane_std_rad")}
    return SkipropeNow(
        float((estimate.time.values[-1] - epoch).astype(np.int64) * 1e-9), last["deflection_m"] / gain,
        last["deflection_std_m"] / gain, last["plane_rad"], last["plane_std_rad"], float(estimate.frequency_hz.values[-1]),
        float(estimate.frequency_std_hz.values[-1]), int(estimate.sense.values[-1]),
    )  # fmt: skip


def damped(given: dict, decide_s: float, method: str = "harmonic", azimuth_error_deg: float = 0.0, share: float = 0.0) -> dict:
    """Fly, estimate from what came down until decide_s, plan, fly again with the yaw; what was there and what is left."""
    still = YawPlan(1e9, 1e9, 0.0, 0.0, ARM_AZIMUTH, 0.0, 0.0)
    run, _ = fly(scenario(arm=still, **given))
    sent = telemetry(run)
    known = sent.slice(0, int(np.searchsorted(sent.seconds, decide_s)))
    estimate = fl.estimate_skiprope(known, tether_length_m=given["length_m"], method=method)
    now = now_of(estimate, run.time.values[0], swing_gain(estimate, swing_hz(run)))
    now = now._replace(azimuth_rad=now.azimuth_rad + np.radians(azimuth_error_deg), deflection_m=now.deflection_m * (1.0 + share))
    plan = plan_yaw(now, arm_m=ARM_M, arm_azimuth_rad=ARM_AZIMUTH, not_before_s=decide_s + 60.0)
    run, place = fly(scenario(arm=plan, **given))
    size, at = np.hypot(*place.T), seconds_of(run)
    period = 1.0 / now.frequency_hz
    before = np.sqrt(np.mean(size[(at > plan.start_s - period) & (at <= plan.start_s)] ** 2))
    after = np.sqrt(np.mean(size[(at > plan.stop_s) & (at <= plan.stop_s + 3.0 * period)] ** 2))
    return {
        "before_m": float(before), "after_m": float(after), "expected_m": plan.expected_m, "turns": plan.turned_rad / (2 * np.pi),
        "takes_s": plan.stop_s - plan.start_s, "flown": (at, size, plan),
    }  # fmt: skip


def by_current(given: dict, most_a: float = 0.2, azimuth_error_deg: float = 0.0) -> dict:
    """The same by a current of at most most_a [A], in rounds: hear, act, hear again while the field turns, act."""
    rounds: list[list[float]] = []
    for heard_s, decide_s, stop_s in ROUNDS:
        run, _ = fly(with_current(given, most_a, rounds))
        sent = telemetry(run)
        first, last = np.searchsorted(sent.seconds, (heard_s, decide_s))
        estimate = fl.estimate_skiprope(sent.slice(int(first), int(last)), tether_length_m=given["length_m"])
        rounds.append([*middle_of(estimate, run, azimuth_error_deg, stop_s)])
    run, place = fly(with_current(given, most_a, rounds))
    size, at = np.hypot(*place.T), seconds_of(run)
    before, after = (np.sqrt(np.mean(size[(at > a) & (at <= b)] ** 2)) for a, b in ((1900.0, 2500.0), (at[-1] - 600.0, at[-1])))
    return {"before_m": float(before), "after_m": float(after), "flown": (at, size, None)}


def with_current(given: dict, most_a: float, rounds) -> str:
    """The scenario with a current along the tether, in the rounds so far."""
    listed = [float(one) for row in rounds or [[1e9, 2e9, 1.0, 0.0, 0.0, 0.0, 0.0]] for one in row]
    return scenario(**given) + WIRE.format(law=LAWS, most=most_a, gain=GAIN, rounds=listed)


def middle_of(estimate, run, azimuth_error_deg: float, stop_s: float):
    """A round: start, stop, w, and place and speed of the tether's middle by a sine through the last turn of the estimate."""
    at = seconds_of(run, estimate.time.values)
    w = 2.0 * np.pi * float(estimate.frequency_hz.values[-1])
    turn = np.radians(azimuth_error_deg)
    place = estimate.position_m.values / swing_gain(estimate, swing_hz(run))
    place = place @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    last = at > at[-1] - 2.0 * np.pi / w
    wave = np.stack([np.cos(w * (at[last] - at[-1])), np.sin(w * (at[last] - at[-1]))], axis=-1)
    (u, v), (du, dv) = np.linalg.lstsq(wave, place[last], rcond=None)[0]
    return at[-1], stop_s, w, u, v, w * du, w * dv


def damping() -> dict:
    """Amplitudes, phases, senses and errors of the estimate."""
    table = {}
    cases = {
        "3 m": {"amplitude_m": 3.0, "pitch_deg": 0.72, "roll_rate_deg_s": -0.0073},
        "6 m": {},
        "6 m, phase 90 deg": {"phase_deg": 90.0},
        "6 m, left-handed": {"sense": "left-handed"},
        "9 m": {"amplitude_m": 9.0, "pitch_deg": 2.2, "roll_rate_deg_s": -0.022},
    }
    for name, change in cases.items():
        table[name] = damped(SHORT | change, 2500.0)
    for error in (10.0, 20.0, 40.0):
        table[f"6 m, azimuth {error:.0f} deg wrong"] = damped(SHORT, 2500.0, azimuth_error_deg=error)
    table["6 m, deflection 20 % too large"] = damped(SHORT, 2500.0, share=0.2)
    draw_damping({name: table[name]["flown"] for name in ("9 m", "6 m", "3 m", "6 m, azimuth 40 deg wrong")})
    return {name: {key: value for key, value in row.items() if key != "flown"} for name, row in table.items()}


def currents() -> dict:
    """By a current, of several sizes."""
    given = SHORT | {"duration_s": 8000.0}
    table = {
        "0.2 A": by_current(given),
        "0.05 A": by_current(given, 0.05),
        "0.2 A, azimuth 30 deg wrong": by_current(given, azimuth_error_deg=30.0),
    }
    with themed():
        figure, axes = panels(1, 1, height_in=3.0)
        for (name, row), colour in zip(table.items(), (*AXIS_COLOURS[:2], GREY), strict=True):
            at, size, _ = row["flown"]
            line(axes[0, 0], at, size, colour, name)
        for _, start, stop in ROUNDS:
            axes[0, 0].axvspan(start, stop, color=FAINT, linewidth=0, zorder=0)
        axes[0, 0].set(xlabel="time [s]", ylabel="radius of the middle [m]", ylim=(0.0, None), xlim=(1500.0, 8000.0))
        legend(axes[0, 0])
        save(figure, "skiprope_flight_current")
    return {name: {key: value for key, value in row.items() if key != "flown"} for name, row in table.items()}


def draw_tracking(name: str, estimate, run, place) -> None:
    """True and found place of the tether's middle, last turn and over time."""
    with themed():
        figure, axes = panels(1, 2, height_in=3.6, widths=(1.0, 1.9), column_gap=0.2)
        left, right = axes[0]
        at, found_at = seconds_of(run), seconds_of(run, estimate.time.values)
        turn = 1.0 / float(estimate.frequency_hz.values[-1])
        left.plot(*place[at >= at[-1] - turn].T, color=INK, label="flown")
        rows = found_at >= found_at[-1] - turn
        left.plot(*estimate.position_m.values[rows].T, color=WARM, label="found")
        reach = 1.2 * float(np.hypot(*place.T).max())
        left.set(aspect="equal", xlim=(-reach, reach), ylim=(-reach, reach), xlabel="U [m]", ylabel="V [m]")
        legend(left)
        line(right, at, np.hypot(*place.T), INK, "flown")
        line(right, found_at, np.hypot(*estimate.position_m.values.T), WARM, "found")
        right.axvspan(
            0.0, json.loads(estimate.attrs["verdict_json"])["trusted_after_s"] or 0.0, color=FAINT, linewidth=0, zorder=0
        )
        right.set(xlabel="time [s]", ylabel="radius of the middle [m]", ylim=(0.0, reach), xlim=(0.0, at[-1]))
        legend(right)
        save(figure, "skiprope_flight_" + name.replace(" ", "_").replace(",", "").replace(".", ""))


def draw_damping(flights: dict) -> None:
    """Radius over time through the yaw."""
    with themed():
        figure, axes = panels(1, 1, height_in=3.4)
        one = axes[0, 0]
        for (name, (at, size, plan)), colour in zip(flights.items(), (AXIS_COLOURS[0], AXIS_COLOURS[2], GREY, WARM), strict=True):
            shown = (at > 2200.0) & (at < 4600.0)
            one.plot(at[shown], size[shown], color=colour, label=name)
            one.plot(
                [plan.start_s, plan.stop_s], np.interp([plan.start_s, plan.stop_s], at, size), "o", color=colour, markersize=4
            )
        one.set(xlabel="time [s]", ylabel="radius of the middle [m]", ylim=(0.0, None))
        legend(one)
        save(figure, "skiprope_flight_damping")


def save(figure, name: str) -> None:
    """A PNG of a palette, which is small."""
    drawn = io.BytesIO()
    write_png(figure, drawn)
    Image.open(drawn).convert("RGB").quantize(128).save(HERE / f"{name}.png", optimize=True)


def main() -> None:
    """All of it."""
    for table in (tracking(), damping(), currents()):
        for name, row in table.items():
            print(name, json.dumps(row, default=lambda x: round(float(x), 4)))


if __name__ == "__main__":
    main()
