"""First guesses with no prior, and the words where there are none."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fieldline.cases.erbs_like import erbs_like_arc
from fieldline.estimation.natanson.candidates import natanson_candidates, turning_rate
from fieldline.estimation.natanson.limits import expected_angle_error, three_sample_verdict


def arc_of(seed, rate_deg_s, noise=1e-7, **settings):
    return erbs_like_arc(
        attitude="random",
        seed=seed,
        rate_deg_s=rate_deg_s,
        quantisation_tesla=0.0,
        noise_tesla=noise,
        ascending_node_deg=83.0 * seed,
        argument_deg=47.0 * seed,
        **settings,
    )


def error_deg(arc, row):
    return np.degrees((Rotation.from_quat(row.q_bi).inv() * Rotation.from_quat(arc.q_bi[row.index])).magnitude())


@pytest.mark.parametrize("top_deg_s, interval", [(0.07, 8.0), (0.5, 10.0), (5.0, 1.0)])
def test_a_slow_body_is_found_among_the_candidates(top_deg_s, interval):
    generator = np.random.default_rng(5)
    for seed in range(8):
        rate = generator.normal(size=3)
        arc = arc_of(seed, tuple(generator.uniform(0.1, 1.0) * top_deg_s * rate / np.linalg.norm(rate)), interval_s=interval)
        rows = natanson_candidates(arc.seconds, arc.measured_b, arc.field_i, 1e-7)
        errors = [error_deg(arc, row) for row in rows]
        best = int(np.argmin(errors))
        assert errors[best] < 1.0
        assert np.degrees(np.linalg.norm(rows[best].omega_b - arc.omega_b[rows[best].index])) < 0.01
        assert rows[best].loss < 1.3e-7


def test_the_paper_s_digits_and_gaps():
    arc = erbs_like_arc()
    field = arc.measured_b.copy()
    field[100:112] = np.nan
    rows = natanson_candidates(arc.seconds, field, arc.field_i, 6.44e-7 / np.sqrt(12))
    assert error_deg(arc, rows[0]) < 1.0
    assert all(np.isfinite(field[row.index]).all() for row in rows)
    assert rows.reason == ""


def test_a_long_record_is_averaged_and_keeps_its_sample_numbers():
    arc = arc_of(2, (0.1, 0.2, -0.1), interval_s=0.1, length_s=5600.0)
    field = arc.measured_b.copy()
    field[::997] = np.nan
    rows = natanson_candidates(arc.seconds, field, arc.field_i, 1e-7)
    assert len(arc.seconds) > 50_000
    for row in rows[:4]:
        assert error_deg(arc, row) < 0.1
        assert row.loss == pytest.approx(1e-7 / np.sqrt(3.0), rel=0.05)  # means of three samples


@pytest.mark.parametrize(
    "settings, words",
    [
        ({"rate_deg_s": (10.0, -2.0, 45.0), "interval_s": 1.0}, "aliased"),
        ({"rate_deg_s": (0.05, 0.0, 0.0), "length_s": 40.0}, "usable samples"),
        ({"rate_deg_s": (0.05, 0.0, 0.0), "length_s": 160.0, "noise": 1e-6}, "longer arc"),
    ],
)
def test_an_arc_without_an_answer_gives_an_empty_list_and_a_reason(settings, words):
    noise = settings.get("noise", 1e-7)
    arc = arc_of(3, **settings)
    rows = natanson_candidates(arc.seconds, arc.measured_b, arc.field_i, noise)
    assert rows == []
    assert words in rows.reason


def test_turning_rate_of_a_steady_spin():
    seconds = 2.0 * np.arange(2000)
    field = 3e-5 * np.stack([np.cos(0.004 * seconds), np.sin(0.004 * seconds), 0 * seconds], axis=-1)
    noisy = field + 2e-7 * np.random.default_rng(0).standard_normal(field.shape)
    assert turning_rate(seconds, noisy, 2e-7) == pytest.approx(0.004, rel=0.05)


def test_limits_order_the_cases_that_were_measured():
    """Medians measured over random cases: expected errors are of the same order, and useless ones are told from useful."""
    degree = np.pi / 180.0
    noise, field, turning = 6.44e-7 / np.sqrt(12), 3e-5, 0.1 * degree
    measured = [  # step [s], noise [T], spin [deg/s], median error [deg]
        (240.0, noise, 0.062, 7.1),
        (240.0, noise, 0.2, 4.3),
        (0.1, 0.0, 10.0, 0.06),
        (0.02, 0.0, 50.0, 0.31),
        (0.1, 0.0, 30.0, 1.7),
    ]
    for step, sigma, spin, error in measured:
        found = np.degrees(expected_angle_error(step, sigma, field, spin * degree, turning))
        assert 0.2 < found / error < 7.0
        assert three_sample_verdict(step, sigma, field, spin * degree, turning)[0]
    for spin in (10.0, 30.0, 50.0):
        works, words = three_sample_verdict(0.5, noise, field, spin * degree, turning)
        assert not works and "at any step" in words
    works, words = three_sample_verdict(8.0, noise, field, 0.062 * degree, turning)
    assert not works and "best step" in words
