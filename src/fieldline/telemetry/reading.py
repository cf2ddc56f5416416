"""Read telemetry: a table of samples becomes a `Telemetry`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fieldline.files import sha256_of
from fieldline.telemetry.record import Quality, Recognised, Telemetry


def read_telemetry(path, *, mapping=None, columns=None, units=None, mag_columns=None, time_column=None, unit=None, repair=False):
    """Telemetry of a CSV file with the columns unix_s, mag_x_nT ..., gyro_x_dps ..., css_mx ..."""
    import pandas as pd

    path = Path(path)
    table = pd.read_csv(path, float_precision="round_trip")
    time_utc = np.round(table["unix_s"].to_numpy(float) * 1e9).astype("int64").astype("datetime64[ns]")
    field_s = table[["mag_x_nT", "mag_y_nT", "mag_z_nT"]].to_numpy(float) * 1e-9
    rate_b = np.radians(table[["gyro_x_dps", "gyro_y_dps", "gyro_z_dps"]].to_numpy(float))
    faces = {sign + axis: f"css_{letter}{axis}" for sign, letter in (("-", "m"), ("+", "p")) for axis in "xyz"}
    step = np.diff(time_utc).astype(np.int64) * 1e-9
    usual = float(np.median(step))
    usable = np.isfinite(field_s).all(axis=1)
    gap = step > 1.5 * usual
    quality = Quality(
        samples=len(table),
        usable=int(usable.sum()),
        step_s=usual,
        gaps=int(gap.sum()),
        missing_s=float((step[gap] - usual).sum()),
    )
    return Telemetry(
        time_utc=time_utc,
        field_s=field_s,
        usable=usable,
        rate_b=rate_b,
        sun_sensor={face: table[column].to_numpy(float) for face, column in faces.items() if column in table},
        recognition=tuple(
            Recognised(column=f"mag_{axis}_nT", quantity="magnetometer", axis=axis, unit="nT", factor=1e-9) for axis in "xyz"
        ),
        quality=quality,
        name=path.name,
        sha256=sha256_of(path),
    )
