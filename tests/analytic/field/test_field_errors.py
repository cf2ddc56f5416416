"""What the field says to input that it cannot use."""

import numpy as np
import pytest

from fieldline.environment import FieldModel, field_model, magnetic_field
from fieldline.errors import InputError

LEO = np.array([6.9e6, 0.0, 0.0])
NOW = np.datetime64("2024-01-01")


@pytest.mark.parametrize(
    ("position", "words"),
    [
        ((6.9e3, 0.0, 0.0), "kilometres"),
        ((6.9e9, 0.0, 0.0), "millimetres"),
        ((-33.4, 289.3, 500.0), "latitude, longitude and height"),
        ((5.0e5, 0.0, 0.0), "not a height"),
        ((6.2e6, 0.0, 0.0), "inside the Earth"),
        ((0.0, 0.0, 0.0), "inside the Earth"),
        ((np.nan, 0.0, 7e6), "not finite"),
        ((np.inf, 0.0, 7e6), "not finite"),
        (np.full((3, 500), 5e6), r"\(3, N\)\? Use \.T"),
        (np.full((500, 2), 5e6), r"got \(500, 2\)"),
        (7e6, "axis of length 3"),
        (("a", "b", "c"), "must be numbers"),
        (np.array([7e6j, 0.0, 7e6]), "must be numbers"),
        (np.array([True, False, True]), "must be numbers"),
        (None, "axis of length 3"),
        ([[7e6, 0.0, 0.0], [7e6, 0.0]], "must be numbers"),
    ],
)
def test_places(position, words):
    with pytest.raises(InputError, match=words) as caught:
        magnetic_field(position, NOW)
    assert "position_e_m" in str(caught.value)


def test_the_bad_row_is_named():
    rows = np.tile(LEO, (9, 1))
    rows[4] = np.nan
    rows[6, 1] = np.nan
    with pytest.raises(InputError, match=r"row 4 of 9 is not finite.*2 such"):
        magnetic_field(rows, NOW)


@pytest.mark.parametrize(
    ("time", "model", "words"),
    [
        ("1899-12-31", "IGRF-14", "1899.*1900 to 2030.*dipole"),
        ("2031-06-01", "IGRF-14", "2031.*until_year=2032"),
        ("2024-12-31", "WMM2025", 'WMM2025 covers 2025 to 2030. Use "IGRF-14"'),
        ("2033-01-01", "dipole", "until_year=2033"),
        ("2050-05-01", "IGRF-14", "No model here reaches"),
    ],
)
def test_a_year_outside_the_model_names_one_that_would_do(time, model, words):
    with pytest.raises(InputError, match=words):
        magnetic_field(LEO, np.datetime64(time), model)


def test_the_end_years_belong_to_the_model():
    for time in ("1900-01-01", "2030-01-01"):
        assert np.isfinite(magnetic_field(LEO, np.datetime64(time))).all()


def test_the_advice_for_a_late_year_works():
    late = magnetic_field(LEO, np.datetime64("2031-06-01"), field_model("IGRF-14", until_year=2032.0))
    steady = [magnetic_field(LEO, np.datetime64(t)) for t in ("2028-01-01", "2029-01-01")]
    assert np.allclose(late, steady[1] + (2031 + 151 / 365 - 2029) * (steady[1] - steady[0]), rtol=1e-9)


@pytest.mark.parametrize("time", [2024.0, 20240101, "yesterday", np.datetime64("NaT"), np.datetime64("0001-01-01"), None])
def test_times(time):
    with pytest.raises(InputError, match="time_utc"):
        magnetic_field(LEO, time)


def test_no_outer_product():
    with pytest.raises(InputError, match=r"one time for all or one for each"):
        magnetic_field(np.tile(LEO, (5, 1)), NOW + np.arange(3) * np.timedelta64(1, "s"))
    with pytest.raises(InputError, match=r"one time for all or one for each"):
        magnetic_field(np.tile(LEO, (5, 1, 1)), NOW + np.arange(5) * np.timedelta64(1, "s"))


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("IGRF-13", {}, 'unknown field model "IGRF-13"; did you mean "IGRF-14"'),
        ("dipol", {}, 'did you mean "dipole"'),
        ("jupiter", {}, "known: .*WMM2025"),
        (14, {}, "unknown field model"),
        (["IGRF-14"], {}, "unknown field model"),
        ("IGRF-14", {"degree": 14}, "degree must be a whole number from 1 to 13 for IGRF-14; got 14"),
        ("WMM2025", {"degree": 13}, "from 1 to 12"),
        ("IGRF-14", {"degree": 0}, "from 1 to 13"),
        ("IGRF-14", {"degree": 8.5}, "whole number"),
        ("IGRF-14", {"degree": True}, "whole number"),
        ("IGRF-14", {"degree": [8]}, "whole number"),
        ("IGRF-14", {"degree": 4, "order": 5}, "order must be a whole number from 0 to 4"),
        ("IGRF-14", {"moment_e": (0, 0, 1e22)}, "has no option moment_e"),
        ("IGRF-14", {"until_year": 2090.0}, "until_year"),
        ("IGRF-14", {"until_year": "2032"}, "until_year"),
        (field_model("IGRF-14"), {"degree": [8]}, "whole number"),
        ("centred-dipole", {}, "needs moment_e"),
        ("centred-dipole", {"moment_e": (1e22, 0.0)}, "moment_e must be finite vectors"),
        ("centred-dipole", {"moment_e": np.ones((2, 3))}, "one vector"),
        ("centred-dipole", {"moment_e": (0, 0, 1e22), "degree": 2}, "has no degree"),
        ("displaced-dipoles", {"moment_e": np.ones((2, 3))}, "needs position_e"),
        ("displaced-dipoles", {"moment_e": np.ones((2, 3)), "position_e": np.ones((3, 3))}, "alike"),
        ("displaced-dipoles", {"moment_e": np.ones((1, 3)), "position_e": (7e6, 0, 0)}, "outside the Earth"),
        ("displaced-dipoles", {"moment_e": "strong", "position_e": (0, 0, 0)}, "moment_e must be finite vectors"),
    ],
)
def test_models(name, options, words):
    with pytest.raises(InputError, match=words):
        field_model(name, **options)


def test_a_finished_model_takes_no_options_but_degree():
    model = field_model("IGRF-14", degree=10)
    assert field_model(model, degree=5).degree == 5
    with pytest.raises(InputError, match="from 1 to 10"):
        field_model(model, degree=11)
    with pytest.raises(InputError, match="until_year cannot be given"):
        field_model(model, until_year=2031.0)


def test_models_are_made_once():
    assert field_model("IGRF-14") is field_model("IGRF-14")
    model = field_model("WMM2025")
    assert field_model(model) is model
    assert field_model(model, degree=6) is field_model(model, degree=6)
    assert field_model(model, degree=np.int64(6)).degree == 6


@pytest.mark.parametrize("name", ["igrf14", "IGRF 14", "Igrf-14"])
def test_names_are_read_kindly(name):
    assert field_model(name).name == "IGRF-14"


def test_stamps_say_what_was_used():
    model = field_model("IGRF-14", degree=8)
    past = model.stamp(np.array(["2023-07-02T12:00", "2024-01-01"], dtype="M8[m]"))
    assert past == {
        "model": "IGRF-14",
        "version": model.version,
        "degree": 8,
        "order": 8,
        "first_year": 2023.5,
        "last_year": 2024.0,
        "predictive": False,
        "source": model.source,
    }
    assert model.stamp(np.datetime64("2026-01-01"))["predictive"] is True
    assert "carried on" in field_model("IGRF-14", until_year=2032.0).stamp(np.datetime64("2031-01-01"))["version"]
    assert field_model("centred-dipole", moment_e=(0, 0, -7e22)).stamp(NOW)["predictive"] is False


def test_a_model_is_frozen():
    model = field_model("IGRF-14")
    assert isinstance(model, FieldModel)
    with pytest.raises(AttributeError):
        model.degree = 3
    with pytest.raises(ValueError, match="read-only"):
        model.coefficients.g[0, 1, 0] = 0.0


def test_one_time_only_freezes_a_model():
    with pytest.raises(InputError, match="one time"):
        field_model("IGRF-14").at(np.array(["2024-01-01", "2024-01-02"], dtype="M8[D]"))
