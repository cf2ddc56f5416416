"""What goes wrong in a run is said by name, time and state, and what was simulated until then is kept."""

import os
import signal
import threading
import time

import numpy as np
import pytest

import fieldline as fl
import plant_flights as pf
from fieldline.simulate import RunError, RunInterrupted
from plant_flights import law, torquers

KINDS = [
    (1, "raised RuntimeError: the law gave up"),
    (2, "returned a number that is not finite (nan, 0, 0)"),
    (3, "returned 2 numbers where 3 are expected (dipole)"),
    (4, "returned 0 numbers where 3 are expected (dipole)"),
    (6, "raised ValueError"),
    (7, "returned a number that is not finite (inf, inf, inf)"),
    (8, "returned 300 numbers where 3 are expected (dipole)"),
]
METHODS = {"rk4": {"step_s": 1.0}, "dop853": {"method": "dop853"}}


def kept(dataset, until):
    """What was simulated before the trouble is there, and marked as a part."""
    assert dataset.attrs["complete"] == 0
    seconds = dataset.seconds.values
    assert len(seconds) >= until / 5.0 and seconds[-1] <= until
    assert np.all(np.isfinite(dataset.position_i.values))
    assert np.all(np.linalg.norm(dataset.position_i.values, axis=-1) > 6e6)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("kind, words", KINDS)
def test_a_law_in_trouble_is_named_with_time_and_state(kind, words, method):
    software = [law(name="trouble", parameters=(kind, 30.0)) | {"name": "mischief"}]
    scenario = pf.scenario(
        pf.body(magnetorquer=torquers()), seconds=100.0, output=5.0, software=software, integrator=METHODS[method]
    )
    with pytest.raises(RunError) as caught:
        fl.simulate(scenario)
    text = str(caught.value)
    assert words in text and 'software "mischief" at t = 30 s' in text and "deg/s" in text
    kept(caught.value.dataset, 30.0)
    assert text in caught.value.dataset.attrs["outcome"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize(
    "function, words",
    [
        ("fails_late", "raised ValueError: the load has had enough"),
        ("not_finite_late", "returned a number that is not finite"),
        ("short_late", "wrong count of numbers"),
        ("none_late", "wrong count of numbers"),
    ],
)
def test_a_load_in_trouble_is_named(function, words, method):
    record = pf.body(load=[{"function": f"user_functions:{function}", "parameters": {"from_s": 30.0}}])
    with pytest.raises(RunError) as caught:
        fl.simulate(pf.scenario(record, seconds=100.0, output=5.0, integrator=METHODS[method] | {"step_max_s": 10.0}))
    assert words in str(caught.value) and f'load "user_functions:{function}" of body "sat"' in str(caught.value)
    kept(caught.value.dataset, 30.0)


def test_a_load_that_fails_in_the_last_row_is_heard():
    record = pf.body(load=[{"function": "user_functions:fails_late", "parameters": {"from_s": 100.0}}])
    with pytest.raises(RunError, match="the load has had enough"):
        fl.simulate(pf.scenario(record, seconds=100.0, output=5.0, integrator={"step_s": 0.5}))


def test_a_step_that_becomes_too_coarse_is_said_with_one_that_would_do():
    """Spun up by a constant torque until it turns by more than a radian in a step."""
    record = pf.body(rate_deg_s=(0.0, 0.0, 1.0), disturbance_torque_b_n_m=(0.0, 0.0, 0.05))
    with pytest.raises(RunError) as caught:
        fl.simulate(pf.scenario(record, seconds=500.0, output=5.0, integrator={"step_s": 4.0}))
    text = str(caught.value)
    assert "the step is too coarse" in text and 'body "sat"' in text and "dop853" in text
    proposed = float(text.split("step_s = ")[1].split()[0])
    rate = float(text.split("turns at ")[1].split()[0])
    assert 0.1 < np.radians(rate) * proposed < 0.3
    kept(caught.value.dataset, caught.value.dataset.seconds.values[-1] + 5.0)


@pytest.mark.parametrize("method", METHODS)
def test_reentry_ends_the_run_and_an_event_can_end_it_first(method):
    orbit = {"state": {"position_km": (6558.0, 0.0, 0.0), "velocity_km_s": (0.0, 7.77, 0.0)}}
    air = {"gravity": "j2", "uniform_field_i_tesla": pf.UNIFORM, "atmosphere": {"model": "layered"}}
    record = pf.body(kind="point", drag={"area_m2": 5.0})
    more = {
        "seconds": 40000.0,
        "output": 60.0,
        "orbit": orbit,
        "environment": air,
        "integrator": METHODS[method] | {"step_s": 10.0},
    }
    with pytest.raises(RunError, match="below 80 km") as caught:
        fl.simulate(pf.scenario(record, **more))
    dataset = caught.value.dataset
    assert dataset.attrs["complete"] == 0 and dataset.altitude_m.values[-1] < 180e3
    event = [{"kind": "altitude", "altitude_km": 120.0, "direction": "falling", "stop": True}]
    dataset = fl.simulate(pf.scenario(record, event=event, **more))
    assert dataset.attrs["complete"] == 1 and abs(dataset.altitude_m.values[-1, 0] - 120e3) < 0.1


def test_a_law_that_is_interrupted_leaves_what_was_flown():
    software = [law(name="trouble", parameters=(5, 30.0))]
    scenario = pf.scenario(pf.body(magnetorquer=torquers()), seconds=100.0, output=5.0, software=software)
    with pytest.raises(RunInterrupted, match="interrupted at t = 30 s of 100 s") as caught:
        fl.simulate(scenario)
    kept(caught.value.dataset, 30.0)


@pytest.mark.parametrize("plain", [True, False], ids=["in python", "in compiled code"])
def test_control_c_is_heard_wherever_it_falls(plain):
    """A signal from outside, while the loop runs: with a law in plain Python it falls between its lines or before its first."""
    software = [law(name="steady", parameters=(0.0, 0.0, 0.0)) | {"rate_hz": 20.0}] if plain else []
    scenario = pf.scenario(pf.body(magnetorquer=torquers()), seconds=3e6, output=1e3, software=software)
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    before = signal.getsignal(signal.SIGINT)
    timer.start()
    begun = time.monotonic()
    with pytest.raises(RunInterrupted) as caught:
        fl.simulate(scenario)
    timer.join()
    assert time.monotonic() - begun < 20.0
    assert 0.0 < caught.value.dataset.seconds.values[-1] < 3e6
    assert signal.getsignal(signal.SIGINT) is before
    assert caught.value.dataset.attrs["complete"] == 0
    assert np.all(np.isfinite(caught.value.dataset.position_i.values))


def test_a_state_that_blows_up_is_said(tmp_path):
    (tmp_path / "mine.py").write_text("def blow(t, s, p):\n    return [1e299 * v for v in s[:3]] + [0.0] * 3\n")
    scenario = pf.scenario(pf.body(load=[{"function": "mine.py:blow"}]), seconds=100.0, output=5.0)
    scenario._folder = tmp_path
    with pytest.raises(RunError) as caught:
        fl.simulate(scenario)
    assert "finite" in str(caught.value)
    assert caught.value.dataset.attrs["complete"] == 0


def test_compiled_functions_that_raise_are_named_too():
    law_at_fault = law(name="compiled_law_raises", parameters=()) | {"compiled": True, "name": "mischief"}
    load = {"load": [{"function": "user_functions:compiled_raises"}]}
    event = {"kind": "user", "name": "mischief", "function": "user_functions:compiled_raises"}
    cases = [
        ({"magnetorquer": torquers()}, {"software": [law_at_fault]}, 'software "mischief" at t = 30 s', "ZeroDivisionError"),
        (load, {}, 'load "user_functions:compiled_raises" of body "sat" raised', "ValueError: compiled and cross"),
        ({}, {"event": [event]}, 'event "mischief"', "raised ValueError: compiled and cross"),
    ]
    for more, tables, *words in cases:
        with pytest.raises(RunError) as caught:
            fl.simulate(pf.scenario(pf.body(**more), seconds=100.0, output=5.0, **tables))
        assert all(word in str(caught.value) for word in words), str(caught.value)
        kept(caught.value.dataset, 30.0)


def test_a_compiled_event_without_a_number_is_named():
    event = {"kind": "user", "name": "mute", "function": "user_functions:compiled_short"}
    with pytest.raises(RunError, match=r'event "mute" .* gave no finite number at t = 30 s'):
        fl.simulate(pf.scenario(seconds=100.0, output=5.0, event=[event]))


def test_the_librarys_own_faults_are_not_hidden():
    """What is raised elsewhere, as by a caller's progress bar, is not blamed on a law."""

    def broken(fraction):
        raise RuntimeError("the bar broke")

    with pytest.raises(RuntimeError, match="the bar broke"):
        fl.simulate(pf.scenario(seconds=10.0), progress=broken)


def test_a_body_of_many_thrusters_has_room_for_their_commands():
    thruster = {"position_b_m": (0.0, 0.0, 0.0), "direction_b": (1.0, 0.0, 0.0), "force_n": 1e-6}
    software = [law(name="steady", commands=("thrust",), parameters=[1.0] * 80)]
    flight = pf.flown(pf.body(thruster=[thruster] * 80), seconds=4.0, output=1.0, software=software)
    assert flight.outcome.name == "DONE"
    assert np.all(flight.record.actuators[1] == 1.0)
