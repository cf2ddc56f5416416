"""What cannot be, or goes wrong, with lines through the whole command: a sentence, exit code 2, and what was flown is kept."""

import numpy as np
import pytest
import xarray as xr

from fieldline.cli import main

pytestmark = [pytest.mark.kernels, pytest.mark.flight]
PAIR = """
name = "pair"
[time]
start_utc = 2026-03-01T00:00:00Z
duration_s = {seconds}
output_step_s = 1.0
[integrator]
{integrator}
[environment]
gravity = "point"
uniform_field_i_tesla = [1e-5, 0.0, 0.0]
[orbit.elements]
altitude_km = {altitude}
inclination_deg = 28.5
[[body]]
name = "low"
kind = "point"
mass_kg = 60.0
[[body]]
name = "high"
kind = "point"
mass_kg = 900.0
offset_o_m = {offset}
[[line]]
name = "rope"
from_body = "low"
to_body = "high"
rest_length_m = {length}
nodes = 4
stiffness_n = 5000.0
damping_n_s = 500.0
mass_per_length_kg_m = 0.004
{line}
"""
USUAL = {
    "seconds": 60.0,
    "integrator": "step_s = 0.05",
    "altitude": 400.0,
    "offset": "[0.0, 0.0, -1000.1]",
    "length": 1000.0,
    "line": "",
}
REEL = "[line.reel]\ntotal_length_m = 2000.0\nshortest_length_m = 900.0\n"
LAW = '[[software]]\nbody = "high"\nlaw = "own.py:law"\ncommands = ["reel"]\ncompiled = false\nrate_hz = 1.0\n'
RADIUS_M, HALF_RAD = 6_469_136.6, np.arccos(1.0 - 11.455 / 6469.1366)  # of two ends 91 km up, whose chord passes near 80 km
AHEAD_M, DOWN_M = RADIUS_M * np.sin(2.0 * HALF_RAD), RADIUS_M * (1.0 - np.cos(2.0 * HALF_RAD))
ACROSS = {
    "altitude": 91.0,
    "offset": f"[{AHEAD_M}, 0.0, {DOWN_M}]",
    "length": 2.0 * RADIUS_M * np.sin(HALF_RAD) + 1.0,
    "integrator": "step_s = 1.0",
}
OWN = """
def law(t, measurement, memory, params):
    return [{}]
"""


WAVED = "[line.start]\nskiprope_amplitude_m = 100.0\n"


@pytest.fixture
def fly(tmp_path, monkeypatch, capsys):
    """Fly a pair in a folder of its own; (exit code, stderr, what was kept or None), never with a traceback."""
    monkeypatch.chdir(tmp_path)

    def run(command="0.0", **changes):
        (tmp_path / "own.py").write_text(OWN.format(command))
        (tmp_path / "pair.toml").write_text(PAIR.format(**USUAL | changes))
        code = main(["simulate", "pair.toml", "--out", "pair", "--quiet"])
        out, err = capsys.readouterr()
        assert "Traceback" not in out + err
        kept = xr.load_dataset("pair.nc") if (tmp_path / "pair.nc").exists() else None
        return code, " ".join(err.split()), kept

    return run


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"length": 400.0, "integrator": "step_s = 0.01"},
            "rest_length_m must be about the distance of its ends: it is 400 m, and they start 1000.1 m apart",
        ),
        (
            {"line": "[[line.stretch]]\nlength_m = 1200.0"},
            "stretch must not be longer together than the line, 1000 m; got 1200 m",
        ),
        ({"integrator": "step_s = 1.0"}, 'may be 0.25 s. Use step_s = 0.2, or method = "rosenbrock", whose step the stiffness'),
        ({"line": REEL.replace("900.0", "-1.0")}, "reel.shortest_length_m must be more than 0; got -1"),
        ({"line": REEL.replace("2000.0", "900.0")}, "reel.total_length_m must be at least what is out, rest_length_m = 1000 m"),
        (
            {"line": REEL + LAW.replace("own.py:law", "reel-exponential") + "parameters = { target_length_m = -5.0 }"},
            "target_length_m",
        ),
        (
            {"line": REEL + LAW.replace("own.py:law", "reel-exponential") + "parameters = { target_length_m = 3000.0 }"},
            "target_length_m",
        ),
    ],
    ids=["short", "parts", "stiff", "negative", "total", "target", "beyond"],
)
def test_what_cannot_be_flown_is_refused_before(fly, changes, words):
    if "reel-exponential" in changes.get("line", ""):
        changes = {"line": changes["line"].replace('commands = ["reel"]\ncompiled = false\n', "")}
    code, err, kept = fly(**changes)
    assert code == 2 and words in err and kept is None, err


@pytest.mark.parametrize(
    ("command", "changes", "words", "until"),
    [
        ("-10.0", {"line": REEL + LAW}, 'the reel on "high" took rope in to shortest_length_m = 900 m at t = 11', 11.0),
        ("20.0", {"line": REEL + LAW}, "paid out all 2000 m of rope (total_length_m) at t = 51", 51.0),
        ("0.0 if t < 30.0 else float('nan')", {"line": REEL + LAW}, "returned a number that is not finite (nan)", 30.0),
        ("0.0 if t < 30.0 else 1.0 / 0.0", {"line": REEL + LAW}, "raised ZeroDivisionError", 30.0),
        ("0.0", ACROSS, 'of line "rope" fell below 80 km', 60.0),
    ],
    ids=["in", "out", "nan", "raises", "ground"],
)
def test_what_goes_wrong_in_flight_is_said_and_what_was_flown_is_kept(fly, command, changes, words, until):
    code, err, kept = fly(command, **changes)
    assert code == 2 and words in err, err
    seconds = kept["seconds"].values
    assert kept.attrs["complete"] == 0 and 0.0 < seconds[-1] <= until + 1.0
    assert len(seconds) == int(seconds[-1]) + 1
    assert np.isfinite(kept["position_i"].values).all()
    assert np.isfinite(kept["tension_rope"].values[:, 0]).all()


def test_a_line_that_is_too_stiff_for_explicit_steps_flies_with_the_method_that_is_told(fly):
    code, err, kept = fly(integrator='method = "rosenbrock"')
    assert code == 0 and kept.attrs["complete"] == 1, err


def test_a_warning_is_told_where_the_run_is_asked_for(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "pair.toml").write_text(PAIR.format(**USUAL | {"seconds": 2.0, "line": WAVED}))
    assert main(["simulate", "pair.toml", "--out", "pair"]) == 0
    assert "warning: line[0].start.skiprope_amplitude_m = 100 m" in " ".join(capsys.readouterr().err.split())
