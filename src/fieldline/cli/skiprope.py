"""`fieldline skiprope`: telemetry of a satellite on a tether and an orbit in; the tether's skiprope out."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from fieldline.cli import options
from fieldline.cli.attitude import read_calibration
from fieldline.cli.inputs import Source, orbit_for, read_flight
from fieldline.cli.outputs import exists, refuse_inputs, refuse_twins, stem_of, targets, wrote
from fieldline.cli.progress import Progress, progress_on_stderr
from fieldline.errors import InputError

ENDINGS = (".nc", ".csv", ".html")
STREAM = "-"
LIVE_ONLY = "the live mode: TELEMETRY - (standard input), or --follow"


@dataclass(frozen=True, kw_only=True)
class Job:
    """All that one run is told."""

    telemetry: Path
    stem: Path | None
    source: Source
    settings: dict[str, Any]
    calibration: str = "none"
    report: Path | None = None
    state: Path | None = None
    figures: bool = False
    quiet: bool = False
    as_json: bool = False


def skiprope(
    telemetry: Annotated[
        Path,
        typer.Argument(help="Telemetry: CSV, Parquet, NetCDF or CDF; - for rows of text on standard input.", show_default=False),
    ],
    tether_length_m: Annotated[
        float | None, typer.Option(help="Length of the tether, in m; or give --tether-lengths.", show_default=False)
    ] = None,
    orbit: options.Orbit = None,
    frequency_hz: Annotated[
        float | None, typer.Option(help="A first frequency of the skiprope; found by default.", show_default=False)
    ] = None,
    method: Annotated[str, typer.Option(help="harmonic, kalman, or bandpass (TP-3123).")] = "harmonic",
    out: options.Out = None,
    plane: Annotated[
        str,
        typer.Option(help="Whose crossings are asked: field, orbit, normal, or an azimuth in deg from the orbit's normal aft."),
    ] = "field",
    sensor_axes: Annotated[
        str, typer.Option(help="Which sensor axes lie along body x, y, z, as x,-y,-z; or nine numbers.", metavar="X,Y,Z")
    ] = "x,y,z",
    attitude_deg: Annotated[
        str, typer.Option(help="The body's usual attitude against the orbital axes.", metavar="ROLL,PITCH,YAW")
    ] = "0,0,0",
    tether: Annotated[str, typer.Option(help="The way it leaves the satellite: down or up.")] = "down",
    steady_s: Annotated[
        float | None,
        typer.Option(help="Harmonic: how long the cone keeps its ellipse; ten periods by default.", show_default=False),
    ] = None,
    reeled: Annotated[
        bool, typer.Option("--reeled", help="Kalman: the tether is paid out or taken in; its frequency runs.")
    ] = False,
    tether_lengths: Annotated[
        Path | None,
        typer.Option(
            help="Of a tether on the reel: a table with time_utc and length_m; may be the telemetry.", show_default=False
        ),
    ] = None,
    end_mass_kg: Annotated[
        float | None, typer.Option(help="Mass of the lighter end; narrows the search, with --tether-g-per-m.", show_default=False)
    ] = None,
    tether_g_per_m: Annotated[float | None, typer.Option(help="Mass of a metre of tether, in g.", show_default=False)] = None,
    swing_hz: Annotated[
        str | None,
        typer.Option(
            help="Frequency of the satellite's swing on its tether, or found; taken off the deflection.", show_default=False
        ),
    ] = None,
    ignore_yaw: Annotated[bool, typer.Option("--ignore-yaw", help="Leave a yaw column of the telemetry aside.")] = False,
    model: options.Model = "IGRF-14",
    calibration: Annotated[str, typer.Option(help="none, auto, bias, full, or a FILE of `fieldline calibrate`.")] = "none",
    mapping: options.Mapping = None,
    mag_columns: options.MagColumns = None,
    time_column: options.TimeColumn = None,
    unit: options.Unit = None,
    repair: options.Repair = False,
    eop: options.Eop = None,
    norad_id: options.NoradId = None,
    max_orbit_age_days: options.MaxAge = 30.0,
    follow: Annotated[bool, typer.Option("--follow", help="Live: go on reading a file of text that grows.")] = False,
    state: Annotated[
        Path | None,
        typer.Option(help="Live: what is remembered goes here, and comes from here after a restart.", show_default=False),
    ] = None,
    every_s: Annotated[
        float | None, typer.Option(help="Live: between estimates; half a period, harmonic one and a half.", show_default=False)
    ] = None,
    memory_s: Annotated[
        float | None, typer.Option(help="Live: rows as old as this are used; twenty periods by default.", show_default=False)
    ] = None,
    silence_s: Annotated[float, typer.Option(help="Live: tell of a stream that brings nothing for so long.", min=0.1)] = 60.0,
    stop_after_s: Annotated[
        float | None, typer.Option(help="Live: end after so long without a row.", min=0.1, show_default=False)
    ] = None,
    figures: options.Figures = False,
    report: Annotated[Path | None, typer.Option(help="Where the report goes instead of STEM.html.", show_default=False)] = None,
    quiet: options.Quiet = False,
    as_json: options.Json = False,
) -> int:
    """Skiprope of a tether from the magnetometer of the satellite on it: amplitude, frequency, sense, plane.

    Writes STEM.csv (the table, with the next three crossings of a plane), STEM.nc (everything) and STEM.html (the report).
    Live, it writes rows of that table to standard output as they come.
    """
    source = Source(
        orbit=orbit, mapping=mapping, mag_columns=mag_columns, time_column=time_column, unit=unit, repair=repair, eop=eop,
        norad_id=norad_id, max_orbit_age_days=max_orbit_age_days,
    )  # fmt: skip
    settings = {
        "tether_length_m": tether_length_m, "frequency_hz": frequency_hz, "method": method, "model": model, "plane": plane,
        "sensor_axes": sensor_axes, "attitude_deg": three_angles(attitude_deg), "tether": tether, "use_yaw": not ignore_yaw,
        "steady_s": steady_s,
        "reeled": reeled, "end_mass_kg": end_mass_kg,
        "tether_kg_m": None if tether_g_per_m is None else 1e-3 * tether_g_per_m, "swing": swing_of(swing_hz),
    }  # fmt: skip
    if tether_lengths is not None:
        from fieldline.estimation.skiprope_telemetry import read_tether_lengths

        settings["lengths"] = read_tether_lengths(tether_lengths)
    from fieldline.estimation.skiprope_telemetry.face import length_of

    settings["tether_length_m"] = length_of(tether_length_m, settings.get("lengths"))
    live = follow or str(telemetry) == STREAM
    only = {"--state": state, "--every-s": every_s, "--memory-s": memory_s, "--stop-after-s": stop_after_s}
    asked = [name for name, value in only.items() if value is not None]
    if asked and not live:
        raise InputError(f"{asked[0]} is of {LIVE_ONLY}.")
    stem = None if live and out is None else stem_of(out, telemetry, "skiprope")
    job = Job(
        telemetry=telemetry, stem=stem, source=source, settings=settings, calibration=calibration, report=report,
        state=state, figures=figures, quiet=quiet, as_json=as_json,
    )  # fmt: skip
    if live:
        from fieldline.cli.skiprope_live import Live, watch

        if as_json:
            raise InputError("--json is not of the live mode, whose output is rows; use --out and read the report's NetCDF.")
        return watch(job, Live(follow, state, every_s, memory_s, silence_s, stop_after_s))
    return run(job)


def run(job: Job) -> int:
    """Estimate from a whole file, write, say what came out; the exit code is the verdict's."""
    paths = output_paths(job)
    calibration = read_calibration(job.calibration)
    with progress_on_stderr(job.quiet) as progress:
        settings_of(job)  # refused before anything long is read
        telemetry = read_flight(job.telemetry, job.source, progress)
        orbit = orbit_for(telemetry, job.source, progress)
        from fieldline.estimation.skiprope_telemetry import estimate_skiprope

        estimate = estimate_skiprope(
            telemetry, orbit, **job.settings, calibration=chosen(calibration, telemetry.time_utc), progress=progress
        )
        written = write_estimate(estimate, paths, job, progress)
    tell(json.loads(estimate.attrs["verdict_json"]), job, written)
    return int(json.loads(estimate.attrs["verdict_json"])["exit_code"])


def settings_of(job: Job, calibration: Any = "none") -> Any:
    """The options as the estimator takes them, refused in words where they cannot be."""
    from fieldline.estimation.skiprope_telemetry import Mounting, SkipropeSettings

    mounting = {name: job.settings[name] for name in ("sensor_axes", "attitude_deg", "tether") if name in job.settings}
    others = {name: value for name, value in job.settings.items() if name not in mounting}
    return SkipropeSettings(mounting=Mounting(**mounting), calibration=calibration, **others)


def output_paths(job: Job) -> dict[str, Path]:
    """Where the files go; refused before any work."""
    if job.stem is None:
        if job.report is not None or job.figures:
            raise InputError("a report or figures of the live mode need --out, whose files are written when the stream ends.")
        return {}
    inputs = [job.telemetry, job.source.orbit, job.source.mapping, job.source.eop]
    paths = targets(job.stem, ENDINGS, inputs)
    if job.report is not None:
        paths[".html"] = job.report
        refuse_inputs([job.report], inputs)
        if not job.report.parent.is_dir():
            raise InputError(f'--report "{job.report}": the folder "{job.report.parent}" does not exist. Make it first.')
    refuse_twins([*paths.values(), job.state])
    folder = job.stem.with_name(job.stem.name + "_figures")
    if job.figures and exists(folder, "--figures") and not folder.is_dir():
        raise InputError(f'the figures go into the folder "{folder}", but a file of that name is there; choose another --out.')
    return paths


def write_estimate(estimate: Any, paths: dict[str, Path], job: Job, progress: Progress) -> list[Path]:
    """All files of an estimate, together or not at all."""
    from fieldline.files import write_together
    from fieldline.report.skiprope_report import skiprope_html, write_skiprope_figures
    from fieldline.telemetry import write_attitude_netcdf
    from fieldline.telemetry.skiprope_csv import write_skiprope_csv

    progress("writing", 0, 1)
    writers: dict[str, Callable[[Path], object]] = {
        ".nc": lambda path: write_attitude_netcdf(estimate, path),
        ".csv": lambda path: write_skiprope_csv(estimate, path),
        ".html": lambda path: path.write_text(skiprope_html(estimate), encoding="utf-8"),
    }
    written = write_together([(path, writers[ending]) for ending, path in paths.items()])
    if job.figures and job.stem is not None:
        written += [write_skiprope_figures(estimate, job.stem.with_name(job.stem.name + "_figures"))[0].parent]
    progress("writing", 1, 1, f"{len(written)} files")
    return written


def tell(verdict: dict[str, Any], job: Job, written: list[Path]) -> None:
    """The verdict on standard output, in words or as JSON."""
    if job.as_json:
        print(json.dumps(verdict, indent=2))
    elif not job.quiet:
        lines = [verdict["sentence"], *verdict["notes"], *verdict["warnings"], wrote(written)]
        print("\n".join(line for line in lines if line))


def chosen(calibration: Any, time_utc: Any) -> Any:
    """The word, or the calibration of the file that was found nearest in time."""
    if isinstance(calibration, str):
        return calibration
    from fieldline.estimation.calibration_file import nearest_in_time

    return nearest_in_time(calibration, time_utc)


def swing_of(text: str | None) -> float | str | None:
    """A frequency, the word found, or nothing."""
    if text is None or text == "found":
        return text
    try:
        return float(text)
    except ValueError:
        raise InputError(f'--swing-hz is a frequency in Hz, or the word found; got "{text}".') from None


def three_angles(text: str) -> tuple[float, float, float]:
    """roll,pitch,yaw as numbers."""
    try:
        angles = tuple(float(part) for part in text.split(","))
    except ValueError:
        angles = ()
    if len(angles) != 3:
        raise InputError(f'--attitude-deg needs the three angles "roll,pitch,yaw" with commas between them; got "{text}".')
    return angles[0], angles[1], angles[2]
