"""TOML: reading with the place of a slip, and writing tables back."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from typing import Any

from fieldline.errors import InputError, shown

BARE = re.compile(r"[A-Za-z0-9_-]+")
PLACE = re.compile(r"\(at line (\d+), column (\d+)\)")


def parse(text: str, source: str) -> dict[str, Any]:
    """The tables of a TOML text; InputError names the line, what stands there and what may be meant."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(_slip(text, source, str(error))) from None
    except (ValueError, RecursionError, OverflowError):
        raise InputError(f"{source}: a number or a nesting in it is beyond what TOML can hold.") from None


def _slip(text: str, source: str, message: str) -> str:
    """Where the syntax broke, with a guess."""
    place = PLACE.search(message)
    what = PLACE.sub("", message).strip().rstrip(".")
    lines = text.splitlines()
    if place is None or int(place[1]) > len(lines):
        return f"{source}: the file ends too early ({what}). Is a quote, bracket or value missing at its end?"
    number = int(place[1])
    line = lines[number - 1]
    return f'{source} line {number}: {what}, in "{shown(line.strip(), 60)}". {_guess(line, what)}'


def _guess(line: str, what: str) -> str:
    """What is commonly meant by such a line."""
    if what.startswith(("Cannot overwrite", "Cannot declare")):
        return "It stands in the file twice: leave one out, or begin each table of a list with [[name]]."
    if what.startswith("Invalid date"):
        return "A date is written 2026-03-01T00:00:00Z: year, month, day; is there such a day?"
    bare = line.split("#")[0].strip()
    key, equals, value = (part.strip() for part in bare.partition("="))
    if bare.startswith("[") and not bare.endswith("]"):
        return "A table is written [name] or [[name]]."
    if not equals:
        return 'Expected key = value, or a table as [name]; is the "=" missing?'
    if re.fullmatch(r"[A-Za-z][\w.\-/ ]*", value) and value not in ("true", "false"):
        return f'Text stands in quotes: {key} = "{shown(value)}". Truth is true or false, in lower case.'
    if re.search(r"\d\s+\d", value):
        return "Numbers of a list are parted by commas: [1.0, 2.0, 3.0]."
    if re.fullmatch(r"[+-]?(\.\d+|\d+\.)([eE].*)?", value):
        return "A decimal has digits on both sides of its point: 0.5, 2.0."
    return "Expected one value: a number, true, false, text in quotes, a list [1.0, 2.0, 3.0] or a table { key = value }."


def written(table: dict[str, Any]) -> str:
    """Tables as TOML text that `parse` reads back to the same."""
    return "\n".join(_table(table, "")).strip() + "\n"


def _table(table: dict[str, Any], path: str) -> Iterator[str]:
    """Plain keys first, then tables, then lists of tables, as TOML needs them."""
    for key, value in table.items():
        if not isinstance(value, dict) and not _is_tables(value):
            yield f"{_key(key)} = {inline(value)}"
    for key, value in table.items():
        inner = f"{path}.{_key(key)}".lstrip(".")
        if isinstance(value, dict):
            bare = bool(value) and all(isinstance(one, dict) for one in value.values())
            yield from (*(() if bare else ("", f"[{inner}]")), *_table(value, inner))
        elif _is_tables(value):
            for one in value:
                yield from ("", f"[[{inner}]]", *_table(one, inner))


def _is_tables(value: Any) -> bool:
    """Whether a value is a list of tables."""
    return isinstance(value, list | tuple) and bool(value) and all(isinstance(one, dict) for one in value)


def _key(key: str) -> str:
    """A key, in quotes where it needs them."""
    return key if BARE.fullmatch(key) else _text(key)


def _text(text: str) -> str:
    """A basic string."""
    escapes = {"\\": "\\\\", '"': '\\"', "\n": "\\n", "\t": "\\t", "\r": "\\r"}
    return '"' + "".join(escapes.get(c, c if c.isprintable() else f"\\U{ord(c):08x}") for c in text) + '"'


def inline(value: Any) -> str:
    """A value on one line."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, list | tuple):
        return f"[{', '.join(inline(one) for one in value)}]"
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{_key(key)} = {inline(one)}' for key, one in value.items())} }}" if value else "{}"
    return repr(value) if isinstance(value, int | float) else _text(str(value))
