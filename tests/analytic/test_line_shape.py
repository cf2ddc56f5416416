"""The shape of a line whose motion is known: libration, bow, skiprope and its sense, ends."""

import numpy as np
import pytest

import fieldline as fl
from fieldline.analysis.line_shape import shape_of_line, skiprope_of
from fieldline.errors import InputError
from line_dataset import BOW_M, LENGTH_M, MASSES_KG, SKIPROPE_M, SKIPROPE_RATE, libration, line_dataset


def shape_of(data):
    ends = data["line_position_i_tether"].values[:, [-1, 0]], data["line_velocity_i_tether"].values[:, [-1, 0]]
    centre, moving = (np.average(one, axis=1, weights=MASSES_KG) for one in ends)
    return shape_of_line(data["line_position_i_tether"].values, data["line_velocity_i_tether"].values, centre, moving)


@pytest.fixture(scope="module")
def shape():
    return shape_of(line_dataset())


def test_libration_and_chord(shape):
    theta, phi = libration(10.0 * np.arange(601))
    assert np.allclose(shape.chord_m, LENGTH_M, atol=1e-3)
    assert np.abs(shape.in_plane_rad - theta).max() < 2e-5  # the centre's velocity is of finite differences
    assert np.abs(shape.across_rad - phi).max() < 2e-5


def test_the_bow_is_the_half_wave(shape):
    turning = SKIPROPE_RATE * 10.0 * np.arange(601)
    expected = np.stack([BOW_M + SKIPROPE_M * np.cos(turning), SKIPROPE_M * np.sin(turning)], axis=1)
    assert np.abs(shape.bow_m - expected).max() < 0.05
    assert shape.largest_m.max() == pytest.approx((BOW_M + SKIPROPE_M) * np.sin(np.pi * 5 / 11), rel=1e-3)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_skiprope_has_its_radius_rate_and_sense(sense):
    data = line_dataset(sense=sense)
    found = skiprope_of(shape_of(data), data["seconds"].values)
    middle = slice(40, -40)
    assert found is not None
    assert np.allclose(found.semi_major_m[middle], SKIPROPE_M, rtol=0.03)
    assert np.allclose(found.semi_minor_m[middle], SKIPROPE_M, rtol=0.03)
    assert np.allclose(found.rate_rad_s[middle], SKIPROPE_RATE, rtol=0.03)
    assert np.allclose(found.sense[middle], sense, atol=0.02)
    assert np.allclose(np.gradient(found.phase_rad, 10.0)[middle], sense * SKIPROPE_RATE, rtol=0.06)
    assert np.allclose(found.mean_m[middle], [BOW_M, 0.0], atol=1.0)


def test_a_swing_in_one_plane_has_no_sense():
    right, left = line_dataset(sense=1.0), line_dataset(sense=-1.0)
    flat = right.copy(deep=True)
    for name in ("line_position_i_tether", "line_velocity_i_tether"):
        flat[name] = 0.5 * (right[name] + left[name])
    found = skiprope_of(shape_of(flat), flat["seconds"].values)
    assert found is not None
    middle = slice(40, -40)
    assert np.abs(found.sense[middle]).max() < 0.05
    assert np.allclose(found.semi_major_m[middle], SKIPROPE_M, rtol=0.05)
    assert found.semi_minor_m[middle].max() < 0.05 * SKIPROPE_M


def test_nodes_that_are_not_out_count_for_nothing():
    data = line_dataset(reel=True)
    shape = shape_of(data)
    assert np.isnan(shape.deflection_m[0, 2:-1]).all() and np.isfinite(shape.bow_m).all()
    assert np.isfinite(shape.largest_m).all() and shape.bows


def test_a_straight_line_has_no_skiprope():
    data = line_dataset()
    ends = [0, -1]
    place, rate = (data[name].values[:, ends] for name in ("line_position_i_tether", "line_velocity_i_tether"))
    shape = shape_of_line(place, rate, place[:, 0], rate[:, 0])
    assert not shape.bows and skiprope_of(shape, data["seconds"].values) is None
    assert (shape.bow_m == 0.0).all() and shape.largest_m.max() < 1e-9


def test_the_users_face():
    data = line_dataset(sense=-1.0)
    found = fl.line_shape(data)
    assert found.attrs["line"] == "tether"
    assert found["deflection"].dims == ("time", "point", "lateral")
    assert float(found["skiprope_sense"][300]) == pytest.approx(-1.0, abs=0.02)
    assert fl.line_shape(data, "tether").identical(found)
    with pytest.raises(InputError, match='no line "tether_2"'):
        fl.line_shape(data, "tether_2")
    with pytest.raises(InputError, match="holds no line"):
        fl.line_shape(data.drop_vars([name for name in data if str(name).endswith("_tether")]))
