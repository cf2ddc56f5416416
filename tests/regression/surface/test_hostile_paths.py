"""Names, paths, seeds and signals that nothing good can come of: refused before the flight, in a sentence."""

import os
import signal
import sys
import threading
from types import SimpleNamespace

import pytest

import fieldline as fl
from fieldline.cli import main
from fieldline.errors import InputError
from fieldline.simulate.interruption import noted
from fieldline.simulate.scenario import Scenario
from simulated_runs import TUMBLE, with_law


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.toml").write_text(TUMBLE)
    monkeypatch.setattr("fieldline.simulate.run.simulate", None)  # a flight would fail
    return tmp_path


@pytest.mark.parametrize(
    "options, words",
    [
        (["--as-telemetry", "b.csv", "--report", "b.csv"], "two outputs of the command would be the same file"),
        (["--out", "b", "--report", "b.nc"], "two outputs of the command would be the same file"),
        (["--out", "x" * 300], "File name too long"),
        (["--report", "folder"], 'the output "folder" is no file but a folder'),
        (["--report", os.devnull], "is no file but a device"),
        (["--out", "c", "--figures"], 'go into the folder "c_figures", but a file of that name is there'),
    ],
)
def test_outputs_that_cannot_be(folder, capsys, options, words):
    (folder / "folder").mkdir()
    (folder / "c_figures").write_text("mine")
    assert main(["simulate", "a.toml", *options]) == 2
    err = capsys.readouterr().err
    assert words in err and "a fault in Fieldline" not in err
    assert (folder / "c_figures").read_text() == "mine"


@pytest.mark.parametrize("name", ["", "..", "a\0b", "a\nb", "a\x1b[31m", "x" * 300])
def test_scenarios_that_cannot_be_named(folder, capsys, name):
    assert main(["scenario", "new", name]) == 2
    assert "a fault in Fieldline" not in capsys.readouterr().err
    assert [path.name for path in folder.iterdir()] == ["a.toml"]


@pytest.mark.parametrize(
    "old, new, words",
    [
        ('name = "satellite"', 'name = "a/b"', 'body[0].name must be text without "/"'),
        ('name = "satellite"', 'name = "a\\u0000"', "body[0].name must be text without"),
        (
            'name = "tumble"',
            'name = "\\u001b[31m"',
            'must be text without "/" and without control characters; got the text "?[31m"',
        ),
        ('name = "tumble"', f'name = "{"x" * 101}"', "name must have at most 100 characters; got 101"),
        ("[integrator]", "[integrator]\n[integrator]", "It stands in the file twice"),
        ("seed = 1", "seed = 1\nseed = 2", "It stands in the file twice"),
        ("2026-03-01T", "2026-02-30T", "is there such a day?"),
        ("duration_s = 11400.0", "duration_s = 1e-12", "time.duration_s must be at least 1e-06"),
    ],
)
def test_texts_that_are_refused(old, new, words):
    assert old in TUMBLE
    with pytest.raises(InputError) as refused:
        Scenario.from_toml(TUMBLE.replace(old, new))
    assert words in str(refused.value)


def test_a_step_too_coarse_for_the_orbit_is_refused():
    text = TUMBLE.replace("step_s = 1.0", "step_s = 600.0").replace("output_step_s = 4.0", "output_step_s = 600.0")
    text = text[: text.index("[[body]]")] + '[[body]]\nname = "p"\nkind = "point"\nmass_kg = 1.0\n'
    with pytest.raises(InputError, match=r"step_s is too coarse for an orbit of 56\d\d.* s; a step of 45 s would do"):
        Scenario.from_toml(text).check()
    assert Scenario.from_toml(text).replace(**{"integrator.step_s": 45.0}).check() == []


@pytest.mark.parametrize("seed", [-1, 1.5, "x", True, 2**64])
def test_seeds_that_are_none(seed):
    with pytest.raises(InputError, match="seed must be a whole number from 0"):
        fl.simulate(Scenario.from_toml(TUMBLE), seed=seed)


@pytest.mark.parametrize("scenario", [None, 3, {}, b"a.toml"])
def test_what_is_no_scenario(scenario):
    with pytest.raises(InputError, match="scenario must be a Scenario or the path"):
        fl.simulate(scenario)


@pytest.mark.kernels
@pytest.mark.flight
def test_an_interrupted_run_says_once_what_is_kept(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "law.py").write_text(
        "def stops(t, m, memory, params):\n    if t > 90.0:\n        raise KeyboardInterrupt\n    return [0, 0, 0]\n"
    )
    (tmp_path / "a.toml").write_text(with_law("stops"))
    assert main(["simulate", "a.toml", "--quiet"]) == 130
    err = capsys.readouterr().err
    assert err.startswith("fieldline: interrupted at t = ") and "kept, marked partial: a_run.nc, a_run.html" in err
    assert "nothing" not in err and err.count("\n") == 1


@pytest.mark.parametrize("compiling", [True, False])
def test_ctrl_c_while_the_plant_is_compiled_is_heard_at_once(monkeypatch, compiling):
    """Noted where the loop flies, raised where it is being compiled."""
    assert threading.current_thread() is threading.main_thread()
    monkeypatch.setitem(sys.modules, "fieldline.simulate.loop.fly", SimpleNamespace(fly=SimpleNamespace(is_compiling=compiling)))
    host, raised = SimpleNamespace(error=None), False
    try:
        with noted(host):
            signal.raise_signal(signal.SIGINT)
    except KeyboardInterrupt:
        raised = True
    assert raised == compiling
    assert isinstance(host.error, KeyboardInterrupt)
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_a_coil_beyond_counting_is_refused(capsys):
    coil = ["design", "coil", "--moment-a-m2", "1e300", "--diameter-m", "2.44", "--current-a", "0.1", "--wire", "AWG29"]
    assert main(coil) == 2
    assert "turns; the most is 1e+09. Is a unit wrong?" in capsys.readouterr().err


@pytest.mark.kernels
@pytest.mark.flight
def test_one_event_is_told_as_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    event = '[[event]]\nkind = "user"\nfunction = "at.py:half"\n'
    (tmp_path / "at.py").write_text("def half(t, state, parameters):\n    return [t - 30.5]\n")
    (tmp_path / "a.toml").write_text(TUMBLE.replace("duration_s = 11400.0", "duration_s = 60.0") + event)
    assert main(["simulate", "a.toml"]) == 0
    assert "\n1 event\n" in capsys.readouterr().out


def test_ten_thousand_names_are_compared_in_no_time():
    bodies = (
        f'[[body]]\nname = "p{k}"\nkind = "point"\nmass_kg = 1.0\noffset_o_m = [{k}.0, 0.0, 0.0]\n' for k in range(1, 10_000)
    )
    twice = TUMBLE + "".join(bodies).replace('"p9999"', '"p9998"')
    with pytest.raises(InputError, match=r'body\[9999\].name must be unique; "p9998" is body\[9998\] too'):
        Scenario.from_toml(twice)
