"""`fieldline calibrate`: bias, matrix and gain of a magnetometer from one or several files of a satellite."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

import typer

from fieldline.cli import options
from fieldline.cli.inputs import Source, orbit_for, read_flight
from fieldline.cli.outputs import stem_of, targets, wrote
from fieldline.cli.progress import progress_on_stderr
from fieldline.errors import NoEstimateError

ENDINGS = (".json", ".html")


def calibrate(
    telemetry: Annotated[list[Path], typer.Argument(help="One or several files of one satellite.", show_default=False)],
    orbit: options.Orbit = None,
    out: options.Out = None,
    model: options.Model = "IGRF-14",
    calibration: Annotated[
        str, typer.Option(help="The sensor's model: auto, bias, full, full+gain, full+drift, full+temperature, ...")
    ] = "auto",
    use: Annotated[
        list[str] | None, typer.Option(help="Columns that terms may use: temperature, dipole, current.", show_default=False)
    ] = None,
    clock_scan: Annotated[
        bool, typer.Option("--clock-scan", help="Also tell whether shifted time stamps would fit better; nothing is shifted.")
    ] = False,
    mapping: options.Mapping = None,
    mag_columns: options.MagColumns = None,
    time_column: options.TimeColumn = None,
    unit: options.Unit = None,
    repair: options.Repair = False,
    eop: options.Eop = None,
    norad_id: options.NoradId = None,
    max_orbit_age_days: options.MaxAge = 30.0,
    quiet: options.Quiet = False,
    as_json: options.Json = False,
) -> int:
    """Calibrate a magnetometer from the magnitude of its readings, without attitude.

    Writes STEM.json, which `fieldline attitude --calibration STEM.json` takes, and STEM.html. Several files share matrix and
    bias; each has a gain of its own.
    """
    source = Source(
        orbit=orbit, mapping=mapping, mag_columns=mag_columns, time_column=time_column, unit=unit, repair=repair, eop=eop,
        norad_id=norad_id, max_orbit_age_days=max_orbit_age_days,
    )  # fmt: skip
    paths = targets(stem_of(out, telemetry[0], "calibration"), ENDINGS, [*telemetry, orbit, mapping, eop])
    columns = tuple(name.strip() for one in use or () for name in one.split(","))
    from fieldline.estimation.calibrate import calibrate as calibrated
    from fieldline.report.calibration_report import misfit, verdict_sentence

    with progress_on_stderr(quiet) as progress:
        flown = [read_flight(path, source, progress) for path in telemetry]
        orbits = [orbit_for(one, source, progress) for one in flown]
        progress("calibration", 0, 1)
        found: Any = calibrated(flown, orbits, model=model, calibration=calibration, clock_scan=clock_scan, use=columns)
        progress("calibration", 1, 1, f"{found[0].model}, {', '.join(f'{1e9 * c.residual_rms_tesla:.0f}' for c in found)} nT RMS")
        flights = [_shown(c, t, o, model) for c, t, o in zip(found, flown, orbits, strict=True)]
        settings = {"model": model, "calibration": calibration, "clock_scan": clock_scan, "use": list(columns)}
        written = _write(found, flights, settings, paths)
    summaries = [flight.summary for flight in flights]
    if as_json:
        print(json.dumps(summaries[0] if len(summaries) == 1 else summaries, indent=2))
    elif not quiet:
        print(f"{verdict_sentence(summaries)}\n{wrote(written)}")
    doubt = misfit(flights)
    if doubt:
        raise NoEstimateError(doubt)
    return 0


def _shown(calibration: Any, telemetry: Any, orbit: Any, model: str) -> Any:
    """A flight as the report takes it, with the gain's knots on the flight's own clock."""
    import numpy as np

    from fieldline.environment import eclipse
    from fieldline.estimation.calibrate import columns_for
    from fieldline.estimation.reference import reference_along_orbit
    from fieldline.report.calibration_report import CalibratedFlight
    from fieldline.report.record import dark_spells

    reference = reference_along_orbit(telemetry.time_utc, orbit, model)
    field_b = calibration.apply(
        telemetry.seconds,
        telemetry.field_s,
        epoch_utc=telemetry.epoch_utc,
        **columns_for(calibration, telemetry, reference),
    )
    later_s = float((telemetry.epoch_utc - calibration.epoch_utc) / np.timedelta64(1, "s"))
    summary = calibration.summary()
    for key in ("gain_knots_s", "gain_curve_s"):
        summary[key] = [seconds - later_s for seconds in summary.get(key, [])]
    return CalibratedFlight(
        name=telemetry.name,
        time_utc=telemetry.time_utc,
        field_s=telemetry.field_s,
        field_b=field_b,
        magnitude_tesla=reference.magnitude,
        used=telemetry.usable,
        summary=summary,
        lines=telemetry.describe(),
        dark=dark_spells(telemetry.seconds, eclipse(reference.position_i, telemetry.time_utc)),
    )


def _write(found: tuple, flights: list, settings: dict[str, Any], paths: dict[str, Path]) -> list[Path]:
    """STEM.json and STEM.html, together."""
    from fieldline import __version__
    from fieldline.estimation.calibration_file import calibrations_to_json
    from fieldline.files import write_together
    from fieldline.report.calibration_report import calibration_html

    html = calibration_html(flights, settings, {"fieldline": __version__})
    return write_together(
        [
            (paths[".json"], lambda path: path.write_text(calibrations_to_json(found), encoding="utf-8")),
            (paths[".html"], lambda path: path.write_text(html, encoding="utf-8")),
        ]
    )
