"""`fieldline demo`: what the package carries, estimated without network: a flown orbit, or a satellite on a tether."""

from __future__ import annotations

from importlib.resources import as_file, files
from pathlib import Path
from typing import Annotated

import typer

from fieldline.cli import attitude, options, skiprope
from fieldline.cli.inputs import Source
from fieldline.errors import InputError, nearest

SAMPLES = {"attitude": ("suchai3_2023-08-24.csv", "suchai3.tle"), "skiprope": ("skiprope.csv", "skiprope.tle")}
TETHER_LENGTH_M = 20e3


def demo(
    what: Annotated[str, typer.Argument(help="attitude, of a flown cubesat; or skiprope, of a simulated tether.")] = "attitude",
    out: Annotated[Path, typer.Option(help="Folder for the results.", metavar="FOLDER")] = Path("fieldline-demo"),
    quiet: options.Quiet = False,
    as_json: options.Json = False,
) -> int:
    """Estimate one orbit that comes with Fieldline, and write its report.

    attitude: the cubesat SUCHAI-3, flown on 24 August 2023. skiprope: a satellite on 20 km of tether, simulated.
    """
    if what not in SAMPLES:
        raise InputError(f'demo "{what}" is not known; {nearest(what, SAMPLES)}')
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f'cannot make the folder "{out}": {error.strerror}. Choose another with --out.') from error
    data = files("fieldline") / "data"
    sample, elements = SAMPLES[what]
    with as_file(data / sample) as telemetry, as_file(data / elements) as orbit:
        stem = out / Path(sample).stem
        given = {"telemetry": telemetry, "stem": stem, "source": Source(orbit=orbit), "quiet": quiet, "as_json": as_json}
        if what == "skiprope":
            code = skiprope.run(skiprope.Job(**given, settings={"tether_length_m": TETHER_LENGTH_M}))
        else:
            code = attitude.run(attitude.Job(**given))
    if not quiet and not as_json:
        print(f"open {stem.resolve()}.html in a browser: the report")
    return code
