"""The user's word wins: TOML, dictionary and flags give the same, and a slip in them is named."""

import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.frames.earth_rotation import dcm_ei, dcm_it, itrs_from_geodetic
from fieldline.telemetry import read_telemetry

COUNT = 120
SECONDS = 1692888249 + np.arange(COUNT)
TIME = SECONDS.astype("datetime64[s]").astype("datetime64[ns]")
ANGLE = 0.4 * np.arange(COUNT)
FIELD_MG = np.stack([300 * np.cos(ANGLE), 280 * np.sin(ANGLE), 90 * np.cos(ANGLE / 9)], axis=-1)
PLACE_M = 6.86e6 * np.stack([np.cos(ANGLE / 400), 0.6 * np.sin(ANGLE / 400), 0.8 * np.sin(ANGLE / 400)], axis=-1)

TOML = """
[columns]
time = "tick"
magnetometer = ["p", "q", "r"]
gyro = ["acc_x", "acc_y", "acc_z"]
temperature = "tmp"
sun_sensor = { "-x" = "s1", "+y" = "s2" }
wheel_speed = { main = "whl" }

[units]
time = "unix_ms"
magnetometer = "mG"
gyro = "deg/s"
temperature = "degC"
wheel_speed = "rpm"
"""


@pytest.fixture
def path(tmp_path):
    rng = np.random.default_rng(1)
    columns = {"tick": SECONDS * 1000} | {name: FIELD_MG[:, k] for k, name in enumerate("pqr")}
    columns |= {name: rng.normal(size=COUNT) for name in ("acc_x", "acc_y", "acc_z", "s1", "s2", "whl", "tmp")}
    columns |= {name: PLACE_M[:, k] / 1e3 for k, name in enumerate(("u", "v", "w"))}
    lines = [",".join(columns), *(",".join(repr(float(value)) for value in row) for row in zip(*columns.values(), strict=True))]
    (tmp_path / "flight.csv").write_text("\n".join(lines))
    return tmp_path / "flight.csv"


def test_toml_dictionary_and_flags_agree(path, tmp_path):
    import tomllib

    (tmp_path / "map.toml").write_text(TOML)
    first = read_telemetry(path, mapping=tmp_path / "map.toml")
    np.testing.assert_allclose(first.field_s, FIELD_MG * 1e-7, rtol=1e-14)
    assert np.array_equal(first.time_utc, TIME)
    assert set(first.sun_sensor) == {"-x", "+y"}
    assert set(first.wheel_speed) == {"main"}
    assert first.rate_b is not None
    assert 270 < np.median(first.temperature_k) < 276
    tables = tomllib.loads(TOML)
    second = read_telemetry(path, mapping=tables)
    tables["columns"] |= {"time": "s1", "magnetometer": ["s1", "s2", "whl"]}
    third = read_telemetry(path, mapping=tables, time_column="tick", mag_columns="p,q,r", unit="mG")
    fourth = read_telemetry(path, columns={"time": "tick", "mag": ("p", "q", "r")}, units={"mag": "mG", "time": "unix_ms"})
    for other in (second, third, fourth):
        assert np.array_equal(other.field_s, first.field_s)
        assert np.array_equal(other.time_utc, first.time_utc)
    assert fourth.rate_b is None
    assert all(r.why == "as told" for r in first.recognition if r.quantity in {"magnetometer", "gyro"})


@pytest.mark.parametrize(
    ("mapping", "words"),
    [
        ({"column": {}}, 'unknown table "column".*did you mean "columns"'),
        ({"columns": {"magnetomter": ["p", "q", "r"]}}, 'did you mean "magnetometer"'),
        ({"columns": {"magnetometer": ["p", "q"]}}, "must be three columns"),
        ({"columns": {"magnetometer": ["p", "q", "q"]}}, "twice"),
        ({"columns": {"magnetometer": ["p", "q", "rr"]}}, 'no column "rr"'),
        ({"columns": {"magnetometer": 5}}, "must be names"),
        ({"columns": {"magnetometer": ["p"]}}, "no vector"),
        ({"columns": {"sun_sensor": {"left": "s1"}}}, "no face"),
        ({"columns": {"sun_sensor": ["s1"]}}, "must name each column"),
        ({"columns": {"time": ["tick", "p"]}}, "one column"),
        ({"columns": {"time": "tick"}, "units": {"time": "unix_h"}}, "units.time"),
        ({"units": {"magnetometer": "furlong"}}, "no unit of the magnetometer"),
        ({"units": {"magnetometer": True}}, "must be a unit"),
        ({"axes": {"position": "moon"}}, "not known"),
        ({"axes": {"attitude": "GCRS"}}, "position"),
        ({"columns": {"position": ["u", "v", "w"]}}, "not their axes"),
        ({"columns": {"position": ["u", "v", "w"]}, "axes": {"position": "ITRS"}}, 'unit of "u"'),
        ({"columns": {"gyro": ["acc_x", "acc_y", "acc_z"]}}, 'unit of "acc_x"'),
        ({"columns": "p,q,r"}, "must be a table"),
    ],
)
def test_slips_are_named(path, mapping, words):
    base = {"columns": {"time": "tick", "magnetometer": ["p", "q", "r"]}, "units": {"magnetometer": "mG"}}
    merged = {
        key: (base.get(key, {}) | mapping.get(key, {})) if isinstance(mapping.get(key, {}), dict) else mapping[key]
        for key in {*base, *mapping}
    }
    with pytest.raises(InputError, match=words):
        read_telemetry(path, mapping=merged)


def test_files_that_are_no_mapping(path, tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_telemetry(path, mapping=tmp_path / "no.toml")
    (tmp_path / "bad.toml").write_text("[columns\n")
    with pytest.raises(InputError, match="no TOML"):
        read_telemetry(path, mapping=tmp_path / "bad.toml")


@pytest.mark.parametrize(
    ("axes", "turn"),
    [("ITRS", None), ("ECEF", None), ("GCRS", dcm_ei), ("J2000", dcm_ei), ("TEME", lambda t: dcm_ei(t) @ dcm_it(t))],
)
def test_positions_in_named_axes(path, axes, turn):
    mapping = {
        "columns": {"time": "tick", "magnetometer": ["p", "q", "r"], "position": ["u", "v", "w"]},
        "units": {"magnetometer": "mG", "position": "km"},
        "axes": {"position": axes},
    }
    telemetry = read_telemetry(path, mapping=mapping)
    expected = PLACE_M if turn is None else np.einsum("nij,nj->ni", turn(TIME), PLACE_M)
    np.testing.assert_allclose(telemetry.position_e, expected, atol=1e-6)


@pytest.mark.parametrize(
    "names",
    ["lat,lon,alt_km", "Latitude,Longitude,Altitude [km]", "latitude_deg,longitude_deg,height_km", "lat_rad,lon_rad,alt_km"],
)
def test_geodetic_positions(tmp_path, names):
    latitude, longitude = np.linspace(-1.2, 1.2, COUNT), np.linspace(-3.0, 3.0, COUNT)
    factor = 1.0 if "rad" in names else 180.0 / np.pi
    rows = zip(SECONDS, *(FIELD_MG.T), latitude * factor, longitude * factor, strict=True)
    body = [",".join(repr(float(value)) for value in row) + ",500.0" for row in rows]
    (tmp_path / "a.csv").write_text("\n".join([f"unix_s,mag_x_mG,mag_y_mG,mag_z_mG,{names}", *body]))
    telemetry = read_telemetry(tmp_path / "a.csv")
    np.testing.assert_allclose(telemetry.position_e, itrs_from_geodetic(latitude, longitude, np.full(COUNT, 5e5)), atol=1e-6)


@pytest.mark.parametrize("pattern", ["{}_ecef_km", "ecef_{}_km", "pos_ecef_{} [km]", "r_itrs_{}_km", "sat_{}_ITRF_km"])
def test_cartesian_names(tmp_path, pattern):
    names = ",".join(pattern.format(axis) for axis in "xyz")
    rows = [",".join(repr(float(value)) for value in row) for row in zip(SECONDS, *(FIELD_MG.T), *(PLACE_M.T / 1e3), strict=True)]
    (tmp_path / "a.csv").write_text("\n".join([f"unix_s,mag_x_mG,mag_y_mG,mag_z_mG,{names}", *rows]))
    np.testing.assert_allclose(read_telemetry(tmp_path / "a.csv").position_e, PLACE_M, atol=1e-6)
