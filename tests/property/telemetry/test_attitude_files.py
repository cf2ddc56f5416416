"""Attitude files read back by other means, turn a vector as they say, and appear whole or not at all."""

import errno
import json
import re

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.spatial.transform import Rotation

from fieldline.errors import InputError
from fieldline.telemetry import (
    read_telemetry,
    telemetry_of,
    write_attitude_aem,
    write_attitude_csv,
    write_attitude_netcdf,
    write_telemetry_csv,
)
from fieldline.telemetry.aem import one_sided

COUNT = 500
COLUMNS = (
    "time_utc,q_bi_x,q_bi_y,q_bi_z,q_bi_w,omega_x_deg_s,omega_y_deg_s,omega_z_deg_s,"
    "attitude_std_x_deg,attitude_std_y_deg,attitude_std_z_deg,omega_std_x_deg_s,omega_std_y_deg_s,omega_std_z_deg_s,"
    "residual_x_nT,residual_y_nT,residual_z_nT,used"
).split(",")
WRITERS = {"csv": write_attitude_csv, "nc": write_attitude_netcdf, "aem": write_attitude_aem}


@pytest.fixture(scope="module")
def dataset():
    rng = np.random.default_rng(3)
    time = np.datetime64("2023-08-24T14:44:09.125", "ns") + np.arange(COUNT) * np.timedelta64(1, "s")
    q_bi = Rotation.from_rotvec(np.cumsum(rng.normal(size=(COUNT, 3)) * 0.3, axis=0)).as_quat()
    q_bi *= rng.choice([-1.0, 1.0], size=(COUNT, 1))
    vector = lambda scale: (("time", "axis"), rng.normal(size=(COUNT, 3)) * scale)
    data = xr.Dataset(
        {
            "q_bi": (("time", "quaternion"), q_bi, {"units": "1", "long_name": "attitude", "axes": "body against GCRS"}),
            "omega_bi_b": vector(0.1),
            "attitude_std_b": vector(0.02),
            "omega_std_b": vector(0.001),
            "residual_b": vector(1e-6),
            "used": ("time", rng.random(COUNT) < 0.9),
        },
        coords={"time": time, "axis": list("xyz"), "quaternion": list("xyzw")},
        attrs={"verdict": "usable: 2 deg", "usable": 1, "verdict_json": json.dumps({"usable": True}), "Conventions": "CF-1.11"},
    )
    data["residual_b"][7] = np.nan
    return data


def read_aem(path):
    """Metadata and data of an AEM in KVN, by the standard's grammar alone."""
    text = path.read_text()
    meta = dict(re.findall(r"^(\w+) = (.*)$", text, re.M))
    rows = [line.split() for line in text.split("DATA_START\n")[1].split("DATA_STOP")[0].splitlines()]
    return meta, np.array([row[0] for row in rows], dtype="datetime64[ns]"), np.array([row[1:] for row in rows], dtype=float)


def ccsds_matrix(q):
    """M(q) of CCSDS 504.0-B-1: v_b = M v_a for q1 q2 q3 qc."""
    a, b, c, d = q
    return np.array(
        [
            [a * a - b * b - c * c + d * d, 2 * (a * b + c * d), 2 * (a * c - b * d)],
            [2 * (a * b - c * d), -a * a + b * b - c * c + d * d, 2 * (b * c + a * d)],
            [2 * (a * c + b * d), 2 * (b * c - a * d), -a * a - b * b + c * c + d * d],
        ]
    )


def test_csv_has_the_columns_and_the_numbers(tmp_path, dataset):
    frame = pd.read_csv(write_attitude_csv(dataset, tmp_path / "a.csv"))
    assert list(frame.columns) == COLUMNS
    assert frame["time_utc"][0] == "2023-08-24T14:44:09.125Z"
    np.testing.assert_allclose(frame[COLUMNS[1:5]], dataset["q_bi"], atol=1e-12)
    np.testing.assert_allclose(frame[COLUMNS[5:8]], np.degrees(dataset["omega_bi_b"]), atol=1e-9)
    np.testing.assert_allclose(frame[COLUMNS[8:11]], np.degrees(dataset["attitude_std_b"]), atol=1e-9)
    np.testing.assert_allclose(frame[COLUMNS[11:14]], np.degrees(dataset["omega_std_b"]), atol=1e-9)
    np.testing.assert_allclose(frame[COLUMNS[14:17]], dataset["residual_b"] * 1e9, atol=1e-6)
    assert frame["residual_x_nT"].isna()[7]
    assert np.array_equal(frame["used"].to_numpy(bool), dataset["used"])


def test_netcdf_comes_back_equal(tmp_path, dataset):
    path = write_attitude_netcdf(dataset, tmp_path / "a.nc")
    with xr.open_dataset(path) as back:
        xr.testing.assert_identical(back.load(), dataset)


def test_aem_states_and_keeps_the_direction(tmp_path, dataset):
    meta, time, q = read_aem(write_attitude_aem(dataset, tmp_path / "a.aem", object_name="SUCHAI-3", object_id="2022-033AL"))
    assert (meta["REF_FRAME_A"], meta["REF_FRAME_B"], meta["ATTITUDE_DIR"]) == ("GCRF", "SC_BODY_1", "A2B")
    assert (meta["ATTITUDE_TYPE"], meta["QUATERNION_TYPE"], meta["TIME_SYSTEM"]) == ("QUATERNION", "LAST", "UTC")
    assert (meta["OBJECT_NAME"], meta["OBJECT_ID"]) == ("SUCHAI-3", "2022-033AL")
    assert np.array_equal(time, dataset["time"].values)
    assert np.datetime64(meta["STOP_TIME"]) == time[-1]
    v_b = np.array([0.3, -0.5, 0.8])
    v_i = Rotation.from_quat(dataset["q_bi"].values).apply(v_b)
    for k in range(0, COUNT, 37):
        np.testing.assert_allclose(ccsds_matrix(q[k]) @ v_i[k], v_b, atol=1e-10)
    assert (np.sum(q[1:] * q[:-1], axis=1) >= 0.0).all()


def test_one_sided_keeps_the_rotation():
    q = np.array([[0, 0, 0, 1.0], [0, 0, 0, -1.0], [0, 0, 0.6, -0.8], [0, 0, 0.6, 0.8]])
    assert np.array_equal(one_sided(q), [[0, 0, 0, 1], [0, 0, 0, 1], [0, 0, -0.6, 0.8], [0, 0, 0.6, 0.8]])


def test_aem_leaves_out_what_is_not_known(tmp_path, dataset):
    part = dataset.copy(deep=True)
    part["q_bi"][3:9] = np.nan
    _, time, _ = read_aem(write_attitude_aem(part, tmp_path / "a.aem"))
    assert len(time) == COUNT - 6
    part["q_bi"][:] = np.nan
    with pytest.raises(InputError, match="no attitude to write"):
        write_attitude_aem(part, tmp_path / "a.aem")


@pytest.mark.parametrize("kind", WRITERS)
def test_a_dataset_without_attitude_is_refused(tmp_path, kind, dataset):
    if kind != "nc":  # NetCDF takes any Dataset
        with pytest.raises(InputError, match="q_bi"):
            WRITERS[kind](dataset.drop_vars("q_bi"), tmp_path / f"a.{kind}")


@pytest.mark.parametrize("kind", WRITERS)
@pytest.mark.parametrize("stop", [KeyboardInterrupt, OSError(errno.ENOSPC, "No space left on device")])
def test_an_interrupted_write_leaves_nothing(tmp_path, monkeypatch, kind, stop, dataset):
    path = tmp_path / f"a.{kind}"
    path.write_text("the old file")

    def breaks(*args, **kwargs):
        raise stop

    monkeypatch.setattr("xarray.Dataset.to_netcdf", breaks)
    monkeypatch.setattr("fieldline.telemetry.attitude_csv.write_rows", breaks)
    monkeypatch.setattr("fieldline.telemetry.aem.write_rows", breaks)
    with pytest.raises((KeyboardInterrupt, InputError), match=None if stop is KeyboardInterrupt else "No space left"):
        WRITERS[kind](dataset, path)
    assert path.read_text() == "the old file"
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def test_an_interrupted_telemetry_write_leaves_nothing(tmp_path, monkeypatch):
    from importlib.resources import files

    telemetry = read_telemetry(files("fieldline") / "data" / "suchai3_2023-08-24.csv").slice(0, 50)

    def breaks(sink, columns):
        sink.write(b"half a line")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("fieldline.telemetry.telemetry_csv.write_rows", breaks)
    with pytest.raises(InputError, match="No space left"):
        write_telemetry_csv(telemetry, tmp_path / "a.csv")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there(tmp_path, dataset):
    with pytest.raises(InputError, match="does not exist"):
        write_attitude_csv(dataset, tmp_path / "nowhere" / "a.csv")


def test_telemetry_of_arrays_is_that_of_its_file(tmp_path):
    angle = 0.4 * np.arange(300)
    field_s = 3e-5 * np.stack([np.cos(angle), np.sin(angle), 0.4 * np.cos(angle / 30)], axis=-1)
    field_s[40] = np.nan
    field_s[90, 1] += 8e-5
    time = np.datetime64("2024-01-01", "ns") + np.arange(300) * np.timedelta64(250, "ms")
    made = telemetry_of(time, field_s, rate_b=np.ones((300, 3)), sun_sensor={"-x": angle})
    read = read_telemetry(write_telemetry_csv(made, tmp_path / "a.csv"))
    assert np.array_equal(made.field_s, read.field_s, equal_nan=True)
    assert np.array_equal(made.usable, read.usable)
    assert made.quality == read.quality
    assert list(np.flatnonzero(~made.usable)) == [40, 90]
    with pytest.raises(InputError, match="must increase"):
        telemetry_of(time[::-1], field_s)
    with pytest.raises(InputError, match="field_s must be"):
        telemetry_of(time, field_s.T)


FULL_DISK = """
import resource, sys
from pathlib import Path
import numpy as np, xarray as xr
from fieldline.errors import InputError
from fieldline.telemetry import write_attitude_aem, write_attitude_csv, write_attitude_netcdf

rng = np.random.default_rng(0)
count = 20_000
names = ("omega_bi_b", "attitude_std_b", "omega_std_b", "residual_b")
data = {name: (("time", "axis"), rng.normal(size=(count, 3))) for name in names}
data |= {"q_bi": (("time", "quaternion"), rng.normal(size=(count, 4))), "used": ("time", np.ones(count, bool))}
time = np.datetime64("2023-08-24", "ns") + np.arange(count) * np.timedelta64(1, "s")
dataset = xr.Dataset(data, coords={"time": time})
folder = Path(sys.argv[1])
resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))
for write, ending in ((write_attitude_csv, "csv"), (write_attitude_aem, "aem"), (write_attitude_netcdf, "nc")):
    try:
        write(dataset, folder / f"a.{ending}")
    except InputError as error:
        print(error)
    print(len(list(folder.iterdir())), "files")
"""


def test_a_disk_that_is_full_for_the_system_itself(tmp_path):
    """The system refuses to let a file grow: each library reports it in its own way, and nothing stays behind."""
    import subprocess
    import sys

    done = subprocess.run([sys.executable, "-c", FULL_DISK, str(tmp_path)], capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    assert [line for line in lines if line.endswith("files")] == ["0 files"] * 3
    assert sum("could not write" in line and "Nothing was changed" in line for line in lines) == 3
