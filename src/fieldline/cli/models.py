"""`fieldline models`: the field models and their years."""

from __future__ import annotations

from fieldline.cli.options import Json


def models(as_json: Json = False) -> None:
    """List the field models: years, degree, source."""
    from fieldline.environment import MAGNETIC_FIELDS

    rows = [_row(name) for name in MAGNETIC_FIELDS]
    if as_json:
        import json

        print(json.dumps(rows, indent=2))
        return
    for row in rows:
        print(f"{row['name']:<20} {row['years']:<28} {row['words']}")


def _row(name: str) -> dict:
    """A model's account; one that needs numbers of the user's own says so."""
    from fieldline.environment import field_model
    from fieldline.errors import InputError

    try:
        model = field_model(name)
    except InputError:
        return {"name": name, "years": "any", "words": "with positions or moments of your own, from Python"}
    first, last = model.years
    years = "any" if first < 0 else f"{first:g} to {last:g}"
    if model.predictive_from is not None:
        years += f" (forecast from {model.predictive_from:g})"
    degree = f"degree {model.degree}; " if model.degree else ""
    return {"name": name, "years": years, "words": degree + model.source}
