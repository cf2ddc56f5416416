"""Options that several commands share, written once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

Telemetry = Annotated[Path, typer.Argument(help="Telemetry: CSV, Parquet, NetCDF or CDF.", show_default=False)]
Orbit = Annotated[
    Path | None,
    typer.Option(help="Orbit: TLE, OMM or OEM. May be left out when the telemetry has position columns.", show_default=False),
]
Out = Annotated[
    Path | None,
    typer.Option(
        help="Path without ending of the results; by default the input's name, in this folder.",
        show_default=False,
        metavar="STEM",
    ),
]
Model = Annotated[str, typer.Option(help="Field model; `fieldline models` lists them.")]
Mapping = Annotated[
    Path | None, typer.Option(help="TOML file that says which column is what, in which unit.", show_default=False)
]
MagColumns = Annotated[str | None, typer.Option(help="The magnetometer's columns x,y,z.", show_default=False, metavar="X,Y,Z")]
TimeColumn = Annotated[str | None, typer.Option(help="The time column.", show_default=False)]
Unit = Annotated[str | None, typer.Option(help="The magnetometer's unit: T, uT, nT, G, mG.", show_default=False)]
Repair = Annotated[bool, typer.Option("--repair", help="Sort unordered times, drop repeated ones and unreadable rows.")]
Eop = Annotated[
    Path | None, typer.Option(help="Earth orientation: finals2000A or C04. UT1 = UTC without it.", show_default=False)
]
NoradId = Annotated[int | None, typer.Option(help="Which satellite, where the orbit file has several.", show_default=False)]
MaxAge = Annotated[float, typer.Option(help="Refuse an element set that is further away than this.", min=0.0)]
Figures = Annotated[bool, typer.Option("--figures", help="Write each figure as PNG and SVG too, into STEM_figures/.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]
Json = Annotated[bool, typer.Option("--json", help="Print the verdict as JSON, and nothing else, on stdout.")]
