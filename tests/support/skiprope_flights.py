"""What tests of the skiprope of telemetry share: the sample's orbit, flights along it with the truth beside them, files."""

from functools import cache
from importlib.resources import files

import numpy as np

from fieldline.cases.tp3123 import record_along
from fieldline.orbit import read_orbit

DATA = files("fieldline") / "data"
SAMPLE, ELEMENTS = str(DATA / "skiprope.csv"), str(DATA / "skiprope.tle")
LENGTH_M = 20e3
START = np.datetime64("1992-08-04T12:00:00", "ns")
METHODS = ("harmonic", "kalman", "bandpass")


@cache
def sample_orbit():
    """The sample's."""
    return read_orbit(ELEMENTS)


def times(count: int, step_s: float = 2.0):
    """(count,) UTC."""
    return START + (np.arange(count) * step_s * 1e9).astype("timedelta64[ns]")


@cache
def flight(count: int = 1700, step_s: float = 2.0, **motion):
    """Telemetry and truth of a skiprope of 0.7 by 0.5 deg at 4.9 mHz unless said otherwise."""
    usual = {
        "skiprope_frequency_hz": 0.0049,
        "skiprope_deg": (0.7, 0.5),
        "pendulous_deg": (1.0, 1.0),
        "bias_deg": (0.5, 0.5, 1.0),
    }
    return record_along(times(count, step_s), sample_orbit(), **(usual | motion))


def lines_of(telemetry, fmt="{:.1f}"):
    """Telemetry as lines of CSV in nanotesla, the header first; an empty cell where there is no number."""
    stamps = np.datetime_as_string(telemetry.time_utc, unit="ms")
    rows = [
        f"{stamp}Z," + ",".join("" if b != b else fmt.format(1e9 * b) for b in field)
        for stamp, field in zip(stamps, telemetry.field_s, strict=True)
    ]
    return ["time_utc,mag_x_nT,mag_y_nT,mag_z_nT", *rows]


def write(path, lines):
    """Lines as a file."""
    path.write_text("\n".join(lines) + "\n")
    return path


def tether_azimuth_rad(record, seconds):
    """The true azimuth of the tether's middle at times [s], a tether that hangs down."""
    at = (record.telemetry.time_utc - record.telemetry.time_utc[0]).astype(np.int64) * 1e-9
    return np.interp(seconds, at, np.unwrap(record.azimuth_rad)) + np.pi


def wrapped_deg(angle_rad):
    """[deg] within half a turn."""
    return np.degrees((np.asarray(angle_rad) + np.pi) % (2 * np.pi) - np.pi)
