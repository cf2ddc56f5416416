"""The numbers of a line that a reader wants first: pull, slack, librations, length, bow, skiprope, heights, heat, power."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.analysis.line_shape import STRAIGHT
from fieldline.report.line_record import LineRecord
from fieldline.report.markup import number, text
from fieldline.report.run_record import DEG

ZERO_CELSIUS_K = 273.15
CIRCLES = 0.5  # |sense| from which on a skiprope is said to go round
LAST = 0.1  # share of the run's end over which a skiprope is told
HANDS = {1: "right-handed", -1: "left-handed", 0: "in one plane"}
ROUNDING_M = 1e-7  # of places of millions of metres


def line_numbers(line: LineRecord) -> dict[str, Any]:
    """Plain numbers and words of a line."""
    shape, tension = line.shape, line.tension
    spells = np.flatnonzero(np.diff(np.concatenate([[False], line.slack]).astype(int)) == 1)
    numbers: dict[str, Any] = {
        "tension_lowest_n": float(np.nanmin(tension)),
        "tension_mean_n": float(np.nanmean(tension)),
        "tension_largest_n": float(np.nanmax(tension)),
        "slack_share": float(line.slack.mean()),
        "slack_s": float(line.slack.mean() * line.run.seconds[-1]),
        "slack_spells": len(spells),
        "libration_in_plane_deg": float(DEG * np.abs(shape.in_plane_rad).max()),
        "libration_across_deg": float(DEG * np.abs(shape.across_rad).max()),
        "length_start_m": float(line.length[0]),
        "length_end_m": float(line.length[-1]),
        "lowest_altitude_km": float(np.nanmin(line.height)) / 1e3,
    }
    if shape.bows:
        numbers["deflection_largest_m"] = _deflection(float(shape.largest_m.max()))
        numbers["deflection_end_m"] = _deflection(float(shape.largest_m[-1]))
    return numbers | _skiprope(line) | _heat_and_current(line) | _levers(line)


def _skiprope(line: LineRecord) -> dict[str, Any]:
    """Size, period and sense over the last tenth of the run."""
    found = line.skiprope
    if found is None:
        return {}
    last = slice(-max(1, int(LAST * len(found.sense))), None)
    if found.rate_rad_s[last].mean() <= 0.0 or found.semi_major_m[last].mean() <= STRAIGHT * line.shape.chord_m[-1]:
        return {}
    sense = float(np.mean(found.sense[last]))
    return {
        "skiprope": {
            "semi_major_m": float(np.mean(found.semi_major_m[last])),
            "semi_minor_m": float(np.mean(found.semi_minor_m[last])),
            "period_s": float(2.0 * np.pi / np.mean(found.rate_rad_s[last])),
            "sense": HANDS[int(np.sign(sense)) if abs(sense) >= CIRCLES else 0],
        }
    }


def _heat_and_current(line: LineRecord) -> dict[str, Any]:
    """Temperatures, current, electromotive force and power, those that there are."""
    numbers: dict[str, Any] = {}
    if line.has("temperature"):
        warm = line.values("temperature") - ZERO_CELSIUS_K
        numbers["temperature_lowest_c"], numbers["temperature_highest_c"] = float(np.nanmin(warm)), float(np.nanmax(warm))
    if line.has("current"):
        current = line.values("current")
        numbers["current_largest_a"] = float(np.nanmax(np.abs(current)))
        numbers["current_mean_a"] = float(np.nanmean(current))
    if line.has("emf"):
        numbers["emf_largest_v"] = float(np.abs(line.values("emf")).max())
    if line.has("power") and line.values("power").any():
        power = line.values("power")
        numbers["power_mean_w"], numbers["power_largest_w"] = float(power.mean()), float(power.max())
    return numbers


def _levers(line: LineRecord) -> dict[str, Any]:
    """Largest angle of each end body's lever from the line."""
    found = {}
    for end in (0, 1):
        angle = line.lever_angle_deg(end)
        if angle is not None:
            found[line.run.bodies[line.ends[end]]] = float(angle.max())
    return {"lever_angle_largest_deg": found} if found else {}


def line_pairs(name: str, numbers: dict[str, Any]) -> list[tuple[str, str]]:
    """Names and values for the table of key numbers, as HTML."""
    name = text(name)
    low, mean, high = (number(numbers[f"tension_{key}_n"], 3) for key in ("lowest", "mean", "largest"))
    pairs = [(f"{name}: tension, lowest · mean · largest", f"{low} · {mean} · {high} N")]
    pairs.append((f"{name}: slack", slack_words(numbers)))
    swing = f"{number(numbers['libration_in_plane_deg'], 3)} · {number(numbers['libration_across_deg'], 3)} deg"
    pairs.append((f"{name}: libration, largest in the plane · across it", swing))
    start, end = number(numbers["length_start_m"], 5), number(numbers["length_end_m"], 5)
    pairs.append((f"{name}: length that is out", f"{end} m" if start == end else f"{start} → {end} m"))
    if "deflection_largest_m" in numbers:
        bow = f"{number(numbers['deflection_largest_m'], 3)} · {number(numbers['deflection_end_m'], 3)} m"
        pairs.append((f"{name}: deflection from the chord, largest · at the end", bow))
    if "skiprope" in numbers:
        pairs.append((f"{name}: skiprope at the end", skiprope_words(numbers["skiprope"])))
    pairs.append((f"{name}: lowest point over the ground", f"{number(numbers['lowest_altitude_km'], 5)} km"))
    if "temperature_lowest_c" in numbers:
        ends = (number(numbers[f"temperature_{key}_c"], 3) for key in ("lowest", "highest"))
        pairs.append((f"{name}: temperature", f"{' to '.join(ends)} °C"))
    if "current_largest_a" in numbers:
        both = f"{number(numbers['current_mean_a'], 3)} · {number(numbers['current_largest_a'], 3)} A"
        pairs.append((f"{name}: current, mean · largest", both))
    if "emf_largest_v" in numbers:
        pairs.append((f"{name}: electromotive force, largest", f"{number(numbers['emf_largest_v'], 4)} V"))
    if "power_mean_w" in numbers:
        both = f"{number(numbers['power_mean_w'], 3)} · {number(numbers['power_largest_w'], 3)} W"
        pairs.append((f"{name}: power delivered, mean · largest", both))
    for body, angle in numbers.get("lever_angle_largest_deg", {}).items():
        pairs.append((f"{text(body)}: lever from the line {name}, largest", f"{number(angle, 3)} deg"))
    return pairs


def line_summary(name: str, numbers: dict[str, Any]) -> str:
    """One line of the terminal."""
    parts = [
        f"tension {numbers['tension_lowest_n']:.3g} to {numbers['tension_largest_n']:.3g} N",
        f"slack: {slack_words(numbers)}" if numbers["slack_spells"] else "never slack",
        f"libration ≤ {numbers['libration_in_plane_deg']:.3g}° in the plane, {numbers['libration_across_deg']:.3g}° across it",
    ]
    start, end = numbers["length_start_m"], numbers["length_end_m"]
    if abs(end - start) > 1e-6 * max(start, end):
        parts.append(f"length {start:.5g} → {end:.5g} m")
    if "deflection_largest_m" in numbers:
        parts.append(f"deflection ≤ {numbers['deflection_largest_m']:.3g} m")
    if "skiprope" in numbers:
        parts.append(f"skiprope {skiprope_words(numbers['skiprope'])}")
    parts.append(f"lowest point {numbers['lowest_altitude_km']:.4g} km")
    if "temperature_lowest_c" in numbers:
        parts.append(f"{numbers['temperature_lowest_c']:.3g} to {numbers['temperature_highest_c']:.3g} °C")
    if "power_mean_w" in numbers:
        parts.append(f"power {numbers['power_mean_w']:.3g} W mean, {numbers['power_largest_w']:.3g} W at most")
    return f"{name}: " + " · ".join(parts)


def _deflection(metres: float) -> float:
    """Nothing where it is the rounding of places that are thousands of kilometres out."""
    return metres if metres > ROUNDING_M else 0.0


def line_warnings(name: str, numbers: dict[str, Any]) -> list[str]:
    """What a reader should know before anything else."""
    if not numbers["slack_spells"]:
        return []
    return [f"{name} is slack: {slack_words(numbers)}. A slack line neither holds its bodies nor keeps them from turning."]


def slack_words(numbers: dict[str, Any]) -> str:
    """For example: 40 s in 1 spell (2 % of the outputs)."""
    spells = numbers["slack_spells"]
    if not spells:
        return "never"
    share = number(100.0 * numbers["slack_share"], 3)
    return f"{number(numbers['slack_s'], 3)} s in {spells} spell{'s' if spells > 1 else ''} ({share} % of the outputs)"


def skiprope_words(skiprope: dict[str, Any]) -> str:
    """For example: 40 × 38 m, right-handed, period 180 s."""
    axes = " × ".join(number(skiprope[key], 3) for key in ("semi_major_m", "semi_minor_m"))
    return f"{axes} m, {skiprope['sense']}, period {number(skiprope['period_s'], 3)} s"
