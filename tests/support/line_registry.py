"""Lines of many kinds about a point Earth, by name, and what all of them must keep: angular momentum, and energy if undamped."""

import numpy as np
from scipy.spatial.transform import Rotation

import plant_flights as pf
from fieldline.constants import EARTH_GM_M3_S2
from fieldline.dynamics.layout import starts_in_state

INERTIA = ((900.0, 20.0, -30.0), (20.0, 700.0, 15.0), (-30.0, 15.0, 1100.0))
LINE = {"rest_length_m": 5e3, "stiffness_n": 5e4, "mass_per_length_kg_m": 0.01, "nodes": 6}
SWING = {"in_plane_deg": 20.0, "out_of_plane_deg": -10.0}


def point(name, mass, **more):
    return pf.body(name, kind="point", mass_kg=mass, **more)


def rigid(name, mass, **more):
    return pf.body(name, mass_kg=mass, inertia_kg_m2=INERTIA, rate_deg_s=(0.5, -0.2, 0.3), gravity_gradient=False, **more)


def joined(a, b, **more):
    return {"from_body": a, "to_body": b} | LINE | more


def apart(length, rate=(0.0, 0.0, 0.0)):
    return {"offset_o_m": (0.0, 0.0, length), "offset_rate_o_m_s": rate}


PARTS = [{"length_m": 1.7e3, "stiffness_n": 2e4, "mass_per_length_kg_m": 0.03}, {"length_m": 1e3, "stiffness_n": 2e5}]
WAVES = {"skiprope_amplitude_m": 60.0, "skiprope_sense": "left-handed", "pulse_amplitude_m": 0.3, "pulse_width_m": 2000.0}
ROPE = {"skiprope_amplitude_m": 40.0}
EYES = {"from_point_b_m": (0.3, -0.2, 1.5), "to_point_b_m": (0.1, 0.4, -0.8)}

# name: bodies, lines
LINES = {
    "massless": ([point("a", 900.0), point("b", 100.0, hang=SWING)], [joined("a", "b", nodes=0, mass_per_length_kg_m=0.0)]),
    "massive without nodes": ([point("a", 900.0), point("b", 100.0, hang=SWING)], [joined("a", "b", nodes=0)]),
    "nodes": ([point("a", 900.0), point("b", 100.0, hang=SWING)], [joined("a", "b")]),
    "upward": ([point("a", 900.0), point("b", 100.0, hang=SWING | {"upward": True})], [joined("a", "b")]),
    "waves": ([point("a", 900.0), point("b", 100.0, hang={})], [joined("a", "b", start=WAVES)]),
    "materials": ([point("a", 900.0), point("b", 100.0, hang=SWING)], [joined("a", "b", stretch=PARTS)]),
    "slack, then a snap": ([point("a", 900.0), point("b", 100.0, **apart(4980.0, (0.0, 0.0, 0.5)))], [joined("a", "b")]),
    "heavy line": ([point("a", 30.0), point("b", 10.0, hang=SWING)], [joined("a", "b", mass_per_length_kg_m=0.05)]),
    "three in a row": (
        [point("a", 900.0), point("b", 100.0, hang={}), point("c", 50.0, hang={})],
        [joined("a", "b", start=ROPE), joined("b", "c", rest_length_m=2e3, nodes=3)],
    ),
    "two lines at one body": (
        [point("a", 400.0), point("b", 100.0, hang={}), point("c", 150.0, hang={"upward": True})],
        [joined("a", "b", start=ROPE), joined("c", "a", nodes=4, start=ROPE | {"skiprope_sense": "plane"})],
    ),
    "a triangle": (
        [
            point("a", 400.0),
            point("b", 100.0, offset_o_m=(800.0, -300.0, 4940.0)),
            point("c", 150.0, offset_o_m=(-600.0, 200.0, 4960.0)),
        ],
        [joined("a", "b"), joined("a", "c", nodes=4), joined("b", "c", rest_length_m=1500.0, nodes=2)],
    ),
    "levers": ([rigid("a", 900.0), rigid("b", 100.0, hang=SWING)], [joined("a", "b", **EYES)]),
    "levers without nodes": ([rigid("a", 900.0), rigid("b", 100.0, hang=SWING)], [joined("a", "b", nodes=0, **EYES)]),
}


def scenario(name, *, seconds=600.0, step=0.05, damping=0.0):
    """The scenario of a line of the registry, 500 km up."""
    bodies, lines = LINES[name]
    lines = [line | {"damping_n_s": damping} for line in lines]
    return pf.scenario(*bodies, seconds=seconds, output=seconds / 20.0, integrator={"step_s": step}, line=lines)


def masses_of(flight):
    """(position (t, m, 3), velocity (t, m, 3), mass (m,), elastic energy (t,)) of everything that a flight moves as points.

    Bodies, nodes, and the half segments that sit at attachments.
    """
    _, states = pf.rows(flight)
    rows, lines = len(states), flight.plant.lines
    first_node, _, _ = starts_in_state(flight.plant)
    place, speed, mass = [states[..., 0:3]], [states[..., 3:6]], [flight.plant.bodies.mass]
    elastic = np.zeros(rows)
    for k in range(len(lines.nodes)):
        first, last = lines.first[k : k + 2]
        inner = flight.record.state[:rows, first_node + 6 * first : first_node + 6 * last].reshape(rows, last - first, 6)
        ends = [end_of(states[:, lines.body[k, e]], lines.point[k, 3 * e : 3 * e + 3]) for e in (0, 1)]
        points = np.concatenate([ends[0][:, None], inner, ends[1][:, None]], axis=1)
        segments = slice(first + k, last + k + 1)
        half = 0.5 * lines.rest[segments] * lines.linear_mass[segments]
        place.append(points[..., :3])
        speed.append(points[..., 3:])
        mass.append(np.append(half, 0.0) + np.append(0.0, half))
        longer = np.linalg.norm(np.diff(points[..., :3], axis=1), axis=2) - lines.rest[segments]
        elastic += 0.5 * (lines.stiffness[segments] / lines.rest[segments] * np.maximum(longer, 0.0) ** 2).sum(axis=1)
    return np.concatenate(place, axis=1), np.concatenate(speed, axis=1), np.concatenate(mass), elastic


def end_of(states, point_b):
    """(t, 6) of a point fixed in a body of states (t, 13)."""
    turn = Rotation.from_quat(states[:, 6:10])
    lever = np.tile(point_b, (len(states), 1))
    swing = turn.apply(np.cross(states[:, 10:13], lever))
    return np.hstack([states[:, :3] + turn.apply(lever), states[:, 3:6] + swing])


def spins(flight):
    """(energy (t,), momentum (t, 3) in inertial axes) of the bodies' own turn, without the half segments on them."""
    _, states = pf.rows(flight)
    energy, momentum = np.zeros(len(states)), np.zeros((len(states), 3))
    for b, body in enumerate(flight.scenario.body):
        if body.kind == "rigid":
            own = states[:, b, 10:13] @ np.array(body.inertia_kg_m2)
            energy += 0.5 * (own * states[:, b, 10:13]).sum(axis=1)
            momentum += Rotation.from_quat(states[:, b, 6:10]).apply(own)
    return energy, momentum


def energy_and_momentum(flight):
    """Energy (t,) [J], and angular momentum (t, 3) [kg m^2/s] about the Earth's centre."""
    place, speed, mass, elastic = masses_of(flight)
    turning, spin = spins(flight)
    kinetic = 0.5 * ((speed**2).sum(axis=2) @ mass)
    potential = -EARTH_GM_M3_S2 * (1.0 / np.linalg.norm(place, axis=2)) @ mass
    return kinetic + potential + elastic + turning, np.einsum("m,tmj->tj", mass, np.cross(place, speed)) + spin
