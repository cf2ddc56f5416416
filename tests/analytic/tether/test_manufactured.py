"""A manufactured solution of the flexible line: the plant's order in nodes and in step, as Roy (2005) asks of a code.

The chosen motion bows, stretches and shifts all of a taut line at once, by incommensurate frequencies (`manufactured_line`).
With the force of the continuum the error that is left is that of the nodes; with the force of the chain it is that of the step.
"""

from itertools import pairwise

import numpy as np
import pytest

import manufactured_line as made
import plant_flights as pf
import tether_flights as tf
from fieldline.dynamics.layout import starts_in_state
from fieldline.simulate.flight import Flight

END_S = 3.0


def flown(nodes, load, step, method="rk4", **more):
    """(error of place [m], of velocity [m/s], of tension over EA) at the end."""
    h = made.LENGTH / (nodes + 1)
    half = 0.5 * made.KG_PER_M * h
    drive = [tf.HELD_KG + half, 0.0, 0.0, 0.0, 0.0, made.SHIFT * made.W4**2, 0.0, made.W4]
    hold = [{"function": "line_loads:laboratory_body", "parameters": {f"p{k}": value for k, value in enumerate(drive)}}]
    bodies = [pf.body(name, kind="point", mass_kg=tf.HELD_KG, load=hold) for name in ("ship", "probe")]
    bodies[1]["offset_o_m"] = (0.0, 0.0, -made.LENGTH)
    one = tf.line(
        nodes,
        rest_length_m=made.LENGTH,
        stiffness_n=made.STIFFNESS,
        damping_n_s=made.DAMPING,
        mass_per_length_kg_m=made.KG_PER_M,
        load=[{"function": f"manufactured_line:{load}", "parameters": {"h": h}}],
    )
    integrator = {"step_s": step, "method": method} | more
    flight = Flight(pf.scenario(*bodies, seconds=END_S, output=END_S, integrator=integrator, line=[one]))
    first, _, _ = starts_in_state(flight.plant)
    bases = [0, *range(first, first + 6 * nodes, 6), 13]
    for base, place, velocity in zip(bases, *made.exact(nodes, 0.0), strict=True):
        flight.y[base : base + 3], flight.y[base + 3 : base + 6] = place, velocity
    flight.start[:] = flight.y
    flight.fly()
    points = tf.points(flight)
    place, velocity = made.exact(nodes, END_S)
    s = np.linspace(0.0, made.LENGTH, nodes + 2)
    pull = [np.linalg.norm(made.segment_pull(low, high, END_S)) for low, high in pairwise(s)]
    assert np.min(points.tension) > 0.0
    return tuple(
        float(np.abs(miss).max())
        for miss in (points.position[-1] - place, points.velocity[-1] - velocity, (points.tension[-1] - pull) / made.STIFFNESS)
    )


def test_nodes_are_of_second_order():
    """5, 10, 20 and 40 segments; the step's part is a thousandth of the smallest error."""
    errors = np.array([flown(n - 1, "of_continuum", 2e-3) for n in (5, 10, 20, 40)])
    order = np.log2(errors[:-1] / errors[1:])
    assert np.allclose(order[1:], 2.0, atol=0.15), order
    assert errors[-1, 0] < 5e-3


def test_steps_are_of_fourth_order():
    """12 segments; the error of the nodes is taken off by the force. Rounding in radii leaves 1e-8 m."""
    errors = np.array([flown(11, "of_chain", step)[0] for step in (0.08, 0.04, 0.02)])
    assert np.allclose(np.log2(errors[:-1] / errors[1:]), 4.0, atol=0.15), errors
    assert errors[-1] < 3e-7


@pytest.mark.parametrize("method, times", [("dop853", 0.1), ("rosenbrock", 25.0)])
def test_methods_that_choose_their_step_follow_their_tolerance(method, times):
    """The error at the end is a fixed multiple of what is allowed a step, or less."""
    errors = [
        flown(11, "of_chain", 0.01, method, position_tolerance_m=one, velocity_tolerance_m_s=1e-3 * one)[0]
        for one in (1e-3, 1e-5)
    ]
    assert errors[0] < times * 1e-3 and errors[1] < times * 1e-5
    assert errors[1] < 0.1 * errors[0]


@pytest.mark.kernels
def test_the_chosen_motion_obeys_its_equation():
    """(2) against differences of (1): a slip in the forces would show here, not in the plant."""
    s, t, d = 37.0, 1.3, 1e-3

    def pull(s, t):
        m = made.motion(s, t)
        long = np.linalg.norm(m[1])
        tension = made.STIFFNESS * (long - 1.0) + made.DAMPING * (m[1] @ m[4]) / long
        return tension * m[1] / long

    assert np.allclose((pull(s + d, t) - pull(s - d, t)) / (2.0 * d), made.pull_gradient(s, t), rtol=1e-6)
    rows = made.motion(s, t)
    along = made.motion(s + d, t) - made.motion(s - d, t)
    over = made.motion(s, t + d) - made.motion(s, t - d)
    for which, change in ((1, along[0]), (3, along[1]), (2, over[0]), (4, over[1]), (5, over[2]), (6, over[3])):
        assert np.allclose(change / (2.0 * d), rows[which], rtol=1e-5, atol=1e-7)
    chain = (made.segment_pull(s, s + d, t) - made.segment_pull(s - d, s, t)) / d
    assert np.allclose(chain, made.pull_gradient(s, t), rtol=1e-5)
