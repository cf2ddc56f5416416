"""What a person may write for a law, and what is refused and how."""

import numpy as np
import pytest

from fieldline.control import LAWS, law_named
from fieldline.control.law import COMMANDS
from fieldline.errors import InputError
from law_tests import CONTEXT, REQUIRED, context_of


@pytest.mark.parametrize("name", sorted(LAWS))
def test_every_law_is_described(name):
    law = LAWS[name]
    assert law.name == name and len(law.doc) > 20 and law.memory > 0
    assert law.commands == tuple(c for c in COMMANDS if c in law.commands) != ()
    for key, parameter in law.parameters.items():
        assert len(parameter.doc) > 5 or parameter.doc in ("z", "w_n"), key
        assert parameter.default is not None or parameter.derived or key in REQUIRED[name]
        assert ("derived" in parameter.doc) == parameter.derived, key


@pytest.mark.parametrize("name", sorted(LAWS))
def test_defaults_pack_to_finite_numbers(name):
    params = LAWS[name].pack(REQUIRED.get(name, {}), context_of(name))
    assert params.ndim == 1 and params.dtype == float and params.flags.c_contiguous and np.isfinite(params).all()


@pytest.mark.parametrize("name", sorted(LAWS))
def test_an_unknown_key_is_refused_with_the_nearest(name):
    key = next(iter(LAWS[name].parameters))
    with pytest.raises(InputError, match=f'"{name}" has no parameter "{key}x"; did you mean "{key}"'):
        LAWS[name].pack(REQUIRED.get(name, {}) | {key + "x": 1.0}, CONTEXT)


def test_an_unknown_law_is_refused_with_the_nearest():
    assert law_named("b-dot") is LAWS["b-dot"]
    with pytest.raises(InputError, match='did you mean "b-dot"'):
        law_named("b_dot")


@pytest.mark.parametrize(
    ("name", "table", "words"),
    [
        ("b-dot", {"gain_n_m_s": -1.0}, "must be more than zero"),
        ("b-dot", {"gain_n_m_s": "much"}, "must be a number"),
        ("b-dot", {"gain_n_m_s": True}, "must be a number"),
        ("b-dot", {"gain_n_m_s": np.nan}, "finite"),
        ("b-dot", {"low_pass_s": -1.0}, "must not be negative"),
        ("b-dot", {"derivative": "differnce"}, 'did you mean "difference"'),
        ("b-dot-bang-bang", {"moment_a_m2": 1.0}, "must be 3 numbers"),
        ("magnetic-pd", {"attitude": (0, 0, 0, 2)}, "unit quaternion"),
        ("magnetic-pd", {"cancel_residual": "yes"}, "a switch"),
        ("magnetic-pd", {"target": "sun"}, "one of inertial, nadir"),
    ],
)
def test_bad_values(name, table, words):
    with pytest.raises(InputError, match=words):
        LAWS[name].pack(table, CONTEXT)


def test_no_parameter_is_changed_by_its_table():
    table = {"gain_n_m_s": 1e-3}
    LAWS["b-dot"].pack(table, CONTEXT)
    assert table == {"gain_n_m_s": 1e-3}
