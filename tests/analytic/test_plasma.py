"""The ionosphere's electrons: Chapman's layer, day and night, tables."""

import numpy as np
import pytest

from fieldline.environment.plasma import chapman, daylight, electron_density, plasma_model
from fieldline.errors import InputError
from fieldline.frames.earth_rotation import itrs_from_geodetic

pytestmark = pytest.mark.kernels

NOON, NIGHT = (1.5e11, 0.0, 0.0), (-1.5e11, 0.0, 0.0)


def above(*heights_m):
    """Places over the equator, under the Sun of `NOON`."""
    return np.array([itrs_from_geodetic(0.0, 0.0, height) for height in heights_m])


def test_the_layer_peaks_where_it_should_and_falls_with_twice_its_scale():
    assert chapman(300e3, 1e12, 300e3, 50e3, 100e3) == pytest.approx(1e12, rel=1e-14)
    heights = np.linspace(150e3, 900e3, 751)
    values = np.array([chapman(height, 1e12, 300e3, 50e3, 100e3) for height in heights])
    assert heights[np.argmax(values)] == 300e3 and np.all(values > 0.0)
    slope = np.log(chapman(2000e3, 1.0, 300e3, 50e3, 100e3) / chapman(1900e3, 1.0, 300e3, 50e3, 100e3))
    assert slope == pytest.approx(-0.5, rel=1e-6)  # exp(-z/2) far above
    assert chapman(0.0, 1e12, 300e3, 1e3, 100e3) == 0.0
    step = 1.0  # curvature at the peak: -1/(2 H^2) of the logarithm, on either side
    for side, scale in ((-1.0, 50e3), (1.0, 100e3)):
        fall = np.log(chapman(300e3 + side * 1000.0 * step, 1.0, 300e3, 50e3, 100e3))
        assert fall == pytest.approx(-((1000.0 / scale) ** 2) / 4.0, rel=2e-2)


def test_day_and_night():
    assert daylight(1.0) == pytest.approx(1.0, abs=1e-3) and daylight(-1.0) == pytest.approx(0.0, abs=1e-3)
    assert daylight(0.0) == 0.5
    model = plasma_model("chapman")
    day = electron_density(above(300e3, 350e3), NOON, model)
    night = electron_density(above(300e3, 350e3), NIGHT, model)
    assert day[0] == pytest.approx(1e12, rel=2e-3) and night[1] == pytest.approx(1e11, rel=2e-3)
    assert np.all(day > 5.0 * night)
    dusk = electron_density(above(320e3), (0.0, 1.0, 0.0), model)
    assert night.min() < dusk[0] < day.max()


def test_constant_none_and_table():
    place = above(100e3, 300e3, 400e3, 2000e3)
    assert electron_density(place, NOON, plasma_model("constant", density_m3=3e11)) == pytest.approx(3e11)
    assert not electron_density(place, NOON, plasma_model("none")).any()
    table = plasma_model("table", heights_m=[300e3, 500e3, 600e3], day_m3=[1e12, 1e11, 1e10], night_m3=[1e11, 1e10, 1e9])
    assert electron_density(place, NOON, table) == pytest.approx([1e12, 1e12, 10.0**11.5, 1e10], rel=3e-3)
    assert electron_density(place, NIGHT, table) == pytest.approx([1e11, 1e11, 10.0**10.5, 1e9], rel=3e-3)
    alike = plasma_model("table", heights_m=[300e3, 500e3], day_m3=[1e12, 1e11])
    assert electron_density(place, NIGHT, alike) == pytest.approx(electron_density(place, NOON, alike), rel=1e-12)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"name": "chapmann"}, 'did you mean "chapman"'),
        ({"name": "constant"}, "density_m3"),
        ({"name": "chapman", "scale_above_m": 0.0}, "scale_above_m"),
        ({"name": "table", "heights_m": [3e5], "day_m3": [1e12]}, "two heights"),
        ({"name": "table", "heights_m": [4e5, 3e5], "day_m3": [1e12, 1e11]}, "must rise"),
        ({"name": "table", "heights_m": [3e5, 4e5], "day_m3": [1e12, 0.0]}, "must be positive"),
    ],
)
def test_refusals(keys, words):
    with pytest.raises(InputError, match=words):
        plasma_model(keys.pop("name"), **keys)
