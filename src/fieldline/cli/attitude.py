"""`fieldline attitude`: telemetry and an orbit in; attitude, rate, their uncertainty and a report out."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from fieldline.cli import options
from fieldline.cli.inputs import Source, orbit_for, read_flight
from fieldline.cli.outputs import refuse_inputs, stem_of, targets, wrote
from fieldline.cli.progress import Progress, progress_on_stderr
from fieldline.errors import InputError, nearest

CALIBRATIONS = ("auto", "none", "bias", "full")
USES = ("gyro", "temperature", "dipole", "current")
ENDINGS = (".nc", ".csv", ".aem", ".html")


@dataclass(frozen=True, kw_only=True)
class Job:
    """All that one run of the estimator is told."""

    telemetry: Path
    stem: Path
    source: Source
    model: str = "IGRF-14"
    use: tuple[str, ...] = ()
    calibration: str = "auto"
    inertia: str | None = None
    seed: int = 0
    report: Path | None = None
    figures: bool = False
    quiet: bool = False
    as_json: bool = False


def attitude(
    telemetry: options.Telemetry,
    orbit: options.Orbit = None,
    out: options.Out = None,
    model: options.Model = "IGRF-14",
    use: Annotated[
        list[str] | None, typer.Option(help="A further column to use: gyro, temperature, dipole, current.", show_default=False)
    ] = None,
    calibration: Annotated[str, typer.Option(help="auto, none, bias, full, or a FILE of `fieldline calibrate`.")] = "auto",
    mapping: options.Mapping = None,
    mag_columns: options.MagColumns = None,
    time_column: options.TimeColumn = None,
    unit: options.Unit = None,
    repair: options.Repair = False,
    inertia: Annotated[
        str | None, typer.Option(help="Inertia matrix of a rigid body, in kg m2.", metavar="IXX,IYY,IZZ[,IXY,IXZ,IYZ]")
    ] = None,
    eop: options.Eop = None,
    norad_id: options.NoradId = None,
    max_orbit_age_days: options.MaxAge = 30.0,
    seed: Annotated[int, typer.Option(help="Seed of every random draw.", min=0)] = 0,
    figures: options.Figures = False,
    report: Annotated[Path | None, typer.Option(help="Where the report goes instead of STEM.html.", show_default=False)] = None,
    quiet: options.Quiet = False,
    as_json: options.Json = False,
) -> int:
    """Attitude, rate and their uncertainty from magnetometer telemetry and an orbit.

    Writes STEM.nc (everything), STEM.csv (the table), STEM.aem (CCSDS attitude ephemeris) and STEM.html (the report).
    """
    source = Source(
        orbit=orbit, mapping=mapping, mag_columns=mag_columns, time_column=time_column, unit=unit, repair=repair, eop=eop,
        norad_id=norad_id, max_orbit_age_days=max_orbit_age_days,
    )  # fmt: skip
    job = Job(
        telemetry=telemetry, stem=stem_of(out, telemetry, "attitude"), source=source, model=model, use=_columns(use),
        calibration=calibration, inertia=inertia, seed=seed, report=report, figures=figures, quiet=quiet, as_json=as_json,
    )  # fmt: skip
    return run(job)


def run(job: Job) -> int:
    """Estimate, write, say what came out; the exit code is the verdict's."""
    inputs = [job.telemetry, job.source.orbit, job.source.mapping, job.source.eop]
    paths = targets(job.stem, ENDINGS, inputs)
    if job.report is not None:
        paths[".html"] = job.report
        refuse_inputs([job.report], inputs)
        if not job.report.parent.is_dir():
            raise InputError(f'--report "{job.report}": the folder "{job.report.parent}" does not exist. Make it first.')
    calibration, inertia = read_calibration(job.calibration), parse_inertia(job.inertia)
    with progress_on_stderr(job.quiet) as progress:
        telemetry = read_flight(job.telemetry, job.source, progress)
        orbit = orbit_for(telemetry, job.source, progress)
        estimate = _estimate(telemetry, orbit, job, _chosen(calibration, telemetry), inertia, progress)
        written = write_estimate(estimate, paths, progress)
        if job.figures:
            from fieldline.report import write_figures

            written += [write_figures(estimate, job.stem.with_name(job.stem.name + "_figures"))[0].parent]
    verdict = json.loads(estimate.attrs["verdict_json"])
    if job.as_json:
        print(json.dumps(verdict, indent=2))
    elif not job.quiet:
        from fieldline.report.verdict import doubts

        lines = [verdict["sentence"], summary(verdict), *doubts(verdict), *verdict.get("warnings", []), wrote(written)]
        print("\n".join(line for line in lines if line))
    return int(verdict.get("exit_code", 0))


def _estimate(telemetry: Any, orbit: Any, job: Job, calibration: Any, inertia: Any, progress: Progress) -> Any:
    """The estimator, called with the job's settings."""
    from fieldline.estimation import estimate_attitude

    return estimate_attitude(
        telemetry,
        orbit,
        model=job.model,
        calibration=calibration,
        use=job.use,
        inertia_kg_m2=inertia,
        progress=progress,
        seed=job.seed,
    )


def write_estimate(estimate: Any, paths: dict[str, Path], progress: Progress) -> list[Path]:
    """All files of an estimate, together or not at all."""
    from fieldline.files import write_together
    from fieldline.report import report_html
    from fieldline.telemetry import write_attitude_aem, write_attitude_csv, write_attitude_netcdf

    progress("writing", 0, 1)
    writers: dict[str, Callable[[Path], object]] = {
        ".nc": lambda path: write_attitude_netcdf(estimate, path),
        ".csv": lambda path: write_attitude_csv(estimate, path),
        ".aem": lambda path: write_attitude_aem(estimate, path),
        ".html": lambda path: path.write_text(report_html(estimate), encoding="utf-8"),
    }
    written = write_together([(path, writers[ending]) for ending, path in paths.items()])
    progress("writing", 1, 1, f"{len(written)} files")
    return written


def summary(verdict: dict[str, Any]) -> str:
    """For example: attitude 1σ 1.9° 2.2° 1.7° · rate 1σ 0.02 °/s · residual 1.1 µT · NIS 0.98 (consistent)."""
    parts = []
    if verdict.get("attitude_std_deg"):
        parts.append("attitude 1σ " + " ".join(f"{v:.2g}°" for v in verdict["attitude_std_deg"]))
    if verdict.get("rate_std_deg_s"):
        parts.append("rate 1σ " + " ".join(f"{v:.2g}" for v in verdict["rate_std_deg_s"]) + " °/s")
    if verdict.get("residual_rms_nt") is not None:
        parts.append(f"residual {verdict['residual_rms_nt'] / 1e3:.2g} µT")
    consistency = verdict.get("consistency") or {}
    if consistency.get("nis_mean") is not None:
        parts.append(f"NIS {consistency['nis_mean']:.2f} ({consistency.get('words', '')})")
    return " · ".join(parts)


def _columns(use: list[str] | None) -> tuple[str, ...]:
    """The columns of --use, given one by one or with commas."""
    names = tuple(name.strip() for one in use or () for name in one.split(","))
    for name in names:
        if name not in USES:
            raise InputError(f'--use "{name}": no such column; {nearest(name, USES)}')
    return names


def read_calibration(text: str) -> Any:
    """A word that the estimator knows, or the calibrations of a file."""
    if text in CALIBRATIONS:
        return text
    if not Path(text).is_file():
        raise InputError(
            f'--calibration "{text}" is neither a file nor one of {", ".join(CALIBRATIONS)}; {nearest(text, CALIBRATIONS)}'
        )
    from fieldline.estimation.calibration_file import read_calibrations

    return read_calibrations(text)


def _chosen(calibration: Any, telemetry: Any) -> Any:
    """The word, or the calibration of the file that was found nearest in time to the telemetry."""
    if isinstance(calibration, str):
        return calibration
    from fieldline.estimation.calibration_file import nearest_in_time

    return nearest_in_time(calibration, telemetry.time_utc)


def parse_inertia(text: str | None) -> Any:
    """(3, 3) [kg m2], symmetric, of the matrix's entries; one that no rigid body can have is refused."""
    if text is None:
        return None
    import numpy as np

    try:
        entries = [float(one) for one in text.split(",")]
    except ValueError:
        entries = []
    if len(entries) not in (3, 6):
        raise InputError(f'--inertia needs three or six numbers "ixx,iyy,izz[,ixy,ixz,iyz]" in kg m2; got "{text}".')
    xx, yy, zz, xy, xz, yz = (*entries, 0.0, 0.0, 0.0)[:6]
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    low, middle, high = np.linalg.eigvalsh(matrix) if np.isfinite(matrix).all() else (0.0, 0.0, 0.0)
    if low <= 0.0 or high > (low + middle) * (1.0 + 1e-9):
        raise InputError(
            f'--inertia "{text}": its principal values are {low:.4g}, {middle:.4g}, {high:.4g} kg m2; those of a body '
            "are positive and none exceeds the sum of the others. Products of inertia are the matrix's own entries."
        )
    return matrix
