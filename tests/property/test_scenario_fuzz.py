"""Whatever is done to a scenario file, it is read or refused in words; what is read can be written and read again."""

import copy
import math
import tomllib

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from fieldline.errors import InputError
from fieldline.simulate.scenario import Scenario
from fieldline.simulate.scenario.summary import summary
from fieldline.simulate.scenario.templates import TEMPLATES, template
from fieldline.simulate.scenario.toml import parse, written

TEXTS = {name: template(name, name) for name in TEMPLATES}
quick = settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])

numbers = st.one_of(st.integers(), st.floats(), st.sampled_from([0, -1, 1e-320, 1e308, -1e308, 10**400, math.nan, math.inf]))
scalars = st.one_of(
    numbers, st.booleans(), st.none(), st.text(max_size=8), st.sampled_from(["gcrs", "rk4", "a.py:f", "2026-01-01"])
)
junk = st.recursive(
    scalars,
    lambda inner: st.one_of(st.lists(inner, max_size=4), st.dictionaries(st.text(max_size=6), inner, max_size=3)),
    max_leaves=6,
)


def leaves(value, path=()):
    """Paths of everything in nested tables."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        yield (*path, key)
        yield from leaves(inner, (*path, key))


def put(table, path, value):
    changed = copy.deepcopy(table)
    here = changed
    for key in path[:-1]:
        here = here[key]
    here[path[-1]] = value
    return changed


def read_or_refused(make):
    """The scenario, or None where it was refused in words that a person can read."""
    try:
        return make()
    except InputError as error:
        text = str(error)
        assert all(line.isprintable() for line in text.splitlines()) and text
        assert "pydantic" not in text and "Traceback" not in text and "Value error" not in text
        assert len(text) < 20_000
        return None


@quick
@given(name=st.sampled_from(sorted(TEXTS)), data=st.data())
def test_values_replaced_by_junk(name, data):
    table = tomllib.loads(TEXTS[name])
    for _ in range(data.draw(st.integers(1, 3))):
        path = data.draw(st.sampled_from(list(leaves(table))))
        table = put(table, path, data.draw(junk))
    scenario = read_or_refused(lambda: Scenario.from_dict(table, "fuzz.toml"))
    if scenario is not None:
        assert Scenario.from_toml(scenario.to_toml()) == scenario
        read_or_refused(lambda: (scenario.check(), summary(scenario)))


@quick
@given(name=st.sampled_from(sorted(TEXTS)), data=st.data())
def test_text_cut_doubled_and_scribbled_on(name, data):
    text = TEXTS[name]
    for _ in range(data.draw(st.integers(1, 3))):
        a, b = sorted(data.draw(st.tuples(st.integers(0, len(text)), st.integers(0, len(text)))))
        b = min(b, a + data.draw(st.sampled_from([0, 1, 5, 200])))
        text = text[:a] + data.draw(st.one_of(st.text(max_size=5), st.just(text[a:b] * 2), st.just(""))) + text[b:]
    read_or_refused(lambda: Scenario.from_toml(text, source="fuzz.toml"))


@quick
@given(name=st.sampled_from(sorted(TEXTS)), data=st.data())
def test_misspelt_keys_are_told_with_the_right_one(name, data):
    table = tomllib.loads(TEXTS[name])
    key = data.draw(st.sampled_from(sorted(table["body"][0])))
    place = data.draw(st.integers(0, len(key)))
    wrong = key[:place] + "q" + key[place:]
    table["body"][0][wrong] = table["body"][0].pop(key)
    with pytest.raises(InputError) as refused:
        Scenario.from_dict(table, "fuzz.toml")
    assert f'unknown key "body[0].{wrong}"; did you mean "{key}"?' in str(refused.value)


@pytest.mark.parametrize("name", sorted(TEXTS))
def test_a_scenario_written_and_read_is_the_same(name):
    scenario = Scenario.from_toml(TEXTS[name])
    again = Scenario.from_toml(scenario.to_toml())
    assert again == scenario
    assert again.to_toml() == scenario.to_toml()
    other = scenario.replace(seed=scenario.seed + 1)
    assert other != scenario and other.replace(seed=scenario.seed) == scenario


tables = st.dictionaries(
    st.text(max_size=6),
    st.recursive(
        st.one_of(st.integers(-(2**62), 2**62), st.floats(allow_nan=False), st.booleans(), st.text(max_size=8)),
        lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(st.text(max_size=6), inner, max_size=3)),
        max_leaves=10,
    ),
    max_size=5,
)


@quick
@given(tables)
def test_any_table_survives_toml(table):
    assert parse(written(table), "round") == table


@quick
@given(axis=st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3).filter(lambda v: math.hypot(*v) > 1e-3))
def test_directions_become_unit_vectors_once(axis):
    torquer = {"body.0.magnetorquer.0.axis_b": axis}
    scenario = Scenario.from_toml(TEXTS["detumble"]).replace(**torquer)
    unit = scenario.body[0].magnetorquer[0].axis_b
    assert math.hypot(*unit) == pytest.approx(1.0, abs=4e-16)
    assert [x * math.hypot(*axis) for x in unit] == pytest.approx(axis, rel=1e-12, abs=1e-12)
    assert scenario.replace(**{"body.0.magnetorquer.0.axis_b": unit}) == scenario
