"""What a checker refused, in words: path of the key, what came, what was expected, the nearest known key."""

from __future__ import annotations

import difflib
from collections.abc import Iterator
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from fieldline.errors import nearest, shown
from fieldline.records.record import RecordError

KINDS = {
    "float_type": "must be a number",
    "float_parsing": "must be a number",
    "finite_number": "must be a finite number",
    "int_type": "must be a whole number",
    "int_from_float": "must be a whole number",
    "int_parsing_size": "must be a whole number of fewer digits",
    "bool_type": "must be true or false",
    "string_type": 'must be text in quotes ("...")',
    "dict_type": "must be a table of keys and values",
    "model_type": "must be a table of keys and values",
    "model_attributes_type": "must be a table of keys and values",
    "tuple_type": "must be a list",
}
BOUNDS = {
    "greater_than": ("must be more than", "gt"),
    "greater_than_equal": ("must be at least", "ge"),
    "less_than": ("must be less than", "lt"),
    "less_than_equal": ("must be at most", "le"),
}


def sentences(error: ValidationError, model: type[BaseModel]) -> list[str]:
    """One sentence for each thing that was refused, in the order of the keys."""
    # A list whose entries were refused counts as too short as well, which would mislead.
    entries = [one for one in error.errors(include_url=False) if not (one["type"] == "too_short" and one["input"])]
    return [text for one in entries for text in _sentences(one, model)]


def _sentences(one: Any, model: type[BaseModel]) -> Iterator[str]:
    """The sentences of one entry: a validator of ours may have found several."""
    cause = one.get("ctx", {}).get("error")
    if isinstance(cause, RecordError):
        for key, text in cause.found:
            inner = path_of(one["loc"])
            joint = "" if not inner or not key or key.startswith("[") else "."
            yield joined(f"{inner}{joint}{key}", text)
    elif cause is not None:
        yield joined(path_of(one["loc"]), str(cause))
    elif one["type"] == "extra_forbidden":
        yield _unknown(one["loc"], model)
    else:
        yield joined(path_of(one["loc"]), _expectation(one, model))


def joined(path: str, text: str) -> str:
    """Path and sentence, without a character that a terminal would obey."""
    text = "".join(c if c.isprintable() else "?" for c in text)
    text = text if text.endswith((".", "?")) else text + "."
    if not path:
        return text
    return f"{path} {text}" if text.startswith(("must ", "has ", "is ", "names ", "gives ", "needs ")) else f"{path}: {text}"


def _expectation(one: Any, model: type[BaseModel]) -> str:
    """What was expected at a key and what came."""
    kind, context = one["type"], one.get("ctx", {})
    if kind == "missing":
        description = _description(one["loc"], model)
        return f"is missing: {description}" if description else "is missing"
    if kind in BOUNDS:
        words, key = BOUNDS[kind]
        return f"{words} {context[key]:g}; got {came(one['input'])}"
    if kind == "literal_error":
        known = [word.strip("'") for word in context["expected"].replace(" or ", ", ").split(", ")]
        near = nearest(str(one["input"]), known) if isinstance(one["input"], str) else ""
        listed = " or ".join(f'"{word}"' for word in known)
        return f"must be {listed}; got {came(one['input'])}{'; ' + near if near.startswith('did') else ''}"
    if kind == "tuple_type" and model_at(one["loc"], model):
        return f"must be a list of tables, each begun with [[{path_of(one['loc'])}]]; got {came(one['input'])}"
    if kind in ("too_short", "string_too_short"):
        return f"must not be empty; got {came(one['input'])}"
    return f"{KINDS.get(kind, one['msg'].lower())}; got {came(one['input'])}"


def came(value: Any) -> str:
    """A value as a message can show it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'the text "{shown(value)}"'
    if isinstance(value, dict):
        return "a table"
    if isinstance(value, int | float):
        return f"{value:.9g}" if isinstance(value, float) or abs(value) < 10**15 else "a number of too many digits"
    return shown(str(value), 60)


def path_of(location: tuple[int | str, ...]) -> str:
    """For example body[0].magnetorquer[1].moment_max_a_m2."""
    path = ""
    for part in location:
        path += f"[{part}]" if isinstance(part, int) else f"{'.' if path else ''}{shown(str(part))}"
    return path


def _unknown(location: tuple[int | str, ...], model: type[BaseModel]) -> str:
    """An unknown key: the nearest one of its table, or the table where the key belongs."""
    key, table = str(location[-1]), model_at(location[:-1], model)
    known = list(table.model_fields) if table else []
    said = f'unknown key "{path_of(location)}"'
    homes = [path for path, owner in tables_of(model) if key in owner.model_fields]
    near = bool(difflib.get_close_matches(key.lower(), known, n=1, cutoff=0.75))
    if homes and not near:
        return f"{said}; {key} belongs in {' or '.join(home or 'the top of the file, before any [table]' for home in homes)}."
    return f"{said}; {nearest(key, known)}{'' if near else '.'}" if known else f"{said}."


def _description(location: tuple[int | str, ...], model: type[BaseModel]) -> str:
    """What the models say of a key."""
    table = model_at(location[:-1], model)
    field = table.model_fields.get(str(location[-1])) if table else None
    return (field.description or "") if field else ""


def model_at(location: tuple[int | str, ...], model: type[BaseModel]) -> type[BaseModel] | None:
    """The record that a path leads to, or None where it leads into a plain value."""
    here: type[BaseModel] | None = model
    for part in location:
        if isinstance(part, int):
            continue
        field = here.model_fields.get(part) if here else None
        here = record_in(field.annotation) if field else None
    return here


def record_in(annotation: Any) -> type[BaseModel] | None:
    """The record type inside an annotation such as `tuple[Wheel, ...]` or `Drag | None`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((inner for one in get_args(annotation) if (inner := record_in(one))), None)


def is_list(annotation: Any) -> bool:
    """Whether an annotation holds several records."""
    return getattr(annotation, "__origin__", None) is tuple or any(is_list(one) for one in get_args(annotation))


def tables_of(model: type[BaseModel], path: str = "") -> Iterator[tuple[str, type[BaseModel]]]:
    """Every table as TOML names it, "" for the top, then [time], [[body]], [[body.wheel]] and so on."""
    yield path, model
    for name, field in model.model_fields.items():
        inner = record_in(field.annotation)
        if inner:
            whole = f"{path.strip('[]')}.{name}".lstrip(".")
            yield from tables_of(inner, f"[[{whole}]]" if is_list(field.annotation) else f"[{whole}]")
