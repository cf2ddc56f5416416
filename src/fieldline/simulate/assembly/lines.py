"""From a scenario's lines to the plant's arrays: segments, their materials, reels and sliding attachments.

A line of n nodes has n + 1 segments of equal unstretched length. Where a segment spans parts of several materials, its
mass is their sum, and its compliance (length over E A, length over c) is theirs in series. With a reel the nodes are
counted when all of the line is out; at the start only those are out that leave the reel's segment between half and
one and a half of a full one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from fieldline.dynamics.parameters import NO_REEL, RATE_REEL, TENSION_REEL, Lines, Sliders

if TYPE_CHECKING:
    from fieldline.analysis.tether import Strand

REELS = {"rate": RATE_REEL, "tension": TENSION_REEL}
MATERIAL = {
    "stiffness_n": "series",
    "damping_n_s": "series",
    "mass_per_length_kg_m": "mean",
    "diameter_m": "mean",
}  # how a segment's value follows from those of its parts


def lines_of(scenario) -> Lines:
    """All lines."""
    lines = scenario.line
    ends = [(scenario.index_of(line.from_body), scenario.index_of(line.to_body)) for line in lines]
    materials = [_materials(line) for line in lines]
    return Lines(
        body=np.array(ends, dtype=np.int64).reshape(-1, 2),
        point=np.array([(*line.from_point_b_m, *line.to_point_b_m) for line in lines], dtype=float).reshape(-1, 6),
        joint=np.array([(line.from_joint_damping_n_m_s, line.to_joint_damping_n_m_s) for line in lines], dtype=float).reshape(
            -1, 2
        ),
        first=np.cumsum([0, *(line.nodes for line in lines)]).astype(np.int64),
        nodes=np.array([nodes_out(line) for line in lines], dtype=np.int64),
        rest=_joined([np.full(line.nodes + 1, spacing(line)) for line in lines]),
        stiffness=_joined([one["stiffness_n"] for one in materials]),
        damping=_joined([one["damping_n_s"] for one in materials]),
        linear_mass=_joined([one["mass_per_length_kg_m"] for one in materials]),
        diameter=_joined([one["diameter_m"] for one in materials]),
        drag_coefficient=_joined([np.full(line.nodes + 1, line.drag_coefficient) for line in lines]),
        capacity=_joined([_capacity(line, one["mass_per_length_kg_m"]) for line, one in zip(lines, materials, strict=True)]),
        absorptivity=np.array([line.heat.absorptivity if line.heat else 0.0 for line in lines], dtype=float),
        emissivity=np.array([line.heat.emissivity if line.heat else 0.0 for line in lines], dtype=float),
        expansion=np.array([line.heat.expansion_1_k if line.heat else 0.0 for line in lines], dtype=float),
        reference=np.array([line.heat.reference_temperature_k if line.heat else 1.0 for line in lines], dtype=float),
        warm=np.cumsum([0, *(line.nodes + 1 if line.heat else 0 for line in lines)]).astype(np.int64),
        exposed=np.array([is_exposed(scenario, line) for line in lines], dtype=np.int64),
        reel=np.array([NO_REEL if line.reel is None else REELS[line.reel.mode] for line in lines], dtype=np.int64),
        reel_lag=np.array([_lag(line.reel) for line in lines], dtype=float),
        spacing=np.array([spacing(line) for line in lines], dtype=float),
        span=np.array([_span(line) for line in lines], dtype=float).reshape(-1, 2),
        stored=np.array([mass_out(line) for line in lines], dtype=float),
    )


def line_names(scenario) -> list[str]:
    """Names of all lines, given or by number."""
    return [line.name or f"line_{k}" for k, line in enumerate(scenario.line, start=1)]


def sliders_of(scenario) -> Sliders:
    """All sliding attachments."""
    pairs = sliders(scenario)
    return Sliders(
        line=np.array([k for k, _ in pairs], dtype=np.int64),
        end=np.array([one.end == "to" for _, one in pairs], dtype=np.int64),
        axis=np.array([one.axis_b for _, one in pairs], dtype=float).reshape(-1, 3),
        speed=np.array([one.speed_m_s for _, one in pairs], dtype=float),
    )


def sliders(scenario) -> list[tuple[int, object]]:
    """(line, record) of every slider, line after line."""
    return [(k, one) for k, line in enumerate(scenario.line) for one in line.slider]


def spacing(line) -> float:
    """Unstretched length of a full segment [m]."""
    return line.whole_length_m / (line.nodes + 1)


def nodes_out(line) -> int:
    """Nodes that are out at the start."""
    if line.reel is None:
        return line.nodes
    return min(line.nodes, max(0, int(np.floor(line.rest_length_m / spacing(line) - 0.5))))


def last_length(line) -> float:
    """Unstretched length of the last segment at the start [m]."""
    return line.rest_length_m - nodes_out(line) * spacing(line)


def mass_out(line) -> float:
    """Mass of what is out at the start [kg]."""
    out = nodes_out(line)
    linear = _materials(line)["mass_per_length_kg_m"]
    return float(linear[:out].sum() * spacing(line) + linear[out] * last_length(line))


def _span(line) -> tuple[float, float]:
    """Least and largest unstretched length out [m]."""
    return (0.0, line.rest_length_m) if line.reel is None else (line.reel.shortest_length_m, line.reel.total_length_m)


def strand_of(line) -> Strand:
    """The segments that are out at the start, as long as their temperature makes them."""
    from fieldline.analysis.tether import Strand

    out, materials = nodes_out(line), _materials(line)
    rest = np.full(out + 1, spacing(line))
    rest[-1] = last_length(line)
    grown = 1.0 if line.heat is None else line.heat.growth_at_start
    return Strand(grown * rest, materials["stiffness_n"][: out + 1], materials["mass_per_length_kg_m"][: out + 1] / grown)


def _lag(reel) -> float:
    """Time constant [s] or effective mass [kg], as its mode asks."""
    if reel is None:
        return 1.0
    return reel.lag_s if reel.mode == "rate" else reel.effective_mass_kg


def _materials(line) -> dict[str, np.ndarray]:
    """(segments,) of each property of `MATERIAL`."""
    edges = spacing(line) * np.arange(line.nodes + 2)
    bounds = np.append(np.cumsum([0.0, *(one.length_m for one in line.stretch)]), np.inf)
    parts = [*line.stretch, line]
    overlap = np.minimum(edges[1:, None], bounds[None, 1:]) - np.maximum(edges[:-1, None], bounds[None, :-1])
    share = np.maximum(overlap, 0.0) / spacing(line)
    share[share < 1e-9] = 0.0
    share /= share.sum(axis=1, keepdims=True)
    found = {}
    for key, rule in MATERIAL.items():
        given = [getattr(part, key) for part in parts]
        values = np.array([getattr(line, key) if value is None else value for value in given])
        if rule == "mean":
            found[key] = share @ values
        else:
            with np.errstate(divide="ignore", invalid="ignore"):
                compliance = np.where(share > 0.0, share / values, 0.0).sum(axis=1)
                found[key] = 1.0 / compliance
    return found


def is_exposed(scenario, line) -> bool:
    """Whether air or current act on a line."""
    air = scenario.environment.atmosphere.model != "none" and line.drag_coefficient > 0.0
    wide = line.diameter_m > 0.0 or any(part.diameter_m for part in line.stretch)
    return line.circuit is not None or (air and wide)


def _capacity(line, linear_mass: np.ndarray) -> np.ndarray:
    """(segments,) heat capacity per length [J/m/K]; 1 for a line without temperature."""
    return linear_mass * line.heat.specific_heat_j_kg_k if line.heat else np.ones_like(linear_mass)


def _joined(parts) -> np.ndarray:
    """Arrays one after the other, also of no line."""
    return np.concatenate([np.zeros(0), *parts]).astype(float)
