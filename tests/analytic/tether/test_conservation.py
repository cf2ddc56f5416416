"""What every line keeps about a point Earth: angular momentum, and energy but for what damping takes; momentum inside it."""

import numpy as np
import pytest

import line_registry as lr
import plant_flights as pf
import tether_flights as tf
from fieldline.constants import EARTH_GM_M3_S2
from fieldline.dynamics.parameters import TANGENT
from fieldline.simulate.flight import Flight

# a snap is a kink in the force: rk4 of 0.02 s misses its instant, and leaves that much of the energy of the stretch
SNAPS = {"slack, then a snap", "waves", "three in a row", "two lines at one body", "a triangle"}


@pytest.mark.parametrize("name", lr.LINES)
def test_energy_and_angular_momentum_are_kept(name):
    flight = tf.flown(lr.scenario(name, seconds=400.0, step=0.02))
    energy, momentum = lr.energy_and_momentum(flight)
    assert np.abs(momentum - momentum[0]).max() < 5e-14 * np.linalg.norm(momentum[0])
    allowed = 1e-13 * abs(energy[0]) + (0.15 if name in SNAPS else 0.0)  # of some tens of joules in the stretch
    assert np.abs(energy - energy[0]).max() < allowed
    slack = (flight.record.tension[: len(energy)] == 0.0).any()
    assert slack == (name in SNAPS)


@pytest.mark.parametrize("name", sorted(SNAPS | {"levers"}))
def test_damping_takes_energy_and_no_angular_momentum(name):
    flight = tf.flown(lr.scenario(name, seconds=400.0, step=0.02, damping=5e3))
    energy, momentum = lr.energy_and_momentum(flight)
    assert np.abs(momentum - momentum[0]).max() < 5e-14 * np.linalg.norm(momentum[0])
    assert energy[-1] < energy[0] - 0.02
    assert np.diff(energy).max() < 2e-3  # rounding of 3e10 J


def test_a_smaller_step_finds_the_snap():
    """The energy that a snap leaves falls with the step."""
    left = []
    for step in (0.08, 0.04, 0.02):
        energy, _ = lr.energy_and_momentum(tf.flown(lr.scenario("slack, then a snap", seconds=200.0, step=step)))
        left.append(np.abs(energy - energy[0]).max())
    assert left[0] > 2.0 * left[1] > 4.0 * left[2]


@pytest.mark.kernels
@pytest.mark.parametrize("name", ["nodes", "materials", "three in a row", "a triangle", "heavy line"])
def test_inner_forces_add_up_to_nothing(name):
    """The sum of m a over bodies and nodes is that of their weights: in a stretched, bent, moving line."""
    flight = Flight(lr.scenario(name, damping=5e3))
    rng = np.random.default_rng(7)
    bodies = len(flight.scenario.body)
    nodes = int(flight.plant.lines.first[-1])
    rows = flight.y[13 * bodies : 13 * bodies + 6 * nodes].reshape(nodes, 6)
    rows[:, :3] += rng.normal(0.0, 20.0, (nodes, 3))
    rows[:, 3:] += rng.normal(0.0, 2.0, (nodes, 3))
    rates, _ = pf.rates(flight)
    inner = rates[TANGENT * bodies : TANGENT * bodies + 6 * nodes].reshape(nodes, 6)
    acceleration = np.concatenate([rates[: TANGENT * bodies].reshape(bodies, TANGENT)[:, 3:6], inner[:, 3:]])
    place = np.concatenate([flight.y[: 13 * bodies].reshape(bodies, 13)[:, :3], rows[:, :3]])
    mass = np.concatenate([flight.plant.bodies.mass, np.zeros(nodes)])
    lines = flight.plant.lines
    for k in range(len(lines.nodes)):
        a, b = lines.first[k : k + 2]
        half = 0.5 * lines.rest[a + k : b + k + 1] * lines.linear_mass[a + k : b + k + 1]
        points = np.append(half, 0.0) + np.append(0.0, half)
        mass[lines.body[k, 0]] += points[0]
        mass[lines.body[k, 1]] += points[-1]
        mass[bodies + a : bodies + b] = points[1:-1]
    weight = -EARTH_GM_M3_S2 * place / np.linalg.norm(place, axis=1, keepdims=True) ** 3
    left = mass @ (acceleration - weight)
    pulls = (mass[:, None] * np.abs(acceleration - weight)).sum()
    assert pulls > 10.0
    assert np.abs(left).max() < 1e-14 * (mass @ np.linalg.norm(weight, axis=1)) + 1e-13 * pulls
