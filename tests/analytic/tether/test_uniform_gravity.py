"""The plant's line where the Earth's pull is replaced by a uniform one: pendulum, hanging chain, catenary."""

import numpy as np
import pytest
from scipy.optimize import fsolve
from scipy.special import ellipk, j0, jn_zeros

import tether_flights as tf

G = 9.80665


@pytest.mark.parametrize("degrees", [5.0, 60.0, 85.0])
def test_a_massless_line_with_a_bob_is_a_pendulum(degrees):
    """T = 4 sqrt(L/g) K(sin(a/2)), as stretch goes to zero (a part in 3e5 here)."""
    length, stiffness, bob = 10.0, 4e7, 12.0
    a = np.radians(degrees)
    places = [[0.0, 0.0, 0.0], [length * np.sin(a), 0.0, -length * np.cos(a)]]
    flight = tf.laboratory(
        places, length, ends=(None, bob), seconds=15.0, output=0.05, step=1e-3, kg_per_m=0.0, stiffness=stiffness, damping=4e4
    )
    flight.fly()
    one = tf.points(flight)
    x = tf.in_laboratory(one)[:, 1, 0]
    k = np.flatnonzero(np.diff(np.sign(x)))
    cross = one.seconds[k] - 0.05 * x[k] / np.diff(x)[k]
    period = 2.0 * np.diff(cross).mean()
    assert np.isclose(period, 4.0 * np.sqrt(length / G) * ellipk(np.sin(0.5 * a) ** 2), rtol=4e-5)
    assert np.isclose(one.tension.max(), bob * G * (3.0 - 2.0 * np.cos(a)), rtol=5e-3)


@pytest.mark.parametrize("mode", [1, 2])
def test_a_hanging_chain_swings_with_bessels_zeros(mode):
    """w = j0_k / 2 sqrt(g/L) and J0(2 w sqrt(s/g)) from the free end, by nodes to the square of their spacing."""
    length, miss = 50.0, {}
    zero = jn_zeros(0, mode)[-1]
    for segments in (10, 20):
        s = np.linspace(0.0, length, segments + 1)
        bow = 0.05 * j0(zero * np.sqrt(1.0 - s / length))
        places = np.stack([bow, np.zeros_like(s), -s], axis=1)
        flight = tf.laboratory(
            places, length, ends=(None, 1e-9), seconds=40.0, output=0.1, step=2e-3, kg_per_m=0.5, stiffness=5e5, damping=50.0
        )
        flight.fly()
        one = tf.points(flight)
        swing = tf.in_laboratory(one)[:, :, 0] @ (one.mass * bow * (np.arange(segments + 1) > 0))
        rate = 0.5 * zero * np.sqrt(G / length)
        miss[segments] = tf.frequency(one.seconds, swing, rate) / rate - 1.0
    assert abs(miss[20]) < 3e-3 * mode**2
    assert 3.3 < miss[10] / miss[20] < 4.2


def catenary(span, drop, length, weight, stiffness, s):
    """(places (p, 2), tension (p,)) of an elastic catenary at unstretched places s, its far end `drop` below.

    x = H s/EA + H/w [asinh(V/H) - asinh((V - w s)/H)], y = ... (Irvine 1981, Cable Structures, section 1.3).
    """

    def place(h, v, s):
        lower = v - weight * s
        x = h * s / stiffness + h / weight * (np.arcsinh(v / h) - np.arcsinh(lower / h))
        y = weight * s / stiffness * (v / weight - 0.5 * s) + (np.hypot(h, v) - np.hypot(h, lower)) / weight
        return x, y

    h, v = fsolve(lambda p: np.subtract(place(p[0], p[1], length), (span, drop)), [0.5 * weight * length, 0.6 * weight * length])
    x, y = place(h, v, s)
    return np.stack([x, -y], axis=1), np.hypot(h, v - weight * s)


def test_a_line_with_drag_comes_to_rest_in_a_catenary():
    """From a polygon to the elastic catenary; the nodes' own error goes with the square of their spacing."""
    length, span, drop, kg_per_m, stiffness = 100.0, 80.0, 10.0, 0.2, 2e4
    miss = {}
    for segments in (8, 16):
        s = np.linspace(0.0, length, segments + 1)
        x = np.linspace(0.0, span, segments + 1)
        polygon = np.stack([x, np.zeros_like(x), -0.5 * drop * x / span - 50.0 * np.minimum(x, span - x) / span], axis=1)
        polygon[-1, 2] = -drop
        flight = tf.laboratory(
            polygon, length, ends=(None, None), seconds=60.0, output=60.0, step=5e-3, kg_per_m=kg_per_m,
            stiffness=stiffness, damping=200.0, drag=0.8,
        )  # fmt: skip
        flight.fly()
        one = tf.points(flight)
        told, _ = catenary(span, drop, length, kg_per_m * G, stiffness, s)
        places = tf.in_laboratory(one)[-1]
        assert np.abs(one.velocity[-1]).max() < 1e-6
        assert np.abs(places[:, 1]).max() < 1e-6
        miss[segments] = np.abs(places[:, [0, 2]] - told).max()
        middle = catenary(span, drop, length, kg_per_m * G, stiffness, 0.5 * (s[1:] + s[:-1]))[1]
        assert np.allclose(one.tension[-1], middle, rtol=0.25 / segments**2 * 8.0)
    assert miss[16] < 0.06 and np.isclose(miss[8] / miss[16], 4.0, rtol=0.1)
