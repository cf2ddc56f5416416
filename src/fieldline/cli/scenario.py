"""`fieldline scenario`: a scenario file begun from a template, checked, and explained key by key."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from fieldline.errors import InputError, shown

scenario = typer.Typer(
    help="Begin, check and look up scenario files (TOML).",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)


@scenario.command()
def new(
    name: Annotated[str | None, typer.Argument(help="Name of the scenario.", show_default=False)] = None,
    template: Annotated[str, typer.Option(help="Which mission to begin from; --list tells them.")] = "detumble",
    out: Annotated[
        Path | None, typer.Option(help="The file; by default NAME.toml in this folder.", show_default=False, metavar="FILE")
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="List the templates and stop.")] = False,
) -> int:
    """Write a complete, commented scenario to change and fly."""
    from fieldline.cli.outputs import exists
    from fieldline.files import write_text_whole
    from fieldline.simulate.scenario.templates import TEMPLATES
    from fieldline.simulate.scenario.templates import template as template_text

    if list_:
        print("\n".join(f"{one:<14} {words}" for one, words in TEMPLATES.items()))
        return 0
    if name is None:
        raise InputError("fieldline scenario new needs a NAME, for example: fieldline scenario new cubesat --template detumble")
    last = Path(name).name
    if last in ("", "..") or not name.isprintable():
        raise InputError(f'a scenario cannot be named "{shown(name)}"; give it a name such as cubesat.')
    path = Path(f"{name}.toml") if out is None else out
    if exists(path, "the file"):
        raise InputError(f'"{path}" exists already, and is left as it is. Choose another name, or --out.')
    write_text_whole(path, template_text(template, last))
    print(f"wrote {path}, from the template {template}")
    if last in TEMPLATES and last != template:
        print(f"A template is called {last}, too: fieldline scenario new NAME --template {last}")
    return 0


@scenario.command()
def check(
    file: Annotated[Path, typer.Argument(help="Scenario: TOML.", show_default=False)],
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print problems alone.")] = False,
) -> int:
    """Check a scenario and print what was understood; every problem is told at once, exit code 2."""
    from fieldline.simulate.scenario import Scenario
    from fieldline.simulate.scenario.summary import summary

    read = Scenario.read(file)
    for warning in read.check():
        typer.echo(f"warning: {warning}", err=True)
    if not quiet:
        print(summary(read))
    return 0


@scenario.command()
def schema(
    markdown: Annotated[bool, typer.Option("--markdown", help="Tables for people instead of JSON Schema.")] = False,
) -> int:
    """Print every key with its unit, bounds and default: JSON Schema, which editors understand, or tables."""
    from fieldline.simulate.scenario.schema import json_schema
    from fieldline.simulate.scenario.schema import markdown as tables

    if markdown:
        print(tables(), end="")
    else:
        import json

        print(json.dumps(json_schema(), indent=2))
    return 0
