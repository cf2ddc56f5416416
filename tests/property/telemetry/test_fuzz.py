"""Thousands of mutations of the sample file: either a Telemetry whose arrays make sense, or an InputError; nothing else."""

import random
from importlib.resources import files

import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.telemetry import Telemetry, read_telemetry

LINES = (files("fieldline") / "data" / "suchai3_2023-08-24.csv").read_text().splitlines()[:41]
TEXT = "\n".join(LINES) + "\n"
WORDS = [
    "nan",
    "inf",
    "-inf",
    "1e400",
    "-9999",
    "",
    " ",
    "abc",
    '"',
    "0x1F",
    "1,5",
    "1_000",
    "\x00",
    "é",
    "٣",
    "1e-320",
    "--",
    "#",
    ";",
    "\t",
]
NAMES = ["time", "local_time", "mag_x_uT", "mag_x", "gps_s", "x_ecef_km", "lat", "lon", "alt_km", "temp_K", "B_VFM", "css_px", ""]


def mutate(chance: random.Random) -> bytes:
    """One to four random damages of the sample's text or bytes."""
    lines = list(LINES)
    for _ in range(chance.randint(1, 4)):
        kind = chance.choice([0, 0, 0, 0, 1, 2, 3, 3, 4, 5, 6, 7])
        row = chance.randrange(len(lines)) if lines else 0
        if not lines:
            break
        cells = lines[row].split(",")
        if kind == 0:
            cells[chance.randrange(len(cells))] = chance.choice(WORDS)
        elif kind == 1:
            del cells[chance.randrange(len(cells))]
        elif kind == 2:
            cells.insert(chance.randrange(len(cells) + 1), chance.choice(WORDS))
        elif kind == 3:
            header = lines[0].split(",")
            header[chance.randrange(len(header))] = chance.choice(NAMES)
            lines[0] = ",".join(header)
            continue
        elif kind == 4:
            del lines[row]
            continue
        elif kind == 5:
            lines.insert(row, chance.choice(lines))
            continue
        elif kind == 6:
            column = chance.randrange(len(cells))
            scale = chance.choice(["0", "-1", "1e9", "1e-9", "nan", "30"])
            lines = [
                ",".join(c if k != column else scale for k, c in enumerate(line.split(","))) if line else line for line in lines
            ]
            continue
        else:
            lines = [line.replace(",", chance.choice([";", "\t", " ", "|", ",,"])) for line in lines]
            continue
        lines[row] = ",".join(cells)
    data = "\n".join(lines).encode("utf-8", errors="replace")
    if chance.random() < 0.3 and data:
        place = chance.randrange(len(data))
        damage = chance.randrange(3)
        if damage == 0:
            data = data[:place]
        elif damage == 1:
            data = data[:place] + bytes([chance.randrange(256)]) + data[place + 1 :]
        else:
            data = data[:place] + bytes(chance.randrange(256) for _ in range(20)) + data[place:]
    return data


def check(telemetry: Telemetry) -> None:
    count = len(telemetry)
    assert count >= 2
    assert (np.diff(telemetry.time_utc) > np.timedelta64(0, "ns")).all()
    assert telemetry.field_s.shape == (count, 3)
    assert telemetry.field_s.dtype == np.float64
    assert np.isfinite(telemetry.field_s[telemetry.usable]).all()
    assert telemetry.usable.any()
    assert telemetry.quality.usable == telemetry.usable.sum()
    assert all(isinstance(line, str) for line in telemetry.describe())
    for values in (*telemetry.sun_sensor.values(), *telemetry.wheel_speed.values()):
        assert values.shape == (count,)


def outcome(path, **options) -> str:
    try:
        check(read_telemetry(path, **options))
    except InputError as error:
        assert 10 < len(str(error)) < 2500
        return "refused"
    return "read"


@pytest.mark.parametrize("seed", range(8))
def test_mutated_samples(tmp_path, seed):
    chance = random.Random(seed)
    path = tmp_path / "flight.csv"
    outcomes = []
    for _ in range(250):
        path.write_bytes(mutate(chance))
        outcomes.append(outcome(path, repair=chance.random() < 0.5))
    assert {"read", "refused"} == set(outcomes)


@pytest.mark.parametrize("form", ["parquet", "nc", "cdf"])
def test_damaged_binary_files(tmp_path, form):
    import pandas as pd
    import xarray as xr
    from cdflib import cdfepoch, cdfwrite

    path = tmp_path / f"flight.{form}"
    values = [[float(cell) for cell in line.split(",")] for line in LINES[1:]]
    frame = pd.DataFrame(values, columns=LINES[0].split(","))
    if form == "parquet":
        frame.to_parquet(path)
    elif form == "nc":
        xr.Dataset.from_dataframe(frame).to_netcdf(path, engine="netcdf4")
    else:
        with cdfwrite.CDF(path) as file:
            stamps = cdfepoch.compute_epoch([[2023, 8, 24, 14, 44, k, 0] for k in range(40)])
            for name, kind, column in (
                ("Timestamp", 31, stamps),
                *((n, 45, frame[n].to_numpy()) for n in frame if n != "unix_s"),
            ):
                file.write_var(
                    {"Variable": name, "Data_Type": kind, "Num_Elements": 1, "Rec_Vary": True, "Dim_Sizes": []}, var_data=column
                )
    whole = path.read_bytes()
    assert outcome(path) == "read"
    chance = random.Random(7)
    for _ in range(60):
        data = bytearray(whole)
        if chance.random() < 0.5:
            data = data[: chance.randrange(8, len(data))]
        else:
            for _ in range(chance.randint(1, 20)):
                data[chance.randrange(8, len(data))] = chance.randrange(256)
        path.write_bytes(bytes(data))
        outcome(path)
