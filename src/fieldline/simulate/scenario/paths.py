"""Changing values of nested tables by their path, for sweeps: "body.0.mass_kg" or "body[0].mass_kg"."""

from __future__ import annotations

import re
from collections.abc import Mapping
from copy import deepcopy
from typing import Any

from fieldline.errors import InputError


def changed(table: dict[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """A copy of nested tables with the values at some paths replaced; None takes a key out."""
    copy = deepcopy(table)
    for path, value in changes.items():
        *way, last = (part for part in re.split(r"[.\[\]]+", path) if part)
        here: Any = copy
        for part in way:
            here = _step(here, part, path)
        _put(here, last, value, path)
    return copy


def _step(here: Any, part: str, path: str) -> Any:
    """One step into a table, made where it was left to its defaults, or into a list."""
    if isinstance(here, dict):
        return here.setdefault(part, {})
    return here[_index(here, part, path)]


def _put(here: Any, last: str, value: Any, path: str) -> None:
    """The value at the end of a path."""
    if not isinstance(here, dict):
        here[_index(here, last, path)] = value
    elif value is None:
        here.pop(last, None)
    else:
        here[last] = value


def _index(here: Any, part: str, path: str) -> int:
    """A place in a list."""
    if not isinstance(here, list) or not part.isdigit() or int(part) >= len(here):
        held = f"a list of {len(here)}, counted from 0" if isinstance(here, list) else "a value, not a table"
        raise InputError(f'"{path}" leads nowhere: "{part}" is asked of {held}. For example "body.0.mass_kg".')
    return int(part)
