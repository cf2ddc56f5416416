"""A line at rest in orbit: against the continuum, closed forms and an independent re-derivation."""

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from fieldline.analysis.tether import (
    Stretches,
    chain_grid,
    cut,
    hang,
    hanging_line,
    inextensible_rate,
    inextensible_tension,
    point_masses,
)
from fieldline.errors import InputError

GM = 3.986013e14  # of the 1982 report
TOP = 6598e3
LINE = (20e3, 8.35e-3, 3.2e5, 500.0, 86363.0, TOP)
# segments: rate [rad/s], tension of the first and the last segment [N], stretch [m]: an independent code's
LUMPED = {
    1: (0.0011780512109933305, 48.413538209474886, 48.413538209474886, 3.025846137665212),
    2: (0.0011780512068907914, 44.94928858135767, 48.38464594619395, 2.9166854536160827),
    10: (0.0011780512055780024, 42.178008599726866, 48.364180054602066, 2.8817542530596256),
    100: (0.0011780512055238502, 41.554483356155124, 48.35989927965659, 2.880313345231116),
}


def at(heights, hanging, rest):
    """Tension at unstretched heights of a continuum."""
    return np.interp(heights, hanging.grid.station, rest)


@pytest.mark.parametrize("segments", LUMPED)
def test_nodes_hang_as_another_code_hangs_them(segments):
    hanging = hanging_line(*LINE, segments - 1, gm_m3_s2=GM)
    rate, first, last, stretch = LUMPED[segments]
    assert np.isclose(hanging.rate, rate, rtol=1e-14)
    assert np.allclose(hanging.tension[[0, -1]], (first, last), rtol=0.0, atol=3e-9)  # its own rounding, in radii
    assert np.isclose(hanging.stretch[-1], stretch, rtol=0.0, atol=3e-9)


def test_the_continuum_is_that_of_another_code():
    hanging = hanging_line(*LINE, None, gm_m3_s2=GM)
    heights, tension = hanging.grid.place, hanging.tension
    fit = np.polynomial.Polynomial.fit(heights, tension, 12)
    told = (41.4852, 44.5122, 46.6660, 47.9480, 48.3594)
    assert np.allclose(fit([0.0, 5e3, 10e3, 15e3, 20e3]), told, rtol=0.0, atol=6e-5)
    assert np.isclose(hanging.rate, 1.178051205523e-3, rtol=1e-12)
    assert np.isclose(hanging.stretch[-1], 2.8803, rtol=0.0, atol=5e-5)


def test_the_continuum_solves_its_boundary_value_problem():
    """r' = 1 + T/EA, T' = mu (GM/r^2 - n^2 r), by SciPy's collocation with the rate as a parameter."""
    length, mu, stiffness, lower, upper, top = LINE
    unit = GM / top**3

    def slope(x, y, p):
        r = top + length * y[0]
        stretch = y[1] * mu * unit * length**2 / stiffness
        return np.array([1.0 + stretch, (GM / r**2 - p[0] * unit * r) / (unit * length)])

    def ends(low, high, p):
        scale = unit * length * mu * length
        r_low = top + length * low[0]
        return np.array(
            [
                low[1] - lower * (GM / r_low**2 - p[0] * unit * r_low) / scale,
                high[1] + upper * (GM / top**2 - p[0] * unit * top) / scale,
                high[0],
            ]
        )

    x = np.linspace(0.0, 1.0, 41)
    guess = np.array([x - 1.0, np.full_like(x, 9.7)])
    solution = solve_bvp(slope, ends, x, guess, p=[1.0], tol=1e-9)
    hanging = hanging_line(*LINE, None, gm_m3_s2=GM)
    tension = solution.sol(hanging.grid.place / length)[1] * unit * length * mu * length
    assert solution.success
    assert np.allclose(tension, hanging.tension, rtol=1e-6)
    assert np.isclose(np.sqrt(solution.p[0] * unit), hanging.rate, rtol=1e-10)


def test_nodes_come_to_the_continuum_with_the_square_of_their_spacing():
    continuum = hanging_line(*LINE, None, gm_m3_s2=GM)
    fit = np.polynomial.Polynomial.fit(continuum.grid.place, continuum.tension, 14)
    for segments in (10, 20, 40, 80):
        hanging = hanging_line(*LINE, segments - 1, gm_m3_s2=GM)
        miss = np.abs(hanging.tension - fit(hanging.grid.station)).max()
        assert np.isclose(miss, 1.749 / segments**2, rtol=2e-3)


@pytest.mark.parametrize("nodes", [0, 7, None])
def test_forces_balance_at_every_point(nodes):
    """The tension below, the tension above, weight and centrifugal force; from radii alone where there are nodes."""
    hanging = hanging_line(*LINE, nodes, gm_m3_s2=GM)
    grid, r = hanging.grid, hanging.radius
    left = grid.slope.T @ (grid.weight * hanging.tension) - grid.mass * (hanging.rate**2 * r - GM / r**2)
    assert np.abs(left).max() < 2e-9
    if nodes is not None:
        strain = np.diff(r) / (20e3 / (nodes + 1)) - 1.0
        assert np.allclose(3.2e5 * strain, hanging.tension, rtol=0.0, atol=1e-6)  # radii hold 1e-9 m


def test_a_stiff_line_is_the_inextensible_one():
    length, mu, _, lower, upper, top = LINE
    hanging = hanging_line(length, mu, 1e13, lower, upper, top, None, gm_m3_s2=GM)
    rate = inextensible_rate(top - length, top, lower, upper, mu, GM)
    assert np.isclose(hanging.rate, rate, rtol=1e-12)
    # the bodies' weight less centrifugal force is the difference of large numbers: 1e-9 N
    closed = inextensible_tension(hanging.radius, rate, top - length, lower, mu, GM)
    assert np.allclose(hanging.tension, closed, rtol=0.0, atol=1e-6)
    elastic = hanging_line(*LINE, None, gm_m3_s2=GM)
    assert np.isclose(elastic.tension.max() / closed.max() - 1.0, 1.5e-4, rtol=0.05)


def test_a_stretched_length_is_met():
    for nodes in (0, 9, None):
        hanging = hanging_line(*LINE, nodes, length="stretched", gm_m3_s2=GM)
        assert np.isclose(hanging.height[-1], 20e3, rtol=1e-14)
        assert np.isclose(hanging.radius[-1] - hanging.radius[0], 20e3, rtol=1e-12)
        again = hanging_line(float(hanging.grid.place[-1]), *LINE[1:], nodes, gm_m3_s2=GM)
        assert np.allclose(again.tension, hanging.tension, rtol=1e-10)


def test_any_of_three_points_may_be_given():
    upper = hanging_line(*LINE, 5, gm_m3_s2=GM)
    for anchor, radius in (("lower", upper.radius[0]), ("centre", upper.centre_radius)):
        hanging = hanging_line(*LINE[:5], float(radius), 5, anchor=anchor, gm_m3_s2=GM)
        assert np.allclose(hanging.radius, upper.radius, rtol=1e-15)
        assert np.allclose(hanging.tension, upper.tension, rtol=1e-9)


def test_materials_in_series():
    """A chain cut across two materials holds their mass and their compliance."""
    stretches = Stretches(np.array([3.0, 7.0]), np.array([0.2, 0.1]), np.array([10.0, 40.0]))
    strand = cut(stretches, 2)
    assert np.isclose(point_masses(strand).sum(), 3.0 * 0.2 + 7.0 * 0.1)
    assert np.isclose((strand.rest / strand.stiffness).sum(), 0.3 + 7.0 / 40.0)
    assert np.allclose(strand.linear_mass, [0.19, 0.1, 0.1])
    assert np.isclose(10.0 / 3.0 / strand.stiffness[0], 0.3 + (10.0 / 3.0 - 3.0) / 40.0)


def test_two_materials_as_one_when_they_are_the_same():
    one = hanging_line(*LINE, None, gm_m3_s2=GM)
    two = hanging_line([5e3, 15e3], *LINE[1:], None, gm_m3_s2=GM)
    assert np.isclose(one.rate, two.rate, rtol=1e-14)
    assert np.allclose(two.tension[[0, -1]], one.tension[[0, -1]], rtol=1e-10)


def test_numbers_that_cannot_be_are_refused_by_name():
    wrong = {
        "length_m": ((-1.0, *LINE[1:]), "length_m"),
        "text": (("20 km", *LINE[1:]), "length_m"),
        "mass": ((20e3, np.nan, *LINE[2:]), "mass_per_length_kg_m"),
        "stiffness": ((20e3, 8e-3, 0.0, *LINE[3:]), "axial_stiffness_n"),
        "soft": ((20e3, 8e-3, 1.0, *LINE[3:]), "too soft"),
        "body": ((20e3, 8e-3, 3e5, True, *LINE[4:]), "lower_mass_kg"),
        "ground": ((300e3, *LINE[1:]), "reaches the ground"),
        "materials": (([1e3, 2e3], [8e-3, 8e-3, 8e-3], *LINE[2:]), "one a material"),
        "lengths": ((20e3, [8e-3, 8e-3], *LINE[2:]), "one length a material"),
        "none": (([], *LINE[1:]), "one a material"),
        "weightless": ((20e3, 0.0, 3e5, 0.0, 100.0, TOP), "lower_mass_kg"),
    }
    for line, words in wrong.values():
        with pytest.raises(InputError, match=words):
            hanging_line(*line, None)
    with pytest.raises(InputError, match="nodes must be a whole number"):
        hanging_line(*LINE, 2.5)
    with pytest.raises(InputError, match='did you mean "stretched"'):
        hanging_line(*LINE, length="streched")
    with pytest.raises(InputError, match='did you mean "upper"'):
        hang(chain_grid(cut(Stretches(*np.ones((3, 1))), 1), 1.0, 1.0), 7e6, "uper")


def test_the_rate_comes_to_the_continuum_with_the_square_of_the_spacing():
    """4.6e-9 / N^2 of itself, of an independent code; below 1e-12 rounding is not far."""
    continuum = hanging_line(*LINE, None, gm_m3_s2=GM).rate
    for segments in (1, 2, 5, 10, 20):
        hanging = hanging_line(*LINE, segments - 1, gm_m3_s2=GM)
        assert np.isclose((hanging.rate / continuum - 1.0) * segments**2, 4.6e-9, rtol=0.03)


def test_the_first_segment_is_half_an_element_from_the_end():
    """Its tension is that of its middle: against the end's it is off by half a segment's share of the gradient, O(1/N)."""
    continuum = hanging_line(*LINE, None, gm_m3_s2=GM)
    slope = 8.35e-3 * (GM / continuum.radius[0] ** 2 - continuum.rate**2 * continuum.radius[0])
    for segments in (20, 50, 100):
        hanging = hanging_line(*LINE, segments - 1, gm_m3_s2=GM)
        assert np.isclose(hanging.tension[0] - 41.4852, 0.5 * slope * 20e3 / segments, rtol=0.03)
