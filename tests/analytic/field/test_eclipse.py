"""The Earth's shadow against plane geometry and against the Sun's disc cut into rays."""

import numpy as np
import pytest

from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M as EARTH
from fieldline.constants import SUN_RADIUS_M
from fieldline.environment import eclipse, sun_position_i
from fieldline.environment.eclipse import sunlit_kernel
from fieldline.errors import InputError

NOW = np.datetime64("2023-08-24T15:00")
SUN = sun_position_i(NOW)
DISTANCE = np.linalg.norm(SUN)
S = SUN / DISTANCE
ASIDE = np.cross(S, (0.0, 0.0, 1.0)) / np.linalg.norm(np.cross(S, (0.0, 0.0, 1.0)))
OF_FLAT_DISCS = 0.0014  # the limb's curvature and the Sun's disc seen as plane circles; stated in the module


def behind(radius, angle):
    """Places at `radius`, turned by `angle` from the point opposite to the Sun."""
    angle = np.asarray(angle)[..., None]
    return radius * (-np.cos(angle) * S + np.sin(angle) * ASIDE)


def sunlit_by_rays(place, across=300):
    """Fraction of the Sun's disc from which a straight ray reaches the place past the Earth's sphere."""
    to_sun = SUN - place
    distance = np.linalg.norm(to_sun)
    z = to_sun / distance
    x = np.cross(z, (0.3, -0.5, 0.7))
    x /= np.linalg.norm(x)
    grid = (2.0 * np.arange(across) + 1.0) / across - 1.0
    u, v = (part[np.hypot(*np.meshgrid(grid, grid)) < 1.0] for part in np.meshgrid(grid, grid))
    polar, azimuth = np.hypot(u, v) * np.arcsin(SUN_RADIUS_M / distance), np.arctan2(v, u)
    ray = np.outer(np.cos(polar), z) + np.sin(polar)[:, None] * (
        np.outer(np.cos(azimuth), x) + np.outer(np.sin(azimuth), np.cross(z, x))
    )
    along = ray @ place
    hit = (along < 0.0) & (along**2 > place @ place - EARTH**2)
    return 1.0 - hit.mean()


@pytest.mark.kernels
def test_the_kernel_is_the_function_and_the_lens_formula():
    rng = np.random.default_rng(8)
    places = behind(rng.uniform(6.5e6, 4.3e7, 400)[:, None], rng.uniform(-np.pi, np.pi, 400))
    places[::2] = behind(6.9e6, np.arcsin(EARTH / 6.9e6) + rng.uniform(-0.006, 0.006, 200))  # half of them in penumbra
    alone = [sunlit_kernel(tuple(place), tuple(SUN)) for place in places]
    assert (eclipse(places, NOW) == alone).all()
    assert 50 < np.count_nonzero((np.array(alone) > 0.0) & (np.array(alone) < 1.0))
    for place, sunlit in zip(places, alone, strict=True):
        a = np.arcsin(SUN_RADIUS_M / np.linalg.norm(SUN - place))
        b = np.arcsin(EARTH / np.linalg.norm(place))
        c = np.arccos((SUN - place) @ -place / np.linalg.norm(SUN - place) / np.linalg.norm(place))
        if abs(a - b) < c < a + b:
            x, y = np.arccos((c * c + a * a - b * b) / (2 * c * a)), np.arccos((c * c + b * b - a * a) / (2 * c * b))
            covered = a * a * (x - np.sin(2 * x) / 2) + b * b * (y - np.sin(2 * y) / 2)
            assert sunlit == pytest.approx(1.0 - covered / (np.pi * a * a), abs=1e-5)
        else:
            assert sunlit in (0.0, 1.0)


def test_cylinder_is_dark_for_the_closed_form_part_of_an_orbit():
    radius = 6.9e6
    angle = np.linspace(-np.pi, np.pi, 100001)
    dark = eclipse(behind(radius, angle), NOW, "cylinder") == 0.0
    assert abs(dark.mean() - 2.0 * np.arcsin(EARTH / radius) / (2.0 * np.pi)) < 2.0 / 100000


def test_cone_begins_and_ends_at_the_common_tangents():
    # Seen from the place, with the Sun far away: c = b -+ a, at the angle asin(R/r) from the shadow's axis, up to a.
    for radius in (6.5e6, 6.9e6, 4.2e7):
        edge = np.arcsin(EARTH / radius)
        sun_angle = np.arcsin(SUN_RADIUS_M / DISTANCE)
        sun_parallax = radius / DISTANCE
        slack = sun_parallax + 1e-6
        assert eclipse(behind(radius, edge + sun_angle + slack), NOW) == 1.0
        assert eclipse(behind(radius, edge - sun_angle - slack), NOW) == 0.0
        inside = eclipse(behind(radius, edge + np.linspace(-0.99, 0.99, 50) * (sun_angle - slack)), NOW)
        assert (np.diff(inside) > 0.0).all()
        assert 0.0 < inside[0] < 0.02 and 0.98 < inside[-1] < 1.0


@pytest.mark.parametrize("radius", [6.4e6, 6.9e6, 8e6, 4.2e7, 3.8e8])
def test_penumbra_against_rays(radius):
    edge = np.arcsin(EARTH / radius)
    for shift in (-0.8, -0.3, 0.0, 0.45, 0.9):
        place = behind(radius, edge + shift * SUN_RADIUS_M / DISTANCE)
        of_the_grid = 0.002
        assert abs(eclipse(place, NOW) - sunlit_by_rays(place)) < OF_FLAT_DISCS + of_the_grid


def test_past_the_tip_of_the_umbra_the_sun_is_a_ring():
    tip = DISTANCE * EARTH / (SUN_RADIUS_M - EARTH)
    assert eclipse(behind(0.99 * tip, 0.0), NOW) == 0.0
    far = 1.4 * tip
    ring = 1.0 - (np.arcsin(EARTH / far) / np.arcsin(SUN_RADIUS_M / (DISTANCE + far))) ** 2
    assert np.isclose(eclipse(behind(far, 0.0), NOW), ring, rtol=1e-9)


def test_sunward_is_bright_and_both_shapes_agree_outside_the_penumbra():
    random = np.random.default_rng(2)
    place = random.normal(size=(2000, 3))
    place *= 7e6 / np.linalg.norm(place, axis=1, keepdims=True)
    cone, cylinder = eclipse(place, NOW), eclipse(place, NOW, "cylinder")
    assert (cone[place @ S > 0.0] == 1.0).all()
    whole = (cone == 0.0) | (cone == 1.0)
    assert whole.mean() > 0.98
    assert np.array_equal(cone[whole], cylinder[whole])
    assert cone.min() == 0.0 and cone.max() == 1.0


def test_shapes():
    place, times = np.tile(7e6 * S, (4, 1)), NOW + np.arange(4) * np.timedelta64(1, "m")
    assert eclipse(place, times).shape == (4,)
    assert eclipse(place[0], times).shape == (4,)
    assert eclipse(place, NOW).shape == (4,)
    assert eclipse(place[0], NOW).shape == ()
    assert eclipse(place.reshape(2, 2, 3), times.reshape(2, 2), "cylinder").shape == (2, 2)


@pytest.mark.parametrize(
    ("position", "time", "shape", "words"),
    [
        (7e6 * S, NOW, "cones", 'did you mean "cone"'),
        (7e3 * S, NOW, "cone", "position_i_m .*kilometres"),
        (np.tile(7e6 * S, (4, 1)), NOW + np.arange(3), "cone", "one time for all"),
        (7e6 * S, np.datetime64("2150-01-01"), "cone", "covers 1900 to 2100"),
    ],
)
def test_errors(position, time, shape, words):
    with pytest.raises(InputError, match=words):
        eclipse(position, time, shape)
