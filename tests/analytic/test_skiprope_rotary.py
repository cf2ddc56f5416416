"""Is there a cone: lines of known amplitude and sense, the threshold, false alarms, and what stays unsaid."""

import numpy as np
import pytest

from fieldline.cases.tp3123 import random_scenario
from fieldline.errors import InputError, NoEstimateError
from fieldline.estimation.skiprope import FieldGeometry, detect, field_vector, skiprope_signals
from fieldline.estimation.skiprope.rotary import chi2_levels

HZ = 0.005
SECONDS = np.arange(4000.0)


def geometry(seconds):
    """A field that turns as along an orbit."""
    turn = 2.0 * np.pi * seconds / 5400.0
    return FieldGeometry(3e-5 + 0.0 * seconds, 0.6 * np.sin(turn), 0.4 * np.sin(turn + 1.0))


def signals(cones, seconds=SECONDS, noise_tesla=2e-8, seed=0):
    """Of small cones (frequency [Hz] signed, amplitudes (a1, a2) [deg]) with white noise."""
    known = field_vector(geometry(seconds))
    tilt = np.zeros((len(seconds), 3))
    for hz, (first, second) in cones:
        wt = 2.0 * np.pi * hz * seconds + 0.3
        tilt[:, :2] += np.radians(np.stack([first * np.cos(wt), second * np.sin(wt)], axis=1))
    noise = noise_tesla * np.random.default_rng(seed).standard_normal(known.shape)
    return skiprope_signals(seconds, known - np.cross(tilt, known) + noise, known)


@pytest.mark.parametrize("hz", [HZ, -HZ])
@pytest.mark.parametrize("axes", [(0.4, 0.4), (0.6, 0.2)])
def test_a_line_has_its_amplitude_frequency_and_sense(hz, axes):
    found = detect(signals([(hz, axes)])).cone
    assert found.frequency_hz == pytest.approx(HZ, rel=3e-3)
    assert np.degrees(found.amplitude_rad) == pytest.approx(np.mean(axes), rel=0.08)
    plus, minus = np.mean(axes), 0.5 * (axes[0] - axes[1])
    assert found.turning == pytest.approx(np.sign(hz) * (plus**2 - minus**2) / (plus**2 + minus**2), abs=0.15)


def test_the_pendulous_line_is_told_apart():
    """Ten times the cone's amplitude, in a plane or turning: above the band it is another motion."""
    for swing in ((2.0, 0.0), (2.0, 2.0)):
        found = detect(signals([(HZ, (0.2, 0.2)), (0.03125, swing)]))
        assert found.cone.frequency_hz == pytest.approx(HZ, rel=5e-3)
        assert max(found.others, key=lambda line: line.amplitude_rad).frequency_hz == pytest.approx(0.03125, rel=1e-3)


def test_the_slowest_line_that_turns_is_taken():
    found = detect(signals([(HZ, (0.2, 0.2)), (0.012, (0.5, 0.5))]))
    assert found.cone.frequency_hz == pytest.approx(HZ, rel=5e-3)
    assert any(line.frequency_hz == pytest.approx(0.012, rel=5e-3) for line in found.others)


def test_noise_alone_is_no_cone_and_the_threshold_is_what_is_found():
    """Twenty-five records of noise: at most one alarm at 1 %; a cone of 1.5 times the threshold is found in all of six."""
    alarms = sum(detect(signals([], seed=seed)).cone is not None for seed in range(25))
    assert alarms <= 1
    quiet = detect(signals([]))
    k = np.abs(quiet.frequency_hz - HZ).argmin()
    size = 1.5 * np.degrees(quiet.threshold_rad[k])
    for seed in range(6):
        cone = detect(signals([(HZ, (size, size))], seed=seed)).cone
        assert cone is not None and cone.frequency_hz == pytest.approx(HZ, rel=0.02)


def test_a_wrong_field_is_no_cone():
    """Flights without a skiprope, with the pendulum and the field known wrongly, long and short."""
    alarms = sum(
        detect(random_scenario(seed, skiprope=False, duration_s=duration).signals).cone is not None
        for duration in (1000.0, 3000.0)
        for seed in range(8)
    )
    assert alarms <= 1


def test_levels_of_chi_squared():
    """Of two and four freedoms in closed form: the median of 2 is 2 ln 2."""
    median, threshold = chi2_levels(2, 0.01, 1.0)
    assert median == pytest.approx(2.0 * np.log(2.0)) and threshold == pytest.approx(1.2 * 2.0 * np.log(100.0))
    median, threshold = chi2_levels(4, 0.01, 50.0)
    x = threshold / 1.2
    assert 1.0 - (1.0 - (1.0 + 0.5 * x) * np.exp(-0.5 * x)) ** 50 == pytest.approx(0.01, rel=1e-6)


def test_gaps_and_long_records():
    seconds = np.concatenate([np.arange(0.0, 5000.0, 2.0), np.arange(5900.0, 16000.0, 2.0)])
    found = detect(signals([(-HZ, (0.1, 0.1))], seconds))
    assert found.cone.frequency_hz == pytest.approx(HZ, rel=5e-3) and found.cone.turning < -0.9


def test_refusals():
    with pytest.raises(NoEstimateError, match="longer record"):
        detect(signals([], SECONDS[:100]))
    with pytest.raises(InputError, match="band_hz"):
        detect(signals([]), band_hz=(0.02, 0.01))
    with pytest.raises(InputError, match="false_alarm"):
        detect(signals([]), false_alarm=1.0)
    sparse = np.concatenate([np.arange(0.0, 100.0), np.arange(5900.0, 6000.0)])
    with pytest.raises(NoEstimateError, match="half full"):
        detect(signals([], sparse))
