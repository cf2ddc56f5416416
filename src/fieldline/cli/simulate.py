"""`fieldline simulate`: a scenario in; every signal of its flight, a report, and on request the telemetry out."""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from fieldline.cli import options
from fieldline.cli.outputs import Told, exists, refuse_inputs, refuse_twins, stem_of, targets, wrote
from fieldline.cli.progress import Progress, progress_on_stderr
from fieldline.errors import InputError

INTERRUPTED = 130
PARTIAL = 2
LEAST_ROWS = 2  # outputs that a report needs
COMPILING_AFTER_S = 2.5  # a plant that is only loaded takes half a second


@dataclass(frozen=True, kw_only=True)
class Job:
    """Where everything of one run goes."""

    paths: dict[str, Path]
    stem: Path
    telemetry: Path | None
    body: str | None
    figures: bool


def simulate(
    scenario: Annotated[Path, typer.Argument(help="Scenario: TOML; `fieldline scenario new` begins one.", show_default=False)],
    out: options.Out = None,
    seed: Annotated[
        int | None, typer.Option(help="Seed in place of the scenario's.", min=0, show_default=False, metavar="N")
    ] = None,
    as_telemetry: Annotated[
        Path | None,
        typer.Option(help="Write what the sensors said as telemetry too: CSV.", show_default=False, metavar="FILE"),
    ] = None,
    body: Annotated[
        str | None,
        typer.Option(help="Whose telemetry; the first body with a magnetometer by default.", show_default=False, metavar="NAME"),
    ] = None,
    report: Annotated[Path | None, typer.Option(help="Where the report goes instead of STEM.html.", show_default=False)] = None,
    figures: options.Figures = False,
    quiet: options.Quiet = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the key numbers as JSON, and nothing else, on stdout.")] = False,
) -> int:
    """Fly a scenario: orbit, attitude, environment, sensors and flight software.

    Writes STEM.nc (every signal) and STEM.html (the report). A run that fails or is interrupted writes what it has, marked
    partial.
    """
    from fieldline.simulate.outcome import RunError, RunInterrupted
    from fieldline.simulate.run import simulate as fly
    from fieldline.simulate.scenario import Scenario

    job = _job(scenario, out, as_telemetry, body, report, figures)
    flown = Scenario.read(scenario)
    _check_telemetry(flown, job)
    outputs = [*job.paths.values(), *([job.telemetry] if job.telemetry else [])]
    refuse_inputs(outputs, [flown.folder / name for name in flown.files()])
    for warning in flown.check():
        if not quiet:
            print(f"warning: {warning}", file=sys.stderr)
    code, message = 0, ""
    with progress_on_stderr(quiet) as progress:
        try:
            with _told_of_compiling(progress), redirect_stdout(sys.stderr):  # what a law prints is no result
                dataset = fly(flown, seed=seed, progress=_flying(flown, progress))
            progress("flying", 1, 1, str(dataset.attrs["outcome"]))
        except RunInterrupted as stop:
            dataset, code, message = stop.dataset, INTERRUPTED, f"fieldline: {stop}"
        except RunError as error:
            dataset, code, message = error.dataset, PARTIAL, f"fieldline: {error}"
        written = write_run(dataset, job, progress)
    _tell(dataset, written, quiet, as_json)
    if message:
        kept = f" What was simulated until then is kept, marked partial: {', '.join(map(str, written))}." if written else ""
        print(f"{message}{kept or ' Nothing was written.'}", file=sys.stderr)
    return Told(code)


def _job(scenario: Path, out: Path | None, telemetry: Path | None, body: str | None, report: Path | None, figures: bool) -> Job:
    """Where things go, refused before any work where they cannot."""
    stem = stem_of(out, scenario, "run")
    paths = targets(stem, (".nc", ".html"), [scenario])
    for option, path in (("--report", report), ("--as-telemetry", telemetry)):
        if path is not None and not path.parent.is_dir():
            raise InputError(f'{option} "{path}": the folder "{path.parent}" does not exist. Make it first.')
        refuse_inputs([path] if path is not None else [], [scenario])
    if report is not None:
        paths[".html"] = report
    refuse_twins([*paths.values(), telemetry])
    folder = _figures_of(stem)
    if figures and exists(folder, "--figures") and not folder.is_dir():
        raise InputError(f'--figures: the figures go into the folder "{folder}", but a file of that name is there. Move it away.')
    if telemetry is not None and telemetry.suffix.lower() != ".csv":
        raise InputError(f'--as-telemetry "{telemetry}": telemetry is written as CSV; give a name that ends in .csv.')
    if body is not None and telemetry is None:
        raise InputError("--body says whose telemetry is written; give --as-telemetry FILE.csv with it.")
    return Job(paths=paths, stem=stem, telemetry=telemetry, body=body, figures=figures)


def _figures_of(stem: Path) -> Path:
    """The folder of the figures."""
    return stem.with_name(stem.name + "_figures")


def _check_telemetry(scenario: Any, job: Job) -> None:
    """InputError, before the flight, where there would be no telemetry after it."""
    if job.telemetry is None:
        return
    from fieldline.errors import nearest

    names = [body.name for body in scenario.body]
    if job.body is not None and job.body not in names:
        raise InputError(f'--body "{job.body}": the scenario has no such body; {nearest(job.body, names)}')
    asked = [body for body in scenario.body if job.body in (None, body.name)]
    if not any(body.magnetometer for body in asked):
        who = f'the body "{job.body}"' if job.body else "no body"
        raise InputError(f"--as-telemetry: {who} has {'no' if job.body else 'a'} magnetometer. Add one: [body.magnetometer].")


def _flying(scenario: Any, progress: Progress) -> Callable[[float], None]:
    """The plant's fraction as the bar of the flight."""
    return lambda fraction: progress("flying", min(fraction, 0.999), 1, scenario.name)


@contextmanager
def _told_of_compiling(progress: Progress) -> Iterator[None]:
    """Say so where the plant is being compiled, which takes a minute the first time and after an update."""
    done = threading.Event()

    def watch() -> None:
        while not done.wait(COMPILING_AFTER_S):
            module = sys.modules.get("fieldline.simulate.loop.fly")
            if getattr(getattr(module, "fly", None), "is_compiling", False):
                progress("compiling the plant", 1, 1, "once; it takes about a minute")
                return

    watcher = threading.Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        done.set()
        watcher.join()


def write_run(dataset: Any, job: Job, progress: Progress) -> list[Path]:
    """All files of a run, together or not at all; a run too short for a report leaves none."""
    from fieldline.files import write_together
    from fieldline.telemetry import write_attitude_netcdf

    if dataset.sizes["time"] < LEAST_ROWS:
        return []
    from fieldline.report.simulation_report import simulation_html, write_simulation_figures

    progress("writing", 0, 1)
    files: list[tuple[Path, Callable[[Path], object]]] = [
        (job.paths[".nc"], lambda path: write_attitude_netcdf(dataset, path)),
        (job.paths[".html"], lambda path: path.write_text(simulation_html(dataset), encoding="utf-8")),
    ]
    if job.telemetry is not None and dataset.attrs["complete"]:
        from fieldline.simulate.as_telemetry import telemetry_of_run
        from fieldline.telemetry.telemetry_csv import write_telemetry_csv

        telemetry = telemetry_of_run(dataset, job.body)
        files.append((job.telemetry, lambda path: write_telemetry_csv(telemetry, path)))
        for line in telemetry.ignored:
            progress("telemetry", 1, 1, line)
    written = write_together(files)
    if job.figures:
        written += [write_simulation_figures(dataset, _figures_of(job.stem))[0].parent]
    progress("writing", 1, 1, f"{len(written)} files")
    return written


def _tell(dataset: Any, written: list[Path], quiet: bool, as_json: bool) -> None:
    """The key numbers on stdout: JSON, a few lines, or nothing."""
    if dataset.sizes["time"] < LEAST_ROWS or (quiet and not as_json):
        return
    from fieldline.report.run_numbers import run_numbers

    numbers = run_numbers(dataset)
    if as_json:
        print(json.dumps(numbers | {"files": [str(path) for path in written]}, indent=2))
    else:
        print("\n".join([*summary(numbers), wrote(written)]))


def summary(numbers: dict[str, Any]) -> list[str]:
    """What flew and how it ended, then a line for each body that turns and each tether."""
    from fieldline.report.run_line_numbers import line_summary

    hours = numbers["duration_s"] / 3600.0
    partial = "" if numbers["complete"] else "PARTIAL: "
    lines = [f"{partial}{numbers['scenario']}: {hours:.4g} h from {numbers['start_utc']}, {numbers['outcome']}"]
    for name, body in numbers["bodies"].items():
        parts = [f"rate {body['rate_start_deg_s']:.3g} → {body['rate_end_deg_s']:.3g} °/s"]
        if "at_rest_after_s" in body:
            parts.append(f"at rest after {body['at_rest_after_s'] / 3600.0:.3g} h")
        if "pointing" in body:
            told = body["pointing"]
            parts.append(f"pointing {_angle(told['rms_deg'])} RMS, {_angle(told['worst_deg'])} at worst in the last quarter")
        parts += [f"{what} at their limit {100.0 * share:.3g} %" for what, share in body.get("saturated_share", {}).items()]
        lines.append(f"{name}: " + " · ".join(parts))
    lines += [line_summary(name, line) for name, line in numbers["lines"].items()]
    if numbers["events"]:
        lines.append("1 event" if numbers["events"] == 1 else f"{numbers['events']} events")
    return lines


def _angle(degrees: float) -> str:
    """Degrees, or seconds of arc where that is small."""
    return f"{degrees:.3g}°" if degrees >= 0.02 else f"{3600.0 * degrees:.3g}″"
