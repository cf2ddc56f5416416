"""What holds for every cone, field and filter."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from fieldline.estimation.skiprope import (
    FieldGeometry,
    axes_about,
    bandpass,
    bandpass_response,
    corrected_signals,
    field_geometry,
    field_vector,
    read_cone,
    tilt_azimuth,
)

angles = st.floats(-3.1, 3.1)
frequencies = st.floats(0.002, 0.02)
quick = settings(max_examples=25, deadline=None)


@given(st.floats(1e-6, 1e-4), st.floats(-1.5, 1.5), angles)
def test_geometry_and_vector_undo_each_other(size, elevation, azimuth):
    given_one = FieldGeometry(*(np.array([x]) for x in (size, elevation, azimuth)))
    back = field_geometry(field_vector(given_one))
    assert np.allclose(np.ravel(back), np.ravel(given_one), rtol=1e-12, atol=1e-12)
    assert np.allclose(corrected_signals(field_vector(given_one), given_one), 0.0)


@given(st.lists(st.floats(-10, 10), min_size=3, max_size=3).filter(lambda v: np.linalg.norm(v) > 1e-3))
def test_axes_about_a_vector_are_axes(axis):
    dcm = axes_about(axis)
    assert np.allclose(dcm @ dcm.T, np.eye(3), atol=1e-12) and np.linalg.det(dcm) > 0.0
    assert np.allclose(dcm @ np.array(axis), [0.0, 0.0, np.linalg.norm(axis)], atol=1e-9)


@quick
@given(frequencies, st.floats(0.03, 0.9), st.integers(0, 2**31), st.floats(-2, 2), st.floats(-2, 2))
def test_filters_are_linear_and_blind_to_a_constant(frequency_hz, damping, seed, a, b):
    rng = np.random.default_rng(seed)
    seconds = np.cumsum(rng.uniform(0.1, 20.0, 60))
    x, y = rng.standard_normal((2, 60))
    apart = a * bandpass(seconds, x, frequency_hz, damping) + b * bandpass(seconds, y, frequency_hz, damping)
    assert np.allclose(bandpass(seconds, a * x + b * y + 0.7, frequency_hz, damping), apart, atol=1e-12)


@given(frequencies, st.floats(0.03, 0.9), st.floats(0.05, 20.0))
def test_nothing_passes_better_than_what_the_filter_is_tuned_to(frequency_hz, damping, ratio):
    assert abs(bandpass_response(ratio * frequency_hz, frequency_hz, damping)) <= 1.0 + 1e-12
    mirrored = bandpass_response(frequency_hz / ratio, frequency_hz, damping)
    assert np.isclose(bandpass_response(ratio * frequency_hz, frequency_hz, damping), np.conj(mirrored))


@quick
@given(frequencies, st.sampled_from([-1, 1]), st.floats(0.001, 0.05), angles, st.floats(0.2, 1.2), angles, angles)
def test_turning_everything_about_the_axis_turns_the_plane_alone(hz, sense, size, azimuth, elevation, phase, turn):
    seconds = np.linspace(0.0, 8.0 / hz, 900)
    wt = sense * 2.0 * np.pi * hz * seconds + phase

    def read(by):
        geometry = FieldGeometry(*(np.full(900, x) for x in (3e-5, elevation, azimuth + by)))
        tilt = size * np.stack([np.cos(wt + by), np.sin(wt + by), np.zeros(900)], axis=1)
        known = field_vector(geometry)
        return read_cone(seconds, corrected_signals(known - np.cross(tilt, known), geometry), geometry, hz, settle_s=0.0)

    first, second = read(0.0), read(turn)
    assert first.sense == second.sense == sense
    assert np.isclose(first.amplitude_rad, size, rtol=1e-6) and np.isclose(second.amplitude_rad, size, rtol=1e-6)
    assert np.isclose(first.frequency_hz, sense * hz, rtol=1e-5)
    off = tilt_azimuth(second, seconds).azimuth_rad - tilt_azimuth(first, seconds).azimuth_rad - turn
    assert np.allclose(np.cos(off), 1.0, atol=1e-6)
    expected = wt + np.pi  # azimuth of the tilt, from V towards -U
    assert np.allclose(np.cos(tilt_azimuth(first, seconds).azimuth_rad - expected), 1.0, atol=1e-6)
