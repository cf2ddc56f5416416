"""Records of heat, circuit and plasma: what they refuse, and in which words."""

import pytest

from fieldline.errors import InputError
from fieldline.simulate.scenario import Scenario
from fieldline.simulate.scenario.plasma import Plasma
from fieldline.vehicle import LineCircuit, LineHeat

WIRE = {"resistance_ohm_per_m": 0.1}


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"mode": "profile"}, "current_a is needed"),
        ({"mode": "profile", "current_a": 1.0, "commanded": True}, "one of them"),
        ({"mode": "profile", "times_s": [0.0, 1.0], "currents_a": [1.0]}, "as many numbers as times_s"),
        ({"mode": "profile", "times_s": [1.0, 0.0], "currents_a": [1.0, 2.0]}, "must rise"),
        ({"mode": "profile", "current_a": 1.0, "fractions": [0.0, 2.0], "shares": [1.0, 1.0]}, "within 0 and 1"),
        ({"mode": "profile", "current_a": 1.0, "load_ohm": 3.0}, 'load_ohm has no meaning for mode = "profile"'),
        ({"mode": "series"}, "resistance_ohm_per_m must be more than zero"),
        ({"mode": "series", **WIRE, "cathode": "to"}, "cathode has no meaning"),
        ({"mode": "series", **WIRE, "collector_radius_m": [-1.0, 0.0]}, "no negative number"),
        ({"mode": "bare", **WIRE, "current_a": 1.0}, "current_a has no meaning"),
        ({"mode": "bare", **WIRE, "cathode_drop_volt": 1.0}, "cathode_drop_v"),
    ],
)
def test_circuits(keys, words):
    with pytest.raises(InputError) as refused:
        LineCircuit(**keys)
    assert words in str(refused.value)


def test_heat():
    with pytest.raises(InputError, match="emissivity"):
        LineHeat(absorptivity=0.5, specific_heat_j_kg_k=900.0)
    assert LineHeat(absorptivity=0.5, emissivity=0.8, specific_heat_j_kg_k=900.0).expansion_1_k == 0.0


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"model": "constant"}, "density_m3 is missing"),
        ({"model": "chapman", "density_m3": 1e11}, "density_m3 has no meaning"),
        ({"model": "table", "altitudes_km": [300.0], "day_m3": [1e11]}, "two heights"),
        ({"model": "table", "altitudes_km": [300.0, 200.0], "day_m3": [1e11, 1e11]}, "must rise"),
    ],
)
def test_plasma(keys, words):
    with pytest.raises(InputError) as refused:
        Plasma(**keys)
    assert words in str(refused.value)


def scenario(plasma="none", **line):
    """Two points on a line."""
    usual = {"from_body": "a", "to_body": "b", "rest_length_m": 100.0, "stiffness_n": 10.0}
    bodies = [{"name": "a", "kind": "point", "mass_kg": 1.0}]
    bodies.append({"name": "b", "kind": "point", "mass_kg": 1.0, "offset_o_m": (0.0, 0.0, 100.0)})
    return Scenario.from_dict(
        {
            "time": {"start_utc": "2026-03-01T00:00:00Z", "duration_s": 10.0, "output_step_s": 1.0},
            "environment": {"plasma": {"model": plasma}},
            "orbit": {"elements": {"altitude_km": 500.0, "inclination_deg": 51.6}},
            "integrator": {"step_s": 0.2},
            "body": bodies,
            "line": [usual | line],
        }
    )


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ({"circuit": {"mode": "bare", **WIRE}, "diameter_m": 0.01}, "[environment.plasma]"),
        ({"circuit": {"mode": "series", **WIRE, "collector_radius_m": [0.0, 1.0]}}, "[environment.plasma]"),
        ({"circuit": {"mode": "bare", **WIRE}}, "diameter_m"),
        ({"heat": {"absorptivity": 0.5, "emissivity": 0.5, "specific_heat_j_kg_k": 900.0}}, "mass_per_length_kg_m"),
    ],
)
def test_what_a_line_needs(line, words):
    with pytest.raises(InputError) as refused:
        scenario(**line)
    assert words in str(refused.value)


def test_a_law_needs_a_circuit_that_listens():
    made = scenario("chapman", circuit={"mode": "series", **WIRE}).to_dict()
    made["software"] = [{"law": "user_functions:ramp", "compiled": False, "commands": ["current"], "rate_hz": 1.0, "body": "b"}]
    with pytest.raises(InputError, match="point mass, which has nothing to command"):
        Scenario.from_dict(made)
    made["line"][0]["circuit"]["commanded"] = True
    assert Scenario.from_dict(made).line[0].circuit.commanded


REEL = {"nodes": 4, "mass_per_length_kg_m": 0.01}


@pytest.mark.parametrize(
    ("line", "words"),
    [
        (REEL | {"reel": {"total_length_m": 300.0, "shortest_length_m": 150.0}}, "reel.shortest_length_m must be at most"),
        (REEL | {"reel": {"total_length_m": 200.0}}, "leaves 1 kg of line on the reel"),
        (
            REEL | {"reel": {"total_length_m": 150.0}, "stretch": [{"length_m": 140.0, "mass_per_length_kg_m": 0.03}]},
            "leaves 1.3 kg of line on the reel",
        ),
    ],
)
def test_reels(line, words):
    with pytest.raises(InputError) as refused:
        scenario(**line)
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ({"reel": {"total_length_m": 150.0, "rate_m_s": -30.0}}, "reel.rate_m_s must be within rate_max_m_s = 20 m/s"),
        ({"reel": {"total_length_m": 150.0, "mode": "tension", "tension_n": 1500.0}}, "tension_n must be at most tension_max_n"),
        ({"from_joint_damping_n_m_s": 1.0}, 'line[0].from_joint_damping_n_m_s: acts on "a", a point mass'),
        ({"to_joint_damping_n_m_s": 1.0}, 'line[0].to_joint_damping_n_m_s: acts on "b", a point mass'),
        (
            {"circuit": {"mode": "series", **WIRE, "temperature_coefficient_1_k": 0.004}},
            "temperature_coefficient_1_k needs [line.heat]",
        ),
        (
            REEL
            | {"diameter_m": 1e-3}
            | {
                "heat": {
                    "absorptivity": 0.5,
                    "emissivity": 0.5,
                    "specific_heat_j_kg_k": 900.0,
                    "expansion_1_k": -1e-3,
                    "start_temperature_k": 1500.0,
                }
            },
            "heat.expansion_1_k: makes the line -0.207 times as long",
        ),
    ],
)
def test_keys_that_cannot_do_what_they_say(line, words):
    with pytest.raises(InputError) as refused:
        scenario(**line)
    assert words in str(refused.value)


def test_a_line_whose_ends_are_in_one_place():
    with pytest.raises(InputError, match=r"line\[0\].*both ends in the same place"):
        scenario().replace(**{"body.1.offset_o_m": [0.0, 0.0, 0.0]}).check()


def test_a_reel_that_its_body_can_bear():
    assert scenario(**REEL, reel={"total_length_m": 199.0}).line[0].mass_on_reel_kg == pytest.approx(0.99)


def test_a_skiprope_that_throws_the_ends_together_is_warned_of():
    (warning,) = scenario(**REEL, start={"skiprope_amplitude_m": 10.0}).check()
    assert "skiprope_amplitude_m = 10 m" in warning and "falls slack" in warning
    assert scenario(**REEL, start={"skiprope_amplitude_m": 0.1}).check() == []


def test_a_body_below_the_ground():
    deep = scenario().replace(**{"body.1.offset_o_m": [0.0, 0.0, 6e5], "line.0.rest_length_m": 6e5})
    with pytest.raises(InputError, match=r'body\[1\].*"b" starts 100 km below the ground: mend its orbit or offset_o_m'):
        deep.check()


def test_the_summary_tells_how_a_line_begins():
    from fieldline.simulate.scenario.summary import summary

    begun = scenario(**REEL, start={"skiprope_amplitude_m": 0.1, "skiprope_sense": "left-handed"})
    assert "4 nodes, skiprope 0.1 m left-handed" in summary(begun)
    hung = begun.replace(**{"body.1.offset_o_m": None, "body.1.hang": {"in_plane_deg": 20.0, "in_plane_rate_deg_s": 0.01}})
    assert "hanging downwards, 20 deg in the plane, 0 deg across it, swinging" in summary(hung)
