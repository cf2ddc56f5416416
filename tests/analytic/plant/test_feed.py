"""A reel feeds a line: momentum over the reel, and a node that comes or goes without a jump."""

import numpy as np
import pytest

from fieldline.dynamics.lines.feed import feed_loads, insert_node, remove_node
from fieldline.dynamics.loads.line import line_tension

MU, EA, CD = 0.008, 3.2e5, 1.6e4


def tension(chord, chord_rate, length, rate, stiffness=EA, damping=CD):
    """Of a fed piece, and its unit vector."""
    stretched = np.linalg.norm(chord)
    speed = chord @ chord_rate / stretched - rate * stretched / length
    return line_tension(stretched, speed, length, stiffness, damping), chord / stretched


class FreeLine:
    """A mass, one node, and a reel's body, nothing else in the world; the reel's rate is a given function of time."""

    rest, far, reel = 100.0, 50.0, 400.0

    def __init__(self, rate, acceleration, length):
        self.rate, self.acceleration, self.start = rate, acceleration, length

    def masses(self, length):
        """Of the far body with its half piece, the node, the reel's body, and the half piece on it."""
        half = 0.5 * MU * self.rest
        return self.far + half, half + 0.5 * MU * length, self.reel - MU * (length - self.start), 0.5 * MU * length

    def rates(self, t, s):
        """Of (positions, velocities of far body, node, reel; l)."""
        place, speed, length = s[:9].reshape(3, 3), s[9:18].reshape(3, 3), s[18]
        far, node, reel, half = self.masses(length)
        u, du = self.rate(t), self.acceleration(t)
        inner, e1 = tension(place[0] - place[1], speed[0] - speed[1], self.rest, 0.0)
        d, w = place[1] - place[2], speed[1] - speed[2]
        outer, e2 = tension(d, w, length, u)
        on_node, on_reel = feed_loads(tuple(d), tuple(w), length, u, du, MU)
        accelerations = (
            -inner * e1 / far,
            (inner * e1 - outer * e2 + on_node) / node,
            (outer * e2 + on_reel) / (reel + half),
        )
        return np.concatenate([speed.ravel(), *accelerations, [u]])

    def momentum(self, t, s):
        """Of everything, with what streams through the last piece."""
        place, speed, length = s[:9].reshape(3, 3), s[9:18].reshape(3, 3), s[18]
        far, node, reel, half = self.masses(length)
        out = speed[2] + self.rate(t) / length * (place[1] - place[2])
        return far * speed[0] + node * speed[1] + reel * speed[2] + half * out

    def first_moment(self, s):
        """Sum of mass times place, what is on the reel at the reel."""
        place = s[:9].reshape(3, 3)
        far, node, reel, half = self.masses(s[18])
        return far * place[0] + node * place[1] + (reel + half) * place[2]


def flown(line, s, h=0.01, steps=800):
    """RK4, the state at the end."""
    t = 0.0
    for _ in range(steps):
        k1 = line.rates(t, s)
        k2 = line.rates(t + h / 2, s + h / 2 * k1)
        k3 = line.rates(t + h / 2, s + h / 2 * k2)
        k4 = line.rates(t + h, s + h * k3)
        s, t = s + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4), t + h
    return t, s


@pytest.mark.kernels
@pytest.mark.parametrize("sense", [1.0, -1.0], ids=["out", "in"])
def test_momentum_stays_and_moves_the_centre_of_mass(sense):
    line = FreeLine(lambda t: sense * (2.0 + np.sin(t)), lambda t: sense * np.cos(t), 80.0)
    place = [0.0, 0.0, 180.02, 0.5, 0.0, 80.0, 0.0, 0.0, 0.0]
    speed = [0.3, 0.1, 0.2 + 2.0 * sense, -0.2, 0.4, 2.0 * sense, 0.02, -0.05, 0.0]
    start = np.array([*place, *speed, 80.0])
    end, s = flown(line, start)
    assert abs(s[18] - 80.0) > 10.0
    before = line.momentum(0.0, start)
    np.testing.assert_allclose(line.momentum(end, s), before, atol=2e-9 * np.linalg.norm(before))
    np.testing.assert_allclose(line.first_moment(s) - line.first_moment(start), before * end, atol=1e-7 * np.linalg.norm(before))


@pytest.mark.kernels
@pytest.mark.parametrize("u", [3.0, -3.0])
def test_even_straight_feed_loads_the_drum_with_less_than_the_tension(u):
    """T - mu u^2 (1 + strain) holds the drum, and the node feels no more than its two tensions."""
    length, strain = 120.0, 1e-4
    chord = (0.0, 0.0, length * (1.0 + strain))
    on_node, on_reel = feed_loads(chord, (0.0, 0.0, u * (1.0 + strain)), length, u, 0.0, MU)
    np.testing.assert_allclose(on_node, 0.0, atol=1e-16)
    np.testing.assert_allclose(on_reel, (0.0, 0.0, -MU * u * u * (1.0 + strain)), rtol=1e-12)


def bent(rng, length, strain):
    """Chord and its rate of a piece, some of it across."""
    direction = rng.normal(size=3)
    chord = direction / np.linalg.norm(direction) * length * (1.0 + strain)
    return chord, rng.normal(size=3)


@pytest.mark.kernels
def test_a_node_appears_without_a_jump():
    rng = np.random.default_rng(4)
    for _ in range(50):
        length, u, h = rng.uniform(140.0, 400.0), rng.normal(), 100.0
        chord, chord_rate = bent(rng, length, rng.uniform(1e-5, 1e-3))
        was, _ = tension(chord, chord_rate, length, u)
        place, moving, rest, over = insert_node(tuple(chord), tuple(chord_rate), length, u, h, (EA, EA), (MU, MU))
        place, moving = np.array(place), np.array(moving)
        assert tension(place, moving, rest, u)[0] == pytest.approx(was, rel=1e-9, abs=1e-6)
        assert tension(chord - place, chord_rate - moving, h, 0.0)[0] == pytest.approx(was, rel=1e-9, abs=1e-6)
        assert rest == pytest.approx(length - h, rel=1e-14)
        np.testing.assert_allclose(over, 0.0, atol=1e-13)
        first = 0.5 * MU * (h * (chord + place) + rest * place)
        np.testing.assert_allclose(first, 0.5 * MU * length * chord, rtol=1e-12, atol=1e-12)


@pytest.mark.kernels
def test_a_node_appears_where_the_line_changes_its_stuff():
    chord, chord_rate = (0.0, 0.0, 150.03), (0.1, 0.0, 1.0)
    place, moving, rest, over = insert_node(chord, chord_rate, 150.0, 1.0, 100.0, (EA, 3.0 * EA), (MU, 2.0 * MU))
    was = tension(np.array(chord), np.array(chord_rate), 150.0, 1.0, EA, 0.0)[0]
    assert tension(np.array(place), np.array(moving), rest, 1.0, 3.0 * EA, 0.0)[0] == pytest.approx(was, rel=1e-9)
    whole = 0.5 * MU * (150.0 * np.array(chord_rate) + np.array(chord))
    pieces = MU * 50.0 * (np.array(chord_rate) + moving) + MU * (rest * np.array(moving) + np.array(place))
    np.testing.assert_allclose(pieces + over, whole, rtol=1e-12)
    assert np.linalg.norm(over) > 0.1


@pytest.mark.kernels
def test_a_node_vanishes_into_the_mean_tension_and_nothing_is_lost():
    rng = np.random.default_rng(5)
    for _ in range(50):
        r, length, u = 100.0, rng.uniform(5.0, 40.0), rng.normal()
        node, node_rate = bent(rng, length, rng.uniform(5e-5, 1e-3))
        away = node / np.linalg.norm(node) + 0.02 * rng.normal(size=3)
        chord = node + away / np.linalg.norm(away) * r * (1.0 + rng.uniform(5e-5, 1e-3))
        chord_rate = node_rate + 0.1 * rng.normal(size=3)
        pieces = tension(chord - node, chord_rate, r, 0.0, EA, 0.0)[0], tension(node, node_rate, length, u, EA, 0.0)[0]
        vectors = (tuple(chord), tuple(chord_rate), tuple(node), tuple(node_rate))
        rest, on_node, on_reel = remove_node(*vectors, r, length, u, (EA, EA), (MU, MU))
        mean = (r * pieces[0] + length * pieces[1]) / (r + length)
        assert tension(chord, chord_rate, rest, u, EA, 0.0)[0] == pytest.approx(mean, rel=1e-8)
        assert 0.9 * (r + length) < rest < (1.0 + 1e-6) * (r + length)
        was = 0.5 * MU * (r * (chord_rate + node_rate) + length * node_rate + u * node)
        now = 0.5 * MU * (rest * chord_rate + u * chord)
        np.testing.assert_allclose(now + on_node + on_reel, was, rtol=1e-10, atol=1e-12)


@pytest.mark.kernels
def test_what_has_just_appeared_vanishes_without_a_trace():
    chord, chord_rate = (20.0, 5.0, 150.0), (0.3, -0.1, 1.5)
    length = np.linalg.norm(chord) / 1.0003
    place, moving, rest, _ = insert_node(chord, chord_rate, length, 1.2, 100.0, (EA, EA), (MU, MU))
    back, on_node, on_reel = remove_node(chord, chord_rate, place, moving, 100.0, rest, 1.2, (EA, EA), (MU, MU))
    assert back == pytest.approx(length, rel=1e-12)
    np.testing.assert_allclose((*on_node, *on_reel), 0.0, atol=1e-12)


@pytest.mark.kernels
def test_a_slack_piece_keeps_its_length():
    vectors = ((0.0, 0.0, 100.0), (0.0, 0.0, 0.0), (0.0, 0.0, 10.0), (0.0, 0.0, 0.0))
    assert remove_node(*vectors, 100.0, 30.0, 0.0, (EA, EA), (MU, MU))[0] == 130.0
