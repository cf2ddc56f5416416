"""`fieldline field`: the model's field at a place and time, or along an orbit."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from fieldline.cli import options
from fieldline.errors import InputError

MOST_ROWS = 5_000_000


def field(
    latitude_deg: Annotated[float | None, typer.Option(help="Geodetic latitude, north positive.", show_default=False)] = None,
    longitude_deg: Annotated[float | None, typer.Option(help="Longitude, east positive.", show_default=False)] = None,
    altitude_km: Annotated[float, typer.Option(help="Height over the WGS 84 ellipsoid.")] = 0.0,
    time: Annotated[str | None, typer.Option(help="UTC, ISO 8601.", show_default=False)] = None,
    model: options.Model = "IGRF-14",
    orbit: options.Orbit = None,
    start: Annotated[str | None, typer.Option(help="First time along the orbit, UTC.", show_default=False)] = None,
    stop: Annotated[str | None, typer.Option(help="Last time along the orbit, UTC.", show_default=False)] = None,
    step_s: Annotated[float, typer.Option(help="Step along the orbit.", min=1e-3)] = 10.0,
    out: Annotated[Path | None, typer.Option(help="CSV file for the values along the orbit.", show_default=False)] = None,
    norad_id: options.NoradId = None,
    max_orbit_age_days: options.MaxAge = 30.0,
    as_json: options.Json = False,
) -> int:
    """The magnetic field at a place (latitude, longitude, time) or along an orbit (--orbit, --start, --stop, --out)."""
    place = {"--latitude-deg": latitude_deg, "--longitude-deg": longitude_deg, "--time": time}
    along = {"--orbit": orbit, "--start": start, "--stop": stop, "--out": out}
    if any(value is not None for value in along.values()):
        _all_given(along, place, "along an orbit")
        return _along_orbit(orbit, start, stop, step_s, out, model, norad_id, max_orbit_age_days)
    _all_given(place, along, "at a place")
    values = field_at(latitude_deg, longitude_deg, altitude_km, time, model)
    if as_json:
        print(json.dumps(values, indent=2))
    else:
        print("\n".join(f"{name:<16} {_shown(value)}" for name, value in values.items()))
    return 0


def _shown(value: Any) -> str:
    """A number to three decimals, truth in words."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.3f}" if isinstance(value, float) else str(value)


def field_at(latitude_deg: Any, longitude_deg: Any, altitude_km: float, time: Any, model: str) -> dict[str, Any]:
    """North, east, down [nT] on geodetic axes, with magnitude, declination and inclination."""
    import numpy as np

    from fieldline.environment import field_model, magnetic_field
    from fieldline.frames.earth_rotation import itrs_from_geodetic
    from fieldline.frames.time import as_utc, iso_utc

    if not -90.0 <= latitude_deg <= 90.0:
        raise InputError(f"--latitude-deg must lie between -90 and 90; got {latitude_deg:g}.")
    when = as_utc(time, "--time")
    latitude, longitude = np.radians([latitude_deg, longitude_deg])
    chosen = field_model(model)
    field_e = magnetic_field(itrs_from_geodetic(latitude, longitude, 1e3 * altitude_km), when, model=chosen)
    north, east, down = 1e9 * north_east_down(latitude, longitude) @ field_e
    horizontal = np.hypot(north, east)
    return {
        "model": chosen.name,
        "time_utc": iso_utc(when),
        "north_nT": float(north),
        "east_nT": float(east),
        "down_nT": float(down),
        "magnitude_nT": float(np.hypot(horizontal, down)),
        "declination_deg": float(np.degrees(np.arctan2(east, north))),
        "inclination_deg": float(np.degrees(np.arctan2(down, horizontal))),
        "predictive": bool(chosen.stamp(when).get("predictive", False)),
    }


def north_east_down(latitude_rad: float, longitude_rad: float) -> Any:
    """(3, 3): rows are north, east and down of the ellipsoid in Earth-fixed axes."""
    import numpy as np

    (sb, cb), (sl, cl) = ((np.sin(a), np.cos(a)) for a in (latitude_rad, longitude_rad))
    return np.array([[-sb * cl, -sb * sl, cb], [-sl, cl, 0.0], [-cb * cl, -cb * sl, -sb]])


def _all_given(wanted: dict[str, Any], other: dict[str, Any], where: str) -> None:
    """InputError that lists what is missing, or what does not go together."""
    missing = [name for name, value in wanted.items() if value is None]
    mixed = [name for name, value in other.items() if value is not None]
    if missing:
        raise InputError(f"the field {where} needs {', '.join(missing)} too. See: fieldline field --help")
    if mixed:
        raise InputError(f"the field {where} does not go together with {', '.join(mixed)}; leave one of them out.")


def _along_orbit(
    orbit_path: Any, start: Any, stop: Any, step_s: float, out: Any, model: str, norad_id: int | None, max_age_days: float
) -> int:
    """A CSV of place and field at each step."""
    import numpy as np

    from fieldline.cli.outputs import refuse_inputs, wrote
    from fieldline.files import write_whole
    from fieldline.frames.time import as_utc
    from fieldline.orbit import read_orbit

    refuse_inputs([out], [orbit_path])
    first, last = as_utc(start, "--start"), as_utc(stop, "--stop")
    count = int((last - first) / np.timedelta64(1, "ns") * 1e-9 // step_s) + 1
    if not 1 <= count <= MOST_ROWS:
        raise InputError(f"--start {start} to --stop {stop} every {step_s:g} s is {count:,} rows; expected 1 to {MOST_ROWS:,}.")
    times = first + np.rint(np.arange(count) * step_s * 1e9).astype("timedelta64[ns]")
    orbit = read_orbit(orbit_path, norad_id=norad_id)
    for warning in orbit.check(times, max_age_days=max_age_days):
        typer.echo(f"warning: {warning}", err=True)
    table = field_table(times, orbit.position_e(times), model)
    write_whole(out, lambda path: table.to_csv(path, index=False, float_format="%.9g", lineterminator="\n"))
    print(wrote([out]))
    return 0


def field_table(time_utc: Any, position_e: Any, model: str) -> Any:
    """A pandas table: time, place, and the field in Earth-fixed axes [nT]."""
    import numpy as np
    import pandas as pd

    from fieldline.environment import magnetic_field
    from fieldline.frames.earth_rotation import geodetic_from_itrs
    from fieldline.frames.time import iso_utc

    field_e = 1e9 * magnetic_field(position_e, time_utc, model=model)
    latitude, longitude, height = geodetic_from_itrs(position_e)
    columns = {
        "time_utc": iso_utc(time_utc),
        "latitude_deg": np.degrees(latitude),
        "longitude_deg": np.degrees(longitude),
        "altitude_km": 1e-3 * height,
    }
    columns |= {f"field_{axis}_itrs_nT": field_e[:, k] for k, axis in enumerate("xyz")}
    return pd.DataFrame(columns | {"magnitude_nT": np.linalg.norm(field_e, axis=1)})
