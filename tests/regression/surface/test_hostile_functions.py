"""Laws, loads and events of the user's own that do everything wrong: a sentence, exit code 2, and no file lost."""

import json

import pytest

from fieldline.cli import main
from simulated_runs import TUMBLE

FUNCTIONS = """
import numpy as np
from numba import njit


class Dumb(Exception):
    def __str__(self):
        raise RuntimeError("no words")


def dumb(t, measurement, memory, params):
    raise Dumb


def loud(t, measurement, memory, params):
    raise ValueError("first\\nsecond \\x1b[31m" + "x" * 5000)


def imaginary(t, measurement, memory, params):
    return np.array([1j, 0.0, 0.0])


def forger(t, measurement, memory, params):
    measurement.field_b[:] = 0.0
    return [0.0, 0.0, 0.0]


def lonely(t, measurement, memory, params):
    return 1.0


def leaves(t, measurement, memory, params):
    raise SystemExit(0)


def prints(t, measurement, memory, params):
    print("hello")
    return [0.0, 0.0, 0.0]


def imports(t, measurement, memory, params):
    import os

    return np.zeros(3)


def short(t, measurement):
    return np.zeros(3)


def asks_too_much(t, measurement, memory, params):
    return measurement.temperature


class Callable:
    def __call__(self, t, measurement, memory, params):
        return np.zeros(3)


an_object = Callable()


def nowhere(t, measurement, memory, params):
    return [0.0] * 7


def nowhere_compiled(t, measurement, memory, params):
    return np.zeros(7)


def mover(t, state, params):
    state[:] = 0.0
    return np.zeros(6)


@njit
def narrow(t, state):
    return np.zeros(6)
"""
SHORT = TUMBLE.replace("duration_s = 11400.0", "duration_s = 60.0")
TORQUER = "magnetorquer = [{ axis_b = [0.0, 1.0, 0.0], moment_max_a_m2 = 0.2 }]\n"


def law(name: str, compiled: bool, file: str = "user.py") -> str:
    task = f'[[software]]\nlaw = "{file}:{name}"\nrate_hz = 1.0\ncommands = ["dipole"]\ncompiled = {str(compiled).lower()}\n'
    return SHORT + TORQUER + task


@pytest.fixture
def fly(tmp_path, monkeypatch, capsys):
    """Fly a scenario in a folder of its own; (exit code, stdout, stderr), never with a traceback."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "user.py").write_text(FUNCTIONS)

    def run(text: str, *options: str):
        (tmp_path / "a.toml").write_text(text)
        code = main(["simulate", "a.toml", "--out", "a", *options])
        out, err = capsys.readouterr()
        assert "Traceback" not in err
        return code, out, err

    return run


@pytest.mark.kernels
@pytest.mark.flight
@pytest.mark.parametrize(
    "name, words",
    [
        ("dumb", "raised Dumb. Mend the law"),
        ("loud", "raised ValueError: first second ?[31mxxx"),
        ("imaginary", "it returned complex numbers"),
        ("forger", "assignment destination is read-only"),
        ("lonely", "returned 1 number where 3 are expected (dipole)"),
        ("leaves", "raised SystemExit: 0"),
    ],
)
def test_plain_laws_that_misbehave(fly, tmp_path, name, words):
    code, out, err = fly(law(name, compiled=False), "--quiet")
    assert (code, out) == (2, "")
    assert words in err and "t = 0 s" in err and err.endswith("Nothing was written.\n")
    assert "\x1b" not in err and len(err) < 1000
    assert not (tmp_path / "a.nc").exists()


@pytest.mark.parametrize(
    "name, words",
    [
        ("imports", "unsupported opcode (IMPORT_NAME)"),
        ("short", "function takes 2 arguments. It is called with 4 arguments"),
        ("asks_too_much", "Unknown attribute 'temperature'"),
        ("an_object", "is not a function"),
    ],
)
def test_laws_that_numba_cannot_compile(fly, name, words):
    code, out, err = fly(law(name, compiled=True), "--quiet")
    assert (code, out) == (2, "")
    assert f'software[0] "user.py:{name}" cannot be compiled by Numba' in err and words in err and "compiled = false" in err


@pytest.mark.kernels
@pytest.mark.flight
@pytest.mark.parametrize(
    "table, words",
    [
        ('load = [{ function = "user.py:mover" }]\n', 'load "user.py:mover" of body "satellite" raised ValueError: assignment'),
        ('load = [{ function = "user.py:narrow" }]\n', "arguments"),
        ('[[event]]\nkind = "user"\nfunction = "user.py:mover"\n', 'event "user" (user.py:mover) raised ValueError: assignment'),
    ],
)
def test_loads_and_events_that_misbehave(fly, table, words):
    code, _, err = fly(SHORT + table, "--quiet")
    assert code == 2 and words in err


@pytest.mark.kernels
@pytest.mark.flight
@pytest.mark.parametrize(("name", "compiled"), [("nowhere", "false"), ("nowhere_compiled", "true")])
def test_an_estimator_that_gives_no_attitude(fly, name, compiled):
    task = f'[[software]]\nlaw = "user.py:{name}"\nrole = "estimator"\nrate_hz = 1.0\ncompiled = {compiled}\n'
    code, _, err = fly(SHORT + task, "--quiet")
    assert code == 2 and "returned a q_bi that is no unit quaternion (0, 0, 0, 0). Scale it" in err


def test_a_file_that_ends_the_process_as_it_is_loaded(fly, tmp_path):
    (tmp_path / "ends.py").write_text(
        "import sys\ndef fine(t, measurement, memory, params):\n    return [0, 0, 0]\nsys.exit(0)\n"
    )
    code, _, err = fly(law("fine", compiled=False, file="ends.py"), "--quiet")
    assert code == 2 and "names ends.py, which fails as it is loaded: SystemExit: 0" in err


@pytest.mark.kernels
@pytest.mark.flight
def test_what_a_law_prints_is_no_result(fly):
    code, out, err = fly(law("prints", compiled=False), "--json")
    assert code == 0 and json.loads(out)["complete"] is True and "hello" in err


def test_a_law_is_not_replaced_by_the_report(fly, tmp_path):
    code, _, err = fly(law("prints", compiled=False), "--report", "user.py")
    assert code == 2 and 'the output "user.py" would replace an input' in err
    assert (tmp_path / "user.py").read_text() == FUNCTIONS
