"""The second-order filters against SciPy and against the closed forms of their response."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.signal import lsim

from fieldline.errors import InputError
from fieldline.estimation.skiprope import bandpass, bandpass_response, filter_bank, group_delay_s, lowpass, settling_time_s
from fieldline.estimation.skiprope.bandpass import exact_step, runge_kutta_step

pytestmark = pytest.mark.kernels
HZ, DAMPING = 0.005, 0.1
WN = 2.0 * np.pi * HZ


def test_the_step_is_the_matrix_exponential():
    for dt in (1.0 / 16.0, 1.0, 37.0, 1000.0):
        exact = expm(np.array([[0.0, 1.0], [-WN * WN, -2.0 * DAMPING * WN]]) * dt)
        assert np.reshape(exact_step(dt, WN, DAMPING), (2, 2)) == pytest.approx(exact, abs=1e-13)


def test_one_runge_kutta_step_errs_in_the_fifth_order():
    def error(dt):
        return abs(np.subtract(exact_step(dt, WN, DAMPING), runge_kutta_step(dt, WN, DAMPING))).max()

    assert np.log2(error(16.0) / error(8.0)) == pytest.approx(5.0, abs=0.15)
    assert error(1.0 / 16.0) < 1e-14


def test_both_outputs_against_scipy_with_uneven_steps():
    rng = np.random.default_rng(3)
    seconds = np.cumsum(rng.choice([1.0, 2.0, 5.0], 400))
    fine = np.arange(seconds[0], seconds[-1] + 0.5)
    signal = rng.standard_normal(400)
    held = signal[np.searchsorted(seconds, fine, side="right") - 1]
    step = 1.0  # lsim holds its input over even steps
    for numerator, found in (([WN * WN], lowpass), ([2 * DAMPING * WN, 0.0], bandpass)):
        system = (numerator, [1.0, 2.0 * DAMPING * WN, WN * WN])
        expected = lsim(system, held - held[0], np.arange(len(fine)) * step, interp=False)[1]
        expected = expected[np.searchsorted(fine, seconds)] + (held[0] if found is lowpass else 0.0)
        assert found(seconds, signal, HZ, DAMPING) == pytest.approx(expected, abs=1e-11)


def test_straight_pieces_against_scipy():
    seconds, signal = np.arange(300.0), np.random.default_rng(4).standard_normal(300)
    system = ([2 * DAMPING * WN, 0.0], [1.0, 2.0 * DAMPING * WN, WN * WN])
    expected = lsim(system, signal - signal[0], seconds, interp=True)[1]
    assert bandpass(seconds, signal, HZ, DAMPING, method="linear") == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("ratio", [0.2, 0.8, 1.0, 1.25, 4.0])
def test_a_steady_tone_comes_out_with_gain_and_phase(ratio):
    seconds = np.arange(0.0, 20000.0, 0.25)
    tone = np.cos(ratio * WN * seconds)
    expected = np.real(bandpass_response(ratio * HZ, HZ, DAMPING) * np.exp(1j * ratio * WN * (seconds - 0.125)))
    late = seconds > 10000.0  # the held input is half a step late, the other is not
    prompt = np.real(bandpass_response(ratio * HZ, HZ, DAMPING) * np.exp(1j * ratio * WN * seconds))
    assert bandpass(seconds, tone, HZ, DAMPING, method="linear")[late] == pytest.approx(prompt[late], abs=1e-4)
    assert bandpass(seconds, tone, HZ, DAMPING)[late] == pytest.approx(expected[late], abs=3e-5)


def test_response_where_tuned_and_its_delay():
    assert bandpass_response(HZ, HZ) == pytest.approx(1.0)
    assert bandpass_response(-0.004, HZ) == pytest.approx(np.conj(bandpass_response(0.004, HZ)))
    assert group_delay_s(HZ, HZ, DAMPING) == pytest.approx(1.0 / (DAMPING * WN))
    near = np.array([0.8, 1.0, 1.3]) * HZ
    step = 1e-8
    slope = np.angle(bandpass_response(near + step, HZ) / bandpass_response(near - step, HZ)) / (4.0 * np.pi * step)
    assert group_delay_s(near, HZ) == pytest.approx(-slope, rel=1e-5)
    assert settling_time_s(HZ) == pytest.approx(800.0, rel=0.01)


def test_a_constant_makes_no_transient():
    seconds = np.arange(500.0)
    assert not bandpass(seconds, np.full(500, 0.3), HZ).any()
    assert lowpass(seconds, np.full(500, 0.3), HZ) == pytest.approx(0.3, abs=1e-15)


def test_a_stream_in_pieces_is_the_stream():
    rng = np.random.default_rng(5)
    seconds, signals = np.cumsum(rng.uniform(0.5, 1.5, 300)), rng.standard_normal((300, 3))
    whole = filter_bank(seconds, signals, HZ, DAMPING)
    state, pieces = None, []
    for part in np.split(np.arange(300), [1, 2, 90, 211]):
        piece = filter_bank(seconds[part], signals[part], HZ, DAMPING, state=state)
        state = piece.state
        pieces.append(piece.rate)
    assert np.array_equal(np.concatenate(pieces), whole.rate)
    with pytest.raises(InputError, match="went back"):
        filter_bank(seconds[:3], signals[:3], HZ, DAMPING, state=state)


def test_gaps_hold_the_input_and_long_ones_start_anew():
    seconds = np.arange(0.0, 3000.0)
    signal = np.cos(WN * seconds)
    holed = signal.copy()
    holed[1000:1003] = np.nan
    held = np.where(np.isnan(holed), signal[999], signal)
    assert np.array_equal(bandpass(seconds, holed, HZ), bandpass(seconds, held, HZ))
    holed[1000:1400] = np.nan
    anew = filter_bank(seconds, holed, HZ, DAMPING, longest_hold_s=60.0)
    assert np.isnan(anew.low[1070:1400]).all() and np.isnan(anew.age_s[1070:1400]).all()
    assert anew.low[1400] == signal[1400] and anew.rate[1400] == 0.0 and anew.age_s[1405] == 5.0
    fresh = filter_bank(seconds[1400:], signal[1400:], HZ, DAMPING)
    assert np.array_equal(anew.rate[1400:], fresh.rate)


@pytest.mark.parametrize(
    "wrong",
    [
        {"frequency_hz": 0.0},
        {"frequency_hz": -0.005},
        {"damping": 1.0},
        {"method": "euler"},
        {"seconds": np.zeros(5)},
        {"signals": np.zeros(4)},
    ],
)
def test_refusals(wrong):
    arguments = {"seconds": np.arange(5.0), "signals": np.zeros(5), "frequency_hz": HZ, "damping": DAMPING}
    with pytest.raises(InputError):
        filter_bank(**{**arguments, **wrong})
