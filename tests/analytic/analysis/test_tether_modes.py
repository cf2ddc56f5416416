"""Modes of a hanging line: an independent code's numbers, a collocation of the continuum, closed forms, laws."""

import numpy as np
import pytest
from scipy.linalg import eig

import fieldline as fl
from fieldline.analysis.tether import eigenmotions, hanging_line, libration_ratio, rod_frequencies, string_frequency
from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M
from fieldline.errors import InputError

GM = 3.986013e14
TOP = 6598e3
LINE = (20e3, 8.35e-3, 3.2e5, 500.0, 86363.0, TOP - EARTH_EQUATORIAL_RADIUS_M)
# segments, or None for the continuum: out of plane and in plane over the continuum's n, along the line in rad/s
TABLE = {
    2: (
        [2.004419803390053, 9.194811305597767],
        [1.7369839599973507, 9.140239185427161],
        [0.16911034540614533, 0.892921991193249],
    ),
    10: (
        [2.0043914315143456, 10.177576686865335, 19.629332449101693, 28.70591084412286],
        [1.7369531421491158, 10.128301758689162, 19.60382916595244, 28.688477517673117],
        [0.17007918285698542, 0.9996829732378949, 1.9280637449614284],
    ),
    50: (
        [2.0043902818103665, 10.219706589806679, 19.94671282663316, 29.758607808713762],
        [1.7369518920683742, 10.170635791816878, 19.921615859605783, 29.74179153712812],
        [0.17011817111773508, 1.004162701091355, 1.959892258425051],
    ),
    None: (
        [2.0043902338785244, 10.221466170278251, 19.960017769042956, 29.803009497822245],
        [1.7369518399513464, 10.172403861024932, 19.93493755249942, 29.78621829406191],
        [0.17011979602227453, 1.0043497131585106, 1.9612259607098623],
    ),
}


@pytest.mark.parametrize("segments", TABLE, ids=str)
def test_modes_are_those_of_another_code(segments):
    modes = fl.tether_modes(*LINE, None if segments is None else segments - 1, gm_m3_s2=GM)
    across, plane, along = TABLE[segments]
    n = hanging_line(*LINE[:5], TOP, None, gm_m3_s2=GM).rate
    assert np.allclose(modes.out_of_plane_frequency.values[: len(across)] / n, across, rtol=3e-11)
    assert np.allclose(modes.in_plane_frequency.values[: len(plane)] / n, plane, rtol=3e-11)
    assert np.allclose(modes.along_line_frequency.values[: len(along)], along, rtol=3e-11)


def test_the_continuum_by_collocation():
    """The differential equations at Chebyshev's points, the bodies as boundary conditions, solved as a pencil."""
    hanging = hanging_line(*LINE[:5], TOP, None, gm_m3_s2=GM)
    count = 49
    x = np.cos(np.pi * np.arange(count) / (count - 1))
    c = np.where(np.isin(np.arange(count), [0, count - 1]), 2.0, 1.0) * (-1.0) ** np.arange(count)
    d = np.outer(c, 1.0 / c) / (x[:, None] - x[None, :] + np.eye(count))
    np.fill_diagonal(d, 0.0)
    np.fill_diagonal(d, -d.sum(axis=1))
    s, d = 10e3 * (x + 1.0), d / 10e3
    tension = np.polynomial.Polynomial.fit(hanging.grid.place, hanging.tension, 14)(s)
    radius = np.polynomial.Polynomial.fit(hanging.grid.place, hanging.radius, 14)(s)
    n, mu = hanging.rate, 8.35e-3
    fall = GM / radius**3

    def string(pull):
        """Stiffness per mass of points inside and of the bodies at the ends: -(pull u')'/mu, and +-pull u' / m."""
        flux = pull[:, None] * d
        matrix = -(d @ flux) / mu
        matrix[-1] = -flux[-1] / 500.0  # s = 0, the lower body: m u'' = T u'
        matrix[0] = flux[0] / 86363.0
        return matrix

    across = string(tension / (1.0 + tension / 3.2e5)) + np.diag(fall)
    found = np.sqrt(np.sort(np.linalg.eigvals(across).real))
    modes = eigenmotions(hanging, GM)
    assert np.isclose(found[0], n, rtol=1e-9)  # the inclined orbit
    assert np.allclose(found[1:8], modes.out_of_plane.rate[:7], rtol=1e-8)
    track = string(tension / (1.0 + tension / 3.2e5)) + np.diag(fall - n**2)
    up = string(np.full(count, 3.2e5)) - np.diag(2.0 * fall + n**2)
    one, none = np.eye(count), np.zeros((count, count))
    both = np.block(
        [[none, none, one, none], [none, none, none, one], [-track, none, none, -2.0 * n * one], [none, -up, 2.0 * n * one, none]]
    )
    rates = np.sort(np.abs(eig(both, right=False).imag))
    for rate in (*modes.in_plane.rate[:6], *modes.along_line.rate[:4]):
        assert np.abs(rates - rate).min() < 1e-6 * rate


@pytest.mark.parametrize("nodes", [0, 1, 6, 30, None], ids=str)
def test_every_motion_obeys_its_equation_of_motion(nodes):
    """Shape, ellipse and rate put into equations (6) to (8) of the theory, point by point."""
    hanging = hanging_line(*LINE[:5], TOP, nodes, gm_m3_s2=GM)
    grid, n = hanging.grid, hanging.rate
    pull = grid.weight * hanging.tension / (1.0 + hanging.tension / grid.stiffness)
    string, spring = (
        grid.slope.T @ (pull[:, None] * grid.slope),
        grid.slope.T @ ((grid.weight * grid.stiffness)[:, None] * grid.slope),
    )
    m, fall = grid.mass, GM / hanging.radius**3
    families = eigenmotions(hanging, GM)

    def plane(x, r, w):
        """x cos(wt) along the track and r sin(wt) up: what is left of (6) and (7)."""
        left = -(w**2) * m * x + 2.0 * n * m * r * w + string @ x + m * (fall - n**2) * x
        right = -(w**2) * m * r + 2.0 * n * m * x * w + spring @ r - m * (2.0 * fall + n**2) * r
        return left, right

    for w, shape in zip(families.out_of_plane.rate[:10], families.out_of_plane.shape, strict=False):
        left = string @ shape + m * fall * shape - w**2 * m * shape
        assert np.abs(left).max() < 1e-8 * np.abs(w**2 * m * shape).max()
    for w, x, r in zip(families.in_plane.rate[:10], families.in_plane.shape, families.in_plane.beside, strict=False):
        left, right = plane(x, r, w)
        assert np.abs(left).max() < 1e-8 * np.abs(w**2 * m * x).max()
        assert np.abs(right).max() < 1e-8 * np.abs(spring @ np.abs(r)).max() + 1e-10 * np.abs(w**2 * m * x).max()
    for w, r, x in zip(families.along_line.rate[:10], families.along_line.shape, families.along_line.beside, strict=False):
        left, right = plane(-x, r, w)  # up as cos, along the track as sin: a quarter of a turn later
        assert np.abs(right).max() < 1e-7 * np.abs(w**2 * m * r).max()
        assert np.abs(left).max() < 1e-7 * np.abs(w**2 * m * r).max()


def test_a_short_massless_line_swings_at_root_three_and_two():
    modes = fl.tether_modes(10.0, 0.0, 1e4, 20.0, 30.0, 500e3)
    assert np.isclose(modes.in_plane_ratio.values[0], np.sqrt(3.0), rtol=2e-5)
    assert np.isclose(modes.out_of_plane_ratio.values[0], 2.0, rtol=2e-5)
    spring = np.sqrt(1e4 / 10.0 * (1.0 / 20.0 + 1.0 / 30.0))
    assert np.isclose(modes.along_line_frequency.values[0], spring, rtol=1e-6)
    assert [modes.sizes[f"{name}_mode"] for name in ("in_plane", "out_of_plane", "along_line")] == [1, 1, 1]


def test_the_correction_for_length_is_what_the_reference_says():
    modes = fl.tether_modes(*LINE, gm_m3_s2=GM)
    assert np.isclose(modes.in_plane_ratio.values[0] / np.sqrt(3.0) - 1.0, 2.8e-3, rtol=0.02)
    assert np.isclose(modes.out_of_plane_ratio.values[0] / 2.0 - 1.0, 2.2e-3, rtol=0.02)


def test_lateral_squares_differ_by_that_of_the_orbit():
    modes = fl.tether_modes(*LINE, gm_m3_s2=GM)
    squares = modes.out_of_plane_ratio.values[1:8] ** 2 - modes.in_plane_ratio.values[1:8] ** 2
    assert np.allclose(squares, 1.002, atol=2e-3)


def test_along_the_line_it_is_a_rod():
    modes = fl.tether_modes(*LINE, gm_m3_s2=GM)
    rod = rod_frequencies(20e3, 8.35e-3, 3.2e5, 500.0, 86363.0, 10)
    assert np.isclose(modes.along_line_frequency.values[0], rod[0], rtol=3e-5)
    assert np.allclose(modes.along_line_frequency.values[1:10], rod[1:], rtol=1e-6)
    free = rod_frequencies(2.0, 3.0, 27.0, 0.0, 0.0, 3)
    assert np.allclose(free, np.pi * np.arange(1, 4) * 1.5, rtol=1e-12)
    spring = rod_frequencies(2.0, 1e-6, 27.0, 4.0, 5.0, 1)
    assert np.isclose(spring[0], np.sqrt(27.0 / 2.0 * (1.0 / 4.0 + 1.0 / 5.0)), rtol=1e-6)


def test_between_heavy_bodies_it_is_the_string_of_slowly_varying_tension():
    modes = fl.tether_modes(20e3, 8.35e-3, 3.2e5, 1e5, 1e7, 220e3, gm_m3_s2=GM)
    tension, rest = modes.tension.values, modes.station_rest_height.values
    for k in (1, 3, 9):
        string = string_frequency(rest, tension, 8.35e-3, 3.2e5, k)
        assert np.isclose(modes.out_of_plane_frequency.values[k], string, rtol=5e-4)
    light = fl.tether_modes(*LINE, gm_m3_s2=GM)
    string = string_frequency(light.station_rest_height.values, light.tension.values, 8.35e-3, 3.2e5, 1)
    assert np.isclose(string / float(light.orbital_rate), 9.8976, rtol=1e-4)


@pytest.mark.parametrize("ends", [(0.0, 86363.0), (500.0, 0.0), (1e-3, 1e12), (1e7, 86363.0)], ids=str)
def test_any_bodies_at_the_ends(ends):
    """Nodes come to the continuum; half waves are counted by changes of sign."""
    line = (20e3, 8.35e-3, 3.2e5, *ends, 220e3)
    whole, nodes = fl.tether_modes(*line), fl.tether_modes(*line, 30)
    for name in ("in_plane_frequency", "out_of_plane_frequency", "along_line_frequency"):
        assert np.allclose(nodes[name].values[:4], whole[name].values[:4], rtol=4e-2)
    for k, shape in enumerate(whole.out_of_plane_shape.values[:8]):
        assert (np.diff(np.sign(shape)) != 0).sum() == k + 1


def test_a_free_end_is_a_string_whose_tension_goes_to_zero():
    """From a fixed point in a tide T = 3 n^2 mu (L^2 - s^2) / 2: Legendre, odd degrees k, w^2 = n^2 (3 k (k + 1) / 2 + 1)."""
    modes = fl.tether_modes(1e3, 1e-3, 1e6, 0.0, 1e9, 1000e3)
    for mode, degree in enumerate((1, 3, 5, 7)):
        assert np.isclose(modes.out_of_plane_ratio.values[mode] ** 2, 1.5 * degree * (degree + 1) + 1.0, rtol=1e-3)


def test_two_materials():
    line = ([12e3, 8e3], [8.35e-3, 4e-3], [3.2e5, 1e5], *LINE[3:])
    whole, nodes = fl.tether_modes(*line), fl.tether_modes(*line, 49)
    assert np.allclose(nodes.out_of_plane_frequency.values[:4], whole.out_of_plane_frequency.values[:4], rtol=4e-3)
    assert np.allclose(nodes.along_line_frequency.values[:4], whole.along_line_frequency.values[:4], rtol=4e-3)
    assert not np.isclose(whole.along_line_frequency.values[0], fl.tether_modes(*LINE).along_line_frequency.values[0], rtol=0.1)


def test_shapes_are_one_where_they_are_largest():
    modes = fl.tether_modes(*LINE, 12)
    for name in ("in_plane_shape", "out_of_plane_shape", "along_line_shape"):
        shapes = modes[name].values
        assert np.allclose(shapes.max(axis=1), 1.0) and np.all(shapes.min(axis=1) >= -1.0)
    assert list(modes.along_line_mode.values[:2]) == [1, 2] and list(modes.in_plane_mode.values[:2]) == [0, 1]
    assert modes.in_plane_frequency.attrs["units"] == "rad s-1"


def test_libration_slows_with_its_amplitude():
    told = (1.73192, 1.71887, 1.61394, 1.26162)
    assert np.allclose(libration_ratio(np.radians([1.0, 10.0, 30.0, 60.0])), told, atol=5e-6)


def test_what_has_no_modes_is_refused():
    with pytest.raises(InputError, match="upper_altitude_m"):
        fl.tether_modes(*LINE[:5], -5.0)
    for gm in (-1.0, 3.986e5, float("nan")):
        with pytest.raises(InputError, match="gm_m3_s2"):
            fl.tether_modes(*LINE, gm_m3_s2=gm)
    with pytest.raises(InputError, match="length_m must be 1 m or more"):
        fl.tether_modes(1e-3, *LINE[1:])
    with pytest.raises(InputError, match="500"):
        fl.tether_modes(*LINE, 501)
    with pytest.raises(InputError, match="above zero for every material"):
        fl.tether_modes([1e3, 1e3], [1e-3, 0.0], 1e5, 10.0, 10.0, 500e3)


def test_twenty_segments_are_as_far_from_the_continuum_as_told():
    """First lateral modes -1.1e-3 of themselves, the first along the line -4e-5, librations below 1e-6."""
    line, whole = fl.tether_modes(*LINE, 19, gm_m3_s2=GM), fl.tether_modes(*LINE, gm_m3_s2=GM)
    away = {
        name: line[name].values[:2] / whole[name].values[:2] - 1.0 for name in ("in_plane_frequency", "out_of_plane_frequency")
    }
    for both in away.values():
        assert abs(both[0]) < 1e-6 and np.isclose(both[1], -1.1e-3, atol=5e-5)
    stretch = line["along_line_frequency"].values[0] / whole["along_line_frequency"].values[0] - 1.0
    assert np.isclose(stretch, -6e-5, atol=1e-5)  # told -4e-5; -2.4e-4 of ten segments, -9.6e-6 of fifty, are 1/N^2 too
