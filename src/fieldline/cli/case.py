"""`fieldline case`: a paper's own set-up, rerun with its numbers or the user's."""

from __future__ import annotations

import inspect
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer

from fieldline.cli import options
from fieldline.cli.outputs import targets, wrote
from fieldline.errors import InputError, nearest


def case(
    name: Annotated[str, typer.Argument(help="The case, named after its source, for example natanson_1990.")],
    set_: Annotated[
        list[str] | None, typer.Option("--set", help="An argument of the case, as TOML.", metavar="KEY=VALUE", show_default=False)
    ] = None,
    out: options.Out = None,
    quiet: options.Quiet = False,
) -> int:
    """Run a published case: writes STEM.nc with every signal and STEM.png with the figure."""
    from fieldline.cases import case_named

    run = case_named(name)
    arguments = parse_settings(set_ or [], run)
    stem = Path(name) if out is None else out
    paths = targets(stem, (".nc", ".png"), [])
    dataset = run(**arguments)
    written = _write(dataset, paths)
    if not quiet:
        print(wrote(written))
    return 0


def _write(dataset: Any, paths: dict[str, Path]) -> list[Path]:
    """The signals and their figure, together."""
    from fieldline.files import write_together
    from fieldline.report.case_figure import case_figure
    from fieldline.report.theme import write_png
    from fieldline.telemetry import write_attitude_netcdf

    figure = case_figure(dataset)
    return write_together(
        [(paths[".nc"], lambda path: write_attitude_netcdf(dataset, path)), (paths[".png"], lambda path: write_png(figure, path))]
    )


def parse_settings(settings: list[str], run: Callable[..., Any]) -> dict[str, Any]:
    """KEY=VALUE pairs as arguments of `run`: values are TOML; a single word may stand without quotes."""
    known = inspect.signature(run).parameters
    arguments: dict[str, Any] = {}
    for one in settings:
        key, equals, text = (part.strip() for part in one.partition("="))
        if not equals or not key or not text:
            raise InputError(f'--set needs KEY=VALUE, for example --set step_s=120.0; got "{one}".')
        if key not in known:
            raise InputError(f"--set {key}: the case has no such argument; {nearest(key, known)}")
        arguments[key] = _literal(key, text)
    return arguments


def _literal(key: str, text: str) -> Any:
    """The value of a TOML literal."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError as error:
        if re.fullmatch(r"[A-Za-z][\w-]*", text):
            return text
        raise InputError(f'--set {key}: "{text}" is not a TOML value. Write 1.5, true, [1.0, 2.0, 3.0] or "words".') from error
