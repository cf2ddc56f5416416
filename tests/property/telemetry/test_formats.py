"""One flight written in every format reads back as the same telemetry."""

import gzip

import numpy as np
import pandas as pd
import pytest

from fieldline.errors import InputError
from fieldline.telemetry import read_telemetry, write_telemetry_csv

COUNT = 400
TIME = np.datetime64("2023-08-24T14:44:09", "ns") + np.arange(COUNT) * np.timedelta64(2, "s")
PHASE = 0.3 * np.arange(COUNT)
FIELD_NT = np.round(np.stack([30e3 * np.cos(PHASE) + 5e3, 28e3 * np.sin(PHASE), 12e3 + 9e3 * np.cos(0.01 * PHASE)], axis=-1), 2)


def table(time_name="time_utc", time=None, pattern="mag_{}_nT", scale=1.0):
    time = time if time is not None else np.char.add(np.datetime_as_string(TIME, unit="s"), "Z")
    return pd.DataFrame({time_name: time} | {pattern.format(axis): FIELD_NT[:, k] * scale for k, axis in enumerate("xyz")})


def same(telemetry, tolerance=1e-15):
    assert np.array_equal(telemetry.time_utc, TIME)
    np.testing.assert_allclose(telemetry.field_s, FIELD_NT * 1e-9, rtol=0, atol=tolerance)
    assert telemetry.usable.all()
    return True


@pytest.mark.parametrize(("separator", "decimal"), [(",", "."), *((s, d) for s in (";", "\t", "|", " ") for d in ".,")])
def test_separators_and_decimal_signs(tmp_path, separator, decimal):
    path = tmp_path / "flight.txt"
    table().to_csv(path, sep=separator, decimal=decimal, index=False)
    assert same(read_telemetry(path))


@pytest.mark.parametrize(
    ("encoding", "name"),
    [("utf-8", "mag_{}_nT"), ("utf-8-sig", "mag_{} [nT]"), ("utf-16", "mag_{}_nT"), ("latin-1", "mag_{} [nT] °")],
)
def test_encodings(tmp_path, encoding, name):
    path = tmp_path / "flight.csv"
    frame = table()
    if encoding == "latin-1":
        frame["temp [°C]"] = 20.5
    else:
        frame.columns = ["time_utc", *(name.format(axis) for axis in "xyz")]
    path.write_bytes(frame.to_csv(index=False).encode(encoding))
    telemetry = read_telemetry(path)
    assert same(telemetry)
    if encoding == "latin-1":
        assert telemetry.temperature_k == pytest.approx(293.65)


def test_micro_sign_in_a_unit(tmp_path):
    for encoding in ("utf-8", "latin-1"):
        path = tmp_path / "flight.csv"
        path.write_bytes(table(pattern="mag_{} [µT]", scale=1e-3).to_csv(index=False).encode(encoding))
        assert same(read_telemetry(path))


def test_gzip_comments_quotes_and_blank_lines(tmp_path):
    text = table().to_csv(index=False, quoting=1)
    lines = text.splitlines()
    text = "# flight 7\n\n# raw\n" + "\n".join([*lines[:50], "# pass lost", "", *lines[50:]]) + "\n"
    path = tmp_path / "flight.csv.gz"
    path.write_bytes(gzip.compress(text.encode()))
    assert same(read_telemetry(path))


def test_windows_line_ends_and_units_row_and_header_in_a_comment(tmp_path):
    lines = table().to_csv(index=False).splitlines()
    path = tmp_path / "a.csv"
    path.write_bytes("\r\n".join(lines).encode())
    assert same(read_telemetry(path))
    path.write_text("\n".join(["time_utc,Bx,By,Bz", "UTC,nT,nT,nT", *lines[1:]]))
    assert same(read_telemetry(path))
    path.write_text("\n".join(["# " + lines[0], *(line.replace("Z", "") for line in lines[1:])]))
    seconds = (TIME - TIME[0]).astype(int) // 10**9 + 1692888249
    body = [f"{s},{x},{y},{z}" for s, (x, y, z) in zip(seconds, FIELD_NT, strict=True)]
    path.write_text("\n".join(["# made by a logger", "# unix_s,mag_x_nT,mag_y_nT,mag_z_nT", *body]))
    assert same(read_telemetry(path))


def test_no_header_at_all_needs_and_takes_a_mapping(tmp_path):
    path = tmp_path / "a.csv"
    seconds = (TIME - TIME[0]).astype(int) // 10**9 + 1692888249
    path.write_text("\n".join(f"{s},{x},{y},{z}" for s, (x, y, z) in zip(seconds, FIELD_NT, strict=True)))
    with pytest.raises(InputError, match="column_1"):
        read_telemetry(path)
    telemetry = read_telemetry(path, time_column="column_1", mag_columns="column_2,column_3,column_4", unit="nT")
    assert same(telemetry)


def test_parquet_flat_list_and_struct(tmp_path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    path = tmp_path / "flight.parquet"
    table(time=TIME).to_parquet(path)
    assert same(read_telemetry(path))
    table(time=TIME).set_index("time_utc").to_parquet(path)
    assert same(read_telemetry(path))
    vectors = pa.table({"timestamp": TIME, "B_VFM": FIELD_NT.tolist()})
    pq.write_table(vectors, path)
    assert same(read_telemetry(path, unit="nT"))
    with pytest.raises(InputError, match=r"do not say their unit.*nT"):
        read_telemetry(path)
    structs = [dict(zip("xyz", row, strict=True)) for row in FIELD_NT.tolist()]
    pq.write_table(pa.table({"unix_ns": TIME.astype(int), "mag_nT": structs}), path)
    assert same(read_telemetry(path, unit="nT"))


def test_parquet_units_in_metadata(tmp_path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields = [pa.field("utc", pa.timestamp("ns"))] + [
        pa.field(f"b{axis}", pa.float64(), metadata={"unit": "nT"}) for axis in "xyz"
    ]
    arrays = [pa.array(TIME), *(pa.array(FIELD_NT[:, k]) for k in range(3))]
    pq.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields)), tmp_path / "a.parquet")
    assert same(read_telemetry(tmp_path / "a.parquet"))


@pytest.mark.parametrize("form", ["NETCDF4", "NETCDF3_64BIT"])
def test_netcdf(tmp_path, form):
    import xarray as xr

    data = xr.Dataset(
        {"B_VFM": (("time", "axis"), FIELD_NT, {"units": "nT"}), "temp": ("time", np.full(COUNT, 21.0), {"units": "degC"})}
    )
    data = data.assign_coords(time=TIME)
    data.to_netcdf(tmp_path / "a.nc", format=form, engine="netcdf4", encoding={"time": {"units": "seconds since 1970-01-01"}})
    telemetry = read_telemetry(tmp_path / "a.nc")
    assert same(telemetry)
    assert telemetry.temperature_k == pytest.approx(294.15)


@pytest.mark.parametrize("epoch", ["CDF_EPOCH", "CDF_TIME_TT2000"])
def test_swarm_like_cdf(tmp_path, epoch):
    from cdflib import cdfepoch, cdfwrite

    parts = [[*(int(p) for p in str(t)[:19].replace("T", "-").replace(":", "-").split("-")), 0] for t in TIME]
    stamps = cdfepoch.compute_epoch(parts) if epoch == "CDF_EPOCH" else cdfepoch.compute_tt2000([[*p, 0, 0] for p in parts])
    variables = [
        ("Timestamp", getattr(cdfwrite.CDF, epoch, None) or {"CDF_EPOCH": 31, "CDF_TIME_TT2000": 33}[epoch], [], stamps, "-"),
        ("B_VFM", 45, [3], FIELD_NT, "nT"),
        *((name, 45, [3], FIELD_NT[:, ::-1], "nT") for name in ("B_NEC", "dB_Sun", "dB_AOCS", "dB_other", "B_error")),
        *((name, 45, [], FIELD_NT[:, 0], "nT") for name in ("F", "dF_Sun", "F_error", "ASM_Freq_Dev")),
        ("q_NEC_CRF", 45, [4], np.ones((COUNT, 4)), "-"),
        ("Flags_B", 45, [], np.zeros(COUNT), "-"),
        ("Latitude", 45, [], np.linspace(-60.0, 60.0, COUNT), "degrees"),
        ("Longitude", 45, [], np.full(COUNT, 90.0), "degrees"),
        ("Radius", 45, [], np.full(COUNT, 6.85e6), "m"),
    ]
    with cdfwrite.CDF(tmp_path / "swarm.cdf") as file:
        for name, kind, sizes, values, units in variables:
            spec = {"Variable": name, "Data_Type": kind, "Num_Elements": 1, "Rec_Vary": True, "Dim_Sizes": sizes}
            file.write_var(spec, var_attrs={"UNITS": units}, var_data=np.asarray(values))
    telemetry = read_telemetry(tmp_path / "swarm.cdf")
    assert same(telemetry)
    radius = np.linalg.norm(telemetry.position_e, axis=1)
    np.testing.assert_allclose(radius, 6.85e6, rtol=1e-12)
    latitude = np.degrees(np.arcsin(telemetry.position_e[:, 2] / radius))
    np.testing.assert_allclose(latitude, np.linspace(-60.0, 60.0, COUNT), atol=1e-9)  # geocentric, not geodetic
    np.testing.assert_allclose(telemetry.position_e[:, 0], 0.0, atol=1e-6)  # longitude 90


def test_every_column_of_a_telemetry_survives_its_own_csv(tmp_path):
    frame = table()
    rng = np.random.default_rng(5)
    names = ["gyro_x_dps", "gyro_y_dps", "gyro_z_dps", "css_mx", "css_py", "dipole_x_mA_m2", "dipole_y_mA_m2", "dipole_z_mA_m2"]
    names += ["wheel_speed_x_rpm", "rw2_rpm", "mag_temp_degC", "solar_current_mA"]
    for name in names:
        frame[name] = rng.normal(size=COUNT)
    frame[["x_ecef_km", "y_ecef_km", "z_ecef_km"]] = 6.9e3 * np.stack([np.cos(PHASE), np.sin(PHASE), 0 * PHASE], axis=-1)
    frame.loc[7, ["mag_y_nT", "gyro_x_dps"]] = np.nan
    frame.to_csv(tmp_path / "a.csv", index=False)
    first = read_telemetry(tmp_path / "a.csv")
    second = read_telemetry(write_telemetry_csv(first, tmp_path / "b.csv"))
    assert np.array_equal(first.time_utc, second.time_utc)
    for name in ("field_s", "rate_b", "dipole_command_b", "position_e", "temperature_k", "solar_current", "usable"):
        assert np.array_equal(getattr(first, name), getattr(second, name), equal_nan=name != "usable"), name
    for name in ("sun_sensor", "wheel_speed"):
        one, two = getattr(first, name), getattr(second, name)
        assert list(one) == list(two)
        assert all(np.array_equal(one[key], two[key]) for key in one)
    assert not first.usable[7]


def test_nanosecond_stamps_survive(tmp_path):
    frame = table(time=np.char.add(np.datetime_as_string(TIME + np.timedelta64(123_456_789, "ns"), unit="ns"), "Z"))
    frame.to_csv(tmp_path / "a.csv", index=False)
    first = read_telemetry(tmp_path / "a.csv")
    assert str(first.time_utc[0]).endswith(".123456789")
    assert np.array_equal(first.time_utc, read_telemetry(write_telemetry_csv(first, tmp_path / "b.csv")).time_utc)
