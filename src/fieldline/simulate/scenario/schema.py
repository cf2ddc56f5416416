"""Every key of a scenario: as JSON Schema for editors, and as tables for the page on scenarios."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic_core import PydanticUndefined

from fieldline.records.words import record_in, tables_of
from fieldline.simulate.scenario.scenario import Scenario

WORDS = {"number": "number", "integer": "whole number", "string": "text", "boolean": "true or false", "object": "table"}
BOUNDS = {"exclusiveMinimum": "> {:g}", "minimum": ">= {:g}", "exclusiveMaximum": "< {:g}", "maximum": "<= {:g}"}
TOO_LARGE = 1e15  # bounds that only keep numbers within what a computer holds are not told


def json_schema() -> dict[str, Any]:
    """JSON Schema of a scenario file."""
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **Scenario.model_json_schema()}


def markdown() -> str:
    """A table of keys for every table of a scenario file."""
    return "\n\n".join(_section(path, model) for path, model in tables_of(Scenario)) + "\n"


def _section(path: str, model: Any) -> str:
    """One heading and its keys; keys that are tables themselves have sections of their own."""
    properties = model.model_json_schema(ref_template="{model}")["properties"]
    rows = list(_rows(model, properties))
    heading = f"### `{path}`" if path else "### Top of the file"
    opening = " ".join((model.__doc__ or "").split("\n\n")[0].split())
    return "\n".join([heading, "", opening, "", "| key | value | default | meaning |", "|---|---|---|---|", *rows])


def _rows(model: Any, properties: dict[str, Any]) -> Iterator[str]:
    """Lines of the table."""
    for name, field in model.model_fields.items():
        if record_in(field.annotation) is None:
            default = "needed" if field.is_required() else _shown(field.get_default())
            yield f"| `{name}` | {_kind(properties[name])} | {default} | {field.description} |"


def _kind(schema: dict[str, Any]) -> str:
    """What a value is, with its bounds."""
    parts = [one for one in schema.get("anyOf", []) if one.get("type") != "null"]
    if parts:
        return " or ".join(dict.fromkeys(_kind(one) for one in parts))
    if "enum" in schema or "const" in schema:
        return ", ".join(f"`{word}`" for word in schema.get("enum", [schema.get("const")]))
    if schema.get("type") == "array":
        return _list(schema)
    bounds = [words.format(schema[key]) for key, words in BOUNDS.items() if abs(schema.get(key, TOO_LARGE)) < TOO_LARGE]
    return ", ".join([WORDS.get(schema.get("type", ""), "value"), *bounds])


def _list(schema: dict[str, Any]) -> str:
    """Three numbers, three rows, or as many as are given."""
    inner, count = schema.get("items", {}), schema.get("maxItems")
    if inner.get("type") == "array":
        return "3 rows of 3 numbers" if count == 3 else "list of 3 numbers each"
    return f"{count} numbers" if count else f"list of {_kind(inner)}"


def _shown(value: Any) -> str:
    """A default as a file would write it."""
    from fieldline.simulate.scenario.toml import inline

    if value is None or value is PydanticUndefined:
        return ""
    if isinstance(value, tuple) and all(isinstance(row, tuple) for row in value) and len(value) == 3:
        value = tuple(value[k][k] for k in range(3))  # the tensors that are defaults are diagonal
    return f"`{inline(value)}`" if value not in ((), {}, "") else ""
