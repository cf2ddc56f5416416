"""Figures of what turned the bodies: torques by load, and the actuators against their limits."""

from __future__ import annotations

import numpy as np

from fieldline.report.markup import number, table, text
from fieldline.report.run_numbers import FULL, limits
from fieldline.report.run_record import RunRecord
from fieldline.report.run_strokes import COLOURS, bounds, finish, fit, logarithmic, slice_words, sliced_rms, stroke
from fieldline.report.theme import Picture, label_outer, panels

MOST_PANELS = 6
SMALL_A_M2 = 0.05  # limits below this are told in thousandths
HALF_SEGMENTS = (
    "<p>Lines count with what of their mass moves with a body: the weight of the half segments at its attachments, and on a "
    "reel's body, which holds the whole line in its mass, less that of what is out. What a line pulls with is its tension.</p>"
)


def torque_picture(record: RunRecord, b: int) -> Picture | None:
    """The size of each load's torque on a body, on a logarithmic scale."""
    sizes = torque_sizes(record, b)
    if not sizes:
        return None
    figure, axes = panels(1, 1, height_in=3.3)
    one = axes[0, 0]
    drawn = []
    for k, (name, size) in enumerate(sizes.items()):
        time, rms = sliced_rms(record, size)
        one.plot(
            time,
            np.where(rms > 0.0, rms, np.nan),
            color=COLOURS[k % len(COLOURS)],
            label=name.replace("_", " "),
            linewidth=1.0,
            marker=".",  # what acts for an instant is seen too
            markersize=2.0,
            linestyle="-" if k < len(COLOURS) else (0, (4, 2.5)),
        )
        drawn.append(rms)
    logarithmic(one, np.concatenate(drawn))
    finish(one, record, slice_words(record), "N m", columns=9)
    one.set_xlabel(record.clock.label)
    largest = max(sizes, key=lambda name: float(np.sqrt(np.mean(sizes[name] ** 2))))
    return Picture(
        record.tag("torques", b),
        record.of_body("Torques by load", b),
        "What controls must stand well above what disturbs. Torques of sampled torquers are those at the outputs.",
        f"Size of the torque of {len(sizes)} loads over time; the largest is {largest.replace('_', ' ')}.",
        figure,
    )


def torque_sizes(record: RunRecord, b: int) -> dict[str, np.ndarray]:
    """(n,) [N m] of each load that turned body b."""
    torque = record.dataset["torque_b"].isel(body=b).values
    names = [str(name) for name in record.dataset["load"].values]
    sizes = {name: np.linalg.norm(torque[:, k], axis=1) for k, name in enumerate(names)}
    return {name: size for name, size in sizes.items() if size.any()}


def load_table(record: RunRecord) -> str:
    """RMS and greatest force and torque of every load on every body."""
    rows = []
    names = [str(name) for name in record.dataset["load"].values]
    force, torque = (np.linalg.norm(record.dataset[name].values, axis=-1) for name in ("force_i", "torque_b"))
    for b, body in enumerate(record.bodies[:MOST_PANELS]):
        for k, name in enumerate(names):
            cells = []
            for values in (force[:, k, b], torque[:, k, b]):
                some = values.any()
                cells += [number(float(np.sqrt(np.mean(values**2))), 3), number(float(values.max()), 3)] if some else ["–", "–"]
            if cells != ["–"] * 4:
                rows.append([text(body), text(name.replace("_", " ")), *cells])
    heads = ("body", "load", "force, RMS [N]", "greatest", "torque, RMS [N m]", "greatest")
    heavy = "lines" in names and any(line.mass_per_length_kg_m > 0.0 for line in record.scenario.line)
    return (table(heads, rows, "numbers") + (HALF_SEGMENTS if heavy else "")) if rows else ""


def actuator_pictures(record: RunRecord, b: int) -> list[Picture]:
    """Torquers, wheels, thrusters and hysteresis rods of a body, those that it has."""
    found = [torquer_picture(record, b), wheel_picture(record, b), thrust_picture(record, b), rod_picture(record, b)]
    return [picture for picture in found if picture is not None]


def torquer_picture(record: RunRecord, b: int) -> Picture | None:
    """A panel for each torquer, with its limits."""
    names = record.names("magnetorquer", b)[:MOST_PANELS]
    if not names or not record.has("torquer_moment"):
        return None
    most = limits(record, b, "torquer_moment")[: len(names)]
    unit, factor = ("mA m²", 1e3) if most.max() < SMALL_A_M2 else ("A m²", 1.0)
    moment, most = factor * record.dataset["torquer_moment"].sel(magnetorquer=names).values, factor * most
    figure, axes = panels(len(names), 1, height_in=0.9 + 1.25 * len(names), row_gap=0.42)
    shares = []
    for k, name in enumerate(names):
        one = axes[k, 0]
        stroke(one, record, moment[:, k], k, width=0.7)
        bounds(one, [most[k]], float(np.abs(moment[:, k]).max()))
        shares.append(100.0 * float((np.abs(moment[:, k]) >= FULL * most[k]).mean()))
        finish(one, record, f"{name.partition('.')[2]}: limit {most[k]:.3g} {unit}, at it {shares[-1]:.3g} %", unit, keyed=False)
        fit(one, moment[:, k], least=1e-6 * most[k])
    label_outer(axes, (record.clock.label,))
    duty = record.scenario.body[b].duty_cycle
    note = " The torquers rest in part of each duty cycle; what shows is the moment at the outputs." if duty else ""
    return Picture(
        record.tag("torquers", b),
        record.of_body("Magnetorquers", b),
        "Dashed: the limits, where the moment comes near them." + note,
        f"Moments of {len(names)} torquers over time; at their limits for {max(shares):.3g} percent of the outputs at most.",
        figure,
    )


def wheel_picture(record: RunRecord, b: int) -> Picture | None:
    """Momentum and motor torque of the wheels, with their limits."""
    names = record.names("wheel", b)
    if not names:
        return None
    figure, axes = panels(2, 1, height_in=4.4, row_gap=0.32)
    momentum, torque = (record.dataset[name].sel(wheel=names).values for name in ("wheel_momentum", "wheel_torque"))
    for one, values, variable, factor, title, unit in (
        (axes[0, 0], momentum, "wheel_momentum", 1.0, "momentum about the wheel's axis", "N m s"),
        (axes[1, 0], torque, "wheel_torque", 1e3, "motor torque, as commanded", "mN m"),
    ):
        for k, name in enumerate(names):
            stroke(one, record, factor * values[:, k], k, name.partition(".")[2], width=0.8)
        bounds(one, factor * limits(record, b, variable), factor * float(np.abs(values).max()))
        fit(one, factor * values, least=1e-9)
        finish(one, record, title, unit, keyed=variable == "wheel_momentum")
    label_outer(axes, (record.clock.label,))
    share = float(np.abs(momentum).max() / limits(record, b, "wheel_momentum").min())
    return Picture(
        record.tag("wheels", b),
        record.of_body("Wheels", b),
        "Dashed: the limits, where the signal comes near them. A wheel at its largest momentum takes no more torque that way.",
        f"Momentum and torque of {len(names)} wheels over time; at most {100.0 * share:.3g} percent of the smallest limit.",
        figure,
    )


def thrust_picture(record: RunRecord, b: int) -> Picture | None:
    """Each thruster's thrust over its full thrust."""
    names = record.names("thruster", b)
    if not names or not record.has("thrust"):
        return None
    thrust = record.dataset["thrust"].sel(thruster=names).values
    figure, axes = panels(1, 1, height_in=2.6)
    for k, name in enumerate(names):
        stroke(axes[0, 0], record, thrust[:, k], k, name.partition(".")[2], width=0.8)
    axes[0, 0].set_ylim(-0.05, 1.05)
    finish(axes[0, 0], record, "part of the control period with full thrust", "")
    axes[0, 0].set_xlabel(record.clock.label)
    return Picture(
        record.tag("thrusters", b),
        record.of_body("Thrusters", b),
        "Thrusters fire at full thrust for part of each control period; what shows is that part, as commanded.",
        f"Thrust of {len(names)} thrusters over time.",
        figure,
    )


def rod_picture(record: RunRecord, b: int) -> Picture | None:
    """Induction of the hysteresis rods."""
    count = len(record.scenario.body[b].hysteresis_rod)
    if not count:
        return None
    names = [f"{record.bodies[b]}.rod_{k + 1}" for k in range(count)]
    induction = 1e3 * record.dataset["rod_induction"].sel(rod=names).values
    shown = min(count, MOST_PANELS)
    figure, axes = panels(shown, 1, height_in=0.9 + 1.25 * shown, row_gap=0.42)
    for k in range(shown):
        stroke(axes[k, 0], record, induction[:, k], k, width=0.6)
        saturation = 1e3 * record.scenario.body[b].hysteresis_rod[k].saturation_tesla
        bounds(axes[k, 0], [saturation], float(np.abs(induction[:, k]).max()))
        fit(axes[k, 0], induction[:, k], least=1e-6)
        finish(axes[k, 0], record, f"rod {k + 1}: saturation {saturation:.3g} mT", "mT", keyed=False)
    label_outer(axes, (record.clock.label,))
    return Picture(
        record.tag("rods", b),
        record.of_body("Hysteresis rods", b),
        "Wide swings take energy out of the tumble; where they shrink the rods have little left to take.",
        f"Induction of {count} hysteresis rods over time, at most {np.abs(induction).max():.3g} millitesla.",
        figure,
    )
