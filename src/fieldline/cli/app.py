"""The commands of `fieldline`; each lives in a file of its own and loads what it needs when it runs."""

from __future__ import annotations

import typer

from fieldline import __version__
from fieldline.cli.attitude import attitude
from fieldline.cli.calibrate import calibrate
from fieldline.cli.case import case
from fieldline.cli.demo import demo
from fieldline.cli.design import design
from fieldline.cli.field import field
from fieldline.cli.models import models
from fieldline.cli.scenario import scenario
from fieldline.cli.simulate import simulate
from fieldline.cli.skiprope import skiprope

app = typer.Typer(
    name="fieldline",
    help="Attitude, rate and their uncertainty from magnetometer telemetry and an orbit; the field; the calibration.",
    epilog="Exit codes: 0 usable, 1 the data do not support an estimate, 2 bad input.",
    add_completion=False,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)

for command in (attitude, calibrate, skiprope, simulate, field, demo, case, models):
    app.command()(command)
app.add_typer(design, name="design")
app.add_typer(scenario, name="scenario")


def _print_version(wanted: bool) -> None:
    """The version alone, for scripts."""
    if wanted:
        print(f"fieldline {__version__}")
        raise typer.Exit()


@app.callback()
def about(
    version: bool = typer.Option(False, "--version", help="Print the version and stop.", is_eager=True, callback=_print_version),
    debug: bool = typer.Option(False, "--debug", help="Show the whole traceback of an error."),
) -> None:
    """What every command shares."""
