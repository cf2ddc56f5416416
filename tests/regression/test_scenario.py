"""Scenarios: what is refused and in which words, the templates, the command, the page of keys."""

import json
import re
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

import fieldline as fl
from fieldline.cli import main
from fieldline.control import LAWS
from fieldline.errors import InputError
from fieldline.records.words import tables_of
from fieldline.sensing.sensors import DutyCycle, Magnetometer
from fieldline.simulate.estimators import ESTIMATORS
from fieldline.simulate.scenario import Body, OrbitStart, Scenario, Span
from fieldline.simulate.scenario.schema import json_schema, markdown
from fieldline.simulate.scenario.templates import TEMPLATES, template
from fieldline.simulate.skiprope_laws import HEARING_LAWS
from fieldline.vehicle import Magnetorquer, Vehicle, Wheel

ROOT = Path(__file__).parents[2]
TLE = files("fieldline").joinpath("data", "suchai3.tle").read_text()
DETUMBLE = template("detumble", "cubesat")


def scenario(**changes):
    return Scenario.from_toml(DETUMBLE).replace(**changes)


def pair(**changes):
    return Scenario.from_toml(template("pair", "pair")).replace(**changes)


REFUSED = [
    ({"body.0.mass_kg": -4.0}, "body[0].mass_kg must be more than 0; got -4."),
    ({"body.0.mass_kg": "heavy"}, 'body[0].mass_kg must be a number; got the text "heavy".'),
    ({"body.0.mass_kg": True}, "body[0].mass_kg must be a number; got true."),
    ({"body.0.mass_kg": float("nan")}, "body[0].mass_kg must be a finite number; got nan."),
    ({"body.0.mass_kg": None}, "body[0].mass_kg is missing: mass [kg]."),
    ({"body.0.mas_kg": 4.0}, 'unknown key "body[0].mas_kg"; did you mean "mass_kg"?'),
    ({"body.0.step_s": 4.0}, 'unknown key "body[0].step_s"; step_s belongs in [integrator].'),
    ({"seeds": 4}, 'unknown key "seeds"; did you mean "seed"?'),
    ({"seed": 1.5}, "seed must be a whole number; got 1.5."),
    ({"body.0.inertia_kg_m2": [1.0, 1.0, 3.0]}, "none larger than the sum of the other two"),
    ({"body.0.inertia_kg_m2": [[1.0, 0.1, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]}, "must be symmetric"),
    ({"body.0.inertia_kg_m2": None}, "body[0].inertia_kg_m2 is missing: a rigid body needs it."),
    ({"body.0.inertia_kg_m2": [1.0, 2.0]}, "body[0].inertia_kg_m2 must be three numbers (a diagonal) or three rows"),
    ({"body.0.rate_deg_s": [1.0, 2.0]}, "body[0].rate_deg_s must be three numbers [x, y, z]; got 2 entries."),
    ({"body.0.rate_deg_s": [1.0, "x", 2.0]}, 'body[0].rate_deg_s[1] must be a number; got the text "x".'),
    ({"body.0.kind": "point"}, 'body[0].magnetorquer has no meaning for kind = "point"'),
    ({"body.0.kind": "rigd"}, 'body[0].kind must be "rigid" or "point"; got the text "rigd"; did you mean "rigid"?'),
    ({"body.0.eddy_damping_n_m_s_tesla2": [1.0, 1.0, -1.0]}, "or it would feed energy in"),
    ({"body.0.magnetorquer.1.moment_max_a_m2": 0}, "body[0].magnetorquer[1].moment_max_a_m2 must be more than 0; got 0."),
    (
        {"body.0.magnetorquer.1.axis_b": [0, 0, 0]},
        "body[0].magnetorquer[1].axis_b must be a direction; got a vector of zero length.",
    ),
    (
        {"body.0.magnetorquer.1.quantum_a_m2": 1.0},
        "body[0].magnetorquer[1].quantum_a_m2 must be at most moment_max_a_m2, 0.2; got 1.",
    ),
    ({"body.0.magnetorquer.1.name": "torquer_1"}, 'body[0].magnetorquer[1].name must be unique; "torquer_1"'),
    ({"body.0.duty_cycle.torque_on_s": 2.0}, "body[0].duty_cycle.torque_on_s must be less than period_s, 2"),
    (
        {"body.0.attitude.random": False},
        "body[0].attitude: give exactly one of quaternion_bi, quaternion_bo, euler_321_deg, random",
    ),
    ({"body.0.attitude": {"quaternion_bi": [0, 0, 0, 2]}}, "must be a unit quaternion, scalar last; its length is 2."),
    ({"body.0.random_rate_deg_s": 2.0}, "body[0]: give only one of rate_deg_s and random_rate_deg_s."),
    ({"body.0.offset_o_m": [1, 0, 0]}, "body[0].offset_o_m has no meaning for the first body"),
    ({"body.0.rate_deg_s": [900, 0, 0]}, "at 900 deg/s a step of 0.1 s turns by 90 deg; a step of 0.0064 s would do (body[0])."),
    ({"body.0.wheel": [{"axis_b": [1, 0, 0], "momentum_max_n_m_s": 9, "torque_max_n_m": 1, "momentum_n_m_s": 9}]}, "too coarse"),
    ({"body.0.load": [{"function": "nothing"}]}, 'body[0].load[0].function must name a function as "file.py:function"'),
    ({"orbit": None}, "orbit is missing: say where the first body starts"),
    (
        {"orbit.elements": {"altitude_km": 500, "inclination_deg": 0}},
        "orbit: give exactly one of tle, elements, state, sun_synchronous",
    ),
    (
        {"orbit": {"elements": {"altitude_km": 60, "inclination_deg": 0}}},
        "perigee at 60 km altitude, in the air; an orbit stays above 90 km",
    ),
    ({"orbit": {"elements": {"semi_major_axis_km": 6400, "eccentricity": 0.1, "inclination_deg": 0}}}, "inside the Earth"),
    ({"orbit": {"elements": {"altitude_km": 500000, "inclination_deg": 0, "eccentricity": 0.99}}}, "Is it in metres?"),
    ({"orbit": {"state": {"position_km": [7e6, 0, 0], "velocity_km_s": [0, 7.5, 0]}}}, "Is it in metres?"),
    (
        {"orbit": {"state": {"position_km": [7000, 0, 0], "velocity_km_s": [0, 5.0, 0]}}},
        "velocity_km_s gives an orbit that has its perigee",
    ),
    ({"orbit": {"state": {"position_km": [7000, 0, 0], "velocity_km_s": [0, 7500, 0]}}}, "Is it in metres per second?"),
    ({"time.duration_s": 5.0}, "time: give exactly one of duration_s and duration_orbits; got duration_s and duration_orbits."),
    ({"time.duration_orbits": None}, "time: give exactly one of duration_s and duration_orbits; got neither."),
    (
        {"time.start_utc": "yesterday"},
        'time.start_utc must be a date and time in UTC, such as 2026-03-01T00:00:00Z; got "yesterday".',
    ),
    ({"time.start_utc": 2026}, "time.start_utc must be a date and time in UTC"),
    ({"time.start_utc": "2040-01-01"}, "IGRF-14 covers 1900 to 2030"),
    ({"integrator.method": "euler"}, 'integrator.method must be "rk4" or "dop853" or "rosenbrock"; got the text "euler".'),
    ({"environment.field": "IGRF14b"}, 'unknown field model "IGRF14b"; did you mean "IGRF-14"?'),
    ({"environment.field_degree": 14}, "degree must be a whole number from 1 to 13 for IGRF-14; got 14."),
    ({"environment.uniform_field_i_tesla": [30000, 0, 0]}, "Is it in nT?"),
    ({"environment.gravity_degree": 8}, 'environment.gravity_degree has no meaning for gravity = "j2"; choose "harmonic".'),
    ({"environment.atmosphere": None}, "body[0].drag needs air"),
    ({"environment.atmosphere.model": "msis"}, 'environment.atmosphere.f107 is missing: model = "msis" needs it.'),
    ({"environment.atmosphere.ap": 4}, 'environment.atmosphere.ap has no meaning for model = "layered"'),
    ({"software.0.body": "cubsat"}, 'software[0].body names no [[body]]: "cubsat"; did you mean "cubesat"?'),
    ({"software.0.delay_s": 2.0}, "software[0].delay_s must be less than the period of a call, 2 s; got 2."),
    ({"software.0.commands": ["dipole"]}, "software[0].commands has a meaning for a law of your own alone"),
    ({"software.0.law": "laws.py:mine"}, "software[0].commands is missing: a law of your own says what it returns"),
    (
        {"software.0.law": "laws.py:mine", "software.0.commands": ["thrust"]},
        'has "thrust", but body "cubesat" has no [[body.thruster]]',
    ),
    (
        {"software.0.law": "laws.py:mine", "software.0.commands": ["wheel_torque", "dipole"]},
        "must be in the order dipole, wheel_torque",
    ),
    ({"event": [{"kind": "altitude"}]}, 'event[0].altitude_km is missing: kind = "altitude" needs it.'),
    ({"event": [{"kind": "eclipse", "rate_deg_s": 1}]}, 'event[0].rate_deg_s has no meaning for kind = "eclipse"; leave it out.'),
    ({"event": [{"kind": "eclipse"}, {"kind": "eclipse"}]}, 'event[1].name must be unique; "eclipse" is event[0] too.'),
    ({"body": []}, "body must not be empty; got []."),
    ({"body": 3}, "body must be a list of tables, each begun with [[body]]; got 3."),
    ({"body.0.magnetometer": 3}, "body[0].magnetometer must be a table of keys and values; got 3."),
]


@pytest.mark.parametrize(("changes", "words"), REFUSED, ids=lambda one: ",".join(one)[:60] if isinstance(one, dict) else "")
def test_what_is_refused_and_in_which_words(changes, words):
    with pytest.raises(InputError) as refused:
        scenario(**changes)
    assert words in str(refused.value)


PAIRS_REFUSED = [
    ({"line.0.to_body": "prob"}, 'line[0].to_body names no [[body]]: "prob"; did you mean "probe"?'),
    ({"line.0.to_body": "satellite"}, "line[0].to_body must be another body than from_body."),
    ({"line.0.stiffness_n": 0}, "line[0].stiffness_n must be more than 0; got 0."),
    ({"body.1.name": "satellite"}, 'body[1].name must be unique; "satellite" is body[0] too.'),
    ({"body.1.offset_o_m": None}, "body[1].offset_rate_o_m_s has a meaning beside offset_o_m alone"),
    ({"body.1.offset_o_m": None, "body.1.offset_rate_o_m_s": None}, "body[1] has no start: give offset_o_m"),
    ({"body.1.rate_deg_s": [1, 0, 0]}, 'body[1].rate_deg_s has no meaning for kind = "point"; leave it out.'),
    ({"software": [{"law": "b-dot"}]}, "software[0].body is missing: which of satellite, probe?"),
    ({"software": [{"law": "b-dot", "body": "probe"}]}, 'software[0].body names "probe", a point mass'),
    (
        {"event": [{"kind": "rate", "rate_deg_s": 1, "body": "probe"}]},
        "event[0].body is a point mass, which has no angular rate.",
    ),
]


@pytest.mark.parametrize(("changes", "words"), PAIRS_REFUSED)
def test_what_two_bodies_are_refused_for(changes, words):
    with pytest.raises(InputError) as refused:
        pair(**{"body.1.offset_rate_o_m_s": [0.0, 0.0, 0.1], **changes})
    assert words in str(refused.value)


def test_every_problem_is_told_at_once():
    changes = {"body.0.mass_kg": -1, "body.0.colour": "red", "time.start_utc": "soon", "software.0.rate_hz": 0, "seed": "x"}
    with pytest.raises(InputError) as refused:
        scenario(**changes)
    first, *rest = str(refused.value).splitlines()
    assert first == "cubesat has 5 problems:" and len(rest) == 5


def test_records_made_in_python_are_refused_in_the_same_words():
    with pytest.raises(InputError, match=r"^Magnetorquer: moment_max_a_m2 must be more than 0; got -1\.$"):
        Magnetorquer(axis_b=[1, 0, 0], moment_max_a_m2=-1)
    with pytest.raises(InputError, match=r'^Wheel: unknown key "torque_max"; did you mean "torque_max_n_m"\?$'):
        Wheel(axis_b=[1, 0, 0], momentum_max_n_m_s=1, torque_max_n_m=1, torque_max=1)
    with pytest.raises(InputError, match=r"^DutyCycle takes its keys by name, for example DutyCycle\(period_s=\.\.\.\)"):
        DutyCycle(2.0, 1.0)
    with pytest.raises(Exception, match="frozen"):
        Magnetometer(rate_hz=1).rate_hz = 2.0


def test_records_and_arrays_make_a_scenario():
    body = Body(name="a", mass_kg=np.float64(2), inertia_kg_m2=np.diag([1.0, 1.0, 1.0]), rate_deg_s=np.ones(3))
    orbit = OrbitStart.from_dict({"elements": {"altitude_km": 500, "inclination_deg": 51}})
    made = fl.Scenario(time=Span(start_utc=np.datetime64("2026-03-01"), duration_s=10), orbit=orbit, body=[body])
    assert made.body[0].mass_kg == 2.0 and made.time.start_utc == "2026-03-01T00:00:00Z"
    assert made.time.start == np.datetime64("2026-03-01", "ns")
    assert Scenario.from_toml(made.to_toml()) == made


@pytest.mark.parametrize(
    "given", ["2026-03-01T12:30:00Z", "2026-03-01T14:30:00+02:00", "2026-03-01 12:30", np.datetime64("2026-03-01T12:30")]
)
def test_times_are_utc(given):
    assert Span(start_utc=given, duration_s=60).start == np.datetime64("2026-03-01T12:30", "ns")


def test_a_toml_time_with_fractions_is_kept():
    text = DETUMBLE.replace("2026-03-01T00:00:00Z", "2026-03-01T00:00:00.123456Z")
    read = Scenario.from_toml(text)
    assert read.time.start == np.datetime64("2026-03-01T00:00:00.123456", "ns")
    assert Scenario.from_toml(read.to_toml()) == read


SLIPS = [
    ("seed = 1", "seed 1", "line 4: Expected '=' after a key in a key/value pair, in \"seed 1\""),
    ("[time]", "[time", "A table is written [name] or [[name]]."),
    ('gravity = "j2"', "gravity = j2", 'Text stands in quotes: gravity = "j2".'),
    ("[5.0, -5.0, 5.0]", "[5.0 -5.0 5.0]", "Numbers of a list are parted by commas: [1.0, 2.0, 3.0]."),
    ("step_s = 0.5 ", "step_s = .5 ", "A decimal has digits on both sides of its point: 0.5, 2.0."),
    ("seed = 1", "seed = True", "Truth is true or false, in lower case."),
    ("phase_s = 2.0\n", "phase_s = [2.0,", "Is a quote, bracket or value missing at its end?"),
    ("seed = 1", "seed = 1\nseed = 2", "Cannot overwrite a value"),
]


@pytest.mark.parametrize(("right", "wrong", "words"), SLIPS)
def test_a_slip_in_the_syntax_is_told_with_its_line(right, wrong, words):
    assert right in DETUMBLE
    with pytest.raises(InputError) as refused:
        Scenario.from_toml(DETUMBLE.replace(right, wrong, 1), source="cubesat.toml")
    text = str(refused.value)
    assert text.startswith("cubesat.toml") and words in text


@pytest.mark.parametrize("name", sorted(TEMPLATES))
def test_templates_are_complete_and_without_warning(name):
    read = Scenario.from_toml(template(name, name))
    assert read.check() == []
    assert read.name == name and read.description
    assert template(name, name).count("#") >= 2


def test_templates_are_the_files():
    found = {path.name for path in (ROOT / "src" / "fieldline" / "data").glob("scenario_*.toml")}
    assert found == {f"scenario_{name}.toml" for name in TEMPLATES}
    with pytest.raises(InputError, match='unknown template "detumbel"; did you mean "detumble"'):
        template("detumbel", "x")


def test_laws_of_templates_are_of_the_library():
    laws = {task.law for name in TEMPLATES for task in Scenario.from_toml(template(name, name)).software}
    assert len(laws) >= 7 and laws <= {*LAWS, *ESTIMATORS, *HEARING_LAWS}


CHECKED = [
    ({"software.0.law": "b-dott"}, 'software[0].law: unknown law "b-dott"; did you mean "b-dot"?'),
    (
        {"software.0.parameters": {"gain": 1.0}},
        'software[0].parameters.gain: "b-dot" has no such parameter; did you mean "gain_n_m_s"?',
    ),
    ({"software.0.law": "wheel-pointing"}, 'has "wheel_torque", but body "cubesat" has no [[body.wheel]].'),
    ({"software.0.law": "none.py:f", "software.0.commands": ["dipole"]}, 'the Python file "none.py" does not exist.'),
    ({"software.0.law": "mine.py:g", "software.0.commands": ["dipole"]}, '"mine.py" defines no g'),
    ({"software.0.law": "slip.py:f", "software.0.commands": ["dipole"]}, '"slip.py" is no Python'),
    ({"software.0.law": "no_such_module:f", "software.0.commands": ["dipole"]}, 'no module "no_such_module" is installed'),
    ({"orbit": {"tle": "none.tle"}}, 'orbit: the orbit file "none.tle" does not exist.'),
    ({"orbit": {"tle": TLE}}, "days after the nearest element epoch"),
    ({"time.start_utc": "2029-12-31T23:00:00Z"}, "the run ends outside the field model"),
    ({"environment.earth_orientation": "none.txt"}, "does not exist"),
    ({"time.output_step_s": 1e6}, "time.output_step_s must be at most the run's"),
]


@pytest.mark.parametrize(("changes", "words"), CHECKED)
def test_what_files_laws_and_models_refuse(changes, words, tmp_path, monkeypatch):
    (tmp_path / "mine.py").write_text("def f(t, measurement, memory, params):\n    return [0.0, 0.0, 0.0]\n")
    (tmp_path / "slip.py").write_text("def f(:\n")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError) as refused:
        scenario(**changes).check()
    assert words in str(refused.value)


def test_files_are_looked_for_beside_the_scenario(tmp_path):
    (tmp_path / "mine.py").write_text("def f(t, measurement, memory, params):\n    return [0.0, 0.0, 0.0]\n")
    (tmp_path / "sat.tle").write_text(TLE)
    text = DETUMBLE.replace('law = "b-dot" ', 'law = "mine.py:f"\ncommands = ["dipole"]\n').replace("2026-03-01", "2023-08-24")
    text = re.sub(r"\[orbit\.sun_synchronous\]\n.*\n.*\n", '[orbit]\ntle = "sat.tle"\n', text)
    (tmp_path / "cubesat.toml").write_text(text)
    read = Scenario.read(tmp_path / "cubesat.toml")
    assert read.check() == [] and read.folder == tmp_path
    assert read.replace(seed=2).check() == []


def test_a_step_that_is_rather_coarse_is_a_warning():
    (warning,) = scenario(**{"body.0.rate_deg_s": [100.0, 0.0, 0.0]}).check()
    assert "at 100 deg/s a step of 0.1 s turns by 10 deg; a step of 0.057 s keeps a day's error small (body[0])." in warning
    assert scenario(**{"body.0.rate_deg_s": [100.0, 0.0, 0.0], "integrator.step_s": 0.057}).check() == []


def test_two_tasks_that_command_the_same_actuators_are_warned_of():
    text = template("detumble", "cubesat")
    block = text[text.index("[[software]]") :]
    block = block[: block.index("\n[", 1)] if "\n[" in block[1:] else block
    name = Scenario.from_toml(text).body[0].name
    again = block.replace("[[software]]", '[[software]]\nname = "again"')
    (warning,) = Scenario.from_toml(text + "\n" + again).check()
    assert warning == f'software[0] and software[1] all command "dipole" of "{name}": who was called last is obeyed.'


def test_readings_shorten_the_step():
    fast = {"body.0.rate_deg_s": [500.0, 0.0, 0.0], "body.0.magnetometer.rate_hz": 100.0}
    assert scenario(**fast).check() == []  # steps end at each reading


def test_a_path_that_leads_nowhere_is_told():
    with pytest.raises(InputError, match=r'"body.3.mass_kg" leads nowhere: "3" is asked of a list of 1, counted from 0'):
        scenario(**{"body.3.mass_kg": 1.0})
    with pytest.raises(InputError, match=r'"seed\.x" leads nowhere'):
        scenario(**{"seed.x": 1.0})


def test_the_digest_is_of_the_text():
    import hashlib

    read = Scenario.from_toml(DETUMBLE)
    assert read.sha256 == hashlib.sha256(DETUMBLE.encode()).hexdigest()
    assert read.replace(seed=9).sha256 != read.replace(seed=8).sha256


def test_tensors_are_diagonals_or_rows():
    made = Vehicle(name="a", mass_kg=1, inertia_kg_m2=[3, 4, 5], induced_dipole_a_m2_tesla=[[1, 2, 3], [2, 4, 5], [3, 5, 6]])
    assert made.inertia_kg_m2 == ((3.0, 0.0, 0.0), (0.0, 4.0, 0.0), (0.0, 0.0, 5.0))
    assert made.induced_dipole_a_m2_tesla[1] == (2.0, 4.0, 5.0)
    assert Magnetometer(rate_hz=1, noise_std_nt=3).noise_std_nt == (3.0, 3.0, 3.0)


def test_every_key_is_described_with_its_unit():
    units = {"s", "m", "km", "kg", "n", "hz", "deg", "rad", "tesla", "nt", "m2", "m3", "a", "h", "arcsec"}
    for path, model in tables_of(Scenario):
        assert model.__doc__, path
        for name, field in model.model_fields.items():
            assert field.description, f"{path} {name}"
            if "float" in str(field.annotation) and name.split("_")[-1] in units:
                assert re.search(r"\[[^\]]+\]|altitude_km|duration|orbits", field.description), (
                    f"{path} {name}: {field.description}"
                )


def test_the_page_tells_every_key():
    page = (ROOT / "docs" / "scenario.md").read_text(encoding="utf-8")
    assert page.endswith(markdown()), "write it anew: fieldline scenario schema --markdown"


def test_the_messages_on_the_page_are_what_is_said():
    page = (ROOT / "docs" / "scenario.md").read_text(encoding="utf-8")
    told = re.search(r"```text\nfieldline: (cubesat\.toml has 3 problems:\n.*?)```", page, re.DOTALL)[1]
    wrong = DETUMBLE.replace("mass_kg = 4.0", "mass_kg = 4.0\nmas_kg = 4.0").replace("0.036, 0.0067]", "0.036, 0.67]")
    head, tail = wrong.split("moment_max_a_m2 = 0.2 },\n", 1)
    wrong = head + "moment_max_a_m2 = 0.2 },\n" + tail.replace("moment_max_a_m2 = 0.2", "moment_max_a_m2 = -0.2", 1)
    with pytest.raises(InputError) as refused:
        Scenario.from_toml(wrong, source="cubesat.toml")
    assert str(refused.value) == told.strip()


def test_the_json_schema_holds_every_table_and_refuses_unknown_keys():
    schema = json_schema()
    assert schema["additionalProperties"] is False and {"time", "body"} <= set(schema["required"])
    assert {"Body", "Magnetorquer", "Wheel", "Software", "TetherLine"} <= set(schema["$defs"])
    json.dumps(schema)


def test_the_command_begins_checks_and_explains(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in TEMPLATES:
        assert main(["scenario", "new", name, "--template", name]) == 0
        assert main(["scenario", "check", f"{name}.toml"]) == 0
    shown = capsys.readouterr()
    assert "wrote detumble.toml" in shown.out and "gravity gradient, residual dipole" in shown.out and shown.err == ""
    assert main(["scenario", "new", "detumble"]) == 2 and "exists already" in capsys.readouterr().err
    assert main(["scenario", "new"]) == 2 and "needs a NAME" in capsys.readouterr().err
    assert main(["scenario", "new", "--list"]) == 0 and "picosatellite" in capsys.readouterr().out
    assert main(["scenario", "schema"]) == 0 and json.loads(capsys.readouterr().out)["title"] == "Scenario"
    assert main(["scenario", "schema", "--markdown"]) == 0 and capsys.readouterr().out == markdown()


def test_the_command_tells_all_problems_and_leaves_with_2(tmp_path, capsys):
    (tmp_path / "bad.toml").write_text(DETUMBLE.replace("mass_kg = 4.0", "mass_kg = -4.0").replace("seed = 1", "sed = 1"))
    assert main(["scenario", "check", str(tmp_path / "bad.toml")]) == 2
    err = capsys.readouterr().err
    assert "bad.toml has 2 problems:" in err and "body[0].mass_kg" in err and 'did you mean "seed"' in err
    assert main(["scenario", "check", str(tmp_path / "none.toml")]) == 2
    assert "does not exist" in capsys.readouterr().err


def test_a_name_with_quotes_is_kept(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["scenario", "new", 'my "own" one']) == 0
    assert Scenario.read(tmp_path / 'my "own" one.toml').name == 'my "own" one'


@pytest.mark.parametrize("code", ["import fieldline", "from fieldline.cli import main; main(['scenario', '--help'])"])
def test_the_records_are_loaded_where_they_are_used(code):
    tail = "\nimport sys; print('fieldline.records' in sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code + tail], capture_output=True, text=True, check=True, timeout=60)
    assert done.stderr.strip() == "False"
