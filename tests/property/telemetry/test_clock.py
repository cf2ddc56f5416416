"""Every count of time gives the same instants, and local time is refused."""

import numpy as np
import pytest

from fieldline.errors import InputError
from fieldline.telemetry import read_telemetry

COUNT = 60
TIME = np.datetime64("2023-08-24T14:44:09.250", "ns") + np.arange(COUNT) * np.timedelta64(500, "ms")
UNIX_NS = TIME.astype(np.int64)
ANGLE = 0.4 * np.arange(COUNT)
BODY = [f"{30000 * np.cos(a):.1f},{30000 * np.sin(a):.1f},{9000 * np.cos(a / 9):.1f}" for a in ANGLE]
GPS_EPOCH_UNIX_S = 315964800
LEAP_SINCE_GPS_S = 18  # from 2017 on: 37 s of TAI less the 19 of 1980
ONE_MICROSECOND = np.timedelta64(1, "us")


def write(path, name, stamps):
    path.write_text("\n".join([f"{name},mag_x_nT,mag_y_nT,mag_z_nT", *(f"{s},{b}" for s, b in zip(stamps, BODY, strict=True))]))
    return path


def iso(shift_hours=0, zone="", unit="ms", sign="T"):
    shifted = TIME + np.timedelta64(shift_hours, "h")
    return [str(t).replace("T", sign) + zone for t in np.datetime_as_string(shifted, unit=unit)]


SECONDS = UNIX_NS / 1e9
CASES = [
    ("unix_s", [f"{s:.3f}" for s in SECONDS]),
    ("unix_ms", UNIX_NS // 10**6),
    ("unix_us", UNIX_NS // 10**3),
    ("unix_ns", UNIX_NS),
    ("timestamp", UNIX_NS // 10**6),
    ("time", [f"{s:.3f}" for s in SECONDS]),
    ("time_s", [f"{s:.3f}" for s in SECONDS]),
    ("Time (ms)", UNIX_NS // 10**6),
    ("obc_timestamp_ms", UNIX_NS // 10**6),
    ("gps_s", [f"{s - GPS_EPOCH_UNIX_S + LEAP_SINCE_GPS_S:.3f}" for s in SECONDS]),
    ("gps_seconds", [f"{s - GPS_EPOCH_UNIX_S + LEAP_SINCE_GPS_S:.3f}" for s in SECONDS]),
    ("time_utc", iso(zone="Z")),
    ("utc", iso()),
    ("timestamp", iso(sign=" ")),
    ("datetime", [s.replace("-", "/", 2) for s in iso(sign=" ")]),
    ("time_utc", [f"2023-236T{s[11:]}Z" for s in iso()]),
    ("time", iso(shift_hours=-3, zone="-03:00")),
    ("local_time", iso(shift_hours=2, zone="+0200")),
]


@pytest.mark.parametrize(("name", "stamps"), CASES, ids=[f"{name}-{k}" for k, (name, _) in enumerate(CASES)])
def test_counts(tmp_path, name, stamps):
    telemetry = read_telemetry(write(tmp_path / "a.csv", name, stamps))
    assert np.abs(telemetry.time_utc - TIME).max() < ONE_MICROSECOND


@pytest.mark.parametrize(
    ("name", "offset", "tolerance_us"), [("jd", 2440587.5, 50), ("mjd", 40587.0, 1), ("julian_date_utc", 2440587.5, 50)]
)
def test_julian_dates(tmp_path, name, offset, tolerance_us):
    """A Julian date in one float64 resolves 40 microseconds."""
    telemetry = read_telemetry(write(tmp_path / "a.csv", name, [f"{s / 86400 + offset:.12f}" for s in SECONDS]))
    assert np.abs(telemetry.time_utc - TIME).max() <= np.timedelta64(tolerance_us, "us")


def test_an_offset_is_converted_and_said(tmp_path):
    telemetry = read_telemetry(write(tmp_path / "a.csv", "time", iso(shift_hours=-3, zone="-03:00")))
    assert any("converted to UTC" in line for line in telemetry.describe())
    telemetry = read_telemetry(write(tmp_path / "a.csv", "time", iso()))
    assert any("without a zone were read as UTC" in line for line in telemetry.describe())


@pytest.mark.parametrize(
    "name", ["local_time", "time_CLT", "time_local", "time (UTC-3)", "time_utc+02:00", "Timestamp GMT-4", "time_CEST"]
)
def test_local_time_is_refused_with_advice(tmp_path, name):
    with pytest.raises(InputError, match=r"local time.*UTC"):
        read_telemetry(write(tmp_path / "a.csv", name, iso()))


def test_utc_wins_over_local_time_and_the_user_over_both(tmp_path):
    path = tmp_path / "a.csv"
    local = iso(shift_hours=-3)
    write(path, "local_time,time_utc,unix_s", [f"{a},{b},{s:.3f}" for a, b, s in zip(local, iso(), SECONDS + 1.0, strict=True)])
    assert read_telemetry(path).time_utc[0] == TIME[0]
    assert read_telemetry(path, time_column="unix_s").time_utc[0] == TIME[0] + np.timedelta64(1, "s")


def test_elapsed_seconds_need_an_epoch(tmp_path):
    path = write(tmp_path / "a.csv", "t", [f"{k * 0.5}" for k in range(COUNT)])
    with pytest.raises(InputError, match="since 2023"):
        read_telemetry(path)
    telemetry = read_telemetry(path, units={"time": "s since 2023-08-24T14:44:09.25Z"})
    assert np.array_equal(telemetry.time_utc, TIME)


@pytest.mark.parametrize(
    ("name", "stamps", "words"),
    [
        ("unix_s", UNIX_NS // 10**6, "says s, but .* looks like Unix time in ms"),
        ("time_utc", ["24.08.2023 14:44"] * COUNT, "no ISO 8601 time"),
        ("time_utc", ["08/24/2023 14:44"] * COUNT, "year first"),
        ("gps_s", [f"{s:.3f}" for s in SECONDS + 3e9], "outside 1957 to 2100"),
        ("when", iso(), "no time column"),
        ("unix_s", [""] * COUNT, "time column"),
    ],
)
def test_times_that_cannot_be_are_refused(tmp_path, name, stamps, words):
    with pytest.raises(InputError, match=words):
        read_telemetry(write(tmp_path / "a.csv", name, stamps))


def test_gps_time_across_a_leap_second(tmp_path):
    """2016-12-31T23:59:59 is 1167264016 GPS seconds, 2017-01-01T00:00:00 is 1167264018: the leap second lies between."""
    stamps = [1167264016 - COUNT + 2 + k for k in range(COUNT - 1)] + [1167264018]
    stamps = [*stamps[:-2], 1167264016, 1167264018]
    telemetry = read_telemetry(write(tmp_path / "a.csv", "gps_s", stamps))
    assert str(telemetry.time_utc[-2])[:19] == "2016-12-31T23:59:59"
    assert str(telemetry.time_utc[-1])[:19] == "2017-01-01T00:00:00"


@pytest.mark.parametrize("header", ["date,time", "utc_date,utc_time"])
def test_a_date_and_a_time_of_day(tmp_path, header):
    stamps = [stamp.replace("T", ",") for stamp in iso()]
    assert np.array_equal(read_telemetry(write(tmp_path / "a.csv", header, stamps)).time_utc, TIME)
    swapped = [",".join(reversed(stamp.split("T"))) for stamp in iso()]
    header = ",".join(reversed(header.split(",")))
    assert np.array_equal(read_telemetry(write(tmp_path / "a.csv", header, swapped)).time_utc, TIME)
