"""The laws that hear a skiprope in the loop and take it out, flown on a flexible line."""

import numpy as np
import pytest

import fieldline as fl
from fieldline.control import LAWS
from fieldline.errors import InputError
from fieldline.simulate.estimators import ESTIMATORS
from fieldline.simulate.line_shape import line_shape
from fieldline.simulate.scenario.outside import known_laws
from fieldline.simulate.scenario.templates import template
from fieldline.simulate.skiprope_laws import HEARING_LAWS

pytestmark = pytest.mark.flight  # an hour on a flexible line each: minutes in plain Python, and no kernel of their own
YAW = '[[software]]\nbody = "ship"\nlaw = "skiprope-yaw"'
CURRENT = """circuit = { mode = "profile", commanded = true, current_max_a = 1.0 }
[[software]]
body = "satellite"
law = "skiprope-current"
rate_hz = 1.0
parameters = { swing_hz = 0.0251, mass_per_length_kg_m = 8.35e-3, listen_s = 1200.0 }
"""


def flown(text, **changes):
    run = fl.simulate(fl.Scenario.from_toml(text).replace(**changes))
    seconds = (run.time.values - run.time.values[0]).astype(np.int64) * 1e-9
    return run, seconds, np.hypot(*line_shape(run, "tether").bow.values.T)


def by_current():
    text = template("skiprope", "current")
    return text[: text.index("[[software]]")] + CURRENT


def test_the_yaw_takes_it_out_by_the_wheels():
    run, seconds, size = flown(template("skiprope", "yaw"), **{"time.duration_s": 3300.0})
    assert size[seconds < 1900.0].mean() == pytest.approx(6.0, abs=0.3) and size[seconds > 2750.0].max() < 0.8
    body = list(run.body.values).index("ship")
    rate = np.linalg.norm(run.omega_bi_b.values[:, body], axis=-1)
    assert np.median(rate[(seconds > 2300.0) & (seconds < 2500.0)]) == pytest.approx(2.0 * np.pi * 5.13e-3, rel=0.05)
    assert rate[seconds > 2800.0].max() < 2.5e-3  # the orbit's, at rest again


def test_a_yaw_half_a_turn_wrong_feeds_it():
    text = template("skiprope", "wrong").replace("{ swing_hz = 0.0251 }", "{ swing_hz = 0.0251, azimuth_off_deg = 180.0 }")
    _, seconds, size = flown(text, **{"time.duration_s": 3000.0})
    assert size[seconds > 2750.0].mean() > 1.7 * size[seconds < 1900.0].mean()


def test_the_current_takes_it_down_round_by_round():
    _, seconds, size = flown(by_current(), **{"time.duration_s": 6000.0})
    after = [np.sqrt(np.mean(size[(seconds > a) & (seconds < b)] ** 2)) for a, b in ((0, 1100), (2000, 2900), (5600, 6000))]
    assert after[0] == pytest.approx(6.0, abs=0.3) and after[1] < 0.75 * after[0] and after[2] < 0.4 * after[0]


def test_they_are_in_the_registry_with_words():
    assert set(HEARING_LAWS) == {"skiprope-yaw", "skiprope-current"} and HEARING_LAWS.items() <= known_laws().items()
    assert not set(HEARING_LAWS) & {*LAWS, *ESTIMATORS}
    for law in HEARING_LAWS.values():
        assert law.commands and law.doc and all(one.doc for one in law.parameters.values())


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("from_point_b_m = [1.5, 0.0, 0.0]", "from_point_b_m = [0.0, 0.0, -1.0]", "off its yaw axis"),
        ("magnetometer = { rate_hz = 1.0, noise_std_nt = 20.0, quantum_nt = 2.0 }", "", "hears a magnetometer"),
        ("{ swing_hz = 0.0251 } ", "{ swing = 0.0251 } ", "swing_hz"),
        ("{ swing_hz = 0.0251 } ", "{ swing_hz = -1.0 } ", "must not be negative"),
        ("{ swing_hz = 0.0251 } ", '{ tether = "left" } ', "down, up"),
    ],
)
def test_what_cannot_be_is_refused(old, new, words):
    text = template("skiprope", "refused")
    assert old in text
    with pytest.raises(InputError, match=words):
        fl.simulate(fl.Scenario.from_toml(text.replace(old, new)))


def test_without_a_skiprope_they_leave_it_alone():
    text = template("skiprope", "still").replace("skiprope_amplitude_m = 6.0", "skiprope_amplitude_m = 0.0")
    text = text.replace("[0.0, 1.45, 0.0]", "[0.0, 0.0, 0.0]").replace("[-0.0146, 0.0, 0.0]", "[0.0, 0.0, 0.0]")
    run, _, size = flown(text, **{"time.duration_s": 2600.0})
    body = list(run.body.values).index("ship")
    assert size.max() < 0.5 and np.linalg.norm(run.omega_bi_b.values[:, body], axis=-1).max() < 2.5e-3
