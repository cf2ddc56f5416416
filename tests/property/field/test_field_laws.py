"""Laws that hold for every registered model of the field, at all places and times; a new model is tested by existing."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fieldline.environment import MAGNETIC_FIELDS, field_gradient, field_model, field_rate, magnetic_field
from fieldline.environment.field_registry import FOREVER

pytestmark = pytest.mark.kernels

# What the models that need options are tried with: the Earth's dipole, and six that together resemble the Earth.
OPTIONS = {
    "centred-dipole": {"moment_e": (-0.4e22, 1.2e22, -7.6e22)},
    "displaced-dipoles": {
        "position_e": np.array([[0, 0, 0], [1, 1, 1], [-2, 1, 0], [0, -2, 1], [1, 0, -2], [-1, -1, 2]]) * 5e5,
        "moment_e": np.array([[0, 1, -6], [0, 0, -1], [1, 0, 0], [-1, 0, -0.5], [0, 0.3, 0.2], [0.1, 0.1, -0.2]]) * 1e22,
    },
}
MODELS = [field_model(name, **OPTIONS.get(name, {})) for name in MAGNETIC_FIELDS]
every_model = pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
STEP_M = 100.0  # differences err by (degree STEP / r)^2 / 6, under 1e-8, and by rounding 1e-16 r / STEP, under 1e-11
OF_DIFFERENCES = 1e-7
OF_ROUNDING = 1e-12

components = st.floats(-1.0, 1.0, allow_subnormal=False)
special = st.sampled_from([(0, 0, 1), (0, 0, -1), (1, 0, 0), (0, -1, 0), (1e-9, 0, -1), (-1e-200, 0, 1)])
directions = st.one_of(st.tuples(components, components, components), special).filter(lambda v: np.linalg.norm(v) > 1e-3)


@st.composite
def places(draw):
    """Positions from the surface to geosynchronous height, poles among them."""
    direction = np.array(draw(directions), dtype=float)
    return draw(st.floats(6.378e6, 4.3e7)) * direction / np.linalg.norm(direction)


def times_of(model, margin_years=0.0):
    """Times inside a model's years; a model that does not know time is tried over IGRF's."""
    first, last = (1900.0, 2030.0) if model.years == FOREVER else model.years
    return st.floats(first + margin_years, last - margin_years).map(
        lambda year: np.datetime64("1970-01-01", "ns") + np.timedelta64(int((year - 1970.0) * 365.2424 * 86400), "s")
    )


def differences(model, place, time):
    """Gradient by central differences of the field, [i, j] = dB_i / dx_j."""
    steps = STEP_M * np.eye(3)
    ahead, behind = magnetic_field(place + steps, time, model), magnetic_field(place - steps, time, model)
    return ((ahead - behind) / (2.0 * STEP_M)).T


@every_model
@settings(max_examples=60, deadline=None)
@given(data=st.data(), place=places())
def test_no_divergence_no_curl_and_the_gradient_is_the_difference(model, data, place):
    time = data.draw(times_of(model, 0.1))
    by_difference = differences(model, place, time)
    scale = np.linalg.norm(magnetic_field(place, time, model)) / np.linalg.norm(place)
    assert abs(np.trace(by_difference)) < OF_DIFFERENCES * scale
    assert np.abs(by_difference - by_difference.T).max() < OF_DIFFERENCES * scale
    gradient = field_gradient(place, time, model)
    assert np.abs(gradient - by_difference).max() < OF_DIFFERENCES * scale
    assert np.array_equal(gradient, gradient.T)
    assert abs(np.trace(gradient)) < OF_ROUNDING * scale


@every_model
@settings(max_examples=60, deadline=None)
@given(data=st.data(), place=places())
def test_the_rate_is_the_difference_within_a_year(model, data, place):
    first, last = (1900, 2030) if model.years == FOREVER else map(int, model.years)
    start = np.datetime64(str(data.draw(st.integers(first, last - 1))), "ns")
    days = data.draw(st.integers(0, 300))
    time = start + np.timedelta64(days, "D")
    span_s = 60 * 86400.0
    ahead, here = magnetic_field(place, [time + np.timedelta64(60, "D"), time], model)
    rounding = 1e-15 * np.linalg.norm(here) / span_s
    rate = field_rate(place, time, model)
    assert np.abs((ahead - here) / span_s - rate).max() < 1e-9 * np.linalg.norm(rate) + 4.0 * rounding


@every_model
@settings(max_examples=40, deadline=None)
@given(data=st.data(), place=places())
def test_the_field_of_nearby_times_and_places_is_near(model, data, place):
    time = data.draw(times_of(model, 0.1))
    nudge = np.array(data.draw(directions)) * 1e-3
    here, there = magnetic_field([place, place + nudge], time, model)
    steepest = 20.0 * np.linalg.norm(here) / np.linalg.norm(place)  # degree 13 at the surface has 15 B / r at most
    assert np.abs(there - here).max() < steepest * np.linalg.norm(nudge) + 1e-15 * np.linalg.norm(here)


@every_model
@settings(max_examples=30, deadline=None)
@given(data=st.data(), direction=directions)
def test_far_away_only_the_dipole_is_left(model, data, direction):
    time = data.draw(times_of(model, 0.1))
    up = np.array(direction, dtype=float) / np.linalg.norm(direction)
    near, far = magnetic_field([0.9e9 * up, 1.8e9 * up], time, model)
    a_hundredth = 0.01  # the quadrupole is a tenth of the dipole at the surface, a / r times less here
    assert np.linalg.norm(8.0 * far - near) < a_hundredth * np.linalg.norm(near)


@settings(max_examples=60, deadline=None)
@given(place=places(), axis=directions, angle=st.floats(-np.pi, np.pi))
def test_a_dipole_turns_with_its_moment(place, axis, angle):
    from scipy.spatial.transform import Rotation

    turn = Rotation.from_rotvec(angle * np.array(axis, dtype=float) / np.linalg.norm(axis)).as_matrix()
    moment, time = np.array([1e22, 2e22, -7e22]), np.datetime64("2024-01-01")
    straight = magnetic_field(place, time, field_model("centred-dipole", moment_e=moment))
    turned = magnetic_field(turn @ place, time, field_model("centred-dipole", moment_e=turn @ moment))
    assert np.abs(turned - turn @ straight).max() < 1e-13 * np.linalg.norm(straight)


@settings(max_examples=40, deadline=None)
@given(place=places(), degree=st.integers(1, 13), data=st.data())
def test_every_degree_and_order_obeys_laplace(place, degree, data):
    model = field_model("IGRF-14", degree=degree, order=data.draw(st.integers(0, degree)))
    time = np.datetime64("2021-05-05")
    scale = np.linalg.norm(magnetic_field(place, time, model)) / np.linalg.norm(place)
    assert np.abs(field_gradient(place, time, model) - differences(model, place, time)).max() < OF_DIFFERENCES * scale


@settings(max_examples=60, deadline=None)
@given(place=places(), first=times_of(MODELS[0]), second=times_of(MODELS[0]))
def test_a_series_is_its_samples(place, first, second):
    both = magnetic_field(place, np.array([first, second]))
    assert np.array_equal(both, [magnetic_field(place, first), magnetic_field(place, second)])


def test_every_registered_model_is_tried():
    assert [model.name for model in MODELS] == list(MAGNETIC_FIELDS)
    assert set(OPTIONS) <= set(MAGNETIC_FIELDS)
