"""Angles and spectra that the report shows, in closed form."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.frames.attitude import quaternion_from_dcm
from fieldline.report.geometry import body_axes_from_nadir_deg, orbital_axes_i, roll_pitch_yaw_deg, terminator_latitude_deg
from fieldline.report.spectra import autocorrelation, gridded, smoothed, spectrum

POSITION = np.array([[7e6, 0.0, 0.0]])
VELOCITY = np.array([[0.0, 7.5e3, 0.0]])
ROUNDING = 1e-9


def test_orbital_axes_of_an_equatorial_orbit():
    assert orbital_axes_i(POSITION, VELOCITY)[0] == pytest.approx(np.array([[0, 1, 0], [0, 0, -1], [-1, 0, 0]]), abs=ROUNDING)


@pytest.mark.parametrize("roll, pitch, yaw", [(0, 0, 0), (10, 0, 0), (0, -20, 0), (0, 0, 130), (25, -35, -100)])
def test_roll_pitch_yaw_are_those_of_the_turns(roll, pitch, yaw):
    # SciPy's matrix is the transpose of ours: intrinsic z, y, x turns of the axes.
    dcm_bo = Rotation.from_euler("ZYX", [yaw, pitch, roll], degrees=True).as_matrix().T
    q_bi = quaternion_from_dcm(dcm_bo @ orbital_axes_i(POSITION, VELOCITY))
    assert roll_pitch_yaw_deg(q_bi, POSITION, VELOCITY)[0] == pytest.approx([roll, pitch, yaw], abs=1e-6)


def test_body_axes_from_nadir_of_a_body_on_the_orbital_axes():
    q_bi = quaternion_from_dcm(orbital_axes_i(POSITION, VELOCITY))
    assert body_axes_from_nadir_deg(q_bi, POSITION)[0] == pytest.approx([90.0, 90.0, 0.0], abs=1e-6)


@pytest.mark.parametrize("sun_latitude", [-23.4, -1.0, 10.0, 23.4])
def test_the_edge_of_night_is_a_right_angle_from_the_sun(sun_latitude):
    def unit(longitude, latitude):
        a, b = np.radians(longitude), np.radians(latitude)
        return np.stack([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b) + 0 * a], axis=-1)

    longitude = np.linspace(-180, 180, 37)
    edge = unit(longitude, terminator_latitude_deg(longitude, 40.0, sun_latitude))
    assert edge @ unit(np.array(40.0), sun_latitude) == pytest.approx(np.zeros(37), abs=ROUNDING)


def test_white_noise_has_spectrum_one_and_no_memory():
    noise = np.random.default_rng(1).normal(size=(20_000, 3))
    _, power = smoothed(*spectrum(noise, 1.0))
    assert power.mean() == pytest.approx(1.0, abs=0.05)
    outside = np.abs(autocorrelation(noise, 200)) > 2 / np.sqrt(len(noise))
    assert outside.mean() == pytest.approx(0.046, abs=0.02)


def test_a_sine_peaks_at_its_frequency():
    seconds = np.arange(0.0, 40_000.0, 10.0)
    frequency, power = spectrum(np.sin(2 * np.pi * 0.012 * seconds)[:, None], 10.0)
    assert frequency[np.argmax(power[:, 0])] == pytest.approx(0.012, abs=2e-4)


def test_missing_samples_are_zero_on_the_grid():
    grid = gridded(np.array([0.0, 1.0, 4.0]), np.array([[1.0], [3.0], [2.0]]), 1.0)
    assert grid[:, 0] == pytest.approx([-1.0, 1.0, 0.0, 0.0, 0.0])


def test_a_long_silence_does_not_make_a_huge_grid():
    assert len(gridded(np.array([0.0, 1.0, 1e9]), np.zeros((3, 1)), 1.0)) == 3
