"""`fieldline demo`: the flown orbit that the package carries, estimated without network."""

from __future__ import annotations

from importlib.resources import as_file, files
from pathlib import Path
from typing import Annotated

import typer

from fieldline.cli import options
from fieldline.cli.attitude import Job, run
from fieldline.cli.inputs import Source
from fieldline.errors import InputError

SAMPLE = "suchai3_2023-08-24.csv"
ELEMENTS = "suchai3.tle"


def demo(
    out: Annotated[Path, typer.Option(help="Folder for the results.", metavar="FOLDER")] = Path("fieldline-demo"),
    quiet: options.Quiet = False,
    as_json: options.Json = False,
) -> int:
    """Estimate one orbit of the cubesat SUCHAI-3 (24 August 2023) that comes with Fieldline, and write its report."""
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f'cannot make the folder "{out}": {error.strerror}. Choose another with --out.') from error
    data = files("fieldline") / "data"
    with as_file(data / SAMPLE) as telemetry, as_file(data / ELEMENTS) as elements:
        stem = out / Path(SAMPLE).stem
        job = Job(telemetry=telemetry, stem=stem, source=Source(orbit=elements), quiet=quiet, as_json=as_json)
        code = run(job)
    if not quiet and not as_json:
        print(f"open {stem.resolve()}.html in a browser: the report")
    return code
