"""Ensembles: runs depend on their number alone, draws follow their distributions, and bad input is said in words."""

import numpy as np
import pytest

from ensemble_scenario import TABLE
from fieldline.errors import InputError
from fieldline.simulate import Scenario
from fieldline.simulate.ensemble import Choice, Normal, Uniform, simulate_many
from fieldline.simulate.ensemble.dispersion import drawn, streams
from fieldline.simulate.flight import Flight
from fieldline.simulate.outcome import RunInterrupted

pytestmark = [pytest.mark.kernels, pytest.mark.flight]

SCENARIO = Scenario.from_dict(TABLE, "scenario").replace(**{"time.duration_s": 4.0, "time.output_step_s": 2.0})
RATES = {"body.0.rate_deg_s": Uniform([-5.0, -5.0, -5.0], [5.0, 5.0, 5.0])}


def test_neither_workers_nor_the_number_of_runs_change_a_run():
    many = simulate_many(SCENARIO, 20, disperse=RATES, workers=2)
    few = simulate_many(SCENARIO, 5, disperse=RATES, workers=1)
    assert many.isel(run=slice(0, 5)).drop_attrs().identical(few.drop_attrs())
    assert len(np.unique(many["body.0.rate_deg_s"].values)) == 60  # no two runs draw alike


def test_lanes_and_the_plant_give_one_result():
    lanes = simulate_many(SCENARIO, 3, disperse=RATES, workers=1)
    plant = simulate_many(SCENARIO, 3, disperse=RATES, workers=1, lanes=False)
    for name in ("position_i", "q_bi", "omega_bi_b", "torquer_moment"):
        np.testing.assert_allclose(lanes[name], plant[name], rtol=1e-13, atol=1e-12)
    assert list(lanes.outcome.values) == list(plant.outcome.values) == ["done"] * 3


def test_runs_that_an_event_stops_share_the_times_of_all():
    event = [{"kind": "rate", "rate_deg_s": 9.87, "direction": "falling", "stop": True}]
    stopped = SCENARIO.replace(event=event, **{"time.duration_s": 20.0})
    lanes, plant = (simulate_many(stopped, 2, lanes=on) for on in (True, False))
    assert lanes.seconds.values.tolist() == plant.seconds.values.tolist()
    np.testing.assert_allclose(lanes.ended_s, plant.ended_s, atol=5e-3)
    assert set(lanes.outcome.values) == {"stopped"} and np.all(lanes.ended_s < 20.0)


def test_a_run_can_be_flown_again_by_itself():
    noisy = SCENARIO.replace(**{"body.0.magnetometer.noise_std_nt": 50.0})
    data = simulate_many(noisy, 3, disperse=RATES, seed=5)
    alone = Flight(noisy.replace(**{"body.0.rate_deg_s": data["body.0.rate_deg_s"].values[2].tolist()}), int(data.seed[2]))
    alone.fly()
    np.testing.assert_array_equal(data.omega_bi_b.values[2, :, 0], alone.record.state[:3, 10:13])


def test_distributions_draw_what_they_say():
    table = {"a": Normal(3.0, 0.5), "b": Uniform([0.0, 10.0], [1.0, 20.0]), "c": Choice(("x", "y"))}
    draws = [drawn(table, rng, 0) for rng, _ in streams(1, 4000)]
    a = np.array([draw["a"] for draw in draws])
    assert a.mean() == pytest.approx(3.0, abs=0.04) and a.std() == pytest.approx(0.5, abs=0.03)  # five sigma
    b = np.array([draw["b"] for draw in draws])
    assert b.min(axis=0) == pytest.approx([0.0, 10.0], abs=0.02) and b.max(axis=0) == pytest.approx([1.0, 20.0], abs=0.02)
    assert {draw["c"] for draw in draws} == {"x", "y"}


def test_a_function_of_ones_own_disperses():
    data = simulate_many(SCENARIO, 2, disperse=lambda rng, run: {"body.0.mass_kg": 4.0 + run})
    assert data["body.0.mass_kg"].values.tolist() == [4.0, 5.0]


def test_an_interruption_keeps_the_runs_that_are_done():
    def interrupt(fraction):
        raise KeyboardInterrupt

    with pytest.raises(RunInterrupted, match="of 40 runs are done") as caught:
        simulate_many(SCENARIO, 40, disperse=RATES, workers=1, progress=interrupt)
    kept = caught.value.dataset
    assert 16 <= kept.sizes["run"] < 40 and np.isfinite(kept.omega_bi_b.values).all()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: simulate_many(SCENARIO, 0), "runs must be a whole number"),
        (lambda: simulate_many(SCENARIO, 1.5), "runs must be a whole number"),
        (lambda: simulate_many(SCENARIO, 1, workers=0), "workers must be a whole number"),
        (lambda: simulate_many(SCENARIO, 1, disperse={"body.0.mass_kg": 3.0}), "must be Normal, Uniform or Choice"),
        (lambda: simulate_many(SCENARIO, 1, disperse=lambda rng, run: 3.0), "must return a table"),
        (lambda: simulate_many(SCENARIO, 1, disperse={"body.0.mass_kg": Choice((-1.0,))}), r"run 0 \(body.0.mass_kg = -1.0\)"),
        (lambda: simulate_many(SCENARIO, 1, disperse={"body.0.mas_kg": Choice((1.0,))}), "mass_kg"),
    ],
)
def test_bad_input_is_said_in_words(call, words):
    with pytest.raises(InputError, match=words):
        call()
