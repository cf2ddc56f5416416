"""What tests of lines in the plant share: a body under another on a line of nodes, flown; its points, tension and shape."""

from typing import NamedTuple

import numpy as np

import plant_flights as pf
from fieldline.analysis.line_shape import LineShape, shape_of_line
from fieldline.analysis.tether import hanging_line
from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M
from fieldline.dynamics.layout import starts_in_state
from fieldline.simulate.flight import Flight
from line_loads import ORIGIN_M

SHIP_KG, PROBE_KG = 86363.0, 500.0
LENGTH_M, KG_PER_M, STIFFNESS_N = 20e3, 8.35e-3, 3.2e5
TOP_M = EARTH_EQUATORIAL_RADIUS_M + 220e3


class Points(NamedTuple):
    """A line of a flight, from its from_body to its to_body."""

    seconds: np.ndarray  # (t,)
    position: np.ndarray  # (t, p, 3) [m]
    velocity: np.ndarray  # (t, p, 3) [m/s]
    tension: np.ndarray  # (t, p - 1) [N]
    mass: np.ndarray  # (p,) [kg], bodies included


def line(nodes=10, **more):
    """20 km from the ship down to the probe."""
    usual = {
        "from_body": "ship",
        "to_body": "probe",
        "rest_length_m": LENGTH_M,
        "stiffness_n": STIFFNESS_N,
        "mass_per_length_kg_m": KG_PER_M,
        "nodes": nodes,
    }
    return usual | more


def hung(nodes=10, *, seconds, output, step=0.1, hang=None, start=None, **more):
    """The scenario of a probe hung 20 km under a ship, as points, about a point Earth."""
    bodies = (
        pf.body("ship", kind="point", mass_kg=SHIP_KG),
        pf.body("probe", kind="point", mass_kg=PROBE_KG, hang=hang or {}),
    )
    orbit = {"elements": {"altitude_km": 220.0, "inclination_deg": 28.5}}
    one = line(nodes, **more) | ({"start": start} if start else {})
    return pf.scenario(*bodies, seconds=seconds, output=output, orbit=orbit, integrator={"step_s": step}, line=[one])


def flown(scenario) -> Flight:
    """A finished flight of a scenario."""
    flight = Flight(scenario)
    flight.fly()
    return flight


def points(flight: Flight, k=0) -> Points:
    """Points of line k of a flight between point bodies."""
    rows, states = pf.rows(flight)
    nodes, _, _ = starts_in_state(flight.plant)
    lines = flight.plant.lines
    first, last = lines.first[k : k + 2]
    inner = flight.record.state[: len(rows), nodes + 6 * first : nodes + 6 * last].reshape(len(rows), last - first, 6)
    ends = [states[:, b, None, :6] for b in lines.body[k]]
    whole = np.concatenate([ends[0], inner, ends[1]], axis=1)
    segments = slice(first + k, last + k + 1)
    half = 0.5 * lines.rest[segments] * lines.linear_mass[segments]
    mass = np.append(half, 0.0) + np.append(0.0, half)
    mass[[0, -1]] += flight.plant.bodies.mass[lines.body[k]]
    return Points(rows, whole[..., :3], whole[..., 3:], flight.record.tension[: len(rows), segments], mass)


def shape(one: Points) -> LineShape:
    """Its shape about the mass centre of line and bodies."""
    share = one.mass / one.mass.sum()
    return shape_of_line(
        one.position, one.velocity, np.einsum("p,tpj->tj", share, one.position), np.einsum("p,tpj->tj", share, one.velocity)
    )


def at_rest(nodes):
    """The state of rest that the plant's line should keep."""
    return hanging_line(LENGTH_M, KG_PER_M, STIFFNESS_N, PROBE_KG, SHIP_KG, TOP_M, nodes)


def frequency(seconds, values, near):
    """[rad/s] of the strongest sine in samples (t,), by least squares about a first guess (with its own mean and slope)."""
    from scipy.optimize import minimize_scalar

    t = np.asarray(seconds) - seconds[0]

    def left(w):
        basis = np.stack([np.cos(w * t), np.sin(w * t), np.ones_like(t), t / t[-1]], axis=1)
        return float(np.sum((values - basis @ np.linalg.lstsq(basis, values, rcond=None)[0]) ** 2))

    width = 0.5 * np.pi / t[-1]
    return float(minimize_scalar(left, bounds=(near - width, near + width), method="bounded", options={"xatol": 1e-9 * near}).x)


HELD_KG = 1e12  # of a body that a line cannot move


def laboratory(places, rest_m, *, ends, seconds, output, step, kg_per_m, stiffness, damping=0.0, drag=0.0, g=9.80665):
    """A flight, not flown yet, of a line under uniform gravity from places (p, 3) [m] at rest, z up.

    ends : for either end None (held), a mass [kg] (free), or (acceleration (3,) [m/s^2], rate): held and moved as a cos(rate t).
    """
    half = 0.5 * kg_per_m * rest_m / (len(places) - 1)
    bodies = []
    for name, end in zip(("ship", "probe"), ends, strict=True):
        mass = float(end) if isinstance(end, int | float) else HELD_KG
        pull = (-g, 0.0, 0.0) if isinstance(end, int | float) else (0.0, 0.0, 0.0)
        drive, rate = ((0.0, 0.0, 0.0), 0.0) if end is None or isinstance(end, int | float) else end
        numbers = [mass + half, *pull, drive[2], drive[0], drive[1], rate]
        load = {"function": "line_loads:laboratory_body", "parameters": _numbered(numbers)}
        bodies.append(pf.body(name, kind="point", mass_kg=mass, load=[load]))
    bodies[1]["offset_o_m"] = (0.0, 0.0, 1.1 * rest_m)
    one = line(len(places) - 2, rest_length_m=rest_m, stiffness_n=stiffness, damping_n_s=damping, mass_per_length_kg_m=kg_per_m)
    if len(places) > 2:
        one["load"] = [{"function": "line_loads:laboratory", "parameters": _numbered([-g, 0.0, 0.0, drag])}]
    flight = Flight(pf.scenario(*bodies, seconds=seconds, output=output, integrator={"step_s": step}, line=[one]))
    laid = np.asarray(places, dtype=float)[:, [2, 0, 1]] + [ORIGIN_M, 0.0, 0.0]
    nodes, _, _ = starts_in_state(flight.plant)
    for place, base in zip(laid, [0, *range(nodes, nodes + 6 * (len(places) - 2), 6), 13], strict=True):
        flight.y[base : base + 3], flight.y[base + 3 : base + 6] = place, 0.0
    flight.start[:] = flight.y
    return flight


def _numbered(values):
    """Parameters of a load: numbers by name, in order."""
    return {f"p{k}": float(value) for k, value in enumerate(values)}


def in_laboratory(one: Points) -> np.ndarray:
    """(t, p, 3) places from the origin, z up."""
    return (one.position - [ORIGIN_M, 0.0, 0.0])[..., [1, 2, 0]]
