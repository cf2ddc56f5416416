"""What holds for every line that hangs in orbit, from metres to a hundred kilometres, between any bodies."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import fieldline as fl
from fieldline.analysis.tether import eigenmotions, hanging_line, librating, point_masses, rod_tension, skiprope
from fieldline.analysis.tether.strand import Strand
from fieldline.constants import EARTH_GM_M3_S2
from fieldline.errors import InputError

POWERS = {
    "length": st.floats(1.0, 5.0),
    "linear_mass": st.floats(-4.0, -1.0),
    "strain": st.floats(-6.0, -2.0),  # of the line under its own tide, about
    "lower": st.floats(-1.0, 5.0),
    "upper": st.floats(-1.0, 5.0),
}
LINES = st.fixed_dictionaries(POWERS).map(lambda powers: {name: 10.0**power for name, power in powers.items()})
NODES = st.integers(0, 12) | st.none()
TOP_M = 7e6


def stiffness_of(line):
    """[N] that gives about the strain that is asked for."""
    low, high, rope = line["lower"], line["upper"], line["length"] * line["linear_mass"]
    pull = 3.0 * EARTH_GM_M3_S2 / TOP_M**3 * line["length"] * (low * high / (low + high) + rope)
    return pull / line["strain"]


def hung(line, nodes):
    return hanging_line(line["length"], line["linear_mass"], stiffness_of(line), line["lower"], line["upper"], TOP_M, nodes)


@settings(max_examples=40, deadline=None)
@given(LINES, NODES)
def test_a_line_at_rest_is_pulled_everywhere_and_balanced(line, nodes):
    hanging = hung(line, nodes)
    grid = hanging.grid
    assert np.all(hanging.tension > 0.0) and np.all(np.diff(hanging.radius) > 0.0)
    load = grid.mass * (hanging.rate**2 * hanging.radius - EARTH_GM_M3_S2 / hanging.radius**2)
    size = grid.mass.max() * 9.0 * 1e-15 + 1e-9 * hanging.tension.max()
    assert np.abs(grid.slope.T @ (grid.weight * hanging.tension) - load).max() < 30.0 * size
    kepler = np.sqrt(EARTH_GM_M3_S2 / hanging.centre_radius**3)
    assert 0.0 <= hanging.rate / kepler - 1.0 + 1e-13 < 1.5 * (line["length"] / TOP_M) ** 2 + 1e-12


@settings(max_examples=12, deadline=None)
@given(LINES, NODES)
def test_motions_are_ordered_and_independent(line, nodes):
    """Rates rise; shapes across the plane are orthogonal by mass, to the orbit as well; librations near root three and two."""
    hanging = hung(line, nodes)
    mass, families = hanging.grid.mass, eigenmotions(hanging)
    for family in families:
        assert np.all(np.diff(family.rate) >= 0.0)
        assert np.allclose(np.abs(family.shape).max(axis=1), 1.0)
    shapes = families.out_of_plane.shape[:8]
    shapes = shapes / np.sqrt((mass * shapes**2).sum(axis=1, keepdims=True))
    assert np.allclose(shapes * mass @ shapes.T, np.eye(len(shapes)), atol=1e-6)
    assert np.allclose(shapes @ (mass * hanging.radius) / np.sqrt(mass @ hanging.radius**2), 0.0, atol=1e-6)
    longer = line["length"] / TOP_M + 3.0 * line["strain"]
    assert np.isclose(families.in_plane.rate[0] / hanging.rate, np.sqrt(3.0), rtol=3.0 * longer + 1e-7)
    assert np.isclose(families.out_of_plane.rate[0] / hanging.rate, 2.0, rtol=3.0 * longer + 1e-7)
    assert len(families.along_line.rate) == len(mass) - 1


@settings(max_examples=30, deadline=None)
@given(
    LINES,
    st.integers(1, 12),
    st.booleans(),
    st.floats(-0.9, 0.9),
    st.floats(-0.9, 0.9),
    st.sampled_from(["right-handed", "left-handed", "plane"]),
)
def test_starts_are_taut_and_leave_the_bodies_alone(line, nodes, upward, in_plane, across, sense):
    """Stretch gives the tension that turns the line as a rod; a skiprope moves nodes across the line, and no attachment."""
    assume(line["strain"] * line["length"] > 1e-6)
    segments = nodes + 1
    strand = Strand(*(np.full(segments, v) for v in (line["length"] / segments, stiffness_of(line), line["linear_mass"])))
    bodies = (line["lower"], line["upper"]) if upward else (line["upper"], line["lower"])
    place, velocity = np.array([TOP_M, 1e5, -2e5]), np.array([10.0, 7000.0, 2000.0])
    state = librating(place, velocity, strand, *bodies, upward=upward, in_plane_rad=in_plane, across_rad=across)
    tension = rod_tension(state, point_masses(strand, *bodies))
    strain = np.linalg.norm(np.diff(state.position_i, axis=0), axis=1) / strand.rest - 1.0
    noise = 1e-8 / strand.rest[0] * strand.stiffness[0] + 1e-12 * max(bodies)
    assert np.allclose(strain * strand.stiffness, tension, rtol=1e-3, atol=3.0 * noise)
    assert (np.linalg.norm(state.position_i[-1]) > np.linalg.norm(state.position_i[0])) == upward
    if not tension.min() > 1e-3 * tension.max():
        return
    swung = skiprope(state, strand, *bodies, amplitude_m=0.01 * line["length"], phase_rad=1.0, sense=sense)
    moved = swung.position_i - state.position_i
    e = state.position_i[-1] - state.position_i[0]
    assert np.abs(moved @ e / np.linalg.norm(e)).max() < 1e-8
    assert np.allclose(moved[[0, -1]], 0.0, atol=1e-8) and np.isclose(
        np.linalg.norm(moved, axis=1).max(), 0.01 * line["length"], rtol=1e-6
    )


@settings(max_examples=40, deadline=None)
@given(
    st.lists(
        st.one_of(st.none(), st.booleans(), st.text(max_size=3), st.floats(), st.integers(-3, 3), st.just([1.0, 2.0])),
        min_size=6,
        max_size=6,
    ),
    NODES,
)
def test_anything_else_is_refused_in_words(values, nodes):
    """Six values of any kind: modes, or an InputError."""
    try:
        assert fl.tether_modes(*values, nodes).sizes["in_plane_mode"] >= 1
    except InputError as error:
        assert str(error)
    except Exception as error:  # anything else is a fault
        pytest.fail(f"{type(error).__name__}: {error}")
