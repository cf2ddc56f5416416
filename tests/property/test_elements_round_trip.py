"""Any bound orbit's state gives elements that give the state back, at every inclination and eccentricity."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from fieldline.orbit.elements import Elements, elements_from_state, mean_anomaly, state_from_elements, true_anomaly

ANGLES = st.floats(0.0, 2.0 * np.pi) | st.sampled_from([0.0, np.pi / 2, np.pi, 3 * np.pi / 2])
NEAR_NOTHING = st.sampled_from([0.0, 1e-15, 1e-12, 1e-11, 1e-9, 1e-6])
ECCENTRICITIES = st.floats(0.0, 0.95) | NEAR_NOTHING
INCLINATIONS = st.floats(0.0, np.pi) | NEAR_NOTHING | NEAR_NOTHING.map(lambda small: np.pi - small) | st.just(np.pi / 2)


@settings(max_examples=300, deadline=None)
@given(st.floats(6.6e6, 5e7), ECCENTRICITIES, INCLINATIONS, ANGLES, ANGLES, ANGLES)
def test_state_to_elements_to_state(axis, e, inclination, raan, perigee, anomaly):
    position, velocity = state_from_elements(Elements(axis, e, inclination, raan, perigee, anomaly))
    found = elements_from_state(position, velocity)
    again = state_from_elements(found)
    # What is below 1e-11 of eccentricity or inclination is dropped, so that a circle has definite elements.
    assert np.linalg.norm(again[0] - position) < 1e-10 * np.linalg.norm(position)
    assert np.linalg.norm(again[1] - velocity) < 1e-10 * np.linalg.norm(velocity)
    assert 0.0 <= found.inclination_rad <= np.pi
    assert all(0.0 <= angle < 2.0 * np.pi for angle in found[3:])


@settings(max_examples=200, deadline=None)
@given(st.floats(6.6e6, 5e7), st.floats(1e-3, 0.95), st.floats(1e-3, np.pi - 1e-3), ANGLES, ANGLES, ANGLES)
def test_elements_to_state_to_elements(axis, e, inclination, raan, perigee, anomaly):
    given_elements = Elements(axis, e, inclination, raan, perigee, anomaly)
    found = elements_from_state(*state_from_elements(given_elements))
    assert np.allclose(found[:3], given_elements[:3], rtol=1e-9, atol=1e-9)
    turned = np.subtract(found[3:], given_elements[3:])
    assert np.abs(np.exp(1j * turned) - 1.0).max() < 1e-8


@settings(max_examples=200, deadline=None)
@given(st.floats(-50.0, 50.0), st.floats(0.0, 0.999))
def test_kepler_there_and_back(mean, e):
    assert abs(mean_anomaly(true_anomaly(mean, e), e) - mean) < 1e-10
