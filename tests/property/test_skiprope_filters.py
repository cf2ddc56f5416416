"""What holds for the filters that run sample by sample: consistency, memory, the bound, and streams that misbehave."""

import numpy as np
import pytest

from fieldline.cases.tp3123 import fly, random_scenario
from fieldline.cases.tp3123.flight import dcm_321, field_along_orbit
from fieldline.errors import InputError
from fieldline.estimation.skiprope import (
    KalmanSettings,
    LiveSkiprope,
    bandpass_step,
    cramer_rao,
    estimate_skiprope,
    field_vector,
    kalman_step,
    skiprope_signals,
)
from fieldline.estimation.skiprope.live import LIVE_METHODS

HZ, SWING_HZ, LENGTH = 0.005, 0.03125, 20e3
TURN = 2.0 * np.pi


def model_flight(seed: int, params, count: int = 1500):
    """States (count, 16) of the filter's own model, drawn from its first deviations and its noises, and what is measured."""
    rng = np.random.default_rng(seed)
    memory = np.zeros(kalman_step.SIZE)
    kalman_step.kalman_start(0.0, memory, params)
    first = memory[kalman_step.HEAD : kalman_step.HEAD + 16].copy()
    first += np.sqrt(np.diag(kalman_step.covariance_of(memory))) * rng.standard_normal(16)
    known = field_vector(fly(duration_s=float(count), rate_hz=1.0).geometry)
    states, fields = np.empty((count, 16)), np.empty((count, 3))
    carrier = np.zeros(kalman_step.SIZE)
    carrier[kalman_step.STARTED] = 1.0
    carrier[kalman_step.HEAD : kalman_step.HEAD + 16] = first
    x = carrier[kalman_step.HEAD : kalman_step.HEAD + 16]
    for k in range(count):
        if k:
            kalman_step.covariance_of(carrier)[:] = 0.0
            kalman_step.kalman_carry(float(k), carrier, params)
            noise = kalman_step.covariance_of(carrier)
            x += np.linalg.cholesky(noise + 1e-24 * np.eye(16)) @ rng.standard_normal(16)
        states[k] = x
        unit = known[k] / np.linalg.norm(known[k])
        direction = np.array(kalman_step.predicted(x, tuple(unit))[0]) + params[1] * rng.standard_normal(3)
        fields[k] = np.linalg.norm(known[k]) * direction + params[0] * rng.standard_normal(3)
    return states, known, fields


def test_the_covariance_is_that_of_the_errors():
    """Twelve flights of the model itself: squared errors of cone and frequency over the covariance average five, those of the
    innovations two, each within four deviations of the mean; nothing is passed over."""
    params = KalmanSettings(noise_tesla=5e-8, frequency_share=0.01, slow_rad_s32=2e-6).packed(HZ, SWING_HZ)
    nees, nis = [], []
    for seed in range(12):
        states, known, fields = model_flight(seed, params)
        memory = np.zeros(kalman_step.SIZE)
        for k in range(len(states)):
            assert kalman_step.kalman_update(float(k), fields[k], known[k], memory, params)
            if k >= 300:
                nis.append(memory[kalman_step.NIS])
            if k >= 600 and k % 300 == 0:
                off = (memory[kalman_step.HEAD : kalman_step.HEAD + 16] - states[k])[6:11]
                spread = kalman_step.covariance_of(memory)[6:11, 6:11]
                nees.append(off @ np.linalg.solve(spread, off))
    assert abs(np.mean(nis) - 2.0) < 4.0 * np.sqrt(4.0 / len(nis)) + 0.03  # the noise is known from the samples alone
    assert abs(np.mean(nees) - 5.0) < 4.0 * np.sqrt(10.0 / 12)  # the times of a flight are not independent


@pytest.mark.kernels
def test_derivatives_are_those_of_the_direction():
    rng = np.random.default_rng(1)
    for _ in range(5):
        x = 0.2 * rng.standard_normal(16)
        unit = rng.standard_normal(3)
        unit = tuple(unit / np.linalg.norm(unit))
        rows = kalman_step.predicted(x, unit)
        for axis, k in enumerate((6, 8, 0, 1, 2)):
            ahead, back = x.copy(), x.copy()
            ahead[k] += 1e-6
            back[k] -= 1e-6
            slope = (np.array(kalman_step.predicted(ahead, unit)[0]) - kalman_step.predicted(back, unit)[0]) / 2e-6
            assert np.allclose(rows[1 + axis], slope, atol=1e-9)
        assert np.linalg.norm(rows[0]) == pytest.approx(1.0)


@pytest.mark.kernels
def test_kernels_take_samples_and_refuse_others():
    """A hundred samples 10 s apart: the covariance stays symmetric, positive and shrinks; what is no sample changes nothing."""
    one = random_scenario(9000, duration_s=1000.0, rate_hz=0.1)
    known = field_vector(one.signals.geometry)
    params = KalmanSettings().packed(HZ, None)
    memory, other = np.zeros(kalman_step.SIZE), np.zeros(bandpass_step.SIZE)
    rules = np.array([HZ, 0.5, 1.0, 0.0])
    for k, t in enumerate(one.signals.seconds):
        row = (t, one.signals.field_b[k], known[k])
        kalman_step.kalman_update(*row, memory, params)
        assert bandpass_step.bandpass_update(*row, other, rules)
        before = memory.copy(), other.copy()
        for bad in ((t, *row[1:]), (t - 5.0, *row[1:]), (t + 5.0, np.full(3, np.nan), row[2]), (np.nan, *row[1:])):
            assert not kalman_step.kalman_update(*bad, memory, params)
            assert not bandpass_step.bandpass_update(*bad, other, rules)
        assert np.array_equal(memory, before[0]) and np.array_equal(other, before[1], equal_nan=True)
    spread = kalman_step.covariance_of(memory)
    assert np.array_equal(spread, spread.T) and (np.linalg.eigvalsh(spread) > -1e-18).all()
    assert np.trace(spread[6:10, 6:10]) < 4.0 * 0.03**2
    part, covariance = np.empty(4), np.empty((4, 4))
    assert bandpass_step.bandpass_phasor(1000.0, other, rules, part, covariance) in (-1, 0, 1)
    assert np.isfinite(part).all() and (np.linalg.eigvalsh(covariance) > -1e-12).all()


@pytest.mark.parametrize("method", LIVE_METHODS)
def test_a_resumed_stream_goes_on_bit_for_bit(method):
    one = random_scenario(9001, duration_s=2600.0)
    known = field_vector(one.signals.geometry)
    live = LiveSkiprope(tether_length_m=LENGTH, method=method)
    other = None
    trusted = 0
    for k, t in enumerate(one.signals.seconds):
        now = live.update(t, one.signals.field_b[k], known[k])
        if other is not None:
            then = other.update(t, one.signals.field_b[k], known[k])
            assert np.array_equal(np.array(now, dtype=float), np.array(then, dtype=float), equal_nan=True)
        if k % 700 == 650:
            other = LiveSkiprope.resumed({name: array.copy() for name, array in (other or live).state().items()})
        trusted += now.trusted
    assert trusted > 1000 and now.sense == np.sign(one.frequency_hz)
    assert now.frequency_hz == pytest.approx(abs(one.frequency_hz), rel=0.03)
    assert len(live.crossings(0.0).seconds) == 3


def test_live_and_offline_agree():
    """The Kalman filter live, started by its search, against the record's at the end: half a deviation."""
    one = random_scenario(9002, duration_s=3600.0)
    known = field_vector(one.signals.geometry)
    live = LiveSkiprope(tether_length_m=LENGTH)
    for k, t in enumerate(one.signals.seconds):
        now = live.update(t, one.signals.field_b[k], known[k])
    found = estimate_skiprope(one.signals, tether_length_m=LENGTH, method="kalman", step_s=3600.0)
    assert abs(now.amplitude_rad - found.amplitude_rad[-1]) < 0.5 * now.amplitude_std_rad
    assert abs(now.plane_rad - found.plane_rad[-1]) < now.plane_std_rad
    assert now.frequency_hz == pytest.approx(found.frequency_hz[-1], abs=now.frequency_std_hz)


@pytest.mark.parametrize("method", LIVE_METHODS)
def test_a_stream_may_stop_repeat_and_go_backwards(method):
    """Repeats, steps back and bad samples change nothing; a stop of 20 minutes ends trust for a while, not for ever."""
    one = random_scenario(9003, duration_s=6000.0)
    known = field_vector(one.signals.geometry)
    clean = LiveSkiprope(tether_length_m=LENGTH, method=method, frequency_hz=HZ, pendulous_hz=SWING_HZ)
    rough = LiveSkiprope(tether_length_m=LENGTH, method=method, frequency_hz=HZ, pendulous_hz=SWING_HZ)
    for k, t in enumerate(one.signals.seconds):
        if 2500.0 < t < 3700.0:
            continue
        row = (t, one.signals.field_b[k], known[k])
        now = clean.update(*row)
        then = rough.update(*row)
        if k % 50 == 7:
            assert not rough.update(*row).used
            assert not rough.update(t - 30.0, *row[1:]).used
            assert not rough.update(t + 0.5, (np.nan, 0.0, 0.0), row[2]).used
        assert np.array_equal(np.array(now, dtype=float), np.array(then, dtype=float), equal_nan=True)
        if t == 2500.0:
            assert now.trusted
    assert now.trusted and now.sense == np.sign(one.frequency_hz)
    counts = rough.counts
    assert counts["repeated"] == 2 * counts["bad"] > 100 and counts["samples"] == clean.counts["samples"]


def test_a_lost_filter_is_reported_and_starts_anew():
    """Told a frequency 20 % high and a pendulum that is not there: the search starts it anew, and it is right in the end."""
    one = random_scenario(9004, duration_s=4000.0)
    known = field_vector(one.signals.geometry)
    live = LiveSkiprope(tether_length_m=LENGTH, frequency_hz=abs(one.frequency_hz) * 1.2, pendulous_hz=0.06)
    for k, t in enumerate(one.signals.seconds):
        now = live.update(t, one.signals.field_b[k], known[k])
    assert live.counts["restarts"] >= 1
    assert now.trusted and now.frequency_hz == pytest.approx(abs(one.frequency_hz), rel=2e-3)


def test_silence_is_not_reported_as_motion():
    one = random_scenario(9005, skiprope=False, duration_s=3000.0)
    known = field_vector(one.signals.geometry)
    for method in LIVE_METHODS:
        live = LiveSkiprope(tether_length_m=LENGTH, method=method)
        for k, t in enumerate(one.signals.seconds):
            now = live.update(t, one.signals.field_b[k], known[k])
            assert not now.trusted and not now.detected
        assert np.degrees(live.threshold_rad) < 0.02 and live.detection.cone is None


def test_no_estimator_beats_the_bound_and_two_come_near():
    """Ten records with the field known exactly and 100 nT: errors between 0.8 and 2.5 times the bound."""
    axes = np.radians((0.75, 0.5))
    errors = {"harmonic": [], "kalman": []}
    for seed in range(10):
        flight = fly(duration_s=3000.0, rate_hz=1.0, bits=0, noise_tesla=1e-7, seed=seed, bias_deg=(0.1, 0.1, 0.1))
        signals = skiprope_signals(flight.seconds, flight.measured_b, field_vector(flight.geometry))
        for method, found in errors.items():
            estimate = estimate_skiprope(signals, tether_length_m=LENGTH, method=method, frequency_hz=HZ)
            k = len(estimate.seconds) - 1 if method == "kalman" else len(estimate.seconds) // 2
            found.append((estimate.amplitude_rad[k] / axes.mean() - 1.0, estimate.frequency_hz[k] / HZ - 1.0))
    turn = np.exp(2j * np.pi * HZ * 1500.0)
    limit = cramer_rao(flight.seconds, flight.geometry, (axes[0] * turn, -1j * axes[1] * turn), HZ, noise_tesla=1e-7)
    for found in errors.values():
        amplitude, frequency = np.sqrt(np.mean(np.square(found), axis=0))
        assert 0.8 < amplitude / (limit.amplitude_rad / axes.mean()) < 2.5
        assert 0.6 < frequency / (limit.frequency_hz / HZ) < 2.5


def test_the_bound_grows_with_what_is_not_known():
    flight = fly(duration_s=2000.0, rate_hz=0.5)
    args = (flight.seconds, flight.geometry, (0.01 + 0j, -0.01j), HZ)
    sizes = [cramer_rao(*args, noise_tesla=1e-8, slow_degree=degree)[:4] for degree in (0, 3, 6)]
    assert (np.diff(sizes, axis=0) > 0.0).all()
    double = cramer_rao(*args, noise_tesla=2e-8)[:4]
    assert np.array(double) == pytest.approx(2.0 * np.array(sizes[0]))
    digits = cramer_rao(*args, noise_tesla=0.0, digit_tesla=np.sqrt(12.0) * 1e-8)[:4]
    assert digits == pytest.approx(sizes[0])
    with pytest.raises(InputError, match="noise_tesla"):
        cramer_rao(*args, noise_tesla=0.0)


def test_refusals():
    with pytest.raises(InputError, match="kalman"):
        LiveSkiprope(tether_length_m=LENGTH, method="harmonic")
    with pytest.raises(InputError, match="rule"):
        LiveSkiprope(tether_length_m=LENGTH, rule="mine")
    state = LiveSkiprope(tether_length_m=LENGTH).state()
    with pytest.raises(InputError, match="no state"):
        LiveSkiprope.resumed({"head": state["head"]})
    with pytest.raises(InputError, match="no state"):
        LiveSkiprope.resumed(state | {"memory": np.zeros(3)})
    assert bandpass_step.SIZE != kalman_step.SIZE


def test_a_tether_on_the_reel_is_tracked():
    """Frequency from 4 to 7.5 mHz and three times the size in 7,000 s, the field known wrongly: live and offline."""
    seconds = np.arange(7000.0)
    share = seconds / seconds[-1]
    hz, size = 0.004 * 1.875**share, np.radians(0.3) * 3.0**share
    phase = TURN * np.cumsum(hz)
    swing = np.radians(2.0) * np.sin(TURN * SWING_HZ * seconds + 0.8)
    angles = np.stack([size * np.cos(phase) + swing, 0.7 * size * np.sin(phase) + swing, 0.05 + 0.0 * seconds], axis=1)
    true = field_vector(field_along_orbit(seconds, "IGRF-14"))
    known = field_vector(field_along_orbit(seconds, "displaced-dipoles"))
    field = np.einsum("nij,nj->ni", dcm_321(angles), true) + 2e-8 * np.random.default_rng(0).standard_normal((7000, 3))
    found = estimate_skiprope(
        skiprope_signals(seconds, field, known), tether_length_m=LENGTH, method="kalman", reeled=True, step_s=20.0
    )
    rows = found.seconds > 1500.0
    at = found.seconds[rows].astype(int)
    assert found.trusted[rows].all() and (found.sense[rows] == 1).all()
    assert np.sqrt(np.mean((found.frequency_hz[rows] / hz[at] - 1.0) ** 2)) < 0.03
    assert np.sqrt(np.mean((found.amplitude_rad[rows] / (0.85 * size[at]) - 1.0) ** 2)) < 0.03
    off = np.angle(np.exp(1j * (found.phase_rad[rows] - phase[at])))
    assert np.degrees(np.sqrt(np.mean(off**2))) < 8.0
    live = LiveSkiprope(tether_length_m=LENGTH, reeled=True)
    for k, t in enumerate(seconds):
        now = live.update(t, field[k], known[k])
    assert now.trusted and now.frequency_hz == pytest.approx(hz[-1], rel=0.03)
    with pytest.raises(InputError, match="kalman"):
        estimate_skiprope(skiprope_signals(seconds, field, known), tether_length_m=LENGTH, reeled=True)
