"""Figures of a body that flies by current: its way in the target's frame, currents against limits, power and energy."""

from __future__ import annotations

from typing import Any

import numpy as np

from fieldline.report.markup import facts, number, table, text
from fieldline.report.run_record import RunRecord
from fieldline.report.run_strokes import COLOURS, finish, fit, stroke
from fieldline.report.theme import GREY, INK, Picture, label_outer, panels

MOST_CONE_DEG = 30.0  # of a corridor that is drawn: what is wider is no approach
NEAR_M = 1e4  # beyond it a body is no neighbour
STANDS = 0.2  # of its distance: a body that moves less is drawn without its target


def carries(record: RunRecord, b: int) -> bool:
    """Whether body b has conductors that were commanded."""
    return bool(record.scenario.body[b].conductor) and record.has("conductor_current")


def approach_of(record: RunRecord, b: int) -> Any:
    """The Dataset of `simulate.approach` for body b, or None where there is no neighbour."""
    from fieldline.simulate.approach import approach

    if b == 0 or not carries(record, b):
        return None
    found = approach(record.dataset, record.bodies[b])
    return found if float(found["distance_m"].max()) < NEAR_M else None


def approach_pictures(record: RunRecord, b: int) -> list[Picture]:
    """The way, the place over time, currents and energy; those that the run has."""
    if not carries(record, b):
        return []
    seen = approach_of(record, b)
    pictures = [current_picture(record, b)]
    if seen is not None:
        pictures = [way_picture(record, b, seen), place_picture(record, b, seen), *pictures, energy_picture(record, b, seen)]
    return pictures


def way_picture(record: RunRecord, b: int, seen: Any) -> Picture:
    """In the orbit's plane and across it, with the cone that holds the way."""
    place, target = seen["place_h_m"].values, record.bodies[0]
    figure, axes = panels(1, 2, height_in=4.2, column_gap=0.24)
    cone = float(seen["corridor_deg"])
    moves = float(np.ptp(place, axis=0).max()) > STANDS * float(seen["distance_m"].max())
    for panel, across, words in ((axes[0, 0], 0, "up"), (axes[0, 1], 2, "across the orbit")):
        panel.plot(place[:, 1], place[:, across], color=COLOURS[0], linewidth=1.2)
        panel.plot(place[0, 1], place[0, across], "o", color=COLOURS[0], markersize=4.5)
        panel.plot(place[-1, 1], place[-1, across], "s", color=COLOURS[0], markersize=4.5)
        if moves and 0.0 < cone < MOST_CONE_DEG:
            _draw_cone(panel, place[[0, -1]][:, [1, across]], cone)
        panel.set_title(f"along the velocity and {words}; scales differ")
        panel.set_xlabel("along the velocity  [m]")
        if moves:
            panel.plot(0.0, 0.0, "+", color=INK, markersize=9)
    axes[0, 0].set_ylabel("up  [m]")
    axes[0, 1].set_ylabel("across  [m]")
    return Picture(
        record.tag("approach", b),
        f"Approach of {record.bodies[b]} to {target}",
        (
            f"In the axes of {target} (+), from the dot to the square. Dashed: the cone of {cone:.3g} deg about the straight "
            "line that holds the whole way."
            if moves
            else f"In the axes of {target}, from the dot to the square."
        ),
        f"The way in the target's frame, from {float(seen['distance_m'][0]):.3g} to {float(seen['distance_m'][-1]):.3g} metres.",
        figure,
    )


def _draw_cone(panel: Any, ends: np.ndarray, cone_deg: float) -> None:
    """Two dashed lines from the end, a half-angle off the straight line."""
    way = ends[0] - ends[1]
    for sign in (-1.0, 1.0):
        c, s = np.cos(np.radians(cone_deg)), sign * np.sin(np.radians(cone_deg))
        edge = ends[1] + np.array([c * way[0] - s * way[1], s * way[0] + c * way[1]])
        panel.plot(*np.column_stack([ends[1], edge]), color=GREY, linewidth=0.8, linestyle=(0, (4, 2.5)))


def place_picture(record: RunRecord, b: int, seen: Any) -> Picture:
    """Place and angles over time."""
    figure, axes = panels(3, 1, height_in=5.2, row_gap=0.34)
    place, angle, rate = (seen[name].values for name in ("place_h_m", "angle_deg", "rate_h_m_s"))
    for values, panel, title, unit in (
        (place, axes[0, 0], f"place from {record.bodies[0]}", "m"),
        (1e3 * rate, axes[1, 0], "rate in its turning axes", "mm/s"),
        (angle, axes[2, 0], "turn from its axes", "deg"),
    ):
        for k, words in enumerate(("up", "along", "across")):
            stroke(panel, record, values[:, k], k, words, width=1.0)
        fit(panel, values, least=1e-6)
        finish(panel, record, title, unit, keyed=panel is axes[0, 0])
    label_outer(axes, (record.clock.label,))
    return Picture(
        record.tag("place", b),
        f"Place and attitude of {record.bodies[b]}",
        "Up, along the velocity and along the orbit's normal of the target; turns about the same axes.",
        f"Place, rate and turn over time; at the end {np.linalg.norm(place[-1]):.3g} metres away.",
        figure,
    )


def current_picture(record: RunRecord, b: int) -> Picture:
    """Every conductor's current over its limit."""
    body, names = record.scenario.body[b], record.names("conductor", b)
    limits = np.array([one.current_max_a for one in body.conductor])
    share = 100.0 * record.dataset["conductor_current"].sel(conductor=names).values / limits
    half = (len(names) + 1) // 2
    figure, axes = panels(2 if len(names) > 1 else 1, 1, height_in=4.0, row_gap=0.34)
    for panel, first, last in zip(axes[:, 0], (0, half), (half, len(names)), strict=False):
        for k in range(first, last):
            stroke(panel, record, share[:, k], k - first, names[k].partition(".")[2], width=0.8)
        for sign in (-100.0, 100.0):
            panel.axhline(sign, color=GREY, linewidth=0.8, linestyle=(0, (4, 2.5)))
        fit(panel, share[:, first:last], least=1.0)
        finish(panel, record, f"current over its limit, {limits[first]:g} A", "%")
    label_outer(axes, (record.clock.label,))
    full = 100.0 * float((np.abs(share) >= 99.9).any(axis=1).mean())
    return Picture(
        record.tag("currents", b),
        record.of_body("Currents", b),
        f"Dashed: the limits. Some conductor is at its limit at {full:.3g} % of the outputs.",
        f"Currents of {len(names)} conductors over their limits, at most {np.abs(share).max():.3g} percent.",
        figure,
    )


def energy_picture(record: RunRecord, b: int, seen: Any) -> Picture:
    """Power of the supplies and what it has come to."""
    figure, axes = panels(2, 1, height_in=3.8, row_gap=0.34)
    power, seconds = seen["power_w"].values, record.seconds
    steps = 0.5 * (power[1:] + power[:-1]) * np.diff(seconds)
    energy = np.concatenate([[0.0], np.cumsum(steps)]) / 3.6e3
    for panel, values, title, unit in (
        (axes[0, 0], power, "power of the supplies: heat, and work on the orbit", "W"),
        (axes[1, 0], energy, "energy so far", "W h"),
    ):
        stroke(panel, record, values, 0, width=1.0)
        fit(panel, values, least=1e-6)
        finish(panel, record, title, unit, keyed=False)
    label_outer(axes, (record.clock.label,))
    return Picture(
        record.tag("energy", b),
        record.of_body("Power and energy", b),
        "Below zero the field drives the currents: the orbit pays. The plasma's resistance counts where the conductors have it.",
        f"Power and energy of the supplies over time; {energy[-1]:.3g} watt hours in all.",
        figure,
    )


def approach_table(record: RunRecord) -> str:
    """Charge and peak of each conductor; energy, impulse and corridor of each body that approaches."""
    parts = []
    for b in record.rigid:
        seen = approach_of(record, b)
        if seen is None:
            continue
        rows = [
            [text(str(name)), number(float(charge), 4), number(100.0 * float(peak), 3)]
            for name, charge, peak in zip(
                seen["conductor"].values, seen["charge_c"].values, seen["peak_share"].values, strict=True
            )
        ]
        told = [
            ("Heat", f"{number(float(seen['heat_j']) / 3.6e3, 4)} W h"),
            ("Work on the orbit", f"{number(float(seen['work_j']) / 3.6e3, 4)} W h"),
            ("Corridor", f"{number(float(seen['corridor_deg']), 3)} deg of half-angle"),
        ]
        if "impulse_n_s" in seen:
            told.append(("Impulse of the thrusters", f"{number(float(seen['impulse_n_s'].sum()), 4)} N s"))
        parts.append(facts(told) + table(("conductor", "charge [A s]", "peak, of its limit [%]"), rows, "numbers"))
    return "".join(parts)
