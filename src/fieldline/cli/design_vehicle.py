"""`fieldline design conductor`, a climb's conductor and supply, and `fieldline design vehicle`, what conductors can reach."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from fieldline.cli import options
from fieldline.errors import InputError

INCLINATIONS = "0,11.5,20,28.5,40,51.6,60,70,78.5,90"
MOST_INCLINATIONS = 181
MOST_FIELD_NT = 1e6
NO_HOLD = 1e-10  # of the inputs' singular values: five directions at most


def conductor(
    mass_kg: Annotated[float, typer.Option(help="What climbs.", show_default=False)],
    low_km: Annotated[float, typer.Option(help="Height of the first orbit.", show_default=False)],
    high_km: Annotated[float, typer.Option(help="Height of the second.", show_default=False)],
    days: Annotated[float, typer.Option(help="Time for it.", show_default=False)],
    current_a: Annotated[float, typer.Option(help="Current, kept up.")] = 125.0,
    field_nt: Annotated[float, typer.Option(help="Field across the orbit's plane.")] = 22600.0,
    ohm_per_m: Annotated[float, typer.Option(help="Of the conductor.")] = 7.7e-5,
    plasma_ohm: Annotated[
        str, typer.Option(help="Least and most of the circuit's path through the plasma.", metavar="A,B")
    ] = "1,20",
    neighbour_m: Annotated[float, typer.Option(help="Distance of the nearest other conductor.")] = 5.0,
    as_json: options.Json = False,
) -> int:
    """A vertical conductor that lifts a mass from one circular orbit to another in time: length, voltage, power."""
    from fieldline.design import design_conductor

    if not 0.0 < field_nt <= MOST_FIELD_NT:
        raise InputError(
            f"--field-nt must lie between 0 and {MOST_FIELD_NT:g}; got {field_nt:g}. In orbit it is 10,000 to 60,000 nT."
        )
    arguments = {
        "mass_kg": mass_kg,
        "low_altitude_m": 1e3 * low_km,
        "high_altitude_m": 1e3 * high_km,
        "transfer_s": 86400.0 * days,
        "current_a": current_a,
        "field_tesla": 1e-9 * field_nt,
        "conductor_ohm_per_m": ohm_per_m,
        "plasma_ohm": _pair(plasma_ohm),
        "neighbour_m": neighbour_m,
    }
    found = design_conductor(**arguments)
    if as_json:
        import json

        print(json.dumps(found.record(), indent=2))
    else:
        print(found.summary())
    return 0


def vehicle(
    vertical_m: Annotated[float, typer.Option(help="Towers up and down, each.")] = 50.0,
    horizontal_m: Annotated[float, typer.Option(help="Towers along the track, each.")] = 310.0,
    support_m: Annotated[float, typer.Option(help="Towers across it, each.")] = 50.0,
    cross_vertical_m: Annotated[float, typer.Option(help="Vertical conductors of the crosses.")] = 20.0,
    cross_horizontal_m: Annotated[float, typer.Option(help="Horizontal conductors of the crosses.")] = 20.0,
    design: Annotated[int, typer.Option(help="1: six conductors; 2: eight, with crosses.")] = 2,
    thruster: Annotated[bool, typer.Option("--thruster/--no-thruster", help="A pair across the orbit.")] = True,
    tank_mass_kg: Annotated[float, typer.Option(help="Of the cylinder in the middle.")] = 31300.0,
    tower_kg_per_m: Annotated[float, typer.Option(help="Of the towers.")] = 7.3,
    altitude_km: Annotated[float, typer.Option(help="Of the circular orbit.")] = 400.0,
    inclinations_deg: Annotated[str, typer.Option(help="With commas.", metavar="LIST")] = INCLINATIONS,
    model: Annotated[str, typer.Option(help="Of the field.")] = "IGRF-14",
    date: Annotated[str, typer.Option(help="Of the field.")] = "2025-01-01",
    out: Annotated[
        Path | None, typer.Option(help="Write STEM.png (a chart over the orbit) and STEM.nc.", show_default=False, metavar="STEM")
    ] = None,
    as_json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """A vehicle that flies by current: mass, inertia, passive stability, and what it can reach at each inclination."""
    from fieldline.analysis.vehicle_survey import vehicle_survey
    from fieldline.design import tank_with_towers

    named = {name: value for name, value in locals().items() if name not in ("vehicle_survey", "tank_with_towers")}
    keys = "vertical_m horizontal_m support_m cross_vertical_m cross_horizontal_m design thruster tank_mass_kg tower_kg_per_m"
    made = tank_with_towers(**{key: named[key] for key in keys.split()})
    paths = _targets(out)
    survey = vehicle_survey(made, 1e3 * altitude_km, _inclinations(inclinations_deg), model=model, time_utc=_date(date))
    written = _write(survey, paths, f"Design {design}, {altitude_km:g} km, {model}: least margin of control") if paths else []
    _show(made, survey, altitude_km, written, as_json, quiet)
    return 0


def _pair(text: str) -> tuple[float, float]:
    """Two numbers with a comma between them."""
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError as error:
        raise InputError(f'--plasma-ohm needs two resistances, for example 1,20; got "{text}".') from error
    return low, high


def _inclinations(text: str) -> Any:
    """Angles [rad] from a list with commas."""
    import numpy as np

    try:
        angles = np.array([float(part) for part in text.split(",")])
    except ValueError as error:
        raise InputError(f'--inclinations-deg needs angles with commas, for example 0,28.5,51.6; got "{text[:60]}".') from error
    if len(angles) > MOST_INCLINATIONS or not ((angles >= 0.0) & (angles <= 180.0)).all():
        raise InputError(f"--inclinations-deg must be at most {MOST_INCLINATIONS} angles from 0 to 180; got {text[:60]}.")
    return np.radians(angles)


def _date(text: str) -> Any:
    """The day, or a refusal."""
    import numpy as np

    try:
        return np.datetime64(text, "s")
    except ValueError as error:
        raise InputError(f'--date needs a day such as 2025-01-01; got "{text[:40]}".') from error


def _targets(out: Path | None) -> dict[str, Path]:
    """Where to write, looked at before the work."""
    from fieldline.cli.outputs import stem_of, targets

    return {} if out is None else targets(stem_of(out, out, "vehicle"), (".png", ".nc"), [])


def _write(survey: Any, paths: dict[str, Path], title: str) -> list[Path]:
    """Chart and numbers, together."""
    from fieldline.files import write_together
    from fieldline.report.afit_1992_figures import survey_figure
    from fieldline.report.theme import write_png
    from fieldline.telemetry import write_attitude_netcdf

    figure = survey_figure(survey, title)
    return write_together(
        [(paths[".png"], lambda path: write_png(figure, path)), (paths[".nc"], lambda path: write_attitude_netcdf(survey, path))]
    )


def _show(made: Any, survey: Any, altitude_km: float, written: list[Path], as_json: bool, quiet: bool) -> None:
    """The table or the record, and what was written."""
    from fieldline.cli.outputs import wrote

    rows = [
        (float(survey["inclination_deg"][k]), *(float(survey[name][k]) for name in ("least_margin", "weak_share", "hold")))
        for k in range(survey.sizes["inclination_deg"])
    ]
    passive, growth = _passive(made, altitude_km)
    threshold = survey.attrs["threshold"]
    if as_json:
        import json

        keys = ("inclination_deg", "least_margin", "weak_share", "hold")
        head = {"mass_kg": made.mass_kg, "inertia_kg_m2": list(made.inertia_kg_m2), "growth_s": growth}
        print(json.dumps(head | {"inclinations": [dict(zip(keys, row, strict=True)) for row in rows]}, indent=2))
        return
    if quiet:
        return
    print(f"mass      {made.mass_kg:,.0f} kg, {made.tower_mass_kg:,.0f} of it towers")
    print(f"inertia   {', '.join(f'{moment:.4g}' for moment in made.inertia_kg_m2)} kg m²")
    print(f"attitude  {passive}")
    print(f"\n{'inclination [deg]':>17}{'least margin':>15}{'weak [% of time]':>18}{'holds a place':>15}")
    for inclination, margin, weak, hold in rows:
        words = "no" if hold < NO_HOLD else "not always" if margin < threshold else "yes"
        print(f"{inclination:>17g}{margin:>15.1e}{100.0 * weak:>18.1f}{words:>15}")
    print("\nmargin: smallest singular value of [s I - F, G] over the day, scaled; weak: under 1e-3; below 1e-6: out of reach.")
    if written:
        print(wrote(written))


def _passive(made: Any, altitude_km: float) -> tuple[str, float | None]:
    """What the gravity gradient does by itself, in words, and the time of growth [s] if it grows."""
    from fieldline.constants import EARTH_EQUATORIAL_RADIUS_M, EARTH_GM_M3_S2
    from fieldline.mechanics.relative_motion import attitude_poles

    rate = (EARTH_GM_M3_S2 / (EARTH_EQUATORIAL_RADIUS_M + 1e3 * altitude_km) ** 3) ** 0.5
    found = attitude_poles(rate, made.inertia_kg_m2)
    if found.stable:
        return "swings about the vertical by itself", None
    if found.growth_s == float("inf"):
        return "drifts by itself", None
    return f"grows e-fold in {found.growth_s:.0f} s without control (C > B > A would be stable)", found.growth_s
