"""`fieldline design`: coil, sized from what it must do, wire, the gauge table; conductor and vehicle in `design_vehicle`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from fieldline.cli import options
from fieldline.cli.design_vehicle import conductor, vehicle
from fieldline.errors import InputError

design = typer.Typer(no_args_is_help=True, help="Size coils, rods and conductors that steer by the field.")
design.command()(conductor)
design.command()(vehicle)

MOST_FIELD_NT = 1e6
ARGUMENTS = "moment_a_m2 torque_n_m diameter_m sides_m core_length_m core_diameter_m core_alloy core_shape current_a voltage_v "
ARGUMENTS += "power_w mass_kg mass_per_watt_kg temperature_c"
OPTION_OF = {name: "--" + name.replace("_", "-") for name in ARGUMENTS.split()}
OPTION_OF |= {"field_tesla": "--field-nt", "wire_area_m2": "--wire-area-mm2", "insulation_m": "--insulation-mm"}


@design.callback()
def about() -> None:
    """Sizes from equations; each command writes a table, and a page where --out is given."""


@design.command()
def coil(
    moment_a_m2: Annotated[float | None, typer.Option(help="The moment.", show_default=False)] = None,
    torque_n_m: Annotated[float | None, typer.Option(help="Or a torque, with --field-nt.", show_default=False)] = None,
    field_nt: Annotated[float | None, typer.Option(help="Field across the coil's axis.", show_default=False)] = None,
    diameter_m: Annotated[float | None, typer.Option(help="A circle's diameter.", show_default=False)] = None,
    sides_m: Annotated[str | None, typer.Option(help="Or a rectangle's sides.", show_default=False, metavar="A,B")] = None,
    core: Annotated[str, typer.Option(help="air or rod.")] = "air",
    core_length_m: Annotated[float | None, typer.Option(help="Of a rod.", show_default=False)] = None,
    core_diameter_m: Annotated[float | None, typer.Option(help="Of a rod.", show_default=False)] = None,
    core_alloy: Annotated[
        str, typer.Option(help="iron, 45-permalloy, 4-79-permalloy, mumetal, supermalloy or 2V-permendur.")
    ] = "4-79-permalloy",
    core_shape: Annotated[str, typer.Option(help="Demagnetising factor: ellipsoid, or the cautious cylinder.")] = "ellipsoid",
    current_a: Annotated[float | None, typer.Option(help="Turns: most current.", show_default=False)] = None,
    turns: Annotated[int | None, typer.Option(help="Turns: their number.", show_default=False)] = None,
    wire: Annotated[str | None, typer.Option(help="Wire: a gauge, such as AWG29.", show_default=False)] = None,
    wire_area_mm2: Annotated[float | None, typer.Option(help="Wire: its conducting area.", show_default=False)] = None,
    voltage_v: Annotated[float | None, typer.Option(help="Wire: voltage at the whole moment.", show_default=False)] = None,
    power_w: Annotated[float | None, typer.Option(help="Section: most power.", show_default=False)] = None,
    mass_kg: Annotated[float | None, typer.Option(help="Section: most mass, with core.", show_default=False)] = None,
    mass_per_watt_kg: Annotated[
        float | None, typer.Option(help="Section: what a watt of supply weighs; the lightest whole is taken.", show_default=False)
    ] = None,
    material: Annotated[str, typer.Option(help="copper, aluminium or silver.")] = "copper",
    temperature_c: Annotated[float, typer.Option(help="Of the wire.")] = 20.0,
    insulation_mm: Annotated[float, typer.Option(help="Thickness of the wire's insulation.")] = 0.0,
    out: Annotated[
        Path | None, typer.Option(help="Write STEM.html and STEM.nc (the trade curve).", show_default=False, metavar="STEM")
    ] = None,
    as_json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """A coil for a moment, or for a torque across a field: turns, current, resistance, power and mass.

    Give what it must do, its shape, and one from each of two groups: turns (--turns, --current-a), wire (--wire,
    --wire-area-mm2, --voltage-v), section (--power-w, --mass-kg, --mass-per-watt-kg).
    """
    from fieldline.design import design_coil

    named = {name: value for name, value in locals().items() if name not in ("out", "as_json", "quiet", "design_coil")}
    arguments = _converted(named)
    paths = _targets(out)
    try:
        found = design_coil(**arguments)
    except InputError as error:
        raise InputError(_as_options(str(error))) from error
    written = _write(found, named, paths) if paths else []
    _show(found, written, as_json, quiet)
    return 0


@design.command()
def wire(
    material: Annotated[str, typer.Option(help="copper, aluminium or silver.")] = "copper",
    temperature_c: Annotated[float, typer.Option(help="Of the wire.")] = 20.0,
    first: Annotated[int, typer.Option(help="Thickest gauge; 0, -1, -2, -3 are AWG0 to AWG4/0.", min=-3, max=50)] = 16,
    last: Annotated[int, typer.Option(help="Finest gauge.", min=-3, max=50)] = 40,
    as_json: options.Json = False,
) -> None:
    """The gauge table: diameter, section, resistance and mass of round wire by AWG number."""
    from dataclasses import asdict

    from fieldline.design import gauge_table

    rows = gauge_table(material, temperature_c, first, last)
    if as_json:
        import json

        print(json.dumps([asdict(row) for row in rows], indent=2))
        return
    print(f"{'gauge':<8}{'diameter [mm]':>14}{'section [mm²]':>15}{'[ohm/m]':>12}{'[g/m]':>11}")
    for row in rows:
        numbers = (1e3 * row.diameter_m, 1e6 * row.area_m2, row.resistance_ohm_per_m, 1e3 * row.mass_kg_per_m)
        print(f"{row.name:<8}{numbers[0]:>14.4f}{numbers[1]:>15.5g}{numbers[2]:>12.4g}{numbers[3]:>11.4g}")


def _converted(named: dict[str, Any]) -> dict[str, Any]:
    """Options in the units of the command line as arguments in SI."""
    kept = {k: v for k, v in named.items() if k not in ("field_nt", "sides_m", "wire_area_mm2", "insulation_mm")}
    field, area = named["field_nt"], named["wire_area_mm2"]
    if field is not None and not 0.0 < field <= MOST_FIELD_NT:
        raise InputError(
            f"--field-nt must lie between 0 and {MOST_FIELD_NT:g}; got {field:g}. In orbit it is 10,000 to 60,000 nT."
        )
    return kept | {
        "field_tesla": None if field is None else 1e-9 * field,
        "sides_m": None if named["sides_m"] is None else _sides(named["sides_m"]),
        "wire_area_m2": None if area is None else 1e-6 * area,
        "insulation_m": 1e-3 * named["insulation_mm"],
    }


def _sides(text: str) -> tuple[float, ...]:
    """Two numbers with a comma between them."""
    try:
        one, other = (float(part) for part in text.split(","))
    except ValueError as error:
        raise InputError(f'--sides-m needs two lengths, for example --sides-m 0.3,0.2; got "{text}".') from error
    return one, other


def _as_options(message: str) -> str:
    """A message about arguments as one about options."""
    import re

    pattern = re.compile(r"\b(" + "|".join(sorted(OPTION_OF, key=len, reverse=True)) + r")\b")
    return pattern.sub(lambda match: OPTION_OF[match.group(0)], message)


def _targets(out: Path | None) -> dict[str, Path]:
    """Where to write, looked at before the work."""
    from fieldline.cli.outputs import stem_of, targets

    return {} if out is None else targets(stem_of(out, out, "coil"), (".html", ".nc"), [])


def _write(found: Any, named: dict[str, Any], paths: dict[str, Path]) -> list[Path]:
    """Page and trade curve, together."""
    from fieldline.files import write_together
    from fieldline.report.coil_report import coil_html
    from fieldline.telemetry import write_attitude_netcdf

    page = coil_html(found, {name: value for name, value in named.items() if value is not None})
    curve = found.trade_curve()
    return write_together(
        [
            (paths[".html"], lambda path: path.write_text(page, encoding="utf-8")),
            (paths[".nc"], lambda path: write_attitude_netcdf(curve, path)),
        ]
    )


def _show(found: Any, written: list[Path], as_json: bool, quiet: bool) -> None:
    """The table or the record, and what was written."""
    from fieldline.cli.outputs import wrote

    if as_json:
        import json

        print(json.dumps(found.record(), indent=2))
    elif not quiet:
        print(found.summary())
        if written:
            print(wrote(written))
